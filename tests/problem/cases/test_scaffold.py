"""Case files written from a table of way-points."""

import re

import numpy as np
import pytest
from hypothesis import given, strategies as st
from support.refusals import Refusal, each_refusal
from trajgap.problem.cases.literature import LITERATURE
from trajgap.problem.cases.load import parse_case
from trajgap.problem.cases.scaffolding import scaffold, units_in_header
from trajgap.problem.errors import CaseError

RAD = {"position": "rad", "velocity": "rad/s", "acceleration": "rad/s^2"}


@pytest.fixture
def table(tmp_path):
    def write(text):
        path = tmp_path / "My table 1.csv"
        path.write_bytes(text if isinstance(text, bytes) else text.encode("utf-8"))
        return path

    return write


def test_a_labelled_table(table):
    path = table("point;q1;q2\nA;0.50;−1\n\nB;1;2\nC;1.25;0.3\nD;0;0\n")
    text = scaffold(path, RAD, velocity="6", acceleration=".5")
    case = parse_case(text, "x")
    assert case.id == "my-table-1"
    assert case.robot.joints == ("q1", "q2")
    assert case.document.waypoints.labels == ("A", "B", "C", "D")
    assert [n.text for n in case.document.waypoints.points[0]] == ["0.50", "-1"]
    problem = case.problem()
    np.testing.assert_array_equal(problem.waypoints, [[0.5, -1], [1, 2], [1.25, 0.3], [0, 0]])
    np.testing.assert_array_equal(problem.limits.velocity, [6, 6])
    np.testing.assert_array_equal(problem.limits.acceleration, [0.5, 0.5])
    assert problem.curve.degrees == (3, 5, 3)
    assert "trajgap" not in text
    assert '# jerk = "rad/s^3"' in text


def test_an_id_and_the_usual_curve(table):
    path = table("1\t2\t3\n10\t20\t30\n40\t50\t60\n")
    case = parse_case(scaffold(path, {"position": "deg", "time": "ms"}, case_id="mine"), "x")
    assert (case.id, case.problem().curve.degrees) == ("mine", (3,))


@pytest.mark.parametrize(
    ("text", "joints", "labels"),
    [
        ("q1 q2\n10 20\n30  40\n", ("q1", "q2"), ("1", "2")),
        ("q1,q2\r\n10,20\r\n30,40", ("q1", "q2"), ("1", "2")),
        ("q1\tq2\n10\t20\n30\t40\n", ("q1", "q2"), ("1", "2")),
        ("where;q1;q2\nA;10;20\nB;30;40\n", ("q1", "q2"), ("A", "B")),
        ("P q1 q2\nP1 10 20\nP2 30 40\n", ("q1", "q2"), ("P1", "P2")),
        ("No.,q1,q2\n1,10,20\n2,30,40\n", ("q1", "q2"), ("1", "2")),
        ("joint,A,B\nq1,10,30\nq2,20,40\n", ("q1", "q2"), ("A", "B")),
        ("Joint 1 2\nq1 10 30\nq2 20 40\n", ("q1", "q2"), ("1", "2")),
        ("point,1,2\nA,10,20\nB,30,40\n", ("1", "2"), ("A", "B")),
        ("1,2\n10,20\n30,40\n", ("1", "2"), ("1", "2")),
        ("q1 (°),q2 [deg]\n10,20\n30,40\n", ("q1", "q2"), ("1", "2")),
        ("θ1 /(°);θ2 (degrees)\n10;20\n30;40\n", ("θ1", "θ2"), ("1", "2")),
        ("q1 (left),q2 (N)\n10,20\n30,40\n", ("q1 (left)", "q2 (N)"), ("1", "2")),
    ],
)
def test_tables_of_many_forms_hold_the_same_way_points(table, text, joints, labels):
    said = []
    path = table(text)
    case = parse_case(scaffold(path, {"position": "deg"}, warn=said.append), "x")
    assert (case.robot.joints, case.document.waypoints.labels) == (joints, labels)
    points = np.rad2deg(case.problem().waypoints)
    np.testing.assert_allclose(points, [[10, 20], [30, 40]], rtol=0, atol=1e-9)
    # Numbers in their order are names, or a way-point whose header is missing.
    warned = f"{path}: line 1 is read as the names of the joints, 1, 2; if it is a way-point, "
    assert said == ([warned + "put a header above it"] if text.startswith("1") else [])
    assert units_in_header(path) == ("deg,deg" if "°" in text else "")
    if "°" in text:
        with pytest.raises(CaseError, match=r"line 1: states joint .1 in deg, but rad is the unit"):
            scaffold(path, RAD)


