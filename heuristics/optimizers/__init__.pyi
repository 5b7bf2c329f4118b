from .borrowed import Borrowed, BorrowedTask
from .catalogue import BASELINES, evaluations_of, find_optimizer, optimizer_name

__all__ = [
    "BASELINES",
    "Borrowed",
    "BorrowedTask",
    "evaluations_of",
    "find_optimizer",
    "optimizer_name",
]
