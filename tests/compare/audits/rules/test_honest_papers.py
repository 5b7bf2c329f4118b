"""Honest papers, made up, are accused of nothing, whether digits were rounded or cut off."""

from __future__ import annotations

import numpy as np
import pytest
from support.findings import said_of, study_of
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

SOUND = """
format = 1
id = "sound"
title = "what an honest paper prints"
[source]
year = 2024
[robot]
name = "arm"
joints = ["1", "2"]
[units]
position = "deg"
velocity = "deg/s"
time = "ms"
[waypoints]
where = "Table 1"
joint_rows = {rows}
[limits]
velocity = {limits}
[interpolant]
family = "rest-to-rest"
degree = 5
[[claims]]
id = "d"
quantity = "durations"
where = "Table 2"
durations = {durations}
total = {total}
[[claims]]
id = "abstract"
quantity = "total_time"
where = "abstract"
of = "d"
value = {short}
[[claims]]
id = "before"
quantity = "durations"
where = "Table 2, before"
state = "before"
durations = ["100", "100", "100"]
[[claims]]
id = "gain"
quantity = "improvement"
where = "abstract"
slower = "before"
faster = "d"
[[claims]]
id = "peaks"
quantity = "peak"
where = "Table 3"
of = "d"
derivative = "velocity"
values = {peaks}
[[claims]]
id = "limits"
quantity = "statement"
where = "conclusion"
checks = "within_limits"
of = ["d", "abstract"]
[[claims]]
id = "optimal"
quantity = "statement"
where = "conclusion"
checks = "optimal"
of = ["d", "abstract"]
[[claims]]
id = "rest"
quantity = "statement"
where = "section 2"
checks = "at_rest"
of = ["d"]
"""


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

    def digits(numbers: np.ndarray, n: int) -> str:
        return "[" + ", ".join(f'"{x:.{n}f}"' for x in numbers) + "]"

    text = SOUND.format(
        rows="[" + ", ".join(digits(row, places) for row in points) + "]",
        limits=digits(limits, places),
        durations=digits(times, places),
        total=f'"{times.sum():.{places}f}"',
        short=f'"{times.sum():.0f}"',
        peaks=digits(peaks, places),
    )
    study = study_of(text)
    return [f for rule in RULES for f in rule(study)]


@pytest.mark.parametrize("seed", range(6))
def test_an_honest_paper_is_accused_of_nothing(seed: int) -> None:
    found = sound(seed, 1.0)
    against = [(f.rule, f.claim, f.message) for f in found if f.severity is not Severity.INFO]
    assert against == []
    words = {f.claim: f.verdict for f in found if f.decides and f.claim is not None}
    assert words["peaks"] is ClaimVerdict.SUPPORTED
    assert words["d"] is ClaimVerdict.SUPPORTED


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
    against = [(f.rule, f.claim, f.message) for f in found if f.severity is not Severity.INFO]
    assert against == []
    words = {f.claim: f.verdict for f in found if f.decides and f.claim is not None}
    assert words["profile"] is words["abstract"] is ClaimVerdict.SUPPORTED


@pytest.mark.parametrize("seed", range(6))
def test_a_profile_that_starts_or_ends_at_speed_is_accused_of_nothing(seed: int) -> None:
    (found,) = said_of(study_of(moving(seed)), judge_profiles, "profile", "TG304")
    assert found.verdict is ClaimVerdict.NOT_CHECKABLE


ENDS = """
format = 1
id = "ends"
title = "one joint that starts and ends with a velocity"
[source]
year = 2024
[robot]
name = "arm"
joints = ["1"]
[units]
position = "rad"
velocity = "rad/s"
time = "s"
[waypoints]
joint_rows = [[0.1, 0.9]]
[limits]
velocity = 1.02
[interpolant]
family = "polynomials"
degrees = [3]
end_orders = [1]
end_derivatives = [{velocity}]
[[claims]]
id = "d"
quantity = "durations"
where = "Table 2"
durations = [{time}]
[[claims]]
id = "t"
quantity = "total_time"
where = "abstract"
value = {time}
[[claims]]
id = "s"
quantity = "statement"
where = "abstract"
checks = "within_limits"
of = ["{of}"]
"""


