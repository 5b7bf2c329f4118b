"""The command new, and one clear line for every bad input."""

from __future__ import annotations

import io
import os
import sys
from pathlib import Path

import pytest
from support.command_line import AUDITS, CASE, IRB, PUMA, Run, assert_refused, on_terminal
from trajgap.problem import load_case, published_ids

# --- new ------------------------------------------------------------------------------------------

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
    code, out, err = run("new", "out.toml", "--from", table, *units, *where)
    assert (code, err) == (0, "")
    assert out == "written: out.toml\nnext: trajgap audit out.toml  # judges what is claimed\n"
    assert [claim.where for claim in load_case("out.toml").claims] == [place]
    assert run("show", "out.toml")[0] == 0


def test_new_warns_of_joints_that_may_be_angles(run: Run, folder: Path) -> None:
    Path("table.csv").write_text("1,2\n10,20\n30,40\n", encoding="utf-8")
    units = ("--position-unit", "deg", "--time-unit", "s")
    code, _, err = run("new", "out.toml", "--from", "table.csv", *units)
    assert code == 0
    assert err.startswith("trajgap: table.csv: line 1 is taken for the names of the joints, 1, 2;")
    Path("table.csv").write_text("10,20\n30,40\n50,60\n", encoding="utf-8")
    assert_refused(run("new", "o.toml", "--from", "table.csv", *units), "line 1: holds numbers")
    assert_refused(
        run("new", "o.toml", "--from", "table.csv", *units, "--durations", "1,2,3"), "line 1"
    )
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


@pytest.mark.parametrize("answers", ["", "furlong\nrad\n"])
def test_new_takes_no_wrong_unit_from_a_pipe(
    run: Run, table: str, monkeypatch: pytest.MonkeyPatch, answers: str
) -> None:
    monkeypatch.setattr(sys, "stdin", io.StringIO(answers))
    assert_refused(
        run("new", "out.toml", "--from", table),
        "--position-unit",
        "give one of rad, deg, m, cm, mm",
    )
    assert not Path("out.toml").exists()


# --- bad input ------------------------------------------------------------------------------------


BROKEN = {
    "empty.toml": (b"", "is empty; "),
    "blank.toml": (b" \n\n", "is empty; "),
    "binary.toml": (bytes(range(256)) * 9, "is a binary file; "),
    "latin.toml": ("title = 'é'".encode("latin-1"), "line 1: is not UTF-8 text; "),
    "huge.toml": (b"#" * 10_000_000, "has 10.0 MB, the limit is 5 MB; "),
    "syntax.toml": (b"format = 1\nid = [", "not valid TOML"),
    "key.toml": (CASE.replace("velocity = [", "velocty = [").encode(), "did you mean 'velocity'?"),
    "nan.toml": (CASE.replace("velocity = [2", "velocity = [nan").encode(), "limits.velocity"),
    "short.toml": (CASE.replace('["1.1", "0.4"]', '["1.1"]').encode(), "has 1 numbers"),
    "unit.toml": (CASE.replace('"rad/s"', '"m/s"').encode(), "units.velocity"),
}


@pytest.mark.parametrize("name", BROKEN)
@pytest.mark.parametrize("command", ["show", "check", "solve", "audit"])
def test_a_broken_file(run: Run, command: str, name: str) -> None:
    content, reason = BROKEN[name]
    Path(name).write_bytes(content)
    durations = ("--durations", "1,1,1") if command == "check" else ()
    assert_refused(run(command, name, *durations), f"trajgap: {name}: ", reason)
    assert not Path("trajgap-audit").exists()


@pytest.mark.parametrize(
    ("source", "reason"),
    [
        ("puma560-mnam-pso", f"did you mean '{PUMA}'?"),
        ("nothing-like-it", f"known: {', '.join(published_ids())}"),
        ("missing.toml", "no such file; check the path"),
        (".", "is a directory; name a file in it"),
        ("", "is empty; name a published case or a file"),
        ("x" * 5000, "cannot be read"),
        ("a\x1b[31mb", "a<U+001B>[31mb: neither a published case nor a file"),
        ("two\nlines", "neither a published case nor a file"),
        ("\udcff", "<U+DCFF>: is not UTF-8; rename the file"),
    ],
)
def test_no_such_case(run: Run, source: str, reason: str) -> None:
    assert_refused(run("show", source), reason)


