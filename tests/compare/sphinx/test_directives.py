"""Words of claims that a page asks for, its readings, and the table of the suite."""

import pytest
from support.checkout import ROOT
from trajgap.compare.blocks import Grid, Prose
from trajgap.compare.documents import ClaimVerdict
from trajgap.compare.sphinx import Results
from trajgap.compare.sphinx.directives import readings_of, wanted_words
from trajgap.compare.sphinx.results import instances_of
from trajgap.problem import TrajgapError
from trajgap.problem.suite import list_instances, select_curve


@pytest.mark.parametrize("name", ["irb1600-ga-cubic-bspline", "irb460-pso-353"])
def test_a_place_that_every_row_shares_is_said_once(name):
    case = Results(ROOT / "docs/results").audited(name)
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
    words = f":verdict: '{wrong}' is no verdict on a claim"
    with pytest.raises(TrajgapError, match=words) as caught:
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
