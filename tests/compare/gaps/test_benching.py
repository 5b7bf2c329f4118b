"""Benches: numbers by hand and in print, a closed-form optimum, and every fault a row."""

import csv
import io
import itertools
import json
from dataclasses import replace
from pathlib import Path
from statistics import median

import numpy as np
import pytest
from scipy.stats import mannwhitneyu
from support import optimizers
from support.documents import assert_valid
from trajgap.compare.documents import BenchDocument, Why, json_text, percent
from trajgap.compare.gaps import (
    COLUMNS,
    Row,
    Runs,
    Trial,
    band,
    bench,
    failed,
    measure_gaps,
    plan_bench,
    quantiles,
    share_of_targets,
    share_within,
)
from trajgap.compare.gaps.standings import bench_result
from trajgap.compare.gaps.statistics import compare_pair, compare_pairs, corrected
from trajgap.compare.gaps.targets import (
    expected_running_time,
    hit,
    running_time_interval,
    success_interval,
)
from trajgap.compare.pages import write_bench
from trajgap.compare.pages.benches import bench_picture
from trajgap.heuristics import search_box
from trajgap.nlp import solve
from trajgap.problem import CaseError, Limits, Problem, TrajgapError, rest_to_rest

WAYPOINTS = np.array([[0.3, -1.1], [1.9, -0.7], [1.2, 0.4], [1.5, 2.6]])
LIMITS = Limits([1.7, 2.3], [2.9, 6.1])
TOY = Problem(WAYPOINTS, LIMITS, rest_to_rest(3, 5), 0.1, 3.0, name="toy")
_WAYS = np.abs(np.diff(WAYPOINTS, axis=0))
# A quintic from rest to rest peaks at 15/8 Δ/T and 10/√3 Δ/T²: Biagiotti and Melchiorri,
# "Trajectory planning for automatic machines and robots", 2008, section 2.1.7.
_PEAKS = 15 / 8 * _WAYS / [1.7, 2.3], np.sqrt(10 / np.sqrt(3) * _WAYS / [2.9, 6.1])
EXACT = np.maximum(*_PEAKS).max(axis=1)


def row(trace: list[tuple[int, float]], evaluations: int, verdict: str | None = "pass") -> Row:
    trial = Trial(TOY, "toy", "", "random", budget=1000)
    end = trace[-1][1] if trace else None
    return replace(
        Row.begun(trial), trace=tuple(trace), evaluations=evaluations, verdict=verdict,
        reported_time=end, feasible_time=end,
    )  # fmt: skip


@pytest.mark.parametrize(
    ("hits", "spent", "expected"),
    [
        ([100, np.inf, 300], [500, 500, 500], (100 + 500 + 300) / 2),
        ([10, 20, 30], [500, 500, 500], 20),
        ([np.inf, np.inf, 7], [400, 90, 500], 400 + 90 + 7),
        ([np.inf, np.inf], [400, 90], np.inf),
    ],
)
def test_expected_running_time(hits: list[float], spent: list[float], expected: float) -> None:
    assert expected_running_time(np.array(hits), np.array(spent, dtype=float)) == expected


def test_running_time_interval() -> None:
    # Every sample of equal runs is alike; with one failure in two, a quarter of samples miss.
    assert running_time_interval(np.full(9, 40.0), np.full(9, 100.0)) == (40.0, 40.0)
    low, high = running_time_interval(np.array([40.0, np.inf]), np.array([100.0, 100.0]))
    assert (low, high) == (40.0, np.inf)
    rng = np.random.default_rng(3)
    hits = rng.exponential(200, 400) + 1
    low, high = running_time_interval(hits, np.full(400, 1e4))
    # The mean of 400 exponential times: a normal interval, because there are so many.
    half = 1.96 * hits.std() / 20
    assert (low, high) == pytest.approx((hits.mean() - half, hits.mean() + half), rel=0.03)


def test_success_interval() -> None:
    # Wilson's interval in Agresti and Coull, "Approximate is better than exact", 1998, (2).
    p, n, z = 0.1, 20, 1.959964
    middle, half = p + z**2 / (2 * n), z * np.sqrt(p * (1 - p) / n + z**2 / (4 * n**2))
    expected = ((middle - half) / (1 + z**2 / n), (middle + half) / (1 + z**2 / n))
    assert success_interval(2, 20) == pytest.approx(expected, rel=1e-6)


