"""Values at a place, means, integrals and norms of a printed motion, by scipy and closed forms."""

from collections.abc import Sequence
from math import sqrt
from typing import Any

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.interpolate import CubicSpline
from support.findings import audited_text, finding, study_of, verdicts
from support.made_up import CUBIC, Numbers, claim, paper, peak, row
from trajgap.compare.audits import printed_rows
from trajgap.compare.audits.rules.beside import Beside
from trajgap.compare.audits.rules.motion_numbers import NAMES, measured
from trajgap.compare.audits.rules.peaks import _norm_top, largest_norm
from trajgap.compare.documents import ClaimVerdict, Confidence
from trajgap.problem import Curve, Printed, cubic_spline, fit, rest_to_rest, uniform_cubic_b_spline

EXAM = [45, 90, -45, 45]
"""Robotics I, exam of February 5, 2018, exercise 4: the table on page 12 follows."""
SPLINE = CubicSpline([0, 1, 1.5, 3], EXAM, bc_type="clamped")


def made_up(derivative: str, rows: Sequence[list[float]] = (EXAM,), **keys: Any) -> str:
    given = row("given", [1, 0.5, 1.5], state="before")
    one = claim("one", "value", of="given", derivative=derivative, **keys)
    limits = {"velocity": 250, "acceleration": 1000}
    return paper(rows, given, one, curve={"family": "cubic-spline"}, angle="deg", **limits)


def verdict_of(
    derivative: str, rows: Sequence[list[float]] = (EXAM,), **keys: Any
) -> ClaimVerdict | None:
    return finding(made_up(derivative, rows, **keys), "one", "TG211").verdict


def test_ends_instants_and_largest_values_are_those_of_scipys_spline() -> None:
    rows = [EXAM, [10.0, -20.0, 35.0, 30.0]]
    curve = CubicSpline([0, 1, 1.5, 3], np.array(rows).T, bc_type="clamped")
    times = np.linspace(0, 3, 300_001)

    def judged(name: str, at: np.ndarray, **where: Any) -> ClaimVerdict | None:
        return verdict_of(name, rows, values=[f"{v:.3f}" for v in at], **where)

    for name, order in (("position", 0), ("velocity", 1), ("acceleration", 2)):
        found = curve(times, order)
        top, bottom = found.max(axis=0), found.min(axis=0)
        for place, at, beyond in (
            ("start", found[0], 0.01),
            ("finish", found[-1], 0.01),
            ("largest", top, 0.01),
            ("smallest", bottom, -0.01),  # samples do not reach the true value
        ):
            assert judged(name, at, place=place) is ClaimVerdict.SUPPORTED, (name, place)
            far = judged(name, at + beyond, place=place)
            assert far is ClaimVerdict.INCONSISTENT, (name, place)
        assert judged(name, curve(0.7, order), time=0.7) is ClaimVerdict.SUPPORTED


def test_either_side_of_a_jump_may_be_meant() -> None:
    before, after = float(SPLINE(0.9, 3)), float(SPLINE(1.1, 3))
    for value, verdict in (
        (before, ClaimVerdict.SUPPORTED),
        (after, ClaimVerdict.SUPPORTED),
        ((before + after) / 2, ClaimVerdict.INCONSISTENT),
    ):
        assert verdict_of("jerk", place="2", value=f"{value:.2f}") is verdict


@pytest.mark.parametrize(
    ("durations", "time", "value", "verdict"),
    [
        # The acceleration jumps from -6 to 12 where the durations meet.
        ("1.02 1.00", "1.0", "12", "supported"),
        ("0.98 1.00", "1.0", "-6.2", "supported"),
        ("1.09 1.00", "1.0", "12", "supported"),  # the instant may be cut off
        ("1.09 1.00", "0.9", "12", "inconsistent"),
        ("0.98 1.00", "1.0", "3", "inconsistent"),
        ("1.00 1.00", "1.0", "3", "inconsistent"),
        ("1.00 1.00", "0.0", "0", "supported"),  # the arm rests before
        ("1.00 1.00", "0.0", "6", "supported"),
        ("1.00 1.00", "0.0", "3", "inconsistent"),
        ("1.00 1.00", "2.0", "0", "supported"),
    ],
)
def test_a_rounded_instant_may_be_on_either_side_of_a_jump(
    durations: str, time: str, value: str, verdict: str
) -> None:
    one = claim("one", "value", of="d", derivative="acceleration", time=time, value=value)
    text = paper([[0, 1, 3]], row("d", durations), one, curve=CUBIC, velocity=90)
    assert finding(text, "one", "TG211").verdict == verdict


