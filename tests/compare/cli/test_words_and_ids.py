"""What a command prints calls problems and readings by words; an id stands once, to be typed."""

from __future__ import annotations

from pathlib import Path

import pytest
from support.command_line import IRB, PUMA, Run
from support.one_joint import QUESTION
from trajgap.compare.audits import asked_as, in_words
from trajgap.compare.cli import output as cli_output
from trajgap.compare.cli import table as cli_table
from trajgap.problem import load_case

TITLE = "Shortest time of joint 5 under 80 °/s"
IDS = ("limit-80", "limit-110", "waypoints-rad", "waypoints-deg")


def output_of(*arguments: str, run: Run) -> str:
    code, out, err = run(*arguments)
    assert (code, err) == (0, "")
    return out


def test_a_problem_is_called_by_what_tells_it_from_others() -> None:
    irb, puma = load_case(IRB), load_case(PUMA)
    asked = asked_as(irb, "limit-80", "waypoints-rad")
    assert asked == f"{TITLE}; way-points in radians (problem limit-80, reading waypoints-rad)"
    one = asked_as(puma, "six-joints", "durations-positive")
    assert one == (
        "durations without a lower bound (problem six-joints, reading durations-positive)"
    )
    # Nothing has to be typed where there is one problem under one reading.
    alone = load_case("suite:353-puma560-joint-1")
    assert asked_as(alone, "main", "as-printed") == alone.title
    assert in_words(alone, "main", "as-printed") == alone.title


def test_check_says_each_id_once(run: Run) -> None:
    out = output_of("check", IRB, "--durations", "0.6445,0.5858,0.6387", run=run)
    assert all(out.count(one) == 1 for one in IDS)
    assert out.index("Shortest time of joint 5") < out.index("--problem limit-80")
    one = ("--problem", "limit-80", "--reading", "waypoints-rad")
    out = output_of("check", IRB, "--durations", "0.6445,0.5858,0.6387", *one, run=run)
    lines = out.splitlines()
    assert lines[1] == f"{TITLE}; way-points in radians ({_ids()})"
    assert lines[2].startswith("verdict ")
    out = output_of("check", "suite:353-puma560-joint-1", "--durations", "1,1.3,1.1", run=run)
    assert "main" not in out
    assert "as-printed" not in out


def test_proofs_are_shown_in_words(run: Run) -> None:
    reading = ("--reading", "waypoints-rad")
    out = output_of(
        "solve", IRB, "--certify", "--gap", "0.1", *reading, "--problem", "limit-80", run=run
    )
    assert out.splitlines()[1] == f"{TITLE}; way-points in radians ({_ids()})"
    out = output_of("solve", IRB, "--certify", "--gap", "0.1", *reading, run=run)
    rows = out.splitlines()
    assert rows[1].startswith("problem ")
    assert "--problem limit-110" in out
    assert out.count("limit-110") == out.count("waypoints-rad") == 1


def test_each_joint_by_itself_is_proved_under_words(run: Run) -> None:
    out = output_of(
        "solve", "mine.toml", "--certify", "--gap", "0.5", "--coupling", "per-joint", run=run
    )
    lines = out.splitlines()
    assert "as-printed" not in out
    assert lines[:2] == ["mine", "Mine"]
    assert [line.split()[0] for line in lines if line.startswith(("a ", "b "))] == ["a", "b"]


def test_curves_and_limits_stand_beside_titles(run: Run) -> None:
    out = output_of("show", IRB, run=run)
    assert out.count("limit-80 ") == 1
    assert out.count(TITLE) == 2
    # With one problem there is nothing to tell apart.
    out = output_of("show", PUMA, run=run)
    assert out.count("six-joints") == 1
    # A reading that nobody described has its reason alone.
    out = output_of("show", "mine.toml", run=run)
    assert "As-printed" not in out


@pytest.mark.slow
def test_the_page_of_a_bench_is_headed_by_words(run: Run, folder: Path) -> None:
    small = ("--optimizer", "random", "--seeds", "1", "--budget", "20", "--no-baselines")
    out = output_of("bench", IRB, *small, run=run)
    # The heading may be longer than the window: it is the case with its id, then the problem.
    headed = f"({IRB}); {TITLE}; way-points in radians ({_ids()}) Closest: random"
    assert headed in " ".join(out.split())
    page = (folder / "trajgap-bench" / "index.html").read_text(encoding="utf-8")
    assert "<h1>Optimisers against the optimum: 2 problems</h1>" in page
    assert "irb460-pso-353/limit-80" not in page