def test_vargha_delaney() -> None:
    def a12(*totals: np.ndarray) -> float:
        return compare_pair(*totals)["vargha_delaney"]

    # By counting: 3 of (1 | 2, 3, 4), 2.5 of (2 | ...), 1.5 of (3 | ...), out of 9; and the
    # measure's own identities.
    a, b = np.array([1.0, 2.0, 3.0]), np.array([2.0, 3.0, 4.0])
    assert a12(a, b) == pytest.approx(7 / 9)
    assert a12(b, a) == pytest.approx(2 / 9)
    assert a12(a, a) == 0.5
    assert a12(a, a + 10) == 1.0
    never = np.array([np.inf, np.inf])
    assert a12(a, never) == 1.0
    assert a12(never, never) == 0.5
    # Totals closer than the checker's tolerance tie.
    assert a12(a, a * (1 + 1e-12)) == 0.5


def test_shares_of_pairs_are_counted() -> None:
    rng = np.random.default_rng(8)
    a, b = rng.integers(1, 9, 14).astype(float), rng.integers(1, 9, 11).astype(float)
    a[3] = np.inf
    wins, ties, a12, low, high = compare_pair(a, b).values()
    pairs = list(itertools.product(a, b))
    assert wins == pytest.approx(sum(x < y for x, y in pairs) / len(pairs))
    assert ties == pytest.approx(sum(x == y for x, y in pairs) / len(pairs))
    assert a12 == pytest.approx(wins + ties / 2)
    assert low < a12 < high
    sampled = ((a[rng.integers(14, size=14)], b[rng.integers(11, size=11)]) for _ in range(600))
    draws = [mannwhitneyu(y, x).statistic / 154 for x, y in sampled]
    assert (low, high) == pytest.approx(tuple(np.quantile(draws, (0.025, 0.975))), abs=0.05)


def test_holm() -> None:
    # The example of R's p.adjust(method = "holm"): sorted, times n, n − 1, ..., never falling.
    assert corrected([0.01, 0.02, 0.03, 0.04]) == pytest.approx((0.04, 0.06, 0.06, 0.06))
    assert corrected([0.04, 0.001]) == pytest.approx((0.04, 0.002))
    assert corrected([0.9, 0.8]) == (1.0, 1.0)
    assert corrected([]) == ()


def test_pairs_are_tested_as_independent_samples() -> None:
    rng = np.random.default_rng(5)
    totals = {name: rng.normal(mean, 1, 20) + 50 for name, mean in (("a", 0), ("b", 0.5), ("c", 2))}
    found = compare_pairs({**totals, "few": np.array([1.0])})
    assert [(one.first, one.second) for one in found] == [("a", "b"), ("a", "c"), ("b", "c")]
    plain = [mannwhitneyu(totals[x], totals[y]).pvalue for x, y in ("ab", "ac", "bc")]
    assert [one.p_value for one in found] == pytest.approx(corrected(plain))
    (same,) = compare_pairs({"a": np.full(6, np.inf), "b": np.full(6, np.inf)})
    assert (same.p_value, same.equal) == (1.0, 1.0)


def test_hits_targets_and_bands_of_known_traces() -> None:
    rows = [row([(1, 2.0), (10, 1.5), (100, 1.0)], 200), row([(10, 1.2)], 50), row([], 30, None)]
    assert [hit(one, 1.5) for one in rows] == [10, 10, np.inf]
    assert [hit(one, 1.1) for one in rows] == [100, np.inf, np.inf]
    assert hit(row([(1, 1.0)], 5, "violated"), 2.0) == np.inf
    steps, shares = share_of_targets(rows, 1.0, (0.5, 0.1))
    assert steps.tolist() == [10, 100]
    assert shares == pytest.approx([2 / 6, 3 / 6])
    at, gaps = band(rows, 1.0, (0.0, 0.5, 1.0))
    assert at.tolist() == [1, 10, 100, 1000]
    assert gaps[0] == pytest.approx([1.0, 0.2, 0.0, 0.0])
    even = band(rows[:2], 1.0, (0.5,))[1]
    assert even[0] == pytest.approx([np.inf, (0.5 + 0.2) / 2, (0.0 + 0.2) / 2, (0.0 + 0.2) / 2])
    assert gaps[1] == pytest.approx([np.inf, 0.5, 0.2, 0.2])
    assert gaps[2].tolist() == [np.inf] * 4
    ratios, shares = share_within(np.array([1.5, 1.0, np.inf, 1.5]), 1.0)
    assert (ratios.tolist(), shares.tolist()) == ([1.0, 1.5], [0.25, 0.75])


