"""One cause for what follows from it, and innocent explanations that the numbers allow."""

from typing import Any

import pytest
from support.findings import audited_text, report_of
from support.made_up import CUBIC, Numbers, claim, entry, one_joint, paper, readings, row, sentence
from support.studies import audited
from trajgap.compare.audits.case_audit import CaseAudit
from trajgap.compare.documents import CaveatKind, ClaimVerdict, Severity, qualified
from trajgap.problem import parse_case


def judged(
    points: Numbers, limit: Any, times: str, total: str, *more: str, **keys: Any
) -> CaseAudit:
    """A row that is said to keep the limits, audited."""
    parts = row("d", times, total=total), sentence("s", "within_limits", "d"), *more
    return audited_text(paper([points], *parts, **({"velocity": limit} | keys)))


def test_what_follows_from_two_tables_alike_is_one_error() -> None:
    one = audited("puma560-mnam-pso-353")
    errors = [c for c in one.causes if c.severity is Severity.ERROR]
    assert one.errors == one.document.errors == len(errors) == 2
    (error,) = [c for c in errors if c.claim != "time-optimal"]
    assert error.rule == "TG104"
    assert "agree in all 28 numbers" in error.says
    followed = [(c.rule, c.claim) for c in error.consequences]
    joints = [("TG103", f"better-fitness-joint-{j}") for j in (1, 2, 3)]
    assert set(followed) == {("TG103", "improvement"), ("TG105", "pso-total"), *joints}
    assert len(followed) == len(set(followed))
    (innocent,) = error.explanations
    assert innocent.change == "One table may have been printed twice by mistake."


def test_neither_side_of_a_contradiction_in_print_is_taken() -> None:
    """3.961 s stands in the text and 3.528 s in a table that equals another table."""
    by = {j.claim: j for j in audited("puma560-mnam-pso-353").judgements}
    for name in ("pso-longest", "mnam-longest", "mnam-total", "pso-joint-1", "limits-kept"):
        (said,) = by[name].caveats
        assert said.kind is CaveatKind.DOUBTED
        assert "Table 2" in said.why
    assert by["pso-total"].verdict is ClaimVerdict.INCONSISTENT
    # Every curve of that kind meets them, whatever the durations.
    for name in ("conditions", "smooth"):
        assert [c.kind for c in by[name].caveats] == [CaveatKind.BUILT]


def test_a_motion_and_a_scaling_law_that_refute_one_claim_are_one_error() -> None:
    one = audited("irb460-pso-353")
    (error,) = [c for c in one.causes if c.claim == "time-optimal"]
    # Neither follows from the other, and the printed times, one of which is too long, from none.
    assert {f.rule for f in one.findings if f.claim == "time-optimal"} == {"TG301", "TG302"}
    assert error.consequences == ()
    (broken,) = [c for c in one.causes if c.claim == "durations-110" and c.rule == "TG201"]
    assert [c.claim for c in broken.consequences] == ["limits-kept"]
    effects = {e.change: e.effect for e in broken.explanations}
    # Joint 5 reaches 119.07 °/s; the exchange keeps 110 °/s and does not reach it.
    first, *others = effects
    assert first == "The limit of velocity is printed as 110, perhaps for 119."
    assert "every limit is kept within rounding and one is reached" in effects[first]
    assert "Durations 1 and 3 may have been exchanged in print." in others


def test_what_was_judged_on_doubted_way_points_says_so() -> None:
    """Way-points of joint 5 repeat digits of positions, and do not lead to those positions."""
    by = {j.claim: j for j in audited("irb460-pso-353").judgements}
    for name in ("durations-80", "durations-110", "limits-kept", "time-optimal"):
        (said,) = by[name].caveats
        assert said.kind in (CaveatKind.POINTS, CaveatKind.SOME_POINTS)
        assert "Table 2" in said.why
    assert qualified(by["durations-80"].verdict, by["durations-80"].beside) == (
        "supported, but on doubtful way-points"
    )
    # The law of scaling refutes it whatever the way-points are.
    assert by["time-optimal"].caveats[0].kind is CaveatKind.SOME_POINTS
    # A count of conditions, and what any curve of the kind does, need no way-points.
    for name in ("rest-at-all-points", "conditions-14", "continuous", "inverse-kinematics"):
        kinds = {c.kind for c in by[name].caveats}
        assert not kinds & {CaveatKind.POINTS, CaveatKind.SOME_POINTS}


