"""The loop: what a run says of itself, seeds, traces, runs side by side, and interrupts."""

import os
import signal
import subprocess
import sys
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest
from support.drawn_settings import drawn
from support.positions import SWINGING
from support.two_joints import WAYPOINTS, two_joints
from trajgap.heuristics import (
    GA,
    KINDS,
    MNAMPSO,
    PSO,
    WOA,
    AskedRun,
    Bounds,
    ConstrainedPSO,
    DeathPenalty,
    Handling,
    ImprovedGA,
    ImprovedWOA,
    JointRuns,
    Run,
    Search,
    Stretch,
    find_optimizer,
    from_settings,
    run,
    run_as_left,
    run_asked,
    run_many,
    run_many_per_joint,
    run_per_joint,
    states,
)
from trajgap.heuristics.repair import judge_of
from trajgap.heuristics.side_by_side import TOGETHER, moves_together
from trajgap.problem import Limits, Problem, TrajgapError, Verdict, check, curves

BOUNDS = {"duration_lower": 0.3, "duration_upper": 3.0}
PROBLEM = two_joints(**BOUNDS, joints=("waist", "elbow"), name="two joints")
STUCK = two_joints(Limits([6.0, 0.0], joints=2), duration_upper=3.0)
JERKY_LIMITS = Limits([4.0, 5.0], [8.0, 9.0], [60.0, 80.0])
JERKY = two_joints(JERKY_LIMITS, duration_lower=0.1, duration_upper=9.0)
SPLINE = Problem(WAYPOINTS[:, 0], Limits(2.5, 6.0), curves.cubic_spline(3), 0.05, 2.5)
WALK = np.random.default_rng(31).uniform(-2, 2, (10, 3))
LONG_LIMITS = Limits([2.0, 3.0, 2.5], [6.0, 5.0, 9.0])
LONG = Problem(WALK, LONG_LIMITS, curves.quintic_spline(9), 0.0, 6.0, name="nine segments")
SEARCHES = (
    PSO(),
    MNAMPSO(),
    ConstrainedPSO(iterations=200, position_rule="bounds", position_max=9.0),
    WOA(position_initial=(0.3, 3.0)),
    ImprovedWOA(position_initial=(0.3, 3.0)),
    GA(population=32, position_range=(0.05, 3.0)),
    ImprovedGA(population=32, position_range=(0.05, 3.0)),
    *(
        replace(find_optimizer(f"scipy:{name}"), per_iteration=30)
        for name in ("differential_evolution", "dual_annealing", "shgo")
    ),
)
ALGORITHMS = tuple(replace(one, iterations=200) for one in SEARCHES[:7])
each_algorithm = pytest.mark.parametrize("algorithm", ALGORITHMS, ids=lambda a: a.kind)
PENAL = Handling.DEATH_PENALTY


@pytest.mark.parametrize("handling", Handling)
@pytest.mark.parametrize("search", SEARCHES, ids=lambda s: s.kind)
def test_the_account_of_a_run(search: Search, handling: Handling) -> None:
    for problem in (PROBLEM, JERKY, SPLINE, LONG, SWINGING):
        found = run(search, problem, 3, 40, objective=handling)
        assert (found.algorithm, found.objective) == (search.kind, handling)
        assert found.iterations == found.settings.iterations == 40
        assert found.trace.shape == (41,)
        assert (found.trace[1:] <= found.trace[:-1]).all()
        judge = judge_of(problem, np.inf, handling)
        np.testing.assert_array_equal(judge.decode(found.position[None])[0], found.durations)
        mutants = 41 if search.kind == "mnam-pso" else 0
        most = 41 * (32 if "ga" in search.kind.split("-") else 30) + mutants
        assert found.evaluations == most if search in SEARCHES[:7] else found.evaluations <= most
        assert found.feasible or handling is PENAL
        if found.feasible:
            assert found.reported_time == found.trace[-1] == found.durations.sum()
            assert check(problem, found.durations).verdict is Verdict.PASS
            assert DeathPenalty(problem)(found.durations[None])[0] == found.reported_time


def same_bits(a: Run, b: Run) -> None:
    for name in ("durations", "trace", "position"):
        assert getattr(a, name).tobytes() == getattr(b, name).tobytes()
    for name in (
        "algorithm", "settings", "problem", "objective", "seed", "stream", "reported_time",
        "evaluations", "iterations", "feasible",
    ):  # fmt: skip
        assert repr(getattr(a, name)) == repr(getattr(b, name))