def test_a_printed_instant_is_an_interval() -> None:
    for time, verdict in (("1.3", ClaimVerdict.SUPPORTED), (1.3, ClaimVerdict.INCONSISTENT)):
        assert verdict_of("position", time=time, value=f"{float(SPLINE(1.34)):.3f}") is verdict


@pytest.mark.parametrize(("derivative", "value"), [("position", "90"), ("acceleration", "0")])
def test_nothing_is_said_of_an_instant_after_the_end(derivative: str, value: str) -> None:
    text = made_up(derivative, time="3.5", value=value)
    assert verdicts(audited_text(text))["one"] is ClaimVerdict.NOT_CHECKABLE


H = 1.25
# Of q(s) = 10 s^3 - 15 s^4 + 6 s^5 rad with s = t/h.
CLOSED = {
    ("velocity", "mean"): 1 / H,
    ("velocity", "rms"): sqrt(10 / 7) / H,
    ("velocity", "integral"): 1.0,
    ("velocity", "integral-square"): 10 / 7 / H,
    ("acceleration", "mean"): 2 * 15 / 8 / H**2,
    ("jerk", "integral-square"): 720 / H**5,
    ("jerk", "rms"): sqrt(720) / H**3,
}


def verdict_on(derivative: str, measure: str, value: str, time: str = "1.2500") -> ClaimVerdict:
    keys = {"derivative": derivative, "measure": measure, "of": "d", "value": value}
    text = paper([[0, 1]], row("d", time), claim("m", "measure", **keys), velocity=9)
    found = finding(text, "m", "TG208")
    assert NAMES[measure] in found.message
    return found.verdict


@pytest.mark.parametrize(("derivative", "measure"), CLOSED)
def test_a_measure_is_its_closed_form(derivative: str, measure: str) -> None:
    exact = CLOSED[derivative, measure]
    assert verdict_on(derivative, measure, f"{exact:.4f}") is ClaimVerdict.SUPPORTED
    assert verdict_on(derivative, measure, f"{0.9 * exact:.4f}") is ClaimVerdict.INCONSISTENT


def test_what_samples_give_is_supported_and_digits_leave_room() -> None:
    times = np.linspace(0, 1, 100)
    jerk = (60 - 360 * times + 360 * times**2) / H**3
    coarse = float(np.sqrt((jerk**2).mean()))
    assert coarse > 1.01 * CLOSED["jerk", "rms"]
    assert verdict_on("jerk", "rms", f"{coarse:.4f}") is ClaimVerdict.SUPPORTED
    assert verdict_on("jerk", "rms", f"{1.2 * coarse:.4f}") is ClaimVerdict.INCONSISTENT
    # 1.2499 s, cut off to 1.2: four per cent away.
    mean = f"{1 / 1.2499:.4f}"
    assert verdict_on("velocity", "mean", mean, "1.2") is ClaimVerdict.SUPPORTED
    assert verdict_on("velocity", "mean", mean, "1.200") is ClaimVerdict.INCONSISTENT


