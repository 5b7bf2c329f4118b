"""Sound papers that a careless rule accuses: none of it may come back."""

from __future__ import annotations

import numpy as np
import pytest
from support.findings import finding, said_of, study_of
from support.made_up import entry, gain, paper, peak, row, sentence, total
from support.one_joint import one_joint
from trajgap.compare.audits.rules.continuous_time import judge_motions
from trajgap.compare.audits.rules.distances import judge_distances
from trajgap.compare.audits.rules.peaks import judge_peaks
from trajgap.compare.audits.rules.printed_digits import judge_digits
from trajgap.compare.audits.rules.printed_tables import judge_tables
from trajgap.compare.documents import ClaimVerdict, Severity
from trajgap.nlp import Status

# A quintic from rest to rest over d rad in h s peaks at 15 d/(8 h) rad/s.
PEAK = 15 / 8


def test_without_limits_no_motion_is_the_shortest_and_none_refutes() -> None:
    study = study_of(one_joint('"0.1", "1.3"', "inf", "2.5", "optimal"))
    assert study.optimum("main", "as-printed").status is Status.NOT_ATTAINED
    (found,) = said_of(study, judge_distances, "s", "TG302")
    assert (found.verdict, found.severity) == (ClaimVerdict.NOT_CHECKABLE, Severity.INFO)
    assert "no limit is printed" in found.message


@pytest.mark.parametrize(("limit", "verdict"), [('"3.14"', "supported"), ("3.14", "refuted")])
def test_a_quoted_limit_stands_for_all_that_rounds_to_it(limit: str, verdict: str) -> None:
    """0.5968 s is exactly what 1 rad takes under pi rad/s, and 0.05 % too short under 3.14."""
    time = f"{PEAK / np.pi:.5f}"
    kept = one_joint("0, 1", limit, time, "within_limits")
    for claim in ("d", "s"):
        assert finding(kept, judge_motions, claim, "TG201").verdict == verdict
    best = finding(one_joint("0, 1", limit, time, "optimal"), judge_distances, "s", "TG302")
    assert best.verdict == ("refuted" if limit == "3.14" else "not checkable")


def test_an_optimum_under_a_limit_that_was_rounded_up_is_not_too_long() -> None:
    """Printed 3.2 for 3.15: the optimum 1.875/3.15 s is longer than what 3.2 allows."""
    time = f"{PEAK / 3.15:.5f}"
    for limit, verdict in (('"3.2"', "not checkable"), ("3.2", "refuted")):
        text = one_joint("0, 1", limit, time, "optimal")
        assert finding(text, judge_distances, "s", "TG302").verdict == verdict


@pytest.mark.parametrize(("lower", "verdict"), [("0.3", "supported"), (0.3, "refuted")])
def test_quoted_bounds_on_durations_are_intervals(lower: str | float, verdict: str) -> None:
    parts = row("d", "0.296"), sentence("s", "within_limits", "d")
    text = paper([[0, 1]], *parts, bounds={"lower": lower}, velocity=9)
    assert finding(text, judge_motions, "d", "TG201").verdict == verdict


@pytest.mark.parametrize("keys", [{"state": "before"}, {}])
def test_the_state_before_an_optimisation_breaks_no_limit(keys: dict[str, str]) -> None:
    """No statement claims a limit here, and what an improvement starts from is no answer."""
    start = row("start", "0.50", **keys) + gain("start", "d")
    text = one_joint("0, 1", "1.9", "0.99", "none", start)
    found = finding(
        text.replace('"none"', '"none"\nnot_checkable = "a"'), judge_motions, "start", "TG201"
    )
    assert (found.severity, found.verdict) == (Severity.INFO, ClaimVerdict.NOT_CHECKABLE)
    assert not found.decides
    assert "A limit is broken" in found.message
    # It is accused where the paper says that it keeps the limits.
    named = one_joint("0, 1", "1.9", "0.99", "within_limits", start)
    named = named.replace('of = ["d"]', 'of = ["d", "start"]')
    assert finding(named, judge_motions, "start", "TG201").verdict is ClaimVerdict.REFUTED


# Steps of 1, 2 and 1.5 rad under 1.9 rad/s take 1.875 d/1.9 s each.
OPTIMAL = ("0.987 1.974 1.480", "4.441")
LONGER = ("1.087 2.074 1.580", "4.741")


