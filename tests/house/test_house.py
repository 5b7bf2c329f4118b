"""The rules of the house that no other tool checks: flow, packaging, documents."""

import ast
import importlib
import importlib.metadata
import importlib.util
import inspect
import re
import subprocess
import sys
from functools import cache

import pytest
from support.checkout import ROOT
from support.house_files import MAY_IMPORT, source_modules

SOLVERS = {"casadi", "toppra", "scipy.optimize"}


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


def loaded_by(names: list[str]) -> set[str]:
    """What the interpreter has loaded after it has imported some modules."""
    program = (
        "import importlib, sys\n"
        f"for name in {names!r}: importlib.import_module(name)\n"
        "print('\\n'.join(sys.modules))"
    )
    run = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert run.returncode == 0, run.stderr
    return set(run.stdout.split())


@pytest.mark.parametrize(
    ("source", "target"),
    [
        ("from trajgap import nlp as n", "trajgap.nlp"),
        ("from .. import nlp", "trajgap.nlp"),
        ("def f():\n    from ..nlp.solve import solve", "trajgap.nlp"),
        ("import importlib\nimportlib.import_module('..nlp', __package__)", "trajgap.nlp"),
        ("import scipy as sp\nsp.optimize.linprog()", "scipy.optimize"),
        ("from .nlp import x\nfrom scipy.interpolate import PPoly\noptimize = 1", None),
    ],
)
def test_flow_check_sees_every_spelling_and_no_more(source: str, target: str | None) -> None:
    found = imports(source, "trajgap.problem")
    seen = [one for one in forbidden("problem") if reaches(found, one)]
    assert seen == ([target] if target else [])


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
    face = importlib.import_module(package)
    public = [n for n, x in vars(face).items() if n[0] != "_" and not inspect.ismodule(x)]
    return list(getattr(face, "__all__", public))


def test_across_folders_only_faces_are_imported() -> None:
    faults = []
    for folder in MAY_IMPORT:
        for name, path in source_modules(folder).items():
            package = name if path.name == "__init__.py" else name.rpartition(".")[0]
            faults += around_the_face(name, package, path.read_text(encoding="utf-8"))
    assert faults == []
    home = "trajgap.nlp.optimum"
    for source, seen in (
        ("from ...problem.curves.kernel import roots_in_unit", True),
        ("from ...problem.curves import kernel", True),
        ("from .. import solve", True),
        ("from ...problem import check", False),
        ("from ..retiming import retime", False),
    ):
        assert bool(around_the_face(f"{home}.x", home, source)) == seen, source


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
    heavy = {"casadi", "numba", "numpy", "scipy", "pydantic", "matplotlib", "toppra", "typer"}
    assert loaded_by(packages()) & heavy == set()


def test_commands_that_draw_nothing_load_no_pictures() -> None:
    commands = [f"trajgap.compare.cli.{name}_command" for name in ("check", "new", "solve")]
    assert "matplotlib" not in loaded_by(commands)


def kinds() -> str:
    """Pattern of the names of every kind of curve and trajectory."""
    face = importlib.import_module("trajgap.problem.curves")
    values = {name: getattr(face, name) for name in face_names("trajgap.problem.curves")}
    bases = face.Curve, face.Trajectory
    found = [n for n, v in values.items() if isinstance(v, type) and issubclass(v, bases)]
    return "|".join(sorted({*found, "StretchedCurve"} - {"Curve", "Trajectory"}))


ASK_FOR_A_KIND = {
    # Named in docs/reference/interpolants.md, with the reason.
    "nlp/optimum/pieces.py",
    "nlp/enclosure/box_bound.py",
    "compare/pages/readings.py",
    "problem/curves/interpolant.py",
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
    page = (ROOT / "docs" / "reference" / "interpolants.md").read_text(encoding="utf-8")
    assert {name for name in ASK_FOR_A_KIND if f"`{name}`" not in page} == set()
    for source in ("isinstance(c, A | curves.TimedUniformBSpline)", "{ClampedBSpline: 1}",
                   "@shape.register\ndef _(curve: X): pass"):  # fmt: skip
        assert asks_for_a_kind(source)
