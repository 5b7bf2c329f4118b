"""Exams, a library and papers, set beside what was computed apart from this project.

The truths are those of the records that the case files were typed from: splines of `scipy`, closed
forms of the trapezoid, and sums, each to the digits given here. The files name their sources.
"""

from __future__ import annotations

import math
from functools import cache

import numpy as np
import pytest
from scipy.interpolate import CubicSpline
from support.checkout import ROOT
from support.findings import verdicts
from trajgap.compare import CaseAudit, ClaimVerdict, audit
from trajgap.compare.documents import Finding, Severity
from trajgap.nlp import solve
from trajgap.problem import load_case
from trajgap.problem.cases import ValueClaim

OPEN = {
    "feng2020-mopso-bspline": {"time-bound", "limits-kept"},
    "liu2025-curtain-wall-nsga3": set(),
    "modern-robotics-joint-trajectory": set(),
    "robotics1-2016-07-11": set(),
    "robotics1-2017-02-03": set(),
    "robotics1-2017-06-06": set(),
    "robotics1-2019-01-11": set(),
    "sun2024-segment-assembly": {"stage-1-shortest-time", "stage-2-shortest-time"},
}
"""The claims of each case that nothing can be computed for; why is said in each file."""
REFUTED = {"feng2020-mopso-bspline": {"comprehensive"}}
"""A total of 7.5786 s that is not the sum of its durations."""

PROFILES = {
    ("robotics1-2017-02-03", "joint-1-alone"): (1.7127, 2.0, 3.0, "1.52302 s"),
    ("robotics1-2017-02-03", "joint-2-alone"): (5 - math.sqrt(2), 2.5, 1.5, "3.09226 s"),
    ("robotics1-2017-02-03", "together"): (5 - math.sqrt(2), 2.5, 1.5, "3.09226 s"),
    ("robotics1-2019-01-11", "total"): (135 - 36.87, math.inf, 200.0, "1.40093 s"),
}
"""Way, limits of velocity and acceleration, and the shortest time."""
SUMS = {
    "1": 9.786, "2": 6.637, "3": 9.375, "4": 8.318, "5": 7.537, "6": 7.899, "7": 7.080, "8": 9.091,
    "9": 8.429, "10": 7.060,
}  # fmt: skip
"""Feng et al. (2020): sums of the six durations of each solution, s."""


@cache
def examined(name: str) -> CaseAudit:
    return audit(ROOT / "docs" / "examples" / f"{name}.toml", seeds=2, certify_seconds=0).cases[0]


def said(name: str, rule: str) -> dict[str | None, Finding]:
    """The findings of one rule, by their claims."""
    return {f.claim: f for f in examined(name).findings if f.rule == rule}


SLOW = "sun2024-segment-assembly"
"""Four optima of septic and quintic B-splines; one of them stands in a quick test."""


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=[pytest.mark.slow] * (name == SLOW)) for name in OPEN]
)
def test_verdicts_are_those_of_the_record(name: str) -> None:
    one = examined(name)
    wanted = dict.fromkeys((claim.id for claim in one.case.claims), ClaimVerdict.SUPPORTED)
    wanted |= dict.fromkeys(OPEN[name], ClaimVerdict.NOT_CHECKABLE)
    wanted |= dict.fromkeys(REFUTED.get(name, ()), ClaimVerdict.REFUTED)
    assert verdicts(one) == wanted
    refuted = REFUTED.get(name, set())
    assert {f.claim for f in one.findings if f.severity != Severity.INFO} == refuted


def test_the_cubic_that_ends_in_motion() -> None:
    """In 0.4652 s the velocity reaches 89.990 deg/s; at its limit the root is 0.465153 s."""
    problem = load_case(ROOT / "docs/examples/robotics1-2016-07-11.toml").problem()
    assert solve(problem).total_time == pytest.approx(0.465153, abs=5e-7)
    (peak,) = said("robotics1-2016-07-11", "TG201").values()
    assert "89.9903" in str(peak.computed)


@pytest.mark.parametrize(("name", "claim"), PROFILES)
def test_shortest_trapezoids(name: str, claim: str) -> None:
    way, fastest, acceleration, shown = PROFILES[name, claim]
    speed = min(fastest, math.sqrt(way * acceleration))
    assert float(shown.split()[0]) == pytest.approx(way / speed + speed / acceleration, abs=5e-6)
    assert said(name, "TG304")[claim].computed == shown


def test_the_spline_over_a_path_parameter() -> None:
    """What the audit computes at the knots is what `scipy` does, in time and over the parameter."""
    knots, angles = np.array([0, 0.25, 0.5, 1]), [70, -45, 10, 100]
    time = CubicSpline(knots / 0.4, angles, bc_type=((1, -184), (1, 72)))(knots / 0.4, 2)
    path = CubicSpline(knots, angles, bc_type=((1, -460), (1, 180)))(knots, 1)
    truth = {f"acceleration-{i}": x for i, x in enumerate(time, 1)}
    truth |= {f"slope-{i}": x for i, x in enumerate(path, 1) if i in (2, 3)}
    found = said("robotics1-2017-06-06", "TG211")
    assert {c: str(f.computed).split()[0] for c, f in found.items()} == {
        claim: f"{x:.6g}" for claim, x in truth.items()
    }


def test_the_library_prints_its_cubic_to_the_last_digit() -> None:
    case = examined("modern-robotics-joint-trajectory").case
    values = {c.id: c for c in case.claims if isinstance(c, ValueClaim)}
    first, last = case.problem("trajectory").waypoints
    for u in (0.2, 0.4, 0.6, 0.8):
        printed = [float(str(x)) for x in values[f"after-{4 * u:.1f}-s"].values or ()]
        truth = first + (last - first) * u * u * (3 - 2 * u)
        np.testing.assert_allclose(truth, printed, rtol=0, atol=1e-12)
    u = 0.3
    quintic = float(str(values["quintic-after-0.6-s"].value))
    assert quintic == pytest.approx(u**3 * (10 - 15 * u + 6 * u * u), abs=1e-12)


def test_ten_sums_are_their_totals_and_the_eleventh_is_not() -> None:
    found = said("feng2020-mopso-bspline", "TG101")
    middles = {
        c: np.mean([float(x) for x in str(f.computed).split()[:3:2]]) for c, f in found.items()
    }
    assert middles.pop("comprehensive") == pytest.approx(38.056)
    assert middles == pytest.approx({f"solution-{n}": total for n, total in SUMS.items()})
    assert found["comprehensive"].printed == "7.5786 s"


def test_a_multi_objective_total_lies_above_the_shortest_known() -> None:
    """27.744 s is a compromise: the shortest known time stands beside it as information."""
    path = ROOT / "docs" / "examples" / f"{SLOW}.toml"
    one = audit(path, seeds=2, certify_seconds=0, problem="stage-2", reading="degree-7").cases[0]
    (beside,) = (f for f in one.findings if f.rule == "TG302")
    assert (beside.claim, beside.printed) == ("stage-2-shortest-time", "27.744 s")
    assert float(str(beside.computed).split()[0]) == pytest.approx(21.9238, rel=1e-4)
    assert verdicts(one)["stage-2-shortest-time"] == ClaimVerdict.NOT_CHECKABLE
    assert one.errors == 0
