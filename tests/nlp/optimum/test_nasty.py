"""Nasty problems that were once answered wrongly, and answers that must not look at the clock."""

from __future__ import annotations

import itertools
import json
import math
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from attacks.nasty import answered, nasty, rebuilt
from trajgap.nlp import Solution, Status, certify, solve
from trajgap.nlp.optimum import limit_rows, optimality, solver
from trajgap.nlp.optimum.limit_rows import exact_rows
from trajgap.nlp.optimum.optimality import kkt
from trajgap.nlp.proofs import exact_problem
from trajgap.problem import (
    Limits,
    Problem,
    SingularError,
    Verdict,
    check,
    quintic_spline,
    three_five_three,
)

MISSED = json.loads(Path(__file__).with_name("missed.json").read_text("utf-8"))
"""Problems beside whose durations `solve` once found nothing, or worse: boxes of durations in which
one is 1e-5 of the others, way-points that coincide, ranges and sides that leave no room."""


@pytest.mark.parametrize("kept", MISSED, ids=lambda kept: kept["name"])
def test_no_known_durations_are_missed(kept: dict) -> None:
    problem, h = rebuilt(kept)
    assert check(problem, h).verdict is Verdict.PASS
    answered(problem, h)


@pytest.mark.parametrize("number", [13, 119, 123, *range(5)])
def test_seeded_nasty_problems(number: int, tmp_path: Path) -> None:
    """13: rounding hides the tight motion; 119, 123: totals that fall far below floors of 1e-4."""
    nasty(np.random.default_rng([20261123, number]), tmp_path)


@pytest.mark.slow
def test_five_hundred_nasty_problems(tmp_path: Path) -> None:
    for number in range(500):
        nasty(np.random.default_rng([20261123, number]), tmp_path)


def two_joints() -> Problem:
    q = np.array([[0.3, 1.0], [0.9, 0.2], [0.5, 0.4], [1.4, 0.8]])
    return Problem(q, Limits([1.0, 2.0], 3.0), three_five_three())


def near_coincident() -> Problem:
    """Way-points 9e-10 apart: a search comes to durations at which rounding hides the spline."""
    q = [[0.00018505375872587249], [-6.026289978938524e-05], [-6.0263766136627984e-05]]
    limits = Limits(acceleration=[3.277876011875105e-05], jerk=[0.0001800391467268852])
    return Problem(q, limits, quintic_spline(4, ((1, 0.0), (2, 0.0), (3, 0.0)), virtual=(1, 3)))


def test_rounding_that_hides_a_spline_is_undecided_and_raises_nothing(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    problem = near_coincident()
    hidden = [3.26329483e-07, 6.48742924, 3.10591737e-08, 3.67050879e-02]
    assert check(problem, hidden).verdict is Verdict.UNDECIDED

    def singular(*_: object) -> None:
        raise SingularError("singular", 0)

    for module in (limit_rows, optimality):
        monkeypatch.setattr(module, "fit", singular)
    assert exact_rows(problem, np.array(hidden)).worst == np.inf
    assert kkt(problem, np.array(hidden)).residual == np.inf


@pytest.mark.slow
def test_a_search_among_singular_splines_ends() -> None:
    solution = solve(near_coincident())
    assert solution.check is not None
    assert solution.check.verdict is Verdict.PASS


def test_a_value_approached_is_called_infimum_only_where_that_is_proved() -> None:
    problem = two_joints()
    open_ = Solution(problem, Status.NOT_ATTAINED, durations=np.ones(3), infimum=2.5)
    assert "infimum" not in str(open_)
    assert "approached      2.500000000 s as a duration goes to 0: an estimate" in str(open_)
    assert "infimum" not in str(replace(open_, lower_bound=2.4))
    assert "infimum         2.500000000 s" in str(replace(open_, lower_bound=2.5))
    assert "infimum         0.000000000 s" in str(replace(open_, infimum=0.0))


def test_a_known_motion_counts_stretched_until_it_keeps_the_limits() -> None:
    """The same ratios at 0.3 and at 4 times the durations are worth as much as tight ones."""
    problem = two_joints()
    best = solve(problem)
    poor = np.array([[9.0, 0.5, 0.5]])
    for factor in (0.3, 4.0):
        asked = solver.asked(problem, 1, 0, poor, factor * best.durations, None, None, 0.0)
        worse = Solution(problem, Status.FEASIBLE, durations=poor[0])
        found = solver._with_known(problem, worse, asked)
        assert found.total_time == pytest.approx(best.total_time, rel=1e-8)
        assert found.check is not None
        assert found.check.verdict is Verdict.PASS


def test_no_answer_depends_on_the_clock(monkeypatch: pytest.MonkeyPatch) -> None:
    """Under a clock on which each look takes an hour, as on a machine that does much else."""
    problem = replace(two_joints(), duration_upper=[9.0, 9.0, 9.0])
    exact = exact_problem(problem)
    asked = {"gap": 1e-9, "seconds": math.inf, "boxes": 40}
    before, proved = solve(problem), certify(exact, **asked)
    hours = itertools.count(1e6, 3600.0)
    for name in ("perf_counter", "monotonic", "time"):
        monkeypatch.setattr(time, name, lambda: next(hours))
    after, again = solve(problem), certify(exact, **asked)
    assert after.status is before.status
    assert after.durations.tolist() == before.durations.tolist()
    assert (again.lower, again.upper, again.nodes) == (proved.lower, proved.upper, proved.nodes)
    assert 0 < proved.nodes < 200
