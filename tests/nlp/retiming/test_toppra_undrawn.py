"""toppra comes without matplotlib, and draws as ever where it is asked to."""

from __future__ import annotations

import subprocess
import sys

import pytest

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
    [RETIMED + NONE_THERE + DRAWN, DRAWN + RETIMED, "import toppra\n" + RETIMED + DRAWN],
    ids=["before", "after", "beside"],
)
def test_who_draws_is_served_as_ever(program: str) -> None:
    run = subprocess.run(
        [sys.executable, "-W", "error::ImportWarning", "-c", program],
        capture_output=True,
        text=True,
        check=False,
    )
    assert run.returncode == 0, run.stderr
