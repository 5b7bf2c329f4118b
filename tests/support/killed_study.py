"""Studies that are killed at random moments, and gone on with."""

from __future__ import annotations

import os
import random
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

from support.small_studies import HEAD, written
from trajgap.compare.gaps import Store, StudyPlan, load_study, study_rows

PROGRAM = """
import sys
from pathlib import Path
from trajgap.compare.gaps import Store, load_study, on_this_machine, run_study
with Store(Path(sys.argv[2])) as store, on_this_machine(2) as engine:
    show = lambda session: print(session.run, flush=True)
    run_study(load_study(Path(sys.argv[1])), store, engine, progress=show)
"""
"""A session that says how many runs it has stored."""
STUDY = (
    HEAD
    + """
[[optimizers]]
name = "support.optimizers:draws"

[[optimizers]]
name = "support.optimizers:dawdles"

[[optimizers]]
name = "support.optimizers:raises"
"""
)


def session(study: Path, store: Path) -> subprocess.Popen[str]:
    """A session in a process of its own."""
    return subprocess.Popen(
        [sys.executable, "-c", PROGRAM, str(study), str(store)],
        stdout=subprocess.PIPE,
        text=True,
        env={**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path))},
    )


def texts(plan: StudyPlan, path: Path) -> list[str]:
    """Every row of a store, in the order of the study."""
    with Store(path) as store:
        assert store._data.execute("PRAGMA integrity_check").fetchone() == ("ok",)
        return [row.text() for row in study_rows(plan, store)]


def killed_at(running: subprocess.Popen[str], rng: random.Random, most: int) -> bool:
    """Kill a session after a random number of rows and a moment; False if it was done before."""
    assert running.stdout is not None
    with running, running.stdout:
        # One in five is killed while it starts and reads what is there.
        wanted = rng.randint(0, most) if rng.random() > 0.2 else -1
        while wanted >= 0:
            line = running.stdout.readline()
            if not line:
                break
            if int(line) >= wanted:
                break
        time.sleep(rng.uniform(0, 0.05 if wanted >= 0 else 3.0))
        running.send_signal(signal.SIGKILL)
        return running.wait() == -signal.SIGKILL


def kill_and_resume(
    folder: Path, kills: int, seeds: int, most: int, report: Callable[[str], None] = lambda _: None
) -> None:
    """Kill studies so many times; each must end with the rows of one that was left alone.

    Parameters
    ----------
    folder : Path
    kills : int
        In total; a study that is done gives way to a fresh one.
    seeds : int
        Of the study: a third of its runs.
    most : int
        Rows after which a session is killed at the latest.
    report : callable
        Takes a line about each session.
    """
    study = written(folder, STUDY.replace("seeds = 4", f"seeds = {seeds}"))
    plan = load_study(study)
    whole = folder / "whole.sqlite"
    with session(study, whole) as running:
        assert running.communicate()
        assert running.returncode == 0
    wanted = texts(plan, whole)
    assert len(wanted) == len(plan)
    rng, done, fresh = random.Random(7), 0, 0
    while done < kills:
        fresh += 1
        path, before = folder / f"killed-{fresh}.sqlite", 0
        finished = False
        while not finished:
            if done < kills:
                hit = killed_at(session(study, path), rng, most)
                done, finished = done + hit, not hit
            else:
                with session(study, path) as running:
                    running.communicate()
                finished = True
                assert running.returncode == 0
            found = texts(plan, path) if path.exists() else []
            # Nothing that was stored is lost, and nothing half-done is there.
            assert len(found) >= before
            assert [text for text in wanted if text in set(found)] == found
            word = "was finished" if finished else f"kill {done}"
            report(f"study {fresh}: {word}, {len(found)} of {len(wanted)} rows stored")
            before = len(found)
        assert found == wanted, "the resumed study differs from the uninterrupted one"
        report(f"study {fresh}: equal to the uninterrupted one, row for row")
