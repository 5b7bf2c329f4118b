"""The planners that `referee.py` compares: each answers a question with the motion it returns.

A planner that does not import is left out, with the line that installs it.
"""

from __future__ import annotations

import importlib
import importlib.metadata
import logging
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline, PPoly, make_interp_spline
from trajgap.problem.motions import Motion, as_motion

sys.path.insert(0, str(Path(__file__).parent))
from referee_motions import joined, steps, third_order, timed

Array = NDArray[np.float64]
CELLS = 50
"""Cells per segment of the way-points in the settings with a grid of their own."""


@dataclass(frozen=True, eq=False)
class Question:
    """Way-points in rad and limits of each joint; ``start`` and ``goal`` for states in motion."""

    name: str
    waypoints: Array
    velocity: Array
    acceleration: Array
    jerk: Array
    states: tuple[Array, ...] = ()
    """Velocity and acceleration at the start, then at the goal."""

    @property
    def cubic(self) -> PPoly:
        """The path of the planners without a jerk limit: a C2 spline, TOPPRA's own default."""
        if self.waypoints.shape[0] == 2:
            return _line(self.waypoints)
        return CubicSpline(np.linspace(0.0, 1.0, self.waypoints.shape[0]), self.waypoints)

    @property
    def quintic(self) -> PPoly:
        """The path under a jerk limit: the natural C4 spline, so jerk has no steps."""
        if self.waypoints.shape[0] == 2:
            return _line(self.waypoints)
        places = np.linspace(0.0, 1.0, self.waypoints.shape[0])
        free = np.zeros(self.waypoints.shape[1])
        ends = [(3, free), (4, free)]
        spline = make_interp_spline(places, self.waypoints, k=5, bc_type=(ends, ends))
        parts = [PPoly.from_spline((spline.t, spline.c[:, j], 5)) for j in range(free.size)]
        kept = np.searchsorted(parts[0].x, places[:-1], side="right") - 1
        return PPoly(np.stack([part.c[:, kept] for part in parts], axis=2), places)


def _line(waypoints: Array) -> PPoly:
    way = waypoints[1] - waypoints[0]
    return PPoly(np.stack([way, waypoints[0]])[:, None, :], np.array([0.0, 1.0]))


class NoAnswerError(Exception):
    """The planner gave no motion; its message says why."""


def _toppra(question: Question, cells: int | None, output: str) -> Motion:
    import toppra

    logging.getLogger("toppra").setLevel(logging.CRITICAL)
    places = np.linspace(0.0, 1.0, question.waypoints.shape[0])
    path = toppra.SplineInterpolator(places, question.waypoints)
    v, a = question.velocity, question.acceleration
    rows = [
        toppra.constraint.JointVelocityConstraint(np.column_stack([-v, v])),
        toppra.constraint.JointAccelerationConstraint(np.column_stack([-a, a])),
    ]
    grid = None if cells is None else np.linspace(0.0, 1.0, cells * (places.size - 1) + 1)
    solver = toppra.algorithm.TOPPRA(rows, path, gridpoints=grid, parametrizer=output)
    found = solver.compute_trajectory(0.0, 0.0)
    if found is None:
        raise NoAnswerError(str(solver.problem_data.return_code).rpartition(".")[2])
    return as_motion(found)


def _copp_robot(
    question: Question, path: PPoly, order: int, cells: int = CELLS
) -> tuple[Any, Array]:
    grid = np.linspace(0.0, 1.0, cells * (question.waypoints.shape[0] - 1) + 1)
    sizes = (question.velocity, question.acceleration, question.jerk)
    return copp_robot(path, grid, sizes[:order]), grid


def copp_robot(path: PPoly, grid: Array, sizes: Sequence[Array]) -> Any:
    """copp's robot on a path, with finite limits of as many derivatives as ``sizes`` has."""
    import copp_py

    robot = copp_py.Robot(sizes[0].size, capacity=grid.size)
    robot.append_s(grid)
    values = [np.ascontiguousarray(path(grid, r)) for r in range(4)]
    robot.set_q(*values[:3], 0, dddq=values[3])
    adds = (robot.add_velocity_limits, robot.add_acceleration_limits, robot.add_jerk_limits)
    for size, add in zip(sizes, adds, strict=False):
        add(size, -size, start_idx_s=0, length=grid.size)
    return robot


