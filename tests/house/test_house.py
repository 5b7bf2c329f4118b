"""The rules of the house that no other tool checks: flow, packaging, documents."""

import ast
import doctest
import importlib
import importlib.metadata
import importlib.util
import inspect
import os
import re
import subprocess
import sys
import tomllib
from collections.abc import Iterator
from fnmatch import fnmatch
from functools import cache
from pathlib import Path

import pytest
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name
from support.checkout import ROOT

PYPROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))

MAY_IMPORT = {
    "problem": set(),
    "verify": set(),
    "nlp": {"problem", "verify"},
    "heuristics": {"problem"},
    "compare": {"problem", "verify", "nlp", "heuristics"},
}
SOLVERS = {"casadi", "toppra", "scipy.optimize"}

README_COMMANDS = [
    "python -m pip install . && trajgap audit",
    'python -m pip install ".[test]" && python -m pytest',
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
    ignored = [
        line.rstrip("/") for line in (ROOT / ".gitignore").read_text(encoding="utf-8").split()
    ]
    found = []
    for folder, folders, files in os.walk(ROOT):
        folders[:] = [f for f in folders if not any(fnmatch(f, pattern) for pattern in ignored)]
        found += [Path(folder, f) for f in files if not any(fnmatch(f, p) for p in ignored)]
    return sorted(path for path in found if not path.is_symlink())


@cache
def source_modules(folder: str) -> dict[str, Path]:
    """Dotted name and file of every module in a folder."""
    found = {}
    for path in sorted((ROOT / folder).rglob("*.py")):
        parts = path.relative_to(ROOT).with_suffix("").parts
        found[".".join(("trajgap", *parts)).removesuffix(".__init__")] = path
    return found


# --- one-way flow ---------------------------------------------------------------------------------


def imports(source: str, package: str) -> set[str]:
    """Dotted names that a module of ``package`` reaches, however it spells the import."""
    tree = ast.parse(source)
    bound: dict[str, str] = {}
    reached = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            for alias in node.names:
                reached.add(alias.name)
                first = alias.name.partition(".")[0]
                bound[alias.asname or first] = alias.name if alias.asname else first
        elif isinstance(node, ast.ImportFrom):
            base = importlib.util.resolve_name("." * node.level + (node.module or ""), package)
            reached.add(base)
            for alias in node.names:
                reached.add(f"{base}.{alias.name}")
                bound[alias.asname or alias.name] = f"{base}.{alias.name}"
        elif isinstance(node, ast.Call) and node.args:
            name, argument = ast.unparse(node.func), node.args[0]
            if name.endswith(("import_module", "__import__")) and isinstance(
                argument, ast.Constant
            ):
                reached.add(importlib.util.resolve_name(str(argument.value), package))
    for node in ast.walk(tree):
        if isinstance(node, ast.Attribute):
            first, dot, rest = ast.unparse(node).partition(".")
            if first in bound:
                reached.add(bound[first] + dot + rest)
    return reached


def reaches(names: set[str], target: str) -> bool:
    return any(name == target or name.startswith(target + ".") for name in names)


def forbidden(folder: str) -> set[str]:
    others = MAY_IMPORT.keys() - MAY_IMPORT[folder] - {folder}
    return {f"trajgap.{other}" for other in others} | (SOLVERS if folder == "problem" else set())


@pytest.mark.parametrize("folder", MAY_IMPORT)
def test_flow_is_one_way(folder: str) -> None:
    modules = source_modules(folder)
    assert modules, f"{folder}/ holds no module"
    faults = []
    for name, path in modules.items():
        package = name if path.name == "__init__.py" else name.rpartition(".")[0]
        found = imports(path.read_text(encoding="utf-8"), package)
        faults += [f"{name} reaches {t}" for t in sorted(forbidden(folder)) if reaches(found, t)]
    assert faults == []


@pytest.mark.parametrize("folder", ["problem", "nlp", "heuristics"])
def test_flow_is_one_way_when_run(folder: str) -> None:
    # The second route: what the interpreter really loaded. scipy.interpolate loads scipy.optimize
    # by itself, so that one is left to the reading of the sources.
    program = (
        "import importlib, sys\n"
        f"for name in {list(source_modules(folder))!r}: importlib.import_module(name)\n"
        "print('\\n'.join(sys.modules))"
    )
    run = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert run.returncode == 0, run.stderr
    loaded = set(run.stdout.split())
    assert loaded & (forbidden(folder) - {"scipy.optimize"}) == set()


@pytest.mark.parametrize(
    ("source", "target"),
    [
        ("import trajgap.nlp", "trajgap.nlp"),
        ("from trajgap import nlp as n", "trajgap.nlp"),
        ("from trajgap.nlp.optimum.solver import solve", "trajgap.nlp"),
        ("from ..nlp import solve", "trajgap.nlp"),
        ("from .. import nlp", "trajgap.nlp"),
        ("def f():\n    from ..nlp.solve import solve", "trajgap.nlp"),
        ("import importlib\nimportlib.import_module('..nlp', __package__)", "trajgap.nlp"),
        ("from scipy import optimize", "scipy.optimize"),
        ("import scipy\nscipy.optimize.linprog()", "scipy.optimize"),
        ("import scipy as sp\nsp.optimize.linprog()", "scipy.optimize"),
        ("import casadi as ca", "casadi"),
    ],
)
def test_flow_check_sees_every_spelling(source: str, target: str) -> None:
    assert reaches(imports(source, "trajgap.problem"), target)


@pytest.mark.parametrize(
    "source", ["from .nlp import x", "from scipy.interpolate import PPoly", "optimize = 1"]
)
def test_flow_check_raises_no_false_alarm(source: str) -> None:
    found = imports(source, "trajgap.problem")
    assert not any(reaches(found, target) for target in forbidden("problem"))


# --- faces ----------------------------------------------------------------------------------------


@cache
def packages() -> list[str]:
    return sorted(
        name.removesuffix(".__init__")
        for folder in MAY_IMPORT
        for name, path in source_modules(folder).items()
        if path.name == "__init__.py"
    )


def around_the_face(name: str, package: str, source: str) -> list[str]:
    """Imports of ours that reach into another folder past its face."""
    faults = []
    houses = set(packages())
    for node in ast.walk(ast.parse(source)):
        if not isinstance(node, ast.ImportFrom) or not (
            node.level or (node.module or "").startswith("trajgap")
        ):
            continue
        base = importlib.util.resolve_name("." * node.level + (node.module or ""), package)
        # A folder may use its own modules, and those that lie in the folders around it.
        home = base if base in houses else base.rpartition(".")[0]
        inside = f"{package}.".startswith(f"{home}.")
        if base not in houses and not inside:
            faults.append(f"{name}: {ast.unparse(node)}")
        if base in houses:
            modules = [a.name for a in node.names if f"{base}.{a.name}" in all_modules()]
            if modules and not inside:
                faults.append(f"{name}: {ast.unparse(node)}")
            if inside and set(face_names(base)) & {a.name for a in node.names}:
                faults.append(f"{name}: asks the face of a folder around it: {ast.unparse(node)}")
    return faults


@cache
def all_modules() -> set[str]:
    return {name for folder in MAY_IMPORT for name in source_modules(folder)}


@cache
def face_names(package: str) -> list[str]:
    return list(getattr(importlib.import_module(package), "__all__", ()))


def test_across_folders_only_faces_are_imported() -> None:
    faults = []
    for folder in MAY_IMPORT:
        for name, path in source_modules(folder).items():
            package = name if path.name == "__init__.py" else name.rpartition(".")[0]
            faults += around_the_face(name, package, path.read_text(encoding="utf-8"))
    assert faults == []


@pytest.mark.parametrize(
    "source",
    [
        "from ...problem.curves.kernel import roots_in_unit",
        "from trajgap.problem.curves.kernel import roots_in_unit",
        "from ...problem.curves import kernel",
        "from ..retiming.path import pieces",
        "from .. import solve",
    ],
)
def test_the_face_rule_sees(source: str) -> None:
    assert around_the_face("trajgap.nlp.optimum.x", "trajgap.nlp.optimum", source)


@pytest.mark.parametrize(
    "source",
    [
        "from ...problem import check",
        "from .starts import settled",
        "from ..retiming import retime",
    ],
)
def test_the_face_rule_lets_pass(source: str) -> None:
    assert not around_the_face("trajgap.nlp.optimum.x", "trajgap.nlp.optimum", source)


def test_no_module_is_named_like_a_public_function() -> None:
    functions = {
        name: package
        for package in packages()
        for name in face_names(package)
        if inspect.isroutine(getattr(importlib.import_module(package), name))
    }
    leaves = {name.rpartition(".")[2]: name for name in all_modules()}
    assert {leaves[name]: functions[name] for name in leaves.keys() & functions} == {}


def test_faces_import_nothing_heavy() -> None:
    program = (
        "import importlib, sys\n"
        f"for name in {packages()!r}: importlib.import_module(name)\n"
        "print('\\n'.join(sys.modules))"
    )
    run = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert run.returncode == 0, run.stderr
    loaded = set(run.stdout.split())
    heavy = {"casadi", "numba", "numpy", "scipy", "pydantic", "matplotlib", "toppra", "typer"}
    assert loaded & heavy == set()


# --- kinds of curve -------------------------------------------------------------------------------


def kinds() -> str:
    """Pattern of the names of every kind of curve and trajectory."""
    face = importlib.import_module("trajgap.problem.curves")
    values = {name: getattr(face, name) for name in face_names("trajgap.problem.curves")}
    bases = face.Curve, face.Trajectory
    found = [n for n, v in values.items() if isinstance(v, type) and issubclass(v, bases)]
    return "|".join(sorted({*found, "StretchedCurve"} - {"Curve", "Trajectory"}))


ASK_FOR_A_KIND = {
    # Named in docs/interpolants.md, with the reason.
    "nlp/optimum/curve_symbols.py",
    "nlp/enclosure/box_bound.py",
    "compare/pages/readings.py",
}


def asks_for_a_kind(source: str) -> list[str]:
    """Places that decide by the type of a curve or trajectory, whatever the spelling."""
    found, names = [], kinds()
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Call) and ast.unparse(node.func) in ("isinstance", "issubclass"):
            tested = re.fullmatch(rf".*\b({names})\b.*", ast.unparse(node.args[1]))
            found += [ast.unparse(node)] if tested else []
        if isinstance(node, ast.Call) and ast.unparse(node) in ("type(curve)", "type(trajectory)"):
            found.append(ast.unparse(node))
        if isinstance(node, ast.Dict) and any(
            key is not None and re.fullmatch(names, ast.unparse(key)) for key in node.keys
        ):
            found.append(ast.unparse(node))
        if isinstance(node, ast.FunctionDef) and any(
            ast.unparse(one).endswith("register") for one in node.decorator_list
        ):
            found.append(node.name)
    return found


