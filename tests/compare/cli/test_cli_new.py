"""The command new, and one clear line for every bad input."""

import io
import sys
from pathlib import Path

import pytest
from support.command_line import Run, assert_refused, on_terminal
from trajgap.problem import load_case

TABLE = "point,q1,q2\nA,0.30,-1.0\nB,1.10,0.4\nC,0.90,1.7\nD,2.00,1.2\n"


@pytest.fixture
def table(folder: Path) -> str:
    (folder / "table.csv").write_text(TABLE, encoding="utf-8")
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
def test_what_new_writes_can_be_shown(
    run: Run, table: str, where: tuple[str, ...], place: str
) -> None:
    units = ("--position-unit", "deg", "--time-unit", "s", "--total", "3.4")
    out = run.done("new", "out.toml", "--from", table, *units, *where)
    assert out == "written: out.toml\nnext: trajgap audit out.toml  # judges what is claimed\n"
    assert [claim.where for claim in load_case("out.toml").claims] == [place]
    assert run("show", "out.toml")[0] == 0


def test_new_warns_of_joints_that_may_be_angles(run: Run, folder: Path) -> None:
    Path("table.csv").write_text("1,2\n10,20\n30,40\n", encoding="utf-8")
    units = ("--position-unit", "deg", "--time-unit", "s")
    code, _, err = run("new", "out.toml", "--from", "table.csv", *units)
    assert code == 0
    assert err.startswith("trajgap: table.csv: line 1 is taken for the names of the joints, 1, 2;")
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


def test_new_takes_no_wrong_unit_from_a_pipe(
    run: Run, table: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sys, "stdin", io.StringIO("furlong\nrad\n"))
    assert_refused(
        run("new", "out.toml", "--from", table),
        "--position-unit",
        "give one of rad, deg, m, cm, mm",
    )
    assert not Path("out.toml").exists()


def test_new_tells_all_missing_units_and_wrong_options_at_once(
    run: Run, table: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sys, "stdin", io.StringIO(""))
    given = ("--velocity", "2", "--jerk", "1,2,3,4,5,6,7", "--family", "bezier")
    ended = run("new", "out.toml", "--from", table, *given)
    options = (
        "--jerk: lists 7",
        "--family: 'bez",
        "--position-unit",
        "--velocity-unit",
        "--jerk-unit",
    )
    assert_refused(ended, *options)
    assert "--time-unit" not in ended[2]
    assert not Path("out.toml").exists()
