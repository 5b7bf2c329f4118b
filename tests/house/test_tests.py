"""The tests mirror the folders of the source, and no test leans on another."""

import ast

from support.checkout import ROOT

SOURCES = ("problem", "nlp", "verify", "heuristics", "compare")
TESTS = ROOT / "tests"

# Folders of tests that mirror no folder of the source.
OWN = {"attacks", "house"}

# Folders of the source without tests of their own, and where they are tested.
ELSEWHERE = {
    "nlp": "nlp/optimum",
    "nlp/enclosure": "compare/audits/test_rounding_enclosures.py",
    "compare": "compare/audits",
    "verify/cubic": "nlp/proofs/cubic",
}


def test_the_tests_mirror_the_folders() -> None:
    holding = {
        path.parent.relative_to(ROOT).as_posix()
        for folder in SOURCES
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
