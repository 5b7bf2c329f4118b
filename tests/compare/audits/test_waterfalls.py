"""Which printed durations the way down starts from: never the order of the file alone."""

from __future__ import annotations

from dataclasses import replace
from itertools import permutations

import pytest
from support.findings import audited_text, study_of, verdicts
from support.made_up import algorithms, gain, paper, row, sentence, total
from trajgap.compare.audits.card_optimum import optimum_line
from trajgap.compare.audits.waterfall import waterfalls
from trajgap.compare.documents import ClaimVerdict

OWN, RIVAL, OTHER = row("own", "1.90"), row("rival", "2.50"), row("other", "2.20")
NAMED = row("own", "1.90", algorithm="a") + row("rival", "2.50", algorithm="b")
BEST = sentence("best", "optimal", "own")
TOTALS = total("t", "1.90", of="own") + total("slow", "2.50", of="rival")
"""A total of an algorithm stands for that algorithm's durations."""
OF_ALGORITHMS = total("t", "1.90", algorithm="a") + total("slow", "2.50", algorithm="b")


def asked(*parts: str) -> str:
    """1 rad under 1 rad/s takes 15/8 s."""
    return paper([[0, 1]], *parts, velocity=1)


@pytest.mark.parametrize("rows", list(map("".join, permutations([OWN, RIVAL, OTHER]))))
def test_what_is_called_optimal_is_found_wherever_it_stands(rows: str) -> None:
    (found,) = waterfalls(study_of(asked(rows, BEST)))
    assert found.claim == "own"
    assert found.steps[0].time == 1.9


@pytest.mark.parametrize(
    ("parts", "claim"),
    [
        ((OWN, RIVAL, gain("rival", "own")), "own"),
        ((RIVAL, OWN, gain("rival", "own")), "own"),
        ((OWN, RIVAL, TOTALS, gain("slow", "t")), "own"),
        ((RIVAL, OWN, TOTALS, gain("slow", "t")), "own"),
        ((algorithms("a", "b"), NAMED, OF_ALGORITHMS, gain("slow", "t")), "own"),
        # Of several without a word the last is taken.
        ((OWN, RIVAL), "rival"),
        ((OWN, row("rival", "2.50", state="before")), "own"),
    ],
)
def test_a_rival_is_not_where_it_starts(parts: tuple[str, ...], claim: str) -> None:
    assert [one.claim for one in waterfalls(study_of(asked(*parts)))] == [claim]


def test_a_wrong_sum_breaks_no_limit() -> None:
    """1.00 and 1.00 s keep the limit of 2; that they do not sum to 3.00 is another fault."""
    for times, said in (
        ("1.00 1.00", "The printed durations keep the limits."),
        ("0.50 0.50", "The printed durations break a limit"),
    ):
        one = audited_text(paper([[0, 1, 2]], row("own", times, total="3.00"), velocity=2))
        assert one.judgements[0].verdict is ClaimVerdict.REFUTED
        assert one.card.limits.startswith(said)


def test_a_named_method_has_a_total_of_its_own() -> None:
    """A rival's 2.50 s is no other print of the paper's 1.90 s, nor its answer on the card."""
    named, own = algorithms("a"), total("own", "1.90")
    one = audited_text(asked(OWN, named, total("rival", "2.50", algorithm="a")))
    assert set(verdicts(one).values()) == {"supported", "not checkable"}
    assert one.card.optimum.startswith("1.90 s is ")
    for rows in (
        own + total("rival", "2.50", algorithm="a"),
        total("rival", "1.88", algorithm="a") + own,
        own + total("rival", "1.50", algorithm="a", objective="energy"),
    ):
        assert audited_text(asked(named, rows)).card.optimum.startswith("1.90 s is ")


def test_a_total_of_another_aim_is_another_total() -> None:
    """Two rows of one method, the second for energy: neither is a print of the other."""
    time = total("time", "2.50", algorithm="a")
    low = total("low", "2.90", algorithm="a", objective="energy")
    by = {j.claim: j for j in audited_text(asked(algorithms("a"), OWN, time, low)).judgements}
    assert "nothing in print can be set against it" in by["time"].why
    assert "nothing in print can be set against it" in by["low"].why


def test_what_only_cut_off_digits_keep_is_not_called_rounding() -> None:
    """1.877 s just keep this limit: no value rounds to 1.87 and does, some that are cut off do."""
    one = audited_text(paper([[0, 1]], row("own", "1.87"), velocity=1.875 / 1.877))
    assert one.card.limits == "The printed durations keep the limits if digits were cut off."


def test_a_total_within_a_proven_interval_neither_agrees_nor_differs() -> None:
    """The optimum is 1.875 s; with a bound of 1.84 s nothing says where 1.86 s lies beside it."""
    study = study_of(asked(row("own", "1.86")))
    found = waterfalls(study)
    wide = replace(study.optimum(*study.pairs[0]), lower_bound=1.84)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(study, "optimum", lambda *_: wide)
        said = optimum_line(study, found, {}, False)
    assert said.startswith("1.86 s")
    assert said.endswith("is proven to hold the optimum, 1.8400 to 1.8750 s.")
