"""TG203 where one number speaks of all joints: some papers print the norm over the joints."""

from __future__ import annotations

import numpy as np
import pytest
from support.findings import said_of, study_of
from support.one_joint import one_joint
from trajgap.compare.audits.rules.norms import _top, largest_norm
from trajgap.compare.audits.rules.peaks import judge_peaks
from trajgap.compare.documents import ClaimVerdict, Confidence
from trajgap.problem import fit, rest_to_rest

ARM = """
format = 1
id = "planar-arm"
title = "Way-points and metrics of github.com/pvc192000/robot-trajectory-interpolation"
[source]
year = 2025
[robot]
name = "planar arm"
joints = ["1", "2"]
[units]
position = "deg"
velocity = "rad/s"
acceleration = "rad/s^2"
time = "s"
[waypoints]
joint_rows = [[0, 30, 30, 30, 75, 110, 110, 50], [0, -60, -90, -60, -90, -60, -90, 0]]
[interpolant]
{curve}
[[claims]]
id = "d"
quantity = "durations"
where = "metrics"
durations = [{times}]
[[claims]]
id = "p"
quantity = "peak"
where = "metrics"
of = "d"
derivative = "{derivative}"
{peak}
"""
QUINTIC = 'family = "quintic-spline"'
NATURAL = 'family = "cubic-spline"\nend_orders = [2]'


def _arm(curve: str, derivative: str, peak: str, times: str = "1, 1, 1, 1, 1, 1, 1") -> str:
    return ARM.format(curve=curve, derivative=derivative, peak=peak, times=times)


@pytest.mark.parametrize(
    ("curve", "derivative", "value"),
    [
        (QUINTIC, "velocity", "2.958025"),
        (QUINTIC, "acceleration", "6.810174"),
        (NATURAL, "velocity", "2.580258"),
    ],
)
def test_a_printed_norm_accuses_nobody(curve: str, derivative: str, value: str) -> None:
    """The repository prints norms over the joints; the largest joint alone has 6 to 20 % less."""
    study = study_of(_arm(curve, derivative, f'value = "{value}"'))
    (found,) = said_of(study, judge_peaks, "p", "TG203")
    assert found.verdict is ClaimVerdict.SUPPORTED
    assert "the largest norm over the joints" in found.message


@pytest.mark.parametrize(
    "peak", ['value = "2.99"', 'value = "2.70"', 'value = "2.958025"\njoint = "1"']
)
def test_what_is_no_norm_is_still_a_finding(peak: str) -> None:
    (found,) = said_of(study_of(_arm(QUINTIC, "velocity", peak)), judge_peaks, "p", "TG203")
    assert found.verdict is ClaimVerdict.INCONSISTENT


def test_the_room_that_coarse_digits_leave_is_said() -> None:
    """A duration printed as 1 may be 0.5 to 1.5 s: nearly any peak fits."""
    coarse, exact = (", ".join([one] * 7) for one in ('"1"', "1"))
    study = study_of(_arm(QUINTIC, "velocity", 'value = "2.958025"', coarse))
    (found,) = said_of(study, judge_peaks, "p", "TG203")
    assert "digits, which leaves 50 % either way." in found.message
    sharp = study_of(_arm(QUINTIC, "velocity", 'value = "2.4664"', exact))
    (found,) = said_of(sharp, judge_peaks, "p", "TG203")
    assert found.message.endswith("digits.")


def test_the_norm_moves_with_the_durations_as_first_order_says() -> None:
    study = study_of(_arm(QUINTIC, "velocity", 'value = "2.9"', ", ".join(['"1.000"'] * 7)))
    claim = study.case.claim("d")
    found = largest_norm(study, claim, "main", "as-printed", 1)
    problem = study.problem("main", "as-printed")

    def top(durations: np.ndarray) -> float:
        times = np.linspace(0.0, durations.sum(), 200_001)
        trajectory = fit(problem.curve, problem.waypoints, durations)
        return float(np.linalg.norm(trajectory(times, 1), axis=1).max())

    exact = top(np.ones(7))
    assert found.largest == pytest.approx(exact, rel=1e-8)
    moved = [top(np.ones(7) + 0.0005 * np.eye(7)[k]) - exact for k in range(7)]
    assert found.reach == pytest.approx(np.abs(moved).sum(), rel=0.01)


def test_the_largest_norm_is_that_of_a_dense_grid_and_never_below_it() -> None:
    waypoints = np.array([[0.0, 0.0], [1.0, -0.3], [0.2, 0.9]])
    trajectory = fit(rest_to_rest(2, 5), waypoints, np.array([0.8, 1.1]))
    for order in (1, 2, 3):
        top = max(_top(trajectory, k, order)[0] for k in range(2))
        times = np.linspace(0.0, 1.9, 200_001)
        dense = np.linalg.norm(trajectory(times, order), axis=1).max()
        assert dense <= top * (1 + 1e-12)
        assert top == pytest.approx(dense, rel=1e-4 if order == 3 else 1e-8)


def test_a_sampled_norm_is_not_called_equal() -> None:
    """Metrics of the natural cubic are sampled: 4.2253 beside a largest norm of 4.2398."""
    study = study_of(_arm(NATURAL, "acceleration", 'value = "4.225276"'))
    (found,) = said_of(study, judge_peaks, "p", "TG203")
    assert found.verdict is ClaimVerdict.SUPPORTED
    assert "slightly below the largest norm over the joints, 4.23976" in found.message
    assert found.confidence is Confidence.COMPUTED


def test_what_a_slip_explains_is_named() -> None:
    """Degree 7 has its largest acceleration 84√5/25 of the way by the squared time, 7.5132."""
    unit = one_joint("0, 1", "9", "1.00000", "within_limits", PEAK).replace(
        "degree = 5", "degree = 7"
    )
    for value, said in (
        ("3.36", "a factor √5 may have been lost in print"),
        ("7.5312", "off by more than"),
    ):
        text = unit.replace('time = "s"', 'time = "s"\nacceleration = "rad/s^2"')
        (found,) = said_of(study_of(text.replace("VALUE", value)), judge_peaks, "p", "TG203")
        assert found.verdict is ClaimVerdict.INCONSISTENT
        assert said in found.message
        assert found.confidence is Confidence.COMPUTED
    exact = study_of(text.replace("VALUE", "7.51"))
    (found,) = said_of(exact, judge_peaks, "p", "TG203")
    assert (found.verdict, found.confidence) == (ClaimVerdict.SUPPORTED, Confidence.PROVEN)


PEAK = """
[[claims]]
id = "p"
quantity = "peak"
where = "text"
of = "d"
derivative = "acceleration"
value = "VALUE"
"""
