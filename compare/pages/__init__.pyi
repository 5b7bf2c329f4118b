from .writer import MARK, foreign, write_report

__all__ = ["MARK", "foreign", "write_report"]
