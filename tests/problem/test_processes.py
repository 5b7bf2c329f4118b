"""Work in processes that are really killed: done again once, in order, and never a hang."""

import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from importlib import import_module
from pathlib import Path

import numpy as np
import pytest
from trajgap.heuristics import PSO, Run, run_many
from trajgap.problem import (
    CaseError,
    Limits,
    LostWork,
    Problem,
    ProcessError,
    Processes,
    in_processes,
    kept_processes,
    load_case,
    processes,
    three_five_three,
)

WAYPOINTS = [[0.1, 0.5], [0.7, 0.2], [1.2, -0.4], [0.9, 0.3]]
PROBLEM = Problem(WAYPOINTS, Limits(6.0, 8.0, joints=2), three_five_three())
STRANGERS: set[int] = set()
"""Processes that other tests have left to this one's process."""


@pytest.fixture(autouse=True)
def no_hang() -> Iterator[None]:
    """End a test that hangs, and leave no process behind."""

    def give_up(*_: object) -> None:
        raise TimeoutError("hangs")

    STRANGERS.clear()
    STRANGERS.update(children())
    before = signal.signal(signal.SIGALRM, give_up)
    signal.alarm(500)
    yield
    signal.alarm(0)
    signal.signal(signal.SIGALRM, before)
    assert children() == set()


def children() -> set[int]:
    """Processes that a test has started; one that has ended and was not waited for counts."""
    lists = Path("/proc/self/task").glob("*/children")
    return {int(pid) for one in lists for pid in one.read_text().split()} - STRANGERS


def test_results_come_in_the_order_of_the_items() -> None:
    assert list(in_processes(partial(pow, 2), [3, 1, 2, 0, 5], 2)) == [8, 2, 4, 1, 32]
    assert list(in_processes(partial(pow, 2), [], 2)) == []


def test_runs_are_the_same_after_a_worker_was_killed() -> None:
    killed: list[int] = []

    def progress(done: Run) -> None:
        if not killed:
            killed.append(done.seed)
            os.kill(max(children()), signal.SIGKILL)  # as the system does without memory

    wanted = run_many(PSO(), PROBLEM, range(6), iterations=40)
    found = run_many(PSO(), PROBLEM, range(6), 2, 40, progress)
    assert killed == [0]
    assert [one.seed for one in found] == list(range(6))
    for one, other in zip(found, wanted, strict=True):
        assert np.array_equal(one.durations, other.durations)
        assert np.array_equal(one.trace, other.trace)


WORK = """
import os, time

def begin(item):
    log, name, seconds = item
    with open(log, "a") as file:
        file.write(f"{name} {os.getpid()}\\n")
    time.sleep(seconds)
    return name
"""


def test_a_killed_worker_costs_its_work(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "logged_work.py").write_text(WORK)
    monkeypatch.syspath_prepend(tmp_path)
    begin = import_module("logged_work").begin
    log = tmp_path / "log"
    names = ["quick", "long", "next", "last"]
    items = [(str(log), name, 2.0 if name == "long" else 0.0) for name in names]
    results = in_processes(begin, items, 2)
    assert next(results) == "quick"
    while "long" not in log.read_text():
        time.sleep(0.01)
    (pid,) = (int(line.split()[1]) for line in log.read_text().splitlines() if "long" in line)
    os.kill(pid, signal.SIGKILL)
    assert list(results) == names[1:]
    begun = [line.split()[0] for line in log.read_text().splitlines()]
    assert sorted(begun) == ["last", "long", "long", "next", "quick"]


@pytest.mark.parametrize(
    ("end", "code", "said"),
    [(signal.raise_signal, signal.SIGKILL, "SIGKILL"), (os._exit, 3, "exit code 3")],
)
def test_work_that_ends_two_is_refused(end: Callable[[int], None], code: int, said: str) -> None:
    with pytest.raises(LostWork) as caught:
        list(in_processes(end, [code, code], 2))
    assert str(caught.value) == (
        f"workers: 2 processes ended at the same piece of work ({said}); "
        "use fewer workers or more memory"
    )


def test_exceptions_arrive_as_they_are() -> None:
    with pytest.raises(ZeroDivisionError):
        list(in_processes(partial(divmod, 1), [1, 0], 2))
    with pytest.raises(CaseError, match=r"^x: neither a published case nor a file; known: ") as one:
        list(in_processes(load_case, ["x", "y"], 2))
    assert one.value.file == "x"


