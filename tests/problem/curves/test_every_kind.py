"""Every kind of curve is known to whoever asks first, whatever was imported before."""

import subprocess
import sys

import pytest


@pytest.mark.parametrize(
    "curve",
    [
        "uniform_cubic_b_spline(4, 'timed')",
        "uniform_cubic_b_spline(4, 'stretched')",
        "ClampedBSpline(4, 5)",
    ],
)
@pytest.mark.parametrize("verb", ["evaluate(problem, [[1, 1, 1]])", "check(problem, [1, 1, 1])"])
def test_a_fresh_process_knows_the_kind(curve: str, verb: str) -> None:
    program = (
        "from trajgap.problem import *\n"
        "q = [[0.25, -0.5], [1.0, 0.125], [-0.375, 0.75], [0.5, 0.25]]\n"
        f"problem = Problem(q, Limits([9.0, 8.0]), {curve})\n"
        f"print(type({verb}).__name__)"
    )
    run = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert (run.returncode, run.stderr) == (0, "")
