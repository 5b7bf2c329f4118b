"""A curve is known by its methods: every kind brings them, a new one included."""

import subprocess
import sys

import numpy as np
import pytest
from trajgap.heuristics import PSO, run
from trajgap.nlp import Status, solve
from trajgap.nlp.optimum.program import Program
from trajgap.problem import Array, Limits, Problem, TrajgapError, Verdict, check, fit
from trajgap.problem.curves import MAX_COEFFICIENTS, quintic_spline, solve_in_closed_form
from trajgap.problem.curves.kind import Shape
from trajgap.problem.curves.stretched import StretchedCurve

KINDS = {
    "ClampedBSpline": "(4, 5, 'averaged-continued')",
    "uniform_cubic_b_spline": "(4, 'timed')",
    "quintic_spline": "(3)",
}


def test_a_constructor_alone_is_enough_to_check_its_curve() -> None:
    # In a process that has imported nothing else; each kind before another one is named.
    program = "".join(
        f"from trajgap.problem import Limits, Problem, check, {name}\n"
        f"problem = Problem([[0.1], [0.9], [-0.3], [0.4]], Limits(9.0), {name}{given})\n"
        "print(check(problem, [0.8, 1.1, 0.9]).limits)\n"
        for name, given in KINDS.items()
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert (done.stdout, done.stderr) == ("pass\n" * len(KINDS), "")


class Chords(StretchedCurve):
    """Straight lines from way-point to way-point, each at one speed: no kind of the house."""

    name = "chords"
    segments = 3

    def shape(self, waypoints: Array) -> Shape:
        n, joints = self.segments, waypoints.shape[1]
        scaled = np.zeros((n, MAX_COEFFICIENTS, joints))
        scaled[:, 0], scaled[:, 1] = waypoints[:-1], np.diff(waypoints, axis=0)
        error = np.finfo(float).eps * np.abs(scaled)
        return Shape(np.arange(n), np.ones(n), 1, scaled, error)


def test_a_new_kind_is_checked_searched_and_solved() -> None:
    q = np.array([[0.1, 1.0], [0.9, 0.2], [-0.3, 0.5], [0.4, 0.4]])
    limits = Limits([2.0, 0.5])
    problem = Problem(q, limits, Chords(), 0.1, 9.0)
    least = (np.abs(np.diff(q, axis=0)) / limits.velocity).max(axis=1)
    np.testing.assert_allclose(solve_in_closed_form(Chords(), q, limits.derivatives), least)
    found = check(problem, least)
    assert found.limits is Verdict.PASS
    assert found.verdict is Verdict.DISCONTINUOUS
    assert check(problem, 0.99 * least).verdict is Verdict.VIOLATED
    solution = solve(problem)
    assert solution.status is Status.OPTIMAL
    np.testing.assert_allclose(solution.durations, least, rtol=1e-8)
    assert run(PSO(), problem, seed=1).reported_time >= least.sum() * (1 - 1e-9)


def test_what_asks_for_stretched_segments_refuses_others() -> None:
    q = np.array([[0.1], [0.9], [-0.3], [0.4]])
    with pytest.raises(TrajgapError, match=r"curve: the segments of C4 quintic .* not stretched"):
        solve_in_closed_form(quintic_spline(3), q, Limits(1.0).derivatives)


class Unsolved(Chords):
    """A kind that gives the NLP nothing to work with."""

    def shape(self, waypoints: Array) -> None:  # type: ignore[override]
        return None


def test_a_kind_without_expressions_is_refused_by_name() -> None:
    q = np.array([[0.1], [0.9], [-0.3], [0.4]])
    problem = Problem(q, Limits(1.0), Unsolved())
    with pytest.raises(TrajgapError, match="curve: no NLP is known for chords; use another curve"):
        Program(problem, 1.0, np.zeros(3))
    with pytest.raises(TrajgapError, match="not stretched"):
        fit(Unsolved(), q, [1.0, 1.0, 1.0])
