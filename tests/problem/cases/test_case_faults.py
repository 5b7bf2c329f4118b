"""Everything that can be wrong in a case file, and the one line that says so."""

import copy
import time
import tomllib
from decimal import Decimal
from pathlib import Path

import pytest
from attacks.mutations import places
from hypothesis import given, settings, strategies as st
from support.case_texts import BASE, case_text
from support.checkout import ROOT
from support.refusals import Refusal, each_refusal
from trajgap.heuristics import from_settings
from trajgap.problem import TrajgapError
from trajgap.problem.cases.faults import all_faults, refusal
from trajgap.problem.cases.load import check_case, load_case, parse_case
from trajgap.problem.cases.schema import CaseFile
from trajgap.problem.cases.statement import _LARGEST
from trajgap.problem.errors import CaseError
from trajgap.problem.files.textfile import read_text


@each_refusal("base")
def test_each_fault_has_its_line(one: Refusal) -> None:
    one.said_by(lambda: parse_case(one.text(BASE), "base.toml"), "base.toml: ")


def test_small_angles_and_small_lower_bounds_are_read():
    text = BASE.replace('"10.5"', '"6.1e-17"').replace("lower = 0.1", "lower = 1e-300")
    assert parse_case(text, "base.toml").problem("one", "rad").waypoints[1, 0] == 6.1e-17
    digits = (ROOT / "docs/reference/case-files.md").read_text("utf-8")
    assert f"must lie between {1 / _LARGEST:g} and {_LARGEST:g}" in digits


@pytest.mark.parametrize(
    ("old", "new", "line"),
    [
        ("title = ", "title = " + "[" * 100_000, r"is nested too deeply; flatten it"),
        ("= 0.1", f"= 1{'0' * 400}", "durations.lower: an integer of more than 300 digits is out"),
        ("= 0.1", f"= 1{'0' * 5000}", "holds a number that is out of range; shorten it"),
    ],
)
def test_what_is_too_long_is_refused(old, new, line):
    with pytest.raises(CaseError, match=rf"^base\.toml: {line}"):
        parse_case(BASE.replace(old, new, 1), "base.toml")


def test_several_faults_are_named_and_spelling_comes_first():
    text = BASE.replace('name = "arm"\n', "").replace('kind = "pso"', 'kinds = "pso"')
    words = r"kinds: unknown key; .*; also robot.name: is missing"
    with pytest.raises(CaseError, match=words) as caught:
        parse_case(text, "base.toml")
    assert [field for field, _ in caught.value.faults] == ["algorithms[0].kinds", "robot.name"]


@pytest.mark.parametrize(
    ("data", "reason"),
    [
        (b" \n", "is empty; `trajgap new` writes a file to start from"),
        (b"id = 1\n\x00\x01", "is a binary file; a UTF-8 text file is needed"),
        (b"id = 1\n# J\xf6rg", "line 2: is not UTF-8 text; save the file as UTF-8"),
        (b"#" * 10_000_000, "has 10.0 MB, the limit is 5 MB; keep only the case itself"),
    ],
    ids=["empty", "binary", "Latin 1", "large"],
)
def test_files_that_cannot_be_read(tmp_path, data, reason):
    path = tmp_path / "a.toml"
    path.write_bytes(data)
    with pytest.raises(CaseError) as caught:
        load_case(path)
    assert str(caught.value) == f"{path}: {reason}"


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("none.toml", r"^none\.toml: no such file; check the path$"),
        ("a\0b.toml", r"^a<U\+0000>b\.toml: no such file; check the path$"),
        ("x" * 5000 + ".toml", r"cannot be read .*; check the path"),
    ],
    ids=["absent", "null character", "long"],
)
def test_names_of_what_is_no_file(name, message):
    with pytest.raises(CaseError, match=message):
        load_case(Path(name))


def test_line_ends_and_byte_order_marks_do_not_matter(tmp_path):
    path = tmp_path / "case.toml"
    path.write_bytes(b"\xef\xbb\xbf" + BASE.replace("\n", "\r\n").encode())
    assert read_text(path) == BASE
    assert load_case(path).document == parse_case(BASE, "base.toml").document


