"""Packaging and documents: what is installed, what CI runs, links, machines, doctests."""

import doctest
import importlib
import importlib.metadata
import importlib.util
import os
import re
import subprocess
import sys
import tomllib
from collections.abc import Iterator
from fnmatch import fnmatch
from pathlib import Path

import yaml
from packaging.requirements import Requirement
from packaging.specifiers import SpecifierSet
from packaging.utils import canonicalize_name
from support.checkout import ROOT
from support.house_files import MAY_IMPORT, source_modules

PYPROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))


README_COMMANDS = [
    "python -m pip install . && trajgap audit docs/examples/fang2020-task1.toml --out first",
    'python -m pip install ".[test,docs]" && python -m pytest',
    'python -m pip install ".[docs]" && python -m sphinx -W -b html docs build/site',
]


def tracked_files() -> list[Path]:
    """Every file that git tracks or would; outside a git checkout, all that is not ignored."""
    listing = subprocess.run(
        ["git", "-C", str(ROOT), "ls-files", "-z", "--cached", "--others", "--exclude-standard"],
        capture_output=True,
        check=False,
    )
    if listing.returncode == 0 and (ROOT / ".git").exists():
        found = [ROOT / os.fsdecode(name) for name in listing.stdout.split(b"\0") if name]
        return sorted({path for path in found if path.is_file() and not path.is_symlink()})
    ignored = [line.rstrip("/") for line in (ROOT / ".gitignore").read_text("utf-8").split()]
    found = []
    for folder, folders, files in os.walk(ROOT):
        folders[:] = [f for f in folders if not any(fnmatch(f, pattern) for pattern in ignored)]
        found += [Path(folder, f) for f in files if not any(fnmatch(f, p) for p in ignored)]
    return sorted(path for path in found if not path.is_symlink())


def package_folders() -> dict[str, Path]:
    packages = PYPROJECT["tool"]["setuptools"]["packages"]
    return {name: ROOT.joinpath(*name.split(".")[1:]) for name in packages}


def test_listed_packages_are_the_folders() -> None:
    holding = {
        path.parent
        for folder in MAY_IMPORT
        for pattern in ("*.py", "*.toml")
        for path in (ROOT / folder).rglob(pattern)
    }
    assert set(package_folders().values()) == {ROOT, *holding}
    assert PYPROJECT["tool"]["setuptools"]["package-dir"] == {"trajgap": "."}
    assert not (ROOT / "trajgap").exists(), "would shadow the installed package"


def test_the_face_at_the_root() -> None:
    """`import trajgap` has what README shows, loads it on first use, and knows its version."""
    import trajgap

    assert trajgap.__version__ == PYPROJECT["project"]["version"]
    for name in trajgap.__all__:
        assert getattr(trajgap, name).__module__.startswith("trajgap.")
    asked = "import sys, trajgap; print([n for n in sys.modules if n.startswith('trajgap.')])"
    run = subprocess.run([sys.executable, "-c", asked], capture_output=True, text=True, check=True)
    assert run.stdout.strip() == "[]"


def test_every_data_file_is_installed() -> None:
    patterns = PYPROJECT["tool"]["setuptools"]["package-data"]
    installed = {
        path
        for name, folder in package_folders().items()
        for pattern in ["*.py", *patterns["*"], *patterns.get(name, [])]
        for path in folder.glob(pattern)
    }
    here = {p for p in tracked_files() if p.relative_to(ROOT).parts[0] in MAY_IMPORT}
    assert {str(path.relative_to(ROOT)) for path in here - installed} == set()


def test_constraints_pin_every_requirement() -> None:
    pins = {}
    for line in (ROOT / "constraints.txt").read_text(encoding="utf-8").splitlines():
        if line and not line.startswith("#"):
            match = re.fullmatch(r"([a-z0-9]+(?:-[a-z0-9]+)*)==([0-9][0-9a-z.]*)", line)
            assert match, f"constraints.txt: {line!r} is not name==version"
            pins[match[1]] = match[2]
    assert list(pins) == sorted(pins)

    project = PYPROJECT["project"]
    pending = [Requirement(r) for r in project["dependencies"]]
    for extra in ("test", "docs"):
        pending += [Requirement(r) for r in project["optional-dependencies"][extra]]
    needed = set()
    while pending:
        requirement = pending.pop()
        name = canonicalize_name(requirement.name)
        if name in needed:
            continue
        needed.add(name)
        assert name in pins, f"constraints.txt does not pin {name}"
        assert requirement.specifier.contains(pins[name]), f"{requirement} against {pins[name]}"
        for below in map(Requirement, importlib.metadata.requires(name) or []):
            extras = requirement.extras or {""}
            if below.marker is None or any(below.marker.evaluate({"extra": e}) for e in extras):
                pending.append(below)


def test_the_conda_recipe_asks_for_the_same() -> None:
    recipe = yaml.safe_load((ROOT / ".ci" / "conda" / "meta.yaml").read_text("utf-8"))
    other_names = {"lazy-loader": "lazy_loader", "matplotlib": "matplotlib-base"}
    wanted = {"python": SpecifierSet(PYPROJECT["project"]["requires-python"])}
    for line in PYPROJECT["project"]["dependencies"]:
        one = Requirement(line)
        wanted[other_names.get(one.name, one.name)] = one.specifier
    stated = map(str.split, recipe["requirements"]["run"])
    assert {name: SpecifierSet(versions) for name, versions in stated} == wanted
    assert recipe["package"]["version"] == PYPROJECT["project"]["version"]
    name, entry = recipe["build"]["entry_points"][0].split(" = ")
    assert PYPROJECT["project"]["scripts"] == {name: entry}


