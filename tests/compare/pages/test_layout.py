"""What a page must have on a phone, for a keyboard and for a screen reader, read from its HTML."""

from pathlib import Path

import pytest
from support.page_tree import Tree
from support.studies import EVERY, page_alone
from trajgap.compare.pages.environment import _TEMPLATES, environment, style

MOST_PICTURE = 300_000
"""Bytes of one picture: more points than a screen shows."""


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
