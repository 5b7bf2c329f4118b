"""One cause for what follows from it, and innocent explanations that the numbers allow."""

from __future__ import annotations

import pytest
from support.one_joint import HEAD
from support.studies import audited
from trajgap.compare import audit
from trajgap.compare.audits.case_audit import CaseAudit
from trajgap.compare.documents import CaveatKind, ClaimVerdict, Severity, qualified
from trajgap.problem import Printed, parse_case

TWO_SEGMENTS = HEAD.replace('durations = ["{time}"]', "durations = [{time}]\ntotal = {total}")


def judged(points: str, limit: str, time: str, total: str, checks: str) -> CaseAudit:
    text = TWO_SEGMENTS.format(points=points, limit=limit, time=time, total=total, checks=checks)
    return audit(parse_case(text, "made-up.toml"), seeds=2).cases[0]


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
    one = audited("puma560-mnam-pso-353")
    by = {j.claim: j for j in one.judgements}
    for claim in ("pso-longest", "mnam-longest", "mnam-total", "pso-joint-1", "limits-kept"):
        (said,) = by[claim].caveats
        assert said.kind is CaveatKind.DOUBTED
        assert said.text.startswith(
            "rests on numbers that other printed numbers contradict: Table 2"
        )
    assert by["pso-total"].verdict is ClaimVerdict.INCONSISTENT
    # Every curve of that kind meets them, whatever the durations.
    (built,) = by["conditions"].caveats
    assert built.kind is CaveatKind.BUILT
    assert [c.kind for c in by["smooth"].caveats] == [CaveatKind.BUILT]


def test_a_motion_and_a_scaling_law_that_refute_one_claim_are_one_error() -> None:
    one = audited("irb460-pso-353")
    (error,) = [c for c in one.causes if c.claim == "time-optimal"]
    # Neither follows from the other, and the printed times, one of which is too long, from none.
    assert {f.rule for f in one.findings if f.claim == "time-optimal"} == {"TG301", "TG302"}
    assert error.consequences == ()
    (broken,) = [c for c in one.causes if c.claim == "durations-110" and c.rule == "TG201"]
    assert [c.claim for c in broken.consequences] == ["limits-kept"]
    changes = [e.change for e in broken.explanations]
    assert changes[0] == "Durations 1 and 3 may have been exchanged in print."
    assert broken.explanations[0].effect == (
        "Then every limit is kept, under “way-points in radians”."
    )
    assert "0.4854 in place of 0.3854" in changes[1]


def test_what_was_judged_on_doubted_way_points_says_so() -> None:
    """Way-points of joint 5 repeat digits of positions, and do not lead to those positions."""
    one = audited("irb460-pso-353")
    by = {j.claim: j for j in one.judgements}
    for claim in ("durations-80", "durations-110", "limits-kept", "time-optimal"):
        (said,) = by[claim].caveats
        assert said.kind in (CaveatKind.POINTS, CaveatKind.SOME_POINTS)
        assert "repeat digits of Table 2" in said.text
        assert "the printed angles do not lead to the printed positions" in said.text
    assert qualified(by["durations-80"].verdict, by["durations-80"].beside) == (
        "supported, but on doubted way-points"
    )
    # The law of scaling refutes it whatever the way-points are.
    assert by["time-optimal"].caveats[0].text.startswith("partly rests on doubted way-points: ")
    # A count of conditions, and what any curve of the kind does, need no way-points.
    for claim in ("rest-at-all-points", "conditions-14", "continuous", "inverse-kinematics"):
        kinds = {c.kind for c in by[claim].caveats}
        assert not kinds & {CaveatKind.POINTS, CaveatKind.SOME_POINTS}


def test_rest_at_all_points_may_be_meant_of_the_ends() -> None:
    """The sentence leaves 18 conditions on 14 coefficients; another one counts 14."""
    one = audited("irb460-pso-353")
    (count,) = [c for c in one.causes if c.rule == "TG107"]
    (meant,) = count.explanations
    assert meant.change == "Section 4.2 may mean rest at the two ends only."
    assert (
        meant.effect
        == "Then there are 14 conditions on 14 coefficients, as section 4.3 counts them."
    )


CONDITIONS = """
[[claims]]
id = "rest"
quantity = "conditions"
where = "section 2"
rest_at = "all"
orders = [{orders}]
degrees = [3, 3]
continuity = 2
"""


