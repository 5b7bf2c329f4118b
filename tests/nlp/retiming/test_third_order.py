"""TOPP3 of copp, which limits jerk, on the path of a proven optimum."""

import sys
from pathlib import Path

import numpy as np
import pytest
from trajgap.problem import fit
from trajgap.problem.suite import load_instance

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
