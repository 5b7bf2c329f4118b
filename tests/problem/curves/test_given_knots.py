"""Clamped B-splines with a printed knot vector: scipy's with the same one, and what is refused."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from scipy.interpolate import BSpline, make_interp_spline
from support.b_splines import INNER, SHARES, H, Q, given, printed, vector
from trajgap.nlp import solve
from trajgap.problem import (
    ClampedBSpline,
    CurveError,
    Limits,
    Problem,
    TrajgapError,
    Verdict,
    check,
    clamped_control_points,
    fit,
)
from trajgap.problem.curves import average_matrix
from trajgap.problem.curves.clamped_knots import chord_fractions


def scipys(degree: int, sites: np.ndarray, orders: tuple[int, ...] = (1, 2)) -> BSpline:
    rest = [(order, np.zeros(2)) for order in orders]
    knots = np.array(vector(degree)) * sites[-1]
    return make_interp_spline(sites, Q, k=degree, t=knots, bc_type=(rest, rest))


@pytest.mark.parametrize("degree", INNER)
def test_at_the_times_it_is_scipys_with_the_same_knots(degree: int) -> None:
    curve, times = given(degree), np.concatenate([[0.0], np.cumsum(H)])
    mine, theirs = fit(curve, Q, H), scipys(degree, times)
    at = np.linspace(0.0, times[-1], 83)
    for order in range(3):
        other = theirs(at, order)
        np.testing.assert_allclose(mine(at, order), other, atol=1e-11 * np.abs(other).max())
    control, knots = clamped_control_points(curve, Q, H)
    np.testing.assert_allclose(control, theirs.c, atol=1e-12)
    both = np.outer(vector(degree), np.full(2, times[-1]))
    np.testing.assert_allclose(knots, both, atol=1e-14)


def test_one_order_at_the_ends_takes_two_knots_less() -> None:
    whole = (0,) * 5 + (0.3, 0.62) + (1,) * 5
    curve = ClampedBSpline(5, 4, "given", "times", end_orders=(1,), knot_vector=whole)
    times = np.concatenate([[0.0], np.cumsum(H)])
    rest = [(1, np.zeros(2))]
    theirs = make_interp_spline(times, Q, k=4, t=np.array(whole) * times[-1], bc_type=(rest, rest))
    at = np.linspace(0.0, times[-1], 40)
    np.testing.assert_allclose(fit(curve, Q, H)(at), theirs(at), atol=1e-13)


def test_the_scale_of_the_vector_does_not_matter() -> None:
    other = ClampedBSpline(5, 4, "given", "times", knot_vector=vector(4, -2.0, 6.0))
    at = np.linspace(0.0, H.sum(), 31)
    np.testing.assert_allclose(fit(other, Q, H)(at), fit(given(4), Q, H)(at), atol=1e-14)


@pytest.mark.parametrize("degree", INNER)
def test_at_printed_parameters_each_segment_is_a_part_of_scipys(degree: int) -> None:
    mine, theirs = fit(printed(degree), Q, H), scipys(degree, np.array(SHARES))
    start = np.concatenate([[0.0], np.cumsum(H)])
    for k, (u, v) in enumerate(pairwise(SHARES)):
        s = np.linspace(0.01, 0.99, 21)
        for order in range(3):
            other = theirs(u + (v - u) * s, order) * ((v - u) / H[k]) ** order
            np.testing.assert_allclose(
                mine(start[k] + s * H[k], order), other, atol=1e-11 * np.abs(other).max()
            )


@pytest.mark.parametrize("time", ["timed", "stretched"])
@pytest.mark.parametrize("degree", [3, 4, 5])
def test_the_averaged_knots_written_out_are_the_averaged_knots(degree: int, time: str) -> None:
    averaged = ClampedBSpline(5, degree, "averaged-continued", "given", time, fractions=(SHARES,))
    inner = average_matrix(averaged) @ np.array(SHARES)
    whole = (*[0.0] * (degree + 1), *inner, *[1.0] * (degree + 1))
    source = "times" if time == "timed" else "given"
    written = ClampedBSpline(
        5, degree, "given", source, time,
        fractions=(SHARES,) if time == "stretched" else None, knot_vector=whole,
    )  # fmt: skip
    at = np.linspace(0.0, H.sum(), 53)
    for order in range(3):
        np.testing.assert_allclose(
            fit(written, Q, H)(at, order), fit(averaged, Q, H)(at, order), atol=1e-12
        )


def test_durations_far_from_the_knots_proportions_define_no_curve() -> None:
    problem = Problem(Q, Limits(2.0, 9.0), given(3))
    odd = [0.1, 0.1, 0.1, 5.0]
    with pytest.raises(CurveError, match="no clamped B-spline of degree 3, printed knots passes"):
        fit(problem.curve, Q, odd)
    found = check(problem, odd)
    assert found.verdict is Verdict.VIOLATED
    assert found.worst is not None
    assert found.worst.quantity == "curve"


def test_the_optimum_of_chord_knots_written_out_is_that_of_chord_knots() -> None:
    limits = Limits(2.0, 9.0)
    chord = ClampedBSpline(5, 3, "averaged-continued", "chord")
    inner = average_matrix(chord) @ np.array(chord_fractions(Q)[0])
    whole = (*[0.0] * 4, *inner, *[1.0] * 4)
    written = ClampedBSpline(5, 3, "given", "times", knot_vector=whole)
    totals = [solve(Problem(Q, limits, one), starts=2).total_time for one in (chord, written)]
    assert totals[0] == pytest.approx(totals[1], rel=1e-9)


def test_an_optimum_is_found_where_equal_durations_pass_no_curve() -> None:
    """Most knots lie in the last third of the time, and so must the middle way-point."""
    whole = (0,) * 4 + (0.6, 0.7, 0.8, 0.85, 0.9) + (1,) * 4
    curve = ClampedBSpline(5, 3, "given", "times", knot_vector=whole)
    with pytest.raises(CurveError):
        fit(curve, Q, np.ones(4))
    problem = Problem(Q, Limits(2.0, 9.0), curve)
    solution = solve(problem, starts=2)
    assert solution.durations is not None
    assert check(problem, solution.durations).verdict is Verdict.PASS


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"knot_vector": ()}, r'knot_vector: is missing where knots are "given"'),
        ({"knots": "waypoints"}, r'knot_vector: is for knots that are "given"; leave it out'),
        ({"parameters": "chord"}, r'where knots are "given" and time is "timed", .* write "times"'),
        ({"parameters": "chord", "time": "stretched"}, r'where knots are "given" and time is'),
        ({"parameters": "given", "time": "stretched"}, r"fractions: are missing where parameters"),
        (
            {"parameters": "given", "time": "stretched", "fractions": ((0.0, 0.5, 0.4, 0.8, 1.0),)},
            r"fractions: each must be larger than the one",
        ),
        ({"knot_vector": vector(5)[:-1]}, r"the last knot, 1, stands 5 times; .* has it 6 times"),
        ({"knot_vector": vector(5)[1:]}, r"the first knot, 0, stands 5 times; .* has it 6 times"),
        ({"knot_vector": (0, 0, 0.5, 1, 1)}, r"has 5 knots, but degree 5 needs 12 at least"),
        (
            {"knot_vector": (*[0] * 6, 0.2, 0.2, 0.7, *[1] * 6)},
            r"the inner knot 0.2 stands 2 times; each may stand once",
        ),
        (
            {"knot_vector": (*[0] * 6, 0.5, 0.2, 0.7, *[1] * 6)},
            r"0.5 is followed by 0.2, but knots do not decrease",
        ),
        ({"knot_vector": (*[0] * 6, 0.2, np.nan, 0.7, *[1] * 6)}, r"knots must be finite"),
        ({"knot_vector": (*[0] * 6, 0.2, 0.7, *[1] * 6)}, r"over-determined, 9 conditions on 8"),
        (
            {"knot_vector": (*[0] * 6, 0.2, 0.4, 0.5, 0.7, *[1] * 6)},
            r"under-determined, 9 conditions on 10 control points; 15 knots in all",
        ),
        (
            {
                "degree": 3,
                "knot_vector": vector(3),
                "parameters": "given",
                "time": "stretched",
                "fractions": ((0.0, 0.01, 0.02, 0.3, 1.0),),
            },
            r"no curve passes way-point 2, whose parameter 0.02 \(of 0 to 1\) does not lie",
        ),
    ],
)
def test_refusals(arguments: dict[str, object], message: str) -> None:
    whole: dict[str, object] = {
        "waypoints": 5, "degree": 5, "knots": "given", "parameters": "times",
        "knot_vector": vector(5), **arguments,
    }  # fmt: skip
    with pytest.raises(TrajgapError, match=message):
        ClampedBSpline(**whole)  # type: ignore[arg-type]