CASE = parse_case(BASE, "base.toml")


@pytest.mark.parametrize(
    ("ask", "message"),
    [
        (lambda: load_case("puma"), "^puma: neither a published case nor a file; "),
        (lambda: load_case("puma560-mnam-353"), "did you mean 'puma560-mnam-pso-353'"),
        (lambda: CASE.problem("on"), "^base.toml: problem: no problem 'on'; did you mean 'one'"),
        (lambda: CASE.problem("one", "deg"), "^base.toml: reading: no reading 'deg'; known"),
        (lambda: CASE.claim("time"), "^base.toml: claim: no claim 'time'; did you mean 'times'"),
        (lambda: CASE.problem(coupling="x"), "coupling: unknown coupling 'x'; use shared, per-j"),
        (lambda: CASE.claim_durations(CASE.claim("peak")), "'peak': states no durations; choose"),
        (lambda: CASE.selections("x"), "no problem 'x'"),
        (lambda: CASE.selections(reading="x"), "no reading 'x'"),
    ],
)
def test_unknown_ids(ask, message):
    with pytest.raises(CaseError, match=message):
        ask()


RAW = tomllib.loads(BASE, parse_float=Decimal)


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
    *above, last = data.draw(st.sampled_from(places(RAW)))
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


@pytest.mark.parametrize(
    ("changes", "fields"),
    [
        # All units that are missing.
        (
            [(BASE[BASE.index("[units]") : BASE.index("[waypoints]")], "")],
            ["units.position", "units.velocity", "units.acceleration", "units.time"],
        ),
        # Of a reference, of what an assumption affects, and of a unit under one reading.
        (
            [
                ('slower = "times-b"', 'slower = "times-c"'),
                ('affects = ["durations"', 'affects = ["nothing"'),
                ('velocity = "deg/s"', ""),
            ],
            ["claims[2].slower", "assumptions[0].affects[0]", "units.velocity"],
        ),
        # Misspelt keys of one block.
        ([("[limits]", "[limits]\nvelocty = 1\njrk = 2")], ["limits.velocty", "limits.jrk"]),
    ],
)
def test_faults_of_every_stage_are_named_together_and_once(changes, fields):
    text = BASE
    for old, new in changes:
        text = text.replace(old, new, 1)
    with pytest.raises(CaseError) as caught:
        parse_case(text, "base.toml")
    named = [field for field, _ in caught.value.faults]
    assert set(fields) <= set(named)
    assert len(named) == len(set(named))
    assert f"also {named[1]}: " in str(caught.value)


def test_one_refusal_tells_a_handful_and_counts_the_rest():
    faults = [(f"claims[{k}].id", "is missing; add it") for k in range(11)]
    message = str(refusal("x.toml", faults))
    assert message.endswith("also claims[7].id: is missing; add it (and 3 more)")


ABSENT = 'not_printed = "x"\ncount = {}\n'


def asking(points: str | int, robot: str = "", joints: str = "1", more: str = "") -> str:
    """A case with so many way-points that are not printed, or with printed ones."""
    points = ABSENT.format(points) if isinstance(points, int) else points
    curve = 'family = "cubic-spline"'
    return case_text(points, curve, joints=joints, robot=robot, unit="rad", more=more)


def numbers(count: int) -> str:
    return ", ".join(str(k % 7) for k in range(count))


def listed(name: str, count: int, more: str = "") -> str:
    return "".join(f'[[{name}]]\nid = "{name[0]}{k}"\n{more}' for k in range(count))


def degrees(text: str) -> str:
    return asking(4).replace('"cubic-spline"', f'"polynomials"\n{text}')