@pytest.mark.parametrize(
    ("values", "expected"),
    [
        ([np.inf, 1.0, 4.0, 2.0], (1.0, 1.5, 3.0, np.inf)),
        ([np.inf, 1.0, np.inf, 2.0], (1.0, 1.5, np.inf, np.inf)),
    ],
)
def test_quantiles_between_runs_are_means(values: list[float], expected: tuple[float, ...]) -> None:
    assert quantiles(np.array(values), (0.0, 0.25, 0.5, 0.75)).tolist() == list(expected)


def test_quantiles_of_finite_runs_are_those_of_numpy() -> None:
    levels = (0.0, 0.25, 0.5, 0.75, 1.0)
    for runs in range(1, 12):
        values = np.random.default_rng(runs).normal(2.0, 1.0, (runs, 3))
        expected = np.quantile(values, levels, axis=0, method="averaged_inverted_cdf")
        assert quantiles(values, levels) == pytest.approx(expected)


def test_a_median_without_one_of_its_two_runs_is_none() -> None:
    rows = [row([(1, 1.5)], 5), row([], 5, None)]
    found = bench_result({"half": rows}, 1.0, problem="", reading="", budget=5, seeds=2)
    (standing,) = found.standings
    assert isinstance(standing.median, Why)
    assert isinstance(standing.median_total, Why)
    assert standing.best == pytest.approx(0.5)
    assert found.verdict == "No optimiser found a feasible answer in more than half of its runs."


@pytest.mark.parametrize(
    ("gap", "shown"),
    [(0.066, "6.6 %"), (9e-7, "0.00009 %"), (-0.002, "−0.2 %"), (1e-12, "< 1e-7 %"), (0.5, "50 %"),
     (12.0, "1200 %"), (0.0, "0 %"), (-1e-12, "> −1e-7 %"), (1.01e-9, "0.0000001 %")],
)  # fmt: skip
def test_percent(gap: float, shown: str) -> None:
    assert percent(gap) == shown


@pytest.fixture(scope="module")
def runs() -> Runs:
    return bench(TOY, ["pso", optimizers.fair], seeds=6, budget=900, name="toy")


def test_gaps_against_a_closed_form(runs: Runs) -> None:
    found = measure_gaps(runs, float(EXACT.sum()))
    by = {one.optimizer: one for one in found.standings}
    assert {"pso", "support.optimizers:fair", "random", "rescale", "multistart"} <= set(by)
    # One duration for all segments is the longest of their own.
    equal = EXACT.size * EXACT.max() / EXACT.sum() - 1
    assert by["rescale"].median == pytest.approx(equal, rel=1e-6)
    assert (by["rescale"].runs, by["random"].runs) == (1, 6)
    assert by["rescale"].targets[0].reached == (equal <= 0.1)
    for one in found.standings:
        assert one.feasible == one.runs
        assert one.best >= -1e-8
        ends = np.sort([r.feasible_time for r in runs.by_label[one.optimizer]]) / EXACT.sum() - 1
        assert one.median == pytest.approx(median(ends), abs=1e-12)
        rates = [target.rate for target in one.targets]
        assert rates == sorted(rates, reverse=True)
    medians = [one.median for one in found.standings]
    assert medians == sorted(medians)
    assert found.verdict.startswith(f"Closest: {found.standings[0].optimizer} (median gap ")
    assert str(found).splitlines()[0] == found.verdict
    solved = measure_gaps(runs, solve(TOY))
    assert solved.optimum.upper == pytest.approx(EXACT.sum(), rel=1e-7)


def test_a_lower_bound_widens_the_gap(runs: Runs) -> None:
    optimum = measure_gaps(runs, float(EXACT.sum())).optimum
    wide = measure_gaps(runs, optimum.model_copy(update={"lower": optimum.upper * 0.9}))
    for one in wide.standings:
        assert 1 + one.median_highest == pytest.approx((1 + one.median) / 0.9)
    alone = measure_gaps(runs, optimum).standings[0].median_highest
    assert isinstance(alone, Why)
    with pytest.raises(TrajgapError, match="is not a positive finite time"):
        measure_gaps(runs, 0.0)


def test_rows_depend_on_nothing_else(runs: Runs) -> None:
    alone = bench(TOY, optimizers.fair, seeds=3, budget=900, name="toy", baselines=False)
    assert alone.rows == runs.by_label["support.optimizers:fair"][:3]


def test_equal_seeds_of_two_optimisers_are_independent_streams() -> None:
    plan = plan_bench(TOY, ["random", "multistart"], seeds=4, baselines=False)
    assert len({trial.stream for trial in plan.trials}) == 2
    first, second = bench(TOY, ["random", "multistart"], seeds=1, baselines=False).rows
    assert first.trace[0] != second.trace[0]


