"""Honest papers, made up, are accused of nothing, whether digits were rounded or cut off."""

import pytest
from support.findings import audited_text, finding, found_by, said_of, study_of
from support.made_up import (
    TWO_UNITS,
    algorithms,
    entry,
    gain,
    one_joint,
    paper,
    peak,
    row,
    sentence,
    total,
)
from support.papers.apart import apart
from trajgap.compare.audits import printed_rows
from trajgap.compare.audits.own_result import said_to_keep
from trajgap.compare.documents import Basis, ClaimVerdict, Finding, Scope, Severity
from trajgap.nlp import Evidence, Status

# A quintic from rest to rest over d rad in h s peaks at 15 d/(8 h) rad/s.
PEAK = 15 / 8
RULES = ["TG101", "TG103", "TG105", "TG107", "TG108", "TG201", "TG203", "TG301", "TG302", "TG304"]


def accused(found: list[Finding]) -> list[tuple[str, str | None, str]]:
    return [(f.rule, f.claim, f.message) for f in found if f.severity is not Severity.INFO]


def decided(found: list[Finding]) -> dict[str, ClaimVerdict | None]:
    return {f.claim: f.verdict for f in found if f.decides and f.claim is not None}


def test_what_is_said_of_a_total_is_said_of_its_durations_alone() -> None:
    rows = row("own", "1.90") + row("other", "2.20") + total("t", "1.90", of="own")
    study = study_of(paper([[0, 1]], rows, sentence("kept", "within_limits", "t"), velocity=1))
    assert [said_to_keep(study.case, c) for c in study.case.claims] == [True, False, True, False]


@pytest.mark.parametrize("seed", range(28))
def test_totals_kept_apart_and_profiles_from_rest_are_accused_of_nothing(seed: int) -> None:
    found = found_by(study_of(apart(seed)), *RULES)
    assert accused(found) == []
    assert decided(found)["profile"] is decided(found)["abstract"] is ClaimVerdict.SUPPORTED


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
    assert finding(text, "s", "TG201").verdict is verdict
    if verdict is ClaimVerdict.NOT_CHECKABLE and of == "d":
        said = [f.message for f in said_of(study_of(text), "d", "TG201")]
        assert "Derivatives at the ends are printed numbers" in " ".join(said)


@pytest.mark.parametrize(
    ("points", "limit", "time", "checks", "verdict"),
    [
        # 0.961736 s, cut off; what is plainly broken, or too long, is still refuted.
        ("0, 1", "1.9496", "0.961", "within_limits", "supported"),
        ("0, 1", "1.9496", "0.95", "within_limits", "refuted"),
        ("0, 1", "1.9496", "1.2", "optimal", "refuted"),
        # 7.125 s is exactly optimal from -0.4 to 3.4, which print as 0 and 3.
        ('"0", "3"', "1", "7.125", "optimal", "not checkable"),
        # From -0.657 to 1.979 rad, printed -0.65 and 1.97: farther than what rounds to these.
        ('"-0.65", "1.97"', "1", "4.9425", "optimal", "not checkable"),
        ('"-0.65", "1.97"', "1", "5.00", "optimal", "refuted"),
        # 0.5968 s is exactly what 1 rad takes under pi rad/s, and 0.05 % too short under 3.14.
        ("0, 1", '"3.14"', "0.59683", "within_limits", "supported"),
        ("0, 1", "3.14", "0.59683", "within_limits", "refuted"),
        ("0, 1", '"3.14"', "0.59683", "optimal", "not checkable"),
        ("0, 1", "3.14", "0.59683", "optimal", "refuted"),
        # Printed 3.2 for 3.15: the optimum 1.875/3.15 s is longer than what 3.2 allows.
        ("0, 1", '"3.2"', "0.59524", "optimal", "not checkable"),
        ("0, 1", "3.2", "0.59524", "optimal", "refuted"),
    ],
)
def test_digits_stand_for_all_that_they_may_be_cut_off_or_rounded_from(
    points: str, limit: str, time: str, checks: str, verdict: str
) -> None:
    text = one_joint(points, limit, time, checks)
    kept = checks == "within_limits"
    assert finding(text, "s", "TG201" if kept else "TG302").verdict == verdict
    if kept:
        assert finding(text, "d", "TG201").verdict == verdict


