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
    effects = {e.change: e.effect for e in broken.explanations}
    # Joint 5 reaches 119.07 °/s; the exchange keeps 110 °/s and does not reach it.
    first, *others = effects
    assert first == "The limit of velocity may be misprinted: 119 in place of 110."
    kept = "Then every limit is kept within rounding and one is reached"
    assert effects[first] == f"{kept}, under “way-points in radians”."
    assert "Durations 1 and 3 may have been exchanged in print." in others


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


def test_a_longest_duration_of_another_row_is_named() -> None:
    """Joints that need 2, 1, 2 s and 1, 2, 1 s; the last row takes 1 s in place of 2 s."""
    rows = {"a": ("2.000", "1.000", "2.000"), "b": ("1.000", "2.000", "1.000")}
    text = """format = 1
id = "rows"
title = "Two joints"
coupling = "per-joint"
source = { note = "Made up." }
robot = { name = "two joints", joints = ["a", "b"] }
units = { position = "rad", velocity = "rad/s", time = "s" }
waypoints = { joint_rows = [[0, 2, 3, 5], [0, 1, 3, 4]] }
limits = { velocity = 1.5 }
interpolant = { family = "rest-to-rest", degree = 3 }
"""
    claim = '[[claims]]\nid = "{}"\nwhere = "row {}"\n{}\n'
    for joint, times in rows.items():
        told = f'quantity = "durations"\njoint = "{joint}"\ndurations = {list(times)}'
        text += claim.format(joint, joint, told)
    text += claim.format(
        "m",
        "m",
        'quantity = "maximum"\nof = ["a", "b"]\n'
        'durations = ["2.000", "1.000", "2.000"]\ntotal = "6.000"',
    ) + claim.format("k", "text", 'quantity = "statement"\nchecks = "within_limits"\nof = ["m"]')
    one = audit(parse_case(text, "made-up.toml"), seeds=2).cases[0]
    errors = [c for c in one.causes if c.severity is Severity.ERROR]
    assert {c.rule for c in errors} == {"TG101", "TG102", "TG201"}
    for error in errors:
        assert error.explanations[0].change == (
            "The duration of segment 2 may have been taken from another row: 2.000 in place of "
            "1.000."
        )


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
    assert [e.effect for e in said] == ["Then every limit is kept."] * 2
    assert {e.change.split(": ")[1] for e in said} == {
        "6.38319 rad in place of 0.1 rad.",
        "0.0168147 rad in place of 6.3 rad.",
    }


def test_a_misprinted_digit_explains_a_sum() -> None:
    one = judged("0, 3, 4", "1.9", '"3.000", "1.000"', '"4.100"', "within_limits")
    (cause,) = one.causes
    assert cause.rule == "TG101"
    said = {e.change.split(": ")[1].split(" ")[0] for e in cause.explanations}
    assert said == {"4.000", "3.100", "1.100"}
    effects = {e.effect for e in cause.explanations}
    assert effects == {"Then the printed total is the sum of its parts."}


SECOND = """
[[claims]]
id = "e"
quantity = "durations"
where = "Table 3"
durations = ["2.350", "1.210"]
total = "3.560"
"""


def test_what_explains_one_row_does_not_speak_for_another() -> None:
    """A quintic over 3 rad keeps 1.9 rad/s in 2.9605 s: 2.350 s exceed it by 26 %."""
    text = TWO_SEGMENTS.replace('of = ["d"]', 'of = ["d", "e"]') + SECOND
    times = {"time": '"2.062", "1.190"', "total": '"4.152"', "checks": "within_limits"}
    case = parse_case(text.format(points="0, 3, 4.2", limit="1.9", **times), "made-up.toml")
    by = {(c.rule, c.claim): c for c in audit(case, seeds=2, certify_seconds=0).cases[0].causes}
    (first, *_) = by["TG201", "d"].explanations
    assert first.change.endswith("misprinted: 2.962 in place of 2.062.")
    assert first.effect == (
        "Then the durations in Table 2 keep every limit, one is reached and the printed total is "
        "the sum of its parts; those in Table 3 still break one."
    )
    assert not any("every limit is kept" in e.effect for c in by.values() for e in c.explanations)


LAYERS = """
format = 1
id = "layers"
title = "limits in a problem, way-points in a reading"
[source]
year = 2024
[robot]
name = "arm"
joints = ["1", "2"]
[units]
position = "rad"
velocity = "rad/s"
time = "s"
[waypoints]
waypoint_rows = [["0.10", "0.30"], ["1.10", "0.90"]]
[interpolant]
family = "rest-to-rest"
degree = 5
[[problems]]
id = "slow"
limits = {{ velocity = [{limit}, 3] }}
[[readings]]
id = "plain"
why = "as printed"
[[readings]]
id = "other"
why = "another column"
waypoints = {{ labels = ["A", "B"], joint_rows = [["0.20", "{end}"], ["0.30", "0.90"]] }}
[[claims]]
id = "d"
quantity = "durations"
where = "Table 2"
problem = "slow"
durations = ["1.500"]
[[claims]]
id = "s"
quantity = "statement"
where = "abstract"
checks = "within_limits"
of = ["d"]
"""


@pytest.mark.parametrize(
    ("limit", "end", "named"),
    [
        # 15/8 of 1 rad in 1.5 s is 1.25 rad/s; of 1.4 rad it would be 1.75 rad/s.
        ("0.125", "1.20", "The limit of velocity of joint 1 may be misprinted: 1.25 in place"),
        ("1.25", "2.20", "Way-point B of joint 1 may be misprinted: 1.20 in place of 2.20."),
        ("1.25", "120", "Way-point B of joint 1 may be misprinted: 1.20 in place of 120."),
        ("1.25", "-1.20", "Way-point B of joint 1 may be misprinted: 1.20 in place of -1.20."),
    ],
)
def test_a_misprint_is_found_where_the_reading_takes_the_number(
    limit: str, end: str, named: str
) -> None:
    case = parse_case(LAYERS.format(limit=limit, end=end), "made-up.toml")
    found = audit(case, seeds=2, certify_seconds=0, reading="other").cases[0]
    (cause,) = (c for c in found.causes if c.rule == "TG201")
    said = [e.effect for e in cause.explanations if e.change.startswith(named)]
    assert len(said) == 1
    assert "and one is reached" in said[0]


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
