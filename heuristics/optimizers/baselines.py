"""What every comparison includes: random search, one shared duration, and local searches."""

from __future__ import annotations

import sys
from collections.abc import Mapping
from typing import Any

import numpy as np

from .borrowed import BorrowedTask


def search_randomly(options: Mapping[str, Any], task: BorrowedTask) -> None:
    """Draw every position uniformly within the bounds."""
    left = task.budget
    while left > 0:
        count = min(1000, left)  # enough at a time to be quick, little memory
        task.fun(task.draw(count))
        left -= count


def rescale_equal(options: Mapping[str, Any], task: BorrowedTask) -> None:
    """Find the shortest duration that all segments can share, by bisection.

    The black-box form of `trajgap.heuristics.uniform_rescaling`: no random numbers, some fifty
    evaluations. Durations are set to their bounds where these differ.
    """

    def feasible(duration: float) -> bool:
        fitness = task.fun(np.clip(duration, task.lower, task.upper))
        return bool(fitness < task.penalty)

    low, high = float(task.lower.min()), float(task.upper.max())
    if not feasible(high) or feasible(low):
        return
    # As many bisections as a double has digits: no more would move it.
    for _ in range(min(sys.float_info.mant_dig - 1, task.budget - 2)):
        middle = (low + high) / 2
        low, high = (low, middle) if feasible(middle) else (middle, high)


def search_locally(options: Mapping[str, Any], task: BorrowedTask) -> None:
    """Run Nelder and Mead's simplex from uniformly drawn starts until the budget is spent.

    The simplex needs no gradient, which the death penalty does not have.
    """
    from scipy.optimize import minimize

    kept = {"xatol": 1e-8, "fatol": 1e-10, "adaptive": True, **options}
    while True:
        start = task.draw(1)[0]
        if task.fun(start) >= task.penalty:
            continue  # a simplex on the plateau of the penalty has nowhere to go
        minimize(task.fun, start, method="Nelder-Mead", bounds=task.box, options=kept)
