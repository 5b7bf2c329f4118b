"""Reasons of a verdict on a page, the words of claims, and the table of the suite."""

from types import SimpleNamespace

import pytest
from support.checkout import ROOT
from trajgap.compare.blocks import Grid, Prose, claims_shown
from trajgap.compare.documents import ClaimVerdict, Judgement, Why
from trajgap.compare.sphinx import Results
from trajgap.compare.sphinx.directives import readings_of, wanted_words
from trajgap.compare.sphinx.suite import instances_of
from trajgap.problem import TrajgapError
from trajgap.problem.suite import list_instances, select_curve


def finding(reading: str | None, message: str, verdict: str = "refuted", **changes: object):
    one = {"claim": "c", "decides": True, "verdict": verdict, "reading": reading, "rule": "TG201"}
    return SimpleNamespace(**{**one, "kind": message, "sentences": (message,), **changes})


def reasons(why: str, opening: str, found: list, labels: dict[str, str] | None = None):
    """The reasons of the one claim of a case."""
    said = SimpleNamespace(labels=labels or {}, implausible={}, default="b")
    stated = SimpleNamespace(claim="c", text="t", where="w", printed="", answer=Why(""))
    case = SimpleNamespace(claims=[stated], findings=found, readings=said if labels else Why(""))
    verdict = Judgement(
        claim="c", verdict="depends on the reading", scope="some", evidence="none", why=why,
        opening=opening, readings=dict.fromkeys("abcd", "refuted"),
    )  # fmt: skip
    (shown,) = claims_shown(case, [verdict])
    return shown


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
    shown = reasons("all of it", "all of it", found, labels)
    assert (shown.why, shown.fold) == (("all of it",), "All 3 reasons")
    assert shown.more == (
        "Refuted under “angles in radians” and “c”: two.",
        "Refuted under “angles in degrees”: one.",
        "Supported under “d”: kept.",
    )


@pytest.mark.parametrize("name", ["irb1600-ga-cubic-bspline", "irb460-pso-353"])
def test_a_place_that_every_row_shares_is_said_once(name):
    case = Results(ROOT / "docs" / "results").audited(name)
    *said, shown, ids = readings_of(case)
    outcomes = case.readings.outcomes
    assert ids.title == "Ids of the readings"
    # The default reading's rows stand in the open where there are many.
    grid = shown if isinstance(shown, Grid) else shown.blocks[0]
    assert isinstance(shown, Grid) == (len(outcomes) <= 8)
    claims = {one.claim for one in outcomes}
    places = [c.where for c in case.claims if c.claim in claims]
    assert len(grid.rows) == len(outcomes)
    counts = [sum(row[1].text == place for row in grid.rows) for place in places]
    if len(places) == 1:
        assert Prose(f"Durations judged: {places[0]}.") in said
    else:
        assert counts == [
            sum(one.claim == claim for one in outcomes) for claim in sorted(claims, reverse=True)
        ]
    assert len(grid.columns) == (5 if len(places) == 1 else 6)


def test_a_long_reason_is_cut_at_a_sentence_and_in_full_a_fold_away() -> None:
    long = "It breaks a limit. Then more. The end."
    shown = reasons(long, "It breaks a limit.", [finding("a", long)])
    assert (shown.why, shown.fold) == (("It breaks a limit.",), "The whole reason")
    assert shown.more == (long,)
    many = [finding(reading, f"{reading}: {long}") for reading in "abc"]
    shown = reasons(long, "It breaks a limit.", many)
    assert shown.fold == "All 3 reasons"
    assert " ".join(shown.more).count("The end.") == 3


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
        TrajgapError, match=f":verdict: '{wrong}' is no verdict on a claim"
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
