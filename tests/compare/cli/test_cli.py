"""The command line: what it prints, how it ends, and one clear line for every bad input."""

from __future__ import annotations

import io
import json
import os
import re
import signal
import subprocess
import sys
import time
from importlib import import_module
from importlib.metadata import version
from pathlib import Path
from typing import Any

import jsonschema
import pytest
from rich.cells import cell_len
from support.checkout import ROOT
from support.command_line import CASE, START, Run, assert_refused, on_terminal, program, strict
from support.documents import SCHEMA, assert_valid, report
from trajgap.compare.cli import main
from trajgap.compare.cli import output as cli_output
from trajgap.compare.cli import table as cli_table
from trajgap.problem import load_case, published_ids

PUMA, IRB = "puma560-mnam-pso-353", "irb460-pso-353"

# --- what is printed ------------------------------------------------------------------------------


def test_help_is_quick_and_documents_the_exit_codes() -> None:
    took = []
    for _ in range(3):
        began = time.perf_counter()
        done = program("--help")
        took.append(time.perf_counter() - began)
        assert done.returncode == 0
        assert done.stderr == ""
    assert min(took) < 0.5
    for command in ("cases", "show", "check", "solve", "verify", "audit", "new"):
        assert f"\n  {command} " in done.stdout
    for line in ("0    done", "1    audit --strict", "2    bad input"):
        assert line in done.stdout


def test_help_imports_nothing_that_computes() -> None:
    program_ = (
        "import sys; import trajgap.compare.cli.app\n"
        "print({'numpy', 'casadi', 'pydantic', 'rich.table', 'numba', 'scipy'} & set(sys.modules))"
    )
    done = subprocess.run([sys.executable, "-c", program_], capture_output=True, text=True)
    assert done.stdout == "set()\n"


@pytest.mark.parametrize("command", ["cases", "show", "check", "solve", "verify", "audit", "new"])
def test_each_command_explains_itself(run: Run, command: str) -> None:
    code, out, err = run(command, "--help")
    assert (code, err) == (0, "")
    assert "2    bad input" in out
    for option in re.findall(r"--[a-z-]+", out):
        page = (ROOT / "docs" / "command-line.md").read_text("utf-8")
        assert option in page, option


def test_no_command_prints_the_help(run: Run) -> None:
    assert run() == run("--help")


def test_version(run: Run) -> None:
    assert run("--version") == (0, f"trajgap {version('trajgap')}\n", "")


def test_cases(run: Run) -> None:
    code, out, err = run("cases")
    assert (code, err) == (0, "")
    assert all(name in out for name in published_ids())
    document = strict(run("cases", "--json")[1])
    assert_valid(document, "cases")


def test_show(run: Run) -> None:
    code, out, err = run("show", PUMA)
    assert (code, err) == (0, "")
    case = load_case(PUMA)
    for word in (case.title, "durations-at-least-0.3 (default)", "0.961 1.258 1.078, total 3.298"):
        assert word in out
    for claim in case.claims:
        assert claim.id in out
    document = strict(run("show", PUMA, "--reading", "durations-positive", "--json")[1])
    assert_valid(document, "show")
    assert [r["id"] for r in document["readings"]] == ["durations-positive"]


def test_check_judges_printed_digits(run: Run) -> None:
    # Table 3 of the paper, row of joint 1: 1.0004 of the limit at the printed point, which
    # rounding explains; four digits leave no room.
    row = ("check", PUMA, "--reading", "durations-positive", "--json", "--durations")
    result = strict(run(*row, "0.961,1.258,1.078")[1])["results"][0]
    assert result["segment_durations"] == [0.961, 1.258, 1.078]
    assert result["joints"][0]["verdict"] == "violated"
    assert result["joints"][0]["rounding_verdict"] == "consistent"
    result = strict(run(*row, "0.96100 1.25800 1.07800")[1])["results"][0]
    assert result["joints"][0]["rounding_verdict"] == "breaks"


def test_check_without_flags_covers_every_problem_and_reading(run: Run) -> None:
    code, out, err = run("check", IRB, "--durations", "0.6445, 0.5858, 0.6387", "--json")
    assert (code, err) == (0, "")
    document = strict(out)
    assert_valid(document, "check")
    pairs = [(r["problem"], r["reading"]) for r in document["results"]]
    assert pairs == load_case(IRB).selections()
    assert all("joints" not in r for r in document["results"])
    code, out, err = run("check", IRB, "--durations", "0.6445 0.5858 0.6387")
    assert (code, err) == (0, "")
    assert "keeps" in out


