"""Everything that can be wrong in a case file, and the one line that says so."""
# ruff: noqa: E501

from __future__ import annotations

import copy
import tomllib
from decimal import Decimal
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from support.base_case import BASE
from support.checkout import ROOT
from trajgap.problem.cases.claim import QUANTITY_KINDS
from trajgap.problem.cases.faults import all_faults, refusal
from trajgap.problem.cases.load import check_case, load_case, parse_case
from trajgap.problem.cases.schema import CaseFile
from trajgap.problem.cases.statement import _LARGEST
from trajgap.problem.errors import CaseError
from trajgap.problem.textfile import read_text

# What to change in the base case, and the line that must come of it.
FAULTS = [
    (("format = 1", "format = 2"), "format: is 2; this version reads 1"),
    (("format = 1", "format = true"), "format: is True; this version reads 1"),
    (("format = 1\n", ""), "format: is missing; add `format = 1`"),
    (('title = "Base"', 'titel = "Base"'), "titel: unknown key; did you mean 'title'?"),
    (("[limits]\nvelocity", "[limits]\nvelocty"), "limits.velocty: unknown key; did you mean 'velocity'?"),
    (('checks = "continuous"', 'check = "continuous"'), "claims[4].check: unknown key; did you mean 'checks'?"),
    (('kind = "pso"', 'kind = ""'), "algorithms[0].kind: is empty; fill it in or leave the key out"),
    (('kind = "pso"', "kind = 3"), "algorithms[0].kind: expected a string, got a number; put it in quotes"),
    (("year = 2020", "year = '2020'"), "source.year: expected a whole number, got a string; write one"),
    (("default = true", "default = 1"), "readings[1].default: expected true or false, got a number; write one of them"),
    (('name = "arm"\n', ""), "robot.name: is missing; add it"),
    (('joints = ["a", "b"]', 'joints = "a"'), "robot.joints: expected a list, got a string; write it in [ ]"),
    (('joints = ["a", "b"]', 'joints = ["a", "a"]'), "robot.joints[1]: joint 'a' is named twice; rename one"),
    (('joint_rows = [["0.0", "10.5", "-3.25", "4"], ', "joint_rows = ["), "waypoints.joint_rows: gives 1 joints, but robot.joints lists 2; list every joint in both (problem 'one', reading 'rad')"),
    (('joints = ["b"]', 'joints = ["c"]'), "joints: joint 'c' is unknown; robot.joints lists a, b (problem 'two', reading 'rad')"),
    (('["1", "2", "3", "4"]]', '["1", "2", "3"]]'), "waypoints.joint_rows[1]: has 3 numbers, but joint_rows[0] has 4; give one number per way-point"),
    (('["1", "2", "3", "4"]]', '["1", "2", "3", "x"]]'), "waypoints.joint_rows[1][3]: 'x' is not a finite decimal number; write the printed digits alone, such as \"0.660\""),
    (('["1", "2", "3", "4"]]', '["1", "2", "3", nan]]'), "waypoints.joint_rows[1][3]: 'NaN' is not a finite decimal number; write the printed digits alone, such as \"0.660\""),
    (('["1", "2", "3", "4"]]', '["1", "2", "3", inf]]'), "waypoints.joint_rows[1][3]: 'Infinity' is not a finite decimal number; write the printed digits alone, such as \"0.660\""),
    (('["1", "2", "3", "4"]]', '["1", "2", "3", true]]'), "waypoints.joint_rows[1][3]: expected a number, got a boolean; write the printed digits, such as \"0.660\""),
    (('["1", "2", "3", "4"]]', '["1", "2", "3", 1979-05-27]]'), "waypoints.joint_rows[1][3]: expected a number, got a date; write the printed digits, such as \"0.660\""),
    (('["1", "2", "3", "4"]]', "[]]"), "waypoints.joint_rows[1]: is empty; fill it in or leave the key out"),
    (('joint_rows = [["0.0", "10.5", "-3.25", "4"], ["1", "2", "3", "4"]]', "joint_rows = [['1'], ['2']]"), "waypoints.joint_rows: holds one way-point only; give at least two"),
    (('labels = ["A", "B", "C", "D"]\n', 'waypoint_rows = [["1", "2"]]\n'), "waypoints: needs one of joint_rows, waypoint_rows and line; give one"),
    (('joint_rows = [["0.0", "10.5", "-3.25", "4"], ["1", "2", "3", "4"]]\n', ""), "waypoints: needs one of joint_rows, waypoint_rows and line; give one"),
    (('"C", "D"]', '"C"]'), "waypoints.labels: 3 labels for 4 way-points; give one each"),
    (("[waypoints]\n", "[source.x]\n"), "source.x: unknown key; known: kind, authors, title, journal, year, doi, note"),
    (("[100, ", "[-100, "), "limits.velocity[0]: -100 is negative; give 0 or more"),
    (("acceleration = 60", "acceleration = nan"), "limits.acceleration: 'NaN' is not a finite decimal number; write the printed digits alone, such as \"0.660\""),
    (("acceleration = 60", "acceleration = -inf"), "limits.acceleration: -inf is negative; write inf where there is no limit"),
    (("acceleration = 60", "acceleration = []"), "limits.acceleration: is an empty list; give one value for all, or one each"),
    (("acceleration = 60", "acceleration = '60 deg'"), "limits.acceleration: '60 deg' is not a finite decimal number; write the printed digits alone, such as \"0.660\""),
    (("acceleration = 60", "acceleration = {x = 1}"), "limits.acceleration: expected a number, got a table; write the printed digits, such as \"0.660\""),
    (("acceleration = 60", "position_lower = inf"), "limits.position_lower: +inf leaves no position; write -inf for no limit"),
    (("acceleration = 60", "position_lower = 3\nposition_upper = 2"), "limits.position_lower: lies above limits.position_upper; exchange them (problem 'one', reading 'rad')"),
    (('[100, "95.0"]', "[1, 2, 3]"), "limits.velocity: 3 values for 2 joints; give one for all, or one each (problem 'one', reading 'rad')"),
    (('position = "deg"', 'position = "grad"'), "units.position: unknown unit 'grad' for position; use one of rad, deg, m, cm, mm"),
    (('velocity = "deg/s"', 'velocity = "deg"'), "units.velocity: 'deg' measures position, not velocity; use one of rad/s, deg/s, rpm, deg/min, rad/min, m/s, cm/s, mm/s, m/min, cm/min, mm/min"),
    (('velocity = "deg/s"\n', ""), "units.velocity: is missing; add one of rad/s, deg/s, rpm, deg/min, rad/min, m/s, cm/s, mm/s, m/min, cm/min, mm/min (problem 'one', reading 'rad')"),
    (('position = "deg"', "position = 3"), "units.position: unknown unit 3 for position; use one of rad, deg, m, cm, mm"),
    (('family = "3-5-3"', 'family = "bezier"'), "interpolant.family: 'bezier' is not allowed; use '3-5-3', 'polynomials', 'cubic-spline', 'quintic-spline', 'septic-spline', 'cubic-spline-virtual', 'quintic-spline-virtual', 'rest-to-rest', 'jtraj', 'uniform-cubic-b-spline' or 'clamped-b-spline'"),
    (('family = "3-5-3"', 'family = {x = 1}'), "interpolant.family: {'x': 1} is not allowed; use '3-5-3', 'polynomials', 'cubic-spline', 'quintic-spline', 'septic-spline', 'cubic-spline-virtual', 'quintic-spline-virtual', 'rest-to-rest', 'jtraj', 'uniform-cubic-b-spline' or 'clamped-b-spline'"),
    (('family = "3-5-3"', 'family = "polynomials"'), "interpolant.degrees: is missing; family 'polynomials' needs it"),
    (('family = "3-5-3"', 'family = "3-5-3"\ndegree = 5'), "interpolant.degree: does not go with family '3-5-3'; leave it out"),
    (('family = "3-5-3"', 'family = "polynomials"\ndegrees = [3, 3, 3]'), "interpolant: 3-3-3 polynomials, C2: over-determined, 14 conditions on 12 coefficients; raise a degree, drop conditions or add 2 virtual breaks (problem 'one', reading 'rad')"),
    (('family = "3-5-3"', 'family = "polynomials"\ndegrees = [5, 5, 5]'), "interpolant: under-determined, 14 conditions on 18 coefficients leave 4 free, not 0; add conditions, lower a degree, or state free = 4 (problem 'one', reading 'rad')"),
    (('family = "3-5-3"', 'family = "polynomials"\ndegrees = [3, 3]'), "interpolant: 3-3 polynomials, C2: over-determined, 10 conditions on 8 coefficients; raise a degree, drop conditions or add 2 virtual breaks (problem 'one', reading 'rad')"),
    (('family = "3-5-3"', 'family = "polynomials"\ndegrees = [5, 5]\nend_orders = [1]\nfree = 2'), "interpolant: 5-5 polynomials, C2 of 2 segments passes 3 way-points, but 4 are given; change the family, the degrees or the way-points (problem 'one', reading 'rad')"),
    (('family = "3-5-3"', 'family = "polynomials"\ndegrees = [3, 12]'), "interpolant.degrees[1]: 12 is out of range; give at most 9"),
    (('family = "3-5-3"', 'family = "polynomials"\ndegrees = [3, 0]'), "interpolant.degrees[1]: 0 is out of range; give at least 1"),
    (('family = "3-5-3"', 'family = "cubic-spline"\nend_orders = [1, 1]'), "interpolant.end_orders: names an order twice; leave one out"),
    (('family = "3-5-3"', 'family = "cubic-spline"\nend_derivatives = [1, 1]'), "interpolant.end_derivatives: 2 values for the 1 orders [1]; give one value per order"),
    (('family = "3-5-3"', 'family = "polynomials"\ndegrees = [9, 9, 9]\nend_orders = [4]\nend_derivatives = [1]'), "interpolant.end_derivatives[0]: order 4 has no unit; only 0 can be prescribed above jerk"),
    (('family = "3-5-3"', 'family = "rest-to-rest"\ndegree = 4'), "interpolant.degree: 4 is not allowed; use 3, 5, 7 or 9"),
    (("lower = 0.1", "lower = -0.1"), "durations.lower: -0.1 is negative; give 0 or more"),
    (("lower = 0.1", "lower = inf"), "durations.lower: 'Infinity' is not a finite decimal number; write the printed digits alone, such as \"0.660\""),
    (("upper = [3, 4, inf]", "upper = [3, 4]"), "durations.upper: 2 values for 3 segments; give one for all, or one each (problem 'one', reading 'rad')"),
    (("upper = [3, 4, inf]", "upper = [3, 0.05, 3]"), "durations.lower: lies above durations.upper in segment 2; exchange or change them (problem 'one', reading 'plain')"),
    (("upper = [3, 4, inf]", "upper = 0"), "durations.upper: is 0; a duration is positive, give more (problem 'one', reading 'rad')"),
    (('coupling = "shared"', 'coupling = "both"'), "coupling: 'both' is not allowed; use 'shared' or 'per-joint'"),
    (('id = "two"', 'id = "one"'), "problems[1].id: 'one' is already the id of problems[0]; rename one"),
    (('id = "rad"', 'id = "plain"'), "readings[1].id: 'plain' is already the id of readings[0]; rename one"),
    (('why = "as printed"', 'why = "as printed"\ndefault = true'), "readings[1].default: a second default reading; keep one"),
    (('id = "times-b"', 'id = "times"'), "claims[1].id: 'times' is already the id of claims[0]; rename one"),
    (('id = "base"', 'id = "Base case"'), "id: 'Base case' is not an id; use lower-case letters, digits, dots and dashes"),
    (('problem = "one"', 'problem = "on"'), "claims[0].problem: 'on' is not the id of any of the problems; did you mean 'one'?"),
    (('problem = "one"\n', ""), "claims[0].problem: is missing, and there are 2 problems; add one of one, two"),
    (('table = "table-1"', 'table = "x"'), "claims[0].table: 'x' is not the id of any of the tables; known: table-1"),
    (('table = "table-1"', 'printed_tables = ["table-2"]'), "claims[0].printed_tables[0]: 'table-2' is not the id of any of the tables; did you mean 'table-1'?"),
    (('table = "table-1"', 'algorithm = "ga"'), "claims[0].algorithm: 'ga' is not the id of any of the algorithms; known: pso"),
    (('where = "Table 1"\nalgorithm = "pso"', 'where = "Table 1"\nalgorithm = "ga"'), "tables[0].algorithm: 'ga' is not the id of any of the algorithms; known: pso"),
    (('joint = "b"', 'joint = "q"'), "claims[1].joint: joint 'q' is unknown; robot.joints lists a, b"),
    (('joint = "b"', 'joint = "a"'), "claims[1].joint: joint 'a' takes no part; the problem has b (problem 'two', reading 'rad')"),
    (('slower = "times-b"', 'slower = "tims"'), "claims[2].slower: 'tims' is not the id of any of the claims; did you mean 'times'?"),
    (('slower = "times-b"', 'slower = "times"'), "claims[2].faster: is the same claim as slower; name two claims"),
    (('slower = "times-b"', 'slower = "peak"'), "claims[2].slower: 'peak' is a claim of quantity 'peak'; name one that states a time"),
    (('of = ["times"]', 'of = ["better"]'), "claims[4].of[0]: 'better' is a claim of quantity 'improvement'; name one that states durations"),
    (('checks = "continuous"', 'checks = "none"'), "claims[4].not_checkable: goes with checks = \"none\" and only with it; say why it cannot be checked, or how it can"),
    (('quantity = "peak"', 'quantity = "peek"'), "claims[3].quantity: 'peek' is no quantity of a claim; did you mean 'peak'?"),
    (('quantity = "peak"\n', ""), f"claims[3].quantity: is missing; add one of {', '.join(QUANTITY_KINDS)}"),
    (('value = "94.8"', 'value = "94.8"\nvalues = ["1", "2"]'), "claims[3].value: or values is needed, and not both; give one of them"),
    (('value = "94.8"', 'values = ["1", "2", "3"]'), "claims[3].values: 3 values for 2 joints; give one each (problem 'one', reading 'rad')"),
    (('value = "94.8"', 'values = ["1", "2"]\njoint = "a"'), "claims[3].joint: does not go with values, one per joint; leave it out"),
    (('value = "94.8"', 'value = "94.8"\nof = "times-b"'), "claims[3].of: 'times-b' is about another problem; name a motion of this one (problem 'one', reading 'rad')"),
    (('value = "94.8"', 'value = "94.8"\nof = "smooth"'), "claims[3].of: 'smooth' is a claim of quantity 'statement'; name one that states durations"),
    (('problem = "two"\njoint = "b"', 'problem = "one"'), "claims[3].of: is missing, and the peak may be that of 'times' or 'times-b'; name the motion: of = \"times\" or of = \"times-b\" (problem 'one', reading 'rad')"),
    (('percent = "10.9"', 'base = "slower"'), "claims[2].base: goes with percent; add it, or leave this out"),
    (('"1.258", "1.078"]', '"1.258", "-1"]'), "claims[0].durations[2]: -1 is negative; give 0 or more"),
    (('derivative = "velocity"', 'derivative = "jerk"'), "units.jerk: is missing; add one of rad/s^3, deg/s^3, m/s^3, cm/s^3, mm/s^3 (problem 'one', reading 'rad')"),
    (('affects = ["durations", "times"]', 'affects = ["nothing"]'), "assumptions[0].affects[0]: 'nothing' is neither an id in this file nor one of units, waypoints, limits, interpolant, durations, coupling, robot; name what it affects"),
    (("inertia = 0.9", "inertia = nan"), "algorithms[0].settings.inertia: NaN is not a finite number of float64; give a finite one"),
    (("inertia = 0.9", "inertia = 1e400"), "algorithms[0].settings.inertia: 1E+400 is not a finite number of float64; give a finite one"),
    (("inertia = 0.9", "inertia = {a = 1}"), "algorithms[0].settings.inertia: a table is no setting; give a number, a string or a list"),
    (("seedless = true", "population = 3"), "algorithms[0].chosen.population: is printed and chosen at once; keep one of the two"),
    (("[source]\n", "[[source]]\n"), "source: expected a table of keys, got a list; write it as a table"),
    (("settings = { population = 30, inertia = 0.9, start = [0.3, 3] }", "settings = 3"), "algorithms[0].settings: expected a table of keys, got a number; write it as a table"),
    (("lower = 0.1", "lower = 1e999"), "durations.lower: '1E+999' is out of range; magnitudes from 1e-300 to 1e300 are read"),
    (("lower = 0.1", f"lower = 1{'0' * 400}"), "durations.lower: an integer of more than 300 digits is out of range"),
    (("lower = 0.1", f"lower = 1{'0' * 5000}"), "holds a number that is out of range; shorten it"),
    (("lower = 0.1", f"lower = 1e{'9' * 30}"), "holds a number that is out of range; shorten it"),
    (("lower = 0.1", "lower = 9e300"), "durations.lower: the number is too large; at most 1e300 is read (problem 'one', reading 'plain')"),
    (("[source]\nyear = 2020\n", ""), "source: is missing; add it"),
    (('"1.258", "1.078"]', '"0.00", "1.078"]'), "claims[0].durations[1]: is 0; a duration is positive, give its digits (problem 'one', reading 'rad')"),
]  # fmt: skip

