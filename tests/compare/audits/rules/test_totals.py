"""Printed totals and improvements: what proves and what excludes them, and what accuses nobody."""

from fractions import Fraction
from itertools import product
from typing import Any
from unittest.mock import Mock

import pytest
from support.findings import audited_text, finding, said_of, study_of
from support.made_up import algorithms, claim, gain, one_joint, paper, row, sentence, tables, total
from trajgap.compare.audits import printed_row as row_module
from trajgap.compare.audits.card_errors import plainly
from trajgap.compare.audits.case_audit import audit_case
from trajgap.compare.audits.rounding import RoundingBox, excludes_total
from trajgap.compare.audits.rules.printed_digits import span
from trajgap.compare.audits.study import Study
from trajgap.compare.documents import ClaimVerdict, Finding, Severity
from trajgap.nlp import solve
from trajgap.problem import Interval, Limits, Problem, rest_to_rest, three_five_three


def bare(value: str, checks: str, points: str = "0, 1") -> Study:
    """A total, what is said of it, and a rival's that is twice as long; 0.98684 s are needed."""
    tail = (
        total("t", value)
        + sentence("said", checks, "t")
        + total("before", f"{2 * float(value):.3f}", algorithm="other")
        + gain("before", "t", percent="50")
        + algorithms("other")
    )
    return study_of(one_joint(points, "1.9", "0.99", "optimal", tail))


@pytest.mark.parametrize(
    ("points", "value", "checks", "verdict"),
    [
        ("0, 1", "5.35", "optimal", "refuted"),  # 442 % above
        ("0, 1", "0.690", "optimal", "refuted"),  # 0.7 of it
        ("0, 1", "0.987", "optimal", "supported"),
        ("0, 1", "0.690", "within_limits", "refuted"),
        ("0, 1", "0.986", "within_limits", "not checkable"),  # 0.98684 cut off
        ("0, 1", "5.35", "within_limits", "not checkable"),
        ('"0.00", "1.00"', "0.690", "optimal", "refuted"),
        ('"0.00", "1.00"', "0.690", "within_limits", "refuted"),
        ('"0.00", "1.00"', "0.975", "within_limits", "not checkable"),  # 0.99 rad takes 0.977 s
        ('"0.00", "1.00"', "0.999", "optimal", "not checkable"),  # 1.01 rad, cut off, takes it
        ('"0.00", "1.00"', "1.020", "optimal", "refuted"),
        ('"0.00", "1.00"', "0.990", "optimal", "not checkable"),
    ],
)
def test_a_bare_total_is_judged(points: str, value: str, checks: str, verdict: str) -> None:
    study = bare(value, checks, points)
    id_ = {"optimal": "TG302", "within_limits": "TG201"}[checks]
    (found,) = said_of(study, "said", id_)
    assert found.verdict == verdict
    # A total is refuted where no motion is so short, never for being long.
    short = verdict == "refuted" and value == "0.690"
    judged = {one.claim: one for one in audit_case(study).judgements}
    assert (judged["t"].verdict == "refuted") == short
    assert ("takes 0.690 s or less" in judged["t"].why) == short
    # The percentage follows from both totals, and from a refuted one nothing follows.
    assert judged["gain"].verdict == ("not checkable" if short else "supported")


def test_no_total_is_excluded_that_a_motion_takes() -> None:
    """Three pieces under a velocity limit: the proof holds well below the optimum, never at it."""
    limits = Limits(velocity=1.7, joints=1)
    problem = Problem([[0.1], [0.9], [-0.3], [0.5]], limits, three_five_three())
    best = solve(problem, prove=0).total_time
    assert excludes_total(problem, 0.4 * best) is True
    assert not excludes_total(problem, best, boxes=100)
    wide = RoundingBox(problem.waypoints, problem.waypoints - 0.05, problem.waypoints + 0.05)
    assert excludes_total(problem, 0.3 * best, wide)
    # A proof that would need more boxes says nothing.
    assert excludes_total(problem, 0.4 * best, boxes=4) is None
    still = Problem([[0.0], [1.0]], Limits(acceleration=1.0, joints=1), rest_to_rest(1, 5))
    assert not excludes_total(still, 0.01)  # no speed bounds a duration: nothing is proved


