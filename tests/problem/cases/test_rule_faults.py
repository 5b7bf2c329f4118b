"""Keys that single rules of an audit read: what is refused of them, on papers that are made up."""

import pytest
from support.checkout import ROOT
from support.made_up import claim, paper, row, sentence, total
from support.refusals import Refusal, each_refusal
from support.toml_text import Bare, block
from trajgap.problem import CaseError, parse_case

MOVED = row("d", "1.00"), sentence("s", "optimal", "d")
LABELS = {"waypoints": {"labels": ["A", "B"]}, "angle": "deg"}
LINKS = block(
    "[robot.dh]",
    {"convention": "standard", "length_unit": "m", "angle_unit": "deg", "joints": ["1", "2"]}
    | {"d": [0, 0], "a": [0.7, 0.4], "alpha": [0, 0]},
)
ARM = paper(["10.0 40.0", "20.0 45.0"], **LABELS, velocity=90)
BLENDED = row("row", "2.00 1.00 3.00", other_curve="linear segments with parabolic blends")
SLOW = {"velocity": 2, "acceleration": [1, 4]}
PROFILED = total("t", "2.00", other_curve="blends", profile="trapezoidal")
SPLINE = {"curve": {"family": "cubic-spline"}, "velocity": 250}
GIVEN = row("given", "1.0 0.5")
AT = {"of": "given", "derivative": "velocity", "place": "1"}
BASES = {
    "one joint": paper([[0, 1]], *MOVED, velocity=3),
    "two joints without links": ARM,
    "two joints": ARM.replace("[units]", f"{LINKS}\n[units]", 1),
    "blends": paper(["10.00 35.00 25.00 10.00"], BLENDED, velocity=100),
    "profile": paper([[0, 1], [0, -3]], PROFILED, **SLOW),
    "jerk of one joint": paper([[0, 1], [0, -3]], PROFILED, **SLOW, jerk=[9, Bare("inf")]),
    "value": paper([[45, 90, 5]], GIVEN, claim("one", "value", value="1", **AT), **SPLINE),
    "values": paper(
        [[45, 90, 5]] * 2, GIVEN, claim("one", "value", values=["1", "2"], **AT), **SPLINE
    ),
    "family": (ROOT / "tests/support/family.toml").read_text("utf-8"),
}
"""Text that each section of the file stands for."""


@each_refusal("rules")
def test_each_fault_has_its_line(one: Refusal) -> None:
    base = BASES[one.section]
    parse_case(base, "made-up.toml")
    one.said_by(lambda: parse_case(one.text(base), "made-up.toml"), "made-up.toml: ")


@pytest.mark.parametrize("joint", ["1", "2"])
def test_a_profile_of_one_joint_needs_the_limit_of_that_joint(joint: str) -> None:
    own = total("t", "2.00", other_curve="blends", profile="s-curve", joint=joint)
    text = paper([[0, 1], [0, -3]], own, **SLOW, jerk=[9, Bare("inf")])
    if joint == "1":
        assert parse_case(text, "made-up.toml").claims[0].profile == "s-curve"
        return
    with pytest.raises(CaseError, match=r'"s-curve" needs limits.jerk, and none is stated; add'):
        parse_case(text, "made-up.toml")


def test_a_peak_is_of_durations_or_of_a_profile() -> None:
    peak = claim("p", "peak", derivative="velocity", value="2.0", of="t")
    for keys, refused in (({"profile": "trapezoidal"}, False), ({}, True)):
        own = total("t", "2.00", other_curve="blends", **keys)
        text = paper([[0, 1]], own, peak, velocity=2, acceleration=1)
        if refused:
            with pytest.raises(CaseError, match="'t' is a claim of quantity 'total_time'; name"):
                parse_case(text, "made-up.toml")
        else:
            assert len(parse_case(text, "made-up.toml").claims) == 2
