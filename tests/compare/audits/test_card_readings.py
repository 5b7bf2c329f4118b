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
                elsewhere="a limit is broken",
            ),
            "Called optimal in the abstract, but under 13 of 19 readings the same curve is "
            "faster within the limits; under the others a limit is broken.",
        ),
        (
            cause("TG302", "time-optimal", "longer", IDS[:4]),
            "Called optimal in the abstract, but under 4 of 19 readings the same curve is "
            "faster within the limits.",
        ),
        (
            cause("TG302", "time-optimal", "longer", IDS, gap=GAP),
            "Called optimal in the abstract, but up to 40.3 % longer than a checked motion within "
            "the limits, under the mildest reading.",
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
