"""The table of claim kinds in the docs: every claim of every paper, each once."""

from __future__ import annotations

import re

from support.checkout import ROOT
from trajgap.problem import load_case, published_ids
from trajgap.problem.cases import StatementClaim

_PAGE = ROOT / "docs" / "claim-checklist.md"


def _columns() -> dict[str, list[list[str]]]:
    """The ids in each row, by case."""
    rows = [line for line in _PAGE.read_text(encoding="utf-8").splitlines() if line[:1] == "|"]
    cells = [[cell.strip() for cell in row.strip("|").split("|")] for row in rows]
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
