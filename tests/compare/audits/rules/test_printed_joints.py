"""What is said of printed joints and positions, on made-up digits."""

from typing import Any

import numpy as np
import pytest
from support.findings import finding
from support.made_up import ARM, Numbers, entry, paper, sentence
from trajgap.compare.documents import ClaimVerdict, Severity
from trajgap.nlp import Status, solve
from trajgap.problem import Limits, Problem, load_case, three_five_three

LINKS = {"joints": ["1", "2"], "d": [0, 0], "a": [0.7, 0.4], "alpha": [0, 0]}


def arm(*parts: str, rows: tuple[Numbers, ...] = ("10.0 40.0", "20.0 45.0")) -> str:
    """Two links in a plane, of which joints are printed."""
    labels, robot = {"labels": ["A", "B"]}, {"dh": ARM | LINKS}
    return paper(rows, *parts, angle="deg", waypoints=labels, robot=robot, velocity=90)


def most(joint: str = "1", checks: str = "varies_most") -> str:
    return sentence("most", checks, joint=joint)


@pytest.mark.parametrize(
    ("other", "joint", "verdict"),
    [
        ("45.0", "1", "supported"),
        ("45.0", "2", "inconsistent"),
        ("55.0", "1", "inconsistent"),
        ("50.0", "1", "not checkable"),  # equal within the rounding
        ("50.1", "1", "not checkable"),
        ("50.3", "1", "inconsistent"),  # 30.2 at least, beside 30.1 at most
    ],
)
def test_the_joint_that_varies_most(other: str, joint: str, verdict: str) -> None:
    text = arm(most(joint), rows=("10.0 40.0", f"20.0 {other}"))
    found = finding(text, "most", "TG110")
    assert found.verdict == verdict
    assert (found.severity is Severity.WARNING) == (verdict == "inconsistent")
    assert found.severity is not Severity.ERROR


def test_digits_cut_off_towards_zero_may_span_more_around_it() -> None:
    """Joint 2 spans 30.2 at least, and joint 1 no more than that, or than 30.1."""
    for own, verdict in (("-10.0 20.0", "not checkable"), ("10.0 40.0", "inconsistent")):
        found = finding(arm(most(), rows=(own, "20.0 50.3")), "most", "TG110")
        assert found.verdict == verdict


@pytest.mark.parametrize("joint", ["1", "2"])
def test_a_joint_that_varies_much_is_never_accused(joint: str) -> None:
    found = finding(arm(most(joint, "varies_much")), "most", "TG110")
    assert (found.verdict, found.severity) == (ClaimVerdict.NOT_CHECKABLE, Severity.INFO)
    assert "30.00" in found.message
    assert "25.00" in found.message


@pytest.mark.parametrize(
    ("values", "verdict", "words"),
    [
        (None, "not checkable", "compared with no other printed joint"),
        (["1.0", "9.0"], "supported", "8.00 of joint 2"),
        (["1.0", "99.0"], "inconsistent", "Joint 2 varies more."),
    ],
)
def test_joints_printed_in_columns_count_and_missing_ones_are_named(
    values: list[str] | None, verdict: str, words: str
) -> None:
    keys = {"id": "other", "where": "Table 3", "joint": "2", "unit": "deg", "values": values}
    column = entry("columns", **keys) if values else ""
    text = arm(most(), column, rows=("10.0 40.0",))
    found = finding(text, "most", "TG110")
    assert found.verdict == verdict
    assert words in found.message
    assert ("Joint 2 is not printed" in found.message) == (values is None)


def position(name: str, waypoint: str, *values: Any) -> str:
    keys = {"label": name, "waypoint": waypoint, "unit": "m", "values": list(values)}
    return entry("cartesian", id=name, where="Table 2", **keys)


def placed(*above: str, kinematics: str = sentence("table", "kinematics")) -> str:
    return arm(
        position("place", "A", "0.50", "-0.30", 0),
        position("above", "B", *above),
        sentence("over", "above", positions=["above", "place"]),
        kinematics,
    )


@pytest.mark.parametrize(
    ("values", "verdict", "words"),
    [
        ("0.50 -0.30 0.25", "supported", "0 m beside place and 0.25 m above"),
        ("0.50 -0.30 -0.25", "not checkable", "-0.25 m above"),
        ("0.50 0.30 0.25", "not checkable", "another sign of y it would be 0 m"),
        ("-0.50 0.30 0.25", "not checkable", "another sign of x and y"),
        ("0.90 -0.30 0.25", "not checkable", "lies 0.4 m beside place"),
        ("0.10 -0.30 0.25", "not checkable", "lies 0.4 m beside place"),
    ],
)
def test_a_position_above_another(values: str, verdict: str, words: str) -> None:
    found = finding(placed(*values.split()), "over", "TG602")
    assert (found.verdict, found.severity) == (verdict, Severity.INFO)
    assert words in found.message


def test_the_finding_on_the_chain_is_about_the_statement_that_claims_it() -> None:
    height = "0.50", "-0.30", "0.25"
    found = finding(placed(*height), "table", "TG601")
    assert found.verdict is ClaimVerdict.INCONSISTENT  # a planar arm reaches no height
    silent = sentence("table", "none", not_checkable="no reason")
    assert finding(placed(*height, kinematics=silent), None, "TG601")


def test_replays_of_two_algorithms_stand_beside_the_sentence_that_compares_them() -> None:
    both = {"c1": 2, "c2": 2, "position_initial": [0.3, 3], "velocity_initial": [-1, 1]}
    named = (
        entry("algorithms", id=k, name=k, kind="pso",
              settings={"particles": 6, "iterations": n} | both)
        for k, n in (("long", 30), ("short", 1))
    )  # fmt: skip
    sides = {"algorithm": "long", "against": "short", "not_checkable": "no data"}
    text = arm(*named, sentence("faster", "none", **sides))
    found = finding(text, "faster", "TG401")
    assert not found.decides
    assert found.verdict is ClaimVerdict.NOT_CHECKABLE
    said = "one run of the long is no longer than one of the short with probability 100 %"
    assert said in found.message


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