names = st.text(st.characters(codec="utf-8", exclude_characters=",;\t\r\n"), min_size=1)
numbers = st.decimals(-999, 999, places=3).map(str)


@given(st.lists(names, min_size=1, max_size=4), st.data())
def test_what_is_written_loads_or_the_table_is_refused(tmp_path_factory, joints, data):
    path = tmp_path_factory.mktemp("t") / "t.csv"
    rows = [[data.draw(numbers) for _ in joints] for _ in range(3)]
    lines = ["point," + ",".join(joints), *(f"p{k}," + ",".join(r) for k, r in enumerate(rows))]
    path.write_text("\n".join(lines), encoding="utf-8", newline="")
    try:
        case = parse_case(scaffold(path, RAD), "x")
    except CaseError as error:
        assert str(error).startswith(f"{path}: ")  # noqa: PT017
        return
    np.testing.assert_array_equal(case.problem().waypoints, np.array(rows, dtype=float))
    assert [j.strip() for j in joints] == list(case.robot.joints)


@each_refusal("tables")
def test_tables_that_are_refused(table, one: Refusal):
    path = table(one.text(""))
    one.said_by(lambda: scaffold(path, RAD), f"{path}: ")


@pytest.mark.parametrize(
    ("units", "options", "reason"),
    [
        ({}, {}, "units.position: is missing; give one of rad, deg, m, cm, mm"),
        ({"position": "rad"}, {"jerk": "9"}, "units.jerk: is missing; give one of rad/s^3"),
        ({"position": "rad/s"}, {}, "units.position: 'rad/s' measures velocity, not position"),
        ({"angle": "rad", "position": "rad"}, {}, "units.angle: no such quantity; known:"),
        (RAD, {"velocity": "-6"}, "velocity: -6 is negative; give 0 or more"),
        (RAD, {"velocity": "six"}, "velocity: 'six' is not a finite decimal number; write the"),
        (RAD, {"velocity": "1,2,3"}, "velocity: lists 3 numbers for 2 joints; give one for all"),
        (RAD, {"case_id": "My case"}, "case_id: 'My case' is not an id; use lower-case letters"),
        (RAD, {"family": "3-5-3"}, "family: 3-5-3 polynomials of 3 segments passes 4 way-points"),
        (RAD, {"family": "clamped"}, "family: 'clamped' is not known; did you mean clamped-b-spl"),
        (RAD, {"family": "bezier"}, "family: 'bezier' is not known; use one of 3-5-3"),
        (RAD, {"family": "rest-to-rest"}, "degree: is missing"),
        (RAD, {"durations": "1,x,2"}, "durations: 'x' is not a finite decimal number"),
        (RAD, {"durations": "1,2,3"}, "durations: lists 3 numbers, and the curve has 4 segments"),
        (RAD, {"durations": "1", "family": "rest-to-rest", "degree": 5}, "durations: lists 1 num"),
    ],
)
def test_options_that_are_refused(table, units, options, reason):
    path = table(points(5))
    with pytest.raises(CaseError) as caught:
        scaffold(path, units, **options)
    assert str(caught.value).startswith(reason)


def points(count):
    return "1,2\n" + "".join(f"0.{k}1,{k % 3}.5\n" for k in range(count))


def test_curves_without_a_shortest_motion_are_written_with_what_they_take(table):
    path = table(points(5))
    assert 'family = "cubic-spline-virtual"' in scaffold(path, RAD | {"jerk": "rad/s^3"}, jerk="9")
    text = scaffold(path, RAD, acceleration="8")
    assert 'family = "cubic-spline"  # cubic-spline-virtual has no shortest motion' in text
    assert parse_case(text, "x").document.units.velocity == "rad/s"  # for printed peaks
    assert "# jerk" in text
    text = scaffold(path, RAD, family="quintic-spline-virtual")
    assert "# no motion is the shortest unless [durations] has a lower bound" in text
    assert parse_case(text, "x").problem().segments == 6


def test_durations_without_decimals_carry_what_they_may_be(table):
    text = scaffold(table(points(4)), RAD, durations="1,2.0,3")
    assert '"3"]  # "1" may be 0.5 to 1.5; no quotes: exact' in text
    assert "no quotes" not in scaffold(table(points(4)), RAD, durations="1.0,2.0,3.0")