@pytest.mark.parametrize(
    ("velocity", "time", "of", "verdict"),
    [
        # A cubic over 0.8 rad in 1 s that starts and ends at v peaks at 1.2 − v/2 in the middle.
        ("0.31", "1", "d", ClaimVerdict.REFUTED),
        ('"0.31"', "1", "d", ClaimVerdict.NOT_CHECKABLE),
        ('"0.4"', "1", "d", ClaimVerdict.SUPPORTED),
        ('"0.3"', "1", "d", ClaimVerdict.NOT_CHECKABLE),
        # At v = 0.3 the mean speed of 0.8 rad in 0.4 s exceeds 1.02 rad/s.
        ("0.3", "0.4", "t", ClaimVerdict.REFUTED),
        ('"0.3"', "0.4", "t", ClaimVerdict.NOT_CHECKABLE),
    ],
)
def test_a_printed_derivative_at_the_ends_is_an_interval(
    velocity: str, time: str, of: str, verdict: ClaimVerdict
) -> None:
    study = study_of(ENDS.format(velocity=velocity, time=time, of=of))
    (found,) = said_of(study, judge_motions, "s", "TG201")
    assert found.verdict is verdict
    if verdict is ClaimVerdict.NOT_CHECKABLE and of == "d":
        assert "Derivatives at the ends are printed numbers" in " ".join(
            f.message for f in said_of(study, judge_motions, "d", "TG201")
        )


CUT_PEAK = """
[[claims]]
id = "top"
quantity = "peak"
where = "Figure 1"
of = "d"
derivative = "velocity"
value = "{value}"
"""


@pytest.mark.parametrize(("value", "fits"), [("1.512", True), ("1.499", False)])
def test_a_peak_of_durations_whose_digits_are_cut_off_fits(value: str, fits: bool) -> None:
    """1.2399 s printed as 1.23: its peak, 1.512, is lower than what rounds to 1.23 allows."""
    assert abs(PEAK / 1.2399 - 1.5122) < 1e-4
    text = one_joint("0, 1", "9", "1.23", "within_limits", CUT_PEAK.format(value=value))
    (found,) = said_of(study_of(text), judge_peaks, "top", "TG203")
    assert found.verdict == ("supported" if fits else "inconsistent")
    assert ("as digits that are cut off" in found.message) == fits


@pytest.mark.parametrize(("time", "refuted"), [("4.9425", False), ("5.00", True)])
def test_an_optimum_between_waypoints_whose_digits_are_cut_off_is_not_too_long(
    time: str, refuted: bool
) -> None:
    """From -0.657 to 1.979 rad, printed -0.65 and 1.97: farther than what rounds to these."""
    assert abs(PEAK * (0.657 + 1.979) - 4.9425) < 1e-4 < 4.94 - PEAK * (0.655 + 1.975)
    study = study_of(one_joint('"-0.65", "1.97"', "1", time, "optimal"))
    (found,) = said_of(study, judge_distances, "s", "TG302")
    assert (found.verdict is ClaimVerdict.REFUTED) == refuted


MIXED = """
[[claims]]
id = "m"
quantity = "durations"
where = "Table 3"
durations = ["{time}"]
total = "{total}"
[[claims]]
id = "best"
quantity = "statement"
where = "Table 3"
checks = "optimal"
of = ["m"]
"""


@pytest.mark.parametrize(
    ("time", "total", "refuted"), [("1.801", "1.802", False), ("1.7", "1.7", True)]
)
def test_a_duration_cut_off_beside_its_total_rounded_is_not_below_the_optimum(
    time: str, total: str, refuted: bool
) -> None:
    """1.80167 s, the proven optimum, cut off to 1.801 and rounded to 1.802: 1.8015 fits both."""
    limit = repr(PEAK / 1.80167)
    tail = MIXED.format(time=time, total=total)
    study = study_of(one_joint("0, 1", limit, "1.80168", "within_limits", tail))
    assert study.optimum("main", "as-printed").lower_bound is not None
    (found,) = said_of(study, judge_distances, "best", "TG302")
    assert (found.verdict is ClaimVerdict.REFUTED) == refuted


@pytest.mark.parametrize(("total", "longest"), [("3.913", 3.916), ("3.914", 3.915)])
def test_a_total_that_is_the_sum_of_the_printed_durations_bounds_no_more_than_they_do(
    total: str, longest: float
) -> None:
    """1.336 + 1.580 + 0.997 = 3.913; each may be cut off, and then so may their sum by 0.003."""
    tail = MIXED.replace('["{time}"]', '["1.336", "1.580", "0.997"]').format(total=total)
    study = study_of(one_joint("0, 1, 2, 3", "1", '1.336", "1.580", "0.997', "within_limits", tail))
    (claim,) = (c for c in study.case.claims if c.id == "m")
    assert study.longest_total(claim, "as-printed") == pytest.approx(longest, abs=1e-9)