def test_a_pipe_is_no_case_file(run: Run) -> None:
    os.mkfifo("pipe.toml")
    assert_refused(run("show", "pipe.toml"), "is not a regular file; name a text file")


@pytest.mark.parametrize(
    ("durations", "reason"),
    [
        ("1,1", "2 numbers for 3 segments of problem 'main'; give one each"),
        ("1 1 1 1", "4 numbers for 3 segments"),
        ("", "is empty; give one number per segment"),
        (" , ", "is empty; give one number per segment"),
        ("1,nan,1", "number 2: 'nan' is not a finite decimal number"),
        ("1,1,inf", "number 3: 'inf' is not a finite decimal number"),
        ("-1,1,1", "number 1: '-1' is not positive; give more than 0"),
        ("1,0.000,1", "number 2: '0.000' is not positive; give more than 0"),
        ("1,one,1", "number 2: 'one' is not a finite decimal number"),
        ("1e-60,1,1", "1e-30"),
        ("1e60,1,1", "1e+30"),
    ],
)
def test_bad_durations(run: Run, durations: str, reason: str) -> None:
    ended = run("check", "mine.toml", "--durations", durations)
    assert_refused(ended, "trajgap: mine.toml: ", "durations", reason)


@pytest.mark.parametrize(
    ("option", "reason"),
    [
        (("--problem", "x"), "problem: no problem 'x'; known: main"),
        (("--reading", "plan"), "reading: no reading 'plan'; did you mean 'plain'?"),
        (("--coupling", "both"), "coupling: unknown coupling 'both'; use shared, per-joint"),
    ],
)
def test_unknown_selections(run: Run, option: tuple[str, str], reason: str) -> None:
    line = f"trajgap: mine.toml: {reason}\n"
    assert run("check", "mine.toml", "--durations", "1,1,1", *option) == (2, "", line)
    assert run("solve", "mine.toml", *option) == (2, "", line)
    if option[0] != "--coupling":
        assert run("show", "mine.toml", *option) == (2, "", line)
        assert run("audit", "mine.toml", *option) == (2, "", line)


@pytest.mark.parametrize("command", ["cases", "show", "check", "solve"])
@pytest.mark.parametrize(
    ("out", "reason"),
    [
        ("mine.toml", "exists already; name another file or delete this one"),
        (".", "is a directory; name a file in it"),
        ("no/where.json", "cannot be written (No such file or directory)"),
        ("mine.toml/x", "cannot be written (Not a directory)"),
        ("x" * 300, "cannot be written (File name too long)"),
    ],
)
def test_out_that_cannot_be_written(run: Run, command: str, out: str, reason: str) -> None:
    case = () if command == "cases" else ("mine.toml",)
    durations = ("--durations", "1,1,1") if command == "check" else ()
    assert_refused(
        run(command, *case, *durations, "--out", out), f"trajgap: {out}: --out: ", reason
    )
    assert Path("mine.toml").read_text("utf-8") == CASE


@pytest.mark.usefixtures("stand_in", "pages")
def test_audit_folders_that_cannot_be_used(run: Run) -> None:
    Path("full").mkdir()
    Path("full", "notes.txt").write_text("mine", encoding="utf-8")
    assert_refused(run("audit", IRB, "--out", "mine.toml"), "mine.toml: --out: is a file; name a")
    assert_refused(run("audit", IRB, "--out", "full"), "holds notes.txt", "name a new or an empty")
    assert_refused(run("audit", IRB, "--out", "mine.toml/x"), "--out: cannot be written")
    assert [p.name for p in Path("full").iterdir()] == ["notes.txt"]


