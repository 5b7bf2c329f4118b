"""Case files that ask for too much are refused before anything is built from them."""

import time
from pathlib import Path

import pytest
from trajgap.heuristics import from_settings
from trajgap.problem import CaseError, TrajgapError, load_case, parse_case

HEAD = """format = 1
id = "cnt"
title = "t"
coupling = "shared"
[source]
[units]
position = "rad"
velocity = "rad/s"
time = "s"
[limits]
velocity = 1
[interpolant]
family = "cubic-spline"
"""
ROBOT = '[robot]\nname = "r"\njoints = ["1"]\n'
ABSENT = '[waypoints]\nnot_printed = "x"\ncount = {}\n'
PRINTED = "[waypoints]\njoint_rows = [[{}]]\n"


def refused(text: str, message: str) -> None:
    begun = time.process_time()
    with pytest.raises(CaseError, match=f"^f: {message}.*; ") as caught:
        parse_case(text, "f")
    assert "\n" not in str(caught.value)
    # What is refused is not built: a million way-points took 38 s.
    assert time.process_time() - begun < 5


def numbers(count: int) -> str:
    return ", ".join(str(k % 7) for k in range(count))


def listed(name: str, count: int, more: str = "") -> str:
    return "".join(f'[[{name}]]\nid = "{name[0]}{k}"\n{more}' for k in range(count))


def test_a_million_waypoints_in_one_line(tmp_path: Path) -> None:
    (tmp_path / "count_bomb.toml").write_text(HEAD + ROBOT + ABSENT.format(1_000_000))
    with pytest.raises(CaseError, match=r"waypoints\.count: 1000000 is out of range; give at most"):
        load_case(tmp_path / "count_bomb.toml")
    case = parse_case(HEAD + ROBOT + ABSENT.format(10_000), "f")
    assert case.document.waypoints.number == 10_000


def test_waypoints_rows_and_joints() -> None:
    refused(
        HEAD + ROBOT + PRINTED.format(numbers(10_001)),
        r"waypoints\.joint_rows: holds 10,001 way-points, at most 10,000 are read",
    )
    rows = "[waypoints]\nwaypoint_rows = [" + "[0], [1], " * 5_001 + "]\n"
    refused(HEAD + ROBOT + rows, r"waypoints\.waypoint_rows: has more than 10,000 entries")
    joints = ", ".join(f'"{k}"' for k in range(101))
    robot = ROBOT.replace('"1"', joints)
    refused(HEAD + robot + ABSENT.format(4), r"robot\.joints: has more than 100 entries")
    dh = ROBOT + (
        '[robot.dh]\nconvention = "standard"\nlength_unit = "m"\nangle_unit = "rad"\n'
        f"d = [{numbers(101)}]\na = [{numbers(101)}]\nalpha = [{numbers(101)}]\n"
    )
    refused(HEAD + dh + ABSENT.format(4), r"robot\.dh\.d: has more than 100 entries")


def test_lists_pairs_and_values() -> None:
    body = HEAD + ROBOT + ABSENT.format(4)
    many = listed("tables", 1_001, 'where = "x"\n')
    refused(body + many, "tables: gives 1,001 entries, at most 1,000 are read")
    pairs = listed("problems", 40) + listed("readings", 26, 'why = "x"\n')
    refused(body + pairs, "readings: gives 1,040 pairs with problems, at most 1,000 are read")
    refused(
        HEAD + ROBOT + ABSENT.format(9_000) + pairs.partition("[[readings]]")[0],
        "waypoints: gives 360,000 joint angles over 40 pairs of problem and reading, at most "
        "200,000 are read",
    )
    refused(body + f"labels = [{numbers(100_000)}]\n", "gives 100,013 values, at most 100,000 are")


def test_way_points_of_a_reading_count_too() -> None:
    body = HEAD + ROBOT + ABSENT.format(4) + listed("problems", 40)
    reading = (
        '[[readings]]\nid = "r"\nwhy = "x"\n[readings.waypoints]\n' + ABSENT.partition("\n")[2]
    )
    refused(body + reading.format(9_000), "waypoints: gives 360,000 joint angles over 40 pairs")
    refused(body + reading.format(10**9), r"readings\[0\]\.waypoints\.count: 1000000000 is out of")


@pytest.mark.parametrize(
    ("keys", "message"),
    [
        ("instances = 10_001", r"families\[0\]\.instances: 10001 is out of range"),
        ("instances = 9_000", r"families\[0\]\.instances: gives 18,000 instances, at most 10,000"),
        ("instances = 5_000\nruns = 10", r"families\[0\]\.runs: gives 200,000 runs, at most 100,0"),
        ("instances = 1\nruns = 10_001", r"families\[0\]\.runs: 10001 is out of range"),
        ("instances = 1\nseed = 9223372036854775808", r"families\[0\]\.seed: 92233720368547"),
        ("instances = 1\nsamples = 1_000_001", r"families\[0\]\.samples: 1000001 is out of range"),
    ],
)
def test_families_of_instances(keys: str, message: str) -> None:
    family = f'[[families]]\nid = "f"\nclaim = "c"\nwhy = "x"\nsteps = [0.1, 0.2]\n{keys}\n'
    with pytest.raises(CaseError, match=f"^f: {message}"):
        parse_case(HEAD + ROBOT + ABSENT.format(4) + family, "f")


@pytest.mark.parametrize("degree", ["degrees = [10, 5, 5]", "degrees = [3, 5, 3]\ncontinuity = 9"])
def test_degrees(degree: str) -> None:
    text = HEAD.replace('"cubic-spline"', f'"polynomials"\n{degree}')
    with pytest.raises(CaseError, match=r"^f: interpolant\.\S+: \d+ is out of range; give at most"):
        parse_case(text + ROBOT + ABSENT.format(4), "f")


def test_a_multiple_of_pi_has_as_many_digits_as_any_number() -> None:
    dh = ROBOT + (
        '[robot.dh]\nconvention = "standard"\nlength_unit = "m"\nangle_unit = "rad"\n'
        f'd = [0]\na = [0]\nalpha = ["{"9" * 400}π"]\n'
    )
    with pytest.raises(CaseError, match=r"alpha\[0\]: a number of 401 characters; at most 64"):
        parse_case(HEAD + dh + ABSENT.format(4), "f")


@pytest.mark.parametrize("key", ["particles", "iterations"])
def test_settings_of_an_algorithm(key: str) -> None:
    with pytest.raises(TrajgapError, match=f"^pso: {key}: 100001 is more than 100000; give less$"):
        from_settings("pso", {key: 100_001})
    assert getattr(from_settings("pso", {key: 100_000}), key) == 100_000


def test_the_limits_are_documented() -> None:
    page = (Path(__file__).parents[3] / "docs" / "reference" / "case-files.md").read_text(
        encoding="utf-8"
    )
    for bound in ("5 MB", "100,000", "1,000 |", "10,000 |", "| 100 |", "200,000", "2^63 − 1"):
        assert bound in page.partition("## How large a case may be")[2]
