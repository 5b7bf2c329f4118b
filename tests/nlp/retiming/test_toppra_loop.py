"""Our loop over toppra's linear programs ends at the bits of toppra's own loop."""

from __future__ import annotations

import numpy as np
import pytest
from toppra.algorithm import TOPPRA
from trajgap.nlp.retiming import toppra_piece
from trajgap.nlp.retiming.grid import measure, sample
from trajgap.nlp.retiming.path import pieces
from trajgap.problem import fit, three_five_three


class Plain(toppra_piece._Solver):
    """The same end condition, and toppra's own loops and parametrisation."""

    def compute_controllable_sets(self, sdmin, sdmax):
        return np.asarray(TOPPRA.compute_controllable_sets(self, 0.0, sdmax))

    def fastest_speeds(self, start, end):
        answer = self.compute_trajectory(start, end)
        if answer is None:
            return None
        speeds = np.asarray(self.problem_data.sd_vec)
        durations.append(float(answer.duration))
        return speeds


durations: list[float] = []
"""What toppra's parametrisation says, in its own unit of time."""


def drawn(seed: int):
    rng = np.random.default_rng(seed)
    trajectory = fit(three_five_three(), rng.normal(size=(4, 3)) + 0.3, rng.uniform(0.3, 2.0, 3))
    return trajectory, rng.uniform(0.5, 3.0, 3), rng.uniform(0.5, 6.0, 3)


@pytest.mark.parametrize("ends", [(0.0, 0.0), (0.05, 0.02), (0.0, 0.1)])
@pytest.mark.parametrize("seed", range(4))
def test_the_same_bits(seed, ends, monkeypatch):
    trajectory, velocity, acceleration = drawn(seed)
    (piece, *_), _ = pieces(trajectory)
    path = sample(piece, measure(piece), 150)
    ours = toppra_piece.optimal_speeds(path, velocity, acceleration, ends, piece.duration)
    durations.clear()
    monkeypatch.setattr(toppra_piece, "_Solver", Plain)
    theirs = toppra_piece.optimal_speeds(path, velocity, acceleration, ends, piece.duration)
    assert (ours is None) == (theirs is None)
    assert ours is not None
    assert ours[1].tobytes() == theirs[1].tobytes()
    length, speed = toppra_piece._UNITS[len(durations) - 1]
    assert ours[0] == durations[-1] * (piece.duration * speed / length)


def test_a_program_that_fails_is_left_to_toppra(monkeypatch):
    """From a speed that no step forward keeps, toppra tries a little slower ones."""
    trajectory, velocity, acceleration = drawn(1)
    (piece, *_), _ = pieces(trajectory)
    path = sample(piece, measure(piece), 60)
    began = []

    class Failing(toppra_piece._Solver):
        def compute_parameterization(self, *asked):
            began.append(asked)
            self.solver_wrapper = self.usual
            return super().compute_parameterization(*asked)

        def fastest_speeds(self, start, end):
            self.usual = self.solver_wrapper
            self.solver_wrapper = Undecided(self.usual)
            return super().fastest_speeds(start, end)

    class Undecided:
        def __init__(self, usual):
            self.usual = usual

        def __getattr__(self, name):
            return getattr(self.usual, name)

        def solve_stagewise_optim(self, i, h, g, low, high, *rest):
            found = self.usual.solve_stagewise_optim(i, h, g, low, high, *rest)
            return found if np.isnan(low) or i != 30 else np.full_like(found, np.nan)

    usual = toppra_piece.optimal_speeds(path, velocity, acceleration, (0.0, 0.0), piece.duration)
    monkeypatch.setattr(toppra_piece, "_Solver", Failing)
    again = toppra_piece.optimal_speeds(path, velocity, acceleration, (0.0, 0.0), piece.duration)
    assert len(began) == 1
    assert usual is not None
    assert again is not None
    assert again[1] == pytest.approx(usual[1], rel=1e-9)
