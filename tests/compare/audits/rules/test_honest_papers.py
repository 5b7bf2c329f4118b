"""Honest papers, made up, are accused of nothing, whether digits were rounded or cut off."""

from __future__ import annotations

import numpy as np
import pytest
from support.findings import finding, said_of, study_of
from support.made_up import algorithms, gain, paper, peak, row, sentence, total
from support.one_joint import one_joint
from support.papers.apart import apart, moving
from trajgap.compare.audits.rules.condition_count import judge_counts
from trajgap.compare.audits.rules.continuous_time import judge_motions
from trajgap.compare.audits.rules.distances import judge_distances
from trajgap.compare.audits.rules.improvements import judge_improvements
from trajgap.compare.audits.rules.other_places import judge_places
from trajgap.compare.audits.rules.peaks import judge_peaks
from trajgap.compare.audits.rules.peaks_and_limits import judge_peak_limits
from trajgap.compare.audits.rules.printed_digits import judge_digits
from trajgap.compare.audits.rules.printed_tables import judge_tables
from trajgap.compare.audits.rules.profiles import judge_profiles
from trajgap.compare.audits.rules.scaling_law import judge_scaling
from trajgap.compare.documents import ClaimVerdict, Finding, Severity

# A quintic from rest to rest over d rad in h s peaks at 15 d/(8 h) rad/s.
PEAK = 15 / 8
RULES = (
    judge_digits,
    judge_improvements,
    judge_tables,
    judge_motions,
    judge_peaks,
    judge_places,
    judge_counts,
    judge_scaling,
    judge_distances,
)


def sound(seed: int, factor: float) -> list[Finding]:
    """What the rules find on optima of way-points and limits that are printed rounded."""
    rng = np.random.default_rng(seed)
    places = int(rng.integers(0, 3))
    points = rng.uniform(-170, 170, (2, 4))
    limits = rng.uniform(40, 200, 2)
    steps = np.abs(np.diff(points, axis=1))
    times = 1000 * factor * (PEAK * steps / limits[:, None]).max(axis=0)  # ms
    peaks = (PEAK * steps / (times / 1000)).max(axis=1)

    def digits(numbers: np.ndarray) -> list[str]:
        return [f"{x:.{places}f}" for x in numbers]

    text = paper(
        [digits(each) for each in points],
        row("d", digits(times), total=f"{times.sum():.{places}f}"),
        total("abstract", f"{times.sum():.0f}", of="d"),
        row("before", "100 100 100", state="before"),
        gain("before", "d"),
        peak("peaks", "d", "velocity", digits(peaks)),
        sentence("limits", "within_limits", "d", "abstract"),
        sentence("optimal", "optimal", "d", "abstract"),
        sentence("rest", "at_rest", "d"),
        angle="deg",
        units={"time": "ms"},
        velocity=digits(limits),
    )
    study = study_of(text)
    return [f for rule in RULES for f in rule(study)]


def accused(found: list[Finding]) -> list[tuple[str, str | None, str]]:
    return [(f.rule, f.claim, f.message) for f in found if f.severity is not Severity.INFO]


def decided(found: list[Finding]) -> dict[str, ClaimVerdict | None]:
    return {f.claim: f.verdict for f in found if f.decides and f.claim is not None}


@pytest.mark.parametrize("seed", range(6))
def test_an_honest_paper_is_accused_of_nothing(seed: int) -> None:
    found = sound(seed, 1.0)
    assert accused(found) == []
    assert decided(found)["peaks"] is decided(found)["d"] is ClaimVerdict.SUPPORTED


@pytest.mark.parametrize(
    ("factor", "refuted"), [(0.9, {"d", "limits", "optimal"}), (1.1, {"optimal"})]
)
def test_the_same_paper_with_other_times_is_refuted(factor: float, refuted: set[str]) -> None:
    found = sound(1, factor)
    assert {f.claim for f in found if f.verdict is ClaimVerdict.REFUTED} == refuted


@pytest.mark.parametrize("seed", range(28))
def test_totals_that_are_kept_apart_and_profiles_from_rest_are_accused_of_nothing(
    seed: int,
) -> None:
    study = study_of(apart(seed))
    rules = (judge_digits, judge_improvements, judge_tables, judge_motions, judge_profiles)
    found = [f for rule in rules for f in rule(study)]
    assert accused(found) == []
    assert decided(found)["profile"] is decided(found)["abstract"] is ClaimVerdict.SUPPORTED


@pytest.mark.parametrize("seed", range(6))
def test_a_profile_that_starts_or_ends_at_speed_is_accused_of_nothing(seed: int) -> None:
    found = finding(moving(seed), judge_profiles, "profile", "TG304")
    assert found.verdict is ClaimVerdict.NOT_CHECKABLE


