"""The published comparison of three lower bounds, and the numbers of the McCormick reference."""

import numpy as np
import pytest
from support.benchmarks import benchmark
from support.checkout import ROOT
from trajgap.nlp import solve


def test_the_page_shows_what_the_file_of_the_runs_holds() -> None:
    module = benchmark("quintic_bounds")
    found = module["rows"]()
    page = (ROOT / "docs/explanation/certificates-quintic.md").read_text("utf-8")
    for line in (*module["summary"](found), *module["each"](found)):
        assert line.startswith("|---") or f"\n{line}\n" in page
    problems = benchmark("quintic_instances")["instances"]()
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
    found = benchmark("quintic_bounds")["rows"]()
    proved = {row["problem"]: row for row in found if row["method"] == "certificate"}
    for row in found:
        certified = proved[row["problem"]]
        assert 0.0 <= float(row["lower"]) <= float(certified["upper"])
        assert float(row["upper"]) >= float(certified["lower"])
        assert float(row["upper"]) == pytest.approx(float(certified["upper"]), abs=2e-6)


@pytest.mark.slow
def test_near_the_answer_the_linear_program_says_little_more_than_the_box() -> None:
    written = benchmark("quintic_mccormick")
    problem = benchmark("quintic_instances")["instances"]()[0]
    best = solve(problem, seed=0).durations
    upper = float(best.sum())
    limits = np.stack([problem.limits.velocity, problem.limits.acceleration], axis=1)
    whole = written["Relaxation"](problem, range(6), upper)
    single = [written["Relaxation"](problem, [j], upper) for j in range(6)]
    wide = np.full((6, 6, 4), np.inf)
    cost = np.zeros(whole.columns)
    cost[:7] = 1.0
    box = written["shrunk"](written["Box"](0.95 * best, 1.05 * best, -wide, wide), upper, limits)
    plain, _ = written["least"](whole.program(box), cost)
    tight = written["nodal_tightened"](single, box, lambda: False)
    better, _ = written["least"](whole.program(tight), cost)
    sentence = f"{plain / upper:.3f} of the answer's, {better / upper:.3f} with"
    assert sentence in (ROOT / "docs/explanation/certificates-quintic.md").read_text("utf-8")
