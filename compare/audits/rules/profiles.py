"""TG304: printed totals of point-to-point profiles beside the shortest that the limits allow."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from math import cbrt, inf, sqrt

import numpy as np

from ....problem import Array, CaseError, Problem
from ....problem.cases import Digits, TotalTimeClaim
from ...documents import Basis, ClaimVerdict, Finding, Severity
from ..study import Study

_SLACK = 1e-12
"""Relative margin that outweighs the few roundings of a closed form in floats."""


def trapezoidal(way: float, velocity: float, acceleration: float, jerk: float) -> float:
    """Shortest time from rest to rest with constant acceleration, constant speed and braking.

    Parameters
    ----------
    way : float
        rad, not negative.
    velocity, acceleration : float
        Limits, rad/s and rad/s²; may be infinite.
    jerk : float
        Not read: the acceleration jumps.

    Returns
    -------
    float
        s.
    """
    if way == 0.0:
        return 0.0
    if way * acceleration <= velocity**2:
        return 2.0 * sqrt(way / acceleration)
    return way / velocity + velocity / acceleration


def s_curve(way: float, velocity: float, acceleration: float, jerk: float) -> float:
    """Shortest time from rest to rest with a jerk that is constant in at most seven phases.

    Parameters
    ----------
    way : float
        rad, not negative.
    velocity, acceleration, jerk : float
        Limits, rad/s, rad/s² and rad/s³; may be infinite.

    Returns
    -------
    float
        s.
    """
    if way == 0.0 or jerk == inf:
        return trapezoidal(way, velocity, acceleration, jerk)
    # Time to the full speed and back takes `speeding` each, and half of speed times that as way.
    if velocity * jerk >= acceleration**2:
        speeding = velocity / acceleration + acceleration / jerk
    else:
        speeding = 2.0 * sqrt(velocity / jerk)
    if way >= velocity * speeding:
        return speeding + way / velocity
    if way * jerk**2 >= 2.0 * acceleration**3:
        ramp = acceleration / jerk
        return ramp + sqrt(ramp**2 + 4.0 * way / acceleration)
    return 4.0 * cbrt(way / (2.0 * jerk))


PROFILES: dict[str, Callable[[float, float, float, float], float]] = {
    "trapezoidal": trapezoidal,
    "s-curve": s_curve,
}
"""The shortest time of each profile: longer for a longer way, shorter for larger limits."""


def shortest(profile: str, ways: Array, limits: Array) -> float:
    """Shortest total through way-points at rest, each segment as long as its slowest joint needs.

    Parameters
    ----------
    profile : str
        A key of `PROFILES`.
    ways : ndarray, shape (segments, joints)
        rad, not negative.
    limits : ndarray, shape (joints, 3)
        Of velocity, acceleration and jerk.

    Returns
    -------
    float
        s.
    """
    time = PROFILES[profile]
    each = [[time(float(w), *map(float, own)) for w, own in zip(row, limits, strict=True)]
            for row in ways]  # fmt: skip
    return float(np.max(each, axis=1).sum())


def judge_profiles(study: Study) -> Iterator[Finding]:
    """Findings of TG304."""
    for claim in study.claims:
        if isinstance(claim, TotalTimeClaim) and claim.profile is not None:
            for pid, rid in study.pairs:
                if claim.problem in (None, pid):
                    yield _beside(study, claim, claim.profile, pid, rid)


def _ways(problem: Problem, study: Study, pid: str, rid: str) -> tuple[Array, Array]:
    """Least and most that each joint moves in each segment, digits rounded or cut off."""
    box = study.waypoint_box(problem, pid, rid).or_cut_off()
    low, high = box.lower[1:] - box.upper[:-1], box.upper[1:] - box.lower[:-1]
    most = np.maximum(np.abs(low), np.abs(high))
    least = np.where((low <= 0) & (high >= 0), 0.0, np.minimum(np.abs(low), np.abs(high)))
    return least, most


def _beside(study: Study, claim: TotalTimeClaim, profile: str, pid: str, rid: str) -> Finding:
    problem = study.claim_problem(claim, pid, rid)
    if problem.limits.uneven:
        return Finding(
            rule="TG304",
            severity=Severity.INFO,
            verdict=ClaimVerdict.NOT_CHECKABLE,
            basis=Basis.CHECK,
            claim=claim.id,
            problem=pid,
            reading=rid,
            message=f"The lower and upper limits differ; the {profile} profile is computed within "
            "limits of equal size only.",
        )
    plain = shortest(
        profile, np.abs(np.diff(problem.waypoints, axis=0)), problem.limits.derivatives
    )
    least, most = _ways(problem, study, pid, rid)
    loose = study.claim_problem(claim, pid, rid, Digits.LOOSEST_CUT).limits.derivatives
    low = shortest(profile, least, loose) * (1.0 - _SLACK)
    try:
        tight = study.claim_problem(claim, pid, rid, Digits.TIGHTEST).limits.derivatives
        high = shortest(profile, most, tight) * (1.0 + _SLACK)
    except (CaseError, ZeroDivisionError):
        high = inf
    number = study.case.measured(claim.value, "time", claim.problem, rid)
    cut = number.cut_off()
    fits = min(number.lower, cut.lower) <= high and low <= max(number.upper, cut.upper)
    verdict, severity = ClaimVerdict.SUPPORTED, Severity.INFO
    said = "which fits"
    if plain == 0.0:
        verdict, said = ClaimVerdict.NOT_CHECKABLE, "and no limit that the profile uses is stated"
    elif not fits:
        verdict, severity = ClaimVerdict.INCONSISTENT, Severity.WARNING
        said = f"which is {abs(number.value / plain - 1):.2%} "
        said += "shorter" if number.value < plain else "longer"
    return Finding(
        rule="TG304",
        severity=severity,
        verdict=verdict,
        basis=Basis.CHECK,
        claim=claim.id,
        problem=pid,
        reading=rid,
        printed=f"{claim.value} {study.time_unit}",
        computed=f"{plain:.6g} s",
        message=f"The shortest {profile} profile from rest to rest, each segment as long as its "
        f"slowest joint needs, takes {plain:.6g} s; printed is {claim.value} {study.time_unit}, "
        f"{said}.",
    )