SIZES = [
    (('"1.258", "1.078"]', '"1.258", "1e-200"]'), "claims[0].durations[2]: 1e-200 s"),
    (('"1.258", "1.078"]', '"1e200", "1.078"]'), "claims[0].durations[1]: 1e200 s"),
    (('total = "3.298"', 'total = "2e13"'), "claims[0].total: 2e13 s"),
    (('value = "94.8"', 'value = "1e-13"'), "claims[3].value: 1e-13 deg/s"),
    (("[100, ", "[1e300, "), "limits.velocity: 1E+300 deg/s"),
    (("acceleration = 60", "acceleration = 1e-60"), "limits.acceleration: 1E-60 deg/s^2"),
    (("acceleration = 60", "position_upper = 2e15"), "limits.position_upper: 2E+15 rad"),
    (('"10.5"', '"1e150"'), "waypoints.joint_rows[0][1]: 1e150 rad"),
    (("upper = [3, 4, inf]", "upper = [3, 4, 1e13]"), "durations.upper: 1E+13 s"),
]  # fmt: skip


@pytest.mark.parametrize(("change", "message"), FAULTS, ids=[m[:60] for _, m in FAULTS])
def test_each_fault_has_its_line(change, message):
    old, new = change
    assert old in BASE
    with pytest.raises(CaseError) as caught:
        parse_case(BASE.replace(old, new, 1), "base.toml")
    assert str(caught.value) == f"base.toml: {message}"