def test_version_is_one() -> None:
    cited = re.search(r"^version: (\S+)$", (ROOT / "CITATION.cff").read_text(), re.MULTILINE)
    assert cited
    assert cited[1] == PYPROJECT["project"]["version"]


def fences(text: str) -> list[tuple[str, str]]:
    """Language and content of every fenced block."""
    return re.findall(r"^```(\w*)\n(.*?)^```$", text, re.MULTILINE | re.DOTALL)


def test_readme_has_exactly_the_commands_that_ci_runs() -> None:
    blocks = fences((ROOT / "README.md").read_text(encoding="utf-8"))
    assert {language for language, _ in blocks} <= {"sh", "python", "console"}
    assert [body.rstrip("\n") for language, body in blocks if language == "sh"] == README_COMMANDS
    script = ROOT / ".ci" / "run"
    assert os.access(script, os.X_OK)
    text = script.read_text(encoding="utf-8")
    assert "\nset -euo pipefail\n" in text
    runs = re.findall(r"^run '(.*?)'", text, re.MULTILINE)
    assert set(README_COMMANDS) <= set(runs)


def anchors(markdown: str) -> set[str]:
    """The fragment of every heading, as the usual hosts form it."""
    prose = re.sub(r"^```.*?^```$", "", markdown, flags=re.MULTILINE | re.DOTALL)
    headings = re.findall(r"^#+ +(.+?)#* *$", prose, re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", h.strip().lower()).replace(" ", "-") for h in headings}


def links(markdown: str) -> Iterator[str]:
    prose = re.sub(r"^```.*?^```$|`[^`\n]*`", "", markdown, flags=re.MULTILINE | re.DOTALL)
    yield from re.findall(r"\]\(<?([^()\s>]+)>?(?: +\"[^\"]*\")?\)", prose)
    yield from re.findall(r"^\[[^\]]+\]: +(\S+)", prose, re.MULTILINE)
    yield from re.findall(r"(?:src|href)=\"([^\"]+)\"", prose)


def test_links_inside_the_documents_resolve() -> None:
    documents = [path for path in tracked_files() if path.suffix == ".md"]
    assert ROOT / "README.md" in documents
    broken = []
    for document in documents:
        for link in links(document.read_text(encoding="utf-8")):
            if re.match(r"[a-z]+:", link) or "generated/" in link:  # made by Sphinx
                continue
            target, _, fragment = link.partition("#")
            path = document.parent / target if target else document
            if not path.exists() or (
                fragment and fragment not in anchors(path.read_text(encoding="utf-8"))
            ):
                broken.append(f"{document.relative_to(ROOT)}: {link}")
    assert broken == []


# Written so that these lines do not match themselves.
MACHINE = re.compile(
    rb"(?<![\w.~/-])/(?:home|root|Users|tmp|work|opt|mnt|srv)\b"
    rb"|\b[A-Za-z]:\\+Users\b"
    rb"|\b(?:pypi|pythonhosted|npmjs|anaconda|artifactory)\.\w"
    rb"|(?:index[-_]url|trusted[-_]host|find[-_]links)\b"
    rb"|\b(?:10|192\.168)(?:\.\d{1,3}){2,3}:\d",
    re.IGNORECASE,
)


def test_no_file_names_a_machine_or_a_registry() -> None:
    found = [
        f"{path.relative_to(ROOT)}: {match[0].decode()}"
        for path in tracked_files()
        for match in MACHINE.finditer(path.read_bytes())
    ]
    assert found == []
    for seen in ('"/' + 'tmp"', "C:" + r"\Users\someone", "https://" + "pypi." + "example/simple",
                 "PIP_INDEX" + "_URL=", "http://" + "10.0.0.7:" + "3141"):  # fmt: skip
        assert MACHINE.search(seen.encode())
    for passed in ("rad/s", "and/or/work", "./tmp", "doi 10.12677/mos.2024.136535"):
        assert not MACHINE.search(passed.encode())


MOST_LINES = 450
"""Lines of a file: what is read in one go."""


def test_no_file_is_too_long() -> None:
    folders = {ROOT / name for name in ("tests", "benchmarks", *MAY_IMPORT)}
    found = [p for p in tracked_files() if p.suffix == ".py" and folders & set(p.parents)]
    covered = {folder for p in found for folder in p.parents} & folders
    assert covered == folders, "a folder without files"
    assert len(found) > 400
    long = [p.name for p in found if len(p.read_text("utf-8").splitlines()) > MOST_LINES]
    assert long == [], "split by what it holds"


def test_doctests() -> None:
    failed = {}
    for folder in MAY_IMPORT:
        for name in source_modules(folder):
            if not name.endswith("__main__"):
                flags = doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE
                result = doctest.testmod(importlib.import_module(name), optionflags=flags)
                if result.failed:
                    failed[name] = result.failed
    assert failed == {}
