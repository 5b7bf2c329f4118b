"""Pages of papers: on a phone, for a keyboard, short until unfolded, each thing said once."""

import re
from dataclasses import replace
from math import radians

import pytest
from support.findings import study_of, with_waterfalls
from support.made_up import paper, row
from support.page_tree import Tree
from support.studies import EVERY, audited_alone, page_alone
from support.toml_text import Bare
from trajgap.compare.audits import KEPT
from trajgap.compare.audits.case_audit import CaseAudit
from trajgap.compare.audits.study import Study
from trajgap.compare.blocks import Cell, Folded, Grid, Page, Prose, Section
from trajgap.compare.documents import ClaimVerdict, Keeping, Step, Waterfall, Why
from trajgap.compare.pages.motions_shown import _totals
from trajgap.compare.pages.numbers import both_units, where_time_goes
from trajgap.compare.pages.rendering import environment, markdown, style
from trajgap.nlp import Evidence
from trajgap.problem import load_case


def test_every_picture_has_words_for_those_who_cannot_see_it(page: Tree) -> None:
    for image in page.every("img"):
        assert len(image["alt"].split()) >= 6, image
        assert int(image["width"]) > 0
        assert int(image["height"]) > 0
        assert image["loading"] == "lazy"
    drawn = page.every("svg")
    assert all(one["role"] == "img" for one in drawn)
    descriptions = [one["text"] for one in page.every("desc")]
    assert len(descriptions) == len(drawn)
    assert all(len(text.split()) >= 6 for text in descriptions)


def test_what_is_wider_than_a_phone_scrolls_and_can_be_reached_by_keyboard(page: Tree) -> None:
    for wide in page.every("table", "img", "svg", "pre"):
        boxes = f"{wide['classes']} {wide.get('class', '')}"
        assert "scroll" in boxes, wide["tag"]
    scrolling = [one for one in page.found if "scroll" in one.get("class", "").split()]
    assert all(one.get("tabindex") == "0" for one in scrolling)
    assert all(one["above"].endswith("details") for one in page.every("summary"))
    cells = page.every("td")
    assert all(one.get("data-label") for one in cells)


def test_no_section_is_empty_and_each_has_a_heading(page: Tree) -> None:
    for section in page.every("section"):
        assert len(section["text"].split()) > 3, section
    assert all(one["text"].strip() for one in page.every("h1", "h2", "h3", "summary"))
    assert len(page.every("h1")) == 1
    labelled = [one["aria-labelledby"] for one in page.found if "aria-labelledby" in one]
    ids = {one["id"] for one in page.found if one.get("id")}
    assert {name for names in labelled for name in names.split()} <= ids


def test_the_focus_is_seen_and_the_card_scrolls_its_picture_on_a_phone() -> None:
    assert ":focus-visible { outline: 3px solid" in style()
    phone = style().split("@media (max-width: 44rem)")[1].split("@media print")[0]
    assert ".card figure svg { min-width:" in phone
    # A track of 1fr is never narrower than its picture, and cuts the words beside it.
    assert ".card { grid-template-columns: minmax(0, 1fr); }" in phone


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
        section = where_time_goes(with_waterfalls(replace(one), (first, *more)))
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


def test_a_total_that_nothing_limits_is_no_line_among_those_of_runs() -> None:
    for velocity, shown in ((1, 1), (Bare("inf"), 0)):
        study = study_of(paper([[0, 1]], row("d", "1.90"), velocity=velocity))
        assert len(_totals(study, study.pairs[0])[0]) == shown


def test_a_section_that_holds_nothing_is_left_out() -> None:
    page = Page("p", "t", (Section("a", "A", ()), Section("b", "B", (Prose("x"),))))
    assert [s.id for s in page.filled.sections] == ["b"]


def test_a_case_without_waypoints_says_once_what_is_not_computed() -> None:
    page = page_alone("z1-woa-bspline")
    ids = [s.id for s in page.sections]
    assert "not-computed" in ids
    assert not {"waterfall", "optima", "sensitivities", "motions", "landscapes"} & set(ids)
    text = markdown(page)
    assert text.count("because way-points are not printed") == 1
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
MOST_WORDS = 1_100
"""Of one page before anything is unfolded."""


# Words of the field that are ids of some case too.
WORDS_THAT_ARE_IDS = {"time-optimal", "b-spline"}


@pytest.mark.parametrize("case_id", EVERY)
def test_pages_of_the_papers_are_short_and_no_id_stands_for_a_name(case_id: str) -> None:
    shown = page_alone(case_id)
    text = environment().get_template("case.html").render(page=shown, style=style())
    unfolded = Tree(text).unfolded
    assert len(text.encode()) <= MOST_BYTES
    assert 150 < len(unfolded) <= MOST_WORDS
    assert "None." not in unfolded
    assert not re.search(r"<tbody>\s*</tbody>", text)
    # Pictures are fetched when they are unfolded: one alone stands in the page.
    assert text.count("<svg ") <= 1
    case, text = audited_alone(case_id).case, markdown(shown)
    assert text.count("Its id: ") == (len(case.readings) if len(case.readings) > 1 else 0)
    # What a reading is called on the command line, files of pictures and of certificates.
    text = re.sub(r"Its id: \S+|\]\([^)]*\)|\*\*\S+\.json\*\*", "", text)
    kinds = (
        "claims readings algorithms problems tables assumptions cartesian columns clues instances"
    )
    named = [getattr(case, kind) for kind in kinds.split()]
    ids = {one.id for group in named for one in group if "-" in one.id} - WORDS_THAT_ARE_IDS
    assert ids
    found = [i for i in ids if re.search(rf"(?<![\w./-]){re.escape(i)}(?![\w-])", text)]
    assert found == []


def test_what_is_open_about_limits_is_called_as_the_claim_is() -> None:
    open_words = {k: KEPT[k] for k in (Keeping.DISCONTINUOUS, Keeping.UNDECIDED)}
    assert all(said.startswith(str(ClaimVerdict.NOT_CHECKABLE)) for said in open_words.values())
    assert len(set(KEPT.values())) == len(KEPT) == len(Keeping)


def test_the_papers_unit_comes_first() -> None:
    statement = load_case("irb460-pso-353").statement("limit-80", "waypoints-rad")
    shown = both_units(statement, "velocity", [radians(80), radians(-12.5)], ".6g")
    assert shown == "80, -12.5 °/s (1.39626, -0.218166 rad/s)"
    # A quantity whose unit the paper does not print, or prints in SI, stands alone.
    assert both_units(statement, "acceleration", [2.5], ".6g") == "2.5 rad/s²"
    assert both_units(statement, "position", [0.5], ".6g") == "0.5 rad"
