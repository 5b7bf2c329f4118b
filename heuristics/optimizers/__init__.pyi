from .borrowed import Borrowed, BorrowedTask
from .catalogue import BASELINES, evaluations_of, find_optimizer

__all__ = ["BASELINES", "Borrowed", "BorrowedTask", "evaluations_of", "find_optimizer"]
