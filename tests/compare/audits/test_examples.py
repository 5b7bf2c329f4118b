"""Papers, exams and tests of libraries, beside what was computed apart from this project.

Each recomputation was made from the same tables by another program, or in closed form: splines of
`scipy`, profiles of `ruckig`, the trapezoid, and sums, each to the digits given here. The files
name their sources.
"""

from functools import cache

import numpy as np
import pytest
from support.checkout import ROOT
from support.findings import verdicts
from trajgap.compare import CaseAudit, ClaimVerdict, audit
from trajgap.compare.documents import SHARED_OPTIMUM, Severity
from trajgap.problem import Case, Problem, check, load_case

WHALES, AUBO = "zhao2022-iwoa-pso", "yu2022-aubo-b-spline"
BEETLES, SEPTIC = "yang2024-dbo-353", "zou2024-hofa-b-spline"
WARNED = (WHALES, AUBO, BEETLES, SEPTIC)
"""Papers in which more is found than errors."""
NOT_SUPPORTED: dict[str, dict[str, str]] = {
    WHALES: {
        "inconsistent": "before-jerk after-jerk",
        "refuted": "after",
        "not checkable": "saving",
    },
    AUBO: {
        "not checkable": "exp-2 exp-3 exp-4 exp-5 others-within-limits",
        "inconsistent": "at-rest",
    },
    BEETLES: {
        "refuted": "ends",
        "not checkable": "total total-other-weights jerk-reduction weights",
    },
    SEPTIC: {"not checkable": "total within-limits", "refuted": "time-optimal"},
    "feng2020-mopso-bspline": {
        "not checkable": "limits-kept time-bound",
        "refuted": "comprehensive",
    },
    "sun2024-segment-assembly": {"not checkable": "stage-1-shortest-time stage-2-shortest-time"},
    "ban2024-dual-s-welding": {"not checkable": "a-shorter-than-b a-shorter-than-c"},
    "he2022-closed-form-paths": {
        "inconsistent": "strictly-optimal",
        "not checkable": " ".join(
            f"{p}-case-{n}" for p in ("sinusoid", "squircle", "nurbs") for n in (1, 2, 3)
        ),
    },
    "riboli2023-iptp-16-tasks": {"inconsistent": "task-15-time"},
    "ruckig-issue-128": {"inconsistent": "reported"},
    "wang2025-mim-wafer-stage": {"not checkable": "above-optimum"},
    "robotics1-2017-07-11": {
        "not checkable": "unit-3 unit-5 unit-7 fastest-under-acceleration",
        "inconsistent": "largest-acceleration-7",
    },
    "robotics1-2020-06-05": {"inconsistent": "peak-velocity-1"},
    "robotics1-2021-01-12": {"not checkable": "cosine"},
    "robotics1-2022-09-09": {"not checkable": "from-speed"},
    "toppra-cubic-path": {"not checkable": "squared-velocities"},
}
"""Claims of each case by their verdict where it is another one; why is said in each file."""
RIGHT = """
biagiotti2008-double-s fang2020-task1 fang2020-task2 kdl-velocity-profiles
liu2025-curtain-wall-nsga3 long-term-planner-switch-times modern-robotics-joint-trajectory
pilz-atrap-profile pilz-ptp-scaled robotics1-2012-01-11 robotics1-2014-02-06 robotics1-2016-04-01
robotics1-2016-07-11 robotics1-2017-02-03 robotics1-2017-04-11 robotics1-2017-06-06
robotics1-2017-09-21 robotics1-2018-01-11 robotics1-2018-02-05 robotics1-2018-06-11
robotics1-2019-01-11 robotics1-2022-02-03 robotics1-2024-09-19 ruckig-issue-204 ruckig-tests
two-joint-arm-c4-quintic two-joint-arm-natural-cubic zhao2022-sine-jerk-otg
"""
"""Cases whose every claim is supported."""
ERRORS = {
    WHALES: [("TG101", "after")],  # the parts sum to 19.78, printed is 19.85
    BEETLES: [("TG107", "ends")],  # 3-5-3 has 14 equations, jerk at the ends makes 16
    SEPTIC: [("TG302", "time-optimal")],
    "feng2020-mopso-bspline": [("TG101", "comprehensive")],  # not the sum of its durations
}
OPTIMA = {AUBO: ("as-printed", 3.595602, 6), SEPTIC: ("deg", 7.3046, 4)}
"""Reading, optimum as it was found before, and its decimals."""