def copp_third(
    robot: Any, about: Array, slope: Array | None, rounds: int, speed: float, stationary: int
) -> Any:
    """copp's profile of third order, linearised about a profile and then about its own answers.

    ``speed`` is that along the path at both ends, squared; ``stationary`` the most intervals at
    either end in which it may rise from 0.
    """
    from copp_py.solver import topp3_socp

    profile = None
    for _ in range(rounds):
        asked = topp3_socp.Problem(
            robot.constraints,
            about,
            idx_s_start=0,
            a_boundary=(speed, speed),
            b_boundary=(0.0, 0.0),
            num_stationary_max=stationary,
            b_linearization=slope,
        )
        profile = topp3_socp.solve(asked)
        about, slope = profile.a, profile.b
    return profile


def _copp_second(robot: Any, grid: Array) -> Array:
    from copp_py.solver import topp2_ra

    asked = topp2_ra.Problem(
        robot.constraints, idx_s_interval=(0, grid.size - 1), a_boundary=(0.0, 0.0)
    )
    return np.asarray(topp2_ra.solve(asked, topp2_ra.Options()))


def _topp2(question: Question) -> Motion:
    path = question.cubic
    robot, grid = _copp_robot(question, path, 2)
    times, laws = steps(grid, _copp_second(robot, grid))
    return timed(path, times, laws, "copp's profile of second order")


def _topp3(question: Question, rounds: int, cells: int = CELLS) -> Motion:
    """TOPP3 as its guide shows: linearised about TOPP2's answer, then again about its own."""
    from copp_py.interpolation import s_to_t_topp3

    path = question.quintic
    robot, grid = _copp_robot(question, path, 3, cells)
    profile = copp_third(robot, _copp_second(robot, grid), None, rounds, 0.0, 1)
    _, times = s_to_t_topp3(grid, profile, 0.0)
    return third_order(path, grid, profile, np.asarray(times))


def _ruckig(question: Question, places: Array) -> Motion:
    import ruckig

    joints = question.waypoints.shape[1]
    parts = []
    for a, b in pairwise(places):
        asked = ruckig.InputParameter(joints)
        asked.current_position, asked.target_position = a.tolist(), b.tolist()
        asked.max_velocity = question.velocity.tolist()
        asked.max_acceleration = question.acceleration.tolist()
        asked.max_jerk = question.jerk.tolist()
        if question.states:
            v0, a0, v1, a1 = (x.tolist() for x in question.states)
            asked.current_velocity, asked.current_acceleration = v0, a0
            asked.target_velocity, asked.target_acceleration = v1, a1
        engine, answer = ruckig.Ruckig(joints), ruckig.Trajectory(joints)
        if question.states and not engine.validate_input(asked, True, True):
            raise NoAnswerError("validate_input: a state cannot be kept within the limits")
        result = engine.calculate(asked, answer)
        if result not in (ruckig.Result.Working, ruckig.Result.Finished):
            raise NoAnswerError(str(result))
        if answer.duration > 0:
            parts.append(as_motion(answer))
    if not parts:
        raise NoAnswerError("no way-points apart")
    return parts[0] if len(parts) == 1 else joined(parts)


def _drake(question: Question, discretization: str) -> Motion:
    from pydrake.multibody.optimization import Toppra, ToppraDiscretization
    from pydrake.trajectories import PiecewisePolynomial

    path = question.cubic
    joints = question.waypoints.shape[1]
    drawn = PiecewisePolynomial.CubicHermite(path.x, path(path.x).T, path(path.x, 1).T)
    grid = np.unique(np.concatenate([Toppra.CalcGridPoints(drawn, _grid_options()), path.x]))
    grid = grid[np.append(True, np.diff(grid) > 1e-12)]
    grid[-1] = path.x[-1]
    solver = Toppra(drawn, _plant(joints), grid)
    v, a = question.velocity, question.acceleration
    solver.AddJointVelocityLimit(-v, v)
    solver.AddJointAccelerationLimit(-a, a, getattr(ToppraDiscretization, discretization))
    law = solver.SolvePathParameterization(0.0, 0.0)
    if law is None:
        raise NoAnswerError("SolvePathParameterization gives None")
    times = [float(t) for t in law.get_segment_times()]
    laws = []
    for k in range(len(times) - 1):
        c = law.getPolynomialMatrix(k)[0, 0].GetCoefficients()
        laws.append(np.asarray(c, dtype=np.float64))
    return timed(path, times, laws, "Drake's path parameterization")


