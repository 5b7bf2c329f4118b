"""Every kind of limit × every derivative × every identity, beside exact rational arithmetic.

`support.exact_route` fits the curve in fractions and finds its extremes. A limit a
millionth above or below such an extreme decides what each judge has to answer: `check`,
`evaluate`, `keeps_limits`, `check_motion`, and the repairs that they state.
"""

from dataclasses import dataclass, replace
from functools import cache

import numpy as np
import pytest
from scipy.interpolate import PPoly
from support import exact_route
from support.positions import position_ratios
from support.same_question import DRESSES, same_question
from support.samples import DECLARATIONS, sample_problem
from trajgap.problem import (
    QUANTITIES,
    Array,
    Check,
    Limits,
    Problem,
    Verdict,
    check,
    evaluate,
    keeps_limits,
)
from trajgap.problem.motions import BRAKING, JointLimits, Motion, check_motion

CURVES = ("3-5-3", "cubic", "cubic, moving ends", "cubic, virtual", "quintic", "rest 5", "uneven")
ORDERS = ("position", *QUANTITIES)
SNAP = 4
"""Limits of it are those of problems alone."""
ROOM = 1e-6
"""Relative distance of a limit from the exact extreme: far above rounding, below all else."""
KINDS = ("even", "only below", "only above", "tight below", "tight above")
JOINT = 2
"""The limited joint, of three."""


@dataclass(frozen=True)
class Exact:
    """A motion in fractions: its least and largest values, shape (orders, joints, 2)."""

    problem: Problem
    durations: Array
    pieces: tuple[list[list[exact_route.Fraction]], ...]
    ends: Array


@cache
def exact(curve: str) -> Exact:
    """One motion of each curve, of three joints with offsets and unequal sizes."""
    problem, h = sample_problem(DECLARATIONS[curve], 17 + len(curve), limits=Limits(joints=3))
    lengths = h.tolist()
    pieces = tuple(
        exact_route.fitted(problem.piecewise, q.tolist(), lengths) for q in problem.waypoints.T
    )
    ends = [[exact_route.extremes(one, lengths, r) for one in pieces] for r in range(5)]
    return Exact(problem, h, pieces, np.array(ends, dtype=np.float64))


def ranges(kind: str, ends: Array, order: int, sign: float) -> tuple[float, float]:
    """A range that is exceeded by `ROOM` where ``sign`` is −1, and kept with `ROOM` where it is 1.

    Of a position the room is a share of the path's width.
    """
    least, most = ends
    if order == 0:
        move = ROOM * (most - least)
        low, high, far = least - sign * move, most + sign * move, 3.0 * (most - least)
        return {
            "even": (low, high),
            "only below": (low, np.inf),
            "only above": (-np.inf, high),
            "tight below": (low, most + far),
            "tight above": (least - far, high),
        }[kind]
    low, high = least * (1 + sign * ROOM), most * (1 + sign * ROOM)
    size = max(-low, high)
    return {
        "even": (-size, size),
        "only below": (min(low, 0.0), np.inf),
        "only above": (-np.inf, max(high, 0.0)),
        "tight below": (min(low, 0.0), 3.0 * size),
        "tight above": (-3.0 * size, max(high, 0.0)),
    }[kind]


def limited(problem: Problem, order: int, low: float, high: float) -> Problem:
    """The problem with one range of one derivative of one joint."""
    if order == 0:
        lower, upper = np.full(3, -np.inf), np.full(3, np.inf)
        lower[JOINT], upper[JOINT] = low, high
        return replace(problem, limits=problem.limits.with_positions(lower, upper))
    sides = np.full((2, 3, max(3, order)), np.inf)
    sides[:, JOINT, order - 1] = -low, high
    return replace(problem, limits=problem.limits.with_sides(sides))


def exact_ratio(ends: Array, order: int, low: float, high: float) -> float:
    """What `Peak.ratio` and `Evaluation` say by definition."""
    least, most = ends
    if order == 0:
        return float(position_ratios(ends[None], np.array([low]), np.array([high]))[0])
    below = max(0.0, -least) / -low if low else 0.0
    above = max(0.0, most) / high if high else 0.0
    return max(below, above)