def test_only_the_documented_places_ask_for_a_kind_of_curve() -> None:
    asking = set()
    for path in (p for folder in MAY_IMPORT for p in source_modules(folder).values()):
        name = path.relative_to(ROOT).as_posix()
        if asks_for_a_kind(path.read_text(encoding="utf-8")):
            # Each proof applies to the kinds that it was derived for, and says so by type.
            asking |= {name} if not name.startswith("nlp/proofs/") else set()
    assert asking == ASK_FOR_A_KIND
    page = (ROOT / "docs" / "interpolants.md").read_text(encoding="utf-8")
    assert {name for name in ASK_FOR_A_KIND if f"`{name}`" not in page} == set()


@pytest.mark.parametrize(
    "source",
    [
        "isinstance(a.curve, Interpolant)",
        "isinstance(c, A | curves.TimedUniformBSpline)",
        "if type(trajectory) is X: pass",
        "{ClampedBSpline: 1}",
        "@shape.register\ndef _(curve: X): pass",
    ],
)
def test_the_kind_rule_sees(source: str) -> None:
    assert asks_for_a_kind(source)


# --- packaging ------------------------------------------------------------------------------------


def package_folders() -> dict[str, Path]:
    return {
        name: ROOT.joinpath(*name.split(".")[1:])
        for name in PYPROJECT["tool"]["setuptools"]["packages"]
    }


