"""The committed faults fit the source, and the tool that plants them finds what tests find."""

import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from planted.faults import FOLDERS, LISTS, NO_FAULTS, Fault, UnfitError, listed
from support.checkout import ROOT

LEAST = {"verify": 70, "problem": 80, "nlp": 70, "heuristics": 20, "compare": 60}
"""So many faults at least: a share of fewer says little about a folder."""


@pytest.mark.parametrize("name", [*FOLDERS, NO_FAULTS])
def test_every_fault_still_stands_in_the_source_once(name: str) -> None:
    unfit, seen = [], set()
    for fault in listed(name):
        try:
            changed = fault.planted((ROOT / fault.file).read_text(encoding="utf-8"))
            same = (fault.file, changed) in seen
            seen.add((fault.file, changed))
            unfit += [f"{fault}: twice in the list"] if same else []
        except UnfitError as error:
            unfit.append(str(error))
    assert unfit == []
    assert {fault.folder for fault in listed(name)} <= {name, *(FOLDERS * (name == NO_FAULTS))}
    assert len(seen) >= LEAST.get(name, 0)


def test_what_is_no_fault_has_a_reason_and_is_not_planted() -> None:
    none = list(listed(NO_FAULTS))
    assert all(fault.reason for fault in none)
    asked = {str(fault) for folder in FOLDERS for fault in listed(folder)}
    assert asked.isdisjoint(map(str, none))


SOURCE = """def f(a, b):
    if a < b:
        return g(
            a, b
        )
    return b


class C:
    def f(self, a, b):
        return a < b or b < a
"""


@pytest.mark.parametrize(
    ("function", "old", "new", "place", "found"),
    [
        ("f", "a < b", "a <= b", None, "if a <= b:"),
        ("f", "g(a, b)", "g(b, a)", None, "return g(b, a)\n"),
        ("C.f", "a<b", "a > b", None, "return a > b or b < a"),
        ("C.f", "b", "a", 3, "return a < b or a < a"),  # the parameter is the first
        ("module", "return b\n", "return a\n", None, "    return a\n"),
    ],
)
def test_a_fault_is_planted_where_the_list_says(
    function: str, old: str, new: str, place: int | None, found: str
) -> None:
    assert found in Fault("verify/x.py", function, old, new, place).planted(SOURCE)


@pytest.mark.parametrize(
    ("function", "old", "new", "place", "why"),
    [
        ("h", "a < b", "a <= b", None, "no h in this file"),
        ("f", "a > b", "a <= b", None, "stands there 0 times"),
        ("C.f", "a", "b", None, "stands there 3 times"),
        ("f", "a < b", "a <= b", 2, "stands there 1 times"),
        ("f", "a < b", "a  <  b", None, "changes nothing"),
        ("f", "a < b", "a <", None, "is no Python"),
    ],
)
def test_a_fault_that_does_not_fit_is_refused(
    function: str, old: str, new: str, place: int | None, why: str
) -> None:
    with pytest.raises(UnfitError, match=why):
        Fault("verify/x.py", function, old, new, place).planted(SOURCE)


COUNT = '''"""Counts."""


def count(n):
    total = 0
    while n > 0:
        total, n = total + n, n - 1
    return total


def unused(n):
    return n + 1
'''
TESTS = """from functools import cache

from trajgap.verify.count import count


@cache
def kept():
    return count(3)


def test_a_test_that_asks_nothing():
    kept()


def test_the_sum():
    assert kept() == 6


def test_what_fails_without_a_fault_finds_none():
    assert count(1) == 2
"""
FAULTS = """["verify/count.py"]
count = [
  ["total + n", "total - n"],
  ["n > 0", "n >= 0"],
  ["total = 0", "total = 1"],
]
unused = [["n + 1", "n - 1"]]
"""


def test_the_tool_tells_what_tests_find_and_goes_on_where_it_ended(tmp_path: Path) -> None:
    tool = tmp_path / "tests" / "planted"
    shutil.copytree(LISTS, tool, ignore=shutil.ignore_patterns("*.toml", "__pycache__"))
    for name, text in (
        ("tests/planted/verify.toml", FAULTS),
        ("tests/verify/test_count.py", TESTS),
        ("pyproject.toml", "[tool.pytest.ini_options]\n"),  # none of a folder above is taken
        ("__init__.py", ""),
        ("verify/__init__.py", ""),
        ("verify/count.py", COUNT),
    ):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(text, encoding="utf-8")
    files = {p: p.read_bytes() for p in tmp_path.rglob("*") if p.is_file()}

    def run() -> tuple[int, str]:
        done = subprocess.run(
            [sys.executable, str(tool), "verify", "-n", "2"], capture_output=True, text=True
        )
        assert done.stderr == ""
        return done.returncode, done.stdout

    code, said = run()
    assert code == 1
    assert "4/4" in said
    assert said.split("folder", 1)[1].split()[5:11] == ["verify", "2", "2", "0", "50", "%"]
    assert said.count("SURVIVES") == 2
    again, said = run()
    assert again == code
    assert "SURVIVES" not in said  # nothing is asked twice
    assert {p: p.read_bytes() for p in files} == files