@pytest.mark.parametrize(("derivative", "measure"), CLOSED)
@pytest.mark.parametrize("time", [0.0151, 0.0249])
def test_a_duration_of_few_digits_leaves_more(derivative: str, measure: str, time: float) -> None:
    """Both are printed as 0.02 s: the square of jerk changes by a factor of 12 between them."""
    power = {"velocity": 1, "acceleration": 2, "jerk": 3}[derivative]
    power = 2 * power - 1 if measure == "integral-square" else power
    power = 0 if measure == "integral" else power
    exact = CLOSED[derivative, measure] * (H / time) ** power
    assert verdict_on(derivative, measure, f"{exact:.4f}", "0.02") is ClaimVerdict.SUPPORTED
    if 0 < power < 5:  # beyond, numbers are refused for their size
        far = f"{exact * (time / 0.008) ** power:.4f}"
        assert verdict_on(derivative, measure, far, "0.02") is ClaimVerdict.INCONSISTENT


@pytest.mark.parametrize(
    "curve", [cubic_spline(3, ((2, 0.0),)), uniform_cubic_b_spline(4, "timed")]
)
def test_measures_are_those_of_adaptive_quadrature(curve: Curve) -> None:
    points = np.array([[0.1, 0.5], [0.9, -0.2], [-0.3, 0.1], [0.4, 1.0]])
    motion = fit(curve, points, np.array([0.8, 1.1, 0.9]))
    breaks = motion.breaks
    for order in (1, 2):
        found = measured(motion, order, "integral")

        def norm(t: float, order: int = order) -> float:
            return float(np.linalg.norm(motion(t, order)))

        whole = quad(norm, breaks[0], breaks[-1], points=breaks[1:-1], limit=400)[0]
        assert found.norm == pytest.approx(whole, rel=1e-6)
        own = quad(lambda t, o=order: abs(motion(t, o)[1]), *breaks[[0, -1]], limit=400)[0]
        assert found.joints[1] == pytest.approx(own, rel=1e-6)


def test_one_number_of_several_joints_may_be_their_norm_largest_mean_or_sum() -> None:
    motion = fit(cubic_spline(1), np.array([[0.0, 0.0], [3.0, 4.0]]), np.array([2.0]))
    found = measured(motion, 1, "mean")
    assert found.meant(None) == {
        " of the norm over the joints": pytest.approx(2.5),
        " of the largest joint": pytest.approx(2.0),
        " averaged over the joints": pytest.approx(1.75),
        " summed over the joints": pytest.approx(3.5),
    }


@pytest.mark.parametrize(
    ("exact", "reach", "far", "sampled", "said"),
    [
        # 2.0 is rounded from 1.95 to 2.05, or cut off from up to 2.1.
        (1.90, 0.06, 0.12, 1.90, "rounding"), (2.10, 0.06, 0.12, 2.10, "rounding"),
        (1.90, 0.04, 0.08, 1.90, "cut off"), (2.16, 0.04, 0.08, 2.16, "cut off"),
        (1.60, 0.00, 0.30, 1.60, "off"), (2.45, 0.00, 0.30, 2.45, "off"),
        (3.00, 0.00, 0.30, 1.70, "sampling"), (3.00, 0.00, 0.30, 2.30, "sampling"),
        (3.00, 0.00, 0.30, 1.60, "off"), (3.00, 0.00, 0.30, 2.45, "off"),
        (1.155, 0.0, 0.01, 1.155, "off"), (4.00, 0.00, 0.30, 4.00, "off"),
    ],
)  # fmt: skip
def test_a_number_agrees_as_far_as_its_digits_and_those_of_the_motion_reach(
    exact: float, reach: float, far: float, sampled: float, said: str
) -> None:
    room = (1.95, 2.05), (1.95, 2.1)
    one = Beside(Printed("2.0"), *room, exact, reach, far, (sampled, sampled), "rad")
    assert one.kind == said
    assert one.fits is (said != "off")


QUINTIC = {"family": "quintic-spline"}
NATURAL = {"family": "cubic-spline", "end_orders": [2]}
ONES = [1] * 7


def arm(curve: dict[str, Any], top: str, times: Numbers = ONES) -> str:
    """Way-points and metrics of github.com/pvc192000/robot-trajectory-interpolation."""
    units = {"velocity": "rad/s", "acceleration": "rad/s^2"}
    rows = [[0, 30, 30, 30, 75, 110, 110, 50], [0, -60, -90, -60, -90, -60, -90, 0]]
    return paper(rows, row("d", times), top, curve=curve, angle="deg", units=units)