def test_rest_at_all_points_may_be_meant_of_the_ends() -> None:
    """The sentence leaves 18 conditions, but only 14 coefficients; another one counts 14."""
    (count,) = [c for c in audited("irb460-pso-353").causes if c.rule == "TG107"]
    (meant,) = count.explanations
    assert meant.change == "Section 4.2 may mean rest at the two ends only."
    assert "14 conditions for 14 coefficients, as section 4.3 counts them" in meant.effect


@pytest.mark.parametrize(("orders", "offered"), [([1], 1), ([1, 2], 0)])
def test_rest_at_the_ends_is_offered_where_the_count_fits(orders: list[int], offered: int) -> None:
    """Two cubics have 8 coefficients: rest of velocity at the ends leaves 8 conditions, rest of
    acceleration too would leave 10."""
    given = "0.00 0.50 1.00", 90, "1.00 1.00", "2.00"
    assert judged(*given).causes == ()
    keys = {"rest_at": "all", "orders": orders, "degrees": [3, 3], "continuity": 2}
    (cause,) = judged(*given, claim("rest", "conditions", **keys)).causes
    assert cause.rule == "TG107"
    said = [e.effect for e in cause.explanations]
    assert said == ["Then there are 8 conditions for 8 coefficients."] * offered


def test_one_claim_under_many_readings_is_one_error() -> None:
    units = ("velocity", "deg/s"), ("acceleration", "deg/s^2"), ("jerk", "deg/s^3")
    more = readings(**{f"r{k}": {"units": dict([unit])} for k, unit in enumerate(units)})
    one = audited_text(one_joint("0, 1", "1.9496", "0.5", "within_limits", more))
    assert one.errors == 1
    (cause,) = one.causes
    assert cause.readings == ("r0", "r1", "r2")
    assert [(c.rule, c.claim) for c in cause.consequences] == [("TG201", "s")]


def test_what_is_too_long_is_told_by_the_least_distance_of_all_readings() -> None:
    """A quintic over 1 rad takes 15/(8 v): 0.8 or 1 s, where 1.95 to 2.05 s are printed."""
    more = readings(fast={"limits": {"velocity": 2.34375}}, slow={})
    one = audited_text(one_joint("0, 1", "1.875", "2.0", "optimal", more))
    (gap,) = [c.head.gap for c in one.causes if c.head and c.head.kind == "longer"]
    assert gap.highest == pytest.approx(2.05 / 1.0 - 1, rel=1e-3)


def test_a_longest_duration_of_another_row_is_named() -> None:
    """Joints that need 2, 1, 2 s and 1, 2, 1 s; the last row takes 1 s instead of 2 s."""
    last = {"durations": ["2.000", "1.000", "2.000"], "total": "6.000"}
    text = paper(
        [[0, 2, 3, 5], [0, 1, 3, 4]],
        row("a", "2.000 1.000 2.000", joint="1"),
        row("b", "1.000 2.000 1.000", joint="2"),
        claim("m", "maximum", of=["a", "b"], **last),
        sentence("k", "within_limits", "m"),
        curve=CUBIC,
        head={"coupling": "per-joint"},
        velocity=1.5,
    )
    errors = [c for c in audited_text(text).causes if c.severity is Severity.ERROR]
    assert {c.rule for c in errors} == {"TG101", "TG102", "TG201"}
    for error in errors:
        assert error.explanations[0].change == (
            "The duration of segment 2 may have been taken from another row: 2.000 instead of "
            "1.000."
        )


def test_exchanged_durations_are_the_first_explanation() -> None:
    """Rest to rest by quintics, 1.875 |Δq|/h: 3 rad in 3 s and 1 rad in 1 s keep 1.9 rad/s."""
    (cause,) = judged([0, 3, 4], 1.9, "1.000 3.000", "4.000").causes
    first = cause.explanations[0]
    assert first.change == "Durations 1 and 2 may have been exchanged in print."
    assert first.effect == "Then every limit is kept."
    assert judged([0, 3, 4], 1.9, "3.000 1.000", "4.000").causes == ()