def _grid_options() -> Any:
    from pydrake.multibody.optimization import CalcGridPointsOptions

    return CalcGridPointsOptions()


_PLANTS: dict[int, Any] = {}


def _plant(joints: int) -> Any:
    """A chain of sliding joints: only its number of joints counts without torque limits."""
    if joints not in _PLANTS:
        from pydrake.multibody.plant import MultibodyPlant
        from pydrake.multibody.tree import PrismaticJoint, SpatialInertia

        plant = MultibodyPlant(0.0)
        parent = plant.world_body()
        for j in range(joints):
            body = plant.AddRigidBody(f"body{j}", SpatialInertia.SolidBoxWithMass(1, 0.1, 0.1, 0.1))
            plant.AddJoint(
                PrismaticJoint(f"joint{j}", parent.body_frame(), body.body_frame(), [1, 0, 0])
            )
            parent = body
        plant.Finalize()
        _PLANTS[joints] = plant
    return _PLANTS[joints]


@dataclass(frozen=True)
class Setting:
    """One planner in one setting."""

    planner: str
    name: str
    solve: Callable[[Question], Motion]
    order: int
    """2: velocity and acceleration are asked for; 3: jerk too."""
    path: str
    """What is prescribed: "cubic", "quintic", "stops" (rest at way-points), "ends", "states"."""
    share: float = 1.0
    """Part of the questions that it gets, where it takes much processor time."""


MODULES = {"toppra": "toppra", "ruckig": "ruckig", "copp-py": "copp_py", "drake": "pydrake"}
"""Packages by what they are imported as."""
SETTINGS = (
    Setting("toppra", "default", lambda q: _toppra(q, None, "ParametrizeSpline"), 2, "cubic"),
    Setting(
        "toppra",
        "ConstAccel, its own grid",
        lambda q: _toppra(q, None, "ParametrizeConstAccel"),
        2,
        "cubic",
    ),
    Setting(
        "toppra",
        "ConstAccel, 50 cells a segment",
        lambda q: _toppra(q, CELLS, "ParametrizeConstAccel"),
        2,
        "cubic",
    ),
    Setting(
        "toppra",
        "ConstAccel, 500 cells a segment",
        lambda q: _toppra(q, 10 * CELLS, "ParametrizeConstAccel"),
        2,
        "cubic",
        0.1,
    ),
    Setting("copp-py", "TOPP2-RA, 50 cells a segment", _topp2, 2, "cubic"),
    Setting("copp-py", "TOPP3-SOCP, 50 cells a segment", lambda q: _topp3(q, 1), 3, "quintic", 0.5),
    Setting(
        "copp-py",
        "TOPP3-SOCP, twice linearised",
        lambda q: _topp3(q, 2),
        3,
        "quintic",
        0.2,
    ),
    Setting(
        "copp-py",
        "TOPP3-SOCP, 200 cells a segment",
        lambda q: _topp3(q, 1, 4 * CELLS),
        3,
        "quintic",
        0.1,
    ),
    Setting(
        "drake", "Toppra, interpolation", lambda q: _drake(q, "kInterpolation"), 2, "cubic", 0.3
    ),
    Setting("drake", "Toppra, collocation", lambda q: _drake(q, "kCollocation"), 2, "cubic", 0.3),
    Setting("ruckig", "rest at each way-point", lambda q: _ruckig(q, q.waypoints), 3, "stops"),
    Setting("ruckig", "first to last", lambda q: _ruckig(q, q.waypoints[[0, -1]]), 3, "ends"),
    Setting("ruckig", "state to state", lambda q: _ruckig(q, q.waypoints), 3, "states"),
)
"""Every planner in every setting that is compared."""


def present() -> tuple[dict[str, str], list[str]]:
    """Versions of the planners that import, and a line for each that does not."""
    found, missing = {}, []
    for package, module in MODULES.items():
        try:
            importlib.import_module(module)
        except ImportError:
            missing.append(f'{package}: left out; python -m pip install "{package}"')
        else:
            found[package] = importlib.metadata.version(package)
    return found, missing
