"""Whales: the weight (22) of z1-woa-bspline, their pull towards 0, and another program.

Every step beside its equations: test_one_by_one.
"""

from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import mannwhitneyu
from trajgap.heuristics import PSO, WOA, Bounds, states

# --- not shift-invariant --------------------------------------------------------------------------


def bowl(x: np.ndarray, shift: float) -> np.ndarray:
    return ((x - shift) ** 2).sum(axis=-1)


def finals(record: WOA | PSO, shift: float, seeds: int = 12) -> np.ndarray:
    """Final values on a sphere; the box is shifted together with its centre."""
    low, high = shift - 5.0, shift + 5.0
    record = replace(record, position_initial=(low, high), iterations=150)
    box = Bounds(np.full(5, low), np.full(5, high))
    found = []
    for seed in range(seeds):
        *_, last = states(record, lambda x: bowl(x, shift), box, np.random.default_rng(seed))
        found.append(last.best_fitness)
    return np.array(found)


def test_what_woa_finds_depends_on_where_zero_is() -> None:
    """The same question, shifted by 3: WOA loses more than ten digits, PSO none."""
    assert finals(WOA(), 0.0).max() < 1e-15
    assert finals(WOA(), 3.0).min() > 1e-4
    pso = PSO(velocity_initial=(-2.0, 2.0))
    ratio = np.median(finals(pso, 3.0)) / np.median(finals(pso, 0.0))
    assert 0.1 < ratio < 10


@pytest.mark.slow
@pytest.mark.parametrize("shift", [0.0, 1.3])
def test_against_mealpy(shift: float) -> None:
    """mealpy 3.0.3, OriginalWOA: alike once its departures from the paper are set alike.

    Its departures: a whale moves only if it is then better; one r for A and C; δ counted from 1;
    a fresh random point in place of a random whale. The first three are settings here, the last is
    undone there. It is no requirement of the tests: its metadata asks for numpy below 2.
    """
    mealpy = pytest.importorskip("mealpy")
    whale = pytest.importorskip("mealpy.swarm_based.WOA")

    class Member(whale.OriginalWOA):  # type: ignore[misc, name-defined]
        def evolve(self, epoch: int) -> None:
            self.problem.generate_solution = lambda encoded=True: (
                self.pop[self.generator.integers(self.pop_size)].solution
            )
            super().evolve(epoch)

    question = {
        "bounds": mealpy.FloatVar(lb=(shift - 5.0,) * 5, ub=(shift + 5.0,) * 5),
        "minmax": "min",
        "obj_func": lambda x: float(bowl(x, shift)),
        "log_to": None,
    }
    theirs = [
        Member(epoch=150, pop_size=30).solve(question, seed=seed).target.fitness
        for seed in range(40)
    ]
    record = WOA(replacement="greedy", r_rule="shared", counter="one")
    assert mannwhitneyu(finals(record, shift, 40), theirs).pvalue > 0.01