@pytest.mark.parametrize(("change", "number"), SIZES, ids=[n for _, n in SIZES])
def test_numbers_beyond_computing_name_their_field(change, number):
    assert change[0] in BASE
    with pytest.raises(CaseError) as caught:
        parse_case(BASE.replace(*change, 1), "base.toml")
    said = "lies outside the magnitudes from 1e-12 to 1e+12 rad and s that are computed with"
    assert str(caught.value).startswith(f"base.toml: {number} {said}; correct digits or unit (")


def test_small_angles_and_small_lower_bounds_are_read():
    text = BASE.replace('"10.5"', '"6.1e-17"').replace("lower = 0.1", "lower = 1e-300")
    assert parse_case(text, "base.toml").problem("one", "rad").waypoints[1, 0] == 6.1e-17
    digits = (ROOT / "docs/reference/case-files.md").read_text(encoding="utf-8")
    assert f"sizes from {1 / _LARGEST:g} to {_LARGEST:g} are computed with" in digits


@pytest.mark.parametrize(
    ("old", "new", "line"),
    [
        ("[units]", "[units", r"line 13, column 7: not valid TOML, expected .*; correct the"),
        ('id = "base"', 'id = "base', r"line 2, column \d+: not valid TOML, illegal .*; correct"),
        ("title = ", "id = ", r"line 3, column \d+: not valid TOML, .*; correct the syntax"),
        ("title = ", "title = " + "[" * 100_000, r"is nested too deeply; flatten it"),
    ],
)
def test_toml_syntax(old, new, line):
    with pytest.raises(CaseError, match=rf"^base\.toml: {line}") as caught:
        parse_case(BASE.replace(old, new, 1), "base.toml")
    assert "\n" not in str(caught.value)


