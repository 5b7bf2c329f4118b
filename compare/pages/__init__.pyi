from .writer import MARK, RESERVED, foreign, write_report

__all__ = ["MARK", "RESERVED", "foreign", "write_report"]
