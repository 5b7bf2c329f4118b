"""TG305: printed totals along a fixed path beside the shortest time that its limits allow."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np

from ....nlp.retiming import retime, shortest_by_squares
from ....problem import fit
from ....problem.cases import AnyClaim, Digits, StatementClaim, TotalTimeClaim
from ...documents import Basis, ClaimVerdict, Finding
from ..printed_row import PrintedRow
from ..rounding import meet
from ..study import Pair, Study
from .rule_group import Explained, rule_group

_AT_REST = (0.0, 0.0)
"""Path speeds at both ends."""


class _Shortest(NamedTuple):
    """The shortest time along a path by two routes, s, and all that both leave open."""

    toppra: float
    squares: float
    error: float

    @property
    def range(self) -> tuple[float, float]:
        """Least and largest value that one of both routes leaves open."""
        both = (self.toppra, self.squares)
        return min(both) - self.error, max(both) + self.error


@rule_group(
    TG305=Explained(
        "A printed total along a fixed path beside the shortest time on it",
        "Is the printed total the shortest within limits of velocity and acceleration, from rest "
        "to rest along the path of the problem's curve? TOPPRA and a convex program in the "
        "square of the path speed give the shortest.",
        "Supported if both agree with it, inconsistent if it is shorter than both, else not "
        "checkable: a motion may take longer. Called optimal, a longer total is inconsistent too. "
        "Nothing is contradicted where way-points are printed digits, which bend the path.",
        "A lap is called time-optimal at 1.7000 s, and a motion on the same path takes 1.6460 s.",
    ),
)
def judge_along_paths(study: Study) -> Iterator[Finding]:
    """Findings of TG305."""
    for claim in study.claims:
        named: list[AnyClaim] = [claim]
        optimal = isinstance(claim, StatementClaim) and claim.checks == "optimal"
        if isinstance(claim, StatementClaim):
            named = [study.case.claim(name) for name in claim.of if optimal]
        for one in named:
            if isinstance(one, TotalTimeClaim) and one.path == "curve":
                for pair in study.pairs:
                    if one.problem in (None, pair.problem):
                        yield _beside(PrintedRow(study, one, pair), claim.id, optimal)


def _shortest(study: Study, pair: Pair) -> _Shortest | str:
    """The shortest time along the path of a problem, or why it is not known, as a sentence."""
    problem = study.problem(pair)
    assert problem.shares is not None
    trajectory = fit(problem.curve, problem.waypoints, problem.shares)
    study.progress("the shortest time along its path")
    by_toppra = retime(trajectory, problem.limits, end_speeds=_AT_REST)
    if not by_toppra.applicable or by_toppra.extrapolated is None:
        return f"The shortest time along the path is not computed: {by_toppra.why}."
    by_squares = shortest_by_squares(trajectory, problem.limits, _AT_REST)
    if by_squares is None:
        return "The convex program along the path found no answer, and TOPPRA's stands alone."
    return _Shortest(by_toppra.extrapolated, by_squares, by_toppra.error or 0.0)


def _beside(row: PrintedRow[TotalTimeClaim], about: str, optimal: bool) -> Finding:
    best = row.study.once(("along path", row.pair), lambda: _shortest(row.study, row.pair))
    if isinstance(best, str):
        return _found(row, about, ClaimVerdict.NOT_CHECKABLE, "not computed", best)
    low, high = best.range
    looser, tighter = _slack(row)
    low, high = low / looser, high * tighter
    number = row.time(row.claim.value).cut_off()
    fits = meet((number.lower, number.upper), (low, high))
    exact = all(one.exact for points in row.statement.waypoints.points for one in points)
    shorter = number.upper < low
    verdict, kind = ClaimVerdict.NOT_CHECKABLE, "longer"
    if fits:
        verdict, kind = ClaimVerdict.SUPPORTED, "fits"
    elif not exact:
        kind = "digits"
    elif shorter or optimal:
        verdict, kind = ClaimVerdict.INCONSISTENT, "shorter" if shorter else "longer"
    away = 100 * abs(number.value / best.toppra - 1)
    said = f"{away:.2f} % {'below' if number.value < best.toppra else 'above'} it"
    return _found(
        row,
        about,
        verdict,
        kind,
        f"Along the path the shortest time is {best.toppra:.6g} s by TOPPRA and "
        f"{best.squares:.6g} s by the convex program; printed is {row.claim.value} "
        f"{row.study.time_unit}, {'which fits' if fits else said}.",
        printed=f"{row.claim.value} {row.study.time_unit}",
        computed=f"{best.toppra:.6g} s",
    )


def _slack(row: PrintedRow[TotalTimeClaim]) -> tuple[float, float]:
    """Factors by which the loosest limits allow less time, and the tightest ask for more.

    Times scale as the inverse of a factor on all velocities whose square is on all accelerations.
    """
    plain, loose, tight = (
        row.posed(digits).limits.derivatives[:, :2]
        for digits in (Digits.PRINTED, Digits.LOOSEST_CUT, Digits.TIGHTEST)
    )
    powers = np.array([1.0, 0.5])
    with np.errstate(invalid="ignore"):
        looser, tighter = ((a / b) ** powers for a, b in ((loose, plain), (plain, tight)))
    return float(np.nanmax(looser, initial=1.0)), float(np.nanmax(tighter, initial=1.0))


def _found(
    row: PrintedRow[Any], about: str, verdict: ClaimVerdict, kind: str, said: str, **facts: Any
) -> Finding:
    return row.finding(
        "TG305",
        verdict=verdict,
        basis=Basis.COMPUTED,
        claim=about,
        kind=kind,
        sentences=(said,),
        **facts,
    )
