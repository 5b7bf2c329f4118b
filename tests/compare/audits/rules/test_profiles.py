"""Shortest profiles from rest to rest, against time-optimal control solved as linear programs."""

from typing import Any

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import linprog
from support.findings import audited_text, finding, verdicts
from support.made_up import QUINTIC, Numbers, claim, entry, paper, peak, sentence, total
from trajgap.compare.audits.named_profiles import resting_total, s_curve, sine_jerk, trapezoidal
from trajgap.compare.documents import Basis, ClaimVerdict, Finding
from trajgap.problem import CaseError, parse_case

STEPS = 120


def farthest(time: float, velocity: float, acceleration: float, jerk: float) -> float:
    """The longest way from rest to rest in a time, with the jerk constant in many steps."""
    h = time / STEPS
    lower = np.tril(np.ones((STEPS, STEPS)))
    a = h * lower
    v = h * (lower @ a) - h / 2 * a
    q = h * v.sum(axis=0)
    bounds = [(-jerk, jerk)] * STEPS if np.isfinite(jerk) else [(None, None)] * STEPS
    rows = np.vstack([a, -a, v, -v])
    right = np.repeat([acceleration, acceleration, velocity, velocity], STEPS)
    still = np.vstack([a[-1], v[-1]])
    found = linprog(-q, A_ub=rows, b_ub=right, A_eq=still, b_eq=[0, 0], bounds=bounds)
    return float(-found.fun)


@pytest.mark.parametrize("way", [0.05, 0.4, 1.5, 6.0])
@pytest.mark.parametrize("limits", [(2.0, 4.0, 20.0), (0.6, 4.0, 20.0), (2.0, 90.0, 20.0)])
def test_no_motion_passes_an_s_curve(way: float, limits: tuple[float, float, float]) -> None:
    time = s_curve(way, *limits)
    assert farthest(time, *limits) == pytest.approx(way, rel=5e-3)
    assert s_curve(way, *limits[:2], np.inf) == trapezoidal(way, *limits[:2], np.inf)
    assert s_curve(way, *limits[:2], 1e9) == pytest.approx(trapezoidal(way, *limits), rel=1e-3)


def test_a_trapezoid_reaches_its_speed_or_does_not() -> None:
    assert trapezoidal(0.25, 2.0, 4.0, 1.0) == 0.5
    assert trapezoidal(3.0, 2.0, 4.0, 1.0) == 2.0
    ways, limits = np.array([[0.25, 3.0], [0.0, 0.25]]), np.tile([2.0, 4.0, np.inf], (2, 1))
    assert resting_total("trapezoidal", ways, limits) == 2.5


def of_half_sines(ramp: float, held: float, cruise: float, jerk: float) -> np.ndarray:
    """Way and peaks of velocity and acceleration, from the jerk alone, by numerical integration."""
    lengths = np.array([ramp, held, ramp, cruise, ramp, held, ramp])
    signs = (1, 0, -1, 0, -1, 0, 1)
    ends = np.concatenate([[0.0], np.cumsum(lengths)])

    def moment(power: int, until: float) -> float:
        """∫ (until − t)^power j(t) dt: acceleration, velocity and twice the way."""
        total = 0.0
        for start, length, sign in zip(ends[:-1], lengths, signs, strict=True):
            end = min(start + length, until)
            if sign and end > start:
                total += sign * quad(
                    lambda t, a=start, n=length: (until - t) ** power
                    * jerk * np.sin(np.pi * (t - a) / n), start, end,
                )[0]  # fmt: skip
        return total

    assert moment(0, ends[-1]) == pytest.approx(0, abs=1e-9)
    assert moment(1, ends[-1]) == pytest.approx(0, abs=1e-9)
    return np.array([moment(2, ends[-1]) / 2, moment(1, ends[3]), moment(0, ends[1])])