PEAKS = [
    (WHALES, [6] * 5, "velocity", "8.046 14.214 9.597 41.072 13.264 21.351"),
    (WHALES, [6] * 5, "jerk", "0.533 5.801 3.166 18.163 5.655 7.473"),
    (WHALES, [5.13, 3.93, 2.53, 2.49, 5.70], "velocity", "12.27 16.57 13.70 45.87 15.53 30.44"),
    (WHALES, [5.13, 3.93, 2.53, 2.49, 5.70], "acceleration", "3.09 7.42 5.10 23.62 7.89 18.31"),
    (WHALES, [5.13, 3.93, 2.53, 2.49, 5.70], "jerk", "1.487 9.873 2.834 32.477 9.604 18.575"),
    (BEETLES, [4] * 3, "velocity", "11.87 34.43 44.90"),
]
"""Largest values of the motions in degrees and seconds, joint by joint."""

SAID = {
    ("ban2024-dual-s-welding", "total-b"): "one of 0.2878 to 0.2979 m serves all 3 totals",
    ("biagiotti2008-double-s", "ex-3.11-phases"): "takes 1.78045 s; the algorithm's is 8.87 %",
    ("biagiotti2008-double-s", "ex-3.12-phases"): "takes 1.75422 s; the algorithm's is 52.01 %",
    ("biagiotti2008-double-s", "ex-3.9-phases"): "takes 2.71 s too",
    ("he2022-closed-form-paths", "squircle-case-1"): "is 3.19 % longer",
    ("pilz-atrap-profile", "reversal-total"): "takes 3.73205 s",
    ("pilz-ptp-scaled", "total"): "takes 4.5 s",
    ("riboli2023-iptp-16-tasks", "task-15-time"): "9.4 rad/s, the profile takes 0.964148 s",
    ("robotics1-2017-04-11", "phases"): "phases of 0.225, 0.99583, 0.675 s",
    ("ruckig-issue-128", "reached"): "brakes into them at once",
    ("ruckig-issue-128", "reported"): "takes 0.167347 s; the printed 0.230593 s is 37.79 %",
    ("ruckig-issue-204", "first-total"): "it jumps from 0.28564",
    ("ruckig-issue-204", "second-total"): "it jumps from 0.28564",
    ("wang2025-mim-wafer-stage", "total"): "takes 0.210003 s",
    ("zhao2022-sine-jerk-otg", "total"): "takes 2.61718 s",
}
"""What the report says of profiles between states, and of a total along a path."""


@cache
def example(name: str) -> Case:
    return load_case(ROOT / "docs/examples" / f"{name}.toml")


@cache
def examined(name: str) -> CaseAudit:
    return audit(example(name), certify_seconds=0, seeds=2).cases[0]


def peaks(problem: Problem, durations: list[float], quantity: str) -> list[float]:
    """In the unit of angle rad."""
    return [p.value for p in check(problem, durations).peaks if p.quantity == quantity]


SLOW = "sun2024-segment-assembly"
"""Four optima of septic and quintic B-splines; one of them stands in a quick test."""


@pytest.mark.parametrize(
    "name",
    [
        pytest.param(name, marks=[pytest.mark.slow] * (name == SLOW))
        for name in (*NOT_SUPPORTED, *RIGHT.split())
    ],
)
def test_each_claim_has_the_verdict_that_the_recomputation_supports(name: str) -> None:
    one, other = examined(name), NOT_SUPPORTED.get(name, {})
    wanted = dict.fromkeys((claim.id for claim in one.case.claims), ClaimVerdict.SUPPORTED)
    for word, claims in other.items():
        wanted |= dict.fromkeys(claims.split(), ClaimVerdict(word))
    assert verdicts(one) == wanted
    errors = {(f.rule, f.claim) for f in one.findings if f.severity is Severity.ERROR}
    assert errors == set(ERRORS.get(name, ()))
    warned = {f.claim for f in one.findings if f.severity is Severity.WARNING}
    assert name in WARNED or warned == set(other.get("inconsistent", "").split())


