"""No sentence of a card drops its reading: what holds under some says under how many."""

from __future__ import annotations

import pytest
from trajgap.compare.audits import plainly
from trajgap.compare.documents import Basis, Cause, Finding, Gap, GapKind, Reference, Severity, Why
from trajgap.problem.cases import load_case

CASE = load_case("irb1600-ga-cubic-bspline")
IDS = tuple(reading.id for reading in CASE.readings)
NO_GAP = Why("not of every reading")
GAP = Gap(kind=GapKind.REPORTED, lowest=0.40, highest=0.4034, reference=Reference(upper=4.852))


def cause(rule: str, claim: str, kind: str, readings: tuple[str, ...], **changes: object) -> Cause:
    gap = changes.pop("gap", NO_GAP)
    head = Finding(
        rule=rule, basis=Basis.OPTIMUM, claim=claim, kind=kind, gap=gap, message="In its words."
    )
    made = Cause(
        severity=Severity.ERROR,
        rule=rule,
        claim=claim,
        says=head.message,
        head=head,
        readings=readings,
        explanations=(),
        consequences=(),
    )
    return made.model_copy(update=changes)


@pytest.mark.parametrize(
    ("made", "wanted"),
    [
        (
            cause(
                "TG302",
                "time-optimal",
                "longer",
                IDS[:13],
                elsewhere="limits broken",
            ),
            "Called optimal in the abstract, but every reading allows a faster motion or finds "
            "limits broken.",
        ),
        (
            cause("TG302", "time-optimal", "longer", IDS[:4]),
            "Called optimal in the abstract, but under 4 of 19 readings the same curve is "
            "faster within the limits.",
        ),
        (
            cause("TG302", "time-optimal", "longer", IDS, gap=GAP),
            "Called optimal in the abstract, but at least 40.0 % longer than a motion within the "
            "limits.",
        ),
        (
            cause("TG302", "time-optimal", "breaks", IDS[:6]),
            "Under 6 of 19 readings: Called optimal in the abstract, but no answer within the "
            "limits.",
        ),
        (
            cause("TG201", "after", "breaks", IDS[:13]),
            "Under 13 of 19 readings: The durations in Table 4, row after optimisation break a "
            "limit.",
        ),
        (
            cause("TG201", "after", "breaks", IDS[:1]),
            "Under “angles in rad, limits in rad/s and rad/s², stretched segments”: The durations "
            "in Table 4, row after optimisation break a limit.",
        ),
        (
            cause("TG201", "after", "breaks", IDS),
            "The durations in Table 4, row after optimisation break a limit.",
        ),
        (
            cause("TG102", "after", "", ()),
            "The longest durations in Table 4, row after optimisation are not those of its rows.",
        ),
    ],
)
def test_a_sentence_says_under_how_many_readings_it_holds(made: Cause, wanted: str) -> None:
    assert plainly(CASE, made) == wanted


@pytest.mark.parametrize(
    ("readings", "far", "front"),
    [
        (IDS[:13], IDS[10:], "Under 13 of 19 readings (3 implausible): "),
        (IDS[:13], IDS[13:], "Under 13 of 19 readings: "),
        (IDS[:2], IDS[:2], "Under 2 of 19 readings (all implausible): "),
        (IDS[:1], IDS[:1], "Under the implausible “angles in rad"),
    ],
)
def test_a_count_says_how_many_of_its_readings_are_implausible(
    readings: tuple[str, ...], far: tuple[str, ...], front: str
) -> None:
    said = plainly(CASE, cause("TG201", "after", "breaks", readings), far)
    assert said.startswith(front)


def test_the_joint_whose_total_lies_farthest_is_named() -> None:
    """Six joints are called optimal one by one: a share of none of them would be of all."""
    puma = load_case("puma560-mnam-pso-353")
    made = cause("TG302", "time-optimal", "longer", ("durations-at-least-0.3",), gap=GAP)
    assert made.head is not None
    head = made.head.model_copy(update={"farthest": "mnam-joint-3"})
    said = plainly(puma, made.model_copy(update={"head": head}))
    wanted = "joint 3 takes at least 40.0 % longer than a motion within the limits."
    assert said.endswith(wanted)