@pytest.mark.parametrize(
    ("ramp", "held", "cruise"),
    [(0.31, 0.52, 0.77), (0.31, 0.52, 0.0), (0.31, 0.0, 0.77), (0.31, 0.0, 0.0)],
)
def test_half_sines_are_a_jerk_smaller_by_half_pi(ramp: float, held: float, cruise: float) -> None:
    peaks = of_half_sines(ramp, held, cruise, 9.0)
    total = 4 * ramp + 2 * held + cruise
    assert sine_jerk(*peaks, 9.0) == pytest.approx(total, rel=1e-9)
    # One limit larger lets it be no longer; all larger, shorter.
    assert sine_jerk(*peaks, 9.9) < total
    assert sine_jerk(*peaks, 9.0) > s_curve(*peaks, 9.0)
    assert sine_jerk(*peaks, np.inf) == trapezoidal(*peaks, np.inf)


def test_joints_on_a_straight_line_share_one_time_law() -> None:
    # s from 0 to 1 within 2/3 (joint 2) and 1 (joint 1): 3/2 + 2/3 s; alone both take 2 s.
    ways, limits = np.array([[1.0, 3.0]]), np.array([[2.0, 1.0, np.inf], [2.0, 4.0, np.inf]])
    assert resting_total("trapezoidal", ways, limits, True) == pytest.approx(13 / 6)
    assert resting_total("trapezoidal", ways, limits) == pytest.approx(2.0)
    assert farthest(13 / 6, 2 / 3, 1.0, np.inf) == pytest.approx(1.0, rel=2e-2)
    # A joint that rests asks for nothing, even where it must not move.
    still = np.vstack([limits, np.zeros(3)])
    way = np.array([[1.0, 3.0, 0.0]])
    assert resting_total("trapezoidal", way, still, True) == pytest.approx(13 / 6)
    assert resting_total("s-curve", np.zeros((2, 3)), still, True) == 0.0
    assert resting_total("sine-jerk", ways, limits, True) == pytest.approx(13 / 6)
    one = np.array([[2.0, 1.0, 5.0]])
    for profile in ("trapezoidal", "s-curve", "sine-jerk"):
        alone = resting_total(profile, np.array([[0.7]]), one)
        assert resting_total(profile, np.array([[0.7]]), one, True) == pytest.approx(alone)


CLAIM = {"other_curve": "blends"}
"""A total of another curve than the file's own."""


def profiled(profile: str, value: str, rows: Any, curve: Any = QUINTIC, **more: Any) -> str:
    """A case file with the total of a profile: keys of it, or limits of the joints."""
    own = {key: more.pop(key) for key in ("path", "deceleration", "snap") if key in more}
    return paper(rows, total("t", value, profile=profile, **CLAIM | own), curve=curve, **more)


def judged(*asked: Any, **more: Any) -> Finding:
    return finding(profiled(*asked, **more), "t", "TG304")


@pytest.mark.parametrize(
    ("profile", "value", "verdict"),
    [
        ("sine-jerk", "1.362", ClaimVerdict.SUPPORTED),
        ("sine-jerk", "1.220", ClaimVerdict.INCONSISTENT),
        ("trapezoidal", "1.000", ClaimVerdict.SUPPORTED),
        ("trapezoidal", "1.018", ClaimVerdict.INCONSISTENT),
        ("s-curve", "1.220", ClaimVerdict.SUPPORTED),
        ("s-curve", "1.00", ClaimVerdict.INCONSISTENT),
    ],
)
def test_printed_totals_of_profiles(profile: str, value: str, verdict: ClaimVerdict) -> None:
    """1 rad: half a second of 4 rad/s² each way; with jerk 0.2 + sqrt(0.04 + 1) s.

    With half sines a ramp of π/2 · 0.2 s.
    """
    limits = {"velocity": 2, "acceleration": 4, "jerk": 20}
    assert judged(profile, value, [[0, 1]], **limits).verdict is verdict
    # 1.009 s is within what way-points that are rounded leave.
    rounded = judged(profile, value.replace("1.018", "1.009"), ["0.00 1.00"], **limits)
    wrong = (profile, value) in (("s-curve", "1.00"), ("sine-jerk", "1.220"))
    assert (rounded.verdict is ClaimVerdict.SUPPORTED) == (not wrong)


