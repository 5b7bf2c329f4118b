"""TG305: printed totals along a fixed path beside the shortest time that the limits allow."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from ....nlp.retiming import PathTime, bound_along, largest_derivatives
from ....problem import Array, CaseError, Trajectory, fit
from ....problem.cases import AnyClaim, Digits, StatementClaim, TotalTimeClaim
from ...documents import Basis, ClaimVerdict, Finding
from ..printed_row import PrintedRow
from ..rounding import meet
from ..study import Study
from .rule_group import Explained, rule_group

_CLOSE = 1.01
"""Ratio of both bounds up to which a total between them counts as the shortest."""
_FEWEST = 20
"""Sampled points from which two interpolations differ by little on a smooth path."""
_RESERVE = 2.0
"""How many times as far as a quintic spline the sampled path may lie from the cubic one."""


@rule_group(
    TG305=Explained(
        "A printed total along a fixed path beside the shortest time on it",
        "Is the printed total the shortest along a path, from rest to rest within limits of "
        "velocity and acceleration? A convex program in the square of the path speed gives a "
        "motion, which is checked everywhere; sweeps from both ends give a bound that no motion "
        "undercuts.",
        "Supported if it lies between them, inconsistent if it lies below both, else not "
        "checkable, because a motion may take longer. If it is called optimal, a longer total is "
        "inconsistent too. Both bounds hold however the digits were rounded, and where points "
        "sample the path, for all paths that differ from their spline by at most twice as much as "
        "a quintic spline does.",
        "A lap is called time-optimal at 1.7000 s, and a motion along it takes 1.6462 s.",
    ),
)
def judge_along_paths(study: Study) -> Iterator[Finding]:
    """Findings of TG305."""
    for claim in study.claims:
        optimal = isinstance(claim, StatementClaim) and claim.checks == "optimal"
        named: list[AnyClaim] = [claim]
        if optimal:
            named = [study.case.claim(name) for name in claim.of]  # type: ignore[union-attr]
        for one in named:
            if isinstance(one, TotalTimeClaim) and one.path in ("curve", "sampled"):
                for pair in study.pairs:
                    if one.problem in (None, pair.problem):
                        yield _beside(PrintedRow(study, one, pair), claim.id, optimal)


def _bounds(row: PrintedRow[TotalTimeClaim]) -> PathTime:
    """Bounds on the shortest time along the path, however the digits were rounded."""
    problem, statement = row.study.problem(row.pair), row.statement
    shares = problem.shares
    assert shares is not None  # the case file states ratios, or is refused
    if statement.loose_ratios or not problem.curve.homogeneous or problem.curve.free:
        return PathTime(why="ratios, way-points and ends at rest do not settle the path")
    row.study.progress("the shortest time along a path")
    trajectory = fit(problem.curve, problem.waypoints, shares)
    box = row.waypoint_box(problem).or_cut_off()
    reach = np.maximum(box.upper - box.value, box.value - box.lower)
    sampled = row.claim.path == "sampled"
    if sampled and len(reach) < _FEWEST:
        return PathTime(why=f"fewer than {_FEWEST} points sample the path")
    size = trajectory.path.durations.size
    plain = trajectory.polynomial_in_time and size == problem.segments
    if not plain and (sampled or reach.any()):
        return PathTime(why="the curve has other pieces than segments between way-points")
    radius = np.zeros((2, size, trajectory.joints))
    if reach.any():
        # By how much a way-point moves q′ and q″: those of the curve through 0 and a single 1.
        single = fit(problem.curve, np.eye(len(reach)), shares)
        radius += [each @ reach for each in largest_derivatives(single)]
    if sampled:
        away = _less_other(trajectory, problem.waypoints)
        radius += [_RESERVE * each for each in largest_derivatives(away)]
    try:
        tightest = row.posed(Digits.TIGHTEST).limits
    except CaseError as error:
        return PathTime(why=str(error))
    loosest = row.posed(Digits.LOOSEST_CUT).limits
    return bound_along(trajectory, loosest, tightest, (radius[0], radius[1]))


def _less_other(trajectory: Trajectory, waypoints: Array) -> Trajectory:
    """The difference to a spline of another degree through the same points at the same times."""
    from scipy.interpolate import make_interp_spline  # half a second, and few need it

    degree = 3 if max(trajectory.degrees) > 3 else 5
    other = make_interp_spline(trajectory.breaks, waypoints, k=degree)
    scaled = np.zeros((trajectory.durations.size, max(6, trajectory.scaled.shape[1]), trajectory.joints))
    scaled[:, : trajectory.scaled.shape[1]] = trajectory.scaled
    scale = np.ones((trajectory.durations.size, 1))
    for p in range(degree + 1):
        scaled[:, p] -= other(trajectory.breaks[:-1], nu=p) * scale
        scale = scale * trajectory.durations[:, None] / (p + 1)
    return Trajectory(trajectory.durations, scaled, trajectory.degrees)


def _beside(row: PrintedRow[TotalTimeClaim], about: str, optimal: bool) -> Finding:
    claim = row.claim
    best = row.study.once(("along path", row.pair, claim.path), lambda: _bounds(row))
    if best.why is not None:
        said = f"The shortest time along the path is not computed: {best.why}."
        return _found(row, about, ClaimVerdict.NOT_CHECKABLE, "not computed", said)
    number = row.time(claim.value).cut_off()
    printed = f"{claim.value} {row.study.time_unit}"
    verdict, kind, said = ClaimVerdict.NOT_CHECKABLE, "longer", "a motion may take longer"
    if number.upper < best.lower:
        verdict, kind = ClaimVerdict.INCONSISTENT, "shorter"
        said = f"which is {100 * (1 - number.value / best.lower):.2f} % shorter"
    elif meet((number.lower, number.upper), (best.lower, best.upper)):
        close = best.upper <= _CLOSE * best.lower
        verdict = ClaimVerdict.SUPPORTED if close else ClaimVerdict.NOT_CHECKABLE
        kind, said = ("fits", "which fits") if close else ("wide", "and the bounds are wide")
    elif optimal:
        verdict = ClaimVerdict.INCONSISTENT
        said = f"which is {100 * (number.value / best.upper - 1):.2f} % longer"
    upper = f"{best.upper:.6g} s" if np.isfinite(best.upper) else "not bounded"
    return _found(
        row,
        about,
        verdict,
        kind,
        f"Along the path, no motion from rest to rest takes less than {best.lower:.6g} s, and one "
        f"within the limits takes {upper}; printed is {printed}, {said}.",
        printed=printed,
        computed=f"{best.lower:.6g} to {upper}",
    )


def _found(
    row: PrintedRow[Any], about: str, verdict: ClaimVerdict, kind: str, said: str, **facts: Any
) -> Finding:
    return row.finding(
        "TG305",
        verdict=verdict,
        basis=Basis.ENCLOSURE,
        claim=about,
        kind=kind,
        sentences=(said,),
        **facts,
    )
