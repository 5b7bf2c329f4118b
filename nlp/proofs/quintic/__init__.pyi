from .certifier import QUINTIC

__all__ = ["QUINTIC"]
