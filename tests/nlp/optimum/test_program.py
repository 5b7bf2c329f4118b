"""The exact NLP: what it consists of, and that its expressions are those of the fitted curve."""

from dataclasses import replace

import casadi as ca
import numpy as np
import pytest
from support.b_splines import clamped, uniform
from support.samples import FAMILIES, long_curves, long_problem, small_problem
from support.uneven import CURVES as UNEVEN, uneven_problem
from trajgap.nlp import build
from trajgap.nlp.optimum.program import Program
from trajgap.nlp.optimum.rounds import near_rows
from trajgap.nlp.optimum.starts import first_nodal
from trajgap.problem import Array, Limits, Problem, curves, extrema, fit, load_case

REST = ((1, 0.0), (2, 0.0))
Q = [[0.1], [0.9], [0.3]]
DECLARED = {
    **{family: small_problem(family, 3) for family in FAMILIES},
    **{f"26 segments, {name}": long_problem(curve) for name, curve in long_curves(26).items()},
    **{f"uneven {name}": uneven_problem(name) for name in UNEVEN if name != "stretched"},
    "one segment": Problem(
        [[0.1, 1.0], [0.9, -0.4]], Limits(1.0, 3.0, joints=2), curves.piecewise((5,))
    ),
    "moving ends": Problem(
        Q, Limits(2.0, 6.0), curves.cubic_spline(2, ends=((1, 0.4),), finish=((1, -0.2),))
    ),
    "fixed ratios": Problem(Q, Limits(2.0, 6.0), curves.cubic_spline(2), ratios=(1, 3)),
    "virtual": Problem([*Q, [1.0]], Limits(2.0, 6.0, 40.0), curves.quintic_spline_virtual(4)),
    "a higher degree first": Problem(
        np.cumsum(np.random.default_rng(4).normal(size=(10, 1)), axis=0),
        Limits(2.0, 6.0),
        curves.piecewise((4, *(3,) * 8), 2, ends=REST, finish=REST[:1]),
    ),
}
SPLINES = {
    "stretched": uniform("stretched")[0],
    "uneven stretched": uneven_problem("stretched"),
    "timed": uniform("timed")[0],
    "averaged knots": clamped((3, "averaged-continued", "times", "timed"), count=6)[0],
    "knots of each joint": clamped((5, "averaged-continued", "joint-chord", "timed"), count=6)[0],
}


def _durations(problem: Problem) -> Array:
    if problem.shares is not None:
        return 1.7 * problem.shares
    return np.random.default_rng(1).uniform(0.9, 1.1, problem.segments)


@pytest.mark.parametrize("name", [*DECLARED, *SPLINES])
def test_expressions_are_those_of_the_fitted_curve(name: str) -> None:
    problem = (DECLARED | SPLINES)[name]
    h, nodal = _durations(problem), first_nodal(problem)
    program = Program(problem, float(h.mean()), np.zeros(h.size))
    trajectory = fit(problem.curve, problem.waypoints, h, nodal)
    rows = near_rows(program, trajectory, 0.1)
    values = program.at_places(rows.places, rows.weight)
    ends = program.at_places(program.ends, np.zeros(program.ends.s.size))
    evaluated = ca.Function("f", [program.variables], [program.equalities, values, ends])
    x = program.pack(trajectory, h)
    equal, inside, last = (np.asarray(v).ravel() for v in evaluated(x))
    np.testing.assert_allclose(equal, 0.0, atol=1e-9)
    found, values_given = program.motion(x)
    np.testing.assert_allclose(found, h, rtol=1e-12)
    if nodal is not None:
        np.testing.assert_allclose(values_given, nodal, atol=1e-9)
    assert rows.places.s.size + program.ends.s.size > 0
    for j in range(program.joints):
        for r in (1, 2, 3):
            scale = program.sides.scale[j, r - 1] * program.angle[j] / program.unit**r
            if np.isinf(scale):
                continue
            at = (rows.places.joint == j) & (rows.places.order == r)
            sides = 0.1 * problem.limits.sides[:, j, r - 1]
            turning = [e.value for e in extrema(trajectory, j, r) if 0.0 < e.s < 1.0]
            near = [v / scale for v in turning if not -sides[0] < v < sides[1]]
            np.testing.assert_allclose(np.sort(inside[at]), np.sort(near), rtol=1e-6, atol=1e-8)
            if name != "knots of each joint":
                at = np.flatnonzero((program.ends.joint == j) & (program.ends.order == r))
                for i, k, s in zip(at, program.ends.segment[at], program.ends.s[at], strict=True):
                    truth = trajectory.values(int(k), j, r, np.array([s]))[0] / scale
                    assert last[i] == pytest.approx(truth, rel=1e-6, abs=1e-8)


@pytest.mark.parametrize("name", DECLARED)
def test_bounds_at_left_ends_are_the_limits(name: str) -> None:
    problem = DECLARED[name]
    program = build(problem)
    low, high = program.bounds()
    below, above = problem.limits.sides
    left = zip(program.left.joint, program.left.order, strict=True)
    for i, (j, r) in enumerate(left, problem.segments):
        if 1 <= r <= 3 and low[i] < high[i]:  # else it is given
            unit = program.unit**r / program.angle[j]
            assert low[i] == pytest.approx(-below[j, r - 1] * unit)
            assert high[i] == pytest.approx(above[j, r - 1] * unit)


def test_a_place_follows_its_extremum_to_second_order() -> None:
    """Value and slope at a place that follows are those of the extremum that has moved."""
    problem = small_problem("C4 quintic", 1)
    h = _durations(problem)
    program = Program(problem, float(h.mean()), np.zeros(h.size))
    trajectory = fit(problem.curve, problem.waypoints, h)
    rows = near_rows(program, trajectory, 0.5)
    moved = h * np.exp(1e-3 * np.random.default_rng(2).normal(size=h.size))
    other = fit(problem.curve, problem.waypoints, moved)
    value = ca.Function("f", [program.variables], [program.at_places(rows.places, rows.weight)])
    found = np.asarray(value(program.pack(other, moved))).ravel()
    still = ca.Function("f", [program.variables], [program.at_places(rows.places, 0 * rows.weight)])
    fixed = np.asarray(still(program.pack(other, moved))).ravel()
    places, follows, stays = rows.places, [], []
    for i in np.flatnonzero(rows.weight != 0.0):
        j, r = int(places.joint[i]), int(places.order[i])
        own = [e for e in extrema(other, j, r) if e.segment == places.segment[i] and 0 < e.s < 1]
        nearest = min(own, key=lambda e: abs(e.s - places.s[i]))
        scale = program.sides.scale[j, r - 1] * program.angle[j] / program.unit**r
        follows.append(abs(found[i] - nearest.value / scale))
        stays.append(abs(fixed[i] - nearest.value / scale))
    assert max(follows) < 1e-3 * max(stays)


def test_a_program_says_what_it_consists_of() -> None:
    problem = load_case("puma560-mnam-pso-353").problem()
    said = str(build(problem))
    assert said.splitlines()[:4] == [
        "minimise the sum of 3 segment durations",
        "  curve        3-5-3 polynomials, 6 joint(s), 3 pieces",
        "  variables    69: 3 durations, 66 derivatives at left ends of pieces",
        "  equalities   54: the curve's conditions at right ends",
    ]
    assert "velocity, acceleration" in said
    fixed = replace(problem, ratios="equal")
    assert "fixed ratios" in str(build(fixed))
    assert "way-points at their times" in str(build(SPLINES["averaged knots"]))
    assert "variables    5: 5 durations\n" in str(build(SPLINES["timed"]))