@pytest.mark.parametrize(
    ("velocity", "time", "of", "verdict"),
    [
        # A cubic over 0.8 rad in 1 s that starts and ends at v peaks at 1.2 − v/2 in the middle.
        (0.31, 1, "d", ClaimVerdict.REFUTED),
        ("0.31", 1, "d", ClaimVerdict.NOT_CHECKABLE),
        ("0.4", 1, "d", ClaimVerdict.SUPPORTED),
        ("0.3", 1, "d", ClaimVerdict.NOT_CHECKABLE),
        # At v = 0.3 the mean speed of 0.8 rad in 0.4 s exceeds 1.02 rad/s.
        (0.3, 0.4, "t", ClaimVerdict.REFUTED),
        ("0.3", 0.4, "t", ClaimVerdict.NOT_CHECKABLE),
    ],
)
def test_a_printed_derivative_at_the_ends_is_an_interval(
    velocity: str | float, time: float, of: str, verdict: ClaimVerdict
) -> None:
    ends = {"degrees": [3], "end_orders": [1], "end_derivatives": [velocity]}
    parts = row("d", [time]), total("t", time), sentence("s", "within_limits", of)
    text = paper([[0.1, 0.9]], *parts, curve={"family": "polynomials"} | ends, velocity=1.02)
    assert finding(text, judge_motions, "s", "TG201").verdict is verdict
    if verdict is ClaimVerdict.NOT_CHECKABLE and of == "d":
        said = [f.message for f in said_of(study_of(text), judge_motions, "d", "TG201")]
        assert "Derivatives at the ends are printed numbers" in " ".join(said)


@pytest.mark.parametrize(("value", "fits"), [("1.512", True), ("1.499", False)])
def test_a_peak_of_durations_whose_digits_are_cut_off_fits(value: str, fits: bool) -> None:
    """1.2399 s printed as 1.23: its peak, 1.512, is lower than what rounds to 1.23 allows."""
    assert abs(PEAK / 1.2399 - 1.5122) < 1e-4
    text = one_joint("0, 1", "9", "1.23", "within_limits", peak("top", "d", "velocity", value))
    found = finding(text, judge_peaks, "top", "TG203")
    assert found.verdict == ("supported" if fits else "inconsistent")
    assert ("as digits that are cut off" in found.message) == fits


@pytest.mark.parametrize(("time", "refuted"), [("4.9425", False), ("5.00", True)])
def test_an_optimum_between_waypoints_whose_digits_are_cut_off_is_not_too_long(
    time: str, refuted: bool
) -> None:
    """From -0.657 to 1.979 rad, printed -0.65 and 1.97: farther than what rounds to these."""
    assert abs(PEAK * (0.657 + 1.979) - 4.9425) < 1e-4 < 4.94 - PEAK * (0.655 + 1.975)
    text = one_joint('"-0.65", "1.97"', "1", time, "optimal")
    found = finding(text, judge_distances, "s", "TG302")
    assert (found.verdict is ClaimVerdict.REFUTED) == refuted


@pytest.mark.parametrize(
    ("time", "value", "refuted"), [("1.801", "1.802", False), ("1.7", "1.7", True)]
)
def test_a_duration_cut_off_beside_its_total_rounded_is_not_below_the_optimum(
    time: str, value: str, refuted: bool
) -> None:
    """1.80167 s, the proven optimum, cut off to 1.801 and rounded to 1.802: 1.8015 fits both."""
    tail = row("m", time, total=value) + sentence("best", "optimal", "m")
    text = one_joint("0, 1", repr(PEAK / 1.80167), "1.80168", "within_limits", tail)
    study = study_of(text)
    assert study.optimum("main", "as-printed").lower_bound is not None
    (found,) = said_of(study, judge_distances, "best", "TG302")
    assert (found.verdict is ClaimVerdict.REFUTED) == refuted


@pytest.mark.parametrize(("value", "longest"), [("3.913", 3.916), ("3.914", 3.915)])
def test_a_total_that_is_the_sum_of_the_printed_durations_bounds_no_more_than_they_do(
    value: str, longest: float
) -> None:
    """1.336 + 1.580 + 0.997 = 3.913; each may be cut off, and then so may their sum by 0.003."""
    study = study_of(paper([[0, 1, 2, 3]], row("m", "1.336 1.580 0.997", total=value), velocity=1))
    found = study.longest_total(study.case.claim("m"), "as-printed")
    assert found == pytest.approx(longest, abs=1e-9)


@pytest.mark.parametrize(("value", "agrees"), [("2.635", True), ("2.638", False)])
def test_a_total_of_digits_cut_off_agrees_with_the_total_of_the_whole_numbers(
    value: str, agrees: bool
) -> None:
    """0.6544 + 0.6408 + 0.5217 + 0.8184 is 2.6353; the digits that are left sum to 2.633."""
    table = row("table", "0.654 0.640 0.521 0.818", total="2.633", algorithm="new")
    head = total("head", value, of="table") + algorithms("new")
    text = one_joint("0, 1, 2, 3, 4", "9", "9", "within_limits", table + head)
    found = finding(text, judge_tables, "head", "TG105")
    assert (found.verdict is ClaimVerdict.SUPPORTED) == agrees
    assert (found.severity is Severity.ERROR) != agrees


@pytest.mark.parametrize(
    ("value", "limit", "wrong"),
    [
        ("3.665", "3.6", True),
        ("3.601", "3.6", False),
        ("3.665", '"3.6"', False),  # in quotes it may be cut off from 3.69
        ("3.75", '"3.6"', True),
        ("3.599", "3.6", False),
    ],
)
def test_a_printed_peak_above_a_printed_limit_contradicts_what_is_said_of_limits(
    value: str, limit: str, wrong: bool
) -> None:
    text = one_joint("0, 1", limit, "0.60", "within_limits", peak("p", "d", "velocity", value))
    said = said_of(study_of(text), judge_peak_limits, "s", "TG209")
    assert [f.verdict for f in said] == [ClaimVerdict.INCONSISTENT] * wrong
    assert all("is at most 3.7 rad/s" in f.message for f in said if limit == '"3.6"')