DH = """[robot.dh]
convention = "standard"
length_unit = "m"
angle_unit = "rad"
d = [{}]
a = [{}]
alpha = [{}]
"""
FAMILY = '[[families]]\nid = "f"\nclaim = "c"\nwhy = "x"\nsteps = [0.1, 0.2]\ninstances = {}\n'
PROBLEMS, READINGS = listed("problems", 40), listed("readings", 26, 'why = "x"\n')
READING = f'{PROBLEMS}[[readings]]\nid = "r"\nwhy = "x"\n[readings.waypoints]\n{ABSENT}'
ANGLES = "waypoints: gives 360,000 joint angles over 40 pairs of problem and reading, at most"
TOO_MUCH = {
    "waypoints.count: 1000000 is out of range; give at most": asking(1_000_000),
    "waypoints.joint_rows: holds 10,001 way-points, but at most 10,000 are read; ": asking(
        f"joint_rows = [[{numbers(10_001)}]]"
    ),
    "waypoints.waypoint_rows: has more than 10,000 entries; ": asking(
        "waypoint_rows = [" + "[0], [1], " * 5_001 + "]\n"
    ),
    "robot.joints: has more than 100 entries; ": asking(4, joints=" ".join(map(str, range(101)))),
    "robot.dh.d: has more than 100 entries; ": asking(4, DH.format(*[numbers(101)] * 3)),
    "robot.dh.alpha[0]: a number of 401 characters; at most 64": asking(
        4, DH.format(0, 0, f'"{"9" * 400}π"')
    ),
    "tables: gives 1,001 entries, at most 1,000 are read; ": asking(
        4, more=listed("tables", 1_001, 'where = "x"\n')
    ),
    "readings: gives 1,040 pairs with problems, at most 1,000 are read; ": asking(
        4, more=PROBLEMS + READINGS
    ),
    ANGLES: asking(9_000, more=PROBLEMS),
    # Way-points of a reading count too.
    ANGLES + " ": asking(4, more=READING.format(9_000)),
    "readings[0].waypoints.count: 1000000000 is out of range; ": asking(
        4, more=READING.format(10**9)
    ),
    "gives 100,014 values, at most 100,000 are": asking(
        ABSENT.format(4) + f"labels = [{numbers(100_000)}]\n"
    ),
    "interpolant.degrees[0]: 10 is out of range; give at most": degrees("degrees = [10, 5, 5]"),
    "interpolant.continuity: 9 is out of range; give at most": degrees(
        "degrees = [3, 5, 3]\ncontinuity = 9"
    ),
    **{
        f"families[0].{said}": asking(4, more=FAMILY.format(keys))
        for said, keys in {
            "instances: 10001 is out of range": "10_001",
            "instances: gives 18,000 instances, at most 10,000": "9_000",
            "runs: gives 200,000 runs, at most 100,0": "5_000\nruns = 10",
            "runs: 10001 is out of range": "1\nruns = 10_001",
            "seed: 92233720368547": "1\nseed = 9223372036854775808",
            "samples: 1000001 is out of range": "1\nsamples = 1_000_001",
        }.items()
    },
}
"""Refusals, each with a text that has it."""


@pytest.mark.parametrize("message", TOO_MUCH)
def test_a_case_that_asks_for_too_much_is_refused_before_it_is_built(message: str) -> None:
    begun = time.process_time()
    with pytest.raises(CaseError) as caught:
        parse_case(TOO_MUCH[message], "f")
    assert str(caught.value).startswith(f"f: {message.strip()}")
    assert "\n" not in str(caught.value)
    assert time.process_time() - begun < 5  # a million way-points took 38 s


def test_what_is_large_and_allowed_is_read() -> None:
    assert parse_case(asking(10_000), "f").document.waypoints.number == 10_000


@pytest.mark.parametrize("key", ["particles", "iterations"])
def test_settings_of_an_algorithm(key: str) -> None:
    with pytest.raises(TrajgapError, match=f"^pso: {key}: 100001 is more than 100000; give less$"):
        from_settings("pso", {key: 100_001})
    assert getattr(from_settings("pso", {key: 100_000}), key) == 100_000


def test_the_limits_are_documented() -> None:
    page = (ROOT / "docs/reference/case-files.md").read_text("utf-8")
    for bound in ("5 MB", "100,000", "1,000 |", "10,000 |", "| 100 |", "200,000", "2^63 − 1"):
        assert bound in page.partition("## How large a case may be")[2]
