"""Way-points that nearly coincide: a second optimum lies decades away in one duration."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from support.near_problems import NEAR
from trajgap.nlp import Status
from trajgap.nlp.optimum import solve
from trajgap.nlp.optimum.basins import short_ways, shortened
from trajgap.problem import (
    Array,
    Interpolant,
    Limits,
    Problem,
    Verdict,
    check,
    cubic_spline,
    cubic_spline_virtual,
    rest_to_rest,
    three_five_three,
)

FOUND = ("three joints", "one joint", "twice", "entering")
MISSED = ("a four thousandth", "billionths", "natural", "two near", "boxed")
"""Of these a search once gave longer durations, and called them converged."""
ONE_JOINT, ENTERING = NEAR["one joint"][0], NEAR["entering"][0]
ROUNDED = 1 + 1e-9
"""Two searches that end in one optimum differ by rounding."""


@pytest.mark.parametrize(
    ("name", "seed"),
    [
        *((name, 0) for name in (*FOUND, *MISSED)),
        *(pytest.param(name, k, marks=pytest.mark.slow) for name in FOUND for k in (1, 2, 3)),
    ],
)
def test_no_answer_is_worse_than_a_motion_that_passes(name: str, seed: int) -> None:
    problem, h = NEAR[name]
    assert check(problem, h).verdict is Verdict.PASS
    solution = solve(problem, seed=seed)
    assert solution.status is Status.CONVERGED or seed > 0 or name == "a four thousandth"
    assert solution.best <= h.sum() * ROUNDED
    assert check(problem, solution.durations).verdict is Verdict.PASS


def test_the_same_reversed_in_time() -> None:
    problem, h = NEAR["one joint"]
    turned = replace(problem, waypoints=problem.waypoints[::-1])
    assert solve(turned).total_time <= h.sum() * ROUNDED


@pytest.mark.parametrize(
    ("rows", "curve", "segments"),
    [
        ([[0, 0], [1, 2], [1.01, 2.02], [3, 4]], cubic_spline(3), [1]),
        ([[0, 0], [1, 2], [1.01, 2.2], [3, 4]], cubic_spline(3), []),
        ([[0, 0], [0, 2], [0, 2], [0, 4]], cubic_spline(3), [1]),
        ([[0, 0], [1, 2], [1.01, 2.02], [3, 4]], three_five_three(), [1]),
        # A cubic spline with virtual breaks: the first and the last way lie over two segments.
        ([[0, 0], [0.01, 0.01], [1, 2], [1.01, 2.02], [3, 4]], cubic_spline_virtual(5), [3]),
    ],
)
def test_ways_that_are_short(
    rows: list[list[float]], curve: Interpolant, segments: list[int]
) -> None:
    problem = Problem(np.array(rows, dtype=float), Limits(1.0, joints=2), curve)
    assert short_ways(problem) == segments


def test_a_way_is_short_beside_what_a_joint_covers_that_enters_in_motion() -> None:
    assert short_ways(ENTERING) == [1]
    assert short_ways(replace(ENTERING, curve=cubic_spline(2))) == []


def test_starts_are_shorter_by_powers_of_ten_in_a_short_way_alone() -> None:
    """Down to 2.7e-4 s, which the way takes at the velocity limit."""
    answer = np.array([10.16655583, 10.83811028, 12.54426111, 0.2902423])
    starts = shortened(ONE_JOINT, answer, np.full(4, 1e-5))
    assert starts[:, 3] == pytest.approx(0.2902423 / 10.0 ** np.arange(1, 4), rel=1e-12)
    assert (starts[:, :3] == answer[:3]).all()


def test_no_start_where_a_bound_is_above_it() -> None:
    problem = replace(ONE_JOINT, duration_lower=np.array([0.0, 0.0, 0.0, 0.2]))
    answer = np.array([10.16655583, 10.83811028, 12.54426111, 0.2902423])
    assert shortened(problem, answer, np.full(4, 1e-5)).shape == (0, 4)


def test_segments_that_stand_alone_are_not_searched_again(monkeypatch: pytest.MonkeyPatch) -> None:
    def never(*_: object) -> Array:
        raise AssertionError("searched")

    monkeypatch.setattr("trajgap.nlp.optimum.solver.shortened", never)
    rows = np.array([[0.0], [1.0], [1.0001], [2.0]])
    assert solve(Problem(rows, Limits(1.0, 1.0, joints=1), rest_to_rest(3, 5))).total_time > 0
