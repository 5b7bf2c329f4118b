"""`solve` on problems on which it once gave wrong answers, and what it may say without a proof."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import minimize
from support.benchmarks import loaded
from support.made_up import paper, row, sentence
from support.near_problems import NEAR
from support.two_joints import TURNING
from trajgap.compare import audit
from trajgap.nlp import Solution, Status, solve_per_joint
from trajgap.nlp.optimum import feasibility, solve
from trajgap.nlp.optimum.descent import descend, least_point, restored
from trajgap.nlp.optimum.optimality import kkt
from trajgap.nlp.optimum.starts import LogBox, box_above, least_durations, slowed
from trajgap.problem import Limits, Problem, TrajgapError, Verdict, check, curves, fit, parse_case


def test_an_audit_never_calls_best_known_what_its_own_checks_undercut() -> None:
    parts = row("keeps", "0.64009 0.00000125908"), sentence("shortest", "optimal", "keeps")
    curve = {"family": "cubic-spline", "end_orders": [2]}
    points = [[0.656747, 0.147626, 0.147625]]
    text = paper(points, *parts, curve=curve, velocity=0.796, acceleration=2.0)
    report = audit(parse_case(text, "near.toml"), seeds=2, certify_seconds=0)
    study = report.cases[0].study
    optimum = study.optimum(study.pairs[0])
    assert optimum.best < 0.64009 + 0.00000125908
    relaxed = study.relaxed(study.pairs[0])
    assert relaxed.best <= optimum.best * (1 + 1e-9)


def test_a_known_motion_is_never_undercut_by_the_answer() -> None:
    problem = replace(TURNING, duration_upper=[9.0, 9.0, 9.0])
    best = solve(problem)
    poor = solve(problem, initial=[[8.9, 8.9, 8.9]], known=best.durations)
    assert poor.best <= best.best * (1 + 1e-9)
    breaking = 0.5 * best.durations
    again = solve(problem, known=[breaking, 1.1 * best.durations])
    assert again.durations == pytest.approx(best.durations, rel=1e-6)


def test_a_known_motion_is_kept_if_the_solver_finds_none(monkeypatch: pytest.MonkeyPatch) -> None:
    from trajgap.nlp.optimum import solver

    problem = TURNING
    known = 1.3 * solve(problem).durations
    monkeypatch.setattr(solver, "_widely", lambda one, *_: Solution(one, Status.NONE_FOUND, "lost"))
    monkeypatch.setattr(solver, "decided", lambda *_: None)
    assert solve(problem).status is Status.NONE_FOUND
    found = solve(problem, known=known)
    assert found.total_time <= known.sum()
    assert found.check.verdict is Verdict.PASS


def test_known_motions_of_each_joint_and_of_free_curves() -> None:
    problem = TURNING
    own = solve(problem.joint(1))
    known = {"2": own.durations}
    answer = solve_per_joint(
        problem, slacks=(), solver=lambda one: solve(one, known=known.get(one.joints[0]))
    )
    assert answer.joints[1].best <= own.best * (1 + 1e-9)
    free = replace(problem.joint(0), curve=curves.piecewise((5, 5, 5), 2))
    best = solve(free)
    kept = solve(free, initial=[[9.0, 9.0, 9.0]], known=best.durations, known_nodal=[best.nodal])
    assert kept.best <= best.best * (1 + 1e-9)


def test_a_known_motion_far_above_a_proved_bound_ends_no_search() -> None:
    best = solve(TURNING).total_time
    known = 1.4 * solve(TURNING).durations
    found = solve(TURNING, known=[known], lower=0.9 * best)
    assert found.total_time == pytest.approx(best, rel=1e-9)


def test_free_derivatives_of_a_slower_motion_are_those_of_the_same_way() -> None:
    problem = Problem([0.0, 1.0, -0.5, 0.3], Limits(1.0, 2.0), curves.piecewise((5, 5, 5), 2))
    rng = np.random.default_rng(2)
    h, nodal = rng.uniform(0.5, 2.0, 3), rng.normal(size=(problem.curve.free, 1))
    quick = fit(problem.curve, problem.waypoints, h, nodal)
    slow = fit(problem.curve, problem.waypoints, 3.0 * h, slowed(problem, nodal, 3.0))
    t = np.linspace(0.0, float(h.sum()), 50)
    np.testing.assert_allclose(slow(3.0 * t), quick(t), atol=1e-12)


def test_least_durations_are_ways_over_the_speed_in_their_direction() -> None:
    line, limits = [[0.0], [1.0], [-1.0]], Limits(velocity=[[-0.5, 2.0]])
    found = least_durations(Problem(line, limits, curves.cubic_spline(2)))
    assert found == pytest.approx([0.5, 4.0], rel=1e-5)


def test_known_motions_of_a_wrong_shape_are_refused() -> None:
    with pytest.raises(TrajgapError, match=r"known: expected shape \(starts, 3\)"):
        solve(TURNING, known=[[1.0, 2.0]])
    with pytest.raises(TrajgapError, match=r"known_nodal: expected shape \(1, 0, 2\)"):
        solve(TURNING, known=[[1.0, 2.0, 1.0]], known_nodal=[[[1.0]]])


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        ({"limits": Limits([0.0, 2.0], 3.0)}, "joint 1 moves, but its velocity limit is 0"),
        ({"limits": Limits([1.0, 2.0], [3.0, 0.0])}, "joint 2 moves, but its acceleration limit"),
        ({"duration_upper": 0.2}, "needs at least"),
        ({"limits": Limits([[-0.5, 1.0], [-2, 1.1]]), "duration_upper": 0.1}, "velocity limit"),
        ({"limits": Limits(1.0, 3.0, np.inf, -1.0, 1.0)}, "way-point 4 of joint 1 lies outside"),
        (
            {"limits": Limits(acceleration=3.0, joints=2), "duration_upper": [0.6, 9.0, 9.0]},
            "joint 2 needs at least 0.730296 s from rest to way-point 2 at its acceleration",
        ),
        (
            {"limits": Limits(acceleration=3.0, joints=2), "duration_upper": [9.0, 9.0, 0.7]},
            "joint 1 needs at least 0.774596 s from way-point 3 to rest at its acceleration",
        ),
        (
            {"limits": Limits(jerk=4.0, joints=2), "duration_upper": [9.0, 0.4, 0.6]},
            "joint 1 needs at least 1.1052 s from way-point 3 to rest at its jerk limit",
        ),
        (
            {
                "limits": Limits(acceleration=[3.0, 1.5], joints=2),
                "duration_upper": [2.0, 0.3, 0.3],
                "curve": curves.cubic_spline(3, ends=((2, 0.0),)),
            },
            "needs an acceleration of",
        ),
        (
            {"curve": curves.rest_to_rest(3, 5), "duration_upper": [0.9, 2.0, 2.0]},
            "in segment 1 even at the longest durations",
        ),
    ],
)
def test_infeasible_is_said_with_a_proof(change: dict[str, object], reason: str) -> None:
    problem = replace(TURNING, **change)
    solution = solve(problem)
    assert solution.status is Status.INFEASIBLE
    assert reason in str(solution.why)
    assert solution.total_time == np.inf
    # A second route: no motion of a dense grid within the bounds passes.
    upper = np.minimum(problem.duration_upper, 3.0)
    grid = np.stack(np.meshgrid(*[np.linspace(0.2, 1.0, 7)] * 3), axis=-1).reshape(-1, 3)
    assert all(check(problem, share * upper).verdict is not Verdict.PASS for share in grid)


@pytest.mark.parametrize("seed", range(12))
def test_elementary_proofs_never_speak_of_feasible_problems(seed: int) -> None:
    """Bounds that just hold a motion that passes are never called infeasible."""
    generator = np.random.default_rng(seed)
    curve = (
        curves.cubic_spline(4),
        curves.quintic_spline(4),
        curves.rest_to_rest(4, 5),
        curves.three_five_three(),
    )[seed % 4]
    q = generator.normal(size=(curve.segments + 1, 2))
    problem = Problem(q, Limits(1.0, 2.0, 9.0, joints=2), curve)
    h = np.exp(generator.normal(size=curve.segments))
    h *= check(problem, h).stretch
    assert check(problem, h).limits is Verdict.PASS
    held = replace(problem, duration_lower=0.999 * h, duration_upper=h)
    assert feasibility.impossible(held) is None


def test_nothing_found_is_a_word_of_its_own_with_the_least_excess() -> None:
    generator = np.random.default_rng(2)
    q = generator.normal(size=(4, 3))
    problem = Problem(q, Limits(1.0, 1.0, joints=3), curves.quintic_spline(3))
    base = solve(problem)
    tight = replace(problem, duration_upper=0.97 * base.durations)
    solution = solve(tight)
    assert solution.status is Status.NONE_FOUND
    assert str(solution.status) == "none found"
    assert "not a proof" in solution.why
    excess = float(solution.why.split("limit was ")[1].split()[0])
    # Simplex from the corner, where every ratio is least to first order, finds no less.
    worst = minimize(
        lambda z: check(tight, np.exp(np.minimum(z, np.log(tight.duration_upper)))).max_violation,
        np.log(0.99 * tight.duration_upper),
        method="Nelder-Mead",
        options={"maxfev": 300},
    ).fun
    assert 0.0 < excess <= worst * 1.001


def test_the_least_point_meets_its_conditions() -> None:
    generator = np.random.default_rng(4)
    for _ in range(20):
        root = generator.normal(size=(4, 4))
        hessian, slope = root @ root.T + 0.1 * np.eye(4), generator.normal(size=4)
        rows, room = generator.normal(size=(7, 4)), generator.uniform(0.0, 1.0, 7)
        found = least_point(hessian, slope, rows, room)
        step, weights = found
        slack = room - rows @ step
        assert (slack >= -1e-9).all()
        assert weights * slack == pytest.approx(np.zeros(7), abs=1e-9)
        assert hessian @ step + slope + rows.T @ weights == pytest.approx(np.zeros(4), abs=1e-9)
        assert (weights >= 0).all()
    contradiction = np.array([[1.0, 0, 0, 0], [-1.0, 0, 0, 0]])
    assert least_point(np.eye(4), np.zeros(4), contradiction, np.array([-1.0, -1.0])) is None
    assert least_point(np.diag([1.0, -1.0]), np.zeros(2), np.eye(2), np.ones(2)) is None


def test_a_descent_starts_outside_the_limits_and_ends_within() -> None:
    problem, _ = NEAR["boxed"]
    box = LogBox(np.log(problem.duration_lower), np.log(problem.duration_upper))
    start = np.sqrt(problem.duration_lower * problem.duration_upper)
    assert check(problem, start).verdict is Verdict.VIOLATED
    assert restored(problem, start, box).worst < 1e-9
    ended = descend(problem, start, box)
    assert ended.feasible
    assert ended.converged
    assert ended.durations.sum() == pytest.approx(6.776743, abs=1e-5)
    # A second one that comes near a shorter end takes it over; a longer one is passed by.
    assert descend(problem, start, box, [ended], near=0.3) is ended
    longer = replace(ended, durations=1.05 * ended.durations)
    again = descend(problem, start, box, [longer], near=0.3)
    assert again.durations.sum() == pytest.approx(ended.durations.sum(), rel=1e-12)


def bent_valley() -> Problem:
    """Two way-points lie 6.5e-5 apart on a joint that moves by 117."""
    q = [125.1124355452457, 49.701619091550135, 8.531303616907653, 8.531368997670285, 69.5356475468]
    limits = Limits(29297.233383318053, np.inf, 2.2881404609094945e08, 2.577467, 126.093, joints=1)
    return Problem(np.array(q), limits, curves.quintic_spline(4))


def test_a_descent_goes_on_along_a_bent_valley_with_a_new_hessian() -> None:
    problem = bent_valley()
    start = np.array([1.65774685e-2, 8.28750141e-3, 4.75276979e-5, 2.06754698e-2])
    ended = descend(problem, start, box_above(problem, np.zeros(4)))
    assert ended.converged
    assert ended.feasible
    assert ended.durations.sum() < 0.0450717  # 0.045405 with the first Hessian alone


@pytest.mark.slow
def test_the_answer_at_the_end_of_the_valley_beats_brute_force() -> None:
    problem = bent_valley()
    # Differential evolution and the simplex method end here.
    brute = [1.6580513894836828e-2, 8.6926208312877434e-3, 1.2266477981631221e-7, 2.015083119108e-2]
    assert check(problem, brute).verdict is Verdict.PASS
    answer = solve(problem)
    assert answer.total_time < 0.993 * sum(brute)
    assert kkt(problem, answer.durations).residual < 1e-8


@pytest.mark.parametrize("seed", [16, 39, 142, 221, pytest.param(309, marks=pytest.mark.slow)])
def test_brute_force_improves_no_answer_and_contradicts_no_word(seed: int) -> None:
    errors = loaded("solver_errors")
    problem = errors.random_problem(np.random.default_rng(seed))
    assert errors.judged(solve(problem), errors.brute_force(problem, seed)) == ""


def test_the_benchmark_sees_wrong_words_and_improvable_answers() -> None:
    errors = loaded("solver_errors")
    problem = TURNING
    brute = errors.brute_force(problem, 0)
    good = solve(problem)
    assert errors.judged(good, brute) == ""
    longer = replace(good, vector=1.01 * good.durations)
    assert errors.judged(longer, brute) == "improvable"
    assert errors.judged(replace(good, vector=0.9 * good.durations), brute) != ""
    lost = Solution(problem, Status.INFEASIBLE, "wrong")
    assert errors.judged(lost, brute) == "wrong infeasible"
