"""From a name to an optimiser that can be run within a budget of evaluations."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import partial
from typing import Any, cast

import numpy as np

from ...problem import Array, TrajgapError
from ..algorithm import Algorithm, Search
from ..algorithms import KINDS, from_settings
from ..objective import Bounds, Counted
from ..settings import COUNT, checked, folded, nearest
from .baselines import rescale_equal, search_locally, search_randomly
from .borrowed import Borrowed, BorrowedTask
from .callables import call_function, call_object, check_call, load_function
from .libraries import (
    load_package,
    mealpy_class,
    minimise_by_cma,
    minimise_by_mealpy,
    minimise_by_pygmo,
    minimise_by_pymoo,
    pygmo_class,
    pymoo_class,
)
from .scipy_methods import ENDED_BY_BUDGET, check_scipy, minimise_by_scipy, scipy_words

Searching = Callable[[Mapping[str, Any], BorrowedTask], object]
"""A search with its settings."""

BUDGET = 6000
"""Evaluations of what counts no iterations, by default: as many as 30 particles take in 200."""

_BASELINES: dict[str, Searching] = {
    "random": search_randomly,
    "rescale": rescale_equal,
    "multistart": search_locally,
}
"""Searches that need nothing but this package."""

_LIBRARIES: dict[str, tuple[Callable[[str], Any], Callable[..., object]]] = {
    "mealpy": (mealpy_class, minimise_by_mealpy),
    "pymoo": (pymoo_class, minimise_by_pymoo),
    "pygmo": (pygmo_class, minimise_by_pygmo),
}
"""By what stands before the colon: what finds a name or refuses it, and the search by it."""

BASELINES: tuple[str, ...] = tuple(_BASELINES)
"""What every comparison includes."""
_OWN = (*KINDS, *BASELINES, "cma")
"""Names that need no prefix."""


def find_optimizer(
    name: str | Callable[..., object], budget: int | None = None, **settings: object
) -> Algorithm[Any] | Search:
    """Optimiser with a name, ready to run within a budget of evaluations.

    Parameters
    ----------
    name : str or callable
        In any case, with or without hyphens (`optimizer_name`):
        one of the papers' algorithms (`KINDS`), such as "pso"; a baseline: "random", "rescale",
        "multistart"; "cma"; one of scipy's, mealpy's, pymoo's or pygmo's:
        "scipy:differential_evolution", "mealpy:OriginalWOA", "pymoo:DE", "pygmo:sade"; your own
        function
        ``f(fun, bounds, budget, rng, **settings)``, as "module:function" or itself. Its ``fun``
        takes one vector or a batch, ``bounds`` has shape (dimensions, 2), s.
    budget : int, optional
        Evaluations. An algorithm of the papers gets as many iterations as use it up, unless the
        settings name ``iterations``; without a budget it has the iterations that its paper prints.
        Any other optimiser then has 6000 evaluations.
    **settings
        Settings of the optimiser; those left out keep their defaults.

    Raises
    ------
    TrajgapError
        If the name or a setting is unknown, or a package is missing.

    Examples
    --------
    >>> find_optimizer("mnam-pso").iterations, find_optimizer("mnam-pso", 6000).iterations
    (200, 192)
    >>> find_optimizer("scipy:dual_annealing").kind
    'scipy:dual_annealing'
    """
    own = budget is None
    budget = BUDGET if budget is None else checked(COUNT, "budget", budget)
    if callable(name):
        said = f"{getattr(name, '__module__', '?')}:{getattr(name, '__qualname__', name)}"
        check_call(said, name, settings)
        return _borrowed(said, partial(call_object, name), budget, settings)
    name = optimizer_name(name)
    if name in KINDS:
        algorithm = from_settings(name, settings)
        return algorithm if own or "iterations" in settings else _fitted(algorithm, budget)
    if name in _BASELINES:
        return _borrowed(name, _BASELINES[name], budget, settings)
    if name == "cma":
        load_package(name, name)
        return _borrowed(name, minimise_by_cma, budget, settings)
    source, colon, rest = name.partition(":")
    if not colon:
        raise TrajgapError(
            f"optimizer {name!r}: unknown; {nearest(name, scipy_words() | {n: n for n in _OWN})} "
            "A function of yours is called module:function, such as mine:evolve for evolve in "
            "mine.py"
        )
    if source == "scipy":
        check_scipy(rest, settings)
        return _borrowed(name, partial(minimise_by_scipy, rest), budget, settings)
    if source in _LIBRARIES:
        find, minimise = _LIBRARIES[source]
        find(rest)
        return _borrowed(name, partial(minimise, rest), budget, settings)
    check_call(name, load_function(name), settings)
    return _borrowed(name, partial(call_function, name), budget, settings)


def optimizer_name(text: str) -> str:
    """Name of an optimiser as it appears in rows and tables.

    Parameters
    ----------
    text : str
        Case, hyphens and underscores do not matter in names of ours and of scipy.

    Returns
    -------
    str
        Any other name is returned unchanged.

    Examples
    --------
    >>> optimizer_name("MNAM_PSO"), optimizer_name("SciPy:shgo"), optimizer_name("mine:PSO")
    ('mnam-pso', 'scipy:shgo', 'mine:PSO')
    """
    scipys = (f"scipy:{one}" for one in ENDED_BY_BUDGET)
    known = {folded(one): one for one in (*_OWN, *scipys)}
    return known.get(folded(text), text)


def _borrowed(
    kind: str, searching: Searching, budget: int, settings: Mapping[str, object]
) -> Borrowed:
    given = dict(settings)
    return Borrowed(kind, partial(searching, given), iterations=budget - 1, options=given)


def evaluations_of(method: Algorithm[Any] | Search) -> int:
    """Evaluations that a method takes for all its iterations.

    Parameters
    ----------
    method : Algorithm or Search
        From `find_optimizer`.

    Examples
    --------
    >>> evaluations_of(find_optimizer("constrained-pso"))
    3030
    """
    if isinstance(method, Search):
        return method.per_iteration * (method.iterations + 1)
    first, each = _costs(method)
    return first + each * method.iterations


def _fitted(algorithm: Algorithm[Any], budget: int) -> Algorithm[Any]:
    """The algorithm with as many iterations as a budget pays for.

    Schedules that run over the iterations then end where the budget does. What remains of the
    budget is less than one iteration.
    """
    first, each = _costs(algorithm)
    iterations = max(0, (budget - first) // each)
    return cast(Algorithm[Any], replace(cast(Any, algorithm), iterations=iterations))


def _costs(algorithm: Algorithm[Any]) -> tuple[int, int]:
    """Evaluations of the first population and of an iteration, found by trying one."""
    counted = Counted(_sums)
    rng = np.random.Generator(np.random.PCG64(0))
    bounds = Bounds(np.zeros(2), np.full(2, np.inf))
    two = cast(Algorithm[Any], replace(cast(Any, algorithm), iterations=2))
    with np.errstate(over="ignore", invalid="ignore"):
        state = two.init(bounds, rng, counted)
        first = counted.evaluations
        two.step(state, bounds, rng, counted)
    return first, max(1, counted.evaluations - first)


def _sums(positions: Array) -> Array:
    totals: Array = np.abs(positions).sum(axis=1)
    return totals
