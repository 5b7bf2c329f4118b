"""Audits of questions that fix the ratios of the durations: made-up papers, clean and too long."""

from __future__ import annotations

from dataclasses import replace
from decimal import ROUND_CEILING, Decimal
from itertools import pairwise

import numpy as np
import pytest
from scipy.interpolate import CubicSpline
from trajgap.compare import ClaimVerdict, audit
from trajgap.compare.audits import CaseAudit, Study, waterfalls
from trajgap.compare.audits.card_optimum import optimum_line
from trajgap.compare.audits.fixed_ratios import off_ratios
from trajgap.compare.audits.rules.scaling_law import velocity_factor
from trajgap.compare.documents import FREED_OPTIMUM, PUBLISHED, RATIOS_OPTIMUM, Severity
from trajgap.nlp import Evidence
from trajgap.problem import Limits, Problem, cubic_spline, parse_case

CASE = """
format = 1
id = "made-up"
title = "Made up"
source = {{ kind = "teaching" }}
robot = {{ name = "arm", joints = ["a", "b"] }}
units = {{ position = "rad", velocity = "rad/s", acceleration = "rad/s^2", time = "s" }}
interpolant = {{ family = "{family}" }}
{coupling}

[waypoints]
waypoint_rows = {points}

[limits]
velocity = [1.2, 0.9]
acceleration = 2

[durations]
ratios = {ratios}
{readings}
[[claims]]
id = "d"
quantity = "durations"
where = "Table 1"
durations = [{durations}]

[[claims]]
id = "total"
quantity = "total_time"
where = "Section 2"
of = "d"
value = "{total}"

[[claims]]
id = "kept"
quantity = "statement"
where = "Section 2"
text = "The motion keeps its limits."
checks = "within_limits"
of = ["d"]

[[claims]]
id = "best"
quantity = "statement"
where = "Section 2"
text = "The total is the shortest."
checks = "optimal"
of = ["d"]
"""
POINTS = [[0.1, 0.4], [0.6, -0.2], [1.1, 0.3], [0.7, 1.4]]
LOOSE = '[["0.100", "0.400"], ["0.600", "-0.200"], ["1.100", "0.300"], ["0.700", "1.400"]]'
READINGS = """
[[readings]]
id = "total-chosen"
why = "One factor scales all times."

[[readings]]
id = "each-chosen"
why = "The text says shortest."
[readings.durations]
ratios = "free"
"""
RATIOS = {"equal": np.ones(3), "chord": np.linalg.norm(np.diff(POINTS, axis=0), axis=1)}


def shortest(ratios: np.ndarray) -> np.ndarray:
    """The shortest durations at ratios, of a clamped spline by another library, densely sampled."""
    shares = ratios / ratios.sum()
    spline = CubicSpline(np.concatenate([[0.0], np.cumsum(shares)]), POINTS, bc_type="clamped")
    dense = np.linspace(0.0, 1.0, 100_001)
    velocity = (np.abs(spline(dense, 1)) / [1.2, 0.9]).max()
    return np.asarray(shares * max(velocity, np.sqrt((np.abs(spline(dense, 2)) / 2.0).max())))


def paper(motion: np.ndarray, ratios: str, digits: str = "0.001", **other: str) -> str:
    """A paper that prints durations, rounded up so that they keep the limits."""
    rounded = [Decimal(float(h)).quantize(Decimal(digits), ROUND_CEILING) for h in motion]
    keys = {
        "family": "cubic-spline",
        "coupling": "",
        "points": str(POINTS),
        "readings": "",
        "durations": ", ".join(f'"{h}"' for h in rounded),
        "total": str(sum(rounded)),
    }
    return CASE.format(**{**keys, "ratios": ratios, **other})


def audited(text: str) -> CaseAudit:
    return audit(parse_case(text, "paper.toml"), certify_seconds=0).cases[0]


def verdicts(one: CaseAudit) -> dict[str, ClaimVerdict]:
    return {judgement.claim: judgement.verdict for judgement in one.judgements}


@pytest.mark.parametrize("word", ["equal", "chord"])
@pytest.mark.parametrize("coupling", ["", 'coupling = "per-joint"'])
def test_the_shortest_total_at_its_ratios_is_supported(word: str, coupling: str) -> None:
    best = shortest(RATIOS[word])
    one = audited(paper(best, f'"{word}"', coupling=coupling))
    assert set(verdicts(one).values()) == {ClaimVerdict.SUPPORTED}
    assert not [f for f in one.findings if f.severity is not Severity.INFO]
    own = next(step for step in one.waterfalls[0].steps if step.name == RATIOS_OPTIMUM)
    assert own.time == pytest.approx(best.sum(), rel=1e-8)
    assert "at these ratios" in one.card.optimum
    # Without the ratios the same total is far from the optimum, and its statement is refuted.
    free = audited(paper(best, '"free"', coupling=coupling))
    assert verdicts(free)["best"] is ClaimVerdict.REFUTED


def test_ratios_are_those_of_the_longest_steps_of_any_unit() -> None:
    """Degrees scale every chord length alike."""
    text = paper(shortest(RATIOS["chord"]), '"chord"')
    degrees = text.replace('position = "rad"', 'position = "deg"').replace(
        str(POINTS), str([[float(np.rad2deg(x)) for x in row] for row in POINTS])
    )
    assert verdicts(audited(degrees))["best"] is ClaimVerdict.SUPPORTED


