"""Clamped B-splines: counts, knots and curves by routes that share no code with them."""

import numpy as np
import pytest
from scipy.interpolate import BSpline, make_interp_spline
from support.b_splines import INNER, SHARES, H, Q, clamped, given, printed, vector
from support.papers.motions import averaged, chords, interpolated, nodes
from trajgap.nlp import solve
from trajgap.problem import (
    Array,
    ClampedBSpline,
    Count,
    CurveError,
    Knots,
    Limits,
    Parameters,
    Problem,
    Timing,
    TrajgapError,
    Verdict,
    check,
    clamped_readings,
    evaluate,
    fit,
    piecewise,
    quintic_spline,
    solve_in_closed_form,
)

KINDS = [
    (degree, knots, parameters, time)
    for degree in range(3, 8)
    for knots in ("waypoints", "averaged-continued")
    for parameters in (Parameters.TIMES, Parameters.CHORD, Parameters.JOINT_CHORD)
    for time in Timing
    if (degree == 5 or knots != "waypoints") and (parameters, time) != ("times", "stretched")
]
FIVE = {
    curve.name + f" {curve.degree}": curve
    for degree in INNER
    for curve in (
        given(degree),
        printed(degree),
        *(
            ClampedBSpline(5, degree, "averaged-continued", "given", time, fractions=(SHARES,))
            for time in Timing
        ),
    )
}
"""Printed knots or printed parameters, through five way-points of two joints."""
EACH = {**{"-".join(map(str, kind)): kind for kind in KINDS}, **FIVE}
each = pytest.mark.parametrize("name", EACH)


def posed(name: str, seed: int = 0) -> tuple[Problem, Array]:
    if name in FIVE:
        return Problem(Q, Limits([1.3, 2.0], [4.0, 5.0], [30.0, 50.0]), FIVE[name]), H
    return clamped(EACH[name], seed)


def independent(problem: Problem, h: Array, joint: int) -> tuple[BSpline, Array]:
    """One joint's spline in its parameter, and the parameter of each way-point."""
    curve, q = problem.curve, problem.waypoints
    assert isinstance(curve, ClampedBSpline)
    times = nodes(h)
    along = {"chord": chords(q), "joint-chord": chords(q[:, [joint]]), "given": np.array(SHARES)}
    u = times if curve.parameters == "times" else along[curve.parameters]
    sites = u if curve.time == "stretched" else times
    scale = sites[-1] / u[-1]
    if curve.knots == "given":
        inner = np.array(INNER[curve.degree]) * sites[-1]
    else:
        at = scale * u
        inner = at[1:-1] if curve.knots == "waypoints" else averaged(at, curve.degree)
    return interpolated(sites, q[:, [joint]], curve.degree, inner), sites


def test_the_count_decides_which_readings_are_determined() -> None:
    found = {(r.degree, r.knots, r.parameters, r.time): r for r in clamped_readings(8)}
    assert len(found) == 5 * 3 * 5
    for (degree, knots, _, _), reading in found.items():
        points = {"waypoints": 7 + degree, "averaged": 8, "averaged-continued": 12}[knots]
        assert (reading.conditions, reading.control_points) == (12, points)
        word = {0: Count.DETERMINED, 1: Count.UNDER, -1: Count.OVER}[int(np.sign(points - 12))]
        assert reading.count is word
        assert (reading.curve is not None) == (word is Count.DETERMINED)
        assert "12 conditions" in reading.words
        assert f"{points} control points" in reading.words
        assert ("impossible" in reading.words) == (knots == "averaged")
    determined = [k for k, r in found.items() if r.count is Count.DETERMINED]
    assert {degree for degree, knots, _, _ in determined if knots == "waypoints"} == {5}
    assert {degree for degree, knots, _, _ in determined if knots != "waypoints"} == {3, 4, 5, 6, 7}
    # What knots at the way-points leave free is a declared polynomial.
    for degree, free in ((6, 1), (7, 2)):
        assert piecewise((degree,) * 7, degree - 1).free == free
        assert f"free = {free}" in found[degree, "waypoints", "times", "timed"].words


