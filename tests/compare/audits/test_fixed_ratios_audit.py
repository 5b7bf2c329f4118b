"""Audits of questions that fix the ratios of the durations: made-up papers, clean and too long."""

from collections.abc import Sequence
from dataclasses import replace
from decimal import ROUND_CEILING, Decimal
from typing import Any

import numpy as np
import pytest
from scipy.interpolate import CubicSpline
from support.findings import audited_text, study_of, verdicts
from support.made_up import Numbers, paper, readings, row, sentence, total
from trajgap.compare import ClaimVerdict
from trajgap.compare.audits import CaseAudit, PrintedRow, waterfalls
from trajgap.compare.audits.card_optimum import optimum_line
from trajgap.compare.audits.digit_ranges import off_ratios
from trajgap.compare.audits.rules.scaling_law import velocity_factor
from trajgap.compare.documents import FREED_OPTIMUM, PUBLISHED, RATIOS_OPTIMUM, Finding, Severity
from trajgap.nlp import Evidence
from trajgap.problem import Limits, Problem, cubic_spline

POINTS = [[0.1, 0.4], [0.6, -0.2], [1.1, 0.3], [0.7, 1.4]]
LOOSE = ["0.100 0.600 1.100 0.700", "0.400 -0.200 0.300 1.400"]
EXACT = [list(column) for column in zip(*POINTS, strict=True)]
BOTH = readings(total={}, each={"durations": {"ratios": "free"}})
RATIOS = {"equal": np.ones(3), "chord": np.linalg.norm(np.diff(POINTS, axis=0), axis=1)}


def shortest(ratios: np.ndarray) -> np.ndarray:
    """The shortest durations at ratios, of a clamped spline by another library, densely sampled."""
    shares = ratios / ratios.sum()
    spline = CubicSpline(np.concatenate([[0.0], np.cumsum(shares)]), POINTS, bc_type="clamped")
    dense = np.linspace(0.0, 1.0, 100_001)
    velocity = (np.abs(spline(dense, 1)) / [1.2, 0.9]).max()
    return np.asarray(shares * max(velocity, np.sqrt((np.abs(spline(dense, 2)) / 2.0).max())))


def rounded_up(motion: np.ndarray) -> list[str]:
    """Durations that keep the limits."""
    return [str(Decimal(float(h)).quantize(Decimal("0.001"), ROUND_CEILING)) for h in motion]


def text(
    motion: np.ndarray | Numbers,
    ratios: object,
    *more: str,
    rows: Sequence[Numbers] = EXACT,
    **keys: Any,
) -> str:
    """A paper that prints durations and calls them optimal."""
    durations = rounded_up(motion) if isinstance(motion, np.ndarray) else motion
    return paper(
        rows,
        *more,
        row("d", durations),
        sentence("kept", "within_limits", "d"),
        sentence("best", "optimal", "d"),
        bounds={"ratios": ratios},
        velocity=[1.2, 0.9],
        acceleration=2,
        **{"curve": {"family": "cubic-spline"}} | keys,
    )


def beside(one: CaseAudit, name: str = "d") -> Finding:
    return next(f for f in one.findings if f.claim == name and f.rule == "TG302")


@pytest.mark.parametrize("word", ["equal", "chord"])
@pytest.mark.parametrize("coupling", ["shared", "per-joint"])
def test_the_shortest_total_at_its_ratios_is_supported(word: str, coupling: str) -> None:
    best = shortest(RATIOS[word])
    total_ = total("total", str(sum(map(Decimal, rounded_up(best)))), of="d")
    one = audited_text(text(best, word, total_, head={"coupling": coupling}))
    assert set(verdicts(one).values()) == {ClaimVerdict.SUPPORTED}
    assert not [f for f in one.findings if f.severity is not Severity.INFO]
    own = next(step for step in one.waterfalls[0].steps if step.name == RATIOS_OPTIMUM)
    assert own.time == pytest.approx(best.sum(), rel=1e-8)
    assert "at these ratios" in one.card.optimum
    # Without the ratios the same total is far from the optimum, and its statement is refuted.
    free = audited_text(text(best, "free", head={"coupling": coupling}))
    assert verdicts(free)["best"] is ClaimVerdict.REFUTED


def test_ratios_are_those_of_the_longest_steps_of_any_unit() -> None:
    """Degrees scale every chord length alike."""
    degrees = {"angle": "deg", "units": {"velocity": "rad/s", "acceleration": "rad/s^2"}}
    rows = np.rad2deg(EXACT).tolist()
    one = audited_text(text(shortest(RATIOS["chord"]), "chord", rows=rows, **degrees))
    assert verdicts(one)["best"] is ClaimVerdict.SUPPORTED


@pytest.mark.parametrize("ratios", ["equal", [2, 2, 2]])
def test_a_total_five_percent_longer_is_refuted(ratios: object) -> None:
    one = audited_text(text(1.05 * shortest(RATIOS["equal"]), ratios))
    assert verdicts(one)["kept"] is ClaimVerdict.SUPPORTED
    assert verdicts(one)["best"] is ClaimVerdict.REFUTED
    said = next(f.message for f in one.findings if f.claim == "best")
    assert "a checked motion at these ratios takes" in said
    assert "certified shortest total at these ratios" in beside(one).message
    assert beside(one).evidence is Evidence.CERTIFIED