def test_limits_of_each_joint_and_printed_times_are_taken_as_given(table):
    printed = {"durations": "0.910, 1.35,1.10", "total": "3.36", "where": "Table 2"}
    text = scaffold(table(points(4)), RAD, velocity="6, 5.50", **printed)
    case = parse_case(text, "x")
    np.testing.assert_array_equal(case.problem().limits.velocity, [6, 5.5])
    (claim,) = case.claims
    assert [d.text for d in claim.durations] == ["0.910", "1.35", "1.10"]
    assert claim.total.text == "3.36"
    (alone,) = parse_case(scaffold(table(points(4)), RAD, total="3.36", where="x"), "x").claims
    assert (alone.quantity, alone.value.text) == ("total_time", "3.36")


def test_all_faults_of_table_and_arguments_are_named_at_once(table):
    path = table("a,b\n1,x\n3\n")
    with pytest.raises(CaseError) as caught:
        scaffold(path, {}, family="bezier", velocity="6", jerk="1,2,3", durations="y")
    assert str(caught.value).startswith(f"{path}: line 2, column 2: 'x' is not a finite")
    fields = [field for field, _ in caught.value.faults]
    units = [f"units.{name}" for name in ("position", "velocity", "jerk")]
    assert fields == ["line 2, column 2", "line 3", *units, "durations", "jerk", "family"]


@pytest.mark.parametrize(
    ("unit", "rows", "written", "remark"),
    [
        ("deg", "-10,90\n60,0\n", [["-10", "90"], ["60", "0"]], "count as exact"),
        ("rad", "1,0\n2,-3\n", [["1", "0"], ["2", "-3"]], "count as exact"),
        ("deg", "12.5,0\n−35,7.0\n", [['"12.5"', "0"], ["-35", '"7.0"']], "count as exact"),
        ("deg", "37,90\n112,0\n", [['"37"', '"90"'], ['"112"', '"0"']], '"37" may be 36.5 to'),
        ("rad", "0.50,1.00\n2.10,0.00\n", [['"0.50"', '"1.00"'], ['"2.10"', '"0.00"']], None),
    ],
)
def test_settings_are_bare_and_what_may_be_rounded_is_quoted(table, unit, rows, written, remark):
    """Quotes are an interval: -10 degrees in quotes would be all from -10.5 to -9.5 degrees."""
    text = scaffold(table("a,b\n" + rows), {"position": unit}, family="cubic-spline")
    assert [f"  [{', '.join(row)}]," in text for row in written] == [True, True]
    bare = [[not number.startswith('"') for number in row] for row in written]
    points = parse_case(text, "x").document.waypoints.points
    assert [[number.exact for number in row] for row in points] == bare
    assert ("exact" in text.split("[waypoints]")[1].split("[limits]")[0]) == (remark is not None)
    assert remark is None or remark in text


@pytest.fixture
def declared(table):
    """The curve of a case that `scaffold` writes for so many way-points under a name."""

    def declare(name, count):
        text = scaffold(table(points(count)), {"position": "rad"}, family=name)
        assert f"# what papers call {name}" in text or f'family = "{name}"' in text
        return parse_case(text, "x").problem().curve

    return declare


@pytest.mark.parametrize("name", LITERATURE)
def test_every_name_of_the_literature_declares_a_curve(declared, name):
    curve = declared(name, 4)
    assert curve.segments >= 3
    orders = {"natural-cubic": 2, "clamped-cubic": 1}
    if name in orders:
        assert curve.ends == (((orders[name], 0.0),),) * 2


