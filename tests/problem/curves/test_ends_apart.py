"""Derivatives at the ends that differ between both ends and between joints."""

from dataclasses import replace

import numpy as np
import pytest
from trajgap.problem import (
    Interpolant,
    Limits,
    Problem,
    TrajgapError,
    Verdict,
    check,
    cubic_spline,
    fit,
    piecewise,
    quintic_spline,
)

WAYPOINTS = np.array([[0.3, -1.0, 2.1], [0.9, -0.55, 2.6], [0.2, 0.35, 1.4], [-0.45, 0.1, 1.9]])
FIRST, LAST = (0.5, -0.2, 0.0), (-0.3, 0.4, 0.7)
"""Velocities at the start and at the finish, rad/s: no two of a joint alike."""
CLAMPED = cubic_spline(3, ((1, FIRST),), finish=((1, LAST),))
QUINTIC = quintic_spline(3, ((1, FIRST), (2, LAST)), ((1, LAST), (2, (0.0, 1.1, -0.6))))
MIXED = cubic_spline(3, ((1, FIRST),), ((2, (0.0, 1.1, -0.6)),))
H = np.array([0.8, 1.3, 0.7])
TIMES = np.concatenate([[0.0], np.cumsum(H)])
LIMITS = Limits([1.5, 1.8, 2.4], [6.0, 7.0, 9.0])


@pytest.mark.parametrize("curve", [CLAMPED, QUINTIC, MIXED])
def test_slower_time_divides_what_is_prescribed(curve: Interpolant) -> None:
    c = 3.7

    def slowed(at: tuple[tuple[int, object], ...]) -> tuple[tuple[int, object], ...]:
        return tuple((r, tuple(np.broadcast_to(v, 3) / c**r)) for r, v in at)

    ends = tuple(map(slowed, curve.ends))
    slow = piecewise(curve.degrees, curve.continuity[0], ends[0], finish=ends[1])
    np.testing.assert_allclose(
        fit(slow, WAYPOINTS, c * H)(c * TIMES[1:3] * 0.9, 1) * c,
        fit(curve, WAYPOINTS, H)(TIMES[1:3] * 0.9, 1),
        rtol=1e-10,
    )
    # Without that it is another path, and no stretch is said to repair it.
    found = check(Problem(WAYPOINTS, Limits(0.3, joints=3), curve), H)
    assert found.verdict is Verdict.VIOLATED
    assert found.feasible_time is None
    assert found.feasible_why == "a prescribed end derivative is not 0; stretching would change it"


def test_joints_that_agree_share_one_value() -> None:
    same = cubic_spline(3, ((1, (0.5, 0.5, 0.5)),), ((1, [0.0, 0.0, 0.0]),))
    assert same == cubic_spline(3, ((1, 0.5),), ((1, 0.0),))
    assert same.prescribed_joints is None
    rest = cubic_spline(3, ((1, (0.0, 0.0)),))
    assert rest == cubic_spline(3)
    assert rest.homogeneous
    assert (CLAMPED.prescribed_joints, CLAMPED.homogeneous) == (3, False)
    assert hash(CLAMPED) == hash(replace(CLAMPED))


def test_names_say_what_is_given_where() -> None:
    assert CLAMPED.name == "C2 cubic spline with velocity given at the ends"
    assert MIXED.name == (
        "C2 cubic spline with velocity given at the start, acceleration at the finish"
    )
    assert cubic_spline(2, ((1, 0.0),), ((1, 0.0),)).name == "clamped C2 cubic spline"


def test_numbers_of_joints_have_to_agree() -> None:
    with pytest.raises(TrajgapError, match="for 3 joints, way-points are given for 2"):
        Problem(WAYPOINTS[:, :2], Limits(1.0, joints=2), CLAMPED)
    with pytest.raises(TrajgapError, match="for 3 joints, the way-points have 2"):
        fit(CLAMPED, WAYPOINTS[:, :2], H)
    with pytest.raises(TrajgapError, match="given for 2 and for 3 joints; give one value"):
        cubic_spline(3, ((1, FIRST),), ((1, (0.1, 0.2)),))
    with pytest.raises(TrajgapError, match="values must be finite"):
        cubic_spline(3, ((1, (0.1, np.nan)),))
