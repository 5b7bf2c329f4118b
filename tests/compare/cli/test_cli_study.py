import csv
import os
import signal
import sqlite3
import subprocess
import sys
from pathlib import Path

import pytest
from support.command_line import START, Run, on_terminal
from support.small_studies import HEAD, STUDY

SMALL = (
    HEAD.replace("seeds = 4", "seeds = 2")
    + """
[[optimizers]]
name = "pso"
settings = { particles = 10 }

[[optimizers]]
name = "support.optimizers:raises"
"""
)


@pytest.fixture(autouse=True)
def study(folder: Path) -> Path:
    path = folder / "few.toml"
    path.write_text(SMALL, encoding="utf-8")
    return path


def test_a_study_is_run_exported_and_gone_on_with(run: Run) -> None:
    code, out, err = run("study", "few.toml", "--workers", "1", "--export", "few.csv")
    assert (code, err) == (1, "")  # of one optimiser every run failed
    lines = out.splitlines()
    assert lines[0] == "few.sqlite: 8 runs done now, 0 were there"
    assert "failed, 4 times: ZeroDivisionError: one over nothing" in " ".join(out.split())
    assert lines[1] == "Mine (mine/main, plain)"
    assert "particles 10" in out
    assert "{" not in out
    assert "run the failed ones again: trajgap study few.toml --retry" in lines
    with open("few.csv", encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 8
    code, out, _ = run("study", "few.toml", "--workers", "1", "--store", "few.sqlite")
    assert code == 1
    assert out.splitlines()[0] == "few.sqlite: 0 runs done now, 8 were there"
    last = "next: trajgap study few.toml --store few.sqlite --export few.csv"
    assert out.splitlines()[-1] == last
    gaps = [float(row["feasible_gap_lowest"]) for row in rows[:2]]
    shown = next(line for line in out.splitlines() if line.startswith("pso ")).split()
    assert shown[-2:] == [f"{100 * min(gaps):+.3g}", f"{50 * sum(gaps):+.3g}"]


def test_the_exit_code_is_0_where_each_optimiser_has_a_run(run: Run, study: Path) -> None:
    study.write_text(
        SMALL.replace("support.optimizers:raises", "support.faulty:raises_at_times").replace(
            "seeds = 2", "seeds = 8"
        ),
        encoding="utf-8",
    )
    code, out, err = run("study", "few.toml", "--workers", "1")
    assert (code, err) == (0, "")
    assert "times: ZeroDivisionError: at times" in out


def test_the_command_that_goes_on_still_exports(
    run: Run, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from trajgap.compare.cli import studying

    def interrupted(*_: object, **__: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(studying, "run_study", interrupted)
    code, out, err = run(
        "study", "few.toml", "--export", "a b.csv", "--export", "few.ioh", "--workers", "1"
    )
    assert (code, out) == (130, "")
    assert "`trajgap study few.toml --export 'a b.csv' --export few.ioh` goes on from there" in err
    assert not (folder / "few.ioh").exists()
    _, _, err = run("study", "few.toml", "--store", "kept.sqlite", "--workers", "1")
    assert "`trajgap study few.toml --store kept.sqlite` goes on from there" in err


@pytest.mark.slow
def test_ctrl_c_keeps_what_is_finished_and_says_how_to_go_on(study: Path) -> None:
    study.write_text(
        STUDY.replace("support.optimizers:raises", "support.optimizers:sleeps"), encoding="utf-8"
    )
    paths = os.pathsep.join(filter(None, sys.path))
    process = subprocess.Popen(
        [sys.executable, "-c", START, "study", "few.toml", "--workers", "1"],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env={**os.environ, "PYTHONPATH": paths},
    )
    while stored() < 24:
        assert process.poll() is None
        signal.sigtimedwait([], 0.1)
    process.send_signal(signal.SIGINT)
    out, err = process.communicate(timeout=120)
    assert (process.returncode, out) == (130, "")
    assert err.strip() == (
        "trajgap: interrupted; 24 of 32 runs are stored, `trajgap study few.toml` goes on from "
        "there"
    )
    assert stored() == 24


def stored() -> int:
    try:
        with sqlite3.connect("file:few.sqlite?mode=ro", uri=True) as data:
            (found,) = data.execute("SELECT count(*) FROM runs").fetchone()
            return int(found)
    except sqlite3.Error:
        return 0


@pytest.mark.slow
def test_a_terminal_shows_how_it_goes(study: Path) -> None:
    paths = os.pathsep.join(filter(None, sys.path))
    code, seen = on_terminal(["study", "few.toml", "--workers", "1"], PYTHONPATH=paths)
    assert code == 1
    assert "8 runs done now" in seen
    assert "a second" in seen
    assert " left" in seen