@pytest.mark.parametrize(
    ("time", "value", "refuted"), [("1.801", "1.802", False), ("1.7", "1.7", True)]
)
def test_a_duration_cut_off_beside_its_total_rounded(time: str, value: str, refuted: bool) -> None:
    """1.80167 s, the proven optimum, cut off to 1.801 and rounded to 1.802: 1.8015 fits both."""
    tail = row("m", time, total=value) + sentence("best", "optimal", "m")
    text = one_joint("0, 1", repr(PEAK / 1.80167), "1.80168", "within_limits", tail)
    study = study_of(text)
    assert study.optimum(study.pairs[0]).lower_bound is not None
    (found,) = said_of(study, "best", "TG302")
    assert (found.verdict is ClaimVerdict.REFUTED) == refuted


@pytest.mark.parametrize(("value", "longest"), [("3.913", 3.916), ("3.914", 3.915)])
def test_a_total_that_is_their_sum_bounds_no_more(value: str, longest: float) -> None:
    """1.336 + 1.580 + 0.997 = 3.913; each may be cut off, and then so may their sum by 0.003."""
    study = study_of(paper([[0, 1, 2, 3]], row("m", "1.336 1.580 0.997", total=value), velocity=1))
    (found,) = printed_rows(study, study.case.claim("m"))
    assert found.longest_total == pytest.approx(longest, abs=1e-9)


@pytest.mark.parametrize(("value", "agrees"), [("2.635", True), ("2.638", False)])
def test_a_total_cut_off_agrees_with_that_of_the_whole_numbers(value: str, agrees: bool) -> None:
    """0.6544 + 0.6408 + 0.5217 + 0.8184 is 2.6353; the digits that are left sum to 2.633."""
    table = row("table", "0.654 0.640 0.521 0.818", total="2.633", algorithm="new")
    head = total("head", value, of="table") + algorithms("new")
    text = one_joint("0, 1, 2, 3, 4", "9", "9", "within_limits", table + head)
    found = finding(text, "head", "TG105")
    assert (found.verdict is ClaimVerdict.SUPPORTED) == agrees
    assert (found.severity is Severity.ERROR) != agrees


@pytest.mark.parametrize(
    ("table", "value", "agrees"),
    [
        ("3.521", "3.53", True),
        ("3.521", "3.54", False),
        ("3.521", "3.6", True),
        ("3.6", "3.521", True),
        ("3.6", "3.498", False),
        ("3.521", "3.523", False),  # of as many digits: neither is the other one rounded up
    ],
)
def test_a_total_of_fewer_digits_may_be_rounded_up(table: str, value: str, agrees: bool) -> None:
    text = paper([[0, 1]], row("d", table), total("head", value, of="d"), velocity=1.9)
    found = finding(text, "head", "TG105")
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
def test_a_printed_peak_contradicts_what_limits_say(value: str, limit: str, wrong: bool) -> None:
    text = one_joint("0, 1", limit, "0.60", "within_limits", peak("p", "d", "velocity", value))
    said = said_of(study_of(text), "s", "TG209")
    assert [f.verdict for f in said] == [ClaimVerdict.INCONSISTENT] * wrong
    assert all("is at most 3.7 rad/s" in f.message for f in said if limit == '"3.6"')


