"""Peaks and jumps of a printed motion; printed peaks beside them, and TG209: beside limits."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from ....problem import (
    QUANTITIES,
    Array,
    Extremum,
    Jump,
    Printed,
    Trajectory,
    extrema,
    fit,
    peak_gradients,
)
from ....problem.cases import AnyClaim, Claim, Digits, PeakClaim, StatementClaim, motions_of
from ...documents import Basis, ClaimVerdict, Finding, Severity
from ..printed_row import PrintedRow, printed_rows
from ..rounding import ROUNDING, Agreement
from ..stated import DERIVATIVES, place
from ..study import Study
from ..words import percent
from .beside import SAMPLES, Beside, Look, largest_change, split
from .rule_group import Explained, rule_group

_PHASES = 8
"""Offsets at which those samples are tried: the worst of so many comes near the worst of all."""
_NORM_PLACES = 65
"""Places of a piece at which the norm is computed before the largest is refined, where it is no
polynomial in time: many for a curve that turns a few times."""
_Jump = tuple[PrintedRow[Claim], Jump]
"""A jump with the row whose motion it is of."""


def box_reach(row: PrintedRow[Claim], point: Extremum) -> float:
    """First-order change of an extremum over the rounding box."""
    return _reach(row, [point], np.ones(1))


def _reach(row: PrintedRow[Claim], points: list[Extremum], share: Array) -> float:
    """First-order change of a sum of extrema, each times its share, over the rounding box."""
    durations, waypoints = row.boxes
    g = peak_gradients(row.posed(), durations.value, points)
    half = (waypoints.upper - waypoints.lower).T[[point.joint for point in points]] / 2
    by_time = np.abs(share @ g.durations) @ (durations.upper - durations.lower) / 2
    return float(by_time + np.sum(np.abs(share[:, None] * g.waypoints) * half))


def farthest(row: PrintedRow[AnyClaim], top: Extremum, alone: bool, share: float) -> float:
    """Largest change of a peak that is found in the rounding box, in SI units.

    Parameters
    ----------
    top : Extremum
        The peak at the printed numbers.
    alone : bool
        Whether it is that of its own joint, and not of all.
    share : float
        How wide the box is, see `largest_change`.
    """
    problem = row.posed()
    joints = [top.joint] if alone else range(len(problem.joints))

    def look(at: Array, low: Array, high: Array) -> Look:
        q, h = split(at, row.boxes)
        moved = fit(problem.curve, q, h)
        ends = (e for j in joints for e in extrema(moved, j, top.order))
        here = max(ends, key=lambda e: abs(e.value))
        g = peak_gradients(replace(problem, waypoints=q), h, [here])
        by_angle = np.zeros_like(q)
        by_angle[:, here.joint] = g.waypoints[0]
        slopes = np.sign(here.value) * np.append(g.durations[0], by_angle)
        return Look(abs(here.value), slopes * (low - at), slopes * (high - at))

    return largest_change(row.boxes, share, look)


def largest(row: PrintedRow[Claim], order: int) -> list[Extremum]:
    """Largest extremum of each joint of the claim's problem, at the printed point."""

    def compute() -> list[Extremum]:
        motion = row.motion
        return [
            max(extrema(motion, j, order), key=lambda e: abs(e.value)) for j in range(motion.joints)
        ]

    return row.once("largest", compute, order)


def peak_beside(
    row: PrintedRow[AnyClaim], claim: PeakClaim, printed: Printed, joint: str | None
) -> Beside | None:
    """A printed peak set beside the exact one of a motion.

    It is None if the joint is not in that motion, or where the motion has no curve.

    Parameters
    ----------
    joint : str or None
        Label of the joint; the largest over all joints if None.
    """
    problem = row.posed()
    if not row.has_curve or (joint is not None and joint not in problem.joints):
        return None
    order = QUANTITIES.index(claim.derivative) + 1
    tops = largest(row, order)
    if joint is not None:
        tops = [tops[problem.joints.index(joint)]]
    top = max(tops, key=lambda e: abs(e.value))
    measured = row.measured(printed, claim.derivative, joint)
    samples, cut = _samples(row, order), measured.cut_off()

    def shown(*values: float) -> Iterator[float]:
        return (row.in_units(claim.derivative, value, joint) for value in values)

    low, high, lowest, highest = shown(measured.lower, measured.upper, cut.lower, cut.upper)

    def of(*numbers: float) -> Beside:
        exact, reach, far, least = shown(*numbers)
        return Beside(
            printed=printed,
            rounded=(low, high),
            wide=(lowest, highest),
            exact=exact,
            reach=reach,
            far=far,
            sampled=(least, exact),
            unit=row.unit(claim.derivative, joint),
            joint=joint,
            linear=problem.linear[top.joint],
        )

    exact, reach = abs(top.value), box_reach(row, top)
    least = min(float((v if joint is None else v[:, top.joint]).max()) for v in samples)
    found = of(exact, reach, 2 * reach, least)
    if not found.fits:
        near, far = (farthest(row, top, joint is not None, share) for share in (1.0, 2.0))
        found = of(exact, max(reach, near), max(2 * reach, far), least)
    if joint is not None or len(tops) == 1 or found.fits:
        return found
    whole, reach = largest_norm(row, order)
    least = min(float(np.linalg.norm(v, axis=1).max()) for v in samples)
    return replace(found, norm=of(whole, reach, 2 * reach, least))


