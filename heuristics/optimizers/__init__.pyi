from .borrowed import Borrowed as Borrowed, BorrowedTask as BorrowedTask
from .catalogue import (
    BASELINES as BASELINES,
    BUDGET as BUDGET,
    evaluations_of as evaluations_of,
    find_optimizer as find_optimizer,
    optimizer_name as optimizer_name,
)