def test_kept_processes_work_again_and_end(tmp_path: Path) -> None:
    with kept_processes():
        assert list(in_processes(partial(pow, 2), [3, 1], 2)) == [8, 2]
        before = children()
        with pytest.raises(ZeroDivisionError):
            list(in_processes(partial(divmod, 1), [1, 0], 2))
        assert children() == before
        # One that was killed while it waited costs no try of the work that it would have got.
        os.kill(min(before), signal.SIGKILL)
        assert list(in_processes(partial(divmod, 7), [2, 3], 2)) == [(3, 1), (2, 1)]
        # Work that is given up ends its process; the other one's is done once this one began.
        os.mkfifo(both := tmp_path / "both")
        first = f"import pathlib, time; both = pathlib.Path({str(both)!r}); both."
        later = first + "write_text('begun'); time.sleep(600)"
        results = in_processes(exec, [first + "read_text()", later], 2)
        next(results)
        results.close()
        assert len(children()) == 1
        # What is left behind in it ends later.
        late = in_processes(time.sleep, [0.0, 1.0], 2)
        next(late)
    assert list(late) == [None]
    assert children() == set()


def test_work_that_takes_too_long_is_ended() -> None:
    with Processes() as some:
        with pytest.raises(LostWork, match=r"^workers: a piece of work took too long; raise"):
            some.run(time.sleep, 600, seconds=0.2)
        assert children() == set()
        assert some.run(pow, 2, 3, seconds=600) == 8


def test_a_process_that_cannot_start_is_reported(monkeypatch: pytest.MonkeyPatch) -> None:
    with Processes() as some:
        monkeypatch.setattr(processes, "_PROGRAM", "raise SystemExit(3)")
        ends = r'^workers: a process ends at once \(exit code 3\); see why: \S+ -c "import time"$'
        with pytest.raises(ProcessError, match=ends):
            some.run(time.sleep, 0)
        monkeypatch.setattr(sys, "executable", "/no/such/python")
        with pytest.raises(ProcessError, match=r"^workers: a process cannot be started \("):
            some.run(time.sleep, 0)


@pytest.mark.parametrize("when", ["while it starts", "while it works"])
def test_no_process_outlives_the_end(when: str, monkeypatch: pytest.MonkeyPatch) -> None:
    begun, ready = threading.Event(), processes._Process.ready

    def seen(process: processes._Process, module: str) -> bool:
        if when == "while it starts":
            begun.set()
        found = ready(process, module)
        begun.set()
        return found

    monkeypatch.setattr(processes._Process, "ready", seen)
    with ThreadPoolExecutor(1) as threads, Processes() as some:
        result = threads.submit(some.run, time.sleep, 600)
        begun.wait()
        some.end()
        with pytest.raises(ProcessError, match=r"^workers: stopped$"):
            result.result()
        with pytest.raises(ProcessError, match=r"^workers: stopped$"):
            some.run(time.sleep, 0)


PROGRAM = """
from trajgap.problem import in_processes
print("once")
def own(number): return -number
print(list(in_processes({function}, [4, 9], 2)))
"""
OWN, GUARDED = PROGRAM.format(function="own"), "if __name__ == '__main__':\n    print(l"


@pytest.mark.parametrize(
    ("program", "out", "error"),
    [
        (PROGRAM.format(function="abs"), "once\n[4, 9]\n", ""),
        # Only what the program itself defines makes processes load it.
        (OWN, "once\n", "guard its entry point with `if __name__"),
        (OWN.replace("print(l", GUARDED), "once\n[-4, -9]\n", "once\n"),
    ],
)
def test_a_program_needs_no_guard(tmp_path: Path, program: str, out: str, error: str) -> None:
    (tmp_path / "bare.py").write_text(program)
    ran = subprocess.run(
        [sys.executable, tmp_path / "bare.py"], capture_output=True, text=True, check=False
    )
    assert ran.stdout == out
    assert error in ran.stderr
    assert bool(error) or not ran.stderr


def test_results_that_cannot_be_sent_are_named() -> None:
    with pytest.raises(RuntimeError, match=r"^memoryview: .*pickle"):
        list(in_processes(memoryview, [b"x", b"y"], 2))


@pytest.mark.parametrize("workers", [1, 2])
def test_what_all_need_is_compiled_before(workers: int, monkeypatch: pytest.MonkeyPatch) -> None:
    loop = import_module("trajgap.heuristics.loop")
    calls: list[object] = []

    def started(some: object, parts: list[tuple[int, ...]], count: int) -> Iterator[tuple[()]]:
        calls.append(count)
        yield from ()

    monkeypatch.setattr(loop, "in_processes", started)
    monkeypatch.setattr(loop, "compile_judge", lambda *asked: calls.append(asked))
    run_many(PSO(particles=4, iterations=1), PROBLEM, range(4), workers, objective="stretch")
    assert calls == ([1] if workers == 1 else [(PROBLEM, "stretch"), 2])
