"""What sources and tests keep to: names, mirrored folders, stamps of what is compiled."""

import ast
import hashlib
import re
from collections import defaultdict
from importlib import import_module
from pathlib import Path

from support.checkout import ROOT

FOLDERS = {"problem", "heuristics", "nlp", "compare", "verify"}
NAME = re.compile(r"_?[A-Z][A-Z0-9_]*")
EXPLAIN = ("TypeVar", "ParamSpec", "Explained")  # what says itself what it is


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
        if isinstance(node.value, ast.Call) and ast.unparse(node.value.func) in EXPLAIN:
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


TESTS = ROOT / "tests"

# Folders of tests that mirror no folder of the source.
OWN = {"attacks", "house"}

# Folders of the source without tests of their own, and where they are tested.
ELSEWHERE = {
    "nlp/enclosure": "compare/audits/test_rounding_enclosures.py",
    "compare": "compare/audits",
    "verify/cubic": "nlp/proofs/cubic",
}


def test_the_tests_mirror_the_folders() -> None:
    holding = {
        path.parent.relative_to(ROOT).as_posix()
        for folder in FOLDERS
        for path in (ROOT / folder).rglob("*.py")
    }
    tested = {path.parent.relative_to(TESTS).as_posix() for path in TESTS.rglob("test_*.py")}
    assert holding - tested == set(ELSEWHERE), "list where else a folder is tested"
    assert all((TESTS / place).exists() for place in ELSEWHERE.values())
    assert tested - holding == OWN


def leaning(source: str) -> list[str]:
    """Imports by which a test reaches another test."""
    faults = []
    for node in ast.walk(ast.parse(source)):
        names = [alias.name for alias in node.names] if isinstance(node, ast.Import) else []
        if isinstance(node, ast.ImportFrom):
            base = "." * node.level + (node.module or "")
            names = [base, *(f"{base}.{alias.name}" for alias in node.names)]
        for name in names:
            parts = name.split(".")
            if parts[0] in ("", "tests") or any(p.startswith("test_") for p in parts):
                faults.append(name)
    return faults


def test_no_test_imports_another_test() -> None:
    faults = {}
    for path in sorted(TESTS.rglob("*.py")):
        found = leaning(path.read_text(encoding="utf-8"))
        if found:
            faults[path.relative_to(ROOT).as_posix()] = found
    assert faults == {}
    for source in (
        "from tests import x",
        "import test_x",
        "from . import x",
        "from a.test_x import y",
    ):
        assert leaning(source)
    assert not leaning("from support.samples import sample_problem")


KERNELS = "trajgap.problem.curves.kernel"
"""The module that names the kernels; they call no compiled function of other files."""


def folder_of(module: str) -> Path:
    """Where a module was imported from: the checkout, or what is installed."""
    file = import_module(module).__file__
    assert file is not None
    return Path(file).resolve().parent


def test_compiled_functions_carry_the_hash_of_all_their_sources() -> None:
    paths = [folder_of(KERNELS) / name for name in import_module(KERNELS).KERNELS]
    stamp = hashlib.sha256(b"".join(path.read_bytes() for path in paths)).hexdigest()[:16]
    for path in paths:
        module = import_module(f"{KERNELS.rpartition('.')[0]}.{path.stem}")
        compiled = [x.py_func for x in vars(module).values() if hasattr(x, "py_func")]
        assert compiled, f"{path.name} compiles nothing"
        assert {Path(f.__code__.co_filename).resolve() for f in compiled} <= set(paths)
        assert all(f.__qualname__ == f"{f.__name__}_{stamp}" for f in compiled)


def test_the_stamp_covers_every_file_that_is_compiled() -> None:
    # A file is compiled with a stamp if it decorates a function with ``compiled``.
    compiling = {
        path.name
        for path in folder_of(KERNELS).glob("*.py")
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(node, ast.FunctionDef)
        and any(ast.unparse(d) == "compiled" for d in node.decorator_list)
    }
    assert compiling == set(import_module(KERNELS).KERNELS)


def test_nothing_else_is_compiled() -> None:
    # Only the stamped compiler calls numba: a bare one would cache old callees.
    users = {
        path.relative_to(ROOT).as_posix()
        for folder in FOLDERS - {"verify"}
        for path in (ROOT / folder).rglob("*.py")
        if "numba.njit" in path.read_text(encoding="utf-8")
    }
    assert users == {"problem/curves/kernel.py"}
