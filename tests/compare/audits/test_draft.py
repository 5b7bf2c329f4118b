"""Advice to an author: what it tells to print must hold, and a sound draft needs none."""

import re
from collections.abc import Sequence
from decimal import Decimal

import pytest
from support.made_up import algorithms, claim, gain, paper, row, sentence, slow, total
from support.papers.spoiled import spoiled
from support.studies import EVERY, audited_alone
from trajgap.compare.audits import CaseAudit, audit
from trajgap.compare.audits.draft import advise
from trajgap.compare.audits.revision import edited
from trajgap.compare.documents import Advice, ClaimVerdict, Urgency, Why
from trajgap.compare.pages.verdicts import advised, against
from trajgap.problem import Case, Verdict, check, parse_case

CONTRADICTED = paper(
    [
        [0, 25, 60, 40, 75],
        [-30, -5, 20, 45, 15],
        [45, 20, -15, -40, 5],
        [10, 35, 20, -25, -50],
        [0, 40, 75, 110, 60],
    ],
    algorithms("pso"),
    row("durations", "0.742 0.780 0.850 1.080", total="3.452"),
    sentence("limits-kept", "within_limits", "durations"),
    sentence("time-optimal", "optimal", "durations"),
    total("rival", "4.118", algorithm="pso"),
    gain("rival", "durations", percent="15.8"),
    curve={"family": "cubic-spline"},
    angle="deg",
    velocity=[90, 90, 100, 120, 150],
    acceleration=[180, 160, 200, 240, 300],
)
ROWS = paper(
    [[0, 1, 1.5], [0, 0.5, 1.5]],
    row("one", "0.900 0.500", joint="1"),
    row("two", "0.500 0.901", joint="2"),
    claim("longest", "maximum", of=["one", "two"], durations=["0.900", "0.901"], total="1.801"),
    sentence("kept", "within_limits", "longest"),
    head={"coupling": "per-joint"},
    velocity=1.9,
)


def audited(case: Case) -> CaseAudit:
    return audit(case, certify_seconds=0, draft=True).cases[0]


def drafted(durations: str, value: str, checks: str = "continuous") -> CaseAudit:
    """A draft whose row is said to keep the limits, and one thing more."""
    text = paper(
        ["0.1000 0.7000 1.2000 0.9000"],
        row("best", durations, total=value),
        sentence("kept", "within_limits", "best"),
        sentence("said", checks, "best"),
        curve={"family": "3-5-3"},
        velocity=6,
        acceleration=8,
    )
    return audited(parse_case(text, "draft.toml"))


def on(one: CaseAudit, name: str) -> Advice:
    return next(a for a in one.advice if a.claim == name)


def needed(one: CaseAudit) -> list[str]:
    return [a.says for a in one.advice if a.urgency is not Urgency.OPEN]


def numbers(change: str) -> tuple[list[float], float]:
    """The durations that an advice tells to print."""
    found = re.search(r"((?:\d+\.\d+, )+\d+\.\d+) s \(total (\d+\.\d+) s\)", change)
    assert found, change
    return [float(x) for x in found[1].split(", ")], float(found[2])


def digits(durations: Sequence[float], more: float = 0.0) -> str:
    return " ".join(f"{h + more:.3f}" for h in durations)


def test_a_total_that_is_no_sum_is_replaced_by_one_number() -> None:
    """0.9000 + 1.1000 + 0.8500 is 2.8500, and no paper prints an interval."""
    one = drafted("0.9000 1.1000 0.8500", "2.900")
    assert on(one, "best").change == "Print 2.850 s as the total, or correct the parts."
    other = drafted("1.000 1.000 1.000", "2.500", "jumps")
    (found,) = [a for a in other.advice if "add up" in a.says]
    assert "3.0" in found.change
    assert advised(other).blocks[-1].title == "1 points that readers cannot check"
    assert "The causes" in str(against(other).blocks)


