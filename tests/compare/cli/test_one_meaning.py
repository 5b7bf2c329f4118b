"""One meaning per verb: `solve` in Python and on the command line; a path is timed once."""

import json
from dataclasses import replace

import numpy as np
import pytest
from trajgap.compare.cli import solve_command as solving
from trajgap.nlp import Evidence, Solution, Status, exact_problem, shipped_file, solve
from trajgap.nlp.retiming import retime
from trajgap.problem import Coupling, Limits, Problem, fit, load_case, three_five_three


@pytest.mark.parametrize(
    "case_id", [pytest.param("puma560-mnam-pso-353", marks=pytest.mark.slow), "irb460-pso-353"]
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


@pytest.mark.parametrize(
    ("change", "evidence"),
    [
        ({"waypoints": 1 + 1e-13}, Evidence.BEST_KNOWN),
        ({"velocity": 1 + 1e-13}, Evidence.BEST_KNOWN),
        ({"duration_lower": 1 + 1e-13}, Evidence.BEST_KNOWN),
        ({"duration_upper": 9.0}, Evidence.BEST_KNOWN),
        ({"name": "typed by hand"}, Evidence.CERTIFIED),
    ],
)
def test_a_problem_next_to_a_certified_one_is_not_certified(change, evidence):
    known = load_case("puma560-mnam-pso-353").problem()
    assert solve(known).evidence is Evidence.CERTIFIED
    moved = known.waypoints.copy()
    moved[1, 0] *= change.get("waypoints", 1)
    limits = Limits(known.limits.velocity * change.get("velocity", 1), known.limits.acceleration)
    lower = known.duration_lower * change.get("duration_lower", 1)
    upper = change.get("duration_upper", known.duration_upper)
    name = change.get("name", known.name)
    given = Problem(moved, limits, three_five_three(), lower, upper, name=name)
    assert solve(given, starts=1, prove=0).evidence is evidence


def test_an_instance_of_the_suite_is_certified_in_python_too():
    assert solve(load_case("suite:353-irb460").problem()).evidence is Evidence.CERTIFIED


def test_a_number_longer_than_a_certificate_may_state_ends_nothing():
    problem = load_case("puma560-mnam-pso-353").problem()
    moved = problem.waypoints.copy()
    moved[1, 0] = 1e-300
    same = replace(problem, waypoints=moved)
    assert solve(same, starts=1).evidence is Evidence.BEST_KNOWN
    assert shipped_file(exact_problem(same)) is None


def test_one_motion_within_the_same_limits_is_timed_once(monkeypatch: pytest.MonkeyPatch) -> None:
    asked = []
    monkeypatch.setattr(solving, "retime", lambda *given: asked.append(given) or retime(*given))
    q = np.array([[0.13], [0.81], [0.32], [1.07]])
    problem = Problem(q, Limits([1.6], [4.0]), three_five_three())
    answer = Solution(problem, Status.FEASIBLE, vector=np.array([1.3, 1.1, 1.7]))
    longer = replace(answer, vector=np.array([1.3, 1.1, 1.8]))
    bounded = replace(answer, problem=replace(problem, duration_lower=np.full(3, 0.3)))
    slower = replace(answer, problem=replace(problem, limits=Limits([1.6], [3.0])))
    mirrored = replace(answer, problem=replace(problem, waypoints=-q))
    known: solving._Retimings = {}
    answers = (answer, longer, bounded, slower, mirrored, answer)
    found = [solving._retimed(one, known) for one in answers]
    assert len(asked) == 4
    assert found[2] is found[0] is found[5]
    for one, said in zip((answer, longer, bounded, slower, mirrored), found, strict=False):
        problem, h = one.problem, one.durations
        alone = retime(fit(problem.curve, problem.waypoints, h), problem.limits)
        assert str(said) == str(alone)
