from .borrowed import Borrowed, BorrowedTask
from .catalogue import BASELINES, find_optimizer

__all__ = ["BASELINES", "Borrowed", "BorrowedTask", "find_optimizer"]