@pytest.mark.parametrize(("ratios", "rows"), [("chord", LOOSE), (["1.00"] * 3, EXACT)])
def test_ratios_that_are_intervals_refute_nothing(ratios: object, rows: Sequence[Numbers]) -> None:
    best = shortest(RATIOS["chord" if ratios == "chord" else "equal"])
    one = audited_text(text(1.05 * best, ratios, rows=rows))
    assert verdicts(one)["best"] is ClaimVerdict.NOT_CHECKABLE
    assert "% longer than the" in beside(one).message
    short = 0.9 * best
    total_ = total("total", f"{short.sum():.3f}", of="d")
    below = audited_text(text(short, ratios, total_, rows=rows))
    assert beside(below, "total").severity is Severity.INFO


def test_a_bare_total_below_accuses_nobody() -> None:
    value = f"{0.97 * shortest(RATIOS['equal']).sum():.3f}"
    limits = {"velocity": [1.2, 0.9], "acceleration": 2}
    curve = {"family": "cubic-spline"}
    bare = paper(EXACT, total("t", value), curve=curve, bounds={"ratios": "equal"}, **limits)
    (below,) = [f for f in audited_text(bare).findings if f.rule == "TG302"]
    assert below.severity is Severity.INFO
    assert "other ratios of the durations" in below.message


def test_other_ratios_are_no_durations_of_the_question() -> None:
    one = audited_text(text(1.2 * shortest(RATIOS["chord"]), "equal"))
    assert verdicts(one)["kept"] is ClaimVerdict.SUPPORTED
    assert verdicts(one)["best"] is ClaimVerdict.NOT_CHECKABLE
    found = [f for f in one.findings if f.rule == "TG302" and f.claim in ("d", "best")]
    assert {f.severity for f in found} == {Severity.INFO}
    assert all("this reading fixes 0.3333 : 0.3333 : 0.3333" in f.message for f in found)
    assert "durations in ratios other" in one.card.optimum
    published = one.waterfalls[0].steps[0]
    assert published.name == PUBLISHED
    assert "this reading fixes" in published.note


@pytest.mark.parametrize(
    ("durations", "ratios", "rows", "off"),
    [
        ([1.1, 1.1, 1.1], "equal", EXACT, False),
        ("1.0 1.1 1.0", "equal", EXACT, False),
        ("1.00 1.10 1.00", "equal", EXACT, True),
        ([1, 2, 3], [2, 4, 6.0000001], EXACT, True),
        ([1, 2, 3], [2, 4, "6.0"], EXACT, False),
        ([1, 2, 3.04], [2, 4, "6.0"], EXACT, False),
        ([1, 2, 3.4], [2, 4, "6.0"], EXACT, True),
        ([0.78103, 0.70711, 1.17047], "chord", LOOSE, False),
        ([0.78103, 0.70711, 1.18], "chord", LOOSE, True),
        ([0.781, 0.707, 1.170], "chord", EXACT, True),
        ("0.781 0.707 1.170", "chord", EXACT, False),
    ],
)
def test_digits_of_durations_and_ratios_decide_whether_they_agree(
    durations: Numbers, ratios: object, rows: Sequence[Numbers], off: bool
) -> None:
    study = study_of(text(durations, ratios, rows=rows))
    row = PrintedRow(study, study.case.claim("d"), study.pairs[0])
    assert (off_ratios(row) is not None) is off


def test_two_readings_stand_side_by_side() -> None:
    one = audited_text(text(shortest(RATIOS["chord"]), "chord", BOTH))
    judged = next(j for j in one.judgements if j.claim == "best")
    assert judged.readings == {"total": ClaimVerdict.SUPPORTED, "each": ClaimVerdict.REFUTED}
    assert one.study.case.labels == {
        "total": "durations in the ratios of the distances",
        "each": "each duration chosen",
    }
    names = {w.reading: {step.name for step in w.steps} for w in one.waterfalls}
    assert {RATIOS_OPTIMUM, FREED_OPTIMUM} <= names["total"]
    assert not {RATIOS_OPTIMUM, FREED_OPTIMUM} & names["each"]


def test_moving_ends_leave_no_total_to_compare_with() -> None:
    moving = {"family": "cubic-spline", "end_derivatives": [0.1]}
    one = audited_text(text(shortest(RATIOS["equal"]), "equal", curve=moving))
    found = waterfalls(one.study)
    assert verdicts(one)["best"] is ClaimVerdict.NOT_CHECKABLE
    said = optimum_line(one.study, found, {}, before=False)
    assert said.startswith("The shortest total at these ratios cannot be checked")
    own = next(step for step in found[0].steps if step.name == RATIOS_OPTIMUM)
    assert "prescribes derivatives other than 0" in own.note


def test_the_law_of_velocity_limits_is_for_the_same_ratios() -> None:
    """T·V is a constant of one question: of two with other ratios it says nothing."""
    one = Problem(POINTS, Limits(1.0), cubic_spline(3), ratios="chord")
    quick = replace(one, limits=Limits(2.0, joints=2))
    assert velocity_factor(one, quick) == 0.5
    assert velocity_factor(one, replace(quick, ratios=10 * one.ratios)) == 0.5
    assert velocity_factor(one, replace(quick, ratios="equal")) is None
    assert velocity_factor(one, replace(quick, ratios=None)) is None
    assert velocity_factor(replace(one, ratios=None), replace(quick, ratios=None)) == 0.5
