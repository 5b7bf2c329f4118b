"""Claims of the same words are one, and no reason or long caveat stands twice."""

from __future__ import annotations

from dataclasses import replace

from trajgap.compare.pages.blocks import Claimed, word
from trajgap.compare.pages.said_once import shown_once

FIGURE_5 = Claimed(
    text="It is better.",
    where="Figure 5",
    printed="",
    verdict=word("inconsistent"),
    holds="under both readings",
    why=("Both print 3.298 s.",),
    more=(),
    caveats=("Rests on doubt: two tables are alike.",),
    anchor="claim-1",
    id="better-1",
)
FIGURE_6 = replace(FIGURE_5, where="Figure 6", why=("Both print 2.289 s.",), anchor="claim-2")


def test_equal_words_in_two_places_are_one_claim_with_both_anchors() -> None:
    (one,) = shown_once([FIGURE_5, FIGURE_6])
    assert one.where == "Figure 5; Figure 6"
    assert one.why == ("Both print 3.298 s.",)
    assert one.more == ("Figure 6: Both print 2.289 s.",)
    assert (one.anchor, one.also) == ("claim-1", ("claim-2",))


def test_equal_words_with_another_verdict_stay_two() -> None:
    refuted = replace(FIGURE_6, verdict=word("refuted"))
    assert [one.where for one in shown_once([FIGURE_5, refuted])] == ["Figure 5", "Figure 6"]


def test_a_reason_and_a_long_caveat_are_given_once() -> None:
    again = replace(FIGURE_5, text="It is faster.", where="Figure 7")
    first, second = shown_once([FIGURE_5, again])
    assert first == FIGURE_5
    assert second.why == ("For the reason given at Figure 5.",)
    here = replace(again, where="Figure 5")
    assert list(shown_once([FIGURE_5, here]))[1].why == (
        "For the reason given for “It is better”.",
    )
    assert second.caveats == ("Rests on doubt (see above).",)
