"""What a page does with many readings, with none complete, and with sections that hold nothing."""

import re
from dataclasses import replace

import pytest
from support.page_tree import Tree
from support.studies import EVERY, page_alone
from trajgap.compare.audits.case_audit import CaseAudit, audit
from trajgap.compare.audits.study import Study
from trajgap.compare.documents import Step, Waterfall, Why
from trajgap.compare.pages.blocks import Cell, Folded, Grid, Page, Prose, Section
from trajgap.compare.pages.environment import environment, style
from trajgap.compare.pages.markdown_text import markdown
from trajgap.compare.pages.numbers import where_time_goes
from trajgap.compare.pages.writer import case_page
from trajgap.nlp import Evidence
from trajgap.problem import load_case


def test_many_readings_share_a_table_and_few_have_pictures() -> None:
    case = load_case("irb460-pso-353")
    steps = (
        Step(name="published", time=1.9, low=1.8, high=2.0, note="printed"),
        Step(name="optimum", time=1.7, evidence=Evidence.BEST_KNOWN),
        Step.missing("retimed", "no acceleration is limited"),
    )
    first = Waterfall(problem="limit-80", reading=case.default_reading.id, claim=None, steps=steps)
    one = CaseAudit(case, Study(case, seeds=2, certify_seconds=0), (), ())
    for others in (3, 5):
        more = [first.model_copy(update={"reading": f"reading-{k}"}) for k in range(others)]
        section = where_time_goes(replace(one, made_waterfalls=(first, *more)))
        drawn = Page("p", "t", (section,)).pictures
        inner = [b for fold in section.blocks if isinstance(fold, Folded) for b in fold.blocks]
        tables = [b for b in inner if isinstance(b, Grid) and b.columns[0] == "reading"]
        assert len(drawn) == (4 if others == 3 else 1)
        assert [len(t.rows) for t in tables] == ([] if others == 3 else [5])
    known = [s for s in first.steps if not isinstance(s.time, Why)]
    assert tables[0].columns == ("reading", *(s.name for s in known))
    for cell, step in zip(tables[0].rows[0][1:], known, strict=True):
        assert cell.text.startswith(f"{step.time:.4f} s")
        assert str(step.evidence) in (*cell.text.split("\n"), "none")


def test_a_section_that_holds_nothing_is_left_out() -> None:
    page = Page("p", "t", (Section("a", "A", ()), Section("b", "B", (Prose("x"),))))
    assert [s.id for s in page.filled.sections] == ["b"]


def test_a_case_without_waypoints_says_once_what_is_not_computed() -> None:
    whale = load_case("z1-woa-bspline")
    alone = replace(whale, document=whale.document.model_copy(update={"families": ()}))
    (one,) = audit(alone, seeds=2, certify_seconds=0).cases
    page = case_page(one)
    ids = [s.id for s in page.sections]
    assert "not-computed" in ids
    assert not {"waterfall", "optima", "sensitivities", "motions", "landscapes"} & set(ids)
    text = markdown(page)
    assert text.count("since way-points are not printed") == 1
    # Why they are not stands with the readings, and once with the claims that need them.
    before, _, _ = text.partition("## Every finding")
    assert before.count("the text gives their number, 8") == 2
    assert "\nNone." not in text


def test_long_tables_of_readings_scroll_in_a_box_and_print_whole() -> None:
    grid = Grid(("problem", "reading"), ((Cell("p"), Cell("r")),) * 13)
    page = Page("p", "t", (Section("a", "A", (grid, replace(grid, rows=grid.rows[:12]))),))
    shapes = environment()
    html_page = shapes.get_template("case.html").render(page=page, style="")
    assert re.findall(r'<div class="(scroll[^"]*)"', html_page) == ["scroll tall", "scroll"]
    sheet = style()
    assert "max-height: none" in sheet.split("@media print")[1]


MOST_BYTES = 600_000
"""Of one page, its pictures apart."""
MOST_WORDS = 1_000
"""Of one page before anything is unfolded."""


def test_what_is_folded_is_not_counted() -> None:
    page = "<p>one two</p><details><summary>three</summary>four<details><summary>five</summary>"
    page += "six</details></details>seven"
    assert Tree(page).unfolded == ["one", "two", "three", "seven"]


@pytest.mark.parametrize("case_id", EVERY)
def test_pages_of_the_papers_are_short_before_anything_is_unfolded(case_id: str) -> None:
    page = page_alone(case_id)
    shapes = environment()
    sheet = style()
    text = shapes.get_template("case.html").render(page=page, style=sheet)
    assert len(text.encode()) <= MOST_BYTES
    words = Tree(text).unfolded
    assert 150 < len(words) <= MOST_WORDS
    assert "None." not in words
    assert not re.search(r"<tbody>\s*</tbody>", text)
    # Pictures are fetched when they are unfolded: one alone stands in the page.
    assert text.count("<svg ") <= 1