TWO = [[0, 1], [0, -3]]
SLOW = {"velocity": 2, "acceleration": [1, 4]}
STRAIGHT = {"path": "straight"}


ARC = [[0, 1]]
ONE = {"velocity": 2, "acceleration": 4, "jerk": 20}
LONG = {"velocity": 0.9, "acceleration": 2}
MOVING = {"family": "polynomials", "degrees": [5], "finish_derivatives": [0, 0]}
FROM_1 = MOVING | {"end_derivatives": [1, 0]}
# From a thousandth of a rad/s it takes half a millisecond less.
FROM_0 = MOVING | {"end_derivatives": [0.001, 0]}


def cubic(start: Any = 0, finish: Any = 0) -> dict[str, Any]:
    """A curve with velocities at its ends, joint by joint."""
    ends = {"end_derivatives": [start], "finish_derivatives": [finish]}
    return {"family": "polynomials", "degrees": [3], "end_orders": [1]} | ends


@pytest.mark.parametrize(
    ("asked", "more", "said"),
    [
        (("2.00", TWO), SLOW, "supported: as long as its slowest joint needs, takes 2 s"),
        (("2.17", TWO), SLOW | STRAIGHT, "supported: straight line in each segment, tak"),
        (("2.00", TWO), SLOW | STRAIGHT, "inconsistent: is 7.69 % shorter"),
        (("2.17", TWO), SLOW, "not checkable: fits if the joints stay on a straight"),
        (("2.30", TWO), SLOW, "inconsistent: is 15.00 % longer"),
        # Joint 1 needs 2 s. Joint 2 comes back to its last speed: 0.5 + 1.0056 + 0.575 s.
        (("2.00", TWO, cubic([0, -1])), SLOW, "supported: fits"),
        (("2.08", TWO, cubic(0, [0, 0.3])), SLOW, "supported: fits"),
        (("2.00", TWO, cubic(0, [0, 0.3])), SLOW, "inconsistent: is 3.88 % shorter"),
        (("2.17", TWO, cubic(0, [0, 0.3])), SLOW, "inconsistent: is 4.30 % longer"),
        (("2.10", TWO, cubic(["0.100", "-0.300"])), SLOW, "not checkable: profile on a straight"),
        (("1.85", TWO, cubic(["0.100", "-0.300"])), SLOW, "inconsistent: is 4.18 % shorter"),
        (("1.85", TWO, cubic("0.00")), SLOW, "inconsistent: is 7.50 % shorter"),
        (("2.00", TWO, cubic()), SLOW, "supported: fits"),
        # 1 rad from 1 rad/s: the peak is sqrt(4.5), above 2 rad/s, so 1/16 s of cruise remain.
        (("0.8125", ARC, FROM_1), ONE, "supported: fits"),
        (("0.8325", ARC, FROM_1), ONE, "inconsistent: is 2.46 % longer"),
        (("0.8125", ARC, FROM_1, "sine-jerk"), ONE, "not checkable: from rest to rest only"),
        (("0.8125", ARC, FROM_1, "fourth-order"), ONE | {"snap": 900}, "not checkable: only"),
        # Within 4 rad/s² and 1 rad/s² it takes sqrt(2 (1/4 + 1)) s.
        (("1.581", ARC), ONE | {"deceleration": 1}, "supported: fits"),
        (("1.000", ARC), ONE | {"deceleration": 1}, "inconsistent: shorter"),
        # It takes 1.5611 s, which may be rounded up, so that the limits are kept.
        (("1.56", ARC), LONG, "supported: fits"),
        (("1.57", ARC), LONG, "supported: fits"),
        (("1.55", ARC), LONG, "inconsistent: shorter"),
        (("1.58", ARC), LONG, "inconsistent: longer"),
        (("1.56", ARC, FROM_0), LONG, "supported: fits"),
        (("1.57", ARC, FROM_0), LONG, "supported: fits"),
        (("1.55", ARC, FROM_0), LONG, "inconsistent: shorter"),
        (("1.58", ARC, FROM_0), LONG, "inconsistent: longer"),
    ],
)
def test_a_total_is_set_beside_that_of_its_profile(
    asked: tuple[Any, ...], more: dict[str, Any], said: str
) -> None:
    value, rows, curve, profile = (*asked, *(QUINTIC, "trapezoidal")[len(asked) - 2 :])
    found = judged(profile, value, rows, curve, **more)
    verdict, words = said.split(": ")
    assert found.verdict == verdict
    assert words in found.message
    # Between moving ends the ends of the digits are tried, and what lies between is not enclosed.
    assert (found.basis is Basis.COMPUTED) == ("between the states" in found.message)