def test_check_reads_the_unit_of_the_case(run: Run) -> None:
    code, out, _ = run("check", "mine.toml", "--durations", "3000,4000,2500", "--json")
    assert code == 0
    result = strict(out)["results"][0]
    assert_valid(strict(out), "check")
    assert result["segment_durations"] == [3.0, 4.0, 2.5]
    assert result["coupling"] == "per-joint"
    assert [one["joint"] for one in result["joints"]] == ["a", "b"]
    worst = max(one["worst"]["ratio"] for one in result["joints"])
    assert result["worst"]["ratio"] == pytest.approx(worst, rel=1e-12)
    shared = run("check", "mine.toml", "--durations", "3000,4000,2500", "--coupling", "shared")
    assert "joint  verdict" not in shared[1]


def test_solve_shared(run: Run) -> None:
    code, out, err = run("solve", IRB, "--problem", "limit-80", "--json")
    assert (code, err) == (0, "")
    document = strict(out)
    assert_valid(document, "solve")
    assert [r["reading"] for r in document["results"]] == ["waypoints-rad", "waypoints-deg"]
    assert all(r["status"] == "optimal" for r in document["results"])
    code, out, err = run("solve", IRB, "--problem", "limit-80", "--reading", "waypoints-rad")
    assert (code, err) == (0, "")
    assert f"{document['results'][0]['total_time']:.6f}" in out


def test_solve_by_joint_and_shared(run: Run) -> None:
    code, out, _ = run("solve", "mine.toml", "--json", "--out", "answer.json")
    assert code == 0
    document = strict(out)
    assert_valid(document, "solve")
    assert strict(Path("answer.json").read_text("utf-8")) == document
    apart = document["results"][0]
    shared = strict(run("solve", "mine.toml", "--coupling", "shared", "--json")[1])["results"][0]
    assert shared["toppra"]
    assert shared["coupling"] == "shared"
    for one in apart["joints"]:
        assert one["total_time"] <= shared["total_time"] * (1 + 1e-9)
    code, out, _ = run("solve", "mine.toml")
    assert code == 0
    assert f"{apart['longest_per_segment']['total_time']:.6f}" in out


def test_starts_and_seed_reach_the_solver(run: Run) -> None:
    one = strict(run("solve", IRB, "--starts", "1", "--seed", "3", "--json")[1])["results"][0]
    assert one["starts"] == 1


# --- audit ----------------------------------------------------------------------------------------


# The command asks the faces when it runs, and a face keeps what it has handed out.
AUDITS, PAGES = (import_module(f"trajgap.compare.{name}") for name in ("audits", "pages"))


@pytest.fixture
def stand_in(monkeypatch: pytest.MonkeyPatch) -> dict[str, Any]:
    """A finished audit in place of minutes of work."""
    seen: dict[str, Any] = {}

    def audit(cases: Any, **options: Any) -> Any:
        seen.update(options, cases=[case.id for case in cases])
        return report()

    monkeypatch.setattr(AUDITS, "audit", audit)
    return seen


@pytest.fixture
def pages(monkeypatch: pytest.MonkeyPatch) -> None:
    def write(report: object, out: Path) -> None:
        out.mkdir(exist_ok=True)
        (out / "index.html").write_text("page", encoding="utf-8")

    monkeypatch.setattr(PAGES, "write_report", write)


@pytest.mark.usefixtures("pages")
def test_audit_writes_pages(run: Run, stand_in: dict[str, Any]) -> None:
    code, out, err = run("audit")
    assert (code, err) == (0, "")
    assert stand_in["cases"] == list(published_ids())
    assert stand_in["seeds"] == 100
    assert stand_in["workers"] >= 1
    assert "refuted" in out
    assert "error TG302 Table 4, column 80 °/s: text" in out
    # The card comes first, then the claims by their texts.
    assert out.index("Under the default") < out.index("Optimal durations of joint 5 under 80 °/s.")
    assert out.endswith(f"pages: {Path('trajgap-audit') / 'index.html'}\n")
    assert [p.name for p in Path("trajgap-audit").iterdir()] == ["index.html"]


