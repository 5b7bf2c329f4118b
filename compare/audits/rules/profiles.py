"""TG304: printed totals of point-to-point profiles beside the shortest that the limits allow."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from math import cbrt, inf, pi, sqrt

import numpy as np

from ....problem import Array, CaseError, Problem
from ....problem.cases import Claim, Digits, TotalTimeClaim
from ...documents import Basis, ClaimVerdict, Finding
from ..printed_row import PrintedRow
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


def sine_jerk(way: float, velocity: float, acceleration: float, jerk: float) -> float:
    """Shortest time from rest to rest in seven phases whose jerk is a half sine on each ramp.

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

    Notes
    -----
    On a ramp of length τ the jerk is J sin(πt/τ), and the acceleration changes by ∫ = 2Jτ/π, as by
    a constant jerk of 2J/π. It is (Jτ/π)(1 − cos(πt/τ)), which with its mirror image about the
    middle of the ramp sums to the whole change, as a straight line does: velocity changes by the
    same amount over the ramp. Both profiles are mirror images about the middle of each half and of
    the whole, so that the ways are half of velocity times time in both. With phases of equal length
    they have the same peaks of velocity and acceleration and the same way. The shortest total is
    that of the S-curve within 2/π of the jerk limit.
    """
    return s_curve(way, velocity, acceleration, 2.0 / pi * jerk)


PROFILES: dict[str, Callable[[float, float, float, float], float]] = {
    "trapezoidal": trapezoidal,
    "s-curve": s_curve,
    "sine-jerk": sine_jerk,
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
    each = [
        [_time(profile, float(w), own) for w, own in zip(row, limits, strict=True)] for row in ways
    ]
    return float(np.max(each, axis=1).sum())


def shortest_straight(profile: str, ways: Array, limits: Array) -> float:
    """Shortest total where all joints follow one time law, on a straight line in each segment.

    Joint j moves by way_j·s(t) while s goes from 0 to 1 by the profile, so that the derivatives of
    s keep the smallest limit_j/way_j over the joints that move.

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
    total = 0.0
    for row in ways:
        moving = row > 0.0
        if moving.any():
            total += _time(profile, 1.0, (limits[moving] / row[moving, None]).min(axis=0))
    return total


def _time(profile: str, way: float, limits: Array) -> float:
    """Time of one segment, infinite where a joint moves that must not."""
    velocity, acceleration, jerk = map(float, limits)
    if way > 0.0 and not (velocity > 0.0 and acceleration > 0.0 and jerk > 0.0):
        return inf
    return PROFILES[profile](way, velocity, acceleration, jerk)


def judge_profiles(study: Study) -> Iterator[Finding]:
    """Findings of TG304."""
    for claim in study.claims:
        if isinstance(claim, TotalTimeClaim) and claim.profile is not None:
            for pair in study.pairs:
                if claim.problem in (None, pair.problem):
                    yield _beside(PrintedRow(study, claim, pair), claim.profile)


def _ways(row: PrintedRow[Claim], problem: Problem) -> tuple[Array, Array]:
    """Least and most that each joint moves in each segment, digits rounded or cut off."""
    box = row.waypoint_box(problem).or_cut_off()
    low, high = box.lower[1:] - box.upper[:-1], box.upper[1:] - box.lower[:-1]
    most = np.maximum(np.abs(low), np.abs(high))
    least = np.where((low <= 0) & (high >= 0), 0.0, np.minimum(np.abs(low), np.abs(high)))
    return least, most


def _beside(row: PrintedRow[TotalTimeClaim], profile: str) -> Finding:
    study, claim = row.study, row.claim
    why = _not_computed(row, profile)
    if why:
        return Finding(
            rule="TG304",
            basis=Basis.CHECK,
            claim=claim.id,
            problem=row.problem,
            reading=row.reading,
            kind="other profile",
            sentences=(why,),
        )
    straight = claim.path == "straight"
    plain, fits = _fitted(row, profile, straight)
    number = row.time(claim.value)
    verdict, kind, said = ClaimVerdict.SUPPORTED, "fits", "which fits"
    if plain == 0.0:
        verdict, kind, said = ClaimVerdict.NOT_CHECKABLE, "at rest", "and no joint moves"
    elif plain == inf:
        verdict, kind = ClaimVerdict.NOT_CHECKABLE, "limit 0"
        said = "and a joint moves whose limit is 0"
    elif not fits and not straight and _fitted(row, profile, True)[1]:
        verdict, kind = ClaimVerdict.NOT_CHECKABLE, "straight"
        said = 'which fits where the joints stay on a straight line: path = "straight" if they do'
    elif not fits:
        verdict, kind = ClaimVerdict.INCONSISTENT, "other total"
        said = f"which is {100 * abs(number.value / plain - 1):.2f} % "
        said += "shorter" if number.value < plain else "longer"
    return Finding(
        rule="TG304",
        verdict=verdict,
        basis=Basis.CHECK,
        claim=claim.id,
        problem=row.problem,
        reading=row.reading,
        printed=f"{claim.value} {study.time_unit}",
        computed=f"{plain:.6g} s",
        kind=kind,
        sentences=(
            f"The shortest {profile} profile from rest to rest, {_PATHS[straight]}, takes "
            f"{plain:.6g} s; printed is {claim.value} {study.time_unit}, {said}.",
        ),
    )


def _not_computed(row: PrintedRow[TotalTimeClaim], profile: str) -> str | None:
    """Why the profile of a problem is none of those computed here, as a sentence; None if it is."""
    problem = row.posed()
    if problem.limits.uneven:
        return (
            f"The lower and upper limits differ; the {profile} profile is computed within limits "
            "of equal size only."
        )
    if not row.statement.declaration.at_rest:
        return (
            "The case file gives derivatives other than 0 at the ends of the motion; the "
            f"{profile} profile is computed from rest to rest only."
        )
    return None


_PATHS = {
    False: "each segment as long as its slowest joint needs",
    True: "all joints on a straight line in each segment",
}
"""How the joints go together, by whether they stay on a straight line."""


def _fitted(row: PrintedRow[TotalTimeClaim], profile: str, straight: bool) -> tuple[float, bool]:
    """The shortest total at the printed numbers, and whether the printed one fits its interval."""
    total = shortest_straight if straight else shortest
    problem = row.posed()
    ways = np.abs(np.diff(problem.waypoints, axis=0))
    plain = total(profile, ways, problem.limits.derivatives)
    least, most = _ways(row, problem)
    loose = row.posed(Digits.LOOSEST_CUT).limits.derivatives
    low = total(profile, least, loose) * (1.0 - _SLACK)
    try:
        tight = row.posed(Digits.TIGHTEST).limits.derivatives
        high = total(profile, most, tight) * (1.0 + _SLACK)
    except CaseError:
        high = inf
    number = row.time(row.claim.value)
    cut = number.cut_off()
    return plain, cut.lower <= high and low <= cut.upper
