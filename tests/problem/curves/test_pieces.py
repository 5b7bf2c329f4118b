"""The compiled search over many pieces finds the very extrema of the search piece by piece."""

from dataclasses import astuple, replace

import numpy as np
import pytest
from support.samples import DECLARATIONS, sample_problem
from trajgap.problem import (
    Extremum,
    Limits,
    Peak,
    Problem,
    check,
    cubic_spline,
    extrema,
    fit,
    jumps,
    quintic_spline,
    rest_to_rest,
)
from trajgap.problem.curves import (
    Deferred,
    largest,
    largest_of_each,
    may_jump,
    near_extrema,
    pieces,
    step_sizes,
    tops,
)

NAMES = ("3-5-3", "cubic", "quintic", "rest 7", "4-2-3", "lines", "uneven")


@pytest.mark.parametrize("name", NAMES)
def test_tops_are_the_largest_of_all_extrema(name: str) -> None:
    problem, h = sample_problem(DECLARATIONS[name], 11)
    found = problem.curve.enclosed(problem.waypoints, h)
    curve, error = (
        found.trajectory,
        found.error + np.random.default_rng(1).random(found.error.shape),
    )
    for j in range(3):
        for r in range(4):
            points = extrema(curve, j, r)
            top = tops(curve, error, j, r)
            same(top.size, max(points, key=lambda e: abs(e.value)))
            same(top.highest, max(points, key=lambda e: e.value))
            same(top.lowest, max(points, key=lambda e: -e.value))
            reach = max(abs(e.value) + error[e.segment, r, j] for e in points)
            assert top.reach == pytest.approx(reach, rel=1e-15)


def same(one: Extremum | Peak, other: Extremum | Peak) -> None:
    assert (one.joint, one.segment, one.time) == (other.joint, other.segment, other.time)
    assert one.value == pytest.approx(other.value, rel=1e-14)


@pytest.mark.parametrize("waited", [0.0, 99.0], ids=["interpreted", "compiled"])
@pytest.mark.parametrize("name", NAMES)
def test_one_call_finds_what_one_search_after_another_finds(
    name: str, waited: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    each = Deferred(pieces._largest_of_each, 2.0)
    each._spent, each._look = waited, 0.0 if waited else 99.0
    monkeypatch.setattr(pieces, "_each", each)
    for seed in range(4):
        problem, h = sample_problem(DECLARATIONS[name], seed)
        found = problem.curve.enclosed(problem.waypoints, h)
        curve = found.trajectory
        error = found.error + np.random.default_rng(seed).random(found.error.shape)
        wanted = np.ones((curve.joints, 3), dtype=bool)
        wanted[1, seed % 3] = False
        asked = np.argwhere(wanted).tolist()
        one_by_one = [largest(curve, j, r + 1, error[:, r + 1, j]) for j, r in asked]
        # Not a bit may differ: rows of earlier runs are compared with those of later ones.
        in_one_call = largest_of_each(curve, error, wanted)
        assert [(astuple(e), b) for e, b in in_one_call] == [(astuple(e), b) for e, b in one_by_one]


def test_a_jump_is_never_overlooked() -> None:
    problem, h = sample_problem(DECLARATIONS["uneven"], 13)
    found = problem.curve.enclosed(problem.waypoints, h)
    assert not may_jump(found.trajectory, found.error)
    bent = found.trajectory.scaled.copy()
    for order in range(3):
        size, scale = step_sizes(found.trajectory, order)
        least = found.error[0, order, 1] + found.error[1, order, 1] + 1e-9 * scale[0, 1]
        added = (least - size[0, 1]) * found.trajectory.durations[1] ** order
        bent[1, order, 1] += added / [1, 1, 2][order]
        jumping = replace(found.trajectory, scaled=bent)
        assert may_jump(jumping, found.error)
        bent[1, order, 1] = found.trajectory.scaled[1, order, 1]


@pytest.mark.parametrize("name", NAMES)
def test_near_extrema_are_those_beyond_the_two_values(name: str) -> None:
    problem, h = sample_problem(DECLARATIONS[name], 12)
    curve = fit(problem.curve, problem.waypoints, h)
    for r in range(4):
        points = extrema(curve, 1, r)
        high = float(np.quantile([e.value for e in points], 0.7))
        low = float(np.quantile([e.value for e in points], 0.2))
        pieces, places, values = near_extrema(curve, 1, r, low, high)
        wanted = [(e.segment, e.s, e.value) for e in points if e.value <= low or e.value >= high]
        assert list(zip(pieces.tolist(), places.tolist(), strict=True)) == [w[:2] for w in wanted]
        np.testing.assert_allclose(values, [w[2] for w in wanted], rtol=1e-14)
        assert near_extrema(curve, 1, r, -np.inf, -np.inf)[0].size == len(points)


def test_step_sizes_are_those_of_the_two_sides() -> None:
    problem, h = sample_problem(DECLARATIONS["uneven"], 13)
    curve = fit(problem.curve, problem.waypoints, h)
    for order in range(4):
        size, scale = step_sizes(curve, order)
        for b in range(1, 3):
            for j in range(3):
                left, right, terms = curve.sides(b, j, order)
                assert size[b - 1, j] == pytest.approx(right - left, abs=1e-14 * terms)
                assert scale[b - 1, j] == pytest.approx(terms, rel=1e-14)


def long_problem(kind: str, segments: int, seed: int = 4) -> tuple[Problem, np.ndarray]:
    rng = np.random.default_rng(seed)
    q = np.cumsum(rng.normal(size=(segments + 1, 2)) * [0.4, 1.1], axis=0) - 5.0
    curve = cubic_spline(segments) if kind == "cubic" else quintic_spline(segments)
    limits = Limits([2.0, 3.0], [9.0, 20.0], [80.0, np.inf], q.min(axis=0) - 0.1, [np.inf, 90.0])
    return Problem(q, limits, curve), rng.uniform(0.4, 1.7, segments)


@pytest.mark.parametrize("kind", ["cubic", "quintic"])
def test_the_checker_says_the_same_by_both_searches(
    kind: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    problem, h = long_problem(kind, 130)
    found = check(problem, h)
    monkeypatch.setattr(jumps, "MANY_PIECES", 10**6)
    for one, other in zip(found.peaks, check(problem, h).peaks, strict=True):
        same(one, other)
        assert one.ratio == pytest.approx(other.ratio, rel=1e-14)
        assert one.error == pytest.approx(other.error, rel=1e-9)
    jumping = Problem(problem.waypoints, problem.limits, rest_to_rest(130, 3))
    one_by_one = check(jumping, h)
    monkeypatch.undo()
    together = check(jumping, h)
    assert one_by_one.verdict is together.verdict
    assert [(e.joint, e.order, e.break_index) for e in one_by_one.jumps] == [
        (e.joint, e.order, e.break_index) for e in together.jumps
    ]
    assert len(together.jumps) > 200
    np.testing.assert_allclose(
        [e.size for e in one_by_one.jumps], [e.size for e in together.jumps], rtol=1e-9
    )
