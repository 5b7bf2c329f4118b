"""What a careless rule misses, or supports without ground."""

from typing import Any

import pytest
from support.findings import audited_text, finding, said_of, study_of, verdicts
from support.made_up import claim, entry, one_joint, paper, peak, row, sentence
from trajgap.compare.audits.card_errors import plainly
from trajgap.compare.audits.rules.stated_curve import meets
from trajgap.compare.documents import ClaimVerdict, Severity

# A quintic from rest to rest over d rad in h s peaks at 15 d/(8 h) rad/s: 0.98684 s under 1.9.


def at_rest(orders: list[int], **keys: Any) -> str:
    return claim("ends", "conditions", rest_at="ends", orders=orders, **keys)


@pytest.mark.parametrize(("orders", "verdict"), [([1], "supported"), ([2], "inconsistent")])
def test_rest_at_the_ends_is_evaluated(orders: list[int], verdict: str) -> None:
    """The natural cubic through 0, 60 and 0 degrees in 1 s each starts at 90 deg/s."""
    text = paper(
        [[0, 60, 0]],
        row("d", "1.00 1.00"),
        sentence("rest", "at_rest", "d"),
        at_rest([1], degrees=[3, 3]),
        curve={"family": "cubic-spline", "end_orders": orders},
        angle="deg",
        velocity=120,
    )
    for name in ("rest", "ends"):
        found = finding(text, name, "TG207")
        assert found.verdict == verdict
        assert ("a velocity of 90 °/s" in found.message) == (verdict == "inconsistent")


@pytest.mark.parametrize(("count", "fits"), [("16", True), ("18", False)])
def test_virtual_points_have_no_position_to_pass(count: str, fits: bool) -> None:
    """Four positions of segments at way-points, two joined ones, C2 at three breaks, v = a = 0 at
    two ends: 4 + 2 + 6 + 4 = 16."""
    ends = at_rest([1, 2], degrees=[3, 3, 3, 3], count=count)
    curve = {"family": "cubic-spline-virtual"}
    found = finding(paper([[0, 60, 0]], ends, curve=curve, velocity=120), "ends", "TG107")
    assert found.computed == "16 conditions for 16 coefficients"
    assert found.verdict == ("supported" if fits else "refuted")


@pytest.mark.parametrize(
    ("degree", "start", "end", "possible"),
    [
        (3, (1, 2), (), True),
        (3, (1, 2, 3), (), False),  # such a cubic is constant
        (3, (), (3,), True),  # a parabola
        (2, (), (2, 1), False),
        (5, (1, 2), (1, 2), True),
        (4, (1, 2), (1, 2), False),
        (4, (2, 3), (2,), True),
    ],
)
def test_ends_that_no_polynomial_meets(
    degree: int, start: tuple[int, ...], end: tuple[int, ...], possible: bool
) -> None:
    assert meets(degree, start, end) is possible


@pytest.mark.parametrize(
    ("points", "verdict"), [("0.1 0.9", "refuted"), ("0.4 0.5", "not checkable")]
)
def test_no_jerk_at_the_end_of_a_cubic_that_moves_is_impossible(points: str, verdict: str) -> None:
    """0.4 and 0.5 may both round from 0.45: there the cubic may stand still."""
    text = paper([points], at_rest([1, 2, 3], degrees=[3], continuity=2), velocity=1.9)
    assert finding(text, "ends", "TG107").verdict == verdict


@pytest.mark.parametrize(
    ("points", "time", "verdict"), [([0, 1], "0.40", "refuted"), ("0 1", "0.45", "not checkable")]
)
def test_a_broken_limit_refutes_without_an_optimum(points: Any, time: str, verdict: str) -> None:
    """At most 0.5 s are allowed, and 0.987 s are needed: no optimum, and 0.4 s break the limit."""
    parts = row("d", time), sentence("s", "optimal", "d")
    study = study_of(paper([points], *parts, bounds={"upper": 0.5}, velocity=1.9))
    assert not study.optimum(study.pairs[0]).found
    (found,) = said_of(study, "s", "TG302")
    assert found.verdict == verdict


@pytest.mark.parametrize(
    ("points", "times", "said"),
    [("0, 1", "0.5 0.4", "2 durations, but the curve has 1 segment"),
     ("0, 1, 2", "0.5", "1 duration, but the curve has 2 segments")],
)  # fmt: skip
def test_a_table_of_wrong_length_loads_and_is_found(points: str, times: str, said: str) -> None:
    one = audited_text(one_joint(points, "1.9", times, "within_limits"))
    (found,) = [f for f in one.findings if f.claim == "d" and f.rule == "TG109"]
    assert (found.verdict, found.severity) == (ClaimVerdict.INCONSISTENT, Severity.WARNING)
    assert not [f for f in one.findings if f.claim == "d" and f.rule == "TG201"]
    # A wrong count is not a proof.
    (cause,) = (c for c in one.causes if c.rule == "TG109")
    assert plainly(one.case, cause, brief=True) == (f"Table 2 prints {said}.",)