SUMMED = """
[[claims]]
id = "table"
quantity = "durations"
where = "Table 4"
algorithm = "new"
durations = ["0.654", "0.640", "0.521", "0.818"]
total = "2.633"
[[claims]]
id = "head"
quantity = "total_time"
where = "abstract"
of = "table"
value = "{value}"
[[algorithms]]
id = "new"
name = "new"
"""


@pytest.mark.parametrize(("value", "agrees"), [("2.635", True), ("2.638", False)])
def test_a_total_of_digits_cut_off_agrees_with_the_total_of_the_whole_numbers(
    value: str, agrees: bool
) -> None:
    """0.6544 + 0.6408 + 0.5217 + 0.8184 is 2.6353; the digits that are left sum to 2.633."""
    text = one_joint("0, 1, 2, 3, 4", "9", "9", "within_limits", SUMMED.format(value=value))
    (found,) = said_of(study_of(text), judge_tables, "head", "TG105")
    assert (found.verdict is ClaimVerdict.SUPPORTED) == agrees
    assert (found.severity is Severity.ERROR) != agrees


CUT_GAIN = """
[[claims]]
id = "slow"
quantity = "durations"
where = "Table 4"
state = "before"
durations = ["0.98", "0.87", "0.66"]
total = "2.51"
[[claims]]
id = "fast"
quantity = "durations"
where = "Table 5"
durations = ["0.65", "0.64", "0.52"]
total = "1.81"
[[claims]]
id = "gain"
quantity = "improvement"
where = "abstract"
slower = "slow"
faster = "fast"
base = "slower"
percent = "{percent}"
"""


@pytest.mark.parametrize(("percent", "follows"), [("27.1", True), ("25.0", False)])
def test_a_percentage_of_whole_numbers_beside_totals_of_digits_cut_off_follows(
    percent: str, follows: bool
) -> None:
    """2.5110 and 1.8315 s, whose parts are cut off and then added up: 27.06 % beside 27.89 %."""
    parts = (0.9803, 0.8704, 0.6603), (0.6579, 0.6468, 0.5268)
    slow, fast = (sum(each) for each in parts)
    assert f"{100 * (1 - fast / slow):.1f}" == "27.1"
    assert 100 * (1 - 1.815 / 2.51) > 27.6 > 100 * (1 - 1.82 / 2.52) - 0.2
    text = one_joint("0, 1, 2, 3", "9", "9", "within_limits", CUT_GAIN.format(percent=percent))
    (found,) = said_of(study_of(text), judge_improvements, "gain", "TG103")
    assert (found.verdict is ClaimVerdict.SUPPORTED) == follows
    assert (found.severity is Severity.ERROR) != follows


def test_a_printed_peak_above_a_printed_limit_contradicts_what_is_said_of_limits() -> None:
    """3.665 beside 3.6, both as printed; 3.6 in quotes may be cut off from 3.69."""
    peak = (
        '[[claims]]\nid = "p"\nquantity = "peak"\nwhere = "Table 4"\nof = "d"\n'
        'derivative = "velocity"\nvalue = "{}"\n'
    )
    for value, limit, wrong in (
        ("3.665", "3.6", True),
        ("3.601", "3.6", False),
        ("3.665", '"3.6"', False),
        ("3.75", '"3.6"', True),
        ("3.599", "3.6", False),
    ):
        text = one_joint("0, 1", limit, "0.60", "within_limits", peak.format(value))
        said = said_of(study_of(text), judge_peak_limits, "s", "TG209")
        assert [f.verdict for f in said] == [ClaimVerdict.INCONSISTENT] * wrong, (value, limit)
    text = one_joint("0, 1", '"3.6"', "0.60", "within_limits", peak.format("3.75"))
    (found,) = said_of(study_of(text), judge_peak_limits, "s", "TG209")
    assert found.message == (
        "Table 4 prints 3.75 rad/s for the velocity of joint 1, whose limit is at most 3.7 rad/s, "
        "however its digits are read."
    )
