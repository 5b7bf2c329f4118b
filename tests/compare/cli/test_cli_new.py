"""The command new, and one clear line for every bad input."""

import io
import sys
from pathlib import Path

import numpy as np
import pytest
from support.command_line import Run, assert_refused, on_terminal
from trajgap.problem import load_case

TABLE = "point,q1,q2\nA,0.30,-1.0\nB,1.10,0.4\nC,0.90,1.7\nD,2.00,1.2\n"


@pytest.fixture
def table(folder: Path) -> str:
    (folder / "table.csv").write_text(TABLE, "utf-8")
    return "table.csv"


def test_new_with_every_unit(run: Run, table: str) -> None:
    units = ("--position-unit", "deg", "--time-unit", "ms", "--velocity-unit", "deg/s")
    code, out, err = run("new", "out.toml", "--from", table, *units, "--velocity", "80")
    then = "next: trajgap audit out.toml  # once claims are filled in"
    assert (code, out, err) == (0, f"written: out.toml\n{then}\n", "")
    case = load_case("out.toml")
    assert case.document.units.time == "ms"
    assert case.robot.joints == ("q1", "q2")
    assert case.problem().limits.velocity == pytest.approx([80 * 3.141592653589793 / 180] * 2)


@pytest.mark.parametrize(
    ("where", "place"), [(("--where", "Table 4"), "Table 4"), ((), "a place not stated")]
)
def test_what_new_writes_is_shown(run: Run, table: str, where: tuple[str, ...], place: str) -> None:
    units = ("--position-unit", "deg", "--time-unit", "s", "--total", "3.4")
    out = run.done("new", "out.toml", "--from", table, *units, *where)
    assert out == "written: out.toml\nnext: trajgap audit out.toml  # judges what is claimed\n"
    assert [claim.where for claim in load_case("out.toml").claims] == [place]
    assert run("show", "out.toml")[0] == 0


def test_new_warns_of_joints_that_may_be_angles(run: Run, folder: Path) -> None:
    Path("table.csv").write_text("1,2\n10,20\n30,40\n", "utf-8")
    units = ("--position-unit", "deg", "--time-unit", "s")
    code, _, err = run("new", "out.toml", "--from", "table.csv", *units)
    assert code == 0
    assert err.startswith("trajgap: table.csv: line 1 is read as the names of the joints, 1, 2;")
    assert sorted(path.name for path in folder.iterdir()) == ["mine.toml", "out.toml", "table.csv"]


def test_new_asks_for_units(run: Run, table: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "stdin", io.StringIO("rad\nrad/s^2\n\n"))
    code, _, err = run(
        "new", "out.toml", "--from", table, "--acceleration", "8", "--id", "other", "--family",
        "quintic-spline",
    )  # fmt: skip
    assert (code, err) == (0, "")
    case = load_case("out.toml")
    assert case.id == "other"
    assert case.document.units.acceleration == "rad/s^2"
    assert case.document.units.time == "s"
    assert case.problem().curve.degrees == (5, 5, 5)


def test_new_asks_again_on_a_terminal(table: str) -> None:
    code, seen = on_terminal(
        ["new", "out.toml", "--from", table],
        [
            ("unit of position", "furlong"),
            ("furlong\r\nunit of position", "rad"),
            ("unit of t", ""),
        ],
    )
    assert code == 0
    assert "(rad, deg, m, cm, mm)" in seen
    assert load_case("out.toml").document.units.position == "rad"


def test_a_wrong_unit_from_a_pipe(run: Run, table: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "stdin", io.StringIO("furlong\nrad\n"))
    ended = run("new", "out.toml", "--from", table)
    assert_refused(ended, "--position-unit", "give one of rad, deg, m, cm, mm")
    assert not Path("out.toml").exists()


URDF = """<robot name="a">
  <joint name="turn" type="continuous"><limit velocity="2.5" acceleration="9" effort="1"/></joint>
  <joint name="swing" type="revolute">
    <limit lower="-1.5" upper="2.25" velocity="3.5" acceleration="7" deceleration="6" effort="1"/>
  </joint>
  <joint name="reach" type="prismatic">
    <limit lower="0" upper="0.4" velocity="0.125" acceleration="0.5" effort="1"/>
  </joint>
</robot>"""
ROWS = "0.10,0.20,100\n0.30,0.50,150\n0.20,0.90,120\n"
UNITS = ("--position-unit", "rad,rad,mm", "--time-unit", "s")


@pytest.fixture
def arm(folder: Path) -> str:
    (folder / "arm.urdf").write_text(URDF, "utf-8")
    return "arm.urdf"


def test_new_refuses_an_angle_for_a_joint_that_slides(run: Run, folder: Path, arm: str) -> None:
    (folder / "t.csv").write_text(f"turn,swing,reach\n{ROWS}", "utf-8")
    units = ("--position-unit", "deg", "--time-unit", "s")
    answer = run("new", "out.toml", "--from", "t.csv", "--urdf", arm, *units)
    assert_refused(answer, "reach: slides, but its unit is deg", "such as deg,deg,m")


