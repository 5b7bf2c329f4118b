"""A cross-check under jerk limits: copp's TOPP3 times the path of each proven optimum of the suite.

    python -m pip install ".[planners]"
    python benchmarks/third_order_retiming.py | python docs/tables.py third-order-retiming

TOPPRA knows no jerk limit, so it says nothing of how a jerk limit was treated. TOPP3 does. The
timing of the optimum itself, s(t) = t, is one of those that it chooses from, whatever the grid. So
TOPP3 must have an answer, and none that is longer than the optimum: otherwise one of the two takes
the limits for others than they are. Both are asserted on three grids, and the command ends with 1
where they fail.

The instances are those whose path has a continuous third derivative (C4 quintic splines), with a
jerk limit on every joint. TOPP3 linearises jerk about a profile: first about s(t) = t, then
about its own answers.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import PPoly
from trajgap.problem import Trajectory, fit
from trajgap.problem.motions import JointLimits, Motion, check_motion
from trajgap.problem.suite import BenchmarkInstance, list_instances

sys.path.insert(0, str(Path(__file__).parent))
from referee_motions import third_order
from referee_planners import copp_robot, copp_third

Array = NDArray[np.float64]
CELLS = (25, 50, 100)
"""Cells of each segment; three grids, each twice as fine as the last."""
ROUNDS = 4
"""Linearisations: the time changes by less than 0.1 % from the third to the fourth."""
NO_LIMIT = 1e9
"""rad/s or rad/s² where a joint has no limit: copp takes finite ones only."""
SOLVER = 1e-6
"""Relative length over the optimum that the tolerance of copp's cone solver explains."""


@dataclass(frozen=True)
class Retimed:
    """What TOPP3 returns on a grid.

    Attributes
    ----------
    time : float
        s.
    repaired : float
        After the uniform slow-down with which the motion keeps every limit at all times, s.
    ratio : float
        Largest ratio of a value to its limit, at any time.
    """

    time: float
    repaired: float
    ratio: float


def path_of(motion: Trajectory) -> PPoly:
    """The path q(s) of a motion by its own time: pieces of degree 5."""
    times = motion.breaks
    powers = []
    factor = 1.0
    for order in range(6):
        factor *= max(order, 1)
        at = [
            [motion.values(k, j, order, np.zeros(1))[0] for j in range(motion.joints)]
            for k in range(times.size - 1)
        ]
        powers.append(np.array(at) / factor)
    return PPoly(np.stack(powers[::-1]), times)


def retimed(motion: Trajectory, limits: Array, cells: int) -> Retimed:
    """The path of a motion as TOPP3 times it, judged for all t."""
    from copp_py.interpolation import s_to_t_topp3

    path = path_of(motion)
    ends = zip(motion.breaks[:-1], motion.breaks[1:], strict=True)
    grid = np.unique(np.concatenate([np.linspace(a, b, cells + 1) for a, b in ends]))
    finite = np.where(np.isfinite(limits), limits, NO_LIMIT)
    robot = copp_robot(path, grid, [np.array(size) for size in finite.T])
    # The motion itself starts and ends with s' = 1 and s'' = 0.
    still, steady = np.zeros(grid.size), np.ones(grid.size)
    profile = copp_third(robot, steady, still, ROUNDS, 1.0, 0)
    _, times = s_to_t_topp3(grid, profile, 0.0)
    found = third_order(path, grid, profile, np.asarray(times))
    return Retimed(found.total_time, *_judged(found, limits))


def _judged(motion: Motion, limits: Array) -> tuple[float, float]:
    check = check_motion(motion, JointLimits.from_values(motion.joints, *limits.T))
    return motion.total_time * check.stretch, max(peak.ratio for peak in check.peaks)


def instances() -> list[BenchmarkInstance]:
    """Instances of the suite that TOPP3 can be asked about."""
    quintic = [one for one in list_instances() if one.curve == "C4 quintic"]
    return [one for one in quintic if np.isfinite(one.problem().limits.derivatives[:, 2]).all()]


def main(names: Sequence[str] = ()) -> int:
    """Print the table; 1 if a time is longer than the optimum."""
    heads = ["instance", "optimum, s"]
    heads += [f"TOPP3, {cells} cells a segment" for cells in CELLS]
    heads += ["worst ratio", "after slow-down", "not longer"]
    print(f"| {' | '.join(heads)} |\n|{' --- |' * len(heads)}")
    failed = False
    for one in instances():
        if names and one.name not in names:
            continue
        problem = one.problem()
        motion = fit(problem.curve, problem.waypoints, np.asarray(one.durations))
        found = [retimed(motion, problem.limits.derivatives, cells) for cells in CELLS]
        total = motion.total_time
        holds = all(each.time <= total * (1 + SOLVER) for each in found)
        failed |= not holds
        shares = [f"{100 * (each.time / total - 1):.1f} %" for each in found]
        last = found[-1]
        print(
            f"| `{one.name}` | {total:.4f} | {' | '.join(shares)} | {last.ratio:.4f} | "
            f"{100 * (last.repaired / total - 1):.1f} % | {'yes' if holds else 'no'} |",
            flush=True,
        )
    return int(failed)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