@pytest.mark.parametrize(
    ("algorithm", "handling"),
    [
        (MNAMPSO(), "death-penalty"),
        (SEARCHES[7], "death-penalty"),
        pytest.param(WOA(), "stretch", marks=pytest.mark.slow),
    ],
)
def test_same_bits_for_any_number_of_workers(algorithm: PSO, handling: str) -> None:
    seeds = [5, 3, 11, 3]
    one = run_many(algorithm, PROBLEM, seeds, iterations=10, objective=handling)
    two = run_many(algorithm, PROBLEM, seeds, workers=2, iterations=10, objective=handling)
    assert [r.seed for r in one] == [r.seed for r in two] == seeds
    for a, b in zip(one, two, strict=True):
        same_bits(a, b)
        same_bits(a, run(algorithm, PROBLEM, a.seed, 10, handling))
        each = [x for one in (a, b) for x in (one.durations, one.trace, one.position)]
        assert not any(x.flags.writeable for x in each)


@pytest.mark.parametrize("judge", [DeathPenalty(PROBLEM), Stretch(PROBLEM)])
def test_the_trace_is_the_best_of_each_iteration(judge: DeathPenalty) -> None:
    rng = np.random.Generator(np.random.PCG64(6))
    smallest = [
        DeathPenalty(PROBLEM)(judge.decode(s.positions)).min()
        for s in states(PSO(), judge, Bounds.of(PROBLEM), rng)
    ]
    handling = "stretch" if isinstance(judge, Stretch) else "death-penalty"
    trace = run(PSO(), PROBLEM, 6, objective=handling).trace
    np.testing.assert_array_equal(trace, np.minimum.accumulate(smallest))


@each_algorithm
@pytest.mark.parametrize("penalty", [np.inf, 1e6])
def test_nothing_feasible(algorithm: PSO, penalty: float) -> None:
    found = run(replace(algorithm, penalty=penalty), STUCK, 0, 20)
    assert not found.feasible
    assert found.reported_time == np.inf
    assert np.isinf(found.trace).all()
    assert np.isfinite(found.durations).all()
    assert "nothing feasible found" in str(found)


def test_a_swarm_that_overflows_is_only_infeasible() -> None:
    wild = PSO(inertia=9.0, velocity_rule="free", position_rule="free", iterations=500)
    assert run(wild, PROBLEM, 0).feasible


def test_joints_by_themselves() -> None:
    found = run_per_joint(PSO(), PROBLEM, 12, iterations=30)
    assert isinstance(found, JointRuns)
    children = np.random.SeedSequence(12).spawn(2)
    for j, (one, child) in enumerate(zip(found.runs, children, strict=True)):
        problem = PROBLEM.joint(j)
        rng = np.random.Generator(np.random.PCG64(child))
        record = PSO(iterations=30)
        *_, last = states(record, DeathPenalty(problem), Bounds.of(problem), rng)
        assert one.durations.tobytes() == last.best.tobytes()
        assert (one.seed, one.stream, one.problem) == (12, (j,), problem.name)
        assert check(problem, one.durations).verdict is Verdict.PASS
    a, b = (one.durations for one in found.runs)
    assert (a > b).any()
    assert (b > a).any()
    np.testing.assert_array_equal(found.durations, np.where(a > b, a, b))
    assert found.reported_time == found.durations.sum()
    assert found.feasible
    assert "each joint separately" in str(found)


def test_a_joint_that_finds_nothing() -> None:
    found = run_per_joint(PSO(), STUCK, 0, iterations=3)
    assert [one.feasible for one in found.runs] == [True, False]
    assert not found.feasible
    assert found.reported_time == np.inf
    assert "some joint found nothing" in str(found)


@pytest.mark.parametrize("workers", [1, pytest.param(2, marks=pytest.mark.slow)])
def test_progress_comes_in_order(workers: int) -> None:
    seen: list[int] = []
    run_many(PSO(), PROBLEM, [4, 2, 9], workers, 2, progress=lambda r: seen.append(r.seed))
    assert seen == [4, 2, 9]


def test_no_seeds_and_seeds_of_numpy() -> None:
    assert run_many(PSO(), PROBLEM, []) == run_many(PSO(), PROBLEM, [], workers=4) == ()
    same_bits(run(PSO(), PROBLEM, np.int64(3), 2), run(PSO(), PROBLEM, 3, 2))


SEEDS = (-1, 1.5, "one", True, None)


@pytest.mark.parametrize(
    ("call", "values", "said"),
    [
        (lambda x: run(PSO(), PROBLEM, x, 1), SEEDS, "seed: expected a whole number of 0"),
        (lambda x: run_per_joint(PSO(), PROBLEM, x, 1), SEEDS, "seed: expected a whole number"),
        (lambda x: run_many(PSO(), PROBLEM, [0, x]), SEEDS, "seed: expected a whole number"),
        (lambda x: run_many_per_joint(PSO(), PROBLEM, [0, x]), SEEDS, "seed: expected a whole"),
        (lambda x: run_many(PSO(), PROBLEM, [0], x), (0, -2, 1.0), "workers: .* whole .* of 1"),
        (lambda x: run(PSO(), PROBLEM, 0, x), (-1, 2.5), "pso: iterations: .* whole number of 0"),
    ],
)
def test_what_must_be_whole(
    call: Callable[[object], object], values: tuple[object, ...], said: str
) -> None:
    for value in values:
        with pytest.raises(TrajgapError, match=f"^{said}"):
            call(value)