@pytest.mark.parametrize(
    ("total", "verdict", "word"),
    [
        ("2.2203", "supported", "is 2.2202 s digit by digit"),
        ("2.2202", "supported", "allows 2.2201 to 2.2203 s"),
        ("2.221", "supported", "fits only if it was rounded up"),  # 2.2202 to a millisecond
        ("2.219", "refuted", ""),
        ("2.222", "refuted", ""),
        ("2.2205", "refuted", ""),  # of as many digits as its parts: nothing to round up
    ],
)
def test_a_sum_at_the_edge_of_its_rounding(total: str, verdict: str, word: str) -> None:
    text = paper([[0, 1, 3]], row("d", "0.9601 1.2601", total=total), velocity=1.9)
    found = finding(text, "d", "TG101")
    assert found.verdict == verdict
    assert word in found.message
    assert (found.severity is Severity.WARNING) == ("up" in word)


@pytest.mark.parametrize(
    ("of", "value", "fits"),
    [("before", "1.2500", "d"), ("d", "1.5000", "before"), ("d", "1.7", None)],
)
def test_peaks_exchanged_between_rows_are_found(of: str, value: str, fits: str | None) -> None:
    """2 rad in 3 s peak at 1.25 rad/s, in 2.5 s at 1.5 rad/s."""
    rows = row("d", "3.0000") + row("before", "2.5000", state="before")
    study = study_of(paper([[0, 2]], rows, peak("p", of, "velocity", value), velocity=1.9))
    (own,) = said_of(study, "p", "TG203")
    assert own.verdict is ClaimVerdict.INCONSISTENT
    found = said_of(study, "p", "TG108")
    assert len(found) == (fits is not None)
    for one in found:
        assert (one.severity, one.decides) == (Severity.INFO, False)
        assert f"from that of {fits}" in one.message


TWO_JOINTS = [[0, 1], [0.5, 2.5]]


def test_peaks_of_each_joint_stand_in_one_claim() -> None:
    """Rest to rest by quintics in 2 s: 1.875/2 of the way."""
    text = paper(TWO_JOINTS, row("d", "2.0000"), velocity=9)
    values = ["0.9375", "1.8750"]
    right = text + peak("p", "d", "velocity", values)
    assert finding(right, "p", "TG203").verdict is ClaimVerdict.SUPPORTED
    study = study_of(text + peak("p", "d", "velocity", values[::-1]))
    (found,) = said_of(study, "p", "TG203")
    assert found.verdict is ClaimVerdict.INCONSISTENT
    (exchanged,) = said_of(study, "p", "TG108")
    assert "d, joint 2" in exchanged.message
    assert "d, joint 1" in exchanged.message


@pytest.mark.parametrize(("last", "found"), [("1.40", 1), ("1.41", 0)])
def test_equal_rows_under_two_names_are_found(last: str, found: int) -> None:
    rows = row("r1", f"0.91 1.25 {last}", joint="1") + row("r2", "0.91 1.25 1.40", joint="2")
    study = study_of(paper([[0, 1, 2, 3], [0.5, 1, 2.5, 3]], rows, velocity=9))
    said = said_of(study, "r2", "TG108")
    assert ["R1 and r2 print the same 3 durations" in one.message for one in said] == [True] * found


def test_a_row_that_fits_another_joint_is_found() -> None:
    """Steps of 1 and 2 rad under 1.9 rad/s take 0.98684 and 1.97368 s; the rows are exchanged."""
    rows = "".join(
        row(f"r{j}", time, joint=j, algorithm="x") for j, time in (("1", "1.9737"), ("2", "0.9869"))
    )
    named = entry("algorithms", id="x", name="x", kind="x")
    study = study_of(paper(TWO_JOINTS, rows, named, velocity=1.9))
    (found,) = said_of(study, "r2", "TG108")
    assert "fit those of joint 1 within" in found.message
    assert not said_of(study, "r1", "TG108")


def test_an_audit_of_odd_tables_ends() -> None:
    """Durations of another curve and of another number pass through everything that is computed."""
    odd = (
        row("rival", "0.3 0.4 0.5", other_curve="straight lines")
        + row("short", "0.9 0.4")
        + row("start", "2.00", state="before")
    )
    one = audited_text(one_joint("0, 1", "1.9", "0.99", "optimal", odd))
    assert verdicts(one)["rival"] is ClaimVerdict.NOT_CHECKABLE
    (rival,) = [j for j in one.judgements if j.claim == "rival"]
    assert "another curve (straight lines), and no motion is built" in rival.sentences[0]
    assert verdicts(one)["short"] is ClaimVerdict.INCONSISTENT
    assert [w.claim for w in one.waterfalls] == ["d"]
    assert one.errors == 0
