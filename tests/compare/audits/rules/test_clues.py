"""What speaks for and against readings, on one joint that moves from rest to rest."""

from __future__ import annotations

import numpy as np
import pytest
from support.findings import study_of
from support.one_joint import HEAD
from trajgap.compare.audits.rules.clues import held_otherwise, reading_clues
from trajgap.compare.documents import HeldOtherwise, ReadingClue, Speaks
from trajgap.problem import CaseError, parse_case

READINGS = """
[[readings]]
id = "rad"
why = "as printed"
default = true
default_why = "The figure shows it."
[[readings]]
id = "deg"
why = "numbers usual in degrees"
units = { position = "deg", velocity = "deg/s" }
"""
AXIS = """
[[clues]]
id = "figure"
kind = "axis"
where = "Figure 3"
text = "labels of the acceleration"
quantity = "acceleration"
unit = "rad/s^2"
ticks = [{ticks}]
of = ["d"]
"""
SHEET = """
[[clues]]
id = "sheet"
kind = "data-sheet"
where = "maker's sheet"
text = "largest velocity"
quantity = "velocity"
unit = "deg/s"
values = [{value}]
"""
TURNS = """
[[clues]]
id = "turns"
kind = "half-turns"
where = "Table 1"
text = "digits of multiples of π"
joint = "1"
"""


def clues(tail: str, points: str = '"0.00", "1.30"', limit: str = "3.1") -> dict[str, ReadingClue]:
    """The one clue of a case, by reading; 1.3 rad in 1 s, from rest to rest."""
    text = HEAD.format(points=points, limit=limit, time="1.00", checks="optimal")
    return {one.reading: one for one in reading_clues(study_of(text + READINGS + tail))}


# A quintic from rest to rest over d in h accelerates to 10 d/(√3 h²): 7.506 for d = 1.3, h = 1.
@pytest.mark.parametrize(
    ("ticks", "rad", "deg"),
    [
        ('0, "5", "10"', Speaks.FOR, Speaks.AGAINST),
        ('"-5", "5"', Speaks.AGAINST, Speaks.AGAINST),  # one label, no step beyond it
        ('0, "5"', Speaks.FOR, Speaks.AGAINST),  # the axis may go on to 10
        ('0, "100"', Speaks.AGAINST, Speaks.AGAINST),
        ('0, "0.1"', Speaks.AGAINST, Speaks.FOR),  # 0.131 rad/s² in degrees
    ],
)
def test_a_curve_fills_its_axis_or_does_not(ticks: str, rad: Speaks, deg: Speaks) -> None:
    found = clues(AXIS.format(ticks=ticks))
    assert (found["rad"].speaks, found["deg"].speaks) == (rad, deg)
    assert "7.51 rad/s²" in found["rad"].computed
    assert "0.131 rad/s²" in found["deg"].computed


@pytest.mark.parametrize(
    ("limit", "value", "rad", "deg"),
    [
        ("120", "120", Speaks.AGAINST, Speaks.FOR),
        ("90", "120", Speaks.AGAINST, Speaks.FOR),
        ("130", "120", Speaks.AGAINST, Speaks.AGAINST),
        ("11", "120", Speaks.AGAINST, Speaks.AGAINST),  # a tenth of it is 12
        ('"2.1"', "120", Speaks.FOR, Speaks.AGAINST),  # 2.0944 rounds to it
    ],
)
def test_printed_limits_stand_beside_a_data_sheet(
    limit: str, value: str, rad: Speaks, deg: Speaks
) -> None:
    found = clues(SHEET.format(value=value), limit=limit)
    assert (found["rad"].speaks, found["deg"].speaks) == (rad, deg)


def test_equal_limits_are_said_to_be_equal() -> None:
    found = clues(SHEET.format(value="120"), limit="120")
    assert found["deg"].computed == "velocity limits equal those of the data sheet"
    assert "57.3 times" in found["rad"].computed


@pytest.mark.parametrize(
    ("points", "rad"),
    [
        ('"0.000", "3.142", "-6.283"', Speaks.FOR),
        ('"0.000", "3.142", "1.300"', Speaks.AGAINST),
        ('"0.000", "3.143", "1.300"', Speaks.AGAINST),
    ],
)
def test_angles_are_multiples_of_pi_within_their_rounding(points: str, rad: Speaks) -> None:
    found = clues(TURNS, points=points)
    assert (found["rad"].speaks, found["deg"].speaks) == (rad, Speaks.AGAINST)


SPLINE = """
format = 1
id = "spline"
title = "a uniform cubic B-spline"
[source]
year = 2024
[robot]
name = "arm"
joints = ["1"]
[units]
position = "rad"
velocity = "rad/s"
acceleration = "rad/s^2"
time = "s"
[waypoints]
joint_rows = [["0.10", "0.90", "-0.40", "0.30"]]
[limits]
velocity = 1.7
acceleration = 9
[interpolant]
family = "uniform-cubic-b-spline"
time = "stretched"
[[readings]]
id = "stretched"
why = "time linear in each segment"
[[readings]]
id = "timed"
why = "time smooth"
interpolant = { family = "uniform-cubic-b-spline", time = "timed" }
[[claims]]
id = "d"
quantity = "durations"
where = "Table 2"
durations = ["0.80", "1.10", "0.90"]
[[clues]]
id = "slopes"
kind = "smooth"
where = "section 1"
text = "slopes are equal"
quantity = "velocity"
of = ["d"]
"""


