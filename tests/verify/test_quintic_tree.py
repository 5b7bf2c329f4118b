"""The tree of a quintic proof as a text: what is written is read, and nothing else is."""

from __future__ import annotations

import json

import pytest
from support.certificate_kinds import text
from support.forgeries.forgery import document
from trajgap.verify import MOST_QUINTIC_SEGMENTS, USUAL_WEIGHT, quintic_tree, verify_certificate
from trajgap.verify.quintic_tree import read_tree
from trajgap.verify.reading import Clock, OutOfTime, Refused

KIND = "quintic-spline"


def test_the_nodes_of_a_text() -> None:
    words = "caz.#7#0(-2.5e-3).-12 0.1302 2932 934:193"
    assert read_tree(words, Clock(9.0)) == [
        2,
        0,
        MOST_QUINTIC_SEGMENTS - 1,
        ["."],
        [".", 7, "0"],
        [".", 0, "-2.5e-3"],
        [".", -12, 0, USUAL_WEIGHT],
        [".", 1302, 2932, USUAL_WEIGHT, 934, 193],
    ]


@pytest.mark.parametrize(
    ("words", "at"),
    [
        ("a b", 1),
        ("aA", 1),
        ("a?", 1),
        ("#", 0),
        ("a#-1", 1),
        ("#1()", 2),
        ("#1(2", 2),
        (".12", 1),
        (".12  3", 1),
        (".1 2:", 4),
        (".1 2:-3", 4),
        (".1 2.5 ", 5),
        (".1.5 2", 1),
        (".\u0661 2", 1),
        (".1 " + "9" * 17, 19),
    ],
)
def test_any_other_character_is_refused(words: str, at: int) -> None:
    with pytest.raises(Refused, match=f"the tree at character {at}$"):
        read_tree(words, Clock(9.0))


def test_a_text_with_too_many_nodes_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(quintic_tree, "MOST_NODES", 3)
    assert read_tree("ab.", Clock(9.0)) == [0, 1, ["."]]
    with pytest.raises(Refused, match="too many nodes"):
        read_tree("ab..", Clock(9.0))


def test_reading_ends_with_the_time() -> None:
    with pytest.raises(OutOfTime):
        read_tree("ab..", Clock(-1.0))


def test_a_text_proves_what_its_nodes_prove() -> None:
    written = document(KIND)
    listed = json.loads(text(KIND))
    assert isinstance(written["proof"]["tree"], str)
    assert isinstance(listed["proof"]["tree"], list)
    found = verify_certificate(written)
    assert found.proves
    assert not found.altered
    assert found.lower == verify_certificate(listed).lower
    assert len(json.dumps(written)) < len(json.dumps(listed))