def test_without_limits_no_motion_is_the_shortest_and_none_refutes() -> None:
    study = study_of(one_joint('"0.1", "1.3"', "inf", "2.5", "optimal"))
    assert study.optimum(study.pairs[0]).status is Status.NOT_ATTAINED
    (found,) = said_of(study, "s", "TG302")
    assert (found.verdict, found.severity) == (ClaimVerdict.NOT_CHECKABLE, Severity.INFO)
    assert "no limit is printed" in found.message


@pytest.mark.parametrize("keys", [{"state": "before"}, {}])
def test_the_state_before_an_optimisation_breaks_no_limit(keys: dict[str, str]) -> None:
    """No statement claims a limit here, and what an improvement starts from is not an answer."""
    start = row("start", "0.50", **keys) + gain("start", "d")
    text = one_joint("0, 1", "1.9", "0.99", "none", start)
    found = finding(text.replace('"none"', '"none"\nnot_checkable = "a"'), "start", "TG201")
    assert (found.severity, found.verdict) == (Severity.INFO, ClaimVerdict.NOT_CHECKABLE)
    assert not found.decides
    assert "A limit is broken" in found.message
    # It is accused where the paper says that it keeps the limits.
    named = one_joint("0, 1", "1.9", "0.99", "within_limits", start)
    named = named.replace('of = ["d"]', 'of = ["d", "start"]')
    assert finding(named, "start", "TG201").verdict is ClaimVerdict.REFUTED


@pytest.mark.parametrize(
    ("times", "value", "tail", "severity"),
    [
        # Steps of 1, 2 and 1.5 rad under 1.9 rad/s take 1.875 d/1.9 s each.
        ("0.987 1.974 1.480", "4.441", "", Severity.INFO),
        ("1.087 2.074 1.580", "4.741", "", Severity.WARNING),
        ("0.987 1.974 1.480", "4.441", gain("a", "b", percent="4.2"), Severity.ERROR),
    ],
)
def test_two_that_print_the_optimum(times: str, value: str, tail: str, severity: Severity) -> None:
    text = paper([[0, 1, 3, 1.5]], velocity=1.9)
    for name, kind in (("a", "pso"), ("b", "ga")):
        text += entry("algorithms", id=name, name=name, kind=kind)
        text += entry("tables", id=f"t{name}", where=f"Table {name}", title="t", algorithm=name)
        text += row(name, times, total=value, table=f"t{name}", algorithm=name)
    found = finding(text + tail, None, "TG104")
    assert found.severity is severity
    alike = severity is Severity.INFO
    assert found.verdict == ("not checkable" if alike else "inconsistent")
    assert ("which explains the agreement" in found.message) == alike


@pytest.mark.parametrize(
    ("value", "time", "verdict", "word"),
    [
        # 2 rad in 3 s peak at 1.25 rad/s exactly.
        ("1.2500", "3.00000", "supported", "equal within the rounding"),
        # 50 samples give 1.2490.
        ("1.2492", "3.00000", "supported", "as sampling the motion would give"),
        ("1.2489", "3.00000", "supported", "as sampling the motion would give"),
        ("1.2510", "3.00000", "inconsistent", "was found to explain the difference"),
        ("0.625", "3.00000", "inconsistent", "was found to explain the difference"),
        ("71.6", "3.00000", "inconsistent", "ratio is near 57.2958"),
        ("1250", "3.00000", "inconsistent", "ratio is near 1000"),
        ("75.0", "3.00000", "inconsistent", "ratio is near 60"),
        # In 2.1 s at 1.78571 rad/s, cut off.
        ("1.785", "2.10000000", "supported", "cut off instead of rounded"),
        # 2.4799 s printed as 2.47: its peak, 1.5121, is lower than what rounds to 2.47 allows.
        ("1.512", "2.47", "supported", "which fits if digits were cut off"),
        ("1.499", "2.47", "inconsistent", ""),
    ],
)
def test_a_peak_is_judged_by_its_distance(value: str, time: str, verdict: str, word: str) -> None:
    text = one_joint("0, 2", "1.9", time, "optimal", peak("p", "d", "velocity", value))
    found = finding(text, "p", "TG203")
    assert found.verdict == verdict
    assert word in found.message
    assert found.severity is (Severity.WARNING if verdict == "inconsistent" else Severity.INFO)


