"""What digits leave open: where an optimum lies, which ratios are printed, how far readings go."""

from __future__ import annotations

from math import exp, isfinite, log
from typing import NamedTuple

import numpy as np

from ...nlp import Evidence, Status
from ...nlp.optimum import apart
from ...problem import Array, Coupling, Problem, as_piecewise, shown_bound
from ...problem.cases import Claim, Digits, RoundingBox
from .printed_row import PrintedRow, rows_under
from .rounding import ROUNDING, same_limits
from .stated import RowClaim, other_objective
from .study import Study


class OptimumRange(NamedTuple):
    """Bounds on the optimum of every problem whose way-points and limits round to the digits, s.

    None if no bound is proved. A best known total of numbers that are exact is both.
    """

    lower: float | None
    upper: float | None


def optimum_range(row: PrintedRow[Claim]) -> OptimumRange:
    """Bounds on the optimum of a claim's problem, whatever its digits stand for.

    Notes
    -----
    Upper: the durations found, stretched until they keep the tightest limits at every way-point of
    the box. Lower: a motion of any problem in the box, slowed down uniformly by c, keeps the limits
    of the printed one, so its total is at least the printed problem's over c. Limits of order
    r that are larger by a factor f ask for a c of f^(1/r); way-points as well where each segment
    depends on its own two alone, for there every derivative scales with their distance.
    """
    solution = row.optimum
    if not solution.found or solution.status is Status.NOT_ATTAINED:
        return OptimumRange(None, None)
    proved = solution.lower_bound
    if all_exact(row):
        known = solution.best if solution.evidence is not Evidence.CERTIFIED else proved
        return OptimumRange(known, solution.best)
    upper = row.reachable(solution.durations)
    slower = None if proved is None else _slow_down(row)
    if proved is None or slower is None:
        return OptimumRange(None, upper)
    return OptimumRange(proved / slower * (1.0 - ROUNDING), upper)


def all_exact(row: PrintedRow[Claim]) -> bool:
    """Whether nothing that defines the problem is a rounded number."""
    if _loose(row):
        return False
    problem = row.posed()
    box = row.waypoint_box(problem)
    loosest = row.posed(Digits.LOOSEST_CUT)
    return same_limits(problem, loosest) and np.array_equal(box.lower, box.upper)


def _loose(row: PrintedRow[Claim]) -> bool:
    """Whether ends, ratios or the curve itself are rounded numbers, which no box holds."""
    statement = row.statement
    return bool(statement.loose_ends or statement.loose_ratios or statement.declaration.loose)


def below_certified(row: PrintedRow[Claim]) -> tuple[str, ...] | None:
    """That a total lies below a certified bound, which speaks only where the problem is exact."""
    bound = row.optimum.lower_bound
    if bound is None or row.longest_total >= bound or not all_exact(row):
        return None
    shown = shown_bound(bound, "lower", places=6)
    return (f"The printed total lies below the certified lower bound {shown} s.",)


def _slow_down(row: PrintedRow[Claim]) -> float | None:
    """By what motions of every problem in the box are slowed down to keep the printed limits."""
    if _loose(row):
        return None
    problem, loosest = row.posed(), row.posed(Digits.LOOSEST_CUT)
    # Slowing down leaves the path, and may take a duration beyond its upper bound.
    if not problem.curve.homogeneous or np.isfinite(problem.duration_upper).any():
        return None
    if problem.limits.braking.any() or loosest.limits.braking.any():
        return None
    if (loosest.duration_lower < problem.duration_lower).any():
        return None
    wider = _farther(row, problem)
    if wider is None:
        return None
    if problem.limits.limits_position and not (
        (wider == 1.0).all()
        and np.array_equal(problem.limits.position_lower, loosest.limits.position_lower)
        and np.array_equal(problem.limits.position_upper, loosest.limits.position_upper)
    ):
        return None
    own, loose = problem.limits.sides, loosest.limits.sides
    with np.errstate(divide="ignore", invalid="ignore"):
        larger = np.where(np.isfinite(own) & (loose > 0), loose / own, 1.0)
    most = (larger.max(axis=0) * wider[:, None]).max(axis=0)
    limited = np.flatnonzero(np.isfinite(own).any(axis=(0, 1)))
    slower = max([1.0, *(most[r] ** (1.0 / (r + 1)) for r in limited)])
    return float(slower) if np.isfinite(slower) else None


def _farther(row: PrintedRow[Claim], problem: Problem) -> Array | None:
    """By what factor each joint's steps are larger as printed than the least in the box."""
    box = row.waypoint_box(problem).or_cut_off()
    joints = problem.waypoints.shape[1]
    if np.array_equal(box.lower, box.upper):
        return np.ones(joints)
    if as_piecewise(problem.curve) is None or problem.ratios is not None or not apart(problem):
        return None
    steps = np.abs(np.diff(problem.waypoints, axis=0))
    down, up = problem.waypoints - box.lower, box.upper - problem.waypoints
    away = np.where(np.diff(problem.waypoints, axis=0) > 0, up[:-1] + down[1:], down[:-1] + up[1:])
    least = steps - away
    if ((least <= 0) & (steps > 0)).any():
        return None
    with np.errstate(divide="ignore", invalid="ignore"):
        factors: Array = np.where(steps > 0, steps / least, 1.0).max(axis=0)
    return factors


_FAR = 10.0
"""Factor between printed durations and the limits from which a reading is called implausible: a
tenth or ten times is more than bad planning, and less than any two units that are mixed up."""


def implausible(study: Study) -> dict[str, str]:
    """Readings under which printed durations lie far from the limits, though not under another.

    A shortest motion just reaches a limit. A reading that leaves it a tenth of the limits, or ten
    times them, is admissible still: it is only named as what it is.

    Each reason stands under the reading's id; there is none where readings do not differ so much.
    """
    if len(study.readings) < 2 or not study.has_problems:
        return {}
    found = {rid: _stretch(study, rid) for rid in study.readings}
    known = {rid: stretch for rid, stretch in found.items() if stretch is not None}
    factors = {rid: exp(abs(log(stretch))) for rid, stretch in known.items()}
    least = min(factors.values(), default=_FAR)
    far = {rid: factor for rid, factor in factors.items() if factor >= _FAR > least}
    return {
        rid: f"printed durations divided by {factor:.3g} would still keep every limit"
        if known[rid] < 1
        else f"printed durations keep the limits only if multiplied by {factor:.3g}"
        for rid, factor in far.items()
    }


def _stretch(study: Study, reading: str) -> float | None:
    """By what all printed durations times this keep the limits, and those of one claim just so."""
    rows = [c for c in study.case.claims if isinstance(c, RowClaim) and c.state != "before"]
    timed = [c for c in rows if other_objective(study.case, c) is None]
    checked = [row.check_or_none for row in rows_under(study, timed, reading)]
    stretches = [found.stretch for found in checked if found is not None]
    return max((one for one in stretches if isfinite(one) and one > 0), default=None)


# --- ratios of durations --------------------------------------------------------------------------


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
