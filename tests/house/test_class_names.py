"""One word, one meaning: no two classes of ours share a name that other modules may use."""

from __future__ import annotations

import ast
from collections import defaultdict

from support.checkout import ROOT

FOLDERS = ("problem", "nlp", "heuristics", "compare")
"""`verify` shares nothing with them, names included: it may use the same word for its own."""
BY_ROOM = {"Search", "Tree"}
"""What each kind of proof has one of; docs/reference/conventions.md says so."""


def test_no_two_classes_share_a_name() -> None:
    found = defaultdict(list)
    for folder in FOLDERS:
        for path in sorted((ROOT / folder).rglob("*.py")):
            for node in ast.walk(ast.parse(path.read_text("utf-8"))):
                if isinstance(node, ast.ClassDef) and not node.name.startswith("_"):
                    found[node.name].append(path.relative_to(ROOT).as_posix())
    shared = {name: places for name, places in found.items() if len(places) > 1}
    assert {name: p for name, p in shared.items() if name not in BY_ROOM} == {}
    assert shared.keys() >= BY_ROOM, "an exception that nothing needs"
    words = (ROOT / "docs" / "reference" / "conventions.md").read_text("utf-8")
    assert all(f"`{name}`" in words for name in BY_ROOM)
