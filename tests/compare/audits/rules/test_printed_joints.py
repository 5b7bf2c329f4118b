"""What is said of printed joints and positions, on made-up digits."""

from __future__ import annotations

import numpy as np
import pytest
from support.findings import said_of, study_of
from trajgap.compare.audits.rules.printed_chain import judge_kinematics
from trajgap.compare.audits.rules.printed_joints import judge_joints
from trajgap.compare.audits.rules.replays import judge_replays
from trajgap.compare.documents import ClaimVerdict, Severity
from trajgap.nlp import Status, solve
from trajgap.problem import CaseError, Limits, Problem, load_case, parse_case, three_five_three

ARM = """
format = 1
id = "arm"
title = "two links in a plane"
[source]
year = 2024
[robot]
name = "arm"
joints = {joints}
[robot.dh]
convention = "standard"
length_unit = "m"
angle_unit = "deg"
joints = ["1", "2"]
d = [0, 0]
a = [0.7, 0.4]
alpha = [0, 0]
[units]
position = "deg"
velocity = "deg/s"
time = "s"
[waypoints]
labels = ["A", "B"]
joint_rows = {rows}
[limits]
velocity = 90
[interpolant]
family = "rest-to-rest"
degree = 5
[[claims]]
id = "most"
quantity = "statement"
where = "section 4"
joint = "{joint}"
checks = "varies_most"
"""
COLUMN = """
[[columns]]
id = "other"
where = "Table 3"
joint = "2"
unit = "deg"
values = [{values}]
"""
BOTH = '["1", "2"]', '[["10.0", "40.0"], ["20.0", "{}"]]'


@pytest.mark.parametrize(
    ("other", "joint", "verdict"),
    [
        ("45.0", "1", ClaimVerdict.SUPPORTED),
        ("45.0", "2", ClaimVerdict.INCONSISTENT),
        ("55.0", "1", ClaimVerdict.INCONSISTENT),
        ("50.0", "1", ClaimVerdict.NOT_CHECKABLE),  # equal within the rounding
        ("50.1", "1", ClaimVerdict.NOT_CHECKABLE),
        ("50.3", "1", ClaimVerdict.INCONSISTENT),  # 30.2 at least, beside 30.1 at most
    ],
)
def test_the_joint_that_varies_most(other: str, joint: str, verdict: ClaimVerdict) -> None:
    joints, rows = BOTH
    study = study_of(ARM.format(joints=joints, rows=rows.format(other), joint=joint))
    (found,) = said_of(study, judge_joints, "most", "TG110")
    assert found.verdict is verdict
    assert found.severity is (
        Severity.WARNING if verdict is ClaimVerdict.INCONSISTENT else Severity.INFO
    )


@pytest.mark.parametrize("joint", ["1", "2"])
def test_a_joint_that_varies_much_is_never_accused(joint: str) -> None:
    joints, rows = BOTH
    text = ARM.format(joints=joints, rows=rows.format("45.0"), joint=joint)
    study = study_of(text.replace("varies_most", "varies_much"))
    (found,) = said_of(study, judge_joints, "most", "TG110")
    assert found.verdict is ClaimVerdict.NOT_CHECKABLE
    assert found.severity is Severity.INFO
    assert "30.00" in found.message
    assert "25.00" in found.message
    assert "varies more" not in found.message


@pytest.mark.parametrize(
    ("column", "verdict", "words"),
    [
        ("", ClaimVerdict.NOT_CHECKABLE, "beside no other joint in print"),
        (COLUMN.format(values='"1.0", "9.0"'), ClaimVerdict.SUPPORTED, "8.00 of joint 2"),
        (COLUMN.format(values='"1.0", "99.0"'), ClaimVerdict.INCONSISTENT, "Joint 2 varies more."),
    ],
)
def test_joints_printed_in_columns_count_and_missing_ones_are_named(
    column: str, verdict: ClaimVerdict, words: str
) -> None:
    text = ARM.format(joints='["1"]', rows='[["10.0", "40.0"]]', joint="1") + column
    (found,) = said_of(study_of(text), judge_joints, "most", "TG110")
    assert found.verdict is verdict
    assert words in found.message
    assert ("Joint 2 is not printed" in found.message) == (not column)


PLACES = """
[[cartesian]]
id = "p"
where = "Table 2"
label = "place"
waypoint = "A"
unit = "m"
values = ["0.50", "-0.30", 0]
[[cartesian]]
id = "q"
where = "Table 2"
label = "above"
waypoint = "B"
unit = "m"
values = [{values}]
[[claims]]
id = "over"
quantity = "statement"
where = "Table 2"
checks = "above"
positions = ["q", "p"]
[[claims]]
id = "table"
quantity = "statement"
where = "section 2"
checks = "kinematics"
"""


def placed(values: str) -> str:
    joints, rows = BOTH
    return ARM.format(joints=joints, rows=rows.format("45.0"), joint="1") + PLACES.format(
        values=values
    )


