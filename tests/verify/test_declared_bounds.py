"""The bound for declared curves against sums of limits in rationals, and against answers."""

from dataclasses import replace
from fractions import Fraction
from math import inf
from typing import Any

import numpy as np
import pytest
from support.declared_curves import CURVES, drawn
from trajgap.nlp.optimum import solve
from trajgap.nlp.proofs.document import problem_document
from trajgap.nlp.proofs.exact import exact_problem
from trajgap.problem import Interpolant, Limits, Problem, piecewise, three_five_three
from trajgap.verify import PLACES, Clock, proof_kind, read_problem
from trajgap.verify.curve import derivative, pieces, value_at


def kind_of(problem: Problem, total: Fraction, proof: dict[str, Any] | None = None) -> Any:
    stated = read_problem(problem_document(exact_problem(problem)))
    given = {"rows": [], "tree": []} if proof is None else proof
    return proof_kind("declared")(stated, given, total, Clock(inf))


def exact_sum(problem: Problem, kind: Any, h: list[Fraction], leaf: Any, centre: Any) -> Fraction:
    """F at durations in rationals, by the verifier's own elimination for an answer."""
    tau, rows, weights = leaf
    stated = read_problem(problem_document(exact_problem(problem)))
    own = pieces(stated, h, Clock(inf))
    value = Fraction(tau) * (sum(h) / kind.total - 1)
    for (k, j, order, sign, place), weight in zip(rows.tolist(), weights.tolist(), strict=True):
        at = value_at(derivative(own[j][k], order), Fraction(place, PLACES)) / h[k] ** order
        if order == 0:
            ends = stated.position[(1 + sign) // 2][j]
            far = max(abs(row[j] - stated.waypoints[0][j]) for row in stated.waypoints)
            unit = Fraction(2) ** (far.numerator.bit_length() - far.denominator.bit_length())
            value += Fraction(weight) * (sign * at - sign * ends[0]) / unit
            continue
        size = stated.sides[(1 + sign) // 2][j][order - 1][0]
        scale = (h[k] / (Fraction(centre[k]) * kind.second)) ** order
        value += Fraction(weight) * (sign * at / size - 1) * scale
    return value


@pytest.mark.parametrize("name", CURVES)
def test_the_bound_is_below_the_exact_sum_all_over_a_box(name: str) -> None:
    rng = np.random.default_rng(sum(map(ord, name)))
    narrowest, judged_boxes = inf, 0
    for trial in range(8):
        problem = drawn(name, rng, 1 + trial % 3)
        n, joints = problem.segments, problem.limits.joints
        middle = rng.uniform(0.5, 2.0, n)
        kind = kind_of(problem, Fraction(float(middle.sum() * rng.uniform(0.9, 1.1))))
        e = 10.0 ** rng.uniform(-4.0, -0.8) * rng.uniform(0.3, 1.0, n)
        own = middle / float(kind.second)
        rows = np.array(
            [[rng.integers(n), rng.integers(joints), rng.integers(4), rng.choice((-1, 1)),
              rng.integers(PLACES + 1)] for _ in range(7)]
        )  # fmt: skip
        rows[0, 4], rows[1, 4] = 0, PLACES
        weights, tau = rng.uniform(0.0, 1.0, 7), float(rng.normal())
        centre = kind.centre(np.array([[own * np.exp(-e), own * np.exp(e)]]))
        least = float(centre.least(np.array([tau]), rows[None], weights[None])[0])
        if not np.isfinite(least):
            continue
        judged_boxes += 1
        for spot in range(5):
            way = rng.choice((-1.0, 1.0), n) if spot % 2 else rng.uniform(-1.0, 1.0, n)
            h = [Fraction(float(x)) * kind.second for x in own * np.exp(e * way * (1 - 1e-9))]
            value = exact_sum(problem, kind, h, (tau, rows, weights), centre.h[0])
            assert value >= Fraction(least), (trial, spot)
            if e.max() < 1e-3:
                narrowest = min(narrowest, float(value) - least)
    assert judged_boxes >= 4
    # And it is worth something: in a narrow box little is lost.
    assert narrowest < 0.1


def test_a_box_that_the_tail_cannot_hold_is_not_bounded() -> None:
    problem = drawn("3-5-3", np.random.default_rng(2), 1)
    kind = kind_of(problem, Fraction(4))
    for low, high in ((0.01, 3.9), (0.0, 0.1), (1e-10, 2e-10), (0.4, 0.3)):
        sides = np.array([[[low] * 3, [high] * 3]])
        with np.errstate(all="ignore"):
            centre = kind.centre(sides)
            row = np.array([[[0, 0, 1, 1, 5]]])
            least = centre.least(np.array([0.0]), row, np.array([[1.0]]))
        assert least[0] == -inf


LEAST = ("3-5-3", "4-3-4", "4-3-3-4", "rest inside", "clamped cubic, moving", "one piece, moving")


@pytest.mark.parametrize("name", LEAST)
def test_no_feasible_answer_has_a_duration_below_the_least_one(name: str) -> None:
    rng = np.random.default_rng(3 + len(name))
    for joints in (1, 2):
        problem = drawn(name, rng, joints)
        for drop in ((0, 1), (0, 2)):
            below, above = problem.limits.sides
            both = np.stack([-below.T, above.T], axis=2)
            both[list(drop)] *= inf
            one = replace(problem, limits=Limits(*both), duration_lower=0.01)
            h = solve(one).durations
            assert h is not None
            held(one, h)


@pytest.mark.parametrize(
    "orders", [(1, 2), *(pytest.param(o, marks=pytest.mark.slow) for o in ((2,), (1, 3), (3,)))]
)
def test_a_joint_that_comes_back_takes_its_time(orders: tuple[int, ...]) -> None:
    """Its velocity where it enters the middle piece follows from the first or the last one."""
    rng = np.random.default_rng([4, *orders])
    curves = (three_five_three(), piecewise((3, 5, 3), ends=((1, -0.25), (2, 0.0))))
    for trial in range(6):
        q = rng.normal(0.3, 1.0, (4, 2))
        q[2] = q[1]
        sizes = [rng.uniform(0.5, 2.0, 2) * 2**r if r in orders else inf for r in (1, 2, 3)]
        one = Problem(q, Limits(*sizes, joints=2), curves[trial % 2])
        h = solve(one).durations
        if h is not None:
            least = held(one, h)
            # In motion, the first piece hangs on its duration, and so does what follows from it.
            assert (least[1] == 0.0) if trial % 2 else (least[1] > 1e-2 * h[1])


@pytest.mark.parametrize("acceleration", [1.0, -1.0])
def test_velocity_and_acceleration_of_two_ends_are_no_pair(acceleration: float) -> None:
    """At its end the acceleration is free: nothing says that it carries the velocity on."""
    start, finish = ((1, 0.0), (2, acceleration), (3, 0.0)), ((1, 0.5),)
    curve = Interpolant((5,), (), (start, finish), name="unlike ends")
    limits = Limits([inf], inf, 40.0)
    assert kind_of(Problem([[0.0], [0.0]], limits, curve), Fraction(2)).shortest == [0.0]
    # Where it is prescribed, a joint that comes back needs that time.
    finish = ((1, 0.5), (2, -0.25))
    curve = Interpolant((5,), (), (((1, 0.0), (2, acceleration)), finish), name="alike")
    found = kind_of(Problem([[0.0], [0.0]], limits, curve), Fraction(2))
    assert found.shortest[0] * float(found.second) == pytest.approx((6 * 0.5 / 40) ** 0.5)


def held(problem: Problem, h: Any) -> list[float]:
    """Least durations in seconds, none of which is above that of an answer."""
    kind = kind_of(problem, Fraction(float(h.sum()) * (1 + 1e-9)))
    found = [x * float(kind.second) for x in kind.shortest]
    assert all(x <= y * (1 + 1e-7) for x, y in zip(found, h, strict=True))
    return found