@pytest.mark.parametrize(
    ("name", "count", "degrees"),
    [
        ("virtual-cubic-spline", 4, (3,) * 5),
        ("cubic spline with two virtual points", 4, (3,) * 5),
        ("cubic spline with 2 virtual knots", 4, (3,) * 5),
        ("Natural cubic splines", 5, (3,) * 4),
        ("natural spline", 5, (3,) * 4),
        ("C2 cubic spline", 5, (3,) * 4),
        ("C4 quintic spline", 5, (5,) * 4),
        ("quintic spline", 5, (5,) * 4),
        ("clamped cubic spline", 5, (3,) * 4),
        ("fifth-order B-spline", 6, (5,) * 5),
        ("quintic B splines", 6, (5,) * 5),
        ("5th-degree polynomial", 3, (5, 5)),
        ("quintic polynomial", 3, (5, 5)),
        ("3-4-5 polynomial", 2, (5,)),
        ("4-5-6-7 polynomial", 2, (7,)),
        ("seventh-order polynomial", 2, (7,)),
        ("3-5-3 polynomials", 4, (3, 5, 3)),
        ("353", 4, (3, 5, 3)),
        ("4-3-4", 4, (4, 3, 4)),
        ("septic-polynomials", 4, (7, 7, 7)),
        ("4-3-3-3-4", 6, (4, 3, 3, 3, 4)),
        ("4–3–3–4 spline", 5, (4, 3, 3, 4)),
        ("5-3-3-3-5", 6, (5, 3, 3, 3, 5)),
        ("5-5-5", 4, (5, 5, 5)),
    ],
)  # fmt: skip
def test_a_name_declares_the_curve_that_it_means(declared, name, count, degrees):
    curve = declared(name, count)
    assert (curve.degrees, curve.free) == (degrees, 0)


def test_degrees_that_are_not_settled_are_left_open(declared, table):
    """27 coefficients, and conditions that are alike at both ends and at all joints: 22 by hand."""
    curve = declared("5-4-4-4-5", 6)
    assert (curve.degrees, curve.free) == ((5, 4, 4, 4, 5), 27 - (10 + 8 + 4))
    text = scaffold(table(points(6)), {"position": "rad"}, family="5-4-4-4-5")
    assert "27 coefficients and 22 conditions: say what settles the other 5" in text


def test_b_splines_are_told_apart(declared):
    assert declared("septic B-spline", 8).name.startswith("clamped B-spline of degree 7")
    assert declared("uniform cubic B-spline", 5).name == declared("uniform-cubic-b-spline", 5).name


UNKNOWN = (
    *("trigonometric spline", "Bezier", "NURBS", "cubic Hermite spline", "exponential spline", ""),
    *("cycloidal", "spline with three virtual points", "Akima spline", "x"),
)
PROFILES = (
    *("LSPB", "parabolic blends", "trapezoidal velocity profile", "S-curve", "double S"),
    *("sine-jerk", "sinusoidal jerk profile"),
)
SEVERAL = {
    "quintic": "quintic-b-spline or quintic-polynomials or quintic-spline? All: ",
    "clamped": "clamped-b-spline or clamped-cubic? All: ",
    "quintc-spline": "quintic-spline? All: ",
    "virtual": "cubic-spline-virtual or quintic-spline-virtual? All: ",
    "cubic": "clamped-cubic or cubic-b-spline or cubic-polynomials or cubic-spline or natural",
}


@pytest.mark.parametrize(
    ("name", "said"),
    [
        *((name, f"{name!r} is not known; use one of 3-5-3, ") for name in UNKNOWN),
        *((name, f"{name!r} is not known; did you mean {all}") for name, all in SEVERAL.items()),
        *((name, "is a profile from rest to rest, not a curve through") for name in PROFILES),
    ],
)
def test_what_is_not_known_is_answered_with_what_may_be_meant(declared, name, said):
    with pytest.raises(CaseError, match=re.escape(said)) as caught:
        declared(name, 4)
    ((field, reason),) = caught.value.faults
    assert field == "family"
    assert name not in UNKNOWN or "degrees such as 4-3-3-4" in reason


def test_a_case_file_that_names_a_curve_as_papers_do_is_shown_how_to_write_it(table):
    text = scaffold(table(points(6)), {"position": "rad"}, family="cubic-spline")
    for name, written in (
        ("virtual-cubic-spline", 'write family = "cubic-spline-virtual"'),
        ("4-3-3-3-4", 'write family = "polynomials", degrees = [4, 3, 3, 3, 4]'),
    ):
        with pytest.raises(CaseError) as caught:
            parse_case(text.replace('"cubic-spline"', f'"{name}"'), "x")
        ((field, reason),) = caught.value.faults
        assert (field, reason) == ("interpolant.family", f"{name!r} is not allowed; {written}")


PRINTED = {
    "durations and total": {"durations": "1.0,2.0,3.0", "total": "6.0", "where": "Table 3"},
    "durations": {"durations": "1.0,2.0,3.0", "where": "Table 3"},
    "total": {"total": "6.0", "where": "Table 3"},
    "nothing": {},
}
"""What a paper prints of times, as `trajgap new` is told."""