@pytest.mark.parametrize(
    ("values", "verdict", "words"),
    [
        ('"0.50", "-0.30", "0.25"', ClaimVerdict.SUPPORTED, "0 m beside place and 0.25 m above"),
        ('"0.50", "-0.30", "-0.25"', ClaimVerdict.NOT_CHECKABLE, "-0.25 m above"),
        ('"0.50", "0.30", "0.25"', ClaimVerdict.NOT_CHECKABLE, "another sign of y it would be 0 m"),
        ('"-0.50", "0.30", "0.25"', ClaimVerdict.NOT_CHECKABLE, "another sign of x and y"),
        ('"0.90", "-0.30", "0.25"', ClaimVerdict.NOT_CHECKABLE, "stands 0.4 m beside place"),
    ],
)
def test_a_position_above_another(values: str, verdict: ClaimVerdict, words: str) -> None:
    (found,) = said_of(study_of(placed(values)), judge_joints, "over", "TG602")
    assert found.verdict is verdict
    assert found.severity is Severity.INFO
    assert words in found.message


def test_the_finding_on_the_chain_is_about_the_statement_that_claims_it() -> None:
    study = study_of(placed('"0.50", "-0.30", "0.25"'))
    (found,) = said_of(study, judge_kinematics, "table", "TG601")
    assert found.verdict is ClaimVerdict.INCONSISTENT  # a planar arm reaches no height
    silent = placed('"0.50", "-0.30", "0.25"').replace('"kinematics"', '"none"')
    silent += 'not_checkable = "no reason"\n'
    (found,) = said_of(study_of(silent), judge_kinematics, None, "TG601")
    assert found.claim is None


TWO = """
[[algorithms]]
id = "{id}"
name = "{id}"
kind = "pso"
[algorithms.settings]
particles = 6
iterations = {iterations}
c1 = 2
c2 = 2
position_initial = [0.3, 3]
velocity_initial = [-1, 1]
"""
AGAINST = """
[[claims]]
id = "faster"
quantity = "statement"
where = "abstract"
algorithm = "long"
against = "short"
checks = "none"
not_checkable = "no data"
"""


def test_replays_of_two_algorithms_stand_beside_the_sentence_that_compares_them() -> None:
    joints, rows = BOTH
    text = ARM.format(joints=joints, rows=rows.format("45.0"), joint="1")
    text += TWO.format(id="long", iterations=30) + TWO.format(id="short", iterations=1) + AGAINST
    (found,) = said_of(study_of(text), judge_replays, "faster", "TG401")
    assert not found.decides
    assert found.verdict is ClaimVerdict.NOT_CHECKABLE
    said = "one run of the long is no longer than one of the short with probability 100 %"
    assert said in found.message


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('joint = "1"\nchecks = "varies_most"', 'checks = "varies_much"',
         "claims[0].joint: is missing; name the joint that is said to vary much"),
        ('joint = "1"\nchecks = "varies_most"', 'checks = "varies_most"',
         "claims[0].joint: is missing; name the joint that is said to vary most"),
        ('positions = ["q", "p"]\n', "",
         "claims[1].positions: names two positions, and goes with checks = \"above\" only"),
        ('["q", "p"]', '["q", "r"]',
         "claims[1].positions[1]: 'r' is not the id of any of the carte"),
        ('checks = "kinematics"', 'checks = "none"\nnot_checkable = "x"\nagainst = "y"',
         "claims[2].against: goes with algorithm; name the one that is compared with it"),
    ],
)  # fmt: skip
def test_wrong_statements_are_refused(old: str, new: str, message: str) -> None:
    text = placed('"0.50", "-0.30", "0.25"')
    assert text.count(old) == 1
    with pytest.raises(CaseError) as caught:
        parse_case(text.replace(old, new), "made-up.toml")
    assert str(caught.value).startswith(f"made-up.toml: {message}")


def test_kinematics_without_positions_is_refused() -> None:
    text = placed('"0.50", "-0.30", "0.25"')
    start, end = text.index("[[cartesian]]"), text.index('[[claims]]\nid = "over"')
    bare = text[:start] + text[text.index('[[claims]]\nid = "table"') :]
    assert end > start
    with pytest.raises(CaseError, match=r"kinematics needs printed positions; add \[\[cartesian"):
        parse_case(bare, "made-up.toml")


@pytest.mark.parametrize(("unit", "total"), [(1.0, "77.68"), (np.pi / 180, "1.356")])
def test_the_palletisers_printed_joints_take_what_its_case_says(unit: float, total: str) -> None:
    """If joints 1 and 3 had the limit of joint 5: the claim about all joints says so."""
    case = load_case("irb460-pso-353")
    rows = {c.joint: [n.value for n in c.values] for c in case.columns}
    rows["5"] = [n.value for n in case.document.waypoints.joint_rows[0]]
    q = unit * np.array([rows[joint] for joint in "135"], dtype=float).T
    problem = Problem(q, Limits(velocity=np.deg2rad(80)), three_five_three())
    found = solve(problem)
    assert found.status is Status.OPTIMAL
    assert f"{found.total_time:.{len(total.split('.')[1])}f}" == total
    (claim,) = [c for c in case.claims if c.id == "all-joints"]
    assert f"{total} s" in claim.not_checkable