@pytest.mark.parametrize("dress", DRESSES)
@pytest.mark.parametrize("order", range(5), ids=ORDERS)
@pytest.mark.parametrize("curve", CURVES)
def test_every_judge_says_what_exact_arithmetic_says(curve: str, order: int, dress: str) -> None:
    truth = exact(curve)
    ends = truth.ends[order, JOINT]
    # Of a question in another dress some ranges are enough.
    for kind in KINDS if dress in ("as it is", "mirror") else KINDS[::2]:
        for sign, expected in ((1.0, Verdict.PASS), (-1.0, Verdict.VIOLATED)):
            low, high = ranges(kind, ends, order, sign)
            # A side on which nothing moves is kept at any size.
            beyond = ends[0] < low or ends[1] > high
            assert beyond == (expected is Verdict.VIOLATED) or 0.0 in (low, high)
            expected = Verdict.VIOLATED if beyond else Verdict.PASS
            ratio = exact_ratio(ends, order, low, high)
            plain = limited(truth.problem, order, low, high)
            problem, h = same_question(dress, plain, truth.durations)
            found = check(problem, h)
            assert found.limits is expected, (kind, sign)
            near = pytest.approx(ratio, rel=1e-9, abs=1e-9)
            worst = max(p.ratio for p in found.peaks)
            if order or np.isfinite(high - low) or dress != "degrees":
                # A position limit on one side is set beside 1 rad, whatever the unit.
                assert worst == near, (kind, sign)
            found_batch = evaluate(problem, np.stack([h, 2.0 * h]))
            batch = found_batch.positions if order == 0 else found_batch.ratios[:, :, order - 1]
            assert batch[0].max() == pytest.approx(worst, rel=1e-9, abs=1e-9)
            assert keeps_limits(problem, h[None], 1e-9)[0] == (not beyond)
            _repair(problem, h, order, ratio, found, beyond)
            assert found.stretch == pytest.approx(found_batch.stretch[0], rel=1e-9)
            _as_motion(truth, dress, order, (low, high), ratio, expected)


def _repair(
    problem: Problem, h: Array, order: int, ratio: float, found: Check, beyond: bool
) -> None:
    """The stretch that exact arithmetic asks for, and no repair where none exists."""
    if order == 0:
        assert found.stretch == 0.0
        assert (found.feasible_time is None) == beyond
        assert not beyond or "stretching does not change the path" in str(found.feasible_why)
        return
    stretch = ratio ** (1.0 / order)
    assert found.stretch == pytest.approx(stretch, rel=1e-9)
    if any(jump.order == SNAP - 1 for jump in found.jumps):
        assert found.feasible_time is None is found.tight_time
        assert "jumps at a break, which stretching does not repair" in str(found.feasible_why)
    elif not problem.curve.homogeneous:
        assert (found.feasible_time is None) == beyond
        assert found.tight_time is None
        assert not beyond or "a prescribed end derivative is not 0" in str(found.feasible_why)
    else:
        assert found.feasible_time == pytest.approx(max(1.0, stretch) * h.sum(), rel=1e-9)
        if stretch:
            assert found.tight_time == pytest.approx(stretch * h.sum(), rel=1e-9)
            tight = check(problem, stretch * (1 + 1e-9) * h)
            assert tight.verdict in (Verdict.PASS, Verdict.DISCONTINUOUS)


def polynomials(truth: Exact) -> PPoly:
    """The motion in fractions, rounded once."""
    powers = max(len(p) for one in truth.pieces for p in one)
    c = np.zeros((powers, len(truth.durations), 3))
    for j, one in enumerate(truth.pieces):
        for k, p in enumerate(one):
            c[powers - len(p) :, k, j] = [float(x) for x in reversed(p)]
    return PPoly(c, np.concatenate([[0.0], np.cumsum(truth.durations)]))


def _as_motion(
    truth: Exact, dress: str, order: int, ends: tuple[float, float], ratio: float, expected: Verdict
) -> None:
    """The judge of motions from elsewhere, about the same polynomials."""
    if dress not in ("as it is", "mirror") or order == SNAP:
        return
    lower, upper = np.full((3, 4), -np.inf), np.full((3, 4), np.inf)
    lower[JOINT, order], upper[JOINT, order] = ends
    motion = polynomials(truth)
    if dress == "mirror":
        motion, (lower, upper) = PPoly(-motion.c, motion.x), (-upper, -lower)
    limits = JointLimits(("1", "2", "3"), lower, upper, np.full(3, np.inf))
    found = check_motion(Motion.of_polynomial(motion), limits, 1e-9)
    assert found.limits is expected
    (peak,) = found.peaks
    assert peak.ratio == pytest.approx(ratio, rel=1e-8, abs=1e-8)
    assert peak.least_ratio <= peak.ratio <= peak.most_ratio
    if not order:
        assert (found.feasible_time is None) == (expected is Verdict.VIOLATED)
    elif ratio > 1.0:
        assert found.stretch == pytest.approx(ratio ** (1.0 / order), rel=1e-8)