@pytest.mark.parametrize(
    ("printed", "tail", "severity", "verdict"),
    [
        (OPTIMAL, "", Severity.INFO, ClaimVerdict.NOT_CHECKABLE),
        (LONGER, "", Severity.WARNING, ClaimVerdict.INCONSISTENT),
        (OPTIMAL, gain("a", "b", percent="4.2"), Severity.ERROR, ClaimVerdict.INCONSISTENT),
    ],
)
def test_two_algorithms_that_print_the_optimum_print_alike(
    printed: tuple[str, str], tail: str, severity: Severity, verdict: ClaimVerdict
) -> None:
    times, value = printed
    text = paper([[0, 1, 3, 1.5]], velocity=1.9)
    for name, kind in (("a", "pso"), ("b", "ga")):
        text += entry("algorithms", id=name, name=name, kind=kind)
        text += entry("tables", id=f"t{name}", where=f"Table {name}", title="t", algorithm=name)
        text += row(name, times, total=value, table=f"t{name}", algorithm=name)
    found = finding(text + tail, judge_tables, None, "TG104")
    assert (found.severity, found.verdict) == (severity, verdict)
    assert ("which explains it" in found.message) == (severity is Severity.INFO)


def test_a_rival_on_another_curve_stands_beside_no_optimum() -> None:
    """1 rad under 1.9 rad/s takes a quintic 0.987 s, and a cubic 0.789 s."""
    text = one_joint("0, 1", "1.9", "0.99", "optimal")
    own = finding(text + total("rival", "0.700"), judge_distances, "rival", "TG302")
    assert own.severity is Severity.WARNING
    other = study_of(text + total("rival", "0.700", other_curve="straight lines"))
    assert not [f for f in judge_distances(other) if f.claim == "rival"]


@pytest.mark.parametrize(
    ("value", "time", "verdict", "word"),
    [
        # 2 rad in 3 s peak at 1.25 rad/s exactly.
        ("1.2500", "3.00000", "supported", "equal within the rounding"),
        ("1.2492", "3.00000", "supported", "as sampling the motion gives it"),  # 50 samples: 1.2490
        ("1.2489", "3.00000", "supported", "as sampling the motion gives it"),
        ("1.2510", "3.00000", "inconsistent", "off by more than"),
        ("0.625", "3.00000", "inconsistent", "off by more than"),
        ("71.6", "3.00000", "inconsistent", "ratio is near 57.2958"),
        ("1250", "3.00000", "inconsistent", "ratio is near 1000"),
        ("75.0", "3.00000", "inconsistent", "ratio is near 60"),
        # In 2.1 s at 1.78571 rad/s, cut off.
        ("1.785", "2.10000000", "supported", "cut off instead of rounded"),
    ],
)
def test_a_peak_is_judged_by_the_class_of_its_distance(
    value: str, time: str, verdict: str, word: str
) -> None:
    text = one_joint("0, 2", "1.9", time, "optimal", peak("p", "d", "velocity", value))
    found = finding(text, judge_peaks, "p", "TG203")
    assert found.verdict == verdict
    assert word in found.message
    assert found.severity is (Severity.WARNING if verdict == "inconsistent" else Severity.INFO)


@pytest.mark.parametrize(
    ("value", "severity"),
    [("0.9800", Severity.INFO), ("0.9868", Severity.INFO), ("0.9500", Severity.WARNING)],
)
def test_no_warning_where_the_rounding_of_way_points_explains_it(
    value: str, severity: Severity
) -> None:
    """Steps of 0.99 to 1.01 rad round to 0.00 and 1.00 and take 0.9770 to 0.9967 s."""
    text = one_joint('"0.00", "1.00"', "1.9", "0.99", "optimal", total("t", value))
    found = finding(text, judge_distances, "t", "TG302")
    assert (found.severity, found.verdict) == (severity, ClaimVerdict.NOT_CHECKABLE)


@pytest.mark.parametrize(("value", "verdict"), [("3.884", "supported"), ("3.880", "refuted")])
def test_durations_may_all_have_been_rounded_up(value: str, verdict: str) -> None:
    """0.7767 s five times is 3.8835 s: printed as 0.777 s, so that each keeps its limit."""
    times = "0.777 0.777 0.777 0.778 0.778"
    text = paper([[0, 1, 2, 3, 4, 5]], row("d", times, total=value), velocity=2)
    assert finding(text, judge_digits, "d", "TG101").verdict == verdict