def test_several_faults_are_named_and_spelling_comes_first():
    text = BASE.replace('name = "arm"\n', "").replace('kind = "pso"', 'kinds = "pso"')
    with pytest.raises(CaseError) as caught:
        parse_case(text, "base.toml")
    assert str(caught.value) == (
        "base.toml: algorithms[0].kinds: unknown key; did you mean 'kind'?; also robot.name: is missing; add it"
    )


def test_files_that_cannot_be_read(tmp_path):
    def refused(path, reason):
        with pytest.raises(CaseError) as caught:
            load_case(path)
        assert str(caught.value) == f"{path}: {reason}"

    refused(tmp_path / "none.toml", "no such file; check the path")
    refused(tmp_path, "is a directory; name a file in it")
    (tmp_path / "empty.toml").write_text(" \n")
    refused(tmp_path / "empty.toml", "is empty; `trajgap new` writes a file to start from")
    (tmp_path / "binary.toml").write_bytes(b"id = 1\n\x00\x01")
    refused(tmp_path / "binary.toml", "is a binary file; a UTF-8 text file is needed")
    (tmp_path / "latin.toml").write_bytes("id = 1\n# Jörg".encode("latin-1"))
    refused(tmp_path / "latin.toml", "line 2: is not UTF-8 text; save the file as UTF-8")
    (tmp_path / "large.toml").write_bytes(b"#" * 10_000_000)
    refused(tmp_path / "large.toml", "has 10.0 MB, the limit is 5 MB; keep only the case itself")
    refused(Path("/dev/null"), "is not a regular file; name a text file")
    with pytest.raises(CaseError, match=r"^a<U\+0000>b\.toml: no such file; check the path$"):
        load_case("a\0b.toml")
    with pytest.raises(CaseError, match=r"cannot be read .*; check the path"):
        load_case("x" * 5000 + ".toml")


