"""Numbers of profiles: their parts, their states at an instant, and what digits leave of them."""

from typing import Any

import numpy as np
import pytest
from support.findings import finding, study_of
from support.made_up import paper, sentence, total
from trajgap.compare.audits import PrintedRow
from trajgap.compare.audits.axis_profile import (
    AxisProfile,
    AxisState,
    Phase,
    Sizes,
    shortest_s_curve as s_curve,
    shortest_trapezoid as trapezoid,
)
from trajgap.compare.audits.named_profiles import fourth_order
from trajgap.compare.audits.number_range import NumberRange
from trajgap.compare.audits.profile_motions import ProfileMotion, ProfileQuestion, questions

STILL = np.zeros((2, 1, 2))
WITHIN = np.full((1, 4), 9.0)


def motion(*laws: AxisProfile) -> ProfileMotion:
    points = [law.start.position for law in laws] + [laws[-1].at(np.inf).position]
    question = ProfileQuestion(np.array(points)[:, None], STILL, WITHIN)
    return ProfileMotion(question, tuple((law,) for law in laws), False)


def phased(*phases: tuple[float, float, float]) -> AxisProfile:
    return AxisProfile(AxisState(0.0), tuple(Phase(*one) for one in phases))


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize(
    ("phases", "parts"),
    [
        # With jerk on both sides, and none at the end of the second.
        (
            [(0.1, 0, 5), (0.2, 0.5, 0), (0.1, 0.5, -5), (0.4, 0, 0), (0.3, -0.2, 0)],
            (0.4, 0.4, 0.3, 0.1, 0.0),
        ),
        # Braked, and speeding up once more: that is not a second first part.
        (
            [(0.2, 0, 4), (0.1, 0.8, -8), (0.1, 0, -3), (0.1, -0.3, 3), (0.2, 0.5, 0)],
            (0.3, 0.0, 0.4, 0.2, 0.0),
        ),
        ([(0.5, 1, 0), (0.6, 0, 0), (0.4, -1, 0), (0.1, -1, 10)], (0.5, 0.6, 0.5, 0.0, 0.1)),
    ],
)
def test_parts_are_told_by_the_sign_of_the_acceleration(
    phases: list[tuple[float, float, float]], parts: tuple[float, ...], sign: float
) -> None:
    own = phased(*((t, sign * a, sign * j) for t, a, j in phases))
    assert motion(own).parts == pytest.approx(parts)


def test_an_instant_in_a_later_segment_is_one_of_that_segment() -> None:
    laws = [trapezoid(AxisState(x), AxisState(y), Sizes(9, 4, np.inf)) for x, y in ((0, 1), (1, 5))]
    whole = motion(*laws)
    # 1 rad in 1 s and 4 rad in 2 s: halfway there at the largest speed, which is 4 rad/s.
    for state in whole.near(2.0, 0):
        np.testing.assert_allclose(state[:2], [3.0, 4.0], atol=1e-6)


def test_values_on_both_sides_of_a_jump_are_told_apart() -> None:
    found = NumberRange(1.0, np.array([1.0, 1.01, 2.0, 2.01]), (1.01, 2.0))
    for low, high, meets, spans in (
        (1.005, 1.02, True, True),
        (1.99, 2.0, True, True),
        (1.5, 1.6, False, True),
        (0.5, 0.6, False, False),
        (2.5, 2.6, False, False),
    ):
        assert (found.meets((low, high)), found.spans((low, high))) == (meets, spans)


FROM_SPEED = {"family": "polynomials", "degrees": [5]}
LIMITS = {"velocity": 2, "acceleration": 4, "jerk": 20}


def said(
    profile: str, value: str, points: Any, ends: Any = None, more: Any = None, **limits: Any
) -> str:
    """A case file with the total of a profile between states."""
    curve = FROM_SPEED | ({} if ends is None else {"end_derivatives": [ends, 0],
                                                   "finish_derivatives": [0, 0]})  # fmt: skip
    own = total("t", value, profile=profile, other_curve="blends", **(more or {}))
    units = limits.pop("units", None)
    return paper(points, own, curve=curve, units=units, **(LIMITS | limits))


def test_the_goal_is_moved_to_both_sides() -> None:
    study = study_of(said("s-curve", "1.0", [[0, 1]], 1))
    asked = questions(PrintedRow(study, study.case.claim("t"), study.pairs[0]), False)
    off = [float(one.points[-1, 0]) - 1.0 for one in asked]
    assert [np.sign(x) for x in off] == [0, -1, 1]
    assert np.abs(off).max() < 1e-11


def test_snap_is_of_jerk_in_the_unit_of_time() -> None:
    """900 rad/s⁴ are 0.9 rad/s³ in a millisecond."""
    value = f"{1000 * fourth_order(1.0, 2.0, 4.0, 20.0, 900.0):.2f}"
    text = said("fourth-order", value, [[0, 1]], None, {"snap": 0.9}, units={"time": "ms"})
    assert finding(text, "t", "TG304").verdict == "supported"


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize(
    ("speed", "goal", "limits", "words"),
    [
        # It stops 0.5 rad away and comes back.
        (2, 0.25, {"position_lower": -0.4, "position_upper": 0.4}, "leaves the position range"),
        (3, 2.0, {}, "The start lies outside the limits"),
    ],
)
def test_what_a_profile_does_beyond_its_limits_is_said(
    speed: float, goal: float, limits: dict[str, float], words: str, sign: int
) -> None:
    text = said("trapezoidal", "1.0", [[0, sign * goal]], sign * speed, **limits)
    assert words in finding(text, "t", "TG304").message


BOOK = {"velocity": 10, "acceleration": 10, "jerk": 30}


def test_the_algorithm_of_the_book_is_no_optimum_where_a_motion_is_shorter() -> None:
    """Example 3.11 takes 1.93837 s, and 1.78045 s would do."""
    text = said("biagiotti-melchiorri", "1.938", [[0, 10]], 7, **BOOK)
    text += sentence("best", "optimal", "t")
    assert finding(text, "t", "TG304").verdict == "supported"
    assert finding(text, "best", "TG304").verdict == "inconsistent"
    best = s_curve(AxisState(0.0), AxisState(30.0), Sizes(10, 10, 30))
    alike = said("biagiotti-melchiorri", f"{best.total_time:.4f}", [[0, 30]], None, **BOOK)
    assert finding(alike, "t", "TG304").message.endswith(" s too.")