@pytest.mark.parametrize(
    ("folder", "why"),
    [("nowhere", "is no folder; name the one with your files"), (".", "holds no trajgap-certif")],
)
def test_certificates_that_are_not_there_are_refused_before_computing(
    run: Run, folder: str, why: str
) -> None:
    code, out, err = run("audit", IRB, "--certificates", folder)
    assert (code, out) == (2, "")
    assert err.startswith(f"trajgap: {folder}: --certificates: {why}")


@pytest.mark.usefixtures("pages")
def test_audit_passes_its_options_on(run: Run, stand_in: dict[str, Any]) -> None:
    options = ("--problem", "limit-80", "--reading", "waypoints-rad", "--seeds", "4")
    given = str(ROOT / "docs/examples")
    more = ("--certify-seconds", "3", "--certificates", given)
    code, _, err = run("audit", IRB, *options, *more, "--workers", "2", "--out", "deep/er")
    assert (code, err) == (0, "")
    del stand_in["progress"]
    (certificate,) = stand_in.pop("certificates")
    assert certificate["format"] == "trajgap-certificate-2"
    assert stand_in.pop("certify_seconds") == 3
    assert stand_in == {
        "cases": [IRB],
        "problem": "limit-80",
        "reading": "waypoints-rad",
        "seeds": 4,
        "workers": 2,
    }
    assert Path("deep/er/index.html").is_file()


@pytest.mark.usefixtures("stand_in", "pages")
def test_audit_json_writes_only_where_told(run: Run) -> None:
    code, out, err = run("audit", IRB, "--json")
    assert (code, err) == (0, "")
    assert_valid(strict(out), "audit")
    assert not Path("trajgap-audit").exists()
    code, again, _ = run("audit", IRB, "--json", "--out", "there")
    assert (code, again) == (0, out)
    assert Path("there/index.html").is_file()


@pytest.mark.usefixtures("stand_in", "pages")
def test_strict_turns_an_error_into_exit_code_1(run: Run) -> None:
    assert run("audit", IRB, "--strict", "--out", "one")[0] == 1
    assert run("audit", IRB, "--out", "two")[0] == 0


@pytest.mark.slow
def test_audit_in_earnest(run: Run) -> None:
    code, out, err = run("audit", IRB, "--seeds", "2", "--workers", "1", "--json", "--out", "x")
    assert (code, err) == (0, "")
    assert_valid(strict(out), "audit")
    assert strict(Path("x/audit.json").read_text("utf-8")) == strict(out)
    assert Path("x", f"{IRB}.html").is_file()


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
    assert "(rad, deg)" in seen
    assert load_case("out.toml").document.units.position == "rad"


@pytest.mark.parametrize("answers", ["", "furlong\nrad\n"])
def test_new_takes_no_wrong_unit_from_a_pipe(
    run: Run, table: str, monkeypatch: pytest.MonkeyPatch, answers: str
) -> None:
    monkeypatch.setattr(sys, "stdin", io.StringIO(answers))
    assert_refused(run("new", "out.toml", "--from", table), "--position-unit", "give rad or deg")
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
        ("1e999,1,1", "out of range"),
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
        (("--position-unit", "rad", "--velocity", "x", "--velocity-unit", "rad/s"), "velocity"),
        (("--position-unit", "rad", "--family", "bezier"), "interpolant.family"),
        (("--position-unit", "rad", "--id", "A B"), "'A B' is not an id"),
    ],
)
def test_bad_options_of_new(run: Run, table: str, options: tuple[str, ...], reason: str) -> None:
    assert_refused(run("new", "out.toml", "--from", table, *options), reason)
    assert not Path("out.toml").exists()


def test_new_does_not_overwrite(run: Run, table: str) -> None:
    ended = run("new", "mine.toml", "--from", table, "--position-unit", "rad")
    assert_refused(ended, "mine.toml: OUT: exists already")
    assert Path("mine.toml").read_text("utf-8") == CASE
    assert_refused(run("new", "o.toml", "--from", "none.csv"), "none.csv: no such file")


# --- odd but correct problems ---------------------------------------------------------------------

ROWS = 'waypoint_rows = [["0.3", "-1.0"], ["1.1", "0.4"], ["0.9", "1.7"], ["2.0", "1.2"]]'


