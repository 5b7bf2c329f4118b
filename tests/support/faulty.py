"""Optimisers that each do one thing wrong, and one that does nothing wrong."""

import contextlib
import time
from typing import Any

import numpy as np


def fair(fun: Any, bounds: Any, budget: int, rng: Any, members: int = 20) -> object:
    """Random search in batches, with one single position at the end."""
    lower, upper = bounds.T
    for _ in range(budget // members):
        fun(rng.uniform(lower, upper, (members, len(bounds))))
    return fun(upper)


def asks_nan(fun: Any, bounds: Any, budget: int, rng: Any) -> None:
    fun(bounds[:, 1])
    fun(np.full(len(bounds), np.nan))


def returns_nan(fun: Any, bounds: Any, budget: int, rng: Any) -> object:
    fun(bounds[:, 1])
    return np.full(len(bounds), np.nan)


def leaves_bounds(fun: Any, bounds: Any, budget: int, rng: Any) -> None:
    fun(bounds[:, 1] + [0.0, 7.0, 0.0])


def returns_outside(fun: Any, bounds: Any, budget: int, rng: Any) -> object:
    fun(bounds[:, 1])
    return bounds[:, 0] - 1


def swallows(fun: Any, bounds: Any, budget: int, rng: Any) -> None:
    """Goes on after its budget is spent."""
    for _ in range(budget + 5):
        with contextlib.suppress(BaseException):
            fun(rng.uniform(*bounds.T))


def hides_faults(fun: Any, bounds: Any, budget: int, rng: Any) -> None:
    """Catches what the objective says of its NaN."""
    with contextlib.suppress(Exception):
        fun(np.full(len(bounds), np.nan))


def raises_at_times(fun: Any, bounds: Any, budget: int, rng: Any) -> None:
    """Fails in half of its runs, by their first draw."""
    fun(bounds[:, 1])
    if rng.random() < 0.5:
        raise ZeroDivisionError("at times")


def generator_of(rng: Any) -> None:
    """Takes too little."""


def anything(*given: Any, **settings: Any) -> None:
    """Takes whatever it gets."""


def raises(fun: Any, bounds: Any, budget: int, rng: Any) -> None:
    fun(bounds[:, 1])
    raise ZeroDivisionError("of its own")


def exits(fun: Any, bounds: Any, budget: int, rng: Any) -> None:
    raise SystemExit(3)


def hangs(fun: Any, bounds: Any, budget: int, rng: Any) -> None:
    fun(bounds[:, 1])
    time.sleep(1000)


def spins(fun: Any, bounds: Any, budget: int, rng: Any) -> None:
    fun(bounds[:, 1])
    while True:
        with contextlib.suppress(Exception):
            pass


def judges_nothing(fun: Any, bounds: Any, budget: int, rng: Any) -> None:
    pass


def wrong_shape(fun: Any, bounds: Any, budget: int, rng: Any) -> None:
    fun(bounds[:2, 1])


def asks_words(fun: Any, bounds: Any, budget: int, rng: Any) -> None:
    fun("three")


FAULTS = {
    asks_nan: "asked for the fitness of NaN",
    returns_nan: "returned NaN",
    leaves_bounds: "asked for the fitness of 10 s for duration 2, outside its bounds 0.1 to 3 s",
    returns_outside: "returned -0.9 s for duration 1, outside its bounds 0.1 to 3 s",
    swallows: "went on after its budget of 40 evaluations was spent",
    hides_faults: "asked for the fitness of NaN",
    raises: "of its own",
    judges_nothing: "judged no position",
    wrong_shape: r"asked for the fitness of shape \(2,\); give \(3,\) or \(batch, 3\)",
    asks_words: "asked for the fitness of something that is not numbers",
}
"""What each is told within bounds of 0.1 to 3 s on three segments and a budget of 40."""
