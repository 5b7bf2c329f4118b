"""TG305: printed totals along a fixed path beside the shortest time that the limits allow."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ....problem.cases import AnyClaim, StatementClaim, TotalTimeClaim
from ...documents import Basis, ClaimVerdict, Finding
from ..path_times import GRID, close, outside, path_time
from ..printed_row import PrintedRow
from ..study import Study
from .rule_group import Explained, rule_group

_SAMPLED = (
    "Both times hold for all paths that differ from the spline through the way-points by at most "
    "twice as much as a spline of another degree does."
)
"""What is added if way-points sample a path."""


TG305 = Explained(
    "TG305",
    "A printed total along a fixed path beside the shortest time on it",
    "Is the printed total the shortest along a path, from rest to rest within limits of "
    "velocity and acceleration? A convex program in the square of the path speed gives a "
    "motion, which is checked everywhere; sweeps from both ends give a bound that no motion "
    "undercuts.",
    "Supported if it lies between them, inconsistent if it lies below both, else not "
    "checkable, because a motion may take longer. If it is called optimal, a longer total is "
    "inconsistent too. A difference of up to 1 % decides nothing, because a planner's grid "
    "may explain it. Both bounds hold however the digits were rounded, and where points "
    "sample the path, for all paths that differ from their spline by at most twice as much as "
    "a spline of another degree does.",
    "A lap is called time-optimal at 1.7000 s, and a motion along it takes 1.6474 s.",
    basis=Basis.ENCLOSURE,
)


@rule_group(TG305)
def judge_along_paths(study: Study) -> Iterator[Finding]:
    """Findings of TG305."""
    for claim in study.claims:
        optimal = isinstance(claim, StatementClaim) and claim.checks == "optimal"
        named: list[AnyClaim] = [claim]
        if optimal:
            named = [study.case.claim(name) for name in claim.of]  # type: ignore[union-attr]
        for one in named:
            if isinstance(one, TotalTimeClaim) and one.along_path:
                for pair in study.pairs:
                    if one.problem in (None, pair.problem):
                        yield _beside(PrintedRow(study, one, pair), claim.id, optimal)


def _beside(row: PrintedRow[TotalTimeClaim], about: str, optimal: bool) -> Finding:
    claim = row.claim
    sampled = claim.path == "sampled"
    known = {"claim": about, "basis": Basis.COMPUTED if sampled else TG305.basis}
    best = path_time(row)
    if best.why is not None:
        said = f"The shortest time along the path is not computed: {best.why}."
        return TG305.finding(row, "not computed", said, **known)
    away = outside(row)
    far = f"{100 * abs(away):.2f} %"
    verdict, kind, said = (
        ClaimVerdict.NOT_CHECKABLE,
        "longer",
        f"is {far} longer, as a motion may be",
    )
    gridded = 0.0 < abs(away) <= GRID
    if away < 0.0 and not gridded:
        verdict, kind, said = ClaimVerdict.INCONSISTENT, "shorter", f"is {far} shorter"
    elif away == 0.0 and close(row):
        verdict, kind, said = ClaimVerdict.SUPPORTED, "fits", "lies between them"
    elif away == 0.0:
        kind, said = "wide", "is not below the first, and they are far apart"
    elif gridded and (optimal or away < 0.0):
        side = "shorter" if away < 0.0 else "longer"
        kind, said = side, f"is {far} {side}, which the grid of a planner may explain"
    elif optimal:
        verdict, said = ClaimVerdict.INCONSISTENT, f"is {far} longer"
    upper = f"one takes {best.upper:.6g} s" if np.isfinite(best.upper) else "none was found"
    printed = f"{claim.value} {row.study.time_unit}"
    said = (
        f"Along the path, from rest to rest, no motion within the limits takes less than "
        f"{best.lower:.6g} s, and {upper}. The printed {printed} {said}."
    )
    known |= {"printed": printed, "computed": f"{best.lower:.6g} to {best.upper:.6g} s"}
    notes = (_SAMPLED,) if sampled else ()
    return TG305.finding(row, kind, said, *notes, verdict=verdict, **known)
