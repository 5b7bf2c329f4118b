"""TG211: values at one place, beside scipy's splines and an exam's printed table."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.interpolate import CubicSpline
from support.findings import said_of, study_of
from trajgap.compare.audits.case_audit import audit_case
from trajgap.compare.audits.rules.values import judge_values
from trajgap.compare.documents import ClaimVerdict
from trajgap.problem import CaseError, parse_case

HEAD = """
format = 1
id = "values"
title = "values of a spline"
source = { year = 2018 }
robot = { name = "arm", joints = JOINTS }
waypoints = { joint_rows = ROWS }
limits = { velocity = 250, acceleration = 1000 }
interpolant = { family = "cubic-spline" }
[units]
position = "deg"
velocity = "deg/s"
acceleration = "deg/s^2"
jerk = "deg/s^3"
time = "s"
[[claims]]
id = "given"
quantity = "durations"
where = "page 2"
durations = [1, 0.5, 1.5]
state = "before"
"""
CLAIM = """
[[claims]]
id = "one"
quantity = "value"
where = "page 12"
of = "given"
"""
EXAM = [45, 90, -45, 45]
"""Robotics I, exam of February 5, 2018, exercise 4: the table on page 12 follows."""
VELOCITIES = ["0", "-175.7143", "-215.3571", "0"]
ACCELERATIONS = ["621.4286", "-972.8571", "814.2857", "-527.1429"]


def made_up(keys: str, rows: list[list[float]] | None = None) -> str:
    rows = rows or [EXAM]
    joints = str([str(j + 1) for j in range(len(rows))]).replace("'", '"')
    return HEAD.replace("JOINTS", joints).replace("ROWS", str(rows)) + CLAIM + keys


def verdict_of(keys: str, rows: list[list[float]] | None = None) -> ClaimVerdict | None:
    (found,) = said_of(study_of(made_up(keys, rows)), judge_values, "one", "TG211")
    return found.verdict


@pytest.mark.parametrize("knot", range(4))
def test_an_exam_and_its_table_agree(knot: int) -> None:
    for name, column in (("velocity", VELOCITIES), ("acceleration", ACCELERATIONS)):
        keys = f'derivative = "{name}"\nplace = "{knot + 1}"\nvalue = "{column[knot]}"'
        assert verdict_of(keys) is ClaimVerdict.SUPPORTED
    wrong = f'derivative = "velocity"\nplace = "{knot + 1}"\nvalue = "{float(column[knot]):.1f}"'
    assert verdict_of(wrong) is ClaimVerdict.INCONSISTENT


def test_ends_instants_and_largest_values_are_those_of_scipys_spline() -> None:
    rows = [EXAM, [10.0, -20.0, 35.0, 30.0]]
    curve = CubicSpline([0, 1, 1.5, 3], np.array(rows).T, bc_type="clamped")
    times = np.linspace(0, 3, 300_001)

    def both(values: np.ndarray) -> str:
        return f"values = {[f'{v:.3f}' for v in values]}".replace("'", '"')

    for name, order in (("position", 0), ("velocity", 1), ("acceleration", 2)):
        found = curve(times, order)
        top, bottom = found.max(axis=0), found.min(axis=0)
        for place, at, beyond in (
            ("start", found[0], 0.01),
            ("finish", found[-1], 0.01),
            ("largest", top, 0.01),
            ("smallest", bottom, -0.01),  # samples do not reach the true value
        ):
            keys = f'derivative = "{name}"\nplace = "{place}"\n{both(at)}'
            assert verdict_of(keys, rows) is ClaimVerdict.SUPPORTED, (name, place)
            keys = f'derivative = "{name}"\nplace = "{place}"\n{both(at + beyond)}'
            assert verdict_of(keys, rows) is ClaimVerdict.INCONSISTENT, (name, place)
        keys = f'derivative = "{name}"\ntime = 0.7\n{both(curve(0.7, order))}'
        assert verdict_of(keys, rows) is ClaimVerdict.SUPPORTED


def test_either_side_of_a_jump_may_be_meant() -> None:
    curve = CubicSpline([0, 1, 1.5, 3], EXAM, bc_type="clamped")
    before, after = float(curve(0.9, 3)), float(curve(1.1, 3))
    for value, verdict in (
        (before, ClaimVerdict.SUPPORTED),
        (after, ClaimVerdict.SUPPORTED),
        ((before + after) / 2, ClaimVerdict.INCONSISTENT),
    ):
        keys = f'derivative = "jerk"\nplace = "2"\nvalue = "{value:.2f}"'
        assert verdict_of(keys) is verdict


def test_a_printed_instant_is_an_interval() -> None:
    curve = CubicSpline([0, 1, 1.5, 3], EXAM, bc_type="clamped")
    keys = f'derivative = "position"\ntime = "1.3"\nvalue = "{float(curve(1.34)):.3f}"'
    assert verdict_of(keys) is ClaimVerdict.SUPPORTED
    assert verdict_of(keys.replace('"1.3"', "1.3")) is ClaimVerdict.INCONSISTENT


@pytest.mark.parametrize(
    ("keys", "said"),
    [
        ('place = "5"\nvalue = 1', "'5' is no place of the motion"),
        ("value = 1", "or time is needed"),
        ('place = "1"\nvalue = 1\nTWO', "is one number for 2 joints"),
        ('place = "1"\ntime = 1\nvalue = 1', "or time is needed, and not both"),
    ],
)
def test_a_place_is_asked_for_in_one_line(keys: str, said: str) -> None:
    rows = [EXAM, EXAM] if "TWO" in keys else None
    text = made_up(f'derivative = "velocity"\n{keys.removesuffix("TWO")}', rows)
    with pytest.raises(CaseError, match=said):
        parse_case(text, "made-up.toml")


def test_the_report_says_where() -> None:
    audit = audit_case(study_of(made_up('derivative = "velocity"\nplace = "2"\nvalue = "-175.8"')))
    assert any("at way-point 2" in finding.message for finding in audit.findings)
    assert audit.card.errors == () or "value" in audit.card.errors[0]
