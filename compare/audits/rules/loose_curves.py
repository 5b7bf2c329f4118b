"""What does not fit a curve that is printed in rounded numbers, such as knots in quotes."""

from __future__ import annotations

from ....problem.cases import Claim
from ...documents import ClaimVerdict
from ..row import Row

FITTING = ClaimVerdict.SUPPORTED, ""
"""What it says that a printed number fits: verdict and no note."""


def misfit(row: Row[Claim]) -> tuple[ClaimVerdict, str]:
    """What it says that a printed number does not fit the motion.

    What rounds to derivatives at the ends, knots and parameters is not looked at, and may be why.

    Parameters
    ----------
    row : Row

    Returns
    -------
    verdict : ClaimVerdict
    note : str
        A further sentence; may be empty.
    """
    loose = row.statement.declaration.loose
    if not loose:
        return ClaimVerdict.INCONSISTENT, ""
    return ClaimVerdict.NOT_CHECKABLE, f"{loose} are rounded numbers, which may explain it."