def test_an_angle_is_tried_modulo_a_full_turn() -> None:
    """From 0.1 to 6.3 rad is 6.2 rad; from 0.1 to 6.3 − 2π it is 0.083 rad."""
    one = judged([0.1, 6.3], 1.9, "1.00", "1.00")
    said = [e for e in one.causes[0].explanations if "modulo a full turn" in e.change]
    assert [e.effect for e in said] == ["Then every limit is kept."] * 2
    assert {e.change.split(": ")[1] for e in said} == {
        "6.38319 rad instead of 0.1 rad.",
        "0.0168147 rad instead of 6.3 rad.",
    }


def test_a_misprinted_digit_explains_a_sum() -> None:
    (cause,) = judged([0, 3, 4], 1.9, "3.000 1.000", "4.100").causes
    assert cause.rule == "TG101"
    said = {e.change.rpartition(" for ")[2] for e in cause.explanations}
    assert said == {"4.000.", "3.100.", "1.100."}
    effects = {e.effect for e in cause.explanations}
    assert effects == {"Then the printed total is the sum of its parts."}


def test_what_explains_one_row_does_not_speak_for_another() -> None:
    """A quintic over 3 rad keeps 1.9 rad/s in 2.9605 s: 2.350 s exceed it by 26 %."""
    other = row("e", "2.350 1.210", total="3.560"), sentence("k", "within_limits", "d", "e")
    one = judged([0, 3, 4.2], 1.9, "2.062 1.190", "4.152", *other)
    by = {(c.rule, c.claim): c for c in one.causes}
    (first, *_) = by["TG201", "d"].explanations
    assert first.change.endswith("is printed as 2.062, perhaps for 2.962.")
    assert first.effect == (
        "Then the durations in d keep every limit, one is reached and the printed total is "
        "the sum of its parts; those in e still break one."
    )
    assert not any("every limit is kept" in e.effect for c in by.values() for e in c.explanations)


@pytest.mark.parametrize(
    ("limit", "end", "named"),
    [
        # 15/8 of 1 rad in 1.5 s is 1.25 rad/s; of 1.4 rad it would be 1.75 rad/s.
        (
            "0.125",
            "1.20",
            "The limit of velocity of joint 1 is printed as 0.125, perhaps for ",
        ),
        ("1.25", "2.20", "Way-point B of joint 1 is printed as 2.20, perhaps for 1.20."),
        ("1.25", "120", "Way-point B of joint 1 is printed as 120, perhaps for 1.20."),
        ("1.25", "-1.20", "Way-point B of joint 1 is printed as -1.20, perhaps for 1.20."),
    ],
)
def test_a_misprint_is_found_where_the_reading_has_it(limit: str, end: str, named: str) -> None:
    points = {"labels": ["A", "B"], "joint_rows": [["0.20", end], ["0.30", "0.90"]]}
    text = paper(
        ["0.10 1.10", "0.30 0.90"],
        entry("problems", id="slow", limits={"velocity": [float(limit), 3]}),
        readings(plain={}, other={"waypoints": points}),
        row("d", "1.500", problem="slow"),
        sentence("s", "within_limits", "d"),
    )
    (found,) = report_of(parse_case(text, "made-up.toml"), reading="other").cases
    (cause,) = (c for c in found.causes if c.rule == "TG201")
    said = [e.effect for e in cause.explanations if e.change.startswith(named)]
    assert len(said) == 1
    assert "and one is reached" in said[0]


def test_what_no_small_change_explains_has_no_explanation() -> None:
    assert judged([0, 3], 1.9, "0.100", "0.100").causes[0].explanations == ()


@pytest.mark.parametrize(("limit", "said"), [(2.035, True), (2.03, False)])
def test_limits_that_hold_at_samples_are_explained_by_them(limit: float, said: bool) -> None:
    """A cubic spline peaks at 2.0431 rad/s, and at 2.0326 rad/s at ten steps a segment."""
    curve = {"family": "cubic-spline"}
    one = judged([0.1, 1.3, 0.9], limit, "0.83000 0.71000", "1.54000", curve=curve)
    (cause,) = one.causes
    assert cause.rule == "TG201"
    assert any("at ten samples per segment none" in e.change for e in cause.explanations) is said