@pytest.mark.parametrize(
    ("points", "value", "keys", "severity"),
    [
        # Steps of 0.99 to 1.01 rad round to 0.00 and 1.00 and take 0.9770 to 0.9967 s.
        ('"0.00", "1.00"', "0.9800", {}, Severity.INFO),
        ('"0.00", "1.00"', "0.9868", {}, Severity.INFO),
        ('"0.00", "1.00"', "0.9500", {}, Severity.WARNING),
        # 1 rad under 1.9 rad/s takes a quintic 0.987 s, and a cubic 0.789 s.
        ("0, 1", "0.700", {}, Severity.WARNING),
        ("0, 1", "0.700", {"other_curve": "straight lines"}, None),
    ],
)
def test_a_warning_only_where_neither_rounding_nor_another_curve_explains_it(
    points: str, value: str, keys: dict[str, str], severity: Severity | None
) -> None:
    text = one_joint(points, "1.9", "0.99", "optimal", total("t", value, **keys))
    found = said_of(study_of(text), "t", "TG302")
    assert [f.severity for f in found] == ([severity] if severity else [])
    assert all(f.verdict is ClaimVerdict.NOT_CHECKABLE for f in found)


@pytest.mark.parametrize(("lower", "verdict"), [("0.3", "supported"), (0.3, "refuted")])
def test_quoted_bounds_on_durations_are_intervals(lower: str | float, verdict: str) -> None:
    parts = row("d", "0.296"), sentence("s", "within_limits", "d")
    text = paper([[0, 1]], *parts, bounds={"lower": lower}, velocity=9)
    assert finding(text, "d", "TG201").verdict == verdict


@pytest.mark.parametrize(("value", "verdict"), [("3.884", "supported"), ("3.880", "refuted")])
def test_durations_may_all_have_been_rounded_up(value: str, verdict: str) -> None:
    """0.7767 s five times is 3.8835 s: printed as 0.777 s, so each keeps its limit."""
    times = "0.777 0.777 0.777 0.778 0.778"
    text = paper([[0, 1, 2, 3, 4, 5]], row("d", times, total=value), velocity=2)
    assert finding(text, "d", "TG101").verdict == verdict


@pytest.mark.parametrize(
    ("time", "severity", "scope"),
    [("0.962", Severity.WARNING, Scope.SOME), ("0.95", Severity.ERROR, Scope.ALL)],
)
def test_a_proof_is_an_error_in_all_readings(time: str, severity: Severity, scope: Scope) -> None:
    one = audited_text(one_joint("0, 1", "1.9496", time, "within_limits", TWO_UNITS))
    against = [f for f in one.findings if f.verdict is ClaimVerdict.REFUTED]
    assert {f.claim for f in against} == {"d", "s"}
    assert {(f.severity, f.scope) for f in against} == {(severity, scope)}
    assert one.errors == (1 if severity is Severity.ERROR else 0)


def test_what_breaks_the_limits_is_not_optimal_within_them() -> None:
    """0.95 s is shorter than the shortest answer, 0.961736 s, and keeps no limit."""
    one = audited_text(one_joint("0, 1", "1.9496", "0.95", "optimal"))
    (found,) = [f for f in one.findings if f.claim == "s"]
    assert found.verdict is ClaimVerdict.REFUTED
    assert (found.basis, found.evidence) == (Basis.ENCLOSURE, Evidence.NONE)
    assert found.message.startswith("The printed motion breaks a limit. Table 2: A limit is broken")
    beside = next(f for f in one.findings if f.rule == "TG302" and f.claim == "d")
    assert beside.severity is Severity.INFO
    assert beside.message.endswith("because these durations break the limits.")