def test_line_ends_and_byte_order_marks_do_not_matter(tmp_path):
    path = tmp_path / "case.toml"
    path.write_bytes(b"\xef\xbb\xbf" + BASE.replace("\n", "\r\n").encode())
    assert read_text(path) == BASE
    assert load_case(path).document == parse_case(BASE, "base.toml").document


def test_unknown_ids():
    with pytest.raises(CaseError, match=r"^puma: neither a published case nor a file; "):
        load_case("puma")
    with pytest.raises(CaseError, match="did you mean 'puma560-mnam-pso-353'"):
        load_case("puma560-mnam-353")
    case = parse_case(BASE, "base.toml")
    with pytest.raises(
        CaseError, match=r"^base\.toml: problem: no problem 'on'; did you mean 'one'"
    ):
        case.problem("on")
    with pytest.raises(
        CaseError, match=r"^base\.toml: reading: no reading 'deg'; known: plain, rad"
    ):
        case.problem("one", "deg")
    with pytest.raises(
        CaseError, match=r"^base\.toml: claim: no claim 'time'; did you mean 'times'"
    ):
        case.claim("time")
    with pytest.raises(CaseError, match="coupling: unknown coupling 'x'; use shared, per-joint"):
        case.problem(coupling="x")
    with pytest.raises(CaseError, match="claim 'peak': states no durations; choose one that does"):
        case.claim_durations(case.claim("peak"))
    with pytest.raises(CaseError, match="no problem 'x'"):
        case.selections("x")
    with pytest.raises(CaseError, match="no reading 'x'"):
        case.selections(reading="x")