def test_a_moving_joint_may_be_too_early_for_the_slowest_one() -> None:
    """Joint 1 may take up to 0.87 s, and not again before 1.2385 s (ruckig)."""
    curve = MOVING | {key: [[1, 0], 0] for key in ("end_derivatives", "finish_derivatives")}
    for value, verdict in (("1.06", "inconsistent"), ("1.24", "supported")):
        found = judged("s-curve", value, [[0, "0.2000"], [0, "0.7000"]], curve, **ONE)
        assert found.verdict == verdict
        assert "Each joint by itself can arrive within 1.06023 s" in found.message


def test_a_joint_that_must_not_move_and_does_is_no_fault_of_the_total() -> None:
    found = judged("trapezoidal", "2.00", TWO, velocity=2, acceleration=[0, 4])
    assert found.verdict is ClaimVerdict.NOT_CHECKABLE
    assert "a joint with limit 0 moves" in found.message


def test_an_optimal_profile_is_the_shortest() -> None:
    for value, verdict in (("1.220", "supported"), ("1.400", "inconsistent")):
        own = total("t", value, profile="s-curve", **CLAIM)
        text = paper([[0, 1]], own, sentence("s", "optimal", "t"), curve=QUINTIC, **ONE)
        assert finding(text, "s", "TG304").verdict == verdict


@pytest.mark.parametrize(
    ("time", "value", "verdict"),
    [
        # 1 rad within 1.9 rad/s and 4 rad/s²: it cruises from 0.475 s to 0.526 s.
        ("0.5", "4", "supported"),
        ("0.5", "-4", "supported"),
        ("0.500", "4", "inconsistent"),
        ("0.0", "0", "supported"),
        ("1.5", "0", "supported"),
        ("1.5", "-4", "inconsistent"),
    ],
)
def test_an_acceleration_may_be_that_of_either_side(time: str, value: str, verdict: str) -> None:
    own = total("t", "1.00", profile="trapezoidal", **CLAIM)
    asked = claim("v", "value", of="t", derivative="acceleration", time=time, value=value)
    text = paper([[0, 1]], own, asked, curve=QUINTIC, velocity="1.90", acceleration=4)
    assert finding(text, "v", "TG304").verdict == verdict


def of_profile(value: Numbers, asked: dict[str, Any], own: dict[str, Any]) -> Finding:
    """The finding on a peak velocity of the profile of two joints on a straight line."""
    printed = total("t", own.pop("total", "2.17"), profile="trapezoidal", **STRAIGHT, **CLAIM | own)
    top = peak("p", "t", "velocity", value, **asked)
    text = paper([[0, 1], [0, -3]], printed, top, curve=QUINTIC, velocity=2, acceleration=[1, 4])
    return finding(text, "p", "TG304")


