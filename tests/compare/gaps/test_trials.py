"""Trials: the row of a run, whatever an optimiser does, here and in a process of its own."""

import os
import random
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from support.small_studies import small_problem, small_trial
from trajgap.compare.gaps import RowStatus, canonical, run_apart, run_trial
from trajgap.compare.gaps.trials import origin_of
from trajgap.heuristics import KINDS, PSO, run
from trajgap.problem import Processes, check


@pytest.mark.parametrize("handling", ["death-penalty", "stretch", "rescale"])
def test_a_row_is_what_the_loop_of_the_papers_finds(handling: str) -> None:
    settings = canonical({"particles": 20, "position_initial": [0.2, 6.0]})
    trial = small_trial("pso", settings=settings, budget=400, handling=handling)
    row = run_trial(trial)
    algorithm = PSO(particles=20, iterations=19, position_initial=(0.2, 6.0))
    found = run(algorithm, small_problem(), seed=3, objective=handling)
    assert row.status is RowStatus.FINISHED
    assert row.evaluations == found.evaluations == 400
    assert row.durations == tuple(found.durations)
    assert row.reported_time == found.reported_time == row.trace[-1][1]
    judged = check(small_problem(), found.durations)
    assert (row.verdict, row.feasible_time) == (judged.verdict, judged.feasible_time)
    assert row.worst_ratio == judged.worst.ratio
    assert row.feasible


def everybodys_numbers(seed: int) -> tuple[float, float]:
    """The first draws of the generators that everybody shares, which begin again."""
    random.seed(seed)
    np.random.seed(seed)  # noqa: NPY002
    drawn = random.random(), np.random.random()  # noqa: NPY002
    random.seed(seed)
    np.random.seed(seed)  # noqa: NPY002
    return drawn


@pytest.mark.parametrize("name", ["support.optimizers:draws_globally", *KINDS])
def test_a_row_depends_on_no_generator_that_everybody_shares_and_moves_none(name: str) -> None:
    first = everybodys_numbers(1)
    row = run_trial(small_trial(name, budget=90))
    assert first == (random.random(), np.random.random())  # noqa: NPY002
    everybodys_numbers(2)
    assert run_trial(small_trial(name, budget=90)) == row
    assert row.status is RowStatus.FINISHED
    assert row.evaluations > 0


def test_settings_of_one_trial_are_not_those_of_the_next() -> None:
    few, many = (run_trial(small_trial("pso", settings=f'{{"particles":{n}}}')) for n in (5, 50))
    assert few.durations != many.durations
    assert (few.evaluations, many.evaluations) == (200, 200)
    assert run_trial(small_trial("pso", settings='{"particles":5}')) == few
    assert run_trial(small_trial("pso", settings='{"particles":5}', budget=100)).evaluations == 100


@pytest.mark.parametrize(
    "name", ["overspends", "scribbles", "returns_short", "forks", "leaves_traces", "warns"]
)
def test_what_does_no_harm_changes_nothing(name: str, tmp_path: Path) -> None:
    before, floats = run_trial(small_trial("support.optimizers:draws")), np.geterr()
    row = run_trial(small_trial(f"support.optimizers:{name}"))
    with (tmp_path / "returned").open("a", encoding="utf-8") as file:
        file.write(row.status)
    assert (tmp_path / "returned").read_text("utf-8") == "finished", "by one process"
    assert row.evaluations == 200 or name not in ("overspends", "scribbles", "returns_short")
    if name in ("scribbles", "returns_short", "forks"):
        assert (row.durations, row.trace) == (before.durations, before.trace)
    assert np.geterr() == floats
    assert run_trial(small_trial("support.optimizers:draws")) == before


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("support.optimizers:raises", "ZeroDivisionError: one over nothing!!!"),
        ("support.optimizers:swallows", "continued after its budget of 200 evaluations was spent"),
        ("support.optimizers:moves_bounds", "asked for the fitness of 7 s for duration 1, outside"),
        ("support.optimizers:raises_unprintable", "ValueError: half of a pair: <U+DC80>, a cursor"),
        ("support.optimizers:raises_mute", "Mute"),
        ("support.optimizers:unknown", "unknown"),
        ("psso", "did you mean 'pso'"),
    ],
)
def test_what_goes_wrong_is_a_row_with_its_message(name: str, message: str) -> None:
    row = run_trial(small_trial(name))
    assert row.status is RowStatus.FAILED
    assert message in row.message
    assert len(row.message) <= 300
    assert row.message.isprintable()
    row.message.encode()
    assert (row.durations, row.reported_time, row.feasible_gap) == (None, None, None)
    assert row.reference_upper == 2.5


def test_a_run_that_takes_too_long_is_a_row_without_clock_times() -> None:
    begun = time.monotonic()
    row = run_trial(small_trial("support.optimizers:sleeps", seconds=0.3))
    assert time.monotonic() - begun < 60
    assert row == run_trial(small_trial("support.optimizers:sleeps", seconds=0.3))
    assert row.message == (
        "support.optimizers:sleeps: took longer than 0.3 s; raise the time limit, or find where "
        "it hangs"
    )


def test_a_run_that_judges_nothing_feasible_has_no_time() -> None:
    # The middle of a box of very short durations breaks every limit.
    trial = small_trial("support.optimizers:warns")
    object.__setattr__(trial.problem, "duration_upper", np.full(3, 0.21))
    row = run_trial(trial)
    assert (row.status, row.reported_time, row.trace) == (RowStatus.FINISHED, None, ())
    assert row.feasible_why == "no feasible vector was evaluated"