def _samples(row: PrintedRow[AnyClaim], order: int) -> list[Array]:
    """Absolute values at evenly spaced times, for each offset that these may have."""

    def compute() -> list[Array]:
        step = float(row.durations.value.sum()) / SAMPLES[0]
        offsets = np.arange(_PHASES)[:, None] / _PHASES
        times = (np.arange(SAMPLES[0]) + offsets) * step
        found = np.abs(row.motion(times.ravel(), order))
        return list(found.reshape(_PHASES, SAMPLES[0], -1))

    return row.once("samples", compute, order)


def largest_norm(row: PrintedRow[Claim], order: int) -> tuple[float, float]:
    """Largest norm of a derivative over the joints, and its first-order change by rounding.

    It is the true maximum where pieces are polynomials in time, else the largest of `_NORM_PLACES`
    values a piece, refined.
    """
    motion = row.motion
    top, piece, s = max(_norm_top(motion, k, order) for k in range(len(motion.durations)))
    values = _norm_values(motion, piece, order, np.array([s]))[:, 0]
    points = [Extremum(j, piece, order, s, 0.0, float(v)) for j, v in enumerate(values)]
    # The norm's gradient weighs each joint's by its share; at the top its place does not count.
    share = values / top if top else np.zeros_like(values)
    return top, _reach(row, points, share)


def _norm_values(trajectory: Trajectory, piece: int, order: int, places: Array) -> Array:
    """A derivative at places of a piece, one row per joint."""
    each = [trajectory.values(piece, j, order, places) for j in range(trajectory.joints)]
    return np.asarray(each, dtype=np.float64)


def _norm_top(trajectory: Trajectory, piece: int, order: int) -> tuple[float, int, float]:
    """Largest norm on a piece, and where it is."""

    def norm(places: Array) -> Array:
        found = np.linalg.norm(_norm_values(trajectory, piece, order, places), axis=0)
        return np.asarray(found, dtype=np.float64)

    if trajectory.polynomial_in_time:
        places = _turning(trajectory, piece, order)
    else:
        places = np.linspace(0.0, 1.0, _NORM_PLACES)
        k = int(norm(places).argmax())
        around = (places[max(k - 1, 0)], places[min(k + 1, _NORM_PLACES - 1)])
        from scipy.optimize import minimize_scalar  # a quarter of a second, and few need it

        best = minimize_scalar(lambda s: -float(norm(np.array([s]))[0]), bounds=around)
        places = np.append(places, best.x)
    values = norm(places)
    k = int(values.argmax())
    return float(values[k]), piece, float(places[k])


def _turning(trajectory: Trajectory, piece: int, order: int) -> Array:
    """Both ends, and every place where the norm can turn: roots of the derivative of its square.

    The square Σ_j q_j² is a polynomial. Real parts of all roots, because rounding moves double ones
    off the axis; a place too many changes no largest value.
    """
    square = np.polynomial.Polynomial([0.0])
    for joint in range(trajectory.joints):
        square += np.polynomial.Polynomial(trajectory.derivative(piece, joint, order)) ** 2
    turns = np.clip(square.deriv().roots().real, 0.0, 1.0)
    return np.concatenate([[0.0, 1.0], turns])


def peak_described(row: PrintedRow[AnyClaim], claim: PeakClaim, one: Beside) -> str:
    """One printed peak beside the exact one, with the class of their distance."""
    whose = "" if one.joint is None else f"joint {one.joint}: "
    exact = one.around
    said = f"{whose}the exact peak of {claim.derivative} is {exact}, printed as {one.printed}"
    room = ""
    # What fits where digits leave more than 5 % of room tells little.
    if one.exact and one.reach > 0.05 * one.exact:
        room = f", which allows {percent(one.reach / one.exact, '.2g')} either way"
    norm = "" if one.norm is None else _of_norm(one.norm)
    away = percent(one.distance, "+.2g")
    return (
        said
        + {
            Agreement.ROUNDING: f", equal within the rounding of the printed digits{room}",
            Agreement.CUT_OFF: f" ({away}), which fits if digits were cut off instead of rounded",
            Agreement.SAMPLING: f" ({away}), slightly below it, as sampling the motion would give",
            Agreement.NORM: f" ({away}), {norm}",
            Agreement.UNIT: f" ({away}); their ratio is near {one.factor}",
            Agreement.ROOT: f" ({away}); a factor √{one.root} may have been lost in print",
            Agreement.OFF: f" ({away})",
        }[one.kind]
    )


