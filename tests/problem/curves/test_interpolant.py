"""Declarations: their conditions counted by hand, and every contradiction refused by name."""

from dataclasses import replace

import numpy as np
import pytest
from trajgap.problem import Interpolant, Limits, Problem, TrajgapError, curves, fit

REST = ((1, 0.0), (2, 0.0))
JERK = (*REST, (3, 0.0))


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (((), (), ((),)), r"interpolant.degrees: at least one segment is needed"),
        (((3, 3), (), ((),) * 3), r"continuity: 2 segments have 1 via-points, got 0 orders"),
        (((3, 3), (2,), ((),) * 2), r"prescribed: 2 segments have 3 breaks, got 2 entries"),
        (((10,), (), ((), ())), r"degrees: every degree must lie in 1..9"),
        (((3, 0), (0,), ((),) * 3), r"degrees: every degree must lie in 1..9"),
        (((3, 3), (-1,), ((),) * 3), r"continuity: every order must be 0 or more"),
        (((3, 3, 3), (2, 2), ((),) * 4, (3,)), r"virtual: only interior breaks .*, 1 to 2$"),
        (((3, 3, 3), (2, 2), ((),) * 4, (0,)), r"virtual: only interior breaks .*, 1 to 2$"),
        (((3,), (), ((),) * 2, (1,)), r"virtual: .* and one segment has none"),
        # four conditions at the start settle the first segment, whose end is a way-point
        (
            ((3,) * 6, (2,) * 5, (JERK, *((),) * 5, JERK), (2, 3, 4, 5)),
            r"contradict each other \(rank 23\); spread the degrees or the virtual breaks",
        ),
        (((3,), (), (((1, 0.0), (1, 1.0)), ())), r"prescribed\[0\]: orders must be distinct"),
        (((3,), (), ((), ((0, 1.0),))), r"prescribed\[1\]: orders must be distinct and at least 1"),
        (((3,), (), ((), ((1, np.inf),))), r"prescribed\[1\]: values must be finite"),
        (((3,), (), (REST, REST)), r"over-determined, 6 conditions, but only 4 coefficients"),
        # v at the start of a straight line is not free: the two way-points fix it
        (((1, 5), (0,), (((1, 0.0),), (), ())), r"5 conditions for 8 coefficients contradict each"),
    ],
)
def test_refusals(arguments: tuple[object, ...], message: str) -> None:
    with pytest.raises(TrajgapError, match=message):
        Interpolant(*arguments)  # type: ignore[arg-type]


def test_constructors_refuse() -> None:
    with pytest.raises(TrajgapError, match="at least two way-points are needed"):
        curves.cubic_spline_virtual(1)
    for degree in (1, 4, 11):
        with pytest.raises(TrajgapError, match="rest-to-rest needs degree 3, 5, 7 or 9"):
            curves.rest_to_rest(2, degree)
    with pytest.raises(TrajgapError, match="at least one segment"):
        curves.piecewise(())


def test_long_declarations_are_judged_too() -> None:
    start, end = ((1, 0.0),), ((1, 0.0),)
    assert curves.cubic_spline(200).rank == 800
    # As many conditions as coefficients, but the first line has three of them and two coefficients.
    with pytest.raises(TrajgapError, match="318 conditions for 318 coefficients contradict"):
        Interpolant((1, *(3,) * 79), (0, *(2,) * 78), (start, *((),) * 79, end))


def test_free_derivatives_complete_a_declaration() -> None:
    quintics = curves.piecewise((5, 5, 5), 2)
    assert quintics.free_derivatives == ((1, 1), (2, 1), (1, 2), (2, 2))
    full = quintics.completed()
    assert (full.free, full.conditions) == (0, 18)
    assert full.prescribed[1] == ((1, 0.0), (2, 0.0))
    # with v = a = 0 at all breaks that is the rest-to-rest quintic
    q = np.array([[0.3, -1.0], [1.1, 0.4], [0.9, 2.0], [-0.5, 2.5]])
    h = [0.7, 1.1, 0.4]
    mine, rest = fit(full, q, h), fit(curves.rest_to_rest(3, 5), q, h)
    np.testing.assert_allclose(mine.scaled, rest.scaled, atol=1e-13)


def test_free_virtual_position_becomes_a_waypoint() -> None:
    open_position = Interpolant(
        (5, 5), (2,), (REST, (), REST), virtual=(1,), name="quintics with a free break"
    )
    assert open_position.free == 3
    assert (1, 0) in open_position.free_derivatives
    assert open_position.completed().virtual == ()


def test_free_coefficients_that_are_not_nodal() -> None:
    loose = Interpolant((9,), (), (((1, 0.0),), ((1, 0.0),)))
    assert loose.free_derivatives == tuple((b, order) for order in (2, 3, 4) for b in (0, 1))
    torn = curves.piecewise((3, 3, 3), 0, ())
    with pytest.raises(
        TrajgapError, match="6 free coefficients, but only 4 of them are nodal derivatives; raise"
    ):
        torn.completed()


def test_declarations_compare_by_value() -> None:
    assert curves.three_five_three() == curves.three_five_three()
    assert hash(curves.three_five_three()) == hash(curves.three_five_three())
    assert curves.piecewise((3, 5, 3)).name == "3-5-3 polynomials, C2"


@pytest.mark.parametrize(
    ("ends", "name"),
    [
        (((1, 0.0),), "clamped C2 cubic spline"),
        (((2, 0.0),), "natural C2 cubic spline"),
        (((1, 0.5),), "C2 cubic spline with velocity given at the ends"),
        (((3, 0.0),), "C2 cubic spline with jerk given at the ends"),
    ],
)
def test_cubic_splines_are_named_by_ends(ends: tuple[tuple[int, float], ...], name: str) -> None:
    assert curves.cubic_spline(5, ends).name == name


FIRST, LAST = (0.5, -0.2, 0.0), (-0.3, 0.4, 0.7)
APART = curves.cubic_spline(3, ((1, FIRST),), finish=((1, LAST),))


def test_joints_that_agree_share_one_value() -> None:
    same = curves.cubic_spline(3, ((1, (0.5, 0.5, 0.5)),), ((1, [0.0, 0.0, 0.0]),))
    assert same == curves.cubic_spline(3, ((1, 0.5),), ((1, 0.0),))
    assert same.prescribed_joints is None
    rest = curves.cubic_spline(3, ((1, (0.0, 0.0)),))
    assert rest == curves.cubic_spline(3)
    assert rest.homogeneous
    assert (APART.prescribed_joints, APART.homogeneous) == (3, False)
    assert hash(APART) == hash(replace(APART))
    assert APART.name == "C2 cubic spline with velocity given at the ends"
    mixed = curves.cubic_spline(3, ((1, FIRST),), ((2, LAST),)).name
    assert mixed.endswith("with velocity given at the start, acceleration at the finish")


def test_numbers_of_joints_have_to_agree() -> None:
    q = np.array([[0.3, -1.0], [0.9, -0.55], [0.2, 0.35], [-0.45, 0.1]])
    with pytest.raises(TrajgapError, match="for 3 joints, way-points are given for 2"):
        Problem(q, Limits(1.0, joints=2), APART)
    with pytest.raises(TrajgapError, match="for 3 joints, the way-points have 2"):
        fit(APART, q, [1.0, 1.0, 1.0])
    with pytest.raises(TrajgapError, match="given for 2 and for 3 joints; give one value"):
        curves.cubic_spline(3, ((1, FIRST),), ((1, (0.1, 0.2)),))
    with pytest.raises(TrajgapError, match="values must be finite"):
        curves.cubic_spline(3, ((1, (0.1, np.nan)),))