@pytest.fixture
def small(table):
    return table("1,2\n0.11,0.5\n0.21,1.5\n0.31,2.5\n0.41,0.5\n")


def blocks(text):
    """Paragraphs of commented blocks, the prose above each left out of none."""
    return [part for part in text.split("\n\n") if re.search(r"^# \[\[claims\]\]", part, re.M)]


def uncommented(block):
    """A block as an editor uncomments it: one mark off every line, the prose above it too."""
    return "\n".join(re.sub("^# ?", "", line, count=1) for line in block.splitlines())


def filled(block):
    """Its blanks filled in: digits of numbers, words of places."""
    block = block.replace('durations = [""]', 'durations = ["1.0", "2.0", "3.0"]')
    block = re.sub(r'^(value|percent) = ""', r'\1 = "7.98"', block, flags=re.M)
    return re.sub(r'= ""', '= "section 4"', block)


@pytest.mark.parametrize("printed", PRINTED.values(), ids=PRINTED)
@pytest.mark.parametrize("units", [RAD, {"position": "rad"}], ids=["units", "no units"])
def test_blocks_load_each_by_itself_and_all_together(small, printed, units):
    text = scaffold(small, units, **printed)
    if units == RAD:
        every = text
        for block in blocks(text):
            every = every.replace(block, filled(uncommented(block)))
        quantities = {claim.quantity for claim in parse_case(every, "x").claims}
        wanted = {"durations", "total_time", "improvement", "peak", "measure", "value"}
        assert {*wanted, "statement"} <= quantities
    found = blocks(text)
    assert len(found) >= 7
    if not printed:  # then the first is what all others are about
        first = filled(uncommented(found[0]))
        assert parse_case(text.replace(found[0], first), "x").claims[0].quantity == "durations"
        text = text.replace(found.pop(0), first)
    for block in found:
        whole = text.replace(block, filled(uncommented(block)))
        if "derivative" in block and "velocity" not in units:
            assert "its unit under [units]" in block
            whole = whole.replace('# velocity = "rad/s"', 'velocity = "rad/s"')
        case = parse_case(whole, "x")
        assert len(case.claims) > 1, block


def test_a_peak_and_a_mean_name_durations_and_never_a_total(small):
    def of(printed):
        text = scaffold(small, RAD, **printed)
        return [b.count('# of = "durations"') for b in blocks(text) if "derivative" in b]

    assert of(PRINTED["durations"]) == [1, 1, 1]
    assert of(PRINTED["total"]) == [0, 0, 0]


@pytest.mark.parametrize("printed", PRINTED.values(), ids=PRINTED)
def test_a_blank_that_is_left_is_refused_in_its_place(small, printed):
    """A number or a place that nobody typed must never stand in a case as if the paper had it."""
    text = scaffold(small, RAD, **printed)
    found = blocks(text)
    if not printed:
        text = text.replace(found[0], filled(uncommented(found[0])))
    for block in found[0 if printed else 1 :]:
        with pytest.raises(CaseError, match=r"claims\[\d\]\.(where|value|durations)"):
            parse_case(text.replace(block, uncommented(block)), "x")


def test_a_place_that_is_not_given_is_said_to_be_none_and_no_number_made_up(small):
    for printed in ({"durations": "1.0,2.0,3.0"}, {"total": "6.0"}, PRINTED["durations and total"]):
        text = scaffold(small, RAD, **{k: v for k, v in printed.items() if k != "where"})
        (claim,) = parse_case(text, "x").claims
        assert claim.where == "a place not stated"
        assert re.findall(r'^#? ?where = "([^"]+)"', text, re.M) == ["a place not stated"]
        for block in blocks(text):
            assert not re.search(r"[0-9]\.[0-9]", block), block


def test_a_row_is_as_long_as_the_curve_has_segments(small):
    """Two virtual way-points make two segments more than the way-points have ways between them."""
    assert 'durations = [""]  # 5 numbers' in scaffold(small, RAD, family="cubic-spline-virtual")
    assert 'durations = [""]  # 3 numbers' in scaffold(small, RAD, family="3-5-3")


def test_a_blank_number_is_called_one(small):
    text = scaffold(small, RAD, where="Table 2", total="6.0").replace('"6.0"', '""')
    with pytest.raises(CaseError, match=r"value: is empty; write the printed digits, such as"):
        parse_case(text, "x")
