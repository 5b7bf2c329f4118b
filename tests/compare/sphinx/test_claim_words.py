"""The option ``:verdict:`` of claims on a page: its words, and what an empty list says."""

from __future__ import annotations

import pytest
from trajgap.compare.documents import ClaimVerdict
from trajgap.compare.sphinx.claim_words import wanted_words
from trajgap.problem import TrajgapError


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
