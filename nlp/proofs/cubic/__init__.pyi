from .certifier import CUBIC

__all__ = ["CUBIC"]
