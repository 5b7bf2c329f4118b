"""Compiled functions are named after all their sources, so that no stale one is loaded."""

import ast
import hashlib
from importlib import import_module
from pathlib import Path

import pytest
from support.checkout import ROOT

STAMPED = {
    "trajgap.problem.curves.kernel": (),
}
"""Modules that name a room's kernels, and the files elsewhere whose functions those call."""


def folder_of(module: str) -> Path:
    """Where a module was imported from: the checkout, or what is installed."""
    file = import_module(module).__file__
    assert file is not None
    return Path(file).resolve().parent


@pytest.mark.parametrize("home", STAMPED)
def test_compiled_functions_carry_the_hash_of_all_their_sources(home: str) -> None:
    paths = [folder_of(home) / name for name in import_module(home).KERNELS]
    root = folder_of("trajgap.problem").parent
    called = [root / name for name in STAMPED[home]]
    stamp = hashlib.sha256(b"".join(path.read_bytes() for path in paths + called)).hexdigest()[:16]
    for path in paths:
        module = import_module(f"{home.rpartition('.')[0]}.{path.stem}")
        compiled = [x.py_func for x in vars(module).values() if hasattr(x, "py_func")]
        elsewhere = {Path(f.__code__.co_filename).resolve() for f in compiled} - set(paths)
        assert elsewhere <= set(called), f"{path.name} calls compiled functions of other files"
        functions = [f for f in compiled if Path(f.__code__.co_filename).resolve() in paths]
        assert functions, f"{path.name} compiles nothing"
        assert all(f.__qualname__ == f"{f.__name__}_{stamp}" for f in functions)


@pytest.mark.parametrize("home", STAMPED)
def test_the_stamp_covers_every_file_that_is_compiled(home: str) -> None:
    # A file is compiled with a stamp if it decorates a function with ``compiled``.
    compiling = {
        path.name
        for path in folder_of(home).glob("*.py")
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(node, ast.FunctionDef)
        and any(ast.unparse(d) == "compiled" for d in node.decorator_list)
        and path.name != "compilation.py"
    }
    assert compiling == set(import_module(home).KERNELS)


def test_nothing_else_is_compiled() -> None:
    # Only the stamped compiler calls numba: a bare one would cache old callees.
    users = {
        path.relative_to(ROOT).as_posix()
        for folder in ("problem", "nlp", "heuristics", "compare")
        for path in (ROOT / folder).rglob("*.py")
        if "numba.njit" in path.read_text(encoding="utf-8")
    }
    assert users == {"problem/curves/compilation.py"}