@pytest.mark.parametrize(
    ("value", "joint", "verdict"),
    [
        # The joints take 3/2 + 2/3 s: joint 2 reaches its 2 rad/s, and joint 1 a third of it.
        ("2.0", None, "supported"),
        ("0.67", None, "inconsistent"),
        ("2.0", "2", "supported"),
        ("0.67", "1", "supported"),
        ("2.0", "1", "inconsistent"),
        (["0.67", "2.0"], None, "supported"),
        (["9.9", "2.0"], None, "inconsistent"),
    ],
)
def test_a_peak_of_no_joint_is_the_largest(value: Numbers, joint: str | None, verdict: str) -> None:
    found = of_profile(value, {} if joint is None else {"joint": joint}, {})
    assert found.verdict == verdict, found.message


def test_a_peak_of_a_joint_that_the_profile_lacks_is_not_checkable() -> None:
    found = of_profile("9.9", {"joint": "1"}, {"joint": "2"})
    assert found.verdict is ClaimVerdict.NOT_CHECKABLE
    assert found.message == "No number is printed for the joints of this profile."


def test_a_peak_of_a_profile_of_another_problem_is_refused() -> None:
    own = total("t", "1.0", profile="trapezoidal", problem="one", **CLAIM)
    top = peak("p", "t", "velocity", "2.0")
    text = paper([[0, 1]], own, top, curve=QUINTIC, velocity=2, acceleration=4)
    with pytest.raises(CaseError, match="'t' belongs to another problem"):
        parse_case(text, "made-up.toml")


@pytest.mark.parametrize(
    ("slower", "velocity", "verdict"),
    [
        ("2.05", 2, "supported"),
        ("2.50", 2, "inconsistent"),
        ("2.50", 0, "not checkable"),  # no way is possible within 0
        (None, 2, "not checkable"),
    ],
)
def test_one_way_serves_all_limits(slower: str | None, velocity: int, verdict: str) -> None:
    """3 rad within 2 and 4 take 2 s, and within 2 rad/s and 3.636 rad/s² 2.05 s."""
    first = total("t", "2.00", profile="trapezoidal", problem="one", **CLAIM)
    other = entry("problems", id="two", limits={"velocity": velocity, "acceleration": "3.636"})
    parts = [first, entry("problems", id="one"), other]
    if slower is not None:
        parts.append(total("u", slower, profile="trapezoidal", problem="two", **CLAIM))
    text = paper([[0, 1]], *parts, curve=QUINTIC, velocity=2, acceleration=4)
    text = text.replace("joint_rows = [[0, 1]]", 'not_printed = "the arc"\ncount = 2')
    found = verdicts(audited_text(text))
    assert set(found.values()) == {verdict}


@pytest.mark.parametrize(
    ("keys", "why"),
    [
        ({"profile": "s-curve", "deceleration": 1}, "deceleration: goes with profile"),
        ({"profile": "s-curve", "snap": 1}, "snap: goes with profile"),
        ({"profile": "fourth-order"}, "snap: is missing"),
        ({"profile": "s-curve", "plateau": 1}, "plateau: goes with profile"),
        ({"profile": "jerk-impulses"}, "plateau: is missing"),
        ({"profile": "trapezoidal", "deceleration": [1, 2]}, "deceleration: 2 values for 1 joints"),
        ({"quantity": "phases", "phases": [1, 0, 1]}, "profile: is missing"),
        ({"quantity": "phases", "phases": [1, 0, 1], "profile": "s-curve"}, "describe one segment"),
    ],
)
def test_keys_that_a_profile_does_not_have_are_refused(keys: dict[str, Any], why: str) -> None:
    own = {"value": "1.0", "quantity": "total_time"} if "phases" not in keys else {}
    given = own | CLAIM | keys
    text = paper([[0, 1, 2]], claim("t", given.pop("quantity"), **given), curve=QUINTIC, **ONE)
    with pytest.raises(CaseError, match=why):
        parse_case(text, "made-up.toml")
