"""Our loop over toppra's linear programs, what it loads, and the motions that come of it."""

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from toppra.algorithm import TOPPRA
from trajgap.nlp import retime, retimed_motion
from trajgap.nlp.retiming import toppra_piece
from trajgap.nlp.retiming.grid import measure, sample
from trajgap.nlp.retiming.path import pieces
from trajgap.problem import Limits, TrajgapError, fit, three_five_three
from trajgap.problem.motions import JointLimits, check_motion
from trajgap.problem.suite import load_instance


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
    assert again[1] == pytest.approx(usual[1], rel=1e-9)


RETIMED = """
import sys
from trajgap.nlp import retime
from trajgap.problem import Limits, fit, three_five_three
path = fit(three_five_three(), [[0.0], [1.0], [0.5], [2.0]], [1.2, 0.9, 1.7])
assert retime(path, Limits(2.0, 4.0, joints=1)).applicable
"""
NONE_THERE = """
assert not any(name.partition(".")[0] == "matplotlib" for name in sys.modules)
"""
DRAWN = """
import matplotlib
matplotlib.use("Agg")
import matplotlib.pyplot
assert matplotlib.pyplot.__spec__.origin.endswith("pyplot.py")
import numpy as np, toppra
from toppra.algorithm import TOPPRA
limits = [
    toppra.constraint.JointVelocityConstraint(np.array([[-2.0, 2.0]])),
    toppra.constraint.JointAccelerationConstraint(np.array([[-4.0, 4.0]])),
]
path = toppra.SplineInterpolator([0.0, 0.5, 1.0], np.array([[0.0], [1.0], [0.5]]))
grid = np.linspace(0, 1, 101)
planned = TOPPRA(limits, path, gridpoints=grid, parametrizer="ParametrizeConstAccel")
planned.compute_trajectory(0, 0).plot_parametrization()
planned.inspect()
assert len(matplotlib.pyplot.gcf().axes[-1].lines) >= 3
"""


@pytest.mark.parametrize(
    "program",
    [
        pytest.param(RETIMED + NONE_THERE + DRAWN, id="before"),
        pytest.param(DRAWN + RETIMED, id="after", marks=pytest.mark.slow),
        pytest.param("import toppra\n" + RETIMED + DRAWN, id="beside", marks=pytest.mark.slow),
    ],
)
def test_who_draws_is_served_as_ever(program: str) -> None:
    run = subprocess.run(
        [sys.executable, "-W", "error::ImportWarning", "-c", program],
        capture_output=True,
        text=True,
        check=False,
    )
    assert run.returncode == 0, run.stderr


WAYPOINTS = np.array([[0.1, -2.0], [0.9, -1.2], [1.4, 0.4], [0.7, 1.0]])
MOTION = fit(three_five_three(), WAYPOINTS, [0.9, 1.1, 0.8])
LIMITS = Limits([2.0, 3.0], [6.0, 9.0])


def test_it_is_as_long_and_on_the_path():
    motion = retimed_motion(MOTION, LIMITS, ("a", "b"), cells=1000)
    retiming = retime(MOTION, LIMITS)
    assert motion.total_time == pytest.approx(retiming.durations[1], rel=1e-3)
    assert motion.total_time == pytest.approx(retiming.extrapolated, rel=5e-3)
    dense = MOTION(np.linspace(0.0, MOTION.total_time, 200_001))
    for place in motion(np.linspace(0.0, motion.total_time, 60)):
        assert np.linalg.norm(dense - place, axis=1).min() < 5e-5
    found = check_motion(motion, JointLimits.of(LIMITS, ("a", "b")))
    assert found.worst.ratio < 1.2  # of the first and last cells, where curvature is largest
    velocity = [p.ratio for p in found.peaks if p.quantity == "velocity"]
    assert max(velocity) < 1.001


def test_a_finer_grid_is_nearer_to_the_limits():
    limits = JointLimits.of(LIMITS, ("1", "2"))
    over = []
    for cells in (250, 2000):
        motion = retimed_motion(MOTION, LIMITS, cells=cells)
        at = np.linspace(0.05, motion.total_time - 0.05, 4001)
        over.append((np.abs(motion(at, 2)) / limits.upper[:, 2]).max() - 1.0)
    assert over[1] < over[0] + 1e-9
    assert over[1] < 0.02


def test_where_toppra_does_not_apply():
    with pytest.raises(TrajgapError, match="jerk is limited"):
        retimed_motion(MOTION, Limits(2.0, 6.0, 50.0, joints=2))


sys.path.insert(0, str(Path(__file__).parents[3] / "benchmarks"))


def test_topp3_is_not_slower_on_the_path_of_an_optimum():
    copp = pytest.importorskip("copp_py")
    from third_order_retiming import SOLVER, path_of, retimed

    instance = load_instance("quintic-gasparetto2008")
    problem = instance.problem()
    motion = fit(problem.curve, problem.waypoints, np.asarray(instance.durations))
    times = np.linspace(0.0, motion.total_time, 101)[1:-1]
    for order in range(4):
        np.testing.assert_allclose(path_of(motion)(times, order), motion(times, order), atol=1e-9)
    limits = problem.limits.derivatives
    for cells in (10, 20, 40):
        assert retimed(motion, limits, cells).time <= motion.total_time * (1 + SOLVER)
    # Jerk is at its limit at the ends of this optimum: a lower limit leaves TOPP3 no timing.
    with pytest.raises(copp.CoppError):
        retimed(motion, limits * [1.0, 1.0, 0.9], 25)
