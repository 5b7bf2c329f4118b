"""Pages call what a case file names by words: an id stands once, where a command asks for it."""

from __future__ import annotations

import re

import pytest
from support.studies import EVERY, audited_alone, page_alone
from trajgap.compare.audits import KEPT
from trajgap.compare.documents import ClaimVerdict, Keeping
from trajgap.compare.pages.markdown_text import markdown

# Words of the field that are ids of some case too.
WORDS = {"time-optimal", "b-spline"}


@pytest.mark.parametrize("case_id", EVERY)
def test_no_id_stands_for_a_name_folded_or_not(case_id: str) -> None:
    case = audited_alone(case_id).case
    text = markdown(page_alone(case_id))
    assert text.count("Its id: ") == (len(case.readings) if len(case.readings) > 1 else 0)
    # What a reading is called on the command line, files of pictures and of certificates.
    text = re.sub(r"Its id: \S+|\]\([^)]*\)|\*\*\S+\.json\*\*", "", text)
    named = (
        case.claims,
        case.readings,
        case.algorithms,
        case.problems,
        case.tables,
        case.assumptions,
        case.cartesian,
        case.columns,
        case.clues,
        case.instances,
    )
    ids = {one.id for group in named for one in group if "-" in one.id} - WORDS
    assert ids
    found = [i for i in ids if re.search(rf"(?<![\w./-]){re.escape(i)}(?![\w-])", text)]
    assert found == []


def test_what_is_open_about_limits_is_called_as_the_claim_is() -> None:
    open_words = {k: KEPT[k] for k in (Keeping.DISCONTINUOUS, Keeping.UNDECIDED)}
    assert all(said.startswith(str(ClaimVerdict.NOT_CHECKABLE)) for said in open_words.values())
    assert len(set(KEPT.values())) == len(KEPT) == len(Keeping)


@pytest.mark.slow
def test_what_decides_nothing_has_one_word() -> None:
    """Under three readings the velocity jumps: card, table and claim say the same of them."""
    one = audited_alone("irb1600-ga-cubic-bspline")
    assert "not checkable under 3" in one.card.limits
    (kept,) = (j for j in one.judgements if j.claim == "limits-kept")
    assert sum(str(word) == "not checkable" for word in kept.readings.values()) == 3
    text = markdown(page_alone("irb1600-ga-cubic-bspline"))
    rows = [line for line in text.splitlines() if "| not checkable<br>48 velocity jumps |" in line]
    assert len(rows) == 3
    assert "not checkable (velocity jumps) under 3 of 19 readings" in text
    assert "undecided" not in text.partition("## What was audited")[0]
    assert "discontinuous" not in text.partition("## What was audited")[0]