RAW = tomllib.loads(BASE, parse_float=Decimal)


def places(node, path=()):
    """Every place in a document."""
    yield path
    if isinstance(node, dict | list):
        for key, child in node.items() if isinstance(node, dict) else enumerate(node):
            yield from places(child, (*path, key))


JUNK = st.one_of(
    st.none(),
    st.booleans(),
    st.integers(-3, 10**6),
    st.sampled_from(["", "nan", "inf", "-1", "x", "é" * 99, "3-5-3", "none", "\n"]),
    st.decimals(),
    st.lists(st.integers(0, 3), max_size=4),
    st.dictionaries(st.text(max_size=3), st.integers(), max_size=2),
)


@settings(max_examples=300, deadline=None)
@given(st.data())
def test_whatever_is_put_anywhere_either_loads_or_gives_one_line(data):
    raw = copy.deepcopy(RAW)
    *above, last = data.draw(st.sampled_from([path for path in places(RAW) if path]))
    node = raw
    for key in above:
        node = node[key]
    if data.draw(st.booleans()):
        node[last] = data.draw(JUNK)
    else:
        del node[last]
    try:
        check_case(raw, "base.toml")
    except CaseError as error:
        line, count = str(error), len(error.faults)
        assert line.startswith("base.toml: ")
        assert "\n" not in line
        assert len(line) < 400 * count


