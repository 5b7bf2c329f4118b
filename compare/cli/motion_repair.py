"""`check --repair OUT`: the motion at the speed that keeps the limits, in a file as it came in."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory

from ...problem import CaseError
from ...problem.motions import ForeignFile, MotionCheck, MotionForm
from ..documents import OrWhy, RepairedMotion, Why
from .motion_results import checked_motion

_ENDINGS = {
    MotionForm.CSV: (".csv", ".txt"),
    MotionForm.ROS: (".json", ".yaml", ".yml"),
    MotionForm.PPOLY: (".json",),
}
"""How a file is called, so that it is read as what it is."""
_ROUNDS = 3
"""Times that a file is written: whole nanoseconds may take a motion past a limit once more."""


def repaired(
    read: ForeignFile,
    found: MotionCheck,
    out: Path,
    check: Callable[[Path], MotionCheck],
    write: Callable[[str], None],
) -> OrWhy[RepairedMotion]:
    """Write the motion slowed down, and what is true of the file when it is read back.

    Parameters
    ----------
    read : ForeignFile
    found : MotionCheck
        What was found about it.
    out : Path
    check : callable
        Reads a file as this one was read, and judges it.
    write : callable
        Writes the text of the file.

    Returns
    -------
    RepairedMotion or Why
        Why nothing was written: no slow-down repairs the motion.

    Raises
    ------
    CaseError
        If the file would be read as another format.
    """
    endings = _ENDINGS[read.form]
    if out.suffix.lower() not in endings:
        known = " or ".join(endings)
        raise CaseError(
            str(out), "--repair", f"the motion would be read as something else; use {known}"
        )
    if found.feasible_time is None:
        advice = read.content.advice
        return Why(f"{found.feasible_why}. {advice}" if advice else str(found.feasible_why))
    factor, after = 1.0, found
    with TemporaryDirectory() as folder:
        draft = Path(folder) / out.name
        for _ in range(_ROUNDS):
            factor *= after.stretch
            text = read.slowed(factor).written()
            draft.write_text(text, encoding="utf-8")
            after = check(draft)
            if after.stretch <= 1.0 + after.tolerance:
                break
    write(text)
    return RepairedMotion(
        file=str(out), form=read.form, slow_down=factor, result=checked_motion(after)
    )