@pytest.mark.parametrize("mirror", [1.0, -1.0])
@pytest.mark.parametrize("curve", [c for c in CURVES if c != "uneven"])
def test_braking_and_speeding_up_are_told_apart(curve: str, mirror: float) -> None:
    truth = exact(curve)
    sizes = [float(x) for x in exact_route.braking(truth.pieces[JOINT], truth.durations.tolist())]
    polynomial = polynomials(truth)
    motion = Motion.of_polynomial(PPoly(mirror * polynomial.c, polynomial.x))
    assert sizes[0] != pytest.approx(sizes[1], rel=1e-3) or "rest" in curve or "virtual" in curve
    for which, word in enumerate(("acceleration", BRAKING)):
        for sign in (1.0, -1.0):
            given = [np.full(3, np.inf), np.full(3, np.inf)]
            given[which][JOINT] = sizes[which] * (1 + sign * ROOM)
            given[1 - which][JOINT] = 3.0 * max(sizes)
            names = ("1", "2", "3")
            limits = JointLimits.from_values(names, acceleration=given[0], deceleration=given[1])
            found = check_motion(motion, limits, 1e-9)
            assert found.limits is (Verdict.PASS if sign > 0 else Verdict.VIOLATED)
            peaks = {p.quantity: p for p in found.peaks}
            assert peaks[word].ratio == pytest.approx(1 / (1 + sign * ROOM), rel=1e-8)
            assert abs(peaks[word].value) == pytest.approx(sizes[which], rel=1e-8)
            assert peaks[word].value / peaks[word].limit > 0.0
            if sign < 0:
                assert found.stretch == pytest.approx((1 - ROOM) ** -0.5, rel=1e-8)
            own = Limits(acceleration=given[0], deceleration=given[1])
            posed, h = replace(truth.problem, limits=own), truth.durations
            own_check, batch = check(posed, h), evaluate(posed, h[None])
            assert own_check.limits is found.limits
            ratios = {p.quantity: p.ratio for p in own_check.peaks}
            assert ratios[word] == pytest.approx(1 / (1 + sign * ROOM), rel=1e-8)
            assert batch.ratios[0, JOINT, 1] == pytest.approx(max(ratios.values()), rel=1e-9)
            assert batch.stretch[0] == pytest.approx(own_check.stretch, rel=1e-9)
            assert keeps_limits(posed, h[None], 1e-9)[0] == (sign > 0)


@pytest.mark.parametrize("order", range(5), ids=ORDERS)
@pytest.mark.parametrize("moves", [False, True])
def test_a_range_of_no_width_is_kept_by_standing_alone(order: int, moves: bool) -> None:
    curves = ("3-5-3", "cubic", "cubic, virtual", "rest 5", "quintic")
    for curve in curves[-1:] if order == SNAP else curves:  # the jerk of the others jumps
        truth = exact(curve)
        q = truth.problem.waypoints.copy()
        place = 61.7
        q[:, JOINT] = place + (1e-3 * np.arange(len(q)) if moves else 0.0)
        low = high = place if order == 0 else 0.0
        still = limited(replace(truth.problem, waypoints=q), order, low, high)
        found, h = check(still, truth.durations), truth.durations[None]
        assert found.limits is (Verdict.VIOLATED if moves else Verdict.PASS)
        assert keeps_limits(still, h, 1e-9)[0] == (not moves)
        worst = np.inf if moves else 0.0
        batch = evaluate(still, h)
        assert (batch.positions if order == 0 else batch.ratios[:, :, order - 1]).max() == worst
        assert (found.feasible_time is None) == moves
        if moves and order:
            assert "a joint with limit 0 moves" in str(found.feasible_why)
        if order == SNAP:
            continue
        lower, upper = np.full((3, 4), -np.inf), np.full((3, 4), np.inf)
        lower[JOINT, order], upper[JOINT, order] = low, high
        limits = JointLimits(("1", "2", "3"), lower, upper, np.full(3, np.inf))
        h = truth.durations.tolist()
        pieces = [exact_route.fitted(still.piecewise, one.tolist(), h) for one in q.T]
        motion = polynomials(Exact(still, truth.durations, tuple(pieces), truth.ends))
        judged = check_motion(Motion.of_polynomial(motion), limits).limits
        # Rounding of a foreign motion's positions is never below a range of no width.
        kept = Verdict.UNDECIDED if order == 0 else Verdict.PASS
        assert judged is (Verdict.VIOLATED if moves else kept)