def test_listed_packages_are_the_folders() -> None:
    holding = {
        path.parent
        for folder in MAY_IMPORT
        for pattern in ("*.py", "*.toml")
        for path in (ROOT / folder).rglob(pattern)
    }
    assert set(package_folders().values()) == holding
    assert PYPROJECT["tool"]["setuptools"]["package-dir"] == {f"trajgap.{f}": f for f in MAY_IMPORT}
    assert not (ROOT / "trajgap").exists(), "would shadow the installed package"
    assert not (ROOT / "__init__.py").exists(), "would shadow the installed package"


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


def test_typings_link_to_the_folders() -> None:
    links = {link.name: os.readlink(link) for link in (ROOT / "typings" / "trajgap").iterdir()}
    assert links == {folder: f"../../{folder}" for folder in MAY_IMPORT}
    for folder in MAY_IMPORT:
        assert (ROOT / "typings" / "trajgap" / folder / "py.typed").is_file()


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
    pending += [Requirement(r) for r in project["optional-dependencies"]["test"]]
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


def test_version_is_one() -> None:
    cited = re.search(r"^version: (\S+)$", (ROOT / "CITATION.cff").read_text(), re.MULTILINE)
    assert cited
    assert cited[1] == PYPROJECT["project"]["version"]


# --- documents ------------------------------------------------------------------------------------