@pytest.mark.parametrize("header", ["turn,swing,reach", "1,2,3", "point,1,2,3"])
def test_new_has_limits_and_names_of_a_urdf(run: Run, folder: Path, arm: str, header: str) -> None:
    rows = ROWS if header[0] != "p" else "".join(f"P{k},{r}\n" for k, r in enumerate(ROWS.split()))
    (folder / "t.csv").write_text(f"{header}\n{rows}", "utf-8")
    code, _, err = run("new", "out.toml", "--from", "t.csv", "--urdf", arm, *UNITS)
    assert code == 0
    assert "deceleration" not in err
    case = load_case("out.toml")
    assert case.robot.joints == ("turn", "swing", "reach")
    limits = case.problem().limits
    assert limits.velocity == pytest.approx([2.5, 3.5, 0.125])
    assert limits.ends("acceleration")[1] == pytest.approx([9.0, 7.0, 0.5])
    assert limits.deceleration == pytest.approx([np.inf, 6.0, np.inf])
    assert np.isinf(limits.jerk).all()
    assert limits.position_lower == pytest.approx([-np.inf, -1.5, 0.0])
    assert limits.position_upper == pytest.approx([np.inf, 2.25, 0.4])
    text = Path("out.toml").read_text("utf-8")
    said = "limits of velocity, acceleration, deceleration and position from arm.urdf"
    assert f'note = "way-points from t.csv; {said}"' in text
    assert f"\n# L{said[1:]}\nvelocity = [2.5, 3.5, 0.125]\n" in text
    assert 'velocity = ["rad/s", "rad/s", "m/s"]' in text


def test_a_limit_that_is_given_comes_before_the_urdf(run: Run, folder: Path, arm: str) -> None:
    (folder / "t.csv").write_text("swing,turn\n10,20\n30,50\n", "utf-8")
    given = ("--velocity", "30", "--velocity-unit", "deg/s", "--acceleration-unit", "deg/s^2")
    units = ("--position-unit", "deg", "--time-unit", "s")
    assert run("new", "out.toml", "--from", "t.csv", "--urdf", arm, *given, *units)[0] == 0
    limits = load_case("out.toml").problem().limits
    assert limits.velocity == pytest.approx(np.radians([30.0, 30.0]))
    assert limits.narrow.acceleration == pytest.approx([6.0, 9.0])
    assert limits.position_upper == pytest.approx([2.25, np.inf])
    text = Path("out.toml").read_text("utf-8")
    assert "limits of acceleration, deceleration and position from arm.urdf" in text
    assert 'acceleration = "deg/s^2"' in text


@pytest.mark.parametrize(
    ("header", "words"),
    [
        ("trun,swing,reach", ("arm.urdf", "trun", "did you mean 'turn'?")),
        ("1,2", ("t.csv", "numbers 2 joints", "has 3 with limits")),
        ("1,2,3,4", ("t.csv", "numbers 4 joints", "(turn, swing, reach)")),
        ("a,b,c", ("arm.urdf", "a: is not a joint", "known: turn, swing, reach")),
    ],
)
def test_joints_that_a_urdf_does_not_have(
    run: Run, folder: Path, arm: str, header: str, words: tuple[str, ...]
) -> None:
    row = ",".join("0.1" for _ in header.split(","))
    (folder / "t.csv").write_text(f"{header}\n{row}\n{row}2\n", "utf-8")
    units = ("--position-unit", "rad", "--time-unit", "s")
    assert_refused(run("new", "out.toml", "--from", "t.csv", "--urdf", arm, *units), *words)
    assert not Path("out.toml").exists()


def test_a_joint_that_lacks_a_limit_which_others_have(run: Run, folder: Path) -> None:
    (folder / "arm.urdf").write_text(URDF.replace(' velocity="3.5"', ""), "utf-8")
    (folder / "t.csv").write_text(f"turn,swing,reach\n{ROWS}", "utf-8")
    ended = run("new", "out.toml", "--from", "t.csv", "--urdf", "arm.urdf", *UNITS)
    assert_refused(ended, "arm.urdf", "velocity of joint swing: no limit is stated")


def test_new_tells_faults_at_once(run: Run, table: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "stdin", io.StringIO(""))
    given = ("--velocity", "2", "--jerk", "1,2,3,4,5,6,7", "--family", "bezier")
    ended = run("new", "out.toml", "--from", table, *given)
    units = [f"--{quantity}-unit" for quantity in ("position", "velocity", "jerk")]
    assert_refused(ended, "--jerk: lists 7", "--family: 'bez", *units)
    assert "--time-unit" not in ended[2]
    assert not Path("out.toml").exists()
