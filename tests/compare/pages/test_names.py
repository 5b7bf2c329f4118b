"""Pictures, pages and places in a page: one name each, whatever the ids of a case."""

import re
import xml.etree.ElementTree as ElementTree
from collections import Counter
from pathlib import Path

import pytest
from support.drawn import sketched
from support.findings import report_of
from support.made_up import entry, paper, row
from trajgap.compare import write_report
from trajgap.compare.blocks import Cell, Grid, Page, Prose, Section, Terms
from trajgap.compare.pages import check_report_folder
from trajgap.compare.pages.rendering import markdown
from trajgap.problem import file_name, parse_case


def dash(case: str, text: str = "t") -> str:
    """Problems and readings whose ids joined by dashes are the same."""
    return paper(
        [[0, 1, 2, 3]],
        entry("problems", id="a"),
        entry("problems", id="a-b", limits={"velocity": 5}),
        entry("readings", id="b-c", why=text, default=True),
        entry("readings", id="c", why="y", limits={"velocity": 2}),
        row("x", "1.5 1.5 1.5", problem="a", where=text),
        row("y", "2.5 2.5 2.5", problem="a-b", where=text),
        curve={"family": "3-5-3"},
        head={"id": case, "title": text},
        robot={"name": text},
        velocity=1,
    )


HIDDEN = "total \u202e5.1\u202c\u2066x\u2069\u200e\u200f\u061c\x1b[31m\x07\x9b\x7f s"
SHOWN = (
    "total <U+202E>5.1<U+202C><U+2066>x<U+2069><U+200E><U+200F><U+061C><U+001B>[31m<U+0007>"
    "<U+009B><U+007F> s"
)
HIDES = re.compile("[\u202a-\u202e\u2066-\u2069\u200e\u200f\u061c\x00-\x08\x0b-\x1f\x7f-\x9f]")


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Report of two cases whose names joined by dashes are the same, with hidden characters."""
    cases = [parse_case(dash("dash", HIDDEN), "f"), parse_case(dash("dash-waterfall"), "g")]
    out = tmp_path_factory.mktemp("names") / "audit"
    with sketched():
        write_report(report_of(*cases), out)
    return out


@pytest.mark.parametrize("name", ["dash", "dash-waterfall"])
def test_no_id_stands_twice_in_a_page(folder: Path, name: str) -> None:
    page = (folder / f"{name}.html").read_text("utf-8")
    ids = Counter(re.findall(r'\bid="([^"]+)"', page))
    assert [one for one, count in ids.items() if count > 1] == []
    assert set(re.findall(r'href="#([^"]+)"', page)) <= ids.keys()
    assert "claim-x" in ids


def test_every_waterfall_has_its_picture(folder: Path) -> None:
    named = {"b-c": "b-c", "c": "velocity limits 2"}
    files = sorted((folder / "pictures").iterdir())
    for case in ("dash", "dash-waterfall"):
        for problem in ("a", "a-b"):
            for reading in ("b-c", "c"):
                drawn = file_name("waterfall", problem, reading)
                file = folder / "pictures" / f"{file_name(case, drawn)}.svg"
                files.remove(file)
                root = ElementTree.fromstring(file.read_text("utf-8"))
                title = root.findtext("{http://www.w3.org/2000/svg}title")
                assert title == f"Where the time goes: {problem}; {named[reading]}"
                for end in ("html", "md"):
                    page = (folder / f"{case}.{end}").read_text("utf-8")
                    assert f"pictures/{file.name}" in page
    assert len(files) >= 2 * 4
    check_report_folder(folder)
    known = folder / "pictures" / "dash-waterfall-a-b-c.svg"  # as pictures were called once
    known.write_text("<svg/>", "utf-8")
    check_report_folder(folder)
    known.unlink()


def test_what_hides_or_steers_is_shown(folder: Path) -> None:
    index = (folder / "index.html").read_text("utf-8")
    page = (folder / "dash.html").read_text("utf-8")
    text = (folder / "dash.md").read_text("utf-8")
    whole = (folder / "audit.json").read_text("utf-8")
    for one in (index, page, text, whole):
        assert HIDES.search(one) is None
    for one in (index, page):
        assert SHOWN.replace("<", "&lt;").replace(">", "&gt;") in one
    assert re.sub(r"([<>\[])", r"\\\1", SHOWN) in text
    assert "\\u202e" in whole
    for file in (folder / "pictures").iterdir():
        assert HIDES.search(file.read_text("utf-8")) is None


def test_every_block_of_markdown_shows_it() -> None:
    section = Section(
        HIDDEN,
        HIDDEN,
        (
            Prose(HIDDEN),
            Prose(HIDDEN, "heading"),
            Terms(((HIDDEN, HIDDEN),)),
            Grid((HIDDEN,), ((Cell(f"{HIDDEN}\n{HIDDEN}"),),), HIDDEN),
        ),
    )
    text = markdown(Page("c", HIDDEN, (section,)))
    assert HIDES.search(text) is None
    assert text.count("\\<U+202E\\>") == 10
    assert text.count("<br>") == 1
