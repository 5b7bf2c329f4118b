"""Optimisers that behave, and some that do everything wrong; found as ``support.optimizers:…``."""

import contextlib
import os
import random
import signal
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np


def draws(fun: Any, bounds: Any, budget: int, rng: Any) -> None:
    """Uniform draws, ten at a time."""
    for _ in range(0, budget, 10):
        fun(rng.uniform(bounds[:, 0], bounds[:, 1], (10, len(bounds))))


def fair(fun: Any, bounds: Any, budget: int, rng: Any, members: int = 20) -> object:
    """Random search in batches, with one single position at the end."""
    lower, upper = bounds.T
    for _ in range(budget // members):
        fun(rng.uniform(lower, upper, (members, len(bounds))))
    return fun(upper)


def draws_globally(fun: Any, bounds: Any, budget: int, rng: Any) -> None:
    """Uniform draws from the global generators of numpy and Python."""
    for _ in range(budget):
        share = (np.random.random(len(bounds)) + random.random()) / 2  # noqa: NPY002
        fun(bounds[:, 0] + share * (bounds[:, 1] - bounds[:, 0]))


def raises(fun: Any, bounds: Any, budget: int, rng: Any) -> None:
    fun(bounds.mean(axis=1))
    raise ZeroDivisionError("one\nover nothing" + "!" * 1000)


def overspends(fun: Any, bounds: Any, budget: int, rng: Any) -> None:
    while True:
        fun(rng.uniform(bounds[:, 0], bounds[:, 1]))


def warns(fun: Any, bounds: Any, budget: int, rng: Any) -> None:
    np.log(np.array([-1.0]))
    fun(bounds.mean(axis=1))


def prints(fun: Any, bounds: Any, budget: int, rng: Any) -> None:
    """Writes to the streams by which its process answers, and reads from the one that asks."""
    print("noise", flush=True)
    os.write(1, b"noise")
    sys.stdin.read()
    fun(bounds.mean(axis=1))


def sleeps(fun: Any, bounds: Any, budget: int, rng: Any) -> None:
    time.sleep(3600)


def hangs(fun: Any, bounds: Any, budget: int, rng: Any) -> None:
    """Catches whatever is raised to end it."""
    while True:
        try:
            time.sleep(3600)
        except BaseException:
            continue


def dies(fun: Any, bounds: Any, budget: int, rng: Any) -> None:
    fun(bounds.mean(axis=1))
    os.kill(os.getpid(), signal.SIGKILL)


def dies_once(fun: Any, bounds: Any, budget: int, rng: Any, mark: str) -> None:
    """The first process dies, and leaves a mark behind by which the next one knows."""
    if not Path(mark).exists():
        Path(mark).touch()
        os.kill(os.getpid(), signal.SIGKILL)
    draws(fun, bounds, budget, rng)


def forks(fun: Any, bounds: Any, budget: int, rng: Any) -> None:
    """Goes on in two processes, each of which believes that it is the run."""
    os.fork()
    draws(fun, bounds, budget, rng)


def forks_and_leaves(fun: Any, bounds: Any, budget: int, rng: Any, mark: str) -> None:
    """Leaves a process behind that never ends by itself, and is then killed."""
    found = os.fork()
    if not found:
        while True:
            time.sleep(3600)
    Path(mark).write_text(str(found), "utf-8")
    os.kill(os.getpid(), signal.SIGKILL)


def leaves_a_grandchild(
    fun: Any, bounds: Any, budget: int, rng: Any, mark: str, dies: bool
) -> None:
    """Leaves a process behind in a session of its own, whose parent is gone."""
    told, tells = os.pipe()
    if not os.fork():
        os.setsid()
        if not os.fork():
            with Path(mark).open("a", encoding="utf-8") as file:
                print(os.getpid(), file=file)
            os.write(tells, b"!")
            while True:
                time.sleep(3600)
        os._exit(0)
    os.read(told, 1)
    if dies:
        os.kill(os.getpid(), signal.SIGKILL)
    fun(bounds.mean(axis=1))


def scribbles(fun: Any, bounds: Any, budget: int, rng: Any) -> None:
    """Writes over all that it was given and that it got back."""
    for _ in range(0, budget, 10):
        asked = rng.uniform(bounds[:, 0], bounds[:, 1], (10, len(bounds)))
        found, kept = fun(asked), bounds.copy()
        asked[:], found[:], bounds[:] = -1.0, 0.0, np.nan
        bounds[:] = kept


def moves_bounds(fun: Any, bounds: Any, budget: int, rng: Any) -> None:
    """Makes its bounds wider, and asks there."""
    bounds[:, 1] += 1.0
    fun(bounds[:, 1])


def returns_short(fun: Any, bounds: Any, budget: int, rng: Any) -> Any:
    """Judges its draws, and returns something of another shape."""
    draws(fun, bounds, budget, rng)
    return np.zeros((2, 7))


def raises_unprintable(fun: Any, bounds: Any, budget: int, rng: Any) -> None:
    """Raises what no file can hold and no terminal should be sent."""
    raise ValueError("half of a pair: \udc80, a cursor that moves: \x1b[2J")


def raises_mute(fun: Any, bounds: Any, budget: int, rng: Any) -> None:
    """Raises an error that cannot say what it is."""

    class Mute(Exception):
        def __str__(self) -> str:
            raise RuntimeError("no words")

    raise Mute


def leaves_traces(fun: Any, bounds: Any, budget: int, rng: Any) -> None:
    """Changes what its process does with floating-point errors, warnings and random numbers."""
    np.seterr(all="raise")
    np.random.seed(0)  # noqa: NPY002
    fun(bounds.mean(axis=1))


def dawdles(fun: Any, bounds: Any, budget: int, rng: Any) -> None:
    """Takes a moment before every tenth of its budget."""
    for _ in range(10):
        time.sleep(0.01)
        fun(rng.uniform(bounds[:, 0], bounds[:, 1], (max(1, budget // 10), len(bounds))))


def asks_nan(fun: Any, bounds: Any, budget: int, rng: Any) -> None:
    fun(bounds[:, 1])
    fun(np.full(len(bounds), np.nan))


def returns_nan(fun: Any, bounds: Any, budget: int, rng: Any) -> object:
    fun(bounds[:, 1])
    return np.stack([bounds[:, 1], np.full(len(bounds), np.nan)])


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


def exits(fun: Any, bounds: Any, budget: int, rng: Any) -> None:
    raise SystemExit(3)


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
    swallows: "continued after its budget of 40 evaluations was spent",
    hides_faults: "asked for the fitness of NaN",
    raises: "one",
    judges_nothing: "evaluated no position",
    wrong_shape: r"asked for the fitness of shape \(2,\); give \(3,\) or \(batch, 3\)",
    asks_words: "asked for the fitness of something that is not numeric",
}
"""What each is told within bounds of 0.1 to 3 s on three segments and a budget of 40."""