@pytest.mark.parametrize(
    ("old", "new", "status"),
    [
        ("velocity = [2, 3]", "velocity = 0", "infeasible"),
        ("velocity = [2, 3]\nacceleration = 5", "velocity = inf", "not_attained"),
        (ROWS, 'waypoint_rows = [["1", "2"], ["1", "2"], ["1", "2"], ["1", "2"]]', "not_attained"),
        (
            f'interpolant = {{ family = "3-5-3" }}\n\n[waypoints]\n{ROWS}',
            'interpolant = { family = "quintic-spline" }\n\n[waypoints]\n'
            'waypoint_rows = [["0.3", "1.0"], ["1.1", "1.0"]]',
            "optimal",
        ),
    ],
    ids=["limit 0", "limit inf", "way-points repeated", "one segment, one joint still"],
)
def test_odd_problems_have_a_correct_result(run: Run, old: str, new: str, status: str) -> None:
    assert old in CASE
    Path("odd.toml").write_text(CASE.replace(old, new), encoding="utf-8")
    code, out, err = run("solve", "odd.toml", "--coupling", "shared", "--json")
    assert (code, err) == (0, "")
    assert_valid(strict(out), "solve")
    assert strict(out)["results"][0]["status"] == status
    assert run("solve", "odd.toml", "--coupling", "shared")[0] == 0


# --- terminals, pipes, signals --------------------------------------------------------------------


def test_colours_and_progress_only_on_a_terminal(run: Run) -> None:
    arguments = ["check", "mine.toml", "--durations", "300,400,250"]
    code, seen = on_terminal(arguments)
    assert code == 0
    assert "\x1b[33mviolated" in seen
    assert "\x1b[?25l" in seen
    code, out, err = run(*arguments)
    assert (code, err) == (0, "")
    assert "\x1b" not in out


def test_no_color(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys.stdout, "isatty", lambda: True)
    monkeypatch.setenv("TERM", "xterm")
    assert "\x1b[1m" in run("show", "mine.toml")[1]
    monkeypatch.setenv("NO_COLOR", "1")
    assert "\x1b" not in run("show", "mine.toml")[1]


