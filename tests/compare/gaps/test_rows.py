import json
import math

import numpy as np
import pytest
from support.small_studies import small_problem, small_trial
from trajgap.compare.gaps import Bracket, Row, against, canonical, checkpoints, run_trial, trace_of
from trajgap.nlp import certificate, certify, exact_problem, problem_seal
from trajgap.problem import Limits, Problem, TrajgapError, three_five_three


def test_a_problem_is_hashed_as_certificates_do() -> None:
    waypoints = [[0.25], [0.75], [1.25], [0.875]]
    problem = Problem(waypoints, Limits(6.0, 8.0), three_five_three(), 0.25, 3.0)
    document = certificate(certify(exact_problem(problem)))
    assert problem_seal(problem) == document["problem_hash"]


@pytest.mark.parametrize(
    "change",
    [
        {"seed": 4},
        {"budget": 201},
        {"optimizer": "support.optimizers:overspends"},
        {"settings": '{"a":1}'},
        {"handling": "stretch"},
        {"stream": (1,)},
        {"origin": "sha256:other"},
        {"name": "mine/other"},
        {"reading": "other"},
    ],
)
def test_whatever_determines_a_run_changes_its_key(change: dict[str, object]) -> None:
    assert small_trial(**{"optimizer": "support.optimizers:draws", **change}).key != (
        small_trial().key
    )


def test_a_way_point_changes_the_key_and_the_reference_does_not() -> None:
    moved = small_problem().waypoints.copy()
    moved[1, 0] = np.nextafter(moved[1, 0], 2)
    given = small_problem()
    other = Problem(moved, given.limits, given.curve, 0.2, 6.0, name="small")
    trial = small_trial()
    assert problem_seal(other) != trial.problem_sha256
    assert small_trial(reference=None, seconds=1.0).key == trial.key


def test_a_key_stays_what_it_is() -> None:
    # Stores of an earlier version would run everything again: raise ROW_FORMAT with this number.
    assert small_trial().key == KEY


KEY = "d5604aec1ad85ca652853b012f16b9efb3035854cbde14d046beed157aa30dc7"


def test_a_row_is_read_as_it_was_written() -> None:
    row = run_trial(small_trial())
    assert row.trace
    assert row.durations
    assert Row.read(row.text()) == row
    assert "\n" not in row.text()
    json.loads(row.text(), parse_constant=pytest.fail)


@pytest.mark.parametrize("text", ["", "{}", "[1]", '{"key": 1}'])
def test_what_is_no_row_is_refused(text: str) -> None:
    with pytest.raises(TrajgapError, match=r"row: cannot be read .*was the file altered\?"):
        Row.read(text)


def test_gaps_are_intervals_and_are_never_clipped() -> None:
    row = run_trial(small_trial())
    assert row.reported_time
    assert row.feasible_time
    row = against(row, Bracket(2 * row.reported_time, 1.5 * row.reported_time))
    assert row.reported_gap == pytest.approx((-1 / 2, -1 / 3))
    assert row.feasible_gap == pytest.approx((-1 / 2, -1 / 3), abs=1e-6)
    row = against(row, Bracket(row.reported_time / 2))
    assert row.reported_gap == pytest.approx((1.0, 1.0))
    assert row.reference_lower is None
    bare = against(row, None)
    assert bare.reported_gap is bare.feasible_gap is bare.reference_upper is None
    assert bare.reported_time == row.reported_time


@pytest.mark.parametrize("ends", [(0.0, None), (math.inf, None), (1.0, 1.1), (1.0, 0.0)])
def test_a_reference_that_is_none_is_refused(ends: tuple[float, float | None]) -> None:
    with pytest.raises(TrajgapError, match=r"reference: .* is n"):
        Bracket(*ends)


def test_a_trial_that_cannot_be_run_is_refused() -> None:
    with pytest.raises(TrajgapError, match="handling: 'squeeze' is unknown; choose death-penalty"):
        small_trial(handling="squeeze")
    with pytest.raises(TrajgapError, match="trial: give a seed of 0 or more and a budget of 1"):
        small_trial(budget=0)
    with pytest.raises(TrajgapError, match=r"settings: .*; use finite numbers"):
        canonical({"a": math.nan})


def test_the_trace_is_the_best_so_far_at_every_checkpoint() -> None:
    totals = np.minimum.accumulate(np.random.default_rng(5).uniform(3, 9, 4000))
    totals[:17] = np.inf
    trace = trace_of(totals)
    assert trace[0][0] >= 18
    for point in checkpoints(4000):
        known = [total for at, total in trace if at <= point]
        assert (known[-1] if known else np.inf) == totals[point - 1]
    assert len(trace) < 140


def test_checkpoints_are_log_spaced_and_end_at_the_last_evaluation() -> None:
    assert checkpoints(0) == ()
    assert checkpoints(1) == (1,)
    points = checkpoints(6030)
    assert points[:5] == (1, 2, 3, 4, 5)
    assert points[-1] == 6030
    assert points == tuple(sorted(set(points)))
    late = np.array([p for p in points if p > 100], dtype=float)
    assert (late[1:] / late[:-1] < 1.09).all()
