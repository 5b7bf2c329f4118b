"""`trajgap solve` of a table of way-points, with limits from flags and a URDF beside it."""

from pathlib import Path

import numpy as np
import pytest
from support.checkout import write_arm
from support.command_line import Run, assert_refused, strict
from trajgap.nlp import solve
from trajgap.problem import Limits, Problem, fit, quintic_spline
from trajgap.problem.limit_files import read_urdf

POINTS = [[10.0, -30.0], [45.0, 20.0], [80.0, -15.0]]
"""Degrees of a shoulder and an elbow."""


@pytest.fixture
def table(tmp_path: Path) -> str:
    write_arm(tmp_path)
    rows = "\n".join(",".join(map(str, row)) for row in POINTS)
    path = tmp_path / "points.csv"
    path.write_text(f"shoulder,elbow\n{rows}\n", "utf-8")
    return str(path)


def answered(run: Run, *arguments: str, said: str = "") -> dict[str, object]:
    code, out, err = run("solve", *arguments, "--prove", "0", "--json")
    assert code == 0
    assert (said in err) if said else err == ""
    (found,) = strict(out)["results"]
    return dict(found)


def test_a_table_is_solved_as_the_same_problem_in_python(run: Run, table: str) -> None:
    """Flags in degrees, and a jerk that the URDF does not state."""
    flags = ("--velocity", "60,45", "--jerk", "900", "--units", "deg")
    found = answered(run, table, *flags, "--family", "quintic-spline")
    limits = Limits(np.radians([60.0, 45.0]), jerk=np.radians(900.0))
    best = solve(Problem(np.radians(POINTS), limits, quintic_spline(2)), prove=0)
    assert found["total_time"] == pytest.approx(best.total_time, rel=1e-7)


def test_the_urdf_limits_the_joints_and_where_they_go(run: Run, table: str) -> None:
    urdf = str(Path(table).parent / "arm.urdf")
    curve = ("--units", "deg", "--family", "quintic-spline")
    found = answered(run, table, "--urdf", urdf, *curve)
    limits = read_urdf(Path(urdf)).for_joints(("shoulder", "elbow"))
    problem = Problem(np.radians(POINTS), limits.two_sided, quintic_spline(2))
    best = solve(problem, prove=0)
    assert found["total_time"] == pytest.approx(best.total_time, rel=1e-7)
    motion = fit(problem.curve, problem.waypoints, found["segment_durations"])
    times = np.linspace(0.0, motion.total_time, 2000)
    assert (motion(times) <= limits.upper[:, 0]).all()
    assert (np.abs(motion(times, 1)) <= limits.upper[:, 1] * (1 + 1e-9)).all()


def test_unequal_sides_are_kept_as_they_are(run: Run, table: str) -> None:
    flags = ("--velocity", "-0.4:0.9", "--family", "cubic-spline", "--units", "deg,deg")
    found = answered(run, table, *flags, "--acceleration", "inf")
    again = answered(run, table, *flags[:3], "cubic-spline", "--units", "deg")
    assert found["total_time"] == again["total_time"]
    joined = answered(run, table, *flags, "--deceleration", "2", said="no single size of accel")
    even = answered(run, table, *flags, "--acceleration", "2")
    assert joined["total_time"] == even["total_time"]


def test_joints_that_are_only_numbered_are_those_of_the_urdf(run: Run, table: str) -> None:
    urdf, path = Path(table).parent / "arm.urdf", Path(table)
    arguments = (table, "--urdf", str(urdf), "--units", "deg", "--family", "cubic-spline-virtual")
    named = answered(run, *arguments)
    text = path.read_text("utf-8")
    path.write_text(text.replace("shoulder,elbow", "1,2"), "utf-8")
    numbered = answered(run, *arguments, said="line 1 is read as the names of the joints")
    assert numbered["total_time"] == named["total_time"]
    assert [one["joint"] for one in numbered["active"]] == [one["joint"] for one in named["active"]]


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ((), ("limits", "none are given")),
        (("--velocity", "1,inf", "--units", "deg,deg,deg"), ("3 units for 2 joints",)),
        (("--velocity", "1", "--family", "no-such-curve"), ("no-such-curve",)),
        (("--velocity", "1,2,3"), ("3 limits for 2 joints",)),
    ],
)
def test_what_cannot_be_used_is_refused(
    run: Run, table: str, arguments: tuple[str, ...], words: tuple[str, ...]
) -> None:
    assert_refused(run("solve", table, *arguments), *words)


def test_a_case_states_its_own_limits_and_curve(run: Run) -> None:
    assert_refused(run("solve", "mine.toml", "--velocity", "1"), "--velocity", "of way-points")
    assert_refused(run("solve", "mine.toml", "--family", "3-5-3"), "--family")
