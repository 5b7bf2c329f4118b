"""Names: every module-level constant carries a line, and no two classes of ours share one."""

import ast
import re
from collections import defaultdict

from support.checkout import ROOT

FOLDERS = {"problem", "heuristics", "nlp", "compare", "verify"}
NAME = re.compile(r"_?[A-Z][A-Z0-9_]*")


def bare_constants(source: str) -> list[str]:
    """Constants with neither a docstring below nor a comment above or beside them."""
    lines = source.splitlines()
    body = ast.parse(source).body
    found = []
    for node, following in zip(body, [*body[1:], None], strict=True):
        if isinstance(node, ast.Assign):
            targets = node.targets
        elif isinstance(node, ast.AnnAssign) and node.value is not None:
            targets = [node.target]
        else:
            continue
        each = [one for t in targets for one in (t.elts if isinstance(t, ast.Tuple) else [t])]
        if isinstance(node.value, ast.Call) and ast.unparse(node.value.func) == "TypeVar":
            continue
        names = [t.id for t in each if isinstance(t, ast.Name) and NAME.fullmatch(t.id)]
        below = isinstance(following, ast.Expr) and isinstance(following.value, ast.Constant)
        above = node.lineno > 1 and lines[node.lineno - 2].startswith("#")
        beside = re.search("  # (?!fmt:|noqa)", lines[(node.end_lineno or node.lineno) - 1])
        if names and not (below or above or beside):
            found.append(", ".join(names))
    return found


def test_every_constant_is_explained() -> None:
    bare = []
    for folder in sorted(FOLDERS):
        for path in sorted((ROOT / folder).rglob("*.py")):
            name = path.relative_to(ROOT).as_posix()
            bare += [f"{name}: {one}" for one in bare_constants(path.read_text("utf-8"))]
    assert bare == []
    seen = "_B: int = 2\nC = 3\n'why'\n\nX, Y = 1, 2\nD = [1]  # fmt: skip\n# why\n_E = 2"
    assert bare_constants(f"{seen}\nF = 3  # why\nname = 1\nA: int") == ["_B", "X, Y", "D"]


BY_ROOM = {"Search", "Tree"}
"""What each kind of proof has one of; docs/reference/conventions.md says so."""


def test_no_two_classes_share_a_name() -> None:
    found = defaultdict(list)
    for folder in sorted(FOLDERS - {"verify"}):  # it shares nothing with them, words included
        for path in sorted((ROOT / folder).rglob("*.py")):
            for node in ast.walk(ast.parse(path.read_text("utf-8"))):
                if isinstance(node, ast.ClassDef) and not node.name.startswith("_"):
                    found[node.name].append(path.relative_to(ROOT).as_posix())
    shared = {name: places for name, places in found.items() if len(places) > 1}
    assert {name: p for name, p in shared.items() if name not in BY_ROOM} == {}
    assert shared.keys() >= BY_ROOM, "an exception that nothing needs"
    words = (ROOT / "docs" / "reference" / "conventions.md").read_text("utf-8")
    assert all(f"`{name}`" in words for name in BY_ROOM)