def test_bounds_and_first_positions_are_said() -> None:
    plan = plan_bench(replace(TOY, duration_upper=np.full(3, np.inf)), "pso", baselines=False)
    assert np.isinf(plan.problem.duration_upper).all()  # the question stays what it was
    assert (search_box(plan.problem).upper >= EXACT).all()
    own, bounds, drawn = plan.notes
    assert own == "pso: 200 iterations, the algorithm's own, in 6,030 evaluations."
    assert bounds.startswith("Some durations have no upper bound. Each is searched within 0.1 to ")
    assert drawn.startswith("pso: first positions drawn from 0.1 to ")
    assert plan_bench(TOY, "random", baselines=False).notes == ()


def test_what_cannot_take_part_is_refused_before_anything_runs() -> None:
    with pytest.raises(TrajgapError, match="defined at the top level of a module"):
        plan_bench(TOY, lambda fun, bounds, budget, rng: None)


def test_an_optimiser_that_always_fails_stands_last_with_its_message() -> None:
    """Every fault by itself: test_optimizers and test_trials."""
    failing = "support.optimizers:raises"
    three = [failing, "support.optimizers:exits", "random"]
    found = bench(TOY, three, seeds=2, budget=40, baselines=False)
    result = measure_gaps(found, float(EXACT.sum()))
    (exits,) = (one.message for one in found.by_label["support.optimizers:exits"][:1])
    assert "SystemExit" in exits
    raised = next(s for s in result.standings if s.optimizer == failing)
    assert (raised.failed, raised.feasible) == (2, 0)
    assert raised.messages[0].startswith("2 of 2 runs failed: ZeroDivisionError: one over")
    assert all(isinstance(target.evaluations, Why) for target in raised.targets)
    assert isinstance(raised.median, Why)
    assert failing in str(result)
    assert result.standings[0].optimizer == "random"


def test_failing_is_not_cheap() -> None:
    trial = Trial(TOY, "toy", "", "random", budget=1000)
    rows = (row([(8, float(EXACT.sum()))], 20), failed(trial, "raised"))
    found = bench_result({"half": rows}, EXACT.sum(), problem="", reading="", budget=1000, seeds=2)
    assert found.standings[0].targets[-1].evaluations == 8 + 1000


def test_the_page_the_picture_and_the_rows(runs: Runs, tmp_path: Path) -> None:
    result = measure_gaps(runs, float(EXACT.sum()))
    assert_valid(json.loads(json_text(BenchDocument(results=(result,)))), "bench")
    drawn = bench_picture(result, runs)
    assert all(f"{one.optimizer}: {one.runs} run" in drawn.description for one in result.standings)
    out = tmp_path / "out"
    write_bench([(result, runs)], out)
    page = (out / "index.html").read_text("utf-8")
    assert result.verdict in page
    for name in ("bench.json", "rows.csv", "pictures/bench-gaps-0.svg"):
        assert f'"{name}"' in page
        assert (out / name).is_file()
    table = list(csv.DictReader(io.StringIO((out / "rows.csv").read_text("utf-8"))))
    assert [one["key"] for one in table] == [one.key for one in runs.rows]
    assert float(table[0]["feasible_time"]) == runs.rows[0].feasible_time
    # The columns of a study's export, each gap set against the optimum above the table.
    assert list(table[0]) == list(COLUMNS)
    assert json.loads(table[0]["trace_totals"]) == [total for _, total in runs.rows[0].trace]
    exact = runs.rows[0].feasible_time / EXACT.sum() - 1
    assert float(table[0]["feasible_gap_lowest"]) == pytest.approx(exact, rel=1e-9)
    assert {float(one["reference_upper"]) for one in table} == {float(EXACT.sum())}
    optimum = result.optimum.model_copy(update={"lower": EXACT.sum() * 0.9})
    wide = result.model_copy(update={"optimum": optimum})
    write_bench([(wide, runs)], tmp_path / "wide")
    (first, *_) = csv.DictReader(io.StringIO((tmp_path / "wide" / "rows.csv").read_text("utf-8")))
    assert float(first["feasible_gap_lowest"]) == pytest.approx(exact, rel=1e-9)
    assert 1 + float(first["feasible_gap_highest"]) == pytest.approx((1 + exact) / 0.9)
    write_bench([(result, runs)], out)  # an earlier bench is replaced
    (out / "mine.txt").write_text("kept")
    with pytest.raises(CaseError, match=r"contains mine.txt, which is not a bench"):
        write_bench([(result, runs)], out)
    assert (out / "mine.txt").read_text() == "kept"
