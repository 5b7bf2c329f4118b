"""Benchmarks of the solver: the rates of its errors, and twenty C4 quintic problems."""

import sys
from collections import Counter
from dataclasses import replace
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
from attacks.nasty import keeps_all
from scipy.stats import binomtest
from support.benchmarks import loaded
from support.checkout import ROOT
from trajgap.nlp import Status, random_starts
from trajgap.nlp.optimum import solve
from trajgap.nlp.optimum.starts import equal_start
from trajgap.problem import Verdict, evaluate, load_case, quintic_spline


@pytest.fixture
def rates() -> ModuleType:
    return loaded("error_rates")


def test_the_page_shows_the_rows(rates: ModuleType) -> None:
    rows = rates.read_rows(rates.CSV.read_text("utf-8"))
    assert rates.csv_text(rows) == rates.CSV.read_text("utf-8")
    assert rates.merged(rows, []) == rows
    for block in set(map(rates.block, rows)):
        assert sum(row.answers for row in rows if rates.block(row) == block) == block[2]
    for row in rows:
        seeds = [int(seed) for seed in row.failing_seeds.split()]
        assert len(seeds) == row.improvable + row.not_passing + row.wrong
        assert all(row.first_seed <= seed < row.first_seed + row.problems for seed in seeds)
    page = rates.PAGE.read_text("utf-8")
    assert rates.page_with(page, rates.tables(rows)) == page


def test_no_answer_that_is_called_optimal_was_improved(rates: ModuleType) -> None:
    rows = [r for r in rates.entered(rates.CSV) if r.kind != rates.HARD and r.status == "optimal"]
    assert {row.kind for row in rows} <= set(PROVED.KINDS)
    assert sum(row.improvable + row.not_passing + row.wrong for row in rows) == 0


def test_faults_are_counted_by_word_and_kind(rates: ModuleType) -> None:
    words = Counter({"none found": 55, "optimal": 900, "feasible": 7})
    faults = [
        (6950, "wrong none found", "none found"),
        (6955, "answer does not pass", "feasible"),
        (6324, "improvable", "optimal"),
        (6325, "wrong bound", "optimal"),
    ]
    rows = rates.rows_of("abc", rates.HARD, 6000, words, faults)
    cells = [
        (r.status, r.answers, r.improvable, r.not_passing, r.wrong, r.failing_seeds) for r in rows
    ]
    assert cells == [
        ("optimal", 900, 1, 0, 1, "6324 6325"),
        ("feasible", 7, 0, 1, 0, "6955"),
        ("none found", 55, 0, 0, 1, "6950"),
    ]
    assert {(r.code, r.kind, r.first_seed, r.problems) for r in rows} == {
        ("abc", "hard", 6000, 962)
    }
    assert rates.read_rows(rates.csv_text(rows)) == rows


def test_blocks_add_up_and_are_replaced(rates: ModuleType) -> None:
    lost = [(5, "wrong failed", "failed")]
    first = rates.rows_of("a", "hard", 0, Counter(optimal=98, failed=2), lost)
    second = rates.rows_of("b", "hard", 100, Counter(optimal=50), [(120, "improvable", "optimal")])
    rows = rates.merged(second, first)
    wanted = [("a", "optimal"), ("a", "failed"), ("b", "optimal")]
    assert [(row.code, row.status) for row in rows] == wanted
    shown = rates.tables(rows)["solver errors"]
    assert "| `a` | 100 | 0 to 99 |" in shown
    assert "| `b` | 50 | 100 to 149 |" in shown
    assert "| `optimal` | 148 | 1 | 0 | 0 | 0.676% |" in shown
    assert "| `failed` | 2 | 0 | 0 | 1 | 50.000% |" in shown
    assert "| all | 150 | 1 | 0 | 1 | 1.333% |" in shown
    assert "5 (`failed`), 120 (`optimal`)" in shown
    replaced = rates.merged(rows, rates.rows_of("c", "hard", 100, Counter(optimal=50), []))
    assert [row.code for row in replaced] == ["a", "a", "c"]
    assert "Seeds in error: 5 (`failed`)." in rates.tables(replaced)["solver errors"]
    with pytest.raises(ValueError, match="hard: the blocks from seed 0 and from seed 99 overlap"):
        rates.merged(rows[:2], rates.rows_of("c", "hard", 99, Counter(optimal=50), []))
    # Other kinds have seeds of their own.
    other = rates.rows_of("c", "cubic, boxes", 99, Counter(optimal=3, converged=1), [])
    assert rates.merged(rows, other)[-3:] == rows
    shares = rates.tables([*rows, *other])["proved shares"]
    assert "| | boxes | all |" in shares
    assert "| cubic | 75.0% of 4 | 75.0% of 4 |" in shares
    assert "| all | 75.0% of 4 | 75.0% of 4 |" in shares


