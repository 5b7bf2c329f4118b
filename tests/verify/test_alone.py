"""The verifier stands alone: nothing of ours, nothing from others, and its folder suffices."""

import ast
import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from support.checkout import ROOT
from support.small_certificates import rest_to_rest

FOLDER = ROOT / "verify"
SHIPPED = sorted((ROOT / "nlp").rglob("certificates/*.json"))
EXAMPLES = sorted((ROOT / "docs/examples").glob("*.certificate.json"))
IMPORT_SECONDS = 0.1
"""Of the processor; the test takes the best of some tries."""
NUMERIC = ("quintic-spline", "declared")
"""Kinds of proof that need numpy."""


def alone(folder: Path, *arguments: str | Path) -> subprocess.CompletedProcess[str]:
    """Run the folder with the standard library only: isolated, and without site-packages."""
    command = [sys.executable, "-I", "-S", str(folder), *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, check=False, cwd="/")


@pytest.fixture(scope="module")
def copied(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder under a name that is not an identifier, and without what Python left in it."""
    to = tmp_path_factory.mktemp("elsewhere") / "a copy-1"
    shutil.copytree(FOLDER, to, ignore=shutil.ignore_patterns("__pycache__"))
    return to


def test_the_folder_alone_proves_what_is_shipped(copied: Path) -> None:
    kinds = {path: json.loads(path.read_text("utf-8"))["proof"]["kind"] for path in SHIPPED}
    kinds |= {path: json.loads(path.read_text("utf-8"))["proof"]["kind"] for path in EXAMPLES}
    # The smallest of each kind; all of them are proved where the prover is tested.
    smallest = {kinds[p]: p for p in sorted(kinds, key=lambda p: p.stat().st_size, reverse=True)}
    files = [path for kind, path in smallest.items() if kind not in NUMERIC]
    assert len(files) >= 3
    found = alone(copied, *files)
    assert found.stderr == ""
    assert found.returncode == 0
    assert found.stdout.count(": proves: ") == len(files)
    assert found.stdout.count("problem sha256 ") == len(files)


@pytest.mark.parametrize("kind", NUMERIC)
def test_the_folder_alone_says_what_floats_need(copied: Path, tmp_path: Path, kind: str) -> None:
    data = rest_to_rest()
    data["proof"]["kind"] = kind
    path = tmp_path / "numeric.json"
    path.write_text(json.dumps(data))
    found = alone(copied, path)
    assert found.returncode == 1
    assert "refused: this kind of proof needs numpy" in found.stdout
    assert found.stderr == ""


def test_both_ways_to_run_it_say_the_same(copied: Path, tmp_path: Path) -> None:
    good, late = tmp_path / "good.json", tmp_path / "late.json"
    good.write_text(json.dumps(rest_to_rest()))
    late.write_text(json.dumps(rest_to_rest()))
    module = [sys.executable, "-m", "trajgap.verify", "--time", "0"]
    installed = subprocess.run([*module, late], capture_output=True, text=True, check=False)
    assert installed.returncode == 1
    assert installed.stdout == alone(copied, "--time", "0", late).stdout
    assert "late.json: out of time: " in installed.stdout
    assert alone(copied, good).returncode == 0
    assert alone(copied).returncode == 2


def test_importing_it_loads_little_and_takes_little_time(tmp_path: Path) -> None:
    script = (
        "import sys, time; began = time.process_time(); import trajgap.verify;"
        "print(time.process_time() - began, sorted("
        "m for m in sys.modules if m.partition('.')[0] in ('numpy', 'trajgap', 'scipy')))"
    )
    # As after an installation: compiled once.
    compiled = {**os.environ, "PYTHONPYCACHEPREFIX": str(tmp_path)}
    compiled.pop("PYTHONDONTWRITEBYTECODE", None)
    best = float("inf")
    for _ in range(3):
        words = subprocess.check_output([sys.executable, "-c", script], text=True, env=compiled)
        seconds, _, modules = words.partition(" ")
        best = min(best, float(seconds))
    loaded = ast.literal_eval(modules.strip())
    assert [m for m in loaded if not m.startswith("trajgap.verify")] == ["trajgap"]
    assert best <= IMPORT_SECONDS


def test_it_imports_the_standard_library_and_itself() -> None:
    modules = sorted(FOLDER.rglob("*.py"))
    assert len(modules) > 10
    for path in modules:
        depth = len(path.relative_to(FOLDER).parts)
        numpy = {"numpy"} if path.stem.startswith(("boxes", "quintic", "declared")) else set()
        for node in ast.walk(ast.parse(path.read_text("utf-8"))):
            if isinstance(node, ast.Import):
                names = {alias.name.partition(".")[0] for alias in node.names}
            elif isinstance(node, ast.ImportFrom) and node.level == 0:
                names = {str(node.module).partition(".")[0]}
            elif isinstance(node, ast.ImportFrom):
                assert node.level <= depth, f"{path}: reaches out of the folder"
                continue
            else:
                continue
            assert names <= {*sys.stdlib_module_names, *numpy}, path


PAGE = ROOT / "docs/explanation/certificates.md"
ROW = re.compile(r"^\| (core|`[a-z_/`, ]+`) \| ([\d,]+) \|", re.MULTILINE)


def test_the_page_counts_every_line_of_the_verifier() -> None:
    lines: dict[str, int] = {}
    for path in (ROOT / "verify").rglob("*.py"):
        part = path.relative_to(ROOT / "verify").parts[0].removesuffix(".py")
        lines[part] = lines.get(part, 0) + len(path.read_text("utf-8").splitlines())
    stated = {
        names: int(count.replace(",", "")) for names, count in ROW.findall(PAGE.read_text("utf-8"))
    }
    named = {names: re.findall(r"`([a-z_]+)/?`", names) for names in stated if names != "core"}
    counted = {names: sum(lines.pop(part) for part in parts) for names, parts in named.items()}
    counted["core"] = sum(lines.values())
    assert stated == {names: round(count, -1) for names, count in counted.items()}