@pytest.mark.parametrize(("orders", "offered"), [("1", 1), ("1, 2", 0)])
def test_rest_at_the_ends_is_offered_only_where_the_count_fits(orders: str, offered: int) -> None:
    """Two cubics have 8 coefficients: rest of velocity at the ends leaves 8 conditions, rest of
    acceleration too would leave 10."""
    one = judged('"0.00", "0.50", "1.00"', "90", '"1.00", "1.00"', '"2.00"', "within_limits")
    assert one.causes == ()
    text = TWO_SEGMENTS.format(
        points='"0.00", "0.50", "1.00"',
        limit="90",
        time='"1.00", "1.00"',
        total='"2.00"',
        checks="within_limits",
    )
    case = parse_case(text + CONDITIONS.format(orders=orders), "made-up.toml")
    (cause,) = audit(case, seeds=2).cases[0].causes
    assert cause.rule == "TG107"
    said = [e.effect for e in cause.explanations]
    assert said == ["Then there are 8 conditions on 8 coefficients."] * offered


def test_one_claim_under_many_readings_is_one_error() -> None:
    units = ("velocity", "deg/s"), ("acceleration", "deg/s^2"), ("jerk", "deg/s^3")
    readings = "".join(
        f'\n[[readings]]\nid = "r{k}"\nwhy = "a test"\nunits = {{ {name} = "{unit}" }}\n'
        for k, (name, unit) in enumerate(units)
    )
    text = HEAD.format(points="0, 1", limit="1.9496", time="0.5", checks="within_limits")
    one = audit(parse_case(text + readings, "made-up.toml"), seeds=2).cases[0]
    assert one.errors == 1
    (cause,) = one.causes
    assert cause.readings == ("r0", "r1", "r2")
    assert [(c.rule, c.claim) for c in cause.consequences] == [("TG201", "s")]


def test_exchanged_durations_are_the_first_explanation() -> None:
    """Rest to rest by quintics, 1.875 |Δq|/h: 3 rad in 3 s and 1 rad in 1 s keep 1.9 rad/s."""
    one = judged("0, 3, 4", "1.9", '"1.000", "3.000"', '"4.000"', "within_limits")
    (cause,) = one.causes
    first = cause.explanations[0]
    assert first.change == "Durations 1 and 2 may have been exchanged in print."
    assert first.effect == "Then every limit is kept."
    kept = judged("0, 3, 4", "1.9", '"3.000", "1.000"', '"4.000"', "within_limits")
    assert kept.causes == ()


def test_an_angle_is_tried_modulo_a_full_turn() -> None:
    """From 0.1 to 6.3 rad is 6.2 rad; from 0.1 to 6.3 − 2π it is 0.083 rad."""
    one = judged("0.1, 6.3", "1.9", '"1.00"', '"1.00"', "within_limits")
    said = [e for e in one.causes[0].explanations if "modulo a full turn" in e.change]
    assert len(said) == 1
    assert "6.38319 rad in place of 0.1 rad" in said[0].change
    assert said[0].effect == "Then every limit is kept."


def test_a_misprinted_digit_explains_a_sum() -> None:
    one = judged("0, 3, 4", "1.9", '"3.000", "1.000"', '"4.100"', "within_limits")
    (cause,) = one.causes
    assert cause.rule == "TG101"
    (said,) = cause.explanations
    assert "4.000 in place of 4.100" in said.change


def test_what_no_small_change_explains_has_no_explanation() -> None:
    one = judged("0, 3", "1.9", '"0.100"', '"0.100"', "within_limits")
    assert one.causes[0].explanations == ()


def test_one_digit_off_is_one_digit_or_two_neighbours_exchanged() -> None:
    off = {p.text for p in Printed("1.20").one_digit_off()}
    assert len(off) == 3 * 9 + 2  # 2.10 and 1.02 are the exchanges
    assert {"2.10", "1.02", "1.29", "9.20"} <= off
    assert "1.20" not in off


@pytest.mark.parametrize(("limit", "explained"), [("2.035", True), ("2.03", False)])
def test_limits_that_hold_at_samples_are_explained_by_them(limit: str, explained: bool) -> None:
    """A cubic spline peaks at 2.0431 rad/s, and at 2.0326 rad/s at ten steps a segment."""
    text = TWO_SEGMENTS.replace('family = "rest-to-rest"\ndegree = 5', 'family = "cubic-spline"')
    times = {"time": '"0.83000", "0.71000"', "total": '"1.54000"', "checks": "within_limits"}
    case = parse_case(text.format(points="0.1, 1.3, 0.9", limit=limit, **times), "made-up.toml")
    (cause,) = audit(case, seeds=2, certify_seconds=0).cases[0].causes
    assert cause.rule == "TG201"
    assert any("at ten steps a segment none" in e.change for e in cause.explanations) is explained
