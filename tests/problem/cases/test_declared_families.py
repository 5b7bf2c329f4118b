"""Every family that a case file can declare goes through the checker and the solver."""

import numpy as np
import pytest
from support.case_texts import case_text
from trajgap.nlp import Status
from trajgap.nlp.optimum import solve
from trajgap.problem import Problem, Verdict, check, parse_case
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


def test_the_table_names_every_family() -> None:
    assert {name.split()[0] for name in FAMILIES} == set(declaration.FAMILIES)


@pytest.mark.parametrize("name", FAMILIES)
def test_a_declared_family_is_checked_and_solved(name: str) -> None:
    # Segments that are stretched by themselves jump in velocity between them.
    kept = Verdict.DISCONTINUOUS if "stretched" in name else Verdict.PASS
    problem = declared(name)
    h = np.linspace(2.0, 3.0, problem.segments)
    slow = check(problem, h)
    assert (slow.verdict, slow.limits) == (kept, Verdict.PASS)
    solution = solve(problem, starts=2)
    assert solution.status is Status.CONVERGED
    assert solution.check is not None
    assert solution.check.verdict is kept
    assert solution.total_time < h.sum()