def speed(value: str, **keys: str) -> str:
    return peak("p", "d", "velocity", value, **keys)


@pytest.mark.parametrize(
    ("curve", "printed", "verdict"),
    [
        (QUINTIC, speed("2.958025"), "supported"),
        (QUINTIC, peak("p", "d", "acceleration", "6.810174"), "supported"),
        (NATURAL, speed("2.580258"), "supported"),
        # What is no norm is still a finding.
        (QUINTIC, speed("2.99"), "inconsistent"),
        (QUINTIC, speed("2.70"), "inconsistent"),
        (QUINTIC, speed("2.958025", joint="1"), "inconsistent"),
    ],
)
def test_a_printed_norm_accuses_nobody(curve: dict[str, Any], printed: str, verdict: str) -> None:
    """The repository prints norms over the joints; the largest joint alone has 6 to 20 % less."""
    found = finding(arm(curve, printed), "p", "TG203")
    assert found.verdict == verdict
    assert ("the largest norm over the joints" in found.message) or verdict == "inconsistent"


def test_the_norm_moves_with_the_durations_as_first_order_says() -> None:
    study = study_of(arm(QUINTIC, speed("2.9"), "1.000 " * 7))
    (row,) = printed_rows(study, study.case.claim("d"))
    largest, reach = largest_norm(row, 1)
    problem = row.posed()

    def top(durations: np.ndarray) -> float:
        times = np.linspace(0.0, durations.sum(), 200_001)
        trajectory = fit(problem.curve, problem.waypoints, durations)
        return float(np.linalg.norm(trajectory(times, 1), axis=1).max())

    exact = top(np.ones(7))
    assert largest == pytest.approx(exact, rel=1e-8)
    moved = [top(np.ones(7) + 0.0005 * np.eye(7)[k]) - exact for k in range(7)]
    assert reach == pytest.approx(np.abs(moved).sum(), rel=0.01)


def test_the_largest_norm_is_that_of_a_dense_grid_and_never_below_it() -> None:
    waypoints = np.array([[0.0, 0.0], [1.0, -0.3], [0.2, 0.9]])
    trajectory = fit(rest_to_rest(2, 5), waypoints, np.array([0.8, 1.1]))
    for order in (1, 2, 3):
        top = max(_norm_top(trajectory, k, order)[0] for k in range(2))
        times = np.linspace(0.0, 1.9, 200_001)
        dense = np.linalg.norm(trajectory(times, order), axis=1).max()
        assert dense <= top * (1 + 1e-12)
        assert top == pytest.approx(dense, rel=1e-4 if order == 3 else 1e-8)


def test_a_sampled_norm_is_not_called_equal() -> None:
    """Metrics of the natural cubic are sampled: 4.2253 beside a largest norm of 4.2398."""
    text = arm(NATURAL, peak("p", "d", "acceleration", "4.225276"))
    found = finding(text, "p", "TG203")
    assert found.verdict is ClaimVerdict.SUPPORTED
    assert "slightly below the largest norm over the joints, 4.23976" in found.message
    assert found.confidence is Confidence.COMPUTED


@pytest.mark.parametrize(
    ("value", "verdict", "said", "known"),
    [
        ("3.36", "inconsistent", "a factor √5 may have been lost in print", Confidence.COMPUTED),
        ("7.5312", "inconsistent", "was found to explain the difference", Confidence.COMPUTED),
        ("7.51", "supported", "", Confidence.PROVEN),
    ],
)
def test_what_a_slip_explains(value: str, verdict: str, said: str, known: Confidence) -> None:
    """Degree 7 has its largest acceleration 84√5/25 of the way by the squared time, 7.5132."""
    parts = row("d", "1.00000"), peak("p", "d", "acceleration", value)
    text = paper([[0, 1]], *parts, curve={"family": "rest-to-rest", "degree": 7}, velocity=9)
    found = finding(text, "p", "TG203")
    assert (found.verdict, found.confidence) == (verdict, known)
    assert said in found.message
