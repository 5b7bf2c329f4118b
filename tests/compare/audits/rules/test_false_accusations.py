"""Sound papers that a careless rule accuses: none of it may come back."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
from support.findings import said_of, study_of
from support.one_joint import QUESTION, one_joint
from trajgap.compare.audits.rules.continuous_time import judge_motions
from trajgap.compare.audits.rules.distances import judge_distances
from trajgap.compare.audits.rules.improvements import judge_improvements
from trajgap.compare.audits.rules.peaks import judge_peaks
from trajgap.compare.audits.rules.printed_digits import judge_digits, span
from trajgap.compare.audits.rules.printed_tables import judge_tables
from trajgap.compare.documents import ClaimVerdict, Severity
from trajgap.nlp import Status
from trajgap.problem import Interval

# A quintic from rest to rest over d rad in h s peaks at 15 d/(8 h) rad/s.
PEAK = 15 / 8


def test_without_limits_no_motion_is_the_shortest_and_none_refutes() -> None:
    study = study_of(one_joint('"0.1", "1.3"', "inf", "2.5", "optimal"))
    assert study.optimum("main", "as-printed").status is Status.NOT_ATTAINED
    (found,) = said_of(study, judge_distances, "s", "TG302")
    assert (found.verdict, found.severity) == (ClaimVerdict.NOT_CHECKABLE, Severity.INFO)
    assert "no limit is printed, and no motion is the shortest" in found.message


@pytest.mark.parametrize(("limit", "verdict"), [('"3.14"', "supported"), ("3.14", "refuted")])
def test_a_quoted_limit_stands_for_all_that_rounds_to_it(limit: str, verdict: str) -> None:
    """0.5968 s is exactly what 1 rad takes under pi rad/s, and 0.05 % too short under 3.14."""
    time = f"{PEAK / np.pi:.5f}"
    study = study_of(one_joint("0, 1", limit, time, "within_limits"))
    for claim in ("d", "s"):
        (found,) = said_of(study, judge_motions, claim, "TG201")
        assert found.verdict == verdict
    bare = limit == "3.14"
    statement = study_of(one_joint("0, 1", limit, time, "optimal"))
    (found,) = said_of(statement, judge_distances, "s", "TG302")
    assert found.verdict == ("refuted" if bare else "not checkable")


def test_an_optimum_under_a_limit_that_was_rounded_up_is_not_too_long() -> None:
    """Printed 3.2 for 3.15: the optimum 1.875/3.15 s is longer than what 3.2 allows."""
    time = f"{PEAK / 3.15:.5f}"
    study = study_of(one_joint("0, 1", '"3.2"', time, "optimal"))
    (found,) = said_of(study, judge_distances, "s", "TG302")
    assert found.verdict is ClaimVerdict.NOT_CHECKABLE
    exact = study_of(one_joint("0, 1", "3.2", time, "optimal"))
    (found,) = said_of(exact, judge_distances, "s", "TG302")
    assert found.verdict is ClaimVerdict.REFUTED


def test_quoted_bounds_on_durations_are_intervals() -> None:
    bounds = '\n[durations]\nlower = {}\n[[claims]]\nid = "d"\n'
    text = one_joint("0, 1", "9", "0.296", "within_limits")
    quoted = text.replace('\n[[claims]]\nid = "d"\n', bounds.format('"0.3"'))
    bare = text.replace('\n[[claims]]\nid = "d"\n', bounds.format("0.3"))
    assert said_of(study_of(quoted), judge_motions, "d", "TG201")[0].verdict == "supported"
    assert said_of(study_of(bare), judge_motions, "d", "TG201")[0].verdict == "refuted"


TABLE_AND_TOTALS = """
[[claims]]
id = "longest"
quantity = "maximum"
where = "Table 3, last row"
of = ["d"]
durations = ["2.5"]
total = "2.5"
{other}
[[claims]]
id = "standard"
quantity = "total_time"
where = "Table 4"
value = "3.961"
{slower}
[[claims]]
id = "improved"
quantity = "total_time"
where = "Table 4"
value = "3.528"
[[claims]]
id = "gain"
quantity = "improvement"
where = "conclusion"
slower = "standard"
faster = "improved"
percent = "10.9"
"""
SECOND_TABLE = """
[[claims]]
id = "other"
quantity = "maximum"
where = "Table 2, last row"
of = ["d"]
durations = ["2.5"]
total = "2.5"
"""
METHOD_2000 = """
[[algorithms]]
id = "rival"
name = "method of 2000"
"""


def test_one_table_does_not_say_how_two_totals_differ() -> None:
    """1 - 3.528/3.961 is 10.93 %; a table that either total might stand in speaks against none."""
    text = one_joint("0, 1", "9", "2.5", "within_limits")
    for other in ("", SECOND_TABLE):
        study = study_of(text + TABLE_AND_TOTALS.format(other=other, slower=""))
        (found,) = said_of(study, judge_improvements, "gain", "TG103")
        assert (found.verdict, found.severity) == (ClaimVerdict.SUPPORTED, Severity.INFO)
    # Each total has a table of its own, and these print the same number.
    rival = SECOND_TABLE + 'algorithm = "rival"'
    apart = TABLE_AND_TOTALS.format(other=rival, slower='algorithm = "rival"') + METHOD_2000
    _, found = said_of(study_of(text + apart), judge_improvements, "gain", "TG103")
    assert (found.verdict, found.severity) == (ClaimVerdict.INCONSISTENT, Severity.ERROR)


BEFORE = """
[[claims]]
id = "better"
quantity = "improvement"
where = "abstract"
slower = "start"
faster = "d"
[[claims]]
id = "start"
quantity = "durations"
where = "Table 2"
durations = ["0.50"]
{state}
"""


@pytest.mark.parametrize("state", ['state = "before"\n', ""])
def test_the_state_before_an_optimisation_breaks_no_limit(state: str) -> None:
    """No statement claims a limit here, and what an improvement starts from is no answer."""
    text = one_joint("0, 1", "1.9", "0.99", "optimal", BEFORE.format(state=state))
    text = text.replace('checks = "optimal"\nof = ["d"]', 'checks = "none"\nnot_checkable = "a"')
    study = study_of(text)
    (found,) = said_of(study, judge_motions, "start", "TG201")
    assert (found.severity, found.verdict) == (Severity.INFO, ClaimVerdict.NOT_CHECKABLE)
    assert not found.decides
    assert "A limit is broken" in found.message


def test_the_state_before_is_accused_where_the_paper_says_that_it_keeps_the_limits() -> None:
    text = one_joint("0, 1", "1.9", "0.99", "within_limits", BEFORE.format(state='state="before"'))
    named = text.replace('of = ["d"]', 'of = ["d", "start"]')
    (found,) = said_of(study_of(named), judge_motions, "start", "TG201")
    assert found.verdict is ClaimVerdict.REFUTED


TOTALS = """
[[claims]]
id = "slow"
quantity = "total_time"
where = "abstract"
value = "{slow}"
[[claims]]
id = "fast"
quantity = "total_time"
where = "abstract"
value = "{fast}"
[[claims]]
id = "gain"
quantity = "improvement"
where = "abstract"
slower = "slow"
faster = "fast"
percent = "{percent}"
{base}
"""


@pytest.mark.parametrize(
    ("percent", "base", "verdict"),
    [
        ("3.7", "", "supported"),  # 2.80/2.70 - 1 = 3.70 %
        ("3.6", "", "supported"),  # 1 - 2.70/2.80 = 3.57 %
        ("3.7", 'base = "faster"', "supported"),
        ("3.6", 'base = "slower"', "supported"),
        ("4.5", "", "refuted"),
    ],
)
def test_a_percentage_may_be_a_share_of_either_total(percent: str, base: str, verdict: str) -> None:
    tail = TOTALS.format(slow="2.800", fast="2.700", percent=percent, base=base)
    study = study_of(one_joint("0, 1", "1.9", "0.99", "optimal", tail))
    (found,) = said_of(study, judge_improvements, "gain", "TG103")
    assert found.verdict == verdict
    if percent == "3.7" and not base:
        assert "as a share of the shorter total" in found.message
        assert "As a share of the longer total it would be" in found.message
    if verdict == "refuted":
        assert "of the longer total" in found.message
        assert "As a share of the shorter total it would be" in found.message


def test_a_percentage_that_was_cut_off_is_set_beside_the_other_base_once() -> None:
    """1 − 3.85282/4 = 3.6795 %, printed 3.67; 4/3.85282 − 1 = 3.8201 %."""
    tail = TOTALS.format(slow="4.00000", fast="3.85282", percent="3.67", base="")
    study = study_of(one_joint("0, 1", "1.9", "0.99", "optimal", tail))
    (found,) = said_of(study, judge_improvements, "gain", "TG103")
    assert found.verdict is ClaimVerdict.SUPPORTED
    assert found.message.count("as a share of the longer total") == 1
    assert "As a share of the shorter total it would be 3.82" in found.message


def test_an_interval_whose_ends_print_alike_is_one_number() -> None:
    assert span(Interval(Fraction("7.771312"), Fraction("7.771314"))) == "7.77131"
    assert span(Interval(Fraction("7.7712"), Fraction("7.7714"))) == "7.7712 to 7.7714"


def test_an_improvement_below_the_last_digit_contradicts_nothing() -> None:
    tail = TOTALS.format(slow="2.80", fast="2.80", percent="0.1", base="")
    tail = tail.replace('percent = "0.1"\n', "")
    study = study_of(one_joint("0, 1", "1.9", "0.99", "optimal", tail))
    (found,) = said_of(study, judge_improvements, "gain", "TG103")
    assert found.verdict is ClaimVerdict.NOT_CHECKABLE
    assert found.severity is Severity.INFO
    assert "an improvement, if there is one, is below 0.01 s" in found.message


@pytest.mark.parametrize(("base", "percent"), [("slower", "3.7"), ("faster", "3.5")])
def test_a_stated_base_is_the_only_one(base: str, percent: str) -> None:
    tail = TOTALS.format(slow="2.8000", fast="2.7000", percent=percent, base=f'base = "{base}"')
    study = study_of(one_joint("0, 1", "1.9", "0.99", "optimal", tail))
    (found,) = said_of(study, judge_improvements, "gain", "TG103")
    assert found.verdict is ClaimVerdict.REFUTED


ALIKE = """
[[algorithms]]
id = "one"
name = "first"
kind = "pso"
[[algorithms]]
id = "two"
name = "second"
kind = "ga"
[[tables]]
id = "t1"
where = "Table 2"
title = "first"
algorithm = "one"
[[tables]]
id = "t2"
where = "Table 3"
title = "second"
algorithm = "two"
[[claims]]
id = "a"
quantity = "durations"
where = "Table 2"
table = "t1"
algorithm = "one"
durations = [{durations}]
total = "{total}"
[[claims]]
id = "b"
quantity = "durations"
where = "Table 3"
table = "t2"
algorithm = "two"
durations = [{durations}]
total = "{total}"
{tail}
"""


GAIN = """
[[claims]]
id = "gain"
quantity = "improvement"
where = "abstract"
slower = "a"
faster = "b"
percent = "4.2"
"""


# Steps of 1, 2 and 1.5 rad under 1.9 rad/s take 1.875 d/1.9 s each.
STEPS = "0, 1, 3, 1.5"


OPTIMAL = ('"0.987", "1.974", "1.480"', "4.441")


LONGER = ('"1.087", "2.074", "1.580"', "4.741")


@pytest.mark.parametrize(
    ("printed", "tail", "severity", "verdict"),
    [
        (OPTIMAL, "", Severity.INFO, ClaimVerdict.NOT_CHECKABLE),
        (LONGER, "", Severity.WARNING, ClaimVerdict.INCONSISTENT),
        (OPTIMAL, GAIN, Severity.ERROR, ClaimVerdict.INCONSISTENT),
    ],
)
def test_two_algorithms_that_print_the_optimum_print_alike(
    printed: tuple[str, str], tail: str, severity: Severity, verdict: ClaimVerdict
) -> None:
    durations, total = printed
    text = one_joint(STEPS, "1.9", "1", "optimal")
    text = text[: text.index("[[claims]]")]
    study = study_of(text + ALIKE.format(durations=durations, total=total, tail=tail))
    (found,) = said_of(study, judge_tables, None, "TG104")
    assert (found.severity, found.verdict) == (severity, verdict)
    assert ("which explains it" in found.message) == (severity is Severity.INFO)


RIVAL = """
[[claims]]
id = "rival"
quantity = "total_time"
where = "Table 4"
value = "0.700"
{curve}
"""


def test_a_rival_on_another_curve_stands_beside_no_optimum() -> None:
    """1 rad under 1.9 rad/s takes a quintic 0.987 s, and a cubic 0.789 s."""
    own = study_of(one_joint("0, 1", "1.9", "0.99", "optimal", RIVAL.format(curve="")))
    (found,) = said_of(own, judge_distances, "rival", "TG302")
    assert found.severity is Severity.WARNING
    named = RIVAL.format(curve='other_curve = "straight lines"')
    other = study_of(one_joint("0, 1", "1.9", "0.99", "optimal", named))
    assert not [f for f in judge_distances(other) if f.claim == "rival"]


PEAKS = """
[[claims]]
id = "p"
quantity = "peak"
where = "Table 5"
of = "d"
derivative = "velocity"
value = "{value}"
"""


@pytest.mark.parametrize(
    ("value", "verdict", "word"),
    [
        ("1.2500", "supported", "equal within the rounding"),
        ("1.2492", "supported", "as sampling the motion gives it"),  # 50 samples: 1.2490
        ("1.2489", "supported", "as sampling the motion gives it"),
        ("1.2510", "inconsistent", "off by more than"),
        ("0.625", "inconsistent", "off by more than"),
        ("71.6", "inconsistent", "ratio is near 57.2958"),
        ("1250", "inconsistent", "ratio is near 1000"),
        ("75.0", "inconsistent", "ratio is near 60"),
    ],
)
def test_a_peak_is_judged_by_the_class_of_its_distance(value: str, verdict: str, word: str) -> None:
    """2 rad in 3 s peak at 1.25 rad/s exactly."""
    study = study_of(one_joint("0, 2", "1.9", "3.00000", "optimal", PEAKS.format(value=value)))
    (found,) = said_of(study, judge_peaks, "p", "TG203")
    assert found.verdict == verdict
    assert word in found.message
    assert found.severity is (Severity.WARNING if verdict == "inconsistent" else Severity.INFO)


def test_digits_cut_off_are_no_other_peak() -> None:
    """2 rad in 2.1 s peak at 1.78571 rad/s, cut off to 1.785."""
    study = study_of(one_joint("0, 2", "1.9", "2.10000000", "optimal", PEAKS.format(value="1.785")))
    (found,) = said_of(study, judge_peaks, "p", "TG203")
    assert found.verdict is ClaimVerdict.SUPPORTED
    assert "cut off instead of rounded" in found.message


TOTAL = """
[[claims]]
id = "t"
quantity = "total_time"
where = "abstract"
value = "{}"
"""


@pytest.mark.parametrize(
    ("value", "severity"),
    [("0.9800", Severity.INFO), ("0.9868", Severity.INFO), ("0.9500", Severity.WARNING)],
)
def test_no_warning_where_the_rounding_of_way_points_explains_it(
    value: str, severity: Severity
) -> None:
    """Steps of 0.99 to 1.01 rad round to 0.00 and 1.00 and take 0.9770 to 0.9967 s."""
    text = one_joint('"0.00", "1.00"', "1.9", "0.99", "optimal", TOTAL.format(value))
    (found,) = said_of(study_of(text), judge_distances, "t", "TG302")
    assert found.severity is severity
    assert found.verdict is ClaimVerdict.NOT_CHECKABLE


@pytest.mark.parametrize(
    ("total", "verdict"),
    [("3.884", ClaimVerdict.SUPPORTED), ("3.880", ClaimVerdict.REFUTED)],
)
def test_durations_may_all_have_been_rounded_up(total: str, verdict: ClaimVerdict) -> None:
    """0.7767 s five times is 3.8835 s: printed as 0.777 s, so that each keeps its limit."""
    text = (
        QUESTION.format(points="0, 1, 2, 3, 4, 5", limit="2")
        + f"""
[[claims]]
id = "d"
quantity = "durations"
where = "Table 2"
durations = ["0.777", "0.777", "0.777", "0.778", "0.778"]
total = "{total}"
"""
    )
    (found,) = said_of(study_of(text), judge_digits, "d", "TG101")
    assert found.verdict is verdict
