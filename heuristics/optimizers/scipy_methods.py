"""scipy's global optimisers, with scipy's own settings; the budget alone ends them early."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from ...problem import Array, TrajgapError
from ..settings import nearest
from .borrowed import BorrowedTask
from .callables import check_settings

ENDED_BY_BUDGET: dict[str, tuple[str, ...]] = {
    "basinhopping": ("niter",),
    "differential_evolution": ("maxiter",),
    "direct": ("maxiter", "maxfun"),
    "dual_annealing": ("maxiter",),
    "shgo": (),
}
"""Functions of scipy.optimize, with the settings that leave the end to the budget if large."""


def scipy_words() -> dict[str, str]:
    """Scipy's optimisers by the words that somebody may write: names, and initials such as "de"."""
    initials = {"".join(word[0] for word in one.split("_")): one for one in ENDED_BY_BUDGET}
    names = {one: one for one in ENDED_BY_BUDGET}
    return {word: f"scipy:{one}" for word, one in (initials | names).items()}


def check_scipy(name: str, settings: Mapping[str, object]) -> None:
    """Find out whether scipy's function is known, and has such settings.

    Raises
    ------
    TrajgapError
        If not; names the nearest.
    """
    if name not in ENDED_BY_BUDGET:
        said = nearest(name.lower(), scipy_words())
        raise TrajgapError(f"scipy:{name}: unknown; {said}")
    if not settings:
        return  # scipy need not be loaded
    from scipy import optimize

    known = inspect.signature(getattr(optimize, name)).parameters
    # Versions from 1.15 on take both words for the generator; the signature names one.
    check_settings(f"scipy:{name}", settings, {*known, "rng", "seed"})


def minimise_by_scipy(name: str, options: Mapping[str, Any], task: BorrowedTask) -> object:
    """Run one of scipy's optimisers."""
    from scipy import optimize

    function = getattr(optimize, name)
    # No budget reaches as many iterations.
    unending = dict.fromkeys(ENDED_BY_BUDGET[name], 10**6)
    kept = {**unending, **_random(function, task.rng), **options}
    if name == "basinhopping":
        local = {"method": "L-BFGS-B", "bounds": task.box}
        return _hop(function, task, {"minimizer_kwargs": local, **kept})
    fun: Callable[[Array], Any] = task.fun
    if kept.get("vectorized"):

        def fun(x: Array) -> Any:  # a generation comes as columns
            return task.fun(x.T)

    return function(fun, [tuple(side) for side in task.box.tolist()], **kept)


def _hop(function: Callable[..., object], task: BorrowedTask, kept: Mapping[str, Any]) -> object:
    def within(x_new: Array, **_: object) -> bool:
        return bool((x_new >= task.lower).all() and (x_new <= task.upper).all())

    def held(x: Array) -> Any:  # the hop itself knows no bounds
        return task.fun(np.clip(x, task.lower, task.upper))

    return function(held, task.draw(1)[0], accept_test=within, **kept)


def _random(function: Callable[..., object], rng: np.random.Generator) -> dict[str, object]:
    # scipy 1.15 renamed the keyword; shgo and direct draw no random numbers.
    known = inspect.signature(function).parameters
    return next(({name: rng} for name in ("rng", "seed") if name in known), {})
