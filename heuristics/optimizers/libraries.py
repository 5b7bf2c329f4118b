"""Optimisers of mealpy, pymoo, pygmo and pycma, with their libraries' own settings."""

from __future__ import annotations

import importlib
import pkgutil
from collections.abc import Iterator, Mapping
from types import ModuleType
from typing import Any

import numpy as np

from ...problem import Array, PackageError, TrajgapError
from ..settings import nearest
from .borrowed import BorrowedTask


def load_package(name: str, wanted_by: str) -> Any:
    """Import an optional package.

    Raises
    ------
    PackageError
        If it is not installed; says how to install it.
    """
    try:
        return importlib.import_module(name)
    except ImportError as error:
        raise PackageError(
            f"{wanted_by}: needs the package {name} ({error}); "
            f"install it with `python -m pip install {name}`"
        ) from None


def mealpy_class(name: str) -> Any:
    """One of mealpy's optimisers by its name."""
    package = load_package("mealpy", f"mealpy:{name}")
    found = {
        attribute: kind
        for module in vars(package).values()
        if isinstance(module, ModuleType) and module.__name__.startswith("mealpy.")
        for attribute, kind in vars(module).items()
        if isinstance(kind, type) and issubclass(kind, package.Optimizer)
    }
    return _named(found, "mealpy", name)


def _named(found: Mapping[str, Any], package: str, name: str) -> Any:
    if name not in found:
        known = [f"{package}:{one}" for one in found]
        raise TrajgapError(f"{package}:{name}: unknown; {nearest(f'{package}:{name}', known)}")
    return found[name]


def minimise_by_mealpy(name: str, options: Mapping[str, Any], task: BorrowedTask) -> None:
    """Run one of mealpy's optimisers; its epochs fill the budget."""
    import mealpy

    kind = mealpy_class(name)
    members = int(options.get("pop_size", kind().pop_size))
    model = kind(**{"epoch": max(1, task.budget // members), **options})
    space = mealpy.FloatVar(lb=task.lower.tolist(), ub=task.upper.tolist())
    question = {"obj_func": task.fun, "bounds": space, "minmax": "min", "log_to": None}
    model.solve(question, seed=task.number())


def pymoo_class(name: str) -> Any:
    """One of pymoo's single-objective algorithms by its name."""
    load_package("pymoo", f"pymoo:{name}")
    from pymoo.core.algorithm import Algorithm

    return _named(dict(_pymoo_classes(Algorithm)), "pymoo", name)


def _pymoo_classes(base: type) -> Iterator[tuple[str, Any]]:
    import pymoo.algorithms.soo.nonconvex as folder

    for module in pkgutil.iter_modules(folder.__path__, folder.__name__ + "."):
        try:
            found = importlib.import_module(module.name)
        except Exception:
            continue  # it needs a package of its own, and pymoo says so by a plain Exception
        for attribute, kind in vars(found).items():
            own = isinstance(kind, type) and issubclass(kind, base)
            if own and kind.__module__ == module.name:
                yield attribute, kind


def minimise_by_pymoo(name: str, options: Mapping[str, Any], task: BorrowedTask) -> None:
    """Run one of pymoo's optimisers until the budget is spent, generation by generation."""
    from pymoo.core.problem import Problem
    from pymoo.core.termination import NoTermination
    from pymoo.optimize import minimize

    class AskedByPymoo(Problem):  # type: ignore[misc]  # pymoo is untyped
        def _evaluate(self, x: Array, out: dict[str, Any], *_: object, **__: object) -> None:
            out["F"] = task.fun(x)[:, None]

    question = AskedByPymoo(n_var=len(task.box), n_obj=1, xl=task.lower, xu=task.upper)
    minimize(question, pymoo_class(name)(**options), NoTermination(), seed=task.number())


def pygmo_class(name: str) -> Any:
    """One of pygmo's algorithms by its name."""
    package = load_package("pygmo", f"pygmo:{name}")
    found = {
        attribute: kind
        for attribute, kind in vars(package).items()
        if isinstance(kind, type) and hasattr(kind, "_pygmo_cpp_algorithm")
    }
    return _named(found, "pygmo", name)


def minimise_by_pygmo(name: str, options: Mapping[str, Any], task: BorrowedTask) -> None:
    """Run one of pygmo's optimisers; its generations fill the budget."""
    import pygmo

    class AskedByPygmo:
        def fitness(self, x: Array) -> list[float]:
            return [task.fun(x)]

        def get_bounds(self) -> tuple[list[float], list[float]]:
            return task.lower.tolist(), task.upper.tolist()

        def __deepcopy__(self, _: object) -> AskedByPygmo:  # pygmo copies it, and the count is one
            return self

    given = dict(options)
    members = int(given.pop("pop_size", 20))  # it has no default; its tutorials take 20
    kind = pygmo_class(name)
    generations = {"gen": max(1, task.budget // members)}
    # CMA-ES and xNES leave the bounds unless told not to.
    for usual in ({**generations, "force_bounds": True}, generations, {}):
        try:
            chosen = kind(**{**usual, **given})
            break
        except TypeError:  # it counts no generations, or stays within the bounds anyway
            if not usual:
                raise
    algorithm = pygmo.algorithm(chosen)
    if algorithm.has_set_seed():
        algorithm.set_seed(task.number())
    algorithm.evolve(pygmo.population(pygmo.problem(AskedByPygmo()), members, seed=task.number()))


def minimise_by_cma(options: Mapping[str, Any], task: BorrowedTask) -> None:
    """Run CMA-ES in the unit cube; each restart doubles the population, until the budget is spent.

    Source: Auger and Hansen, "A restart CMA evolution strategy with increasing population size",
    CEC 2005. Positions outside the bounds are mapped back by pycma.
    """
    import cma

    def normal(*shape: int) -> Array:
        return task.rng.standard_normal(shape)

    width = task.upper - task.lower
    members = int(options.get("popsize", 4 + int(3 * np.log(len(width)))))
    # No output and no files; no seed, because the numbers come from our generator.
    quiet = {"verbose": -9, "verb_log": 0, "seed": np.nan}
    while True:
        kept = {**quiet, "bounds": [0, 1], "randn": normal, **options, "popsize": members}
        # A first step of 0.3 of each range is what its manual recommends.
        search = cma.CMAEvolutionStrategy(task.rng.random(len(width)), 0.3, kept)
        while not search.stop():
            drawn = search.ask()
            unit = np.clip(np.array(drawn), 0.0, 1.0)
            search.tell(drawn, task.fun(task.lower + width * unit).tolist())
        members *= 2