def test_audit_reads_everything_before_it_computes(
    run: Run, monkeypatch: pytest.MonkeyPatch
) -> None:
    def audit(*_: object, **__: object) -> None:
        raise AssertionError("computed")

    monkeypatch.setattr(AUDITS, "audit", audit)
    Path("bad.toml").write_text(CASE + "\nwrong = 1", encoding="utf-8")
    assert_refused(run("audit", IRB, PUMA, "bad.toml"), "bad.toml: ", "wrong: unknown key")
    assert_refused(run("audit", "mine.toml", "mine.toml"), "'mine' is also the id of mine.toml")
    named = CASE.replace('"mine"', '"index"')
    Path("index.toml").write_text(named, encoding="utf-8")
    assert_refused(run("audit", "index.toml"), "'index' is the name of another page; rename it")
    setting = '[[algorithms]]\nid = "a"\nname = "A"\nkind = "pso"\nsettings = { particles = -3 }\n'
    Path("setting.toml").write_text(CASE + setting, encoding="utf-8")
    assert_refused(run("audit", IRB, "setting.toml"), "setting.toml: algorithms.a: ", "particles")


@pytest.mark.parametrize(
    ("arguments", "reason"),
    [
        (("bogus",), "No such command 'bogus'; see `trajgap --help`"),
        (("--bogus",), "No such option: --bogus; see `trajgap --help`"),
        (("show",), "Missing argument 'CASE|FILE'; see `trajgap show --help`"),
        (("show", IRB, "more"), "unexpected extra argument"),
        (("check", IRB), "Missing option '--durations'; see `trajgap check --help`"),
        (("check", IRB, "--durations"), "--durations"),
        (("solve", IRB, "--starts", "0"), "'--starts'"),
        (("solve", IRB, "--starts", "x"), "'--starts'"),
        (("solve", IRB, "--seed", "-1"), "'--seed'"),
        (("audit", "--seeds", "1"), "'--seeds'"),
        (("audit", "--workers", "0"), "'--workers'"),
        (("new", "out.toml"), "Missing option '--from'"),
    ],
)
def test_wrong_usage(run: Run, arguments: tuple[str, ...], reason: str) -> None:
    assert_refused(run(*arguments), reason, " --help`")


@pytest.mark.parametrize(
    ("content", "reason"),
    [
        (b"", "is empty"),
        (b"\x00\x01", "is a binary file"),
        (b"a,b\n1,2\n1\n", "line 3: has 1 cells"),
        (b"a,b\n1,2\n1,x\n", "line 3, column 2: 'x' is not a finite decimal number"),
        (b"a,b\n1,2\n", "holds 1 way-points"),
        (b"a,a\n1,2\n3,4\n", "joint 'a' is named twice"),
        (b"9" * 10_000_000, "has 10.0 MB"),
    ],
)
def test_a_bad_table(run: Run, content: bytes, reason: str) -> None:
    Path("bad.csv").write_bytes(content)
    ended = run("new", "out.toml", "--from", "bad.csv", "--position-unit", "rad")
    assert_refused(ended, "trajgap: bad.csv: ", reason)
    assert not Path("out.toml").exists()


@pytest.mark.parametrize(
    ("options", "reason"),
    [
        (("--position-unit", "furlong"), "unknown unit 'furlong'"),
        (("--position-unit", "rad/s"), "measures velocity, not position"),
        (("--position-unit", "rad", "--time-unit", "h"), "unknown unit 'h'"),
        (
            ("--position-unit", "rad", "--velocity", "x", "--velocity-unit", "rad/s"),
            "trajgap: --velocity:",
        ),
        (("--position-unit", "rad", "--family", "bezier"), "trajgap: --family: 'bezier' is not"),
        (("--position-unit", "rad", "--id", "A B"), "trajgap: --id: 'A B' is not an id"),
    ],
)
def test_bad_options_of_new(run: Run, table: str, options: tuple[str, ...], reason: str) -> None:
    assert_refused(run("new", "out.toml", "--from", table, *options), reason)
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


def test_new_does_not_overwrite(run: Run, table: str) -> None:
    ended = run("new", "mine.toml", "--from", table, "--position-unit", "rad")
    assert_refused(ended, "mine.toml: OUT: exists already")
    assert Path("mine.toml").read_text("utf-8") == CASE
    assert_refused(run("new", "o.toml", "--from", "none.csv"), "none.csv: no such file")
