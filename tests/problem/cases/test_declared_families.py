"""Every family that a case file can declare goes through the checker, the solver and a search."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from support.case_texts import case_text
from trajgap.heuristics import PSO, run
from trajgap.nlp import Status
from trajgap.nlp.optimum import solve
from trajgap.problem import (
    Problem,
    Verdict,
    check,
    ctraj,
    cubic_spline,
    forward_kinematics,
    load_robot,
    parse_case,
    scaffold,
)
from trajgap.problem.cases import declaration

WAYPOINTS = ((0.3, -1.0), (0.9, -0.55), (0.2, 0.35), (-0.45, 0.1))
FAMILIES = {
    "3-5-3": "",
    "polynomials": "degrees = [4, 3, 4]",
    "cubic-spline": "",
    "quintic-spline": "",
    "quintic-spline 4": "end_orders = [1, 2, 3, 4]\nvirtual = [1, 3, 4, 6]",
    "septic-spline": "",
    "cubic-spline-virtual": "",
    "quintic-spline-virtual": "",
    "rest-to-rest 5": "degree = 5",
    "rest-to-rest 7": "degree = 7",
    "jtraj": "",
    "uniform-cubic-b-spline stretched": 'time = "stretched"',
    "uniform-cubic-b-spline timed": 'time = "timed"',
    "clamped-b-spline 5": 'degree = 5\nknots = "waypoints"\nparameters = "times"',
    "clamped-b-spline 4": 'degree = 4\nknots = "averaged-continued"\nparameters = "chord"',
}


def declared(name: str) -> Problem:
    text = case_text(
        f"waypoint_rows = {[list(row) for row in WAYPOINTS]}",
        f'family = "{name.split()[0]}"\n{FAMILIES[name]}',
        unit="rad",
        limits="velocity = [1.1, 1.7]\nacceleration = [3.0, 2.2]",
        more="[durations]\nlower = 0.25",
    )
    return parse_case(text, "family.toml").problem()


def through(problem: Problem, kept: Verdict = Verdict.PASS) -> None:
    """Check, solve and one seeded search agree about a problem; ``kept`` where limits hold."""
    h = np.linspace(2.0, 3.0, problem.segments)
    slow = check(problem, h)
    assert slow.verdict is kept
    assert slow.limits is Verdict.PASS
    hasty = check(problem, 0.02 * h)
    assert hasty.limits is Verdict.VIOLATED
    solution = solve(problem, starts=2)
    assert solution.status is Status.CONVERGED
    assert solution.check is not None
    assert solution.check.verdict is kept
    assert solution.total_time < h.sum()
    assert solution.found
    span = 0.05, 3.0 * float(solution.durations.max())
    swarm = PSO(particles=12, iterations=20, position_initial=span)
    found = run(swarm, problem, 5, None, "stretch")
    assert check(problem, found.durations).limits is Verdict.PASS
    # A swarm ends above the optimum, after 252 evaluations within half of it.
    assert solution.total_time * (1 - 1e-9) <= found.reported_time
    assert found.reported_time <= 1.5 * solution.total_time


def test_the_table_names_every_family() -> None:
    assert {name.split()[0] for name in FAMILIES} == set(declaration.FAMILIES)


@pytest.mark.parametrize("name", FAMILIES)
def test_a_declared_family_is_checked_solved_and_searched(name: str) -> None:
    # Segments that are stretched by themselves jump in velocity between them.
    through(declared(name), Verdict.DISCONTINUOUS if "stretched" in name else Verdict.PASS)


def test_a_straight_line_becomes_a_case_file(tmp_path: Path) -> None:
    arm, start = load_robot("puma560"), np.array([0.1, -0.6, 0.4, 0.2, 0.5, 0.1])
    last = forward_kinematics(arm, start)
    last[:3, 3] += [0.02, 0.12, 0.06]
    line = ctraj(arm, forward_kinematics(arm, start), last, 5, guess=start)
    (tmp_path / "line.csv").write_text(line.table)
    units = {"position": "rad", "velocity": "rad/s", "acceleration": "rad/s^2"}
    limits = {"velocity": "2.0", "acceleration": "8.0"}
    text = scaffold(tmp_path / "line.csv", units, family="cubic-spline", **limits)
    problem = parse_case(text, "line.toml").problem()
    np.testing.assert_array_equal(problem.waypoints, line.waypoints)
    assert problem.curve == cubic_spline(4)
    assert problem.joints == line.chain.labels
