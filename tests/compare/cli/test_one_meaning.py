"""One meaning per verb: `solve` in Python and on the command line."""

import json

import pytest
from trajgap.nlp import Evidence, exact_problem, shipped_file, solve
from trajgap.problem import Coupling, Limits, Problem, load_case, three_five_three


@pytest.mark.parametrize(
    "case_id",
    [pytest.param("puma560-mnam-pso-353", marks=pytest.mark.slow), "irb460-pso-353"],
)
def test_python_and_the_command_line_solve_alike(run, case_id):
    shown = json.loads(run("solve", case_id, "--json")[1])["results"]
    case = load_case(case_id)
    for result in shown:
        problem = case.problem(result["problem"], result["reading"])
        found = solve(problem)
        said = result["shared"] if problem.coupling is Coupling.PER_JOINT else result
        assert said["evidence"] == found.evidence
        assert said["status"] == found.status
        assert said["total_time"] == pytest.approx(found.total_time, rel=1e-12)
        assert said["lower_bound"] == found.lower_bound
    assert any(solve(case.problem(r["problem"], r["reading"])).evidence is Evidence.CERTIFIED
               for r in shown)  # fmt: skip


def test_a_problem_next_to_a_certified_one_is_not_certified():
    case = load_case("puma560-mnam-pso-353")
    problem = case.problem()
    assert solve(problem).evidence is Evidence.CERTIFIED
    moved = problem.waypoints.copy()
    moved[1, 0] *= 1 + 1e-13
    limits = Limits(problem.limits.velocity * (1 + 1e-13), problem.limits.acceleration)
    other = (
        {"waypoints": moved},
        {"limits": limits},
        {"duration_lower": problem.duration_lower * (1 + 1e-13)},
        {"duration_upper": 9.0},
    )
    for change in other:
        given = {
            "waypoints": problem.waypoints,
            "limits": problem.limits,
            "duration_lower": problem.duration_lower,
            "duration_upper": problem.duration_upper,
            **change,
        }
        again = Problem(curve=three_five_three(), **given)
        assert solve(again, starts=1).evidence is Evidence.BEST_KNOWN, change


def test_names_do_not_matter():
    problem = load_case("puma560-mnam-pso-353").problem()
    same = Problem(
        problem.waypoints, problem.limits, three_five_three(),
        problem.duration_lower, problem.duration_upper, name="typed by hand",
    )  # fmt: skip
    assert solve(same, starts=1).lower_bound == solve(problem, starts=1).lower_bound


def test_an_instance_of_the_suite_is_certified_in_python_too():
    assert solve(load_case("suite:353-irb460").problem()).evidence is Evidence.CERTIFIED


def test_a_number_longer_than_a_certificate_may_state_ends_nothing():
    problem = load_case("puma560-mnam-pso-353").problem()
    moved = problem.waypoints.copy()
    moved[1, 0] = 1e-300
    same = Problem(
        moved, problem.limits, three_five_three(), problem.duration_lower, problem.duration_upper
    )
    assert solve(same, starts=1).evidence is Evidence.BEST_KNOWN
    assert shipped_file(exact_problem(same)) is None