def test_a_velocity_that_jumps_speaks_against_equal_slopes() -> None:
    stretched, timed = reading_clues(study_of(SPLINE))
    assert (stretched.speaks, timed.speaks) == (Speaks.AGAINST, Speaks.FOR)
    assert stretched.computed.startswith("velocity jumps 2 times, by up to ")


def test_limits_held_at_samples_or_on_control_vertices() -> None:
    study = study_of(SPLINE)
    claim = study.case.claim("d")
    held = held_otherwise(study, claim, "main", "stretched")
    assert isinstance(held, HeldOtherwise)
    # A second route: V by solving (2) and (3), then differences over the durations.
    q, h = np.array([0.1, 0.9, -0.4, 0.3]), np.array([0.8, 1.1, 0.9])
    system = np.diag([5.0, 4, 4, 5]) + np.diag([1.0] * 3, 1) + np.diag([1.0] * 3, -1)
    v = np.linalg.solve(system / 6, q)
    v = np.array([v[0], *v, v[-1]])
    worst = 0.0
    for k in range(3):
        local = v[k : k + 4]
        worst = max(worst, abs(np.diff(local)).max() / h[k] / 1.7)
        worst = max(worst, abs(np.diff(local, 2)).max() / h[k] ** 2 / 9)
    assert held.vertices == pytest.approx(worst, rel=1e-12)
    assert held.sampled <= held.everywhere * (1 + 1e-12)
    assert held.everywhere <= worst * (1 + 1e-12)
    assert 0.97 * held.everywhere < held.sampled < held.everywhere


@pytest.mark.parametrize(
    ("limits", "low"),
    [
        # scipy's clamped cubic through 0, 1.2 and 1.1 rad in 1 and 1.5 s rises to 1.40776 rad, and
        # to 1.40772 rad at ten steps a segment; its speed to 1.60627 and 1.60320 rad/s.
        ("velocity = 3\nposition_upper = 1.25\nposition_lower = -0.05", 1.0 + 0.15772 / 0.65),
        ("velocity = 3\nposition_upper = 1.4", 1.0 + 0.00772 / 1.4),
        ("velocity = 1.605\nposition_upper = 1.5", 1.60320 / 1.605),
    ],
)
def test_every_limit_is_held_at_the_samples(limits: str, low: float) -> None:
    text = HEAD.format(points="0, 1.2, 1.1", limit="3", time='1.0", "1.5', checks="optimal")
    text = text.replace("velocity = 3", limits).replace("rest-to-rest", "cubic-spline")
    text = text.replace("degree = 5\n", "")
    study = study_of(text)
    held = held_otherwise(study, study.case.claim("d"), "main", "as-printed")
    assert isinstance(held, HeldOtherwise)
    assert held.sampled == pytest.approx(low, abs=1e-4)


def test_a_curve_without_control_vertices_says_so() -> None:
    study = study_of(SPLINE)
    held = held_otherwise(study, study.case.claim("d"), "main", "timed")
    assert isinstance(held, HeldOtherwise)
    assert "no control vertices" in str(held.vertices)


@pytest.mark.parametrize(
    ("tail", "message"),
    [
        (AXIS.format(ticks="0"), "clues[0].ticks: are all 0; give the labels of the axis"),
        (
            AXIS.format(ticks="1").replace('"rad/s^2"', '"rad/s"'),
            "clues[0].unit: 'rad/s' is no unit of acceleration; use one of rad/s^2, "
            "deg/s^2, m/s^2, cm/s^2, mm/s^2",
        ),
        (
            AXIS.format(ticks="1").replace('"d"', '"e"'),
            "clues[0].of[0]: 'e' is not the id of a claim; known: d, s",
        ),
        (
            AXIS.format(ticks="1").replace('"d"', '"s"'),
            "clues[0].of[0]: 's' is a claim of quantity 'statement'; "
            "name one that states durations",
        ),
        (SHEET.format(value="1, 2"), "clues[0].values: 2 values for 1 joints; give one each"),
        (
            SHEET.format(value="0"),
            "clues[0].values: hold a number that is not positive; a limit is",
        ),
        (
            TURNS.replace('"half-turns"', '"half-turn"'),
            "clues[0].kind: 'half-turn' is no kind of clue; did you mean 'half-turns'?",
        ),
        (
            TURNS.replace('"1"', '"2"'),
            "clues[0].joint: joint '2' is unknown; robot.joints lists 1",
        ),
    ],
)
def test_a_wrong_clue_is_refused_in_one_line(tail: str, message: str) -> None:
    text = HEAD.format(points="0, 1", limit="3", time="1", checks="optimal") + tail
    with pytest.raises(CaseError) as caught:
        parse_case(text, "made-up.toml")
    assert str(caught.value) == f"made-up.toml: {message}"


def test_a_reason_for_the_default_goes_with_the_default() -> None:
    text = HEAD.format(points="0, 1", limit="3", time="1", checks="optimal")
    text += READINGS.replace("default = true\n", "")
    with pytest.raises(CaseError, match=r"readings\[0\].default_why: goes with default = true"):
        parse_case(text, "made-up.toml")
