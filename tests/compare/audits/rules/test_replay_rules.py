"""What replays and committed studies say: probabilities with their intervals, never a vote."""

import numpy as np
import pytest
from scipy.stats import qmc
from support.benchmarks import benchmark
from support.checkout import ROOT
from support.findings import study_of
from support.made_up import algorithms, paper, row
from support.studies import hurried
from trajgap.compare.audits.replay_settings import DESIGN, LISTED, latin_hypercube, spread_settings
from trajgap.compare.audits.rules import compared_before as comparisons
from trajgap.compare.audits.rules.compared_before import (
    Ablated,
    Comparison,
    Designed,
    Listed,
    PairShown,
    all_comparisons,
    cite_comparisons,
)
from trajgap.compare.audits.rules.replays import _typical, interval_words, judge_replays
from trajgap.compare.audits.study import Study
from trajgap.compare.documents import ClaimVerdict, Severity
from trajgap.compare.gaps import share_interval, share_of_pairs, spread
from trajgap.heuristics import GA, PSO, ImprovedGA
from trajgap.problem import load_case


def test_settings_fill_the_range_of_every_open_number() -> None:
    """A Latin hypercube: each of the equal parts of a range holds one value of it."""
    found = spread_settings(PSO(), ("particles", "c1", "c2"))
    assert next(iter(found)) == LISTED
    drawn = [one for name, one in found.items() if name != LISTED]
    assert len(drawn) == DESIGN
    parts = [int((one.inertia - 0.4) / 0.6 * DESIGN - 1e-9) for one in drawn]
    assert sorted(parts) == pytest.approx(range(DESIGN), abs=1)
    assert {one.particles for one in drawn} == {30}
    rules = {one.velocity_rule for one in drawn}
    assert rules == set(type(PSO().velocity_rule))
    assert (latin_hypercube(7) == qmc.LatinHypercube(7, rng=0).random(DESIGN)).all()


def test_the_same_settings_every_time_and_the_printed_ones_held() -> None:
    one, other = (spread_settings(GA(), ("population", "elite")) for _ in range(2))
    assert list(one) == list(other)
    assert {a.population for a in one.values()} == {40}
    assert all(isinstance(a.elite, int) and a.elite == 0 for a in one.values())
    assert all("mutation_rate = " in name for name in one if name != LISTED)


@pytest.mark.parametrize("algorithm", [GA(), ImprovedGA()], ids=lambda one: one.kind)
def test_no_setting_is_lost_because_a_population_cannot_be_paired(algorithm: object) -> None:
    found = spread_settings(algorithm, ("resolution", "k1", "k2", "k3", "k4"))  # type: ignore[arg-type]
    assert len(found) == 1 + DESIGN
    assert {one.population % 4 for one in found.values()} == {0}
    assert len({one.population for one in found.values()}) > DESIGN // 2


def test_the_interval_of_a_probability_is_that_of_independent_runs() -> None:
    """Against many fresh samples of the same size: the interval holds about 95 % of their truth."""
    generator = np.random.default_rng(3)
    truth = share_of_pairs(generator.normal(10, 1, 4000), generator.normal(9.5, 1, 4000), 0.0)
    held = 0
    for _ in range(30):
        slower, faster = generator.normal(10, 1, 40), generator.normal(9.5, 1, 40)
        low, high = share_interval(slower, faster, 0.0)
        assert low <= share_of_pairs(slower, faster, 0.0) <= high
        held += low <= truth <= high
    assert held >= 25
    assert np.isnan(share_interval(np.array([np.inf, np.inf]), np.ones(2), 0.1)).all()


def test_too_few_runs_with_an_answer_have_no_interval() -> None:
    """A quarter of the samples of these two has no answer at all: no warning, and words for it."""
    low, high = share_interval(np.array([1.0, np.inf]), np.array([0.9, 0.95]), 0.08)
    assert np.isnan([low, high]).all()
    assert interval_words(low, high) == "too few runs with an answer for an interval"
    assert interval_words(0.25, 0.5) == "95 % interval 25 % to 50 %"


def test_replays_inform_and_judge_nothing() -> None:
    case = hurried("puma560-mnam-pso-353")
    study = Study(case, seeds=2, certify_seconds=0)
    found = [f for f in judge_replays(study) if f.rule.startswith("TG40")]
    assert {f.rule for f in found} == {"TG401", "TG402", "TG403"}
    for f in found:
        assert (f.severity, f.verdict) == (Severity.INFO, ClaimVerdict.NOT_CHECKABLE)
        assert not f.decides
        assert "reproduced" not in f.message
    (improvement,) = [f for f in found if f.rule == "TG401"]
    assert "95 % interval" in improvement.message or "in none of the 4 pairs" in improvement.message
    assert "2 independent runs each" in improvement.message
    (convergence,) = [f for f in found if f.rule == "TG403"]
    assert "within 0.1 %" in convergence.message
    assert "within 0.5 %" in convergence.message


def test_an_algorithm_without_replays_has_the_reason_beside_totals_of_all_joints_alone() -> None:
    rows = row("all", "1.9", algorithm="a") + row("one", "1.9", joint="1", algorithm="a")
    study = study_of(paper([[0, 1], [0, 2]], algorithms("a"), rows, velocity=2))
    (found,) = judge_replays(study)
    assert (found.claim, found.kind, found.decides) == ("all", "not replayed", False)


