"""Benchmarks of the solver: the rates of its errors, and twenty C4 quintic problems."""

from __future__ import annotations

import sys
from collections import Counter
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest
from scipy.stats import binomtest
from support.benchmarks import loaded
from support.checkout import ROOT
from trajgap.nlp import Status, random_starts
from trajgap.nlp.optimum import solve
from trajgap.nlp.optimum.starts import equal_start
from trajgap.problem import (
    Problem,
    Verdict,
    evaluate,
    load_case,
    quintic_spline,
)

PRINTED = """6324: improvable, optimal, C2 cubic spline, gain 0.000935
6950: wrong none found, none found, rest-to-rest polynomials of degree 5, gain 1
6955: answer does not pass, feasible, C2 cubic spline, gain nan
1000 problems, seeds 6000 to 6999
solve 441 s, brute force 710 s
| status | optimal | 900 | 90.0000% |
| status | none found | 55 | 5.5000% |
| status | not_attained | 38 | 3.8000% |
| status | feasible | 7 | 0.7000% |
| fault | improvable | 1 | 0.1000% |
| fault | wrong none found | 1 | 0.1000% |
| fault | answer does not pass | 1 | 0.1000% |
"""


@pytest.fixture
def rates() -> ModuleType:
    return loaded("error_rates")


def test_the_page_shows_the_rows(rates: ModuleType) -> None:
    rows = rates.read_rows(rates.CSV.read_text("utf-8"))
    assert rates.csv_text(rows) == rates.CSV.read_text("utf-8")
    assert rates.merged(rows, []) == rows
    for first in {row.first_seed for row in rows}:
        block = [row for row in rows if row.first_seed == first]
        assert sum(row.answers for row in block) == block[0].problems
    for row in rows:
        seeds = [int(seed) for seed in row.failing_seeds.split()]
        assert len(seeds) == row.improvable + row.not_passing + row.wrong
        assert all(row.first_seed <= seed < row.first_seed + row.problems for seed in seeds)
    page = rates.PAGE.read_text("utf-8")
    assert rates.page_with(page, rates.tables(rows)) == page


def test_what_was_printed_becomes_rows(rates: ModuleType) -> None:
    rows = {row.status: row for row in rates.rows_printed("abc", PRINTED)}
    assert list(rows) == ["optimal", "feasible", "none found", "not_attained"]
    assert {row.problems for row in rows.values()} == {1000}
    assert {(row.code, row.first_seed) for row in rows.values()} == {("abc", 6000)}

    def cells(word: str) -> tuple[Any, ...]:
        row = rows[word]
        return row.answers, row.improvable, row.not_passing, row.wrong, row.failing_seeds

    assert cells("optimal") == (900, 1, 0, 0, "6324")
    assert cells("feasible") == (7, 0, 1, 0, "6955")
    assert cells("none found") == (55, 0, 0, 1, "6950")
    assert cells("not_attained") == (38, 0, 0, 0, "")
    assert rates.read_rows(rates.csv_text(list(rows.values()))) == list(rows.values())


def test_a_run_without_an_end_and_one_that_hides_its_seeds(rates: ModuleType) -> None:
    assert rates.rows_printed("abc", PRINTED.split("1000 problems")[0]) == []
    hidden = "\n".join(PRINTED.splitlines()[1:])
    with pytest.raises(ValueError, match="seeds 6000 to 6999: counts do not add up"):
        rates.rows_printed("abc", hidden)


def test_blocks_add_up_and_are_replaced(rates: ModuleType) -> None:
    first = rates.rows_of("a", 0, Counter(optimal=98, failed=2), [(5, "wrong failed", "failed")])
    second = rates.rows_of("b", 100, Counter(optimal=50), [(120, "improvable", "optimal")])
    rows = rates.merged(second, first)
    assert [(row.code, row.status) for row in rows] == [
        ("a", "optimal"),
        ("a", "failed"),
        ("b", "optimal"),
    ]
    shown = rates.tables(rows)
    assert "| `a` | 100 | 0 to 99 |" in shown
    assert "| `b` | 50 | 100 to 149 |" in shown
    assert "| `optimal` | 148 | 1 | 0 | 0 | 0.676% |" in shown
    assert "| `failed` | 2 | 0 | 0 | 1 | 50.000% |" in shown
    assert "| all | 150 | 1 | 0 | 1 | 1.333% |" in shown
    assert "5 (`failed`), 120 (`optimal`)" in shown
    again = rates.rows_of("c", 100, Counter(optimal=50), [])
    replaced = rates.merged(rows, again)
    assert [row.code for row in replaced] == ["a", "a", "c"]
    assert "Seeds in error: 5 (`failed`)." in rates.tables(replaced)
    with pytest.raises(ValueError, match="from seed 0 and from seed 99 overlap"):
        rates.merged(rows[:2], rates.rows_of("c", 99, Counter(optimal=50), []))


