"""Every kind of curve is known to whoever asks first, whatever was imported before."""

import ast
import subprocess
import sys

import pytest
from support.checkout import ROOT
from trajgap.problem.curves import every_kind

FOLDER = ROOT / "problem" / "curves"


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


def test_what_kinds_register_is_handed_out_with_all_of_them() -> None:
    registered, registering = set(), set()
    for path in FOLDER.glob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.FunctionDef):
                for decorator in map(ast.unparse, node.decorator_list):
                    if decorator.endswith(".register"):
                        registered.add(decorator.removesuffix(".register").rpartition(".")[2])
                        registering.add(path.stem)
    # Trajectories register their extrema in the module that makes them.
    assert registered - {"extrema"} <= set(every_kind.__all__)
    loaded = {module.__name__.rpartition(".")[2] for module in every_kind.KINDS}
    assert registering - {"kind", "clamped"} == loaded, "clamped is imported by clamped_fit"