def test_other_end_conditions_are_counted_too() -> None:
    """The literal rule is determined without end conditions; one order takes two knots less."""
    readings = clamped_readings(6, (1,))
    assert [r.degree for r in readings if r.knots == "waypoints" and r.curve] == [3] * 5
    rng = np.random.default_rng(1)
    q, h = rng.normal(size=(8, 2)) + 3, rng.uniform(0.8, 1.2, 7)
    t = np.concatenate([[0.0], np.cumsum(h)])
    literal = np.concatenate([[t[0]] * 6, averaged(t, 5, 0), [t[-1]] * 6])
    whole = (0,) * 5 + (0.3, 0.62) + (1,) * 5
    one = [(1, np.zeros(2))]
    five = make_interp_spline(t[:5], q[:5], k=4, t=np.array(whole) * t[4], bc_type=(one, one))
    for curve, other in (
        (
            ClampedBSpline(8, 5, "averaged", "times", end_orders=()),
            make_interp_spline(t, q, k=5, t=literal),
        ),
        (
            ClampedBSpline(8, 3, "waypoints", "times", end_orders=(1,)),
            make_interp_spline(t, q, k=3, bc_type="clamped"),
        ),
        (ClampedBSpline(5, 4, "given", "times", end_orders=(1,), knot_vector=whole), five),
    ):
        n = curve.waypoints
        at = np.linspace(0, t[n - 1], 101)[:-1]
        for order in range(2):
            mine = fit(curve, q[:n], h[: n - 1])(at, order)
            np.testing.assert_allclose(mine, other(at, order), rtol=0, atol=1e-10)


def test_degrees_too_low_for_the_end_conditions_are_no_readings() -> None:
    """A cubic has no second derivative to prescribe beside the first, nor a quartic a third one."""
    assert {r.degree for r in clamped_readings(7, (1, 2, 3))} == {4, 5, 6, 7}
    readings = clamped_readings(8, (1, 2, 3))
    assert {r.degree for r in readings if r.knots == "waypoints" and r.curve} == {7}


def test_few_waypoints() -> None:
    with pytest.raises(TrajgapError, match="at least two way-points"):
        clamped_readings(1)
    words = next(r.words for r in clamped_readings(3, degrees=(7,)) if r.knots == "averaged")
    assert words.startswith("impossible as printed: degree 7 needs more way-points")
    two = ClampedBSpline(2, 5, "averaged-continued", "times")
    assert two.inner_knots == 0
    q, t = np.array([[0.3], [1.5]]), np.linspace(0, 2, 21)
    mine, quintic = fit(two, q, [2.0]), fit(quintic_spline(1), q, [2.0])
    np.testing.assert_allclose(mine(t), quintic(t), rtol=0, atol=1e-14)


@each
def test_the_curve_is_scipys(name: str) -> None:
    problem, h = posed(name)
    trajectory = fit(problem.curve, problem.waypoints, h)
    nodes = np.concatenate([[0.0], np.cumsum(h)])
    t = np.sort(np.random.default_rng(9).uniform(0, nodes[-1] * (1 - 1e-9), 200))
    stretched = problem.curve.time is Timing.STRETCHED
    for joint in range(problem.waypoints.shape[1]):
        spline, sites = independent(problem, h, joint)
        u, speed = t, np.ones_like(t)
        if stretched:
            u = np.interp(t, nodes, sites)
            speed = (np.diff(sites) / h)[np.searchsorted(nodes, t, side="right") - 1]
        for order in range(3):
            expected = spline(u, order)[:, 0] * speed**order
            found = trajectory(t, order)[:, joint]
            np.testing.assert_allclose(found, expected, rtol=0, atol=1e-8 if order else 1e-10)


@each
def test_continuity(name: str) -> None:
    problem, h = posed(name, 4)
    verdict = check(problem, 9 * h)
    stretched = problem.curve.time is Timing.STRETCHED
    assert (verdict.limits, bool(verdict.jumps)) == (Verdict.PASS, stretched)
    assert (verdict.verdict is Verdict.DISCONTINUOUS) == stretched
    if stretched:
        # At via-points velocity and acceleration of each joint; knots inside are smooth.
        times = np.cumsum(9 * h)[:-1]
        assert len(verdict.jumps) == times.size * problem.waypoints.shape[1] * 2
        found = {round(jump.time, 9) for jump in verdict.jumps}
        assert found == {round(t, 9) for t in times}