@pytest.mark.parametrize(("errors", "tried"), [(0, 7), (0, 10000), (2, 3625), (9, 10), (7, 7)])
def test_limits_are_those_of_clopper_and_pearson(
    rates: ModuleType, errors: int, tried: int
) -> None:
    exact = binomtest(errors, tried, alternative="less").proportion_ci(0.95, method="exact")
    assert rates.upper_limit(errors, tried) == pytest.approx(exact.high, rel=1e-9)


def test_a_run_enters_its_counts(
    rates: ModuleType,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    errors = loaded("solver_errors")
    to = tmp_path / "rates.csv"
    monkeypatch.setattr(errors, "brute_force", lambda *_: errors.Brute(1e-9, None))
    given = ["solver_errors.py", "--count", "2", "--seed", "3", "--verbose", "--write", str(to)]
    monkeypatch.setattr(sys, "argv", given)
    assert errors.main() == 0
    rows = rates.read_rows(to.read_text("utf-8"))
    assert sum(row.answers for row in rows) == 2
    assert {(row.first_seed, row.problems) for row in rows} == {(3, 2)}
    assert sum(row.improvable for row in rows) == sum(
        row.answers
        for row in rows
        if row.status in ("optimal", "converged", "feasible", "not_attained")
    )
    # What the run printed says the same.
    assert rates.rows_printed(rows[0].code, capsys.readouterr().out) == rows


QUINTIC = loaded("quintic_instances")
STEPS, INSTANCES = QUINTIC.STEPS, QUINTIC.instances()


def test_twenty_problems_of_seven_segments_and_six_joints() -> None:
    assert len(INSTANCES) == 20
    again = QUINTIC.instances()
    assert len({p.name for p in INSTANCES}) == 20
    _, limits, _, _ = load_case("z1-woa-bspline").statement("b-spline", "v-deg-a-deg").data()
    for k, (problem, same) in enumerate(zip(INSTANCES, again, strict=True)):
        np.testing.assert_array_equal(problem.waypoints, same.waypoints)
        assert problem.curve == quintic_spline(7)
        np.testing.assert_allclose(
            problem.limits.derivatives[:, :2], limits.derivatives[:, :2], rtol=1e-15
        )
        assert not np.isfinite(problem.limits.jerk).any()
        steps = np.abs(np.diff(problem.waypoints, axis=0))
        assert steps.shape == (7, 6)
        assert 0.9 * STEPS[k // 5] < steps.max() <= STEPS[k // 5]


def page() -> dict[str, list[str]]:
    """Rows of the page's table by the name of the problem."""
    text = (ROOT / "docs" / "reference" / "interpolants.md").read_text()
    lines = [line.strip("|").split("|") for line in text.splitlines() if line.startswith("| step")]
    return {cells[0].strip(): [cell.strip() for cell in cells[1:]] for cells in lines}


def test_the_page_lists_every_problem_and_its_totals_are_not_below_what_a_bound_allows() -> None:
    rows = page()
    assert list(rows) == [p.name for p in INSTANCES]
    near, default = [], 0
    for problem in INSTANCES:
        _, best, single, *_, last = rows[problem.name]
        mean_speed = (np.abs(np.diff(problem.waypoints, axis=0)) / problem.limits.velocity).max(1)
        assert mean_speed.sum() < float(best) < float(equal_start(problem).sum())
        hits, count = map(int, single.split(" of "))
        assert count == 20
        near.append(hits)
        default += last == "yes"
    assert np.median(near) >= 15
    assert default >= 19


def found_from(problem: Problem, count: int, seed: int) -> tuple[float, np.ndarray, int]:
    """Total of the default call, totals of single starts, and neighbours that are shorter."""
    usual = solve(problem)
    assert usual.status is Status.CONVERGED
    quantities, best, *_ = page()[problem.name]
    assert usual.total_time == pytest.approx(float(best), abs=6e-7)
    assert sorted({a.quantity for a in usual.active}) == quantities.split(", ")
    assert usual.check.verdict is Verdict.PASS
    starts = random_starts(problem, count, np.random.default_rng(seed))
    totals = np.array([solve(problem, initial=start).total_time for start in starts])
    rng = np.random.default_rng(seed)
    widths = np.geomspace(1e-4, 1.0, 6000)[:, None]
    near = usual.durations * np.exp(widths * rng.standard_normal((6000, 7)))
    repaired = near.sum(axis=1) * evaluate(problem, near).stretch
    return usual.total_time, totals, int((repaired < usual.total_time * (1 - 1e-9)).sum())


def test_single_starts_and_the_default_reach_the_same_total() -> None:
    usual, totals, shorter = found_from(INSTANCES[15], 4, 8)
    assert (totals <= usual * (1 + 1e-6)).all()
    assert usual <= totals.min() * (1 + 1e-6)
    assert shorter == 0


@pytest.mark.slow
@pytest.mark.parametrize("number", [3, 11, 19])
def test_of_20_starts_at_least_15_reach_the_best(number: int) -> None:
    usual, totals, shorter = found_from(INSTANCES[number], 20, 9)
    best = min(usual, totals.min())
    assert (totals <= best * (1 + 1e-6)).sum() >= 15
    assert usual <= best * (1 + 1e-6)
    assert shorter == 0
