"""A paper that minimises something else than time alone is not held to the shortest time."""

import json

import pytest
from trajgap.compare.audits.card import verdict_card
from trajgap.compare.audits.case_audit import audit_case
from trajgap.compare.audits.study import Study
from trajgap.compare.documents import ClaimVerdict, Severity, json_text
from trajgap.compare.sphinx import distance_of
from trajgap.problem import CaseError, parse_case

CASE = """
format = 1
id = "compromise"
title = "One joint, a compromise of time and jerk"
{objective}
[source]
note = "Made up."
[robot]
name = "One joint"
joints = ["1"]
[units]
position = "rad"
velocity = "rad/s"
time = "s"
[waypoints]
joint_rows = [[0, 1, 0.5, 2]]
[limits]
velocity = {limit}
[interpolant]
family = "3-5-3"
[[problems]]
id = "one"
[[problems]]
id = "two"
limits = {{ velocity = 2 }}
[[claims]]
id = "times"
quantity = "durations"
where = "Table 2"
problem = "one"
durations = ["6.0", "6.0", "6.0"]
total = "18.0"
{own}
[[claims]]
id = "faster"
quantity = "durations"
where = "Table 3"
problem = "two"
durations = ["3.0", "3.0", "3.0"]
total = "9.0"
[[claims]]
id = "best"
quantity = "statement"
where = "conclusion"
text = "The motion is optimal."
checks = "optimal"
of = ["times", "faster"]
"""
WEIGHTED = 'objective = "time and jerk, weighted"'


def audited(objective="", own="", limit="1.0"):
    text = CASE.format(objective=objective, own=own, limit=limit)
    return audit_case(Study(parse_case(text, "x"), certify_seconds=0))


@pytest.fixture(scope="module")
def weighted():
    return audited(WEIGHTED)


@pytest.fixture(scope="module")
def plain():
    return audited()


def test_without_an_objective_the_same_numbers_are_refuted(plain):
    """18 s are longer than what one radian a second takes: so that the rest can fail."""
    verdicts = {j.claim: j.verdict for j in plain.judgements}
    assert verdicts["best"] is ClaimVerdict.REFUTED
    assert "above the" in plain.card.optimum or "times the" in plain.card.optimum


def test_optimal_for_another_objective_is_not_judged_by_time(weighted):
    verdicts = {j.claim: j for j in weighted.judgements}
    assert verdicts["best"].verdict is ClaimVerdict.NOT_CHECKABLE
    assert "minimised for time and jerk, weighted, not for time alone" in verdicts["best"].why
    assert not [c for c in weighted.causes if c.severity is not Severity.INFO]
    assert weighted.errors == 0


def test_the_card_gives_the_shortest_time_as_information(weighted, plain):
    best = f"{weighted.study.optimum('one', 'as-printed').best:.4f} s"
    assert weighted.card.optimum.startswith(
        f"18.0 s was not minimised for time alone (time and jerk, weighted); the shortest "
        f"known motion on the same curve takes {best}"
    )
    assert "above" not in " ".join(weighted.card.sentences)
    assert best in plain.card.optimum


def test_the_distance_is_shown_as_information(weighted):
    messages = [f.message for f in weighted.findings if f.rule == "TG302" and f.claim == "times"]
    best = f"{weighted.study.optimum('one', 'as-printed').best:.6f} s"
    assert messages == [
        "Printed 18.0 s was not minimised for time alone (time and jerk, weighted): as "
        f"information, the shortest motion with shared durations takes {best}, best known."
    ]
    assert all("longer than" not in f.message for f in weighted.findings)
    assert {f.rule for f in weighted.findings if f.claim == "best"} <= {"TG302"}


def test_the_waterfall_says_it_beside_the_printed_total(weighted):
    first = weighted.waterfalls[0].steps[0]
    assert "not minimised for time alone: time and jerk, weighted" in first.note
    stated = {one.claim: one.objective for one in weighted.document.claims}
    assert stated["times"] == "time and jerk, weighted"
    assert str(stated["best"]) == "no printed time"


def test_the_table_of_papers_shows_no_distance(weighted, plain):
    shown, best, share, _ = distance_of(json.loads(json_text(weighted.document)))
    assert (shown, share) == ("18", "–")
    assert distance_of(json.loads(json_text(plain.document)))[:2] == (shown, best)
    assert distance_of(json.loads(json_text(plain.document)))[2] == "36.0%"


def test_a_claim_may_have_an_objective_of_its_own():
    """A row of a method that minimises time, in a paper whose own method does not."""
    one = audited(WEIGHTED, own='objective = "time"')
    verdicts = {j.claim: j.verdict for j in one.judgements}
    assert verdicts["best"] is ClaimVerdict.REFUTED
    assert "not minimised" not in one.card.optimum.split(";")[0]
    assert str(next(c.objective for c in one.document.claims if c.claim == "times")) == "time alone"


def test_an_objective_hides_no_broken_limit():
    """1.5 rad of way in 6 s takes 0.25 rad/s at least, whatever was minimised."""
    one = audited(WEIGHTED, limit="0.2")
    verdicts = {j.claim: j.verdict for j in one.judgements}
    assert verdicts["times"] is ClaimVerdict.REFUTED
    assert "break a limit" in one.card.limits


def test_a_long_objective_leaves_the_card_short():
    long = 'objective = "' + "a weighted sum of many things, " * 20 + '"'
    one = audited(long)
    card = verdict_card(one.study, one.judgements, one.causes, one.waterfalls)
    assert card.words <= 80
    assert (
        "was not minimised for time alone; the shortest known motion on the same curve"
        in card.optimum
    )


def test_an_empty_objective_is_refused():
    with pytest.raises(CaseError, match="objective: is empty; fill it in or leave the key out"):
        audited('objective = ""')