def test_the_scale_of_the_vector_does_not_matter() -> None:
    other = ClampedBSpline(5, 4, "given", "times", knot_vector=vector(4, -2.0, 6.0))
    at = np.linspace(0.0, H.sum(), 31)
    np.testing.assert_allclose(fit(other, Q, H)(at), fit(given(4), Q, H)(at), atol=1e-14)


@pytest.mark.parametrize("parameters", ["chord", "joint-chord"])
def test_closed_form_of_a_stretched_chord_curve(parameters: str) -> None:
    problem, _ = clamped((4, "averaged-continued", parameters, "stretched"), 11)
    h = solve_in_closed_form(problem.curve, problem.waypoints, problem.limits.derivatives)
    assert check(problem, h).stretch == pytest.approx(1.0, rel=1e-12)
    for k in range(7):
        shorter = h * (1 - 1e-6 * np.eye(7)[k])
        assert check(problem, shorter).limits is Verdict.VIOLATED
    alone = problem.joint(1)
    assert alone.curve.for_joint(alone.waypoints, 0) == alone.curve


def test_an_optimum_is_found_where_equal_durations_pass_no_curve() -> None:
    """Most knots lie in the last third of the time, and so must the middle way-point."""
    whole = (0,) * 4 + (0.6, 0.7, 0.8, 0.85, 0.9) + (1,) * 4
    curve = ClampedBSpline(5, 3, "given", "times", knot_vector=whole)
    with pytest.raises(CurveError, match=r"\(way-point 3 lies outside"):
        fit(curve, Q, np.ones(4))
    problem = Problem(Q, Limits(2.0, 9.0), curve)
    solution = solve(problem, starts=2)
    assert solution.found
    assert check(problem, solution.durations).verdict is Verdict.PASS


def test_knots_are_numbers_of_one_kind_however_they_are_given():
    whole = [0, 0, 0, 0, 0, 0.25, 0.5, 0.75, 1, 1, 1, 1, 1]
    given = (whole, tuple(whole), np.array(whole))
    curves = {ClampedBSpline(4, 4, Knots.GIVEN, Parameters.TIMES, knot_vector=one) for one in given}
    assert len(curves) == 1
    (curve,) = curves
    assert curve.knot_vector == tuple(map(float, whole))
    assert all(type(one) is float for one in curve.knot_vector)


@pytest.mark.parametrize(("degree", "orders"), [(3, (1,)), (5, (1, 2))])
def test_inner_knots_at_times_of_points_make_a_spline(degree: int, orders: tuple[int, ...]) -> None:
    curve = ClampedBSpline(5, degree, end_orders=orders)
    rng = np.random.default_rng(degree)
    q, h = rng.normal(size=(5, 2)), rng.uniform(0.5, 1.5, 4)
    at = np.linspace(0.0, h.sum(), 41)
    spline = curve.polynomial_form()
    np.testing.assert_allclose(fit(spline, q, h)(at), fit(curve, q, h)(at), atol=1e-9)
    assert spline is not curve
    for knots, places in ((Knots.WAYPOINTS, Parameters.CHORD), (Knots.CONTINUED, Parameters.TIMES)):
        other = ClampedBSpline(5, 5, knots, places)
        assert other.polynomial_form() is other


def test_segments_that_are_stretched_by_themselves_are_not_smooth():
    for time, order in ((Timing.TIMED, 3), (Timing.STRETCHED, 0)):
        curve = ClampedBSpline(5, 4, Knots.CONTINUED, Parameters.CHORD, time)
        assert curve.smooth_order(2) == order


@pytest.mark.parametrize("printed_vector", [False, True])
def test_durations_far_from_the_parameters_define_no_curve(printed_vector: bool) -> None:
    problem, h = clamped((3, "averaged-continued", "chord", "timed"), 12)
    far = np.array([60.0, 0.001, *h[2:]])
    if printed_vector:
        problem, far = Problem(Q, Limits(2.0, 9.0), given(3)), np.array([0.1, 0.1, 0.1, 5.0])
    assert np.isinf(evaluate(problem, far[None]).stretch[0])
    with pytest.raises(CurveError, match=r"no clamped B-spline .* passes the way-points at these"):
        fit(problem.curve, problem.waypoints, far)
    verdict = check(problem, far)
    assert verdict.verdict is Verdict.VIOLATED
    assert verdict.worst is not None
    assert verdict.worst.quantity == "curve"
    assert "Schoenberg" not in str(verdict.feasible_why)


