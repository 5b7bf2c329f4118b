"""Reasons of a verdict on a page, the words of claims, and the table of the suite."""

import pytest
from docutils import nodes
from support.checkout import ROOT
from trajgap.compare.documents import ClaimVerdict
from trajgap.compare.sphinx import Results
from trajgap.compare.sphinx.directives import readings_of
from trajgap.compare.sphinx.reasons import reasons, wanted_words
from trajgap.compare.sphinx.suite import instances_of
from trajgap.problem import TrajgapError
from trajgap.problem.suite import list_instances, select_curve


def finding(reading: str | None, message: str, verdict: str = "refuted", **changes: object):
    one = {"claim": "c", "decides": True, "verdict": verdict, "reading": reading, "rule": "TG201"}
    return {**one, "kind": message, "message": message, **changes}


VERDICT = {
    "claim": "c",
    "verdict": "depends on the reading",
    "why": "all of it",
    "readings": dict.fromkeys("abcd", "refuted"),
}


def test_of_many_reasons_the_default_stands_first_and_the_others_are_folded() -> None:
    found = [
        finding("d", "kept.", "supported"),
        finding("a", "one."),
        finding("b", "two."),
        finding("c", "two."),
        finding("a", "of another claim.", claim="other"),
        finding("a", "decides nothing.", decides=False),
        finding("a", "says nothing.", "not checkable"),
    ]
    labels = {"a": "angles in degrees", "b": "angles in radians"}
    case = {"readings": {"default": "b", "labels": labels}, "findings": found}
    lead, opening, folded, closing = reasons(case, {**VERDICT, "opening": "all of it"})
    assert lead.astext() == "all of it"
    assert opening.astext() == "<details><summary>All 3 reasons</summary>"
    assert [one.astext() for one in folded.findall(nodes.paragraph)] == [
        "Refuted under “angles in radians” and “c”: two.",
        "Refuted under “angles in degrees”: one.",
        "Supported under “d”: kept.",
    ]
    assert closing.astext() == "</details>"


@pytest.mark.parametrize("name", ["irb1600-ga-cubic-bspline", "irb460-pso-353"])
def test_a_place_that_every_row_shares_is_said_once(name):
    case = Results(ROOT / "docs" / "results").case(name)
    parts = readings_of(case)
    tables = [table for part in parts for table in part.findall(nodes.table)]
    said = [part for part in parts if isinstance(part, nodes.paragraph)]
    # The default reading's rows stand in the open where there are many; ids come last.
    *_, shown, _ = tables
    assert len(tables) == (2 if len(case["readings"]["outcomes"]) <= 8 else 3)
    rows = list(shown.findall(nodes.row))
    outcomes = case["readings"]["outcomes"]
    claims = {one["claim"] for one in outcomes}
    places = [c["where"] for c in case["claims"] if c["claim"] in claims]
    assert len(rows) == len(outcomes) + 1
    counts = [sum(place in part.astext() for part in (*said, *rows)) for place in places]
    if len(places) == 1:
        assert counts == [1]
        assert said[-1].astext() == f"Durations judged: {places[0]}."
    else:
        assert counts == [
            sum(one["claim"] == claim for one in outcomes) for claim in sorted(claims, reverse=True)
        ]
    wide = {len(list(row.findall(nodes.entry))) for row in rows}
    assert wide == {5 if len(places) == 1 else 6}


def test_a_long_reason_is_cut_at_a_sentence_and_in_full_a_fold_away() -> None:
    long = "It breaks a limit. Then more. The end."
    case = {"readings": None, "findings": [finding("a", long)]}
    verdict = {**VERDICT, "why": long, "opening": "It breaks a limit."}
    lead, opening, folded, _ = reasons(case, verdict)
    assert lead.astext() == "It breaks a limit."
    assert opening.astext() == "<details><summary>The whole reason</summary>"
    assert folded.astext() == long
    many = [finding(reading, f"{reading}: {long}") for reading in "abc"]
    lead, opening, folded, _ = reasons({"readings": {"default": "a"}, "findings": many}, verdict)
    assert opening.astext() == "<details><summary>All 3 reasons</summary>"
    assert folded.astext().count("The end.") == 3


@pytest.mark.parametrize(
    ("option", "words"),
    [
        ("refuted, depends on the reading", ["refuted", "depends on the reading"]),
        ("depends on\n   the reading,\ninconsistent,", ["depends on the reading", "inconsistent"]),
        ("", []),
        (", ".join(ClaimVerdict), list(ClaimVerdict)),
    ],
)
def test_words_are_read_in_their_order(option: str, words: list[str]) -> None:
    assert wanted_words(option) == words


@pytest.mark.parametrize(
    ("option", "wrong"),
    [
        ("refutedd", "refutedd"),
        ("refuted, dependent on the reading", "dependent on the reading"),
        ("Refuted", "Refuted"),
    ],
)
def test_a_word_that_no_claim_can_have_is_an_error(option: str, wrong: str) -> None:
    with pytest.raises(
        TrajgapError, match=f":verdict: '{wrong}' is not a verdict on a claim"
    ) as caught:
        wanted_words(option)
    assert all(str(word) in str(caught.value) for word in ClaimVerdict)


@pytest.mark.parametrize("word", ["quintic", "Septic", "353", "virtual", "septic-c6-"])
def test_a_word_chooses_what_the_command_line_lists(word: str) -> None:
    chosen = instances_of(word)
    assert 0 < len(chosen) < len(list_instances())
    assert list(chosen) == list(select_curve(word))


def test_a_whole_name_keeps_to_that_curve() -> None:
    assert {one.curve for one in instances_of("C2 cubic")} == {"C2 cubic"}
    assert {one.curve for one in select_curve("C2 cubic")} > {"C2 cubic"}
    assert instances_of(None) == list_instances()
