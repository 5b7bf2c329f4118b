"""Questions that fix the ratios of the durations: which printed durations are theirs, in words."""

from __future__ import annotations

import numpy as np

from ...nlp import Evidence
from ...problem import Array, Coupling, Problem
from ...problem.cases import Claim
from .printed_row import PrintedRow
from .rounding import ROUNDING, RoundingBox


def optimum_called(problem: Problem, evidence: Evidence) -> str:
    """What the optimum of a problem is called in a sentence, with its evidence."""
    fixed = problem.ratios is not None
    return f"{evidence} shortest total at these ratios" if fixed else f"{evidence} optimum"


def at_ratios(problem: Problem) -> str:
    """What follows the name of an optimum whose durations have fixed ratios; else nothing."""
    return "" if problem.ratios is None else " at these ratios"


def planned_apart(problem: Problem) -> bool:
    """Whether a paper plans each joint separately, with another outcome than for all together.

    At fixed ratios the longest of the joints' totals is the shortest total of all.
    """
    apart = problem.coupling is Coupling.PER_JOINT and len(problem.joints) > 1
    return apart and problem.ratios is None


def off_ratios(row: PrintedRow[Claim]) -> str | None:
    """In which ratios printed durations are, where a reading fixes others; None if it does not.

    They are in the ratios that it fixes if some durations and ratios agree, of all whose digits
    were rounded or cut off to those printed.
    """
    problem = row.study.problem(row.pair)
    if problem.shares is None or not row.study.case.printed_durations(row.claim):
        return None
    printed = row.durations
    # Half a digit more to each side: durations are cut off, or rounded up to keep a limit.
    down, up = printed.lower - printed.value, printed.upper - printed.value
    least_h, most_h = printed.lower + down, printed.upper + up
    low, high = _ratio_box(row)
    # A total c serves a segment if c·[low, high] meets its box; one c has to serve all.
    with np.errstate(divide="ignore"):
        least, most = float((least_h / high).max()), float((most_h / low).min())
    if least <= most * (1.0 + ROUNDING):
        return None
    own = printed.value / printed.value.sum()
    return (
        f"durations in the ratios {_shown(own)}, and this reading fixes {_shown(problem.shares)} "
        "(shares of the total)"
    )


def _ratio_box(row: PrintedRow[Claim]) -> tuple[Array, Array]:
    """Ratios of any scale: the least and the largest that the digits may stand for."""
    problem, given = row.study.problem(row.pair), row.statement.durations.ratios
    if isinstance(given, tuple):
        box = RoundingBox.of(given).or_cut_off()
        return np.maximum(box.lower, 0.0), box.upper
    if given == "equal":
        assert problem.shares is not None
        return problem.shares, problem.shares
    near, far = row.waypoint_box(problem).or_cut_off().steps
    return np.hypot.reduce(near, axis=1), np.hypot.reduce(far, axis=1)


def _shown(shares: Array) -> str:
    return " : ".join(f"{share:.4g}" for share in shares)
