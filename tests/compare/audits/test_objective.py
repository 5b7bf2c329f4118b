"""A paper that minimises something else than time alone is not held to the shortest time."""

import pytest
from support.findings import audited_text, verdicts
from support.made_up import entry, paper, row, sentence
from trajgap.compare.audits import Pair
from trajgap.compare.audits.case_audit import CaseAudit
from trajgap.compare.documents import CARD_WORDS, ClaimVerdict, Severity
from trajgap.compare.sphinx import paper_row

AIM = "time and jerk, weighted"


def audited(objective: str | None = AIM, own: str | None = None, limit: float = 1.0) -> CaseAudit:
    """18 s for what 1 rad/s allows in 13.24 s."""
    return audited_text(
        paper(
            [[0, 1, 0.5, 2]],
            entry("problems", id="one"),
            entry("problems", id="two", limits={"velocity": 2}),
            row("times", "6.0 6.0 6.0", total="18.0", problem="one", **aim(own)),
            row("faster", "3.0 3.0 3.0", total="9.0", problem="two"),
            sentence("best", "optimal", "times", "faster"),
            curve={"family": "3-5-3"},
            head=aim(objective),
            velocity=limit,
        )
    )


def aim(objective: str | None) -> dict[str, str]:
    return {} if objective is None else {"objective": objective}


@pytest.fixture(scope="module")
def weighted() -> CaseAudit:
    return audited()


@pytest.fixture(scope="module")
def plain() -> CaseAudit:
    return audited(None)


def test_without_an_objective_the_same_numbers_are_refuted(plain: CaseAudit) -> None:
    assert verdicts(plain)["best"] is ClaimVerdict.REFUTED
    assert "above the" in plain.card.optimum or "times the" in plain.card.optimum


def test_optimal_for_another_objective_is_not_judged_by_time(weighted: CaseAudit) -> None:
    assert verdicts(weighted)["best"] is ClaimVerdict.NOT_CHECKABLE
    (why,) = [j.why for j in weighted.judgements if j.claim == "best"]
    assert f"minimised for {AIM}, not for time alone" in why
    assert not [c for c in weighted.causes if c.severity is not Severity.INFO]
    assert weighted.errors == 0


def test_the_shortest_time_is_given_as_information(weighted: CaseAudit, plain: CaseAudit) -> None:
    best = weighted.study.optimum(Pair("one", "as-printed")).best
    said = weighted.card.optimum
    assert said.startswith(f"18.0 s and 9.0 s were not minimised for time alone ({AIM}), so ")
    assert f"{best:.4f} s" in said
    assert f"{best:.4f} s" in plain.card.optimum
    assert "above" not in " ".join(weighted.card.sentences)
    (distance,) = [f for f in weighted.findings if f.rule == "TG302" and f.claim == "times"]
    assert f"takes {best:.6f} s, best known" in distance.message
    assert all("longer than" not in f.message for f in weighted.findings)
    assert {f.rule for f in weighted.findings if f.claim == "best"} <= {"TG302"}
    assert f"not minimised for time alone: {AIM}" in weighted.waterfalls[0].steps[0].note
    stated = {one.claim: str(one.objective) for one in weighted.document.claims}
    assert (stated["times"], stated["best"]) == (AIM, "no printed time")


def test_the_table_of_papers_shows_no_distance(weighted: CaseAudit, plain: CaseAudit) -> None:
    shown, best, share = paper_row("", weighted.document).cells[:3]
    assert (shown, share) == ("18", "–")
    own = paper_row("", plain.document)
    assert own.cells[:2] == (shown, best)
    assert own.distance.shares == pytest.approx([0.36, 0.36], abs=0.0005)


def test_a_claim_may_have_an_objective_of_its_own() -> None:
    """A row of a method that minimises time, in a paper whose own method does not."""
    one = audited(own="time")
    assert verdicts(one)["best"] is ClaimVerdict.REFUTED
    assert "not minimised" not in one.card.optimum.split(";")[0]
    assert str(next(c.objective for c in one.document.claims if c.claim == "times")) == "time alone"


def test_an_objective_hides_no_broken_limit() -> None:
    """1.5 rad of way in 6 s takes 0.25 rad/s at least, whatever was minimised."""
    one = audited(limit=0.2)
    assert verdicts(one)["times"] is ClaimVerdict.REFUTED
    assert "break a limit" in one.card.limits


def test_a_long_objective_leaves_the_card_short() -> None:
    card = audited("a weighted sum of many things, " * 20).card
    assert card.words <= CARD_WORDS
    assert "for time alone, so they need not be the shortest; the shortest known" in card.optimum
