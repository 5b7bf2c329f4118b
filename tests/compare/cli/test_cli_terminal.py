"""Odd but correct problems, terminals, pipes, signals, and the schema of what is printed."""

import io
import json
import re
import subprocess
import sys
from pathlib import Path
from unittest.mock import Mock

import pytest
from rich.cells import cell_len
from support.checkout import ROOT
from support.command_line import CASE, IRB, ONE, START, Run, interrupted, on_terminal, strict
from support.documents import SCHEMA
from trajgap.compare.blocks import table
from trajgap.compare.cli import main, output as cli_output

ROWS = 'waypoint_rows = [["0.3", "-1.0"], ["1.1", "0.4"], ["0.9", "1.7"], ["2.0", "1.2"]]'


@pytest.mark.parametrize(
    ("old", "new", "status"),
    [
        ("velocity = [2, 3]", "velocity = 0", "infeasible"),
        ("velocity = [2, 3]\nacceleration = 5", "velocity = inf", "not_attained"),
        (
            f'interpolant = {{ family = "3-5-3" }}\n\n[waypoints]\n{ROWS}',
            'interpolant = { family = "quintic-spline" }\n\n[waypoints]\n'
            'waypoint_rows = [["0.3", "1.0"], ["1.1", "1.0"]]',
            "optimal",
        ),
    ],
    ids=["limit 0", "limit inf", "one segment, one joint still"],
)
def test_odd_problems_have_a_correct_result(run: Run, old: str, new: str, status: str) -> None:
    assert old in CASE
    Path("odd.toml").write_text(CASE.replace(old, new), "utf-8")
    (one,) = run.document("solve", "odd.toml", "--coupling", "shared", kind="solve")["results"]
    assert one["status"] == status
    assert run("solve", "odd.toml", "--coupling", "shared")[0] == 0


def test_colours_and_progress_only_on_a_terminal(run: Run) -> None:
    arguments = ["check", "mine.toml", "--durations", "300,400,250"]
    code, seen = on_terminal(arguments)
    assert code == 0
    assert "\x1b[33mviolated" in seen
    assert "\x1b[?25l" in seen
    out = run.done(*arguments)
    assert "\x1b" not in out


@pytest.mark.slow
def test_the_live_line_on_a_terminal() -> None:
    # So narrow an interval takes several times as long as the line needs to change.
    narrow = ("--certify", "--gap", "1e-9", "--no-cache")
    code, seen = on_terminal(["solve", *ONE, *narrow], COLUMNS="160")
    assert code == 0
    shown = re.findall(
        r"way-points in radians: ([\d.]+) to [\d.]+ s, gap [\de.+-]+, \d+ open, \d+ nodes/s", seen
    )
    assert shown, seen
    assert float(shown[0]) < float(shown[-1]), seen
    assert "waypoints-rad:" not in seen


def test_no_color(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("FORCE_COLOR", "1")
    assert "\x1b" not in run("cases")[1], "in a pipe"
    monkeypatch.delenv("FORCE_COLOR")
    monkeypatch.setattr(sys.stdout, "isatty", lambda: True)
    monkeypatch.setenv("TERM", "xterm")
    assert "\x1b[1m" in run("show", "mine.toml")[1]
    monkeypatch.setenv("NO_COLOR", "1")
    assert "\x1b" not in run("show", "mine.toml")[1]


def test_no_digit_is_cut_off_in_a_narrow_window(monkeypatch: pytest.MonkeyPatch) -> None:
    rows = [("name", "3.296695", "prose " * 40)]
    for width in (20, 40, 200):
        monkeypatch.setenv("COLUMNS", str(width))
        text = cli_output.rendered([table(("a", ">total s", "…why"), rows)])
        assert "name" in text
        assert "3.296695" in text
        assert "…" in text
        assert max(map(cell_len, text.splitlines())) == max(width, 4 + 2 + 8 + 2 + 16)


def test_prose_shares_what_the_window_leaves() -> None:
    """A narrow column of prose takes what it needs, one that would be cut off comes first."""
    words, cut = "some words of prose " * 5, "c" * 50
    rows = [("x" * 10, words, "short prose", cut)]
    text = cli_output.rendered([table(("firm", "~long", "~short", "…cut"), rows)])
    # Tests have a window of 120 columns.
    assert max(map(len, text.splitlines())) == 120
    assert cut in text
    assert "short prose" in text
    assert text.count("some") == 5


def test_nothing_from_a_file_steers_the_terminal(run: Run) -> None:
    Path("evil.toml").write_text(CASE.replace('"Mine"', '"[red]x\\u001b[31m\\u0007"'), "utf-8")
    out = run.done("show", "evil.toml")
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


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no full device here")
@pytest.mark.parametrize("arguments", [("cases",), ("--help",)])
def test_a_full_disk(arguments: tuple[str, ...]) -> None:
    with Path("/dev/full").open("w") as full:
        command = [sys.executable, "-c", START, *arguments]
        done = subprocess.run(command, stdout=full, stderr=subprocess.PIPE, text=True)
    assert done.returncode == 2
    assert done.stderr.startswith("trajgap: standard output: cannot be written (No space")
    assert done.stderr.count("\n") == 1


def test_interrupted() -> None:
    # CasADi swallows a KeyboardInterrupt and would go on with a solve that was cut short.
    started = (
        "import sys, trajgap.compare.cli.solve_command as c; from trajgap.compare.cli import main\n"
        "solve = c.solve_per_joint\n"
        "def slow(*a, **k):\n"
        "    print('solving', file=sys.stderr, flush=True)\n"
        "    while True: solve(*a, **k)\n"
        "c.solve_per_joint = slow\n"
        "sys.exit(main())"
    )
    ended = interrupted(started, "solve", "mine.toml", "--out", "answer.json", after="solving")
    assert ended == (130, "", "trajgap: interrupted\n")
    assert sorted(p.name for p in Path().iterdir()) == ["mine.toml"]


@pytest.mark.parametrize(
    ("error", "ended", "said"),
    [
        (KeyboardInterrupt, 130, r"trajgap: interrupted\n"),
        (ZeroDivisionError, 70, r"(?s).+\ntrajgap: this is a bug .* report the lines above\n"),
    ],
)
def test_what_is_raised_inside(
    run: Run, monkeypatch: pytest.MonkeyPatch, error: type, ended: int, said: str
) -> None:
    inside = Mock(side_effect=error)
    monkeypatch.setattr("trajgap.compare.cli.solve_command.solve_per_joint", inside)
    code, out, err = run("solve", "mine.toml", "--out", "answer.json")
    assert (code, out) == (ended, "")
    assert re.fullmatch(said, err)
    assert sorted(p.name for p in Path().iterdir()) == ["mine.toml"]


def test_every_enum_is_documented() -> None:
    page = (ROOT / "docs/reference/command-line.md").read_text("utf-8")
    for name, schema in SCHEMA["$defs"].items():
        for value in schema.get("enum", ()):
            assert f"`{value}`" in page, f"{name}: {value}"


def test_two_transcriptions_are_compared(run: Run) -> None:
    Path("b.toml").write_text(CASE.replace('"1.7"', '"1.70"'))
    only = {"field": "waypoints.waypoint_rows[2][1]", "first": '"1.7"', "second": '"1.70"'}
    for second, ended, differences in (("mine.toml", 0, []), ("b.toml", 1, [only])):
        code, out, _ = run("case", "diff", "mine.toml", second, "--json")
        assert (code, strict(out)["differences"]) == (ended, differences)
    code, out, _ = run("case", "diff", "mine.toml", "b.toml")
    assert (code, '"1.70"' in out) == (1, True)
