"""A claim is called by its text; one without is called by a sentence from its own numbers."""

from __future__ import annotations

import re
from itertools import permutations
from typing import Any

import pytest
from support.base_case import BASE
from support.made_up import claim, gain, peak, row, sentence, total
from trajgap.compare.audits.stated import claim_text
from trajgap.problem import load_case, parse_case, published_ids
from trajgap.problem.cases import ConditionsClaim, StatementClaim

ONE: Any = {"problem": "one"}
TIMES = row("times", "0.961 1.258 1.078", total="3.297", **ONE)
ALONE = BASE.split("[[claims]]")[0] + TIMES
HEAD = ALONE + TIMES.replace('"times"', '"second"')
COUNTED: Any = {"degrees": [3, 5, 3]}


def measured(derivative: str, measure: str, **number: Any) -> str:
    return claim("m", "measure", of="times", derivative=derivative, measure=measure, **ONE | number)


@pytest.mark.parametrize(
    ("stated", "text"),
    [
        (row("c", "0.9 1.2 1.0", **ONE), "The segments take 0.9, 1.2 and 1.0 s."),
        (
            row("c", "0.9 1.2 1.0", problem="two", joint="b", algorithm="pso", total="3.1"),
            "PSO: the segments of joint b take 0.9, 1.2 and 1.0 s, 3.1 s in total.",
        ),
        (
            row("c", "2.7998", total="2.7998", other_curve="septic", **ONE),
            "The segment takes 2.7998 s (septic).",
        ),
        (row("c", "0.11 " * 12, total="1.3", **ONE), "The 12 segments take 1.3 s in total."),
        (
            claim("c", "maximum", of=["times"], durations=["0.9", "1.2", "1.0"], **ONE),
            "The longest durations of the segments are 0.9, 1.2 and 1.0 s.",
        ),
        (total("c", "3.5", **ONE), "The motion takes 3.5 s."),
        (
            total("c", "3.5", state="before", other_curve="straight lines", objective="e", **ONE),
            "Before optimisation, the motion takes 3.5 s (straight lines).",
        ),
        (gain("times", "second", percent="10.9"), "The motion is 10.9 % shorter."),
        (gain("times", "second", seconds="0.4"), "The motion is 0.4 s shorter."),
        (gain("times", "second"), "The motion is shorter."),
        (
            peak("c", "times", "velocity", "94.8", joint="a", **ONE),
            "The largest velocity of joint a is 94.8 deg/s.",
        ),
        (
            peak("c", "times", "acceleration", ["7.9", "8.0"], **ONE),
            "The largest accelerations of the joints are 7.9 and 8.0 deg/s^2.",
        ),
        (
            measured("velocity", "mean", values=["36.9", "59.8"]),
            "The mean velocities of the joints are 36.9 and 59.8 deg/s.",
        ),
        (
            measured("acceleration", "rms", joint="b", value="5.1"),
            "The root mean square of the acceleration of joint b is 5.1 deg/s^2.",
        ),
        (measured("velocity", "integral", value="12"), "The integral of the velocity is 12."),
        (
            measured("velocity", "integral-square", value="12"),
            "The integral of the squared velocity is 12.",
        ),
        (
            claim("c", "convergence", algorithm="pso", iterations="50"),
            "PSO: the search converges within 50 iterations.",
        ),
        (
            claim("c", "conditions", rest_at="ends", orders=[1, 2], count="14", **COUNTED),
            "Velocity and acceleration are 0 at both ends: 14 conditions.",
        ),
        (
            claim("c", "conditions", rest_at="all", orders=[1, 2, 4], **COUNTED),
            "Velocity, acceleration and derivative 4 are 0 at all way-points.",
        ),
        (
            claim("c", "control_vertices", joint_rows=[["1", "1", "2", "3", "4", "4"]] * 2, **ONE),
            "The control vertices of the B-spline.",
        ),
        (sentence("c", "within_limits", "times"), "The motion keeps its limits."),
        (sentence("c", "varies_most", joint="b"), "Joint b varies most."),
        (sentence("c", "none", not_checkable="x"), "A sentence that cannot be checked."),
        (sentence("c", "none", not_checkable="x", text="It is gentle."), "It is gentle."),
    ],
)
def test_a_claim_is_a_sentence_of_its_quantity_joint_value_and_unit(stated: str, text: str) -> None:
    case = parse_case(HEAD + stated, "x")
    assert claim_text(case, case.claims[-1]) == text


@pytest.mark.parametrize("case_id", published_ids())
def test_no_sentence_is_judged_twice(case_id: str) -> None:
    """Where one printed sentence is two claims, neither holds the other: each could be judged
    otherwise, and the same words would stand in two rows with two verdicts."""
    stated = [
        c for c in load_case(case_id).claims if isinstance(c, StatementClaim | ConditionsClaim)
    ]
    for one, other in permutations(stated, 2):
        alone, among = (set(re.findall("[a-z]{4,}", c.text.lower())) for c in (one, other))
        alone -= {"motion", "that", "with", "from", "they"}
        assert one.where != other.where or not alone <= among, (one.id, other.id)