@pytest.mark.parametrize(("errors", "tried"), [(0, 7), (0, 10000), (2, 3625), (9, 10), (7, 7)])
def test_limits_are_clopper_and_pearsons(rates: ModuleType, errors: int, tried: int) -> None:
    exact = binomtest(errors, tried, alternative="less").proportion_ci(0.95, method="exact")
    assert rates.upper_limit(errors, tried) == pytest.approx(exact.high, rel=1e-9)


def test_a_run_enters_its_counts_and_goes_on_where_it_ended(
    rates: ModuleType,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    errors = loaded("solver_errors")
    to = tmp_path / "rates.csv"
    monkeypatch.setattr(errors, "brute_force", lambda *_: errors.Brute(1e-9, None))
    for count, blocks in ((2, {("hard", 3, 2)}), (3, {("hard", 3, 2), ("hard", 5, 1)})):
        given = ["solver_errors.py", "--block", "2", "--count", str(count), "--seed", "3"]
        monkeypatch.setattr(sys, "argv", [*given, "--write", str(to)])
        assert errors.main() == 0
        rows = rates.entered(to)
        assert set(map(rates.block, rows)) == blocks
        assert sum(row.answers for row in rows) == count
        found = ("optimal", "converged", "feasible", "not_attained")
        faults = sum(row.answers for row in rows if row.status in found)
        assert sum(row.improvable + row.wrong for row in rows) == faults
    assert capsys.readouterr().out.count("hard, seeds 3 to 4:") == 1


PROVED = loaded("proved_problems")


@pytest.mark.parametrize("kind", PROVED.KINDS)
def test_problems_with_proofs_are_kept_by_what_they_are_made_of(kind: str) -> None:
    family, trait = kind.split(", ")
    for seed in range(8):
        problem, h = PROVED.known_problem(kind, seed)
        assert keeps_all(problem, h)
        assert problem.segments <= PROVED.MOST_SEGMENTS
        assert len(problem.joints) <= PROVED.MOST_JOINTS
        assert problem.limits.limits_position == (trait in ("positions", "all three"))
        assert np.isfinite(problem.duration_upper).any() == (trait in ("boxes", "all three"))
        assert problem.curve.homogeneous == (trait not in ("moving ends", "all three"))
        degree = {"3-5-3": 5, "4-3-4": 4, "cubic": 3, "quintic": 5, "septic": 7}
        assert max(problem.curve.degrees) == degree[family]


@pytest.mark.parametrize("kind", ["3-5-3, positions", "cubic, moving ends", "septic, all three"])
def test_answers_called_optimal_are_not_improved(kind: str) -> None:
    errors = loaded("solver_errors")
    solution, brute = errors.tried(kind, 1)
    assert solution.status is Status.OPTIMAL
    assert errors.judged(solution, brute) == ""
    assert errors.judged(solution, errors.Brute(solution.best * (1 - 3e-6), None)) == "wrong bound"
    bare = replace(solution, lower_bound=None)
    assert errors.judged(bare, errors.Brute(solution.best * (1 - 3e-6), None)) == "improvable"


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
        own, given = (one.derivatives[:, :2] for one in (problem.limits, limits))
        np.testing.assert_allclose(own, given, rtol=1e-15)
        assert not np.isfinite(problem.limits.jerk).any()
        steps = np.abs(np.diff(problem.waypoints, axis=0))
        assert steps.shape == (7, 6)
        assert 0.9 * STEPS[k // 5] < steps.max() <= STEPS[k // 5]


def page() -> dict[str, list[str]]:
    """Rows of the page's table by the name of the problem."""
    text = (ROOT / "docs/reference/interpolants.md").read_text()
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


SLOW = [pytest.param(number, 20, 15, 9, marks=pytest.mark.slow) for number in (3, 11, 19)]


@pytest.mark.parametrize(("number", "count", "hits", "seed"), [(15, 4, 4, 8), *SLOW])
def test_single_starts_reach_the_same_total(number: int, count: int, hits: int, seed: int) -> None:
    problem = INSTANCES[number]
    usual = solve(problem)
    assert usual.status is Status.CONVERGED
    quantities, best, *_ = page()[problem.name]
    assert usual.total_time == pytest.approx(float(best), abs=6e-7)
    assert sorted({a.quantity for a in usual.active}) == quantities.split(", ")
    assert usual.check.verdict is Verdict.PASS
    starts = random_starts(problem, count, np.random.default_rng(seed))
    totals = np.array([solve(problem, initial=start).total_time for start in starts])
    reached = min(usual.total_time, totals.min()) * (1 + 1e-6)
    assert (totals <= reached).sum() >= hits
    assert usual.total_time <= reached
    # No neighbour is shorter.
    rng = np.random.default_rng(seed)
    widths = np.geomspace(1e-4, 1.0, 6000)[:, None]
    near = usual.durations * np.exp(widths * rng.standard_normal((6000, 7)))
    repaired = near.sum(axis=1) * evaluate(problem, near).stretch
    assert repaired.min() >= usual.total_time * (1 - 1e-9)