@pytest.mark.parametrize("ratios", ['"equal"', "[2, 2, 2]"])
def test_a_total_five_percent_longer_is_refuted(ratios: str) -> None:
    one = audited(paper(1.05 * shortest(RATIOS["equal"]), ratios))
    found = verdicts(one)
    assert found["kept"] is ClaimVerdict.SUPPORTED
    assert found["best"] is ClaimVerdict.REFUTED
    said = next(f.message for f in one.findings if f.claim == "best")
    assert "a checked motion at these ratios takes" in said
    beside = next(f for f in one.findings if f.claim == "d" and f.rule == "TG302")
    assert "certified shortest total at these ratios" in beside.message
    assert beside.evidence is Evidence.CERTIFIED


@pytest.mark.parametrize(
    ("ratios", "points"), [('"chord"', LOOSE), ('["1.00", "1.00", "1.00"]', str(POINTS))]
)
def test_ratios_that_stand_for_intervals_refute_nothing(ratios: str, points: str) -> None:
    word = "chord" if "chord" in ratios else "equal"
    one = audited(paper(1.05 * shortest(RATIOS[word]), ratios, points=points))
    assert verdicts(one)["best"] is ClaimVerdict.NOT_CHECKABLE
    beside = next(f for f in one.findings if f.claim == "d" and f.rule == "TG302")
    assert "% longer than the" in beside.message
    short = audited(paper(0.9 * shortest(RATIOS[word]), ratios, points=points))
    below = next(f for f in short.findings if f.claim == "total" and f.rule == "TG302")
    assert below.severity is Severity.INFO


def test_a_bare_total_below_accuses_nobody() -> None:
    total = 0.97 * shortest(RATIOS["equal"]).sum()
    text = paper(np.ones(3), '"equal"', total=f"{total:.3f}").replace('of = "d"\n', "")
    claims = text.split("[[claims]]")
    one = audited("[[claims]]".join([claims[0], claims[2]]))
    (below,) = [f for f in one.findings if f.rule == "TG302"]
    assert below.severity is Severity.INFO
    assert "other ratios of the durations" in below.message


def test_other_ratios_are_no_durations_of_the_question() -> None:
    one = audited(paper(1.2 * shortest(RATIOS["chord"]), '"equal"'))
    assert verdicts(one)["kept"] is ClaimVerdict.SUPPORTED
    assert verdicts(one)["best"] is ClaimVerdict.NOT_CHECKABLE
    found = [f for f in one.findings if f.rule == "TG302" and f.claim in ("d", "best")]
    assert {f.severity for f in found} == {Severity.INFO}
    assert all("this reading fixes 0.3333 : 0.3333 : 0.3333" in f.message for f in found)
    assert "durations in other ratios" in one.card.optimum
    published = one.waterfalls[0].steps[0]
    assert published.name == PUBLISHED
    assert "this reading fixes" in published.note


@pytest.mark.parametrize(
    ("durations", "ratios", "points", "off"),
    [
        ("1.1, 1.1, 1.1", '"equal"', None, False),
        ('"1.0", "1.1", "1.0"', '"equal"', None, False),
        ('"1.00", "1.10", "1.00"', '"equal"', None, True),
        ("1, 2, 3", "[2, 4, 6.0000001]", None, True),
        ("1, 2, 3", '[2, 4, "6.0"]', None, False),
        ("1, 2, 3.04", '[2, 4, "6.0"]', None, False),
        ("1, 2, 3.4", '[2, 4, "6.0"]', None, True),
        ("0.78103, 0.70711, 1.17047", '"chord"', LOOSE, False),
        ("0.78103, 0.70711, 1.18", '"chord"', LOOSE, True),
        ("0.781, 0.707, 1.170", '"chord"', None, True),
        ('"0.781", "0.707", "1.170"', '"chord"', None, False),
    ],
)
def test_digits_of_durations_and_ratios_decide_whether_they_agree(
    durations: str, ratios: str, points: str | None, off: bool
) -> None:
    text = paper(np.ones(3), ratios, durations=durations, points=points or str(POINTS))
    case = parse_case(text, "paper.toml")
    found = off_ratios(Study(case), case.claim("d"), "main", "as-printed")
    assert (found is not None) is off


def test_two_readings_stand_side_by_side() -> None:
    one = audited(paper(shortest(RATIOS["chord"]), '"chord"', readings=READINGS))
    judged = next(j for j in one.judgements if j.claim == "best")
    assert judged.readings == {
        "total-chosen": ClaimVerdict.SUPPORTED,
        "each-chosen": ClaimVerdict.REFUTED,
    }
    assert one.study.case.labels == {
        "total-chosen": "durations in the ratios of the distances",
        "each-chosen": "each duration chosen",
    }
    names = {w.reading: [step.name for step in w.steps] for w in one.waterfalls}
    assert RATIOS_OPTIMUM in names["total-chosen"]
    assert FREED_OPTIMUM in names["total-chosen"]
    assert not {RATIOS_OPTIMUM, FREED_OPTIMUM} & {*names["each-chosen"]}


def test_the_way_down_falls() -> None:
    one = audited(paper(shortest(RATIOS["equal"]), '"equal"'))
    times = [s.time for s in one.waterfalls[0].steps if isinstance(s.time, float)]
    assert len(times) >= 5
    assert all(above >= below * (1 - 1e-6) for above, below in pairwise(times))


def test_moving_ends_leave_no_total_to_compare_with() -> None:
    text = paper(shortest(RATIOS["equal"]), '"equal"').replace(
        '{ family = "cubic-spline" }', '{ family = "cubic-spline", end_derivatives = [0.1] }'
    )
    one = audited(text)
    study, found = one.study, waterfalls(one.study)
    assert verdicts(one)["best"] is ClaimVerdict.NOT_CHECKABLE
    said = optimum_line(study, found, {}, before=False)
    assert said == (
        "The shortest total at these ratios is not checkable: it is no formula of this curve."
    )
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
