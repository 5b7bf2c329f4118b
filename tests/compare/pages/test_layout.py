"""What a page must have on a phone, for a keyboard and for a screen reader, read from its HTML."""

import html.parser
import re
from pathlib import Path

import pytest
from support.studies import EVERY, audited_alone, page_alone
from trajgap.compare.pages.environment import _TEMPLATES, environment, style

MOST_PICTURE = 300_000
"""Bytes of one picture: more points than a screen shows."""
VOID = {"meta", "img", "link", "br"}
"""Elements without an end tag."""


class Tree(html.parser.HTMLParser):
    """Elements of a page with their attributes, their parents and their text."""

    def __init__(self, page: str) -> None:
        super().__init__()
        self.found: list[dict[str, str]] = []
        self.open: list[int] = []
        self.feed(page)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        above = " ".join(self.found[i]["tag"] for i in self.open)
        classes = " ".join(self.found[i].get("class", "") for i in self.open)
        own = {name: value or "" for name, value in attrs}
        self.found.append({**own, "tag": tag, "above": above, "classes": classes, "text": ""})
        if tag not in VOID:
            self.open.append(len(self.found) - 1)

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.handle_starttag(tag, attrs)
        if tag not in VOID:
            self.open.pop()

    def handle_endtag(self, tag: str) -> None:
        while self.open and self.found[self.open[-1]]["tag"] != tag:
            self.open.pop()
        if self.open:
            self.open.pop()

    def handle_data(self, data: str) -> None:
        for i in self.open:
            self.found[i]["text"] += data

    def every(self, *tags: str) -> list[dict[str, str]]:
        return [one for one in self.found if one["tag"] in tags]


@pytest.fixture(scope="module", params=EVERY)
def page(request: pytest.FixtureRequest) -> tuple[str, Tree]:
    shown = page_alone(request.param)
    template = environment().get_template("case.html")
    return request.param, Tree(template.render(page=shown, style=style()))


def test_ids_are_unique_and_every_link_within_the_page_leads_somewhere(
    page: tuple[str, Tree],
) -> None:
    _, tree = page
    ids = [one["id"] for one in tree.found if one.get("id")]
    assert len(ids) == len(set(ids))
    within = [a["href"][1:] for a in tree.every("a") if a.get("href", "").startswith("#")]
    assert set(within) <= set(ids)
    labelled = [one["aria-labelledby"] for one in tree.found if "aria-labelledby" in one]
    assert {name for names in labelled for name in names.split()} <= set(ids)


def test_every_picture_has_words_for_those_who_cannot_see_it(page: tuple[str, Tree]) -> None:
    _, tree = page
    for image in tree.every("img"):
        assert len(image["alt"].split()) >= 6, image
        assert int(image["width"]) > 0
        assert int(image["height"]) > 0
        assert image["loading"] == "lazy"
    drawn = tree.every("svg")
    assert all(one["role"] == "img" for one in drawn)
    descriptions = [one["text"] for one in tree.every("desc")]
    assert len(descriptions) == len(drawn)
    assert all(len(text.split()) >= 6 for text in descriptions)


def test_what_is_wider_than_a_phone_scrolls_and_can_be_reached_by_keyboard(
    page: tuple[str, Tree],
) -> None:
    _, tree = page
    for wide in tree.every("table", "img", "svg", "pre"):
        boxes = f"{wide['classes']} {wide.get('class', '')}"
        assert "scroll" in boxes, wide["tag"]
    scrolling = [one for one in tree.found if "scroll" in one.get("class", "").split()]
    assert all(one.get("tabindex") == "0" for one in scrolling)
    assert all(one["above"].endswith("details") for one in tree.every("summary"))
    cells = tree.every("td")
    assert all(one.get("data-label") for one in cells)


def test_no_section_is_empty_and_each_has_a_heading(page: tuple[str, Tree]) -> None:
    _, tree = page
    for section in tree.every("section"):
        assert len(section["text"].split()) > 3, section
    assert all(one["text"].strip() for one in tree.every("h1", "h2", "h3", "summary"))
    assert len(tree.every("h1")) == 1


def test_no_id_of_the_case_file_stands_for_a_claim_or_an_algorithm(page: tuple[str, Tree]) -> None:
    case_id, tree = page
    case = audited_alone(case_id).case
    # "time-optimal" is an id, and a word of the papers.
    words = " ".join(
        ["time-optimal", case.title, case.source.title, *(claim.text for claim in case.claims)]
    )
    named = (*case.claims, *case.algorithms)
    ids = [one.id for one in named if "-" in one.id and one.id not in words]
    assert len(ids) >= 5
    # Findings rule by rule, and the list of what was chosen, name the keys of the case file.
    (body,) = tree.every("main")
    text = body["text"]
    for section in tree.every("section"):
        if section["id"] in ("findings", "assumptions", "reproducibility", "instances"):
            text = text.replace(section["text"], "")
    heard = [one for one in ids if re.search(rf"(?<![\w-]){re.escape(one)}(?![\w-])", text)]
    assert not heard


def test_pictures_hold_no_more_than_can_be_seen(page: tuple[str, Tree]) -> None:
    case_id, _ = page
    for picture in page_alone(case_id).pictures:
        assert len(picture.document.encode()) <= MOST_PICTURE, picture.name


def test_the_focus_is_seen_and_the_card_scrolls_its_picture_on_a_phone() -> None:
    rules = style()
    assert ":focus-visible { outline: 3px solid" in rules
    phone = rules.split("@media (max-width: 44rem)")[1].split("@media print")[0]
    assert ".card figure svg { min-width:" in phone
    # A track of 1fr is never narrower than its picture, and cuts the words beside it.
    assert ".card { grid-template-columns: minmax(0, 1fr); }" in phone
    assert "grid-template-columns: 7.5rem 1fr" in phone
    assert Path(_TEMPLATES / "blocks.html").read_text("utf-8").count('<div class="scroll') == 2