SLOWER = Problem(WAYPOINTS, Limits([2.0, 1.5], [8.0, 3.0]), curves.quintic_spline(3), 0.1, 4.0)
STOPPING = Problem(WAYPOINTS, Limits([2.0, 1.5], [8.0, 3.0]), curves.rest_to_rest(3, 5), 0.1, 4.0)


@pytest.mark.parametrize("kind", KINDS)
def test_questions_of_all_sorts_and_every_choice_together(kind: str) -> None:
    for seed in range(13):
        algorithm = drawn(kind, np.random.default_rng(seed)) if seed else from_settings(kind, {})
        algorithm = replace(algorithm, iterations=12)
        assert moves_together(algorithm) == (kind != "constrained-pso")
        questions = [
            AskedRun(problem, at, (), handling)
            for problem in (PROBLEM, SLOWER, STOPPING)
            for handling in Handling
            for at in (3, 8)
        ]
        for one, found in zip(questions, run_asked(algorithm, questions), strict=True):
            same_bits(found, run(algorithm, one.problem, one.seed, None, one.handling))


def test_joints_and_more_seeds_than_are_moved_at_once() -> None:
    algorithm = MNAMPSO(particles=6, iterations=3)
    seeds = range(TOGETHER // 2 + 2)
    for seed, found in zip(seeds, run_many_per_joint(algorithm, PROBLEM, seeds), strict=True):
        alone = run_per_joint(algorithm, PROBLEM, seed)
        assert found.durations.tobytes() == alone.durations.tobytes()
        for j, (a, b) in enumerate(zip(found.runs, alone.runs, strict=True)):
            same_bits(a, b)
            same_bits(a, run_asked(algorithm, [AskedRun(PROBLEM.joint(j), seed, (j,))])[0])


def test_a_subclass_that_says_nothing_is_moved_by_itself() -> None:
    @dataclass(frozen=True)
    class Own(PSO):
        """Whose step may know of single swarms only."""

    assert moves_together(PSO())
    assert not moves_together(Own())
    questions = [AskedRun(PROBLEM, seed) for seed in (1, 2)]
    own, plain = (run_asked(kind(iterations=4), questions) for kind in (Own, PSO))
    for a, b in zip(own, plain, strict=True):
        assert a.trace.tobytes() == b.trace.tobytes()


@pytest.mark.slow
def test_an_interrupt_is_answered_by_the_parent_alone(tmp_path: Path) -> None:
    # A terminal sends Ctrl-C to every process of the group. After two of three runs one worker is
    # busy and one waits, where KeyboardInterrupt would print a traceback.
    started = tmp_path / "many.py"
    started.write_text(
        "import sys\n"
        "from trajgap.heuristics import PSO, run_many\n"
        "from trajgap.problem import load_case\n"
        "if __name__ == '__main__':\n"
        "    problem = load_case('irb460-pso-353').problem()\n"
        "    try:\n"
        "        run_many(PSO(), problem, range(3), 2, 2000,\n"
        "                 progress=lambda r: print('one', flush=True))\n"
        "    except KeyboardInterrupt:\n"
        "        sys.exit(130)\n",
        encoding="utf-8",
    )
    command, pipe = [sys.executable, str(started)], subprocess.PIPE
    process = subprocess.Popen(command, stdout=pipe, stderr=pipe, text=True, start_new_session=True)
    assert process.stdout is not None
    assert [process.stdout.readline() for _ in range(2)] == ["one\n"] * 2
    os.killpg(process.pid, signal.SIGINT)
    _, err = process.communicate(timeout=60)
    assert (process.returncode, err) == (130, "")


def test_a_run_that_was_left_is_judged_again() -> None:
    swarm, question = PSO(iterations=20), AskedRun(PROBLEM, 3)
    (own,) = run_asked(swarm, [question])

    def left(trace: np.ndarray = own.trace, position: np.ndarray = own.position) -> Run:
        return run_as_left(swarm, question, trace.copy(), position.copy(), own.evaluations)

    again = left()
    assert again.reported_time == own.reported_time
    assert (again.durations == own.durations).all()
    assert (again.trace == own.trace).all()
    for said, wrong in (
        ("another size", {"trace": own.trace[:-1]}),
        ("another size", {"position": own.position[:-1]}),
        ("does not end at", {"trace": own.trace[::-1]}),
        ("does not end at", {"position": own.position * (1 + 1e-15)}),
        ("does not end at", {"position": own.position * 0.5}),
        ("does not end at", {"trace": np.append(own.trace[:-1], np.nextafter(own.trace[-1], 0))}),
    ):
        with pytest.raises(TrajgapError, match=said):
            left(**wrong)
