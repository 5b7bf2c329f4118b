"""The verifier stands alone: nothing of ours, nothing from others, and its folder suffices."""

from __future__ import annotations

import ast
import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from support.small_certificates import rest_to_rest

ROOT = Path(__file__).resolve().parents[2]
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
    """The folder under a name that is no identifier, and without what Python left in it."""
    to = tmp_path_factory.mktemp("elsewhere") / "a copy-1"
    shutil.copytree(FOLDER, to, ignore=shutil.ignore_patterns("__pycache__"))
    return to


def test_the_folder_alone_proves_what_is_shipped(copied: Path) -> None:
    files = [
        path
        for path in (*SHIPPED, *EXAMPLES)
        if json.loads(path.read_text("utf-8"))["proof"]["kind"] not in NUMERIC
    ]
    assert len(files) > 15
    found = alone(copied, *files)
    assert found.stderr == ""
    assert found.returncode == 0
    assert found.stdout.count(": proves: ") == len(files)
    assert found.stdout.count("problem sha256 ") == len(files)


@pytest.mark.parametrize("kind", NUMERIC)
def test_the_folder_alone_says_what_it_needs_for_proofs_in_floats(
    copied: Path, tmp_path: Path, kind: str
) -> None:
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
    for _ in range(5):
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
        numpy = {"numpy"} if path.stem.startswith(("quintic", "declared")) else set()
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


def test_the_docs_say_how_long_it_is() -> None:
    page = (ROOT / "docs" / "explanation" / "certificates.md").read_text("utf-8")
    stated = {}
    for line in page.splitlines():
        cells = [cell.strip() for cell in line.strip("|").split("|")]
        if len(cells) == 3 and cells[1].isdigit():
            stated[cells[0].replace("`", "")] = int(cells[1])
    length = {
        path.relative_to(FOLDER).as_posix().removesuffix(".py"): len(path.read_text().splitlines())
        for path in FOLDER.rglob("*.py")
        if not path.name.startswith("__")
    }
    parts = {
        "closed_form, fixed_ratios": ["closed_form", "fixed_ratios"],
        "declared, declared_bound, declared_form, floors": [
            "declared",
            "declared_bound",
            "declared_form",
            "floors",
        ],
        "any_curve": ["any_curve"],
        "cubic/": [name for name in length if name.startswith("cubic/")],
        "quintic, quintic_bound, quintic_parts, quintic_tree": [
            "quintic",
            "quintic_bound",
            "quintic_parts",
            "quintic_tree",
        ],
    }
    kinds = {name for names in parts.values() for name in names}
    parts["core"] = [name for name in length if name not in kinds]
    assert set(stated) == set(parts)
    for part, names in parts.items():
        true = sum(length[name] for name in names)
        assert true <= stated[part] * 1.05, part
        assert true >= stated[part] * 0.8, part
