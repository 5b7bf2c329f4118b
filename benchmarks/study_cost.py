"""What a study costs beside its runs: memory over 10,000 of them, and one worker against two.

    python benchmarks/study_cost.py
    python benchmarks/study_cost.py memory [RUNS]
    python benchmarks/study_cost.py workers [SEEDS]
    python benchmarks/study_cost.py overhead

The first prints the table of docs/reference/studies.md, and needs two idle cores.
``memory`` prints the resident memory of the session as cheap runs pass through it. ``workers``
compares two workers with one at the papers' budget, which needs two idle cores.
``overhead`` sets a trial, with its row, beside the bare loop, and beside the loop with a check of
its answer, which a trial always makes.
"""

from __future__ import annotations

import resource
import sys
import tempfile
import time
from pathlib import Path

from trajgap.compare.gaps import (
    Store,
    StudySession,
    Trial,
    export_rows,
    on_this_machine,
    parse_study,
    run_study,
    run_trial,
    study_rows,
)
from trajgap.heuristics import PSO, run
from trajgap.problem import check, load_case

HEAD = """
format = 1
[[problems]]
case = "puma560-mnam-pso-353"
readings = "durations-at-least-0.3"
coupling = "shared"
[[optimizers]]
"""
SEEDS = 200
"""Runs that each number of workers makes, the first four of which start the processes."""
CHECKS = 4000
"""Checks before anything is timed: enough for the checker to have compiled its search."""
ROUNDS = 150
"""Of which the least time counts: the machine does other work too."""


def resident() -> float:
    """Largest resident memory of this process so far, MB."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


def memory(runs: int) -> tuple[list[float], list[float]]:
    """MB before the first run and after the last, and after writing each kind of export."""
    text = f'{HEAD}name = "random"\n'.replace(
        "format = 1", f"format = 1\nbudget = 20\nseeds = {runs}"
    )
    plan = parse_study(text, "memory", Path())
    held, written = [], []
    with tempfile.TemporaryDirectory() as folder, Store(Path(folder, "runs.sqlite")) as store:
        begun = time.monotonic()

        def note(session: StudySession) -> None:
            if session.run in (0, 10, 100) or session.run % max(1, runs // 10) == 0:
                rate = session.run / (time.monotonic() - begun)
                held.append(resident())
                print(f"{session.run:6} runs  {held[-1]:7.1f} MB  {rate:6.1f} a second", flush=True)

        with on_this_machine(2) as engine:
            run_study(plan, store, engine, progress=note)
        for name in ("rows.csv", "rows.parquet", "rows.ioh"):
            count = export_rows(study_rows(plan, store), Path(folder, name))
            written.append(resident())
            print(f"{name:12}  {count} rows  {written[-1]:7.1f} MB")
    return [held[0], held[-1]], written


def workers(seeds: int) -> float:
    """How many times the runs a second of one worker two make, the best of two rounds each."""
    text = f'{HEAD}name = "mnam-pso"\n'.replace("format = 1", f"format = 1\nseeds = {seeds}")
    plan = parse_study(text, "workers", Path())
    took = {}
    for count in (1, 2, 1, 2):
        with tempfile.TemporaryDirectory() as folder, Store(Path(folder, "runs.sqlite")) as store:
            begun = 0.0

            def start(session: StudySession) -> None:
                nonlocal begun
                # The first runs start the processes.
                if session.run == 4:
                    begun = time.monotonic()

            with on_this_machine(count) as engine:
                run_study(plan, store, engine, progress=start)
            rate = (seeds - 4) / (time.monotonic() - begun)
            took.setdefault(count, []).append(rate)
            print(f"{count} workers: {rate:.2f} runs a second", flush=True)
    ratio = max(took[2]) / max(took[1])
    print(f"two workers: {ratio:.2f} times one")
    return ratio


def overhead() -> dict[str, float]:
    """Least seconds of the bare loop, of the loop with a check of its answer, and of a trial."""
    problem = load_case("puma560-mnam-pso-353").problem(None, None, "shared")
    algorithm = PSO(particles=30, iterations=199)
    trial = Trial(problem, "puma", "r", "pso", settings='{"particles":30}', budget=6000)
    found = run(algorithm, problem, seed=0).durations
    for _ in range(CHECKS):
        check(problem, found)
    calls = {
        "bare loop": lambda: run(algorithm, problem, seed=0),
        "and check": lambda: check(problem, run(algorithm, problem, seed=0).durations),
        "trial": lambda: run_trial(trial),
    }
    best = dict.fromkeys(calls, float("inf"))
    for _ in range(ROUNDS):
        for name, call in calls.items():
            begun = time.process_time()
            call()
            best[name] = min(best[name], time.process_time() - begun)
    for name, seconds in best.items():
        print(f"{name:10} {1e3 * seconds:7.2f} ms")
    for name in ("bare loop", "and check"):
        print(f"a trial takes {100 * (best['trial'] / best[name] - 1):.1f} % more than: {name}")
    return best


def table() -> None:
    """Print what docs/reference/studies.md shows."""
    best = overhead()
    more = {name: 100 * (best["trial"] / best[name] - 1) for name in ("bare loop", "and check")}
    times = workers(SEEDS)
    (first, last), written = memory(10_000)
    exports = ", ".join(f"{size:.0f}" for size in written)
    print(
        "\n| what | measured |\n| --- | --- |\n"
        "| a trial of 30 particles × 200 iterations, with its row | "
        f"{1e3 * best['trial']:.1f} ms |\n"
        "| the same beside the bare loop, which judges no answer | "
        f"{more['bare loop']:.0f} % more |\n"
        "| the same beside the bare loop with a `check` of its answer | "
        f"{more['and check']:.1f} % more |\n"
        f"| runs a second of two workers beside one | {times:.2f} times |\n"
        "| memory of the session before the first run, and after 10,000 | "
        f"{first:.0f} MB, {last:.0f} MB |\n"
        "| memory while 10,000 rows are written as CSV, Parquet, IOHprofiler's format | "
        f"{exports} MB |"
    )


if __name__ == "__main__":
    what, *count = sys.argv[1:] or [""]
    if what == "memory":
        memory(int(count[0]) if count else 10_000)
    elif what == "workers":
        workers(int(count[0]) if count else SEEDS)
    elif what == "overhead":
        overhead()
    else:
        table()