def test_what_takes_more_boxes_to_exclude_accuses_nobody(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(row_module, "excludes_total", lambda *_: None)
    study = bare("0.7", "within_limits")
    (found,) = said_of(study, "said", "TG201")
    assert found.verdict == "not checkable"
    (left,) = study.intervals.left_out
    assert left == "whether any motion takes 0.7 s or less, tried with 1000 boxes"


def test_a_total_that_a_known_motion_takes_is_never_tried(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(row_module, "excludes_total", Mock(side_effect=AssertionError("tried")))
    (found,) = said_of(bare("1.2", "within_limits"), "said", "TG201")
    assert found.verdict == "not checkable"


TABLES = algorithms("new", "old") + tables(2, 6)
NEW, OLD = {"algorithm": "new"}, {"algorithm": "old"}
STRAIGHT = {"other_curve": "straight lines"}


@pytest.mark.parametrize(
    ("own", "other", "more", "severity"),
    [
        ({}, {}, "", Severity.WARNING),
        (NEW, NEW, "", Severity.WARNING),
        ({"table": "table-2"}, {"printed_tables": ["table-2"]}, "", Severity.ERROR),
        ({}, {"of": "d"}, "", Severity.ERROR),
        # A rival's: of a method that the text names, or that the total's place leaves out.
        (OLD, {}, "", None),
        (OLD, NEW, "", None),
        (OLD, NEW | {"of": "d"}, "", None),
        ({}, {}, gain("t", "d", percent="24.4"), None),
        # Another curve's.
        (STRAIGHT, {}, "", None),
        ({}, STRAIGHT | {"of": "d"}, "", None),
        # Another experiment's, of the same method.
        (NEW | {"table": "table-2"}, NEW | {"table": "table-6"}, "", None),
        ({"state": "before"}, {}, "", None),
        ({"coupling": "per-joint"}, {"coupling": "shared"}, "", None),
        # It may be the total of either row, or the mean of many runs.
        (NEW, NEW, row("e", "0.8", algorithm="new"), None),
        ({}, NEW, total("best", "0.990", algorithm="new"), None),
    ],
)
def test_two_totals_that_the_file_keeps_apart_contradict_nothing(
    own: dict[str, Any], other: dict[str, Any], more: str, severity: Severity | None
) -> None:
    parts = row("d", "0.990", **own), total("t", "1.31", **other), TABLES, more
    found = said_of(study_of(paper([[0, 1]], *parts, velocity=1.9)), "t", "TG105")
    against = [f for f in found if f.severity is not Severity.INFO]
    assert [f.severity for f in against] == ([severity] if severity else [])
    assert all((f.verdict is ClaimVerdict.INCONSISTENT) == (f in against) for f in found)
    assert all("0.990 s (sum of its durations)" in f.message for f in against)


def test_a_total_is_set_beside_the_place_that_prints_the_other() -> None:
    d = row("d", "0.990", where="Figure 3")
    t = total("t", "1.31", of="d", where="Figure 9")
    found = audited_text(paper([[0, 1]], d, t, velocity=1.9))
    (cause,) = (c for c in found.causes if c.rule == "TG105")
    said = "Figure 9 prints 1.31 s for a total that Figure 3 gives as 0.990 s"
    assert said in plainly(found.case, cause)[0]


SHARES = {"slower": lambda a, b: 100 * (a - b) / a, "faster": lambda a, b: 100 * (a - b) / b}
PAIRS = [("1.2", "0.8"), ("3.1", "2.9"), ("0.9", "0.8"), ("2.25", "2.10"), ("1.05", "0.95")]


def judged(slow: str, fast: Any, **stated: str) -> Finding:
    """What is found on an improvement between two totals."""
    tail = total("slow", slow) + total("fast", fast) + gain("slow", "fast", **stated)
    text = one_joint("0, 1", "9", "0.99", "optimal", tail)
    return finding(text, "gain", "TG103")


def alike(text: str) -> list[Fraction]:
    """The ends and the middle of what rounds to the digits; ties round either way."""
    half = Fraction(1, 2 * 10 ** len(text.partition(".")[2]))
    return [Fraction(text) - half, Fraction(text), Fraction(text) + half]


def near(true: list[Fraction], places: int) -> list[str]:
    """Numbers to print: inside, at both ends, and the first beyond each end."""
    unit = Fraction(1, 10**places)
    low, high = int(min(true) // unit) - 1, int(max(true) // unit) + 2
    chosen = {low, low + 1, low + 2, (low + high) // 2, high - 1, high, high + 1}
    return [f"{float(k * unit):.{places}f}" for k in sorted(chosen) if k >= 0]


def held(slow: str, fast: str, printed: str, true: list[Fraction], **stated: str) -> bool:
    """Whether some value that rounds to the digits is true; a difference and a share are monotone
    in each total, so the enumerated ends are the ends."""
    least, _, most = alike(printed)
    fits = min(true) <= most and least <= max(true)
    found = judged(slow, fast, **stated)
    assert (found.severity is Severity.INFO) == fits, printed
    assert found.verdict is ClaimVerdict.SUPPORTED or not fits
    return fits


@pytest.mark.parametrize(("slow", "fast"), PAIRS)
@pytest.mark.parametrize("places", [0, 1])
@pytest.mark.parametrize("base", SHARES)
def test_a_percentage_of_some_rounding(slow: str, fast: str, places: int, base: str) -> None:
    true = [SHARES[base](a, b) for a, b in product(alike(slow), alike(fast))]
    tried = near(true, places)
    assert len({held(slow, fast, one, true, percent=one, base=base) for one in tried}) > 1


@pytest.mark.parametrize(("slow", "fast"), PAIRS)
@pytest.mark.parametrize("places", [0, 1, 2])
def test_a_difference_within_rounding_is_supported(slow: str, fast: str, places: int) -> None:
    true = [a - b for a, b in product(alike(slow), alike(fast))]
    for printed in near(true, places):
        held(slow, fast, printed, true, seconds=printed)


@pytest.mark.parametrize(
    ("slow", "fast", "percent", "base", "verdict", "other"),
    [
        # 2.80/2.70 − 1 = 3.70 %, and 1 − 2.70/2.80 = 3.57 %.
        ("2.800", "2.700", "3.7", "", "supported", "longer"),
        ("2.800", "2.700", "3.6", "", "supported", None),
        ("2.800", "2.700", "3.7", "faster", "supported", None),
        ("2.800", "2.700", "3.6", "slower", "supported", None),
        ("2.800", "2.700", "4.5", "", "refuted", "shorter"),
        # A stated base is the only one.
        ("2.8000", "2.7000", "3.7", "slower", "refuted", None),
        ("2.8000", "2.7000", "3.5", "faster", "refuted", None),
        ("3.000", "2.000", "50.0", "slower", "refuted", "shorter"),
        ("3.000", "2.000", "33.3", "faster", "refuted", "longer"),
        ("3.000", "2.000", "41.0", "slower", "refuted", ""),
        ("3.000", "2.000", "41.0", "faster", "refuted", ""),
        # 1 − 3.85282/4 = 3.6795 %, cut off; 4/3.85282 − 1 = 3.8201 %.
        ("4.00000", "3.85282", "3.67", "", "supported", "shorter"),
    ],
)
def test_a_percentage_may_be_a_share_of_either_total(
    slow: str, fast: str, percent: str, base: str, verdict: str, other: str | None
) -> None:
    found = judged(slow, fast, percent=percent, **({"base": base} if base else {}))
    assert found.verdict == verdict
    if other is not None:
        said = f"As a share of the {other} total it would be"
        assert found.message.count("As a share of") == bool(other)
        assert (said in found.message) == bool(other)


@pytest.mark.parametrize(
    ("slow", "fast", "percent", "base", "verdict"),
    [
        # 9.9 and 3.1 s, both rounded up; rounded to the nearest or cut off, at most 68.2 % fits.
        ("10", "4", "69", "slower", "supported"),
        ("10", "4", "71", "slower", "refuted"),
        ("10", "4", "219", "faster", "supported"),
        ("10", "4", "235", "faster", "refuted"),
        ("1", "1", "99", "slower", "refuted"),  # nothing is a share of nothing
    ],
)
def test_an_improvement_may_be_that_of_totals_rounded_up(
    slow: str, fast: str, percent: str, base: str, verdict: str
) -> None:
    found = judged(slow, fast, percent=percent, base=base)
    assert found.verdict == verdict
    assert ("parts were rounded up" in found.message) == (verdict == "supported")


@pytest.mark.parametrize(
    ("printed", "verdict"),
    [
        ("0.96", "supported"),
        ("0.97", "supported"),  # rounded up to a hundredth
        ("0.98", "refuted"),
        ("0.9601", "supported"),
        ("0.9603", "refuted"),  # of as many digits as the row: nothing to round up
    ],
)
def test_the_longest_durations_may_be_rounded_up(printed: str, verdict: str) -> None:
    text = paper([[0, 1]], row("d", "0.9601"), longest("m", printed), velocity=1.9)
    assert finding(text, "m", "TG102").verdict == verdict


@pytest.mark.parametrize("keys", [{}, {"base": "slower"}, {"base": "faster"}])
@pytest.mark.parametrize("fast", ["0", "0.0", 0])
def test_nothing_is_a_share_of_a_total_of_nothing(fast: Any, keys: dict[str, str]) -> None:
    for percent, verdict in (("100", "supported"), ("40", "refuted")):
        word = "not checkable" if keys == {"base": "faster"} else verdict
        assert judged("3", fast, percent=percent, **keys).verdict == word


def test_an_interval_whose_ends_print_alike_is_one_number() -> None:
    assert span(Interval(Fraction("7.771312"), Fraction("7.771314"))) == "7.77131"
    assert span(Interval(Fraction("7.7712"), Fraction("7.7714"))) == "7.7712 to 7.7714"


def test_an_improvement_below_the_last_digit_contradicts_nothing() -> None:
    found = judged("2.80", "2.80")
    assert (found.verdict, found.severity) == (ClaimVerdict.NOT_CHECKABLE, Severity.INFO)
    assert "below 0.01 s" in found.message


def longest(name: str, value: str = "2.5", **keys: str) -> str:
    """A table with a total."""
    return claim(name, "maximum", of=["d"], durations=[value], total=value, **keys)


def test_one_table_does_not_say_how_two_totals_differ() -> None:
    """1 - 3.528/3.961 is 10.93 %; a table that either total might stand in speaks against none."""
    said = total("standard", "3.961"), total("improved", "3.528")
    share = gain("standard", "improved", percent="10.9")
    text = one_joint("0, 1", "9", "2.5", "within_limits", longest("longest"))
    for other in ("", longest("other")):
        found = finding(text + other + "".join(said) + share, "gain", "TG103")
        assert (found.verdict, found.severity) == (ClaimVerdict.SUPPORTED, Severity.INFO)
    # Each total has a table of its own, and these print the same number.
    rival = total("standard", "3.961", algorithm="rival") + algorithms("rival")
    apart = text + longest("other", algorithm="rival") + rival + said[1] + share
    _, found = said_of(study_of(apart), "gain", "TG103")
    assert (found.verdict, found.severity) == (ClaimVerdict.INCONSISTENT, Severity.ERROR)
    # 3.961/3.528 − 1 is 12.27 %: tables that give either share contradict nothing.
    text = one_joint("0, 1", "9", "2.5", "within_limits", longest("longest", "3.528"))
    text += longest("other", "3.961", algorithm="rival") + rival + said[1]
    for percent in ("10.9", "12.3"):
        one = finding(text + gain("standard", "improved", percent=percent), "gain", "TG103")
        assert one.verdict is ClaimVerdict.SUPPORTED


@pytest.mark.parametrize(("percent", "follows"), [("27.1", True), ("25.0", False)])
def test_a_percentage_of_whole_numbers_beside_totals_cut_off(percent: str, follows: bool) -> None:
    """2.5110 and 1.8315 s, whose parts are cut off and then added up: 27.06 % beside 27.89 %."""
    tail = (
        row("slow", "0.98 0.87 0.66", total="2.51", state="before")
        + row("fast", "0.65 0.64 0.52", total="1.81")
        + gain("slow", "fast", base="slower", percent=percent)
    )
    text = one_joint("0, 1, 2, 3", "9", "9", "within_limits", tail)
    found = finding(text, "gain", "TG103")
    assert (found.verdict is ClaimVerdict.SUPPORTED) == follows
    assert (found.severity is Severity.ERROR) != follows