def test_durations_that_break_a_limit_are_lengthened_until_they_keep_it() -> None:
    one = drafted("0.300 0.400 0.350", "1.050")
    advice = on(one, "best")
    assert advice.urgency is Urgency.CONTRADICTED
    durations, value = numbers(advice.change)
    assert check(one.case.problem(), durations).verdict is Verdict.PASS
    assert value == pytest.approx(sum(durations), abs=1e-12)
    # As many decimals as the draft prints, and no more than they need: all scaled by one factor.
    assert all(h == round(h, 3) for h in durations)
    factor = check(one.case.problem(), [0.3, 0.4, 0.35]).stretch
    assert durations == pytest.approx([factor * h for h in (0.3, 0.4, 0.35)], abs=0.003)


@pytest.fixture(scope="module")
def shorter() -> list[float]:
    """What is advised to print where a motion that is too long is called optimal."""
    one = drafted("1.000 1.000 1.000", "3.000", "optimal")
    durations, value = numbers(on(one, "said").change)
    assert check(one.case.problem(), durations).verdict is Verdict.PASS
    assert value == pytest.approx(sum(durations))
    assert value < 3.0
    assert one.document.advice == one.advice
    return durations


def test_a_sound_draft_without_open_points_needs_nothing(shorter: list[float]) -> None:
    assert needed(drafted(digits(shorter), f"{sum(shorter):.3f}", "optimal")) == []


@pytest.mark.parametrize(("more", "word"), [(0.0, "supported"), (0.002, "refuted")])
def test_an_optimum_rounded_up_is_not_refuted(more: float, word: str, shorter: list[float]) -> None:
    one = drafted(digits(shorter, more), f"{sum(shorter) + 3 * more:.3f}", "optimal")
    (judged,) = [j for j in one.judgements if j.claim == "said"]
    assert judged.verdict == word
    assert ("digits were rounded up" in judged.why) == (more == 0.0)


def applied(text: str) -> tuple[CaseAudit, CaseAudit]:
    """A draft's audit, and that of the draft with every edit of its advice made."""
    case = parse_case(text, "draft.toml")
    first = audited(case)
    edits = [edit for advice in first.advice for edit in advice.edits]
    return first, audited(edited(case, edits))


def test_all_advice_together_contradicts_nothing() -> None:
    """The draft of an attack: "print 16.15 %" and "lengthen to 3.492 s" were said at once."""
    first, second = applied(CONTRADICTED)
    assert len([a for a in first.advice if a.urgency is Urgency.CONTRADICTED]) == 2
    (share,) = [a for a in first.advice if a.claim == "gain"]
    new = second.case.claim("durations").total.decimal
    assert share.change == f"Print {100 * (1 - new / Decimal('4.118')):.1f} %."
    assert needed(second) == []
    assert {j.verdict for j in second.judgements if j.claim != "rival"} == {"supported"}


# Of the first three drafts both audits take some seconds.
@pytest.mark.parametrize("seed", [2, 24, 25, *slow({*range(30)} - {2, 24, 25})])
def test_after_all_advice_the_next_audit_finds_nothing(seed: int) -> None:
    draft, faults = spoiled(seed)
    first, second = applied(draft.text())
    assert needed(first), faults
    assert needed(second) == [], faults
    assert not second.edits


def test_longest_durations_are_lengthened_with_their_rows() -> None:
    """A quintic over 1 rad peaks at 15/(8 h) rad/s: 0.9868 s under 1.9 rad/s, and half of it."""
    first, second = applied(ROWS)
    changed = {(e.claim, e.key): e.becomes for a in first.advice for e in a.edits}
    assert changed["longest", "durations"] == ("0.987", "0.988")
    assert changed["longest", "total"] == ("1.975",)
    assert needed(second) == []


def test_advice_is_there_on_request_alone() -> None:
    assert audited_alone("irb460-pso-353").document.advice == Why("not audited as a draft")


@pytest.mark.parametrize("case_id", EVERY)
def test_every_cause_has_its_advice_in_plain_words(case_id: str) -> None:
    one = audited_alone(case_id)
    found = advise(one.study, one.causes, one.judgements, one.edits)
    assert len([a for a in found if a.urgency is not Urgency.OPEN]) >= len(one.causes)
    assert all(advice.says and advice.change for advice in found)
    undecided = (ClaimVerdict.NOT_CHECKABLE, ClaimVerdict.DEPENDS)
    assert {j.claim for j in one.judgements if j.verdict in undecided} <= {a.claim for a in found}
    assert not [a for a in found if "None as" in a.change or "Print None" in a.change]
