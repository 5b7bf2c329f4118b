from .borrowed import Borrowed, BorrowedTask
from .catalogue import BASELINES, BUDGET, evaluations_of, find_optimizer, optimizer_name

__all__ = [
    "BASELINES",
    "BUDGET",
    "Borrowed",
    "BorrowedTask",
    "evaluations_of",
    "find_optimizer",
    "optimizer_name",
]
