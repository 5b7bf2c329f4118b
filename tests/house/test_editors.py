"""Programs of documents and notebooks pass pyright, and strict mypy, outside the checkout."""

import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from support.checkout import ROOT

DOCUMENTS = [
    ROOT / "README.md",
    *sorted((ROOT / "docs/start").glob("*.md")),
    *sorted((ROOT / "docs/guides").glob("*.md")),
]
NOTEBOOKS = sorted((ROOT / "docs/gallery/examples/notebooks").glob("*.py"))
PROGRAM = re.compile(r"^```python\n(.*?)^```$", re.MULTILINE | re.DOTALL)
FILE = re.compile(r"^```\{code-block\} python\n:caption: (\S+)\n\n(.*?)^```$", re.M | re.DOTALL)


@pytest.fixture(scope="module")
def project(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder for each document with its files and programs; those of the README stand alone."""
    folder = tmp_path_factory.mktemp("reader")
    for document in DOCUMENTS:
        text = document.read_text(encoding="utf-8")
        programs = PROGRAM.findall(text)
        own = folder / document.stem.replace("-", "_")
        own.mkdir(exist_ok=True)
        for name, content in FILE.findall(text):
            (own / name).write_text(content, encoding="utf-8")
        parts = programs if document.stem == "README" else ["\n".join(programs)]
        for number, program in enumerate(filter(None, parts), 1):
            (own / f"program_{number}.py").write_text(program, encoding="utf-8")
    for notebook in NOTEBOOKS:
        shutil.copy(notebook, folder)
    return folder


def said(project: Path, *command: str) -> str:
    done = subprocess.run(command, cwd=project, capture_output=True, text=True)
    return "" if done.returncode == 0 else done.stdout + done.stderr


def test_the_programs_are_there(project: Path) -> None:
    assert len(list(project.glob("README/*.py"))) == 2
    assert len(list(project.rglob("*.py"))) > 8
    assert len(list(project.glob("plot_*.py"))) == 3


def test_pyright_finds_nothing(project: Path) -> None:
    checker = shutil.which("basedpyright", path=str(Path(sys.executable).parent))
    if checker is None:
        pytest.skip("basedpyright is not installed")
    (project / "pyrightconfig.json").write_text('{"typeCheckingMode": "standard"}')
    assert said(project, checker, "--pythonpath", sys.executable, ".") == ""


def test_strict_mypy_finds_nothing_in_the_readme_but_what_is_wrong(project: Path) -> None:
    """With a wrong argument beside them, which is seen: the package comes with its types."""
    program = "import trajgap as tg\nbest = tg.solve('no problem')\n"
    (project / "wrong.py").write_text(program, encoding="utf-8")
    found = said(project, sys.executable, "-m", "mypy", "--strict", "README", "wrong.py")
    (project / "wrong.py").unlink()
    assert re.findall(r"^(\S+?):\d+: error: .*\[(.*)\]$", found, re.M) == [("wrong.py", "arg-type")]