@pytest.mark.parametrize("name", OPTIMA)
def test_the_optimum_is_the_one_found_before(name: str) -> None:
    reading, truth, places = OPTIMA[name]
    (steps,) = (w.steps for w in examined(name).document.waterfalls if w.reading == reading)
    (best,) = (step.time for step in steps if step.name == SHARED_OPTIMUM)
    assert round(best, places) == truth


@pytest.mark.parametrize(("name", "durations", "quantity", "truth"), PEAKS)
def test_peaks_are_recomputed(name: str, durations: list[float], quantity: str, truth: str) -> None:
    problem = example(name).problem()
    found = np.abs(np.rad2deg(peaks(problem, durations, quantity)))
    places = len(truth.split()[0].split(".")[1])
    np.testing.assert_allclose(found, [*map(float, truth.split())], atol=0.51 * 10.0**-places)


def test_the_jerk_of_joint_4_is_above_its_limit_as_printed() -> None:
    """133.0 °/s³. Its way is the longest, so rounding of the points to 0.01 rad matters least.

    Some motion within the rounding of all keeps every limit, so the claim is supported.
    """
    case = example(AUBO)
    durations = case.claim_durations(case.claim("exp-1")).value
    jerks = np.abs(np.rad2deg(peaks(case.problem(), durations, "jerk")))
    assert jerks[3] == pytest.approx(133.0, rel=0.01)
    assert jerks[3] > 120


def test_the_velocity_limit_of_yang_2024_is_in_radians() -> None:
    """Joint 4 turns by 140.4 degrees in a segment: 56.16 s at 2.5 °/s, at 2.5 rad/s within 4 s."""
    case = example(BEETLES)
    way = np.rad2deg(np.abs(np.diff(case.problem().waypoints, axis=0)).max())
    assert (round(way, 1), round(way / 2.5, 2)) == (140.4, 56.16)
    (shown,) = (w for w in examined(BEETLES).document.waterfalls if w.reading == "deg")
    (missing,) = (step.time for step in shown.steps if step.name == SHARED_OPTIMUM)
    assert "joint 4 needs at least 56.16 s" in str(missing)
    # Durations estimated from kinks of a figure, whose axis shows 0.55, 1.85 and 2.35 rad/s.
    estimated = np.abs(peaks(case.problem(), [1.65, 1.45, 3.41], "velocity"))
    np.testing.assert_allclose(estimated, [0.56, 1.91, 2.43], atol=0.0051)


def test_equal_segments_of_zou_2024_are_far_from_the_limits_at_39_60_s() -> None:
    """At most 8, 7.4 and 3.7 % of the limits; scaled until one is reached, 13.15 s."""
    problem = example(SEPTIC).problem()
    found = check(problem, [39.60 / 7] * 7)
    for quantity, share in (("velocity", 0.08), ("acceleration", 0.074), ("jerk", 0.037)):
        largest = max(p.ratio for p in found.peaks if p.quantity == quantity)
        assert largest == pytest.approx(share, abs=0.0011)
    assert found.tight_time == pytest.approx(13.15, abs=0.0051)


def test_a_multi_objective_total_lies_above_the_shortest_known() -> None:
    """27.744 s is a compromise: the shortest known time stands beside it as information."""
    path = ROOT / "docs/examples" / f"{SLOW}.toml"
    one = audit(path, seeds=2, certify_seconds=0, problem="stage-2", reading="degree-7").cases[0]
    (beside,) = (f for f in one.findings if f.rule == "TG302")
    assert (beside.claim, beside.printed) == ("stage-2-shortest-time", "27.744 s")
    assert float(str(beside.computed).split()[0]) == pytest.approx(21.9238, rel=1e-4)
    assert verdicts(one)["stage-2-shortest-time"] == ClaimVerdict.NOT_CHECKABLE
    assert one.errors == 0


@pytest.mark.parametrize(("name", "claim"), SAID)
def test_what_is_said_of_a_profile(name: str, claim: str) -> None:
    beside = [f for f in examined(name).findings if f.rule in ("TG304", "TG305")]
    (found,) = (f for f in beside if f.claim == claim)
    assert SAID[name, claim] in found.message


def test_a_card_is_about_profiles_where_the_curve_only_stands_in() -> None:
    """No motion within the limits starts above them, and no claim is about one that does."""
    optimum = examined("ruckig-issue-128").document.card.optimum
    assert optimum == "1 of 2 printed times is that of the shortest s-curve profile."