def test_where_an_optimiser_comes_from(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert origin_of("pso").startswith("trajgap ")
    assert origin_of("scipy:shgo").startswith("scipy ")
    monkeypatch.syspath_prepend(tmp_path)
    (tmp_path / "mine_once.py").write_text("def f(): ...\n")
    before = origin_of("mine_once:f")
    (tmp_path / "mine_once.py").write_text("def f(): 1\n")
    origin_of.cache_clear()
    assert before.startswith("sha256:")
    assert origin_of("mine_once:f") != before
    assert origin_of("nowhere_at_all:f").startswith("trajgap ")


def of_one_child() -> Iterator[Processes]:
    with Processes() as found:
        yield found


processes = pytest.fixture(of_one_child)
going_on = pytest.fixture(of_one_child, scope="module")
"""For the tests after which it can run trials as before: to start costs a second."""


def test_a_trial_gives_the_same_row_in_a_process_of_its_own(going_on: Processes) -> None:
    outcome = run_apart(small_trial(), going_on)
    assert outcome.row == run_trial(small_trial())
    assert outcome.row.status is RowStatus.FINISHED
    assert outcome.seconds > 0


@pytest.mark.slow
def test_a_run_whose_process_dies_is_done_again(processes: Processes, tmp_path: Path) -> None:
    settings = canonical({"mark": str(tmp_path / "mark")})
    row = run_apart(small_trial("support.optimizers:dies_once", settings=settings), processes).row
    assert row.status is RowStatus.FINISHED
    assert row.durations == run_trial(small_trial("support.optimizers:draws")).durations


def test_what_an_optimiser_prints_and_reads_is_not_ours(going_on: Processes) -> None:
    row = run_apart(small_trial("support.optimizers:prints"), going_on).row
    assert row.status is RowStatus.FINISHED


def test_a_run_at_which_two_processes_die_is_reported(going_on: Processes) -> None:
    row = run_apart(small_trial("support.optimizers:dies"), going_on).row
    assert row.status is RowStatus.FAILED
    assert row.message == "support.optimizers:dies: its process ended 2 times (SIGKILL)"
    assert run_apart(small_trial(), going_on).row.status is RowStatus.FINISHED


def test_a_run_that_forks_answers_once(going_on: Processes) -> None:
    honest = run_trial(small_trial("support.optimizers:draws"))
    for seed in (3, 4):
        row = run_apart(small_trial("support.optimizers:forks", seed=seed), going_on).row
        assert (row.optimizer, row.seed) == ("support.optimizers:forks", seed)
        assert (row.durations == honest.durations) == (seed == 3)
    assert run_apart(small_trial(), going_on).row == run_trial(small_trial())


def test_what_a_run_leaves_behind_holds_nothing_up(going_on: Processes, tmp_path: Path) -> None:
    mark = tmp_path / "mark"
    settings = canonical({"mark": str(mark)})
    trial = small_trial("support.optimizers:forks_and_leaves", settings=settings, seconds=60)
    row = run_apart(trial, going_on).row
    assert row.message.endswith("its process ended 2 times (SIGKILL)")
    left = int(mark.read_text("utf-8"))
    assert run_apart(small_trial(), going_on).row.status is RowStatus.FINISHED
    assert is_gone(left)


@pytest.mark.skipif(sys.platform != "linux", reason="other systems know no subreaper")
@pytest.mark.parametrize("how", ["the pool ends", "the trial dies", "the parent is gone"])
def test_grandchildren_in_a_session_end(processes: Processes, tmp_path: Path, how: str) -> None:
    mark = tmp_path / "mark"
    settings = canonical({"mark": str(mark), "dies": how == "the trial dies"})
    trial = small_trial("support.optimizers:leaves_a_grandchild", settings=settings, seconds=60)
    row = run_apart(trial, processes).row
    left = [int(line) for line in mark.read_text("utf-8").split()]
    if how == "the trial dies":
        assert row.message.endswith("its process ended 2 times (SIGKILL)")
        assert len(left) == 2
    else:
        assert row.status is RowStatus.FINISHED
        os.kill(left[0], 0)  # it lives as long as the process that ran the trial
        if how == "the pool ends":
            processes.end()
        else:
            processes._idle._waiting[0]._process.stdin.close()
    assert all(map(is_gone, left))


def is_gone(pid: int) -> bool:
    """Whether a process ends within ten seconds; one that nobody waited for counts as ended."""
    for _ in range(100):
        try:
            os.kill(pid, 0)
            status = Path(f"/proc/{pid}/stat")
            if status.exists() and status.read_text().rpartition(")")[2].split()[0] == "Z":
                return True
        except (ProcessLookupError, FileNotFoundError):
            return True
        time.sleep(0.1)
    return False


def test_a_search_that_catches_everything_is_ended_from_outside(going_on: Processes) -> None:
    row = run_apart(small_trial("support.optimizers:hangs", seconds=0.5), going_on, grace=0.5).row
    assert row.status is RowStatus.FAILED
    assert row.message.startswith("support.optimizers:hangs: took longer than 0.5 s; raise")
    assert run_apart(small_trial(), going_on).row.status is RowStatus.FINISHED
