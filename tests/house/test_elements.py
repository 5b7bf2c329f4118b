"""The list behind "The four papers, element by element": nothing left out, all of it there."""

import ast
import runpy
import tomllib
from typing import Any

from support.checkout import ROOT
from trajgap.problem import load_case, published_ids

LISTED = tomllib.loads((ROOT / "docs" / "elements.toml").read_text(encoding="utf-8"))
KINDS = ("equation", "table", "figure", "algorithm")
COUNTS = {
    "z1-woa-bspline": (23, 2, 8),
    "puma560-mnam-pso-353": (13, 3, 10),
    "irb1600-ga-cubic-bspline": (15, 4, 8),
    "irb460-pso-353": (25, 4, 5),
}
"""Equations, tables and figures of each paper, counted a second time in its text."""


def numbers(paper: dict[str, Any], kind: str) -> list[int]:
    """Every number that entries of a kind name, each range written out."""
    found: list[int] = []
    for one in paper["elements"]:
        if one["kind"] == kind:
            first, _, last = one["number"].partition("-")
            found += range(int(first), int(last or first) + 1)
    return found


def functions_of(path: str) -> set[str]:
    tree = ast.parse((ROOT / path).read_text(encoding="utf-8"))
    return {node.name for node in tree.body if isinstance(node, ast.FunctionDef)}


def test_every_number_of_every_paper_is_there_once() -> None:
    assert [paper["case"] for paper in LISTED["papers"]] == list(COUNTS)
    assert set(COUNTS) == set(published_ids())
    for paper in LISTED["papers"]:
        for kind, count in zip(KINDS, COUNTS[paper["case"]], strict=False):
            assert sorted(numbers(paper, kind)) == list(range(1, count + 1)), (paper["case"], kind)
            assert paper[f"{kind}s"] == count
        assert {one["kind"] for one in paper["elements"]} == set(KINDS)


def test_what_stands_for_an_element_exists() -> None:
    """Files, and functions that test them; where there are none, a note says why."""
    for paper in LISTED["papers"]:
        for one in paper["elements"]:
            assert set(one) <= {"kind", "number", "says", "code", "test", "note"}
            assert ("code" in one) == ("test" in one), one
            assert "code" in one or "ot in the text" in one["note"], one
            if "code" in one:
                assert (ROOT / one["code"]).is_file(), one["code"]
                path, _, name = LISTED["tests"].get(one["test"], one["test"]).partition("::")
                assert name in functions_of(path), one
    for rule, path in LISTED["rules"].items():
        assert f'"{rule}"' in (ROOT / path).read_text(encoding="utf-8"), rule


def test_the_page_has_every_element_and_claim() -> None:
    made = runpy.run_path(str(ROOT / "docs" / "made_pages.py"))
    page = made["elements"]()
    for paper in LISTED["papers"]:
        part = page.split(f"reports/{paper['case']}.md")[1].split("\n## ")[0]
        assert all(f"| {one['says']}" in part.replace("\\", "") for one in paper["elements"])
        assert all(f"| `{claim.id}` | " in part for claim in load_case(paper["case"]).claims)
