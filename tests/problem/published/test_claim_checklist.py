"""The table of claim kinds in the docs: every claim of every paper, each once."""

from __future__ import annotations

import re

from support.checkout import ROOT
from trajgap.problem import load_case, published_ids
from trajgap.problem.cases import StatementClaim

_PAGE = ROOT / "docs" / "reference" / "claim-checklist.md"


def _cells(section: int) -> list[list[str]]:
    """The table of a section of the page, its header first."""
    text = _PAGE.read_text(encoding="utf-8").split("\n## ")[section]
    rows = [line for line in text.splitlines() if line[:1] == "|"]
    return [[cell.strip() for cell in row.strip("|").split("|")] for row in rows]


def _columns() -> dict[str, list[list[str]]]:
    """The ids in each row, by case."""
    cells = _cells(0)
    cases = [name.strip("`") for name in cells[0][1:]]
    return {
        case: [re.findall("`([^`]+)`", row[place]) for row in cells[2:]]
        for place, case in enumerate(cases, start=1)
    }


def test_every_claim_stands_in_the_checklist_once() -> None:
    found = _columns()
    assert set(found) == set(published_ids())
    for case, rows in found.items():
        listed = sorted(id_ for row in rows for id_ in row)
        assert listed == sorted(claim.id for claim in load_case(case).claims)


def test_what_is_called_optimal_is_checked_as_optimal_in_every_paper() -> None:
    for case in published_ids():
        claim = load_case(case).claim("time-optimal")
        assert isinstance(claim, StatementClaim)
        assert (claim.checks, bool(claim.of)) == ("optimal", True)


def test_what_else_is_printed_has_its_claim_or_reading() -> None:
    """The first name in each row's last cell, where it begins with one, is in that case."""
    cases = {"IRB 460": "irb460-pso-353", "IRB 1600": "irb1600-ga-cubic-bspline"}
    cases["Z1"] = "z1-woa-bspline"
    named = 0
    for _, paper, where in _cells(1)[2:]:
        case = load_case(cases[paper])
        ids = {claim.id for claim in case.claims} | {reading.id for reading in case.readings}
        first = re.match("(?:not printed: the reading )?`([a-z][^`]+)`", where)
        if first is not None:
            assert first[1] in ids
            named += 1
    assert named == 10
