"""The published comparison of three lower bounds, and the soundness of the McCormick reference."""

from __future__ import annotations

import runpy
import sys
from typing import Any

import numpy as np
import pytest
from scipy.interpolate import make_interp_spline
from support.checkout import ROOT
from trajgap.nlp import solve
from trajgap.problem import Limits, Problem, quintic_spline

BENCHMARKS = ROOT / "benchmarks"


@pytest.fixture
def reference(monkeypatch: pytest.MonkeyPatch) -> dict[str, Any]:
    """What benchmarks/quintic_mccormick.py defines."""
    monkeypatch.syspath_prepend(str(BENCHMARKS))
    found = runpy.run_path(str(BENCHMARKS / "quintic_mccormick.py"))
    sys.modules.pop("quintic_instances", None)
    return found


def small() -> Problem:
    q = np.array([[0.25, -0.5], [1.0, 0.125], [-0.375, 0.75], [0.5, 0.25]])
    return Problem(q, Limits([1.0, 0.9], [2.0, 1.5]), quintic_spline(3))


def test_the_page_shows_what_the_file_of_the_runs_holds() -> None:
    module = runpy.run_path(str(BENCHMARKS / "quintic_bounds.py"))
    found = module["rows"]()
    page = (ROOT / "docs" / "explanation" / "certificates-quintic.md").read_text("utf-8")
    for line in (*module["summary"](found), *module["each"](found)):
        assert line.startswith("|---") or f"\n{line}\n" in page
    problems = runpy.run_path(str(BENCHMARKS / "quintic_instances.py"))["instances"]()
    wanted = {(method, problem.name) for method in module["METHODS"] for problem in problems}
    assert sorted((row["method"], row["problem"]) for row in found) == sorted(wanted)
    (limit,) = {row["limit_s"] for row in found}
    assert f"--seconds {limit}" in page
    gaps = {(row["method"], row["problem"]): module["gap"](row) for row in found}
    reached_all = [x for (method, _), x in gaps.items() if method == "certificate"]
    assert max(reached_all) <= 0.01  # "reached what was asked for on every problem"
    for (_, name), reached in gaps.items():
        assert reached >= gaps["certificate", name]  # "the smallest gap"


def test_no_bound_of_the_file_exceeds_a_certified_upper_bound() -> None:
    found = runpy.run_path(str(BENCHMARKS / "quintic_bounds.py"))["rows"]()
    proved = {row["problem"]: row for row in found if row["method"] == "certificate"}
    for row in found:
        certified = proved[row["problem"]]
        assert 0.0 <= float(row["lower"]) <= float(certified["upper"])
        assert float(row["upper"]) >= float(certified["lower"])
        assert float(row["upper"]) == pytest.approx(float(certified["upper"]), abs=2e-6)


def lifted(relaxation: Any, problem: Problem, h: np.ndarray) -> np.ndarray:
    """Columns of the linear program on scipy's spline."""
    times = np.concatenate([[0.0], np.cumsum(h)])
    rest = [(1, 0.0), (2, 0.0)]
    out = [h**power for power in range(1, 5)]
    nodal, scaled = [], []
    for j in relaxation.joints:
        spline = make_interp_spline(times, problem.waypoints[:, j], k=5, bc_type=(rest, rest))
        values = np.array([spline(times[1:-1], order) for order in range(1, 5)])
        nodal.append(values.T.reshape(-1))
        v, a = spline(times, 1), spline(times, 2)
        v[[0, -1]] = a[[0, -1]] = 0.0
        ends = np.stack([h * v[:-1], h * v[1:], h**2 * a[:-1], h**2 * a[1:]], axis=1)
        scaled.append(ends.reshape(-1))
    return np.concatenate([*out, *nodal, *scaled])


@pytest.mark.parametrize("width", [0.02, 0.2, 0.6])
def test_feasible_splines_lie_in_every_linear_program(
    reference: dict[str, Any], width: float
) -> None:
    problem, rng = small(), np.random.default_rng(5)
    best = solve(problem).durations
    limits = np.stack([problem.limits.velocity, problem.limits.acceleration], axis=1)
    upper = 3.0 * float(best.sum())
    relaxation = reference["Relaxation"](problem, range(2), upper)
    wide = np.full((2, 2, 4), np.inf)
    for _ in range(20):
        middle = best * np.exp(rng.uniform(-width, width, 3))
        h = best * 1.001
        low, high = np.minimum(h, middle), np.maximum(h, middle * (1.0 + width))
        box = reference["shrunk"](reference["Box"](low, high, -wide, wide), upper, limits)
        matrix, right, bounds = relaxation.program(box)
        point = lifted(relaxation, problem, h)
        size = abs(matrix) @ np.abs(point) + np.abs(right)
        assert (matrix @ point <= right + 1e-9 * size).all()
        assert (bounds[:, 0] <= point + 1e-9).all()
        assert (point <= bounds[:, 1] + 1e-9).all()


@pytest.mark.slow
def test_near_the_answer_the_linear_program_says_little_more_than_the_box(
    reference: dict[str, Any],
) -> None:
    problem = runpy.run_path(str(BENCHMARKS / "quintic_instances.py"))["instances"]()[0]
    best = solve(problem, seed=0).durations
    upper = float(best.sum())
    limits = np.stack([problem.limits.velocity, problem.limits.acceleration], axis=1)
    whole = reference["Relaxation"](problem, range(6), upper)
    single = [reference["Relaxation"](problem, [j], upper) for j in range(6)]
    wide = np.full((6, 6, 4), np.inf)
    cost = np.zeros(whole.columns)
    cost[:7] = 1.0
    box = reference["shrunk"](
        reference["Box"](0.95 * best, 1.05 * best, -wide, wide), upper, limits
    )
    plain, _ = reference["least"](whole.program(box), cost)
    tight = reference["nodal_tightened"](single, box, lambda: False)
    better, _ = reference["least"](whole.program(tight), cost)
    sentence = f"{plain / upper:.3f} of the answer's, {better / upper:.3f} with"
    assert sentence in (ROOT / "docs" / "explanation" / "certificates-quintic.md").read_text(
        "utf-8"
    )