def test_colours_stay_off_in_a_pipe(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("FORCE_COLOR", "1")
    assert "\x1b" not in run("cases")[1]


def test_no_digit_is_cut_off_in_a_narrow_window(monkeypatch: pytest.MonkeyPatch) -> None:
    rows = [("name", "3.296695", "prose " * 40)]
    for width in (20, 40, 200):
        monkeypatch.setenv("COLUMNS", str(width))
        text = cli_output.rendered([cli_table.Columns(("a", ">total s", "…why"), rows)])
        assert "name" in text
        assert "3.296695" in text
        assert "…" in text
        assert max(map(cell_len, text.splitlines())) == max(width, 4 + 2 + 8 + 2 + 16)


def test_nothing_from_a_file_steers_the_terminal(run: Run) -> None:
    Path("evil.toml").write_text(
        CASE.replace('"Mine"', '"[red]x\\u001b[31m\\u0007"'), encoding="utf-8"
    )
    code, out, _ = run("show", "evil.toml")
    assert code == 0
    assert "[red]x<U+001B>[31m<U+0007>" in out
    assert "\x1b" not in out
    assert "\x07" not in out


def test_narrow_encodings(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    wide = strict(run("show", IRB, "--json")[1])
    assert "°" in json.dumps(wide, ensure_ascii=False)
    for arguments in (("show", IRB, "--json"), ("show", IRB)):
        narrow = io.TextIOWrapper(io.BytesIO(), encoding="ascii")
        monkeypatch.setattr(sys, "stdout", narrow)
        assert main(arguments) == 0
        monkeypatch.undo()
        text = narrow.buffer.getvalue().decode("ascii")  # type: ignore[attr-defined]
        assert "limit-80" in text
        if "--json" in arguments:
            assert strict(text) == wide


def test_a_closed_pipe_is_no_fault() -> None:
    process = subprocess.Popen(
        [sys.executable, "-c", START, "show", PUMA, "--json"],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
    )
    assert process.stdout is not None
    process.stdout.close()
    assert process.stderr is not None
    assert process.stderr.read() == b""
    process.stderr.close()
    assert process.wait() == 141


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no full device here")
@pytest.mark.parametrize("arguments", [("cases",), ("--help",)])
def test_a_full_disk(arguments: tuple[str, ...]) -> None:
    with Path("/dev/full").open("w") as full:
        done = subprocess.run(
            [sys.executable, "-c", START, *arguments],
            stdout=full,
            stderr=subprocess.PIPE,
            text=True,
        )
    assert done.returncode == 2
    assert done.stderr.startswith("trajgap: standard output: cannot be written (No space")
    assert done.stderr.count("\n") == 1


def test_interrupted() -> None:
    # CasADi swallows a KeyboardInterrupt and would go on with a solve that was cut short.
    started = (
        "import sys, trajgap.compare.cli.solving as c; from trajgap.compare.cli import main\n"
        "solve = c.solve_per_joint\n"
        "def slow(*a, **k):\n"
        "    print('solving', file=sys.stderr, flush=True)\n"
        "    while True: solve(*a, **k)\n"
        "c.solve_per_joint = slow\n"
        "sys.exit(main())"
    )
    process = subprocess.Popen(
        [sys.executable, "-c", started, "solve", "mine.toml", "--out", "answer.json"],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    assert process.stderr is not None
    assert process.stderr.readline() == "solving\n"
    assert any(p.name.startswith(".trajgap") for p in Path().iterdir())
    time.sleep(1.0)
    process.send_signal(signal.SIGINT)
    out, err = process.communicate(timeout=20)
    assert (process.returncode, out, err) == (130, "", "trajgap: interrupted\n")
    assert sorted(p.name for p in Path().iterdir()) == ["mine.toml"]


def test_interrupted_while_pages_are_written() -> None:
    # What a finalizer raises is printed and lost: an exception cannot end the program there.
    started = (
        "import os, signal, sys\n"
        "from trajgap.compare.cli import main\n"
        "import trajgap.compare.pages.writer as w\n"
        "class Gone:\n"
        "    def __del__(self):\n"
        "        os.kill(os.getpid(), signal.SIGINT)\n"
        "        for _ in range(1000): pass\n"
        "class Files(dict):\n"
        "    def items(self):\n"
        "        for item in super().items():\n"
        "            yield item\n"
        "            Gone()\n"
        "replace = w.replace_folder\n"
        "w.replace_folder = lambda out, files: replace(out, Files(files))\n"
        "sys.exit(main())"
    )
    arguments = ["audit", "mine.toml", "--seeds", "2", "--reading", "plain", "--out", "pages"]
    done = subprocess.run(
        [sys.executable, "-c", started, *arguments], capture_output=True, text=True
    )
    assert (done.returncode, done.stdout, done.stderr) == (130, "", "trajgap: interrupted\n")
    assert sorted(p.name for p in Path().iterdir()) == ["mine.toml"]


def test_interrupted_inside_a_library(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    def stop(*_: object, **__: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("trajgap.compare.cli.solving.solve_per_joint", stop)
    ended = run("solve", "mine.toml", "--out", "answer.json")
    assert ended == (130, "", "trajgap: interrupted\n")
    assert sorted(p.name for p in Path().iterdir()) == ["mine.toml"]


def test_a_fault_of_ours_is_told_apart(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(*_: object, **__: object) -> None:
        raise ZeroDivisionError

    monkeypatch.setattr("trajgap.compare.cli.solving.solve_per_joint", fail)
    code, out, err = run("solve", "mine.toml", "--out", "answer.json")
    assert (code, out) == (70, "")
    assert err.endswith("trajgap: a fault of trajgap itself, please report the lines above\n")
    assert not Path("answer.json").exists()


# --- documents ------------------------------------------------------------------------------------


def test_every_enum_is_documented() -> None:
    page = (ROOT / "docs" / "command-line.md").read_text("utf-8")
    for name, schema in SCHEMA["$defs"].items():
        for value in schema.get("enum", ()):
            assert f"`{value}`" in page, f"{name}: {value}"


def test_the_schema_knows_each_document() -> None:
    for name in ("cases", "show", "check", "solve", "certify", "verify", "audit"):
        assert {"$ref": f"#/$defs/{name}"} in SCHEMA["anyOf"]
    with pytest.raises(jsonschema.ValidationError):
        jsonschema.validate({"schema": "trajgap/1"}, SCHEMA)