def fences(text: str) -> list[tuple[str, str]]:
    """Language and content of every fenced block."""
    return re.findall(r"^```(\w*)\n(.*?)^```$", text, re.MULTILINE | re.DOTALL)


def test_readme_has_exactly_the_two_commands_that_ci_runs() -> None:
    blocks = fences((ROOT / "README.md").read_text(encoding="utf-8"))
    assert {language for language, _ in blocks} <= {"sh", "python"}
    assert [body.rstrip("\n") for language, body in blocks if language == "sh"] == README_COMMANDS
    script = ROOT / ".ci" / "run"
    assert os.access(script, os.X_OK)
    text = script.read_text(encoding="utf-8")
    assert "\nset -euo pipefail\n" in text
    assert re.findall(r"^run '(.*?)'", text, re.MULTILINE)[:2] == README_COMMANDS


def test_readme_python_runs(capsys: pytest.CaptureFixture[str]) -> None:
    blocks = fences((ROOT / "README.md").read_text(encoding="utf-8"))
    programs = [body for language, body in blocks if language == "python"]
    assert programs
    for program in programs:
        exec(compile(program, "README.md", "exec"), {"__name__": "readme"})
    assert capsys.readouterr().out


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
            if re.match(r"[a-z]+:", link):
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


@pytest.mark.parametrize(
    "text",
    [
        "see /" + "home/someone/file",
        '"/' + 'tmp"',
        "C:" + r"\Users\someone",
        "https://" + "pypi." + "example/simple",
        "PIP_INDEX" + "_URL=",
        "http://" + "10.0.0.7:" + "3141",
    ],
)
def test_machine_pattern_sees(text: str) -> None:
    assert MACHINE.search(text.encode())


@pytest.mark.parametrize("text", ["rad/s", "and/or/work", "./tmp", "doi 10.12677/mos.2024.136535"])
def test_machine_pattern_lets_pass(text: str) -> None:
    assert not MACHINE.search(text.encode())


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


@pytest.mark.parametrize("folder", MAY_IMPORT)
def test_every_public_name_has_a_docstring(folder: str) -> None:
    package = importlib.import_module(f"trajgap.{folder}")
    bare = []
    for name in package.__all__:
        value = getattr(package, name)
        if isinstance(value, type) or inspect.isroutine(value):
            # A dataclass without a docstring is given its signature as one.
            text = vars(value).get("__doc__") if isinstance(value, type) else value.__doc__
            if not text or text.startswith(f"{name}("):
                bare.append(name)
    assert bare == []
