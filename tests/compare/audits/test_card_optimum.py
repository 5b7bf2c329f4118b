"""The line of a card on the optimum: whose total is compared with what, and what is counted."""

from __future__ import annotations

from pathlib import Path

import pytest
from trajgap.compare.audits.card_optimum import _beside_profiles
from trajgap.compare.audits.case_audit import audit_case
from trajgap.compare.audits.study import Study
from trajgap.compare.documents import ClaimVerdict
from trajgap.problem import load_case, parse_case

EXAMPLES = Path(__file__).parents[3] / "docs" / "examples"

TWO = """
format = 1
id = "two"
title = "Two joints"
coupling = "{coupling}"
[source]
note = "Made up."
[robot]
name = "Two joints"
joints = ["a", "b"]
[units]
position = "rad"
velocity = "rad/s"
time = "s"
[waypoints]
joint_rows = [[0, 2, 3], [0, 1, 3]]
[limits]
velocity = 1.5
[interpolant]
family = "rest-to-rest"
degree = 3
[[claims]]
id = "one"
quantity = "durations"
where = "Table 1, row a"
joint = "a"
coupling = "per-joint"
durations = ["2.200", "1.100"]
total = "3.300"
[[claims]]
id = "other"
quantity = "durations"
where = "Table 1, row b"
joint = "b"
coupling = "per-joint"
durations = ["1.100", "2.200"]
total = "3.300"
[[claims]]
id = "longest"
quantity = "maximum"
where = "Table 1, last row"
coupling = "shared"
of = ["one", "other"]
durations = ["2.200", "2.200"]
total = "4.400"
"""


def line(text: str, **options: float) -> str:
    case = (
        load_case(EXAMPLES / text) if text.endswith(".toml") else parse_case(text, "made-up.toml")
    )
    return audit_case(Study(case, seeds=2, certify_seconds=0, **options)).card.optimum


def test_a_total_of_joints_that_are_planned_alone_stands_beside_their_own_optima() -> None:
    """A cubic from rest to rest peaks at 1.5 |Δq|/h: at 1.5 rad/s each joint needs 3 s, in 2 and
    1 s or in 1 and 2 s, and the longest durations take 4 s, as all joints together do; up to
    4.001 s while each joint stays within half a printed digit, 0.0005 s, of its own."""
    said = line(TWO.format(coupling="per-joint"))
    assert said.startswith("4.400 s is 10.0 % above 4.0000 to 4.0010 s, found at the joints' own ")
    assert said.endswith(" optima.")
    shared = line(TWO.format(coupling="shared"))
    assert shared.startswith("4.400 s is 10.0 % above the ")
    assert "joints' own" not in shared


@pytest.mark.parametrize(
    ("times", "said"),
    [
        # 1.5 rad/s · 2 s/1.5 = 2 rad: in 1.9 s the limit is broken, whatever the rounding.
        ('["1.900", "2.200"]\ntotal = "4.100"', "4.100 s, which breaks a limit, is 2.5 % above "),
        ('["2.200", "2.200"]\ntotal = "4.400"', "4.400 s is 10.0 % above "),
        ('["2.000", "2.000"]\ntotal = "4.000"', "4.000 s agrees with the "),
    ],
)
def test_a_distance_stands_with_the_limit_that_its_motion_breaks(times: str, said: str) -> None:
    text = TWO.format(coupling="shared").split("[[claims]]")[0]
    claim = (
        f'[[claims]]\nid = "all"\nquantity = "durations"\nwhere = "Table 1"\ndurations = {times}'
    )
    assert line(f"{text}{claim}\n").startswith(said)


def test_a_total_that_was_cut_off_is_said_to_agree_if_it_was() -> None:
    """6/1.499 s are 4.00267 s, of which 4.002 s is cut off and 4.003 s rounded."""
    text = TWO.format(coupling="shared").split("[[claims]]")[0].replace("= 1.5", "= 1.499")
    claim = """[[claims]]
id = "all"
quantity = "durations"
where = "Table 1"
durations = ["2.001", "2.001"]
"""
    assert line(f'{text}{claim}total = "4.002"\n').endswith("4.0027 s if digits were cut off.")
    assert line(f'{text}{claim}total = "4.003"\n').endswith("4.0027 s.")


@pytest.mark.parametrize(
    ("example", "said"),
    [
        # Its curve stands in for one that a case file cannot name: its optimum is not the tests'.
        (
            "kdl-velocity-profiles.toml",
            "All 4 printed times agree with their shortest trapezoidal profiles.",
        ),
        ("toppra-cubic-path.toml", "No printed total stands beside an optimum."),
        (
            "robotics1-2022-09-09.toml",
            "Both printed times agree with their shortest trapezoidal profiles.",
        ),
        (
            "robotics1-2017-07-11.toml",
            "3 printed totals agree with their proven optima; elsewhere without limits no motion "
            "is the shortest: there is no optimum to compare with.",
        ),
    ],
)
def test_the_card_of_an_example_speaks_of_its_own_numbers(example: str, said: str) -> None:
    assert line(example) == said


@pytest.mark.parametrize(
    ("verdicts", "said"),
    [
        (
            "not checkable",
            "Whether the printed time agrees with the shortest s-curve profile is open.",
        ),
        ("inconsistent", "The printed time does not agree with the shortest s-curve profile."),
        (
            "supported, refuted, not checkable",
            "1 of 3 printed times agree with their shortest s-curve profiles; 1 is open.",
        ),
    ],
)
def test_a_time_that_was_not_judged_is_not_said_to_disagree(verdicts: str, said: str) -> None:
    words = [ClaimVerdict(word) for word in verdicts.split(", ")]
    assert _beside_profiles(words, "s-curve") == said