def _of_norm(one: Beside) -> str:
    """How a printed peak that is not that of a joint is the norm over the joints."""
    norm = f"the largest norm over the joints, {one.around}"
    return {
        Agreement.CUT_OFF: f"which fits {norm}, if digits were cut off instead of rounded",
        Agreement.SAMPLING: f"slightly below {norm}, as sampling the motion would give",
    }.get(one.kind, f"equal to {norm}, within rounding")


def largest_of_each_kind(jumps: Sequence[_Jump]) -> list[_Jump]:
    """The largest jump of joints that turn and that of joints that slide, if there are any.

    The kind of the first one stands first.
    """
    found: dict[bool, _Jump] = {}
    for row, jump in jumps:
        statement = row.statement
        linear = statement.linear[statement.labels.index(jump.joint)]
        if linear not in found or abs(jump.size) > abs(found[linear][1].size):
            found[linear] = row, jump
    return list(found.values())


def jump_shown(row: PrintedRow[Claim], jump: Jump, form: str = ".6g") -> str:
    """Size of a jump as a sentence writes it."""
    return row.shown(DERIVATIVES[jump.order], jump.size, jump.joint, form)


def jumps_shown(jumps: Sequence[_Jump], form: str = ".6g") -> list[str]:
    """Sizes of the largest jump of each kind of joints, without their signs."""
    largest_ones = largest_of_each_kind(jumps)
    return [jump_shown(row, jump, form).removeprefix("-") for row, jump in largest_ones]


TG209 = Explained(
    "TG209",
    "Printed peaks lie within the limits that the text calls kept",
    "Does a printed peak exceed the limit that its motion is said to keep?",
    "Inconsistent if the peak exceeds the limit however the digits of both were rounded, "
    "rounded up or cut off. A number for several joints at once may be a norm and is not "
    "compared.",
    "A table prints 3.665 rad/s² for the acceleration of joint 2, another the limit 3.6, and "
    "the abstract says that no limit is exceeded.",
    basis=Basis.DIGITS,
)


@rule_group(TG209)
def judge_peak_limits(study: Study) -> Iterator[Finding]:
    """Findings of TG209."""
    for claim in study.statements("within_limits"):
        for peak in study.claims:
            if isinstance(peak, PeakClaim):
                yield from _beyond(study, claim, peak)


def _beyond(study: Study, claim: StatementClaim, peak: PeakClaim) -> Iterator[Finding]:
    for motion in motions_of(study.case.claims, peak):
        if claim.of and motion.id not in claim.of:
            continue
        for row in printed_rows(study, motion):
            said = _above(row, peak)
            if said:
                yield TG209.finding(
                    row,
                    "beyond",
                    f"{place(peak)} prints {'; '.join(said)}.",
                    severity=Severity.ERROR,
                    verdict=ClaimVerdict.INCONSISTENT,
                    claim=claim.id,
                    printed=", ".join(map(str, peak.printed)),
                    root=f"peaks beyond limits {claim.id}",
                    between=(claim.id, peak.id),
                )


def _above(row: PrintedRow[AnyClaim], peak: PeakClaim) -> list[str]:
    """Printed peaks beyond their limits, whatever was rounded, raised or cut off in either.

    A number for several joints at once may be the norm over them, which no limit bounds.
    """
    loosest = row.posed(Digits.LOOSEST_CUT)
    order = QUANTITIES.index(peak.derivative)
    found = []
    for joint, number in row.study.printed_numbers(peak):
        if joint is None and len(loosest.joints) > 1:
            continue
        j = 0 if joint is None else loosest.joints.index(joint) if joint in loosest.joints else None
        if j is None:
            continue
        limit = float(loosest.limits.sides[:, j, order].max())
        label = loosest.joints[j]
        measured = row.measured(number, peak.derivative, label)
        least = measured.value - (measured.upper - measured.lower)
        if np.isfinite(limit) and least > limit * (1.0 + ROUNDING):
            unit, shown = row.unit(peak.derivative, label), row.shown(peak.derivative, limit, label)
            found.append(
                f"{number} {unit} for the {peak.derivative} of joint {label}, whose "
                f"limit is at most {shown}, however its digits are read"
            )
    return found
