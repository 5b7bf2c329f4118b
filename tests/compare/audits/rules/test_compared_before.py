"""TG405: a committed study beside the claim that compares; it informs and decides nothing."""

from __future__ import annotations

import pytest
from support.checkout import ROOT
from support.studies import hurried
from support.suite import benchmark
from trajgap.compare.audits import comparisons
from trajgap.compare.audits.comparisons import (
    Ablated,
    Comparison,
    Designed,
    Listed,
    PairShown,
    all_comparisons,
)
from trajgap.compare.audits.rules.compared_before import cite_comparisons, comparison_words
from trajgap.compare.audits.study import Study
from trajgap.compare.documents import ClaimVerdict, Severity
from trajgap.problem import load_case

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


def test_a_study_is_cited_with_every_number_and_decides_nothing(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    made_up = comparisons._Results(format="x", command="y", comparisons=(MADE_UP,))
    monkeypatch.setattr(comparisons, "_results", lambda: made_up)
    study = Study(hurried(PUMA), seeds=2, certify_seconds=0)
    (found,) = cite_comparisons(study)
    assert (found.rule, found.claim, found.decides) == ("TG405", "improvement", False)
    assert (found.severity, found.verdict) == (Severity.INFO, ClaimVerdict.NOT_CHECKABLE)
    assert found.computed == "shows in 25 % of the pairs"
    for said in (
        "ran both on the paper's way-points, 6,030 evaluations a run, 90 independent runs each",
        "one run of mnam-pso is at least 10.85 % shorter than one of standard-pso with probability",
        "25 % (95 % interval 20 % to 31 %) under death-penalty; 0 % (in none of the 9,000 pairs)",
        "under 1 other problem or reading 12.5 %.",
        "in 12 of 256 pairs of settings, most often with standard-pso at inertia = 0.95 and",
        "mnam-pso at inertia_max = 0.8 (87.5 %).",
        "than itself without niches 90 % (it helps), mutation 50 %.",
    ):
        assert said in found.message


def test_what_was_searched_is_called_by_words() -> None:
    """The study writes problems as ids, with what was searched of their joints."""

    def said(case: str, *problems: str) -> str:
        lists = {
            name: tuple(
                one.model_copy(update={"problem": problem})
                for problem in problems
                for one in getattr(MADE_UP, name)
            )
            for name in ("ablated", "designed")
        }
        return " ".join(comparison_words(MADE_UP.model_copy(update=lists), load_case(case)))

    apart = said(PUMA, "six-joints, each joint by itself", "six-joints")
    assert "six-joints" not in apart
    settings = "in 12 of 256 pairs of settings"
    assert f"{settings} (each joint by itself) and {settings} (all joints together)," in apart
    shares = "in which the whole algorithm is shorter than itself without niches 90 %"
    assert f"Share of pairs (each joint by itself) {shares}" in apart
    assert f"Share of pairs (all joints together) {shares}" in apart
    both = said("irb460-pso-353", "limit-80", "limit-110")
    title = "Shortest time of joint 5 under"
    assert f"{settings} ({title} 80 °/s) and {settings} ({title} 110 °/s)," in both
    assert "limit-" not in both
    alone = said(PUMA, "six-joints, each joint by itself")
    assert f"{settings}, most often" in alone
    assert f"Share of pairs {shares}" in alone


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
            assert shown.lowest is not None
            assert shown.highest is not None
            assert shown.lowest <= shown.share <= shown.highest
    for spread in one.designed:
        assert spread.typical <= spread.pairs <= spread.settings[0] * spread.settings[1]


def test_the_page_holds_the_committed_numbers() -> None:
    page = (ROOT / "docs" / "measurements" / "comparisons.md").read_text("utf-8")
    assert benchmark("comparison_results")["filled"](page, all_comparisons()) == page
