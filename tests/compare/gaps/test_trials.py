import random
import time
from pathlib import Path

import numpy as np
import pytest
from support.small_studies import small_problem, small_trial
from trajgap.compare.gaps import RowStatus, canonical, origin_of, run_trial
from trajgap.heuristics import KINDS, PSO, run
from trajgap.problem import check


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
    assert judged.worst is not None
    assert row.worst_ratio == judged.worst.ratio
    assert row.feasible


def test_the_same_trial_gives_the_same_row() -> None:
    assert run_trial(small_trial()) == run_trial(small_trial())
    assert run_trial(small_trial()).durations != run_trial(small_trial(seed=4)).durations
    assert run_trial(small_trial()).durations != run_trial(small_trial(stream=(1,))).durations


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
    ("name", "message"),
    [
        ("support.optimizers:raises", "ZeroDivisionError: one over nothing!!!"),
        ("support.faulty:exits", "SystemExit: 3"),
        ("support.faulty:returns_nan", "returned NaN"),
        ("support.faulty:asks_nan", "asked for the fitness of NaN"),
        ("support.faulty:leaves_bounds", "outside its bounds"),
        ("support.faulty:swallows", "went on after its budget of 200 evaluations was spent"),
        ("support.faulty:judges_nothing", "judged no position"),
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


def test_a_spent_budget_ends_a_run_and_is_no_fault() -> None:
    row = run_trial(small_trial("support.optimizers:overspends"))
    assert (row.status, row.evaluations) == (RowStatus.FINISHED, 200)


@pytest.mark.parametrize("name", ["scribbles", "returns_short"])
def test_what_does_no_harm_changes_nothing(name: str) -> None:
    row = run_trial(small_trial(f"support.optimizers:{name}"))
    honest = run_trial(small_trial("support.optimizers:draws"))
    assert (row.durations, row.trace) == (honest.durations, honest.trace)


def test_what_a_run_does_to_its_process_ends_with_it() -> None:
    before = run_trial(small_trial("pso"))
    floats = np.geterr()
    assert run_trial(small_trial("support.optimizers:leaves_traces")).status is RowStatus.FINISHED
    assert np.geterr() == floats
    assert run_trial(small_trial("pso")) == before


def test_a_fork_in_the_calling_process_does_not_come_back(tmp_path: Path) -> None:
    returned = tmp_path / "returned"
    row = run_trial(small_trial("support.optimizers:forks"))
    with returned.open("a", encoding="utf-8") as file:
        file.write(row.status)
    assert row.durations == run_trial(small_trial("support.optimizers:draws")).durations
    assert returned.read_text(encoding="utf-8") == "finished"


def test_warnings_of_an_optimiser_are_its_own() -> None:
    assert run_trial(small_trial("support.optimizers:warns")).status is RowStatus.FINISHED


def test_a_run_that_takes_too_long_is_a_row_without_clock_times() -> None:
    begun = time.monotonic()
    row = run_trial(small_trial("support.optimizers:sleeps", seconds=0.3))
    assert time.monotonic() - begun < 60
    assert row == run_trial(small_trial("support.optimizers:sleeps", seconds=0.3))
    assert row.message == (
        "support.optimizers:sleeps: took longer than 0.3 s; raise the time limit, or look where "
        "it hangs"
    )


def test_a_run_that_judges_nothing_feasible_has_no_time() -> None:
    # The middle of a box of very short durations breaks every limit.
    trial = small_trial("support.optimizers:warns")
    object.__setattr__(trial.problem, "duration_upper", np.full(3, 0.21))
    row = run_trial(trial)
    assert (row.status, row.reported_time, row.trace) == (RowStatus.FINISHED, None, ())
    assert row.feasible_why == "nothing feasible was judged"


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