def test_a_total_beside_spread_settings_names_the_nearest() -> None:
    spreads = {
        LISTED: spread(np.array([3.36, 3.37])),
        "inertia = 0.884": spread(np.array([3.50, 3.53])),
        "inertia = 0.952": spread(np.array([3.80, 3.97])),
        "inertia = 0.999": spread(np.array([np.inf, np.inf])),
    }
    said = " ".join(_typical(spreads, 3.5275, 3.5285))
    assert "(3 settings), medians are 3.3650 to 3.8850 s" in said
    assert "nearest to the printed total is 3.5150 s, with inertia = 0.884." in said
    assert "every one of these settings" not in said
    for low, end in (
        (4.0, "every one of these settings is shorter."),
        (3.0, "every one of these settings is longer."),
        (3.4, "all runs are shorter or all are longer than the printed total."),
    ):
        assert " ".join(_typical(spreads, low, low + 0.001)).endswith(end)
    assert not [*_typical({LISTED: spreads[LISTED]}, 3.5, 3.6)]


PUMA = "puma560-mnam-pso-353"
DEATH = "death-penalty"
WHERE = {"problem": "six-joints", "reading": "durations-at-least-0.3"}


def pair(share: float, low: float, high: float, shorter: float) -> PairShown:
    return PairShown(
        runs=(100, 90), medians=(3.4, 3.3), share=share, lowest=low, highest=high, shorter=shorter
    )


MADE_UP = Comparison(
    case=PUMA,
    claim="improvement",
    standard="standard-pso",
    improved="mnam-pso",
    budget=6030,
    advantage=0.1085,
    printed="10.9 %",
    on="the paper's way-points",
    listed=(
        Listed(**WHERE, handling=DEATH, shown=pair(0.25, 0.2, 0.31, 0.6)),
        Listed(**WHERE, handling="stretch", shown=pair(0.0, 0.0, 0.0, 0.5)),
        Listed(
            problem="six-joints", reading="durations-positive", handling=DEATH,
            shown=pair(0.125, 0.1, 0.2, 0.5),
        ),
    ),
    ablated=(
        Ablated(**WHERE, handling=DEATH, without=("niches",), shown=pair(0.9, 0.8, 1.0, 0.9)),
        Ablated(**WHERE, handling=DEATH, without=("mutation",), shown=pair(0.5, 0.4, 0.6, 0.5)),
        Ablated(
            **WHERE, handling=DEATH, without=("niches", "mutation"),
            shown=pair(0.1, 0.05, 0.2, 0.1),
        ),
    ),
    designed=(
        Designed(
            **WHERE, handling=DEATH, settings=(16, 16), seeds=10, pairs=256, typical=12,
            shorter=100, most=0.875, at=("inertia = 0.95", "inertia_max = 0.8"),
        ),
    ),
)  # fmt: skip


def test_a_study_is_cited_in_numbers_and_decides_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    made_up = comparisons._Results(format="x", command="y", comparisons=(MADE_UP,))
    monkeypatch.setattr(comparisons, "_results", lambda: made_up)
    study = Study(hurried(PUMA), seeds=2, certify_seconds=0)
    (found,) = cite_comparisons(study)
    assert (found.rule, found.claim, found.decides) == ("TG405", "improvement", False)
    assert (found.severity, found.verdict) == (Severity.INFO, ClaimVerdict.NOT_CHECKABLE)
    assert found.computed == "holds in 25 % of the pairs"
    own, other = study.called("mnam-pso"), study.called("standard-pso")
    for said in (
        "ran both on the paper's way-points, with 6,030 evaluations per run and 90 independent "
        "runs each",
        f"one run of {own} is at least 10.85 % shorter than one of {other} with probability",
        "25 % (95 % interval 20 % to 31 %) under death-penalty; 0 % (in none of the 9,000 pairs)",
        "under 1 other problem or reading 12.5 %.",
        f"for 12 of 256 pairs of settings, most often with {other} at inertia = 0.95 and",
        f"{own} at inertia_max = 0.8 (87.5 %).",
        "than without one improvement: niches 90 % (it helps), mutation 50 %.",
    ):
        assert said in found.message


@pytest.mark.parametrize("one", all_comparisons(), ids=lambda one: one.case)
def test_committed_results_are_about_claims_and_algorithms_that_exist(one: Comparison) -> None:
    case = load_case(one.case)
    claim = case.claim(one.claim)
    assert {one.standard, one.improved} <= {algorithm.id for algorithm in case.algorithms}
    percent = getattr(claim, "percent", None)
    assert one.advantage == (0.0 if percent is None else float(percent.lower) / 100)
    first = one.listed[0]
    assert first.handling == "death-penalty"
    assert min(first.shown.runs) >= 100  # the central comparison, at the paper's budget
    for cell in (*one.listed, *one.ablated):
        shown = cell.shown
        if shown.share is not None:
            assert shown.lowest <= shown.share <= shown.highest
    for tried in one.designed:
        assert tried.typical <= tried.pairs <= tried.settings[0] * tried.settings[1]


def test_the_page_holds_the_committed_numbers() -> None:
    page = (ROOT / "docs/measurements/comparisons.md").read_text("utf-8")
    assert benchmark("comparison_results")["filled"](page, all_comparisons()) == page
