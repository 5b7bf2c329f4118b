"""What does not fit a curve that is printed in rounded numbers, such as knots in quotes."""

from __future__ import annotations

from ...documents import ClaimVerdict, Severity
from ..study import Study

FITTING = ClaimVerdict.SUPPORTED, Severity.INFO, ""
"""What it says that a printed number fits: verdict, severity and no note."""


def misfit(study: Study, pid: str, rid: str) -> tuple[ClaimVerdict, Severity, str]:
    """What it says that a printed number does not fit the motion.

    What rounds to derivatives at the ends, knots and parameters is not looked at, and may be why.

    Parameters
    ----------
    study : Study
    pid, rid : str
        Problem and reading.

    Returns
    -------
    verdict : ClaimVerdict
    severity : Severity
    note : str
        To be added to the message; may be empty.
    """
    loose = study.case.statement(pid, rid).declaration.loose
    if not loose:
        return ClaimVerdict.INCONSISTENT, Severity.WARNING, ""
    note = f" {loose} are rounded numbers, which may explain it."
    return ClaimVerdict.NOT_CHECKABLE, Severity.INFO, note