def test_chords_need_waypoints_that_differ() -> None:
    problem, h = clamped((5, "averaged-continued", "chord", "timed"), 13)
    still = problem.waypoints.copy()
    still[4] = still[3]
    words = "waypoints: 3 and 4 coincide, so chord parameters cannot"
    with pytest.raises(TrajgapError, match=words):
        fit(problem.curve, still, h)


SIX = tuple([*[0] * 6, *inner, *[1] * 6] for inner in ((0.2, 0.7), (0.2, 0.4, 0.5, 0.7)))
PRINTED = {"parameters": "given", "time": "stretched"}
FAR = {"degree": 3, "knot_vector": vector(3), "fractions": ((0, 0.01, 0.02, 0.3, 1),)}


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"knots": "waypoints", "degree": 3}, "over-determined, 9 conditions, but only 7 control"),
        ({"knots": "waypoints", "degree": 7}, "under-determined, 9 conditions for 11 control"),
        ({"knots": "averaged", "waypoints": 6}, "but only 6 control points; continue the"),
        ({"knots": "averaged"}, "degree 5 needs at least 6 way-points; lower the"),
        ({"degree": 2}, "interpolant.degree: must lie in 3..7, got 2"),
        ({"degree": 8}, "interpolant.degree: must lie in 3..7, got 8"),
        ({"waypoints": 1}, "at least two way-points"),
        ({"knots": "uniform"}, "interpolant.knots: 'uniform' is unknown; use one of waypoints, av"),
        ({"parameters": "time"}, "interpolant.parameters: 'time' is unknown; use one of times, ch"),
        ({"time": "slow"}, "interpolant.time: 'slow' is unknown; use one of stretched, timed"),
        ({"knots": "waypoints", "time": "stretched"}, "from the times are times already"),
        ({"knots": "waypoints", "end_orders": (1, 1)}, "orders must be distinct and lie in 1..deg"),
        ({"knots": "waypoints", "end_orders": (1, 5)}, "orders must be distinct and lie in 1..deg"),
        ({"knots": "waypoints", "fractions": ((0.0, 1.0),)}, "expected 5 numbers from 0 to 1"),
        ({"knot_vector": ()}, 'knot_vector: is missing, although knots are "given"'),
        ({"knots": "waypoints", "knot_vector": vector(5)}, "knot_vector: is for knots that"),
        ({"parameters": "chord"}, 'if knots are "given" and time is "timed", way-points are pas'),
        ({**PRINTED, "parameters": "chord"}, 'if knots are "given" and time is "stretched"'),
        (PRINTED, 'fractions: are missing where parameters are "given"'),
        ({**PRINTED, "fractions": ((0.0, 0.5, 0.4, 0.8, 1.0),)}, "must be larger than the one"),
        ({"knot_vector": vector(5)[:-1]}, "the last knot, 1, stands 5 times; "),
        ({"knot_vector": vector(5)[1:]}, "the first knot, 0, stands 5 times; "),
        ({"knot_vector": (0, 0, 0.5, 1, 1)}, "has 5 knots, but degree 5 needs 12 at least"),
        ({"knot_vector": (*[0] * 6, 0.2, 0.2, 0.7, *[1] * 6)}, "the inner knot 0.2 stands 2 times"),
        ({"knot_vector": (*[0] * 6, 0.5, 0.2, 0.7, *[1] * 6)}, "0.5 is followed by 0.2, but knots"),
        ({"knot_vector": (*[0] * 6, 0.2, np.nan, 0.7, *[1] * 6)}, "knots must be finite"),
        ({"knot_vector": SIX[0]}, "but only 8 control points; 15 knots determine it, but 14"),
        ({"knot_vector": SIX[1]}, "under-determined, 9 conditions for 10 control points; 15 knots"),
        (
            PRINTED | FAR,
            "way-point 3, whose parameter 0.02 (of 0 to 1) does not lie between the knots",
        ),
    ],
)
def test_what_cannot_be_declared(change: dict[str, object], message: str) -> None:
    knots = {"knot_vector": vector(5)} if change.get("knots", "given") == "given" else {}
    basic = {"waypoints": 5, "degree": 5, "knots": "given", "parameters": "times", **knots}
    with pytest.raises(TrajgapError) as caught:
        ClampedBSpline(**(basic | change))  # type: ignore[arg-type]
    assert message in str(caught.value)
