"""Papers read later: what was recomputed from their numbers before, beside what is computed here.

Each recomputation was made from the same tables by another program; numbers stand as it gave them.
"""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from support.checkout import ROOT
from support.findings import verdicts
from trajgap.compare import CaseAudit, audit
from trajgap.compare.documents import SHARED_OPTIMUM, Severity
from trajgap.problem import Case, Problem, check, load_case

WHALES, AUBO = "zhao2022-iwoa-pso", "yu2022-aubo-b-spline"
BEETLES, SEPTIC = "yang2024-dbo-353", "zou2024-hofa-b-spline"

VERDICTS = {
    WHALES: "before=supported before-velocity=supported before-jerk=inconsistent after=refuted "
    "after-jerk=inconsistent within-limits=supported saving=not_checkable",
    AUBO: "exp-1=supported exp-2=not_checkable exp-3=not_checkable exp-4=not_checkable "
    "exp-5=not_checkable within-limits=supported others-within-limits=not_checkable "
    "at-rest=inconsistent",
    BEETLES: "before=supported saving=supported ends=refuted total=not_checkable "
    "total-other-weights=not_checkable jerk-reduction=not_checkable weights=not_checkable",
    SEPTIC: "total=not_checkable within-limits=not_checkable time-optimal=refuted",
}
ERRORS = {
    WHALES: [("TG101", "after")],  # the parts sum to 19.78, printed is 19.85
    AUBO: [],
    BEETLES: [("TG107", "ends")],  # 3-5-3 has 14 equations, jerk at the ends makes 16
    SEPTIC: [("TG302", "time-optimal")],
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


@cache
def example(name: str) -> Case:
    return load_case(ROOT / "docs" / "examples" / f"{name}.toml")


@cache
def examined(name: str) -> CaseAudit:
    return audit(example(name), certify_seconds=0, seeds=2).cases[0]


def peaks(problem: Problem, durations: list[float], quantity: str) -> list[float]:
    """In the unit of angle rad."""
    return [p.value for p in check(problem, durations).peaks if p.quantity == quantity]


@pytest.mark.parametrize("name", VERDICTS)
def test_each_claim_has_the_verdict_that_the_recomputation_supports(name: str) -> None:
    one = examined(name)
    said = (pair.split("=") for pair in VERDICTS[name].split())
    assert verdicts(one) == {claim: word.replace("_", " ") for claim, word in said}
    found = {(f.rule, f.claim) for f in one.findings if f.severity == Severity.ERROR}
    assert found == set(ERRORS[name])


@pytest.mark.parametrize("name", OPTIMA)
def test_the_optimum_is_the_one_found_before(name: str) -> None:
    reading, truth, places = OPTIMA[name]
    (steps,) = (w.steps for w in examined(name).document.waterfalls if w.reading == reading)
    (best,) = (step.time for step in steps if step.name == SHARED_OPTIMUM)
    assert round(best, places) == truth


@pytest.mark.parametrize(("name", "durations", "quantity", "truth"), PEAKS)
def test_peaks_are_those_recomputed(
    name: str, durations: list[float], quantity: str, truth: str
) -> None:
    problem = example(name).problem()
    found = np.abs(np.rad2deg(peaks(problem, durations, quantity)))
    places = len(truth.split()[0].split(".")[1])
    np.testing.assert_allclose(found, [*map(float, truth.split())], atol=0.51 * 10.0**-places)


def test_five_jerks_printed_after_are_those_before() -> None:
    """0.533 to 5.655 of Zhao et al.; the sixth is printed 7.388 and was 7.473."""
    printed = [float(str(x)) for x in example(WHALES).claim("after-jerk").values]
    before = np.rad2deg(peaks(example(WHALES).problem(), [6] * 5, "jerk"))
    np.testing.assert_allclose(printed[:5], np.abs(before)[:5], atol=0.00051)
    assert abs(printed[5] - abs(before[5])) > 0.05


def test_the_jerk_of_joint_4_is_above_its_limit_as_printed() -> None:
    """133.0 °/s³. Its way is the longest, so that rounding of the points to 0.01 rad matters least.

    Some motion within the rounding of all keeps every limit, so that the claim is supported.
    """
    case = example(AUBO)
    durations = case.claim_durations(case.claim("exp-1")).value
    jerks = np.abs(np.rad2deg(peaks(case.problem(), durations, "jerk")))
    assert jerks[3] == pytest.approx(133.0, rel=0.01)
    assert jerks[3] > 120


def test_the_velocity_limit_of_yang_2024_is_in_radians() -> None:
    """Joint 3 turns by 118.8 degrees in a segment: 47.5 s at 2.5 °/s, at 2.5 rad/s within 4 s."""
    case = example(BEETLES)
    way = np.rad2deg(np.abs(np.diff(case.problem().waypoints[:, 1])).max())
    assert (round(way, 1), round(way / 2.5, 1)) == (118.8, 47.5)
    (shown,) = (w for w in examined(BEETLES).document.waterfalls if w.reading == "deg")
    (missing,) = (step.time for step in shown.steps if step.name == SHARED_OPTIMUM)
    assert "needs at least 18.6 s" in str(missing)
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