def test_an_unforeseen_fault_still_names_the_field():
    from pydantic_core import InitErrorDetails, PydanticCustomError, ValidationError

    details = InitErrorDetails(
        type=PydanticCustomError("new_kind", "Input is odd"), loc=("a", 1), input="x" * 99
    )
    error = ValidationError.from_exception_data("CaseFile", [details])
    ((field, reason),) = all_faults(error)
    assert field == "a[1]"
    assert reason == f"Input is odd, got 'x{'x' * 35}...; see the schema of case files"
    assert CaseFile.model_fields


def test_all_missing_units_are_named_in_one_refusal():
    units = BASE[BASE.index("[units]") : BASE.index("[waypoints]")]
    with pytest.raises(CaseError) as caught:
        parse_case(BASE.replace(units, ""), "base.toml")
    fields = [field for field, _ in caught.value.faults]
    for name in ("position", "velocity", "acceleration", "time"):
        assert f"units.{name}" in fields
    assert len(fields) == len(set(fields))
    assert "also units.velocity: is missing; add one of rad/s, deg/s, rpm" in str(caught.value)


def test_faults_of_every_stage_are_named_together():
    """Of a reference, of what an assumption affects, and of a unit under one reading."""
    text = BASE.replace('slower = "times-b"', 'slower = "times-c"')
    text = text.replace('affects = ["durations"', 'affects = ["nothing"')
    with pytest.raises(CaseError) as caught:
        parse_case(text.replace('velocity = "deg/s"', "", 1), "base.toml")
    fields = {field for field, _ in caught.value.faults}
    assert {"claims[2].slower", "assumptions[0].affects[0]", "units.velocity"} <= fields


def test_misspelt_keys_of_one_block_are_named_together():
    with pytest.raises(CaseError, match=r"limits\.velocty: .*; also limits\.jrk: unknown key"):
        parse_case(BASE.replace("[limits]", "[limits]\nvelocty = 1\njrk = 2", 1), "base.toml")


def test_one_refusal_tells_a_handful_and_counts_the_rest():
    faults = [(f"claims[{k}].id", "is missing; add it") for k in range(11)]
    message = str(refusal("x.toml", faults))
    assert message.endswith("also claims[7].id: is missing; add it (and 3 more)")