def test_many_problems_of_a_study_stand_in_one_table(run: Run) -> None:
    """More than six are called as the exports call them; what was chosen for each is in words."""
    few = """format = 1
seeds = 1
budget = 5
problems = [{ case = "CASE", coupling = "per-joint" }]
optimizers = [{ name = "random" }]
"""
    Path("few.toml").write_text(few.replace("CASE", IRB), encoding="utf-8")
    out = output_of("study", "few.toml", "--workers", "1", run=run)
    assert out.count("irb460-pso-353/limit-80") == 2
    assert f"{TITLE}; way-points in radians (irb460-pso-353/limit-80, waypoints-rad)\n" in out
    assert out.count("optimiser ") == 4
    Path("many.toml").write_text(few.replace("CASE", PUMA), encoding="utf-8")
    out = output_of("study", "many.toml", "--workers", "1", run=run)
    assert out.count("optimiser ") == 1
    assert out.count(" durations-positive ") == 6
    assert "joint 3 alone; durations without a lower bound: Not every duration" in out


UNTITLED = (
    QUESTION.format(points="0, 1", limit=2)
    .replace('"fair"', '"arm"')
    .replace("one joint from rest to rest", "arm")
    .replace("year = 2024", 'note = "Made up."')
)


def test_a_title_that_is_the_id_stands_once(run: Run) -> None:
    Path("arm.toml").write_text(UNTITLED, encoding="utf-8")
    lines = output_of("show", "arm.toml", run=run).splitlines()
    assert lines[:2] == ["arm", "arm, joint 1"]
    assert any(line.split() == ["main", "as", "stated", "below"] for line in lines)
    lines = output_of("solve", "arm.toml", run=run).splitlines()
    assert lines[0] == "arm"
    assert lines[1].startswith("status ")
    lines = output_of("audit", "arm.toml", "--certify-seconds", "0", run=run).splitlines()
    assert lines[:2] == ["arm", ""]
    assert "arm" not in lines[2:]


def test_a_written_motion_is_called_by_words(run: Run) -> None:
    one = ("--problem", "limit-80", "--reading", "waypoints-rad")
    out = " ".join(output_of("solve", IRB, *one, "--samples", "m.csv", run=run).split())
    assert f"m.csv: the motion as csv ({TITLE}; way-points in radians); read back: pass" in out


def test_one_jump_is_in_the_singular(run: Run) -> None:
    pieces = '{"joints": ["1"], "breaks": [0, 1, 2], "coefficients": [[[-1], [1.5], [0], [0]], '
    Path("one.json").write_text(pieces + "[[0], [0], [0], [0.5]]]}", encoding="utf-8")
    out = output_of("check", "one.json", "--velocity", "1.2", "--acceleration", "4", run=run)
    assert "at 1 s; it jumps at 1 break\n" in out


def test_prose_shares_what_the_window_leaves() -> None:
    """A narrow column of prose takes what it needs, one that would be cut off comes first."""
    words, cut = "some words of prose " * 5, "c" * 50
    rows = [("x" * 10, words, "short prose", cut)]
    shown = cli_table.Columns(("firm", "~long", "~short", "…cut"), rows)
    text = cli_output.rendered([shown])
    # Tests have a window of 120 columns.
    assert max(map(len, text.splitlines())) == 120
    assert cut in text
    assert "short prose" in text
    assert " ".join(text.split()).count("some") == 5


def _ids() -> str:
    return "problem limit-80, reading waypoints-rad"


def test_where_the_time_goes_is_shown_of_each_problem_in_words(run: Run) -> None:
    out = output_of("audit", IRB, "--seeds", "2", "--certify-seconds", "0", run=run)
    for limit in ("80", "110"):
        words = f"Shortest time of joint 5 under {limit} °/s; way-points in radians"
        assert f"\nWhere the time goes; {words}\nstep " in out
    assert all(one not in out for one in IDS)
