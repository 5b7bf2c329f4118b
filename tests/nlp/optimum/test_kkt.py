import numpy as np
import pytest
from trajgap.nlp import Form, Structure, build, kkt, solve, structure_of
from trajgap.nlp.optimum.polish import polish
from trajgap.problem import (
    Limits,
    Problem,
    cubic_spline,
    load_case,
    piecewise,
    quintic_spline,
    rest_to_rest,
    three_five_three,
)

Q = np.array([[0.2, -1.0, 0.7], [0.9, 0.3, 0.1], [0.4, 1.1, -0.8], [1.3, 0.6, 0.2]])
LIMITS = Limits([1.5, 2.0, 1.0], [4.0, 6.0, 5.0], [30.0, 50.0, 40.0])
CURVES = [three_five_three(), cubic_spline(3), quintic_spline(3), rest_to_rest(3, 5)]


@pytest.mark.parametrize("interpolant", CURVES, ids=lambda i: i.name)
def test_multipliers_obey_the_scaling_law(interpolant) -> None:
    """T(cV, c²A, c³J) = T/c, so Σ order × multiplier = T wherever no duration bound holds."""
    solution = solve(Problem(Q, LIMITS, interpolant))
    orders = {"velocity": 1, "acceleration": 2, "jerk": 3}
    weighted = sum(orders[a.quantity] * a.multiplier for a in solution.active)
    assert weighted == pytest.approx(solution.total_time, rel=1e-8)
    assert all(a.multiplier > 0 for a in solution.active)
    assert all(a.sensitivity == pytest.approx(-0.1 * a.multiplier) for a in solution.active)


def test_only_an_optimum_has_a_small_residual() -> None:
    problem = Problem(Q, LIMITS, three_five_three())
    best = solve(problem).durations
    assert kkt(problem, best).residual <= 1e-10
    assert kkt(problem, best * 1.01).residual > 0.1
    assert kkt(problem, best * 0.999).residual > 1e-4
    other = best * np.array([1.05, 1.0, 1.0])
    from trajgap.problem import check

    assert kkt(problem, other * check(problem, other).stretch).residual > 1e-2


def test_newton_sharpens_and_never_worsens() -> None:
    problem = Problem(Q, LIMITS, three_five_three())
    best = solve(problem).durations
    blurred = best * (1 + 1e-9)
    report = kkt(problem, blurred)
    sharp, better = polish(problem, blurred, report)
    assert better.residual <= report.residual
    assert better.residual <= 1e-11
    assert sharp == pytest.approx(best, rel=1e-7)


def test_free_derivatives_enter_the_conditions() -> None:
    problem = Problem(Q, LIMITS, piecewise((5, 5, 5), 2))
    solution = solve(problem)
    assert solution.kkt_residual <= 1e-8
    shifted = solution.nodal + np.array([[0.05], [0.0], [0.0], [0.0]])
    assert kkt(problem, solution.durations, shifted).residual > 1e-3


@pytest.mark.parametrize("form", list(Form))
def test_a_formulation_prints_its_sizes_and_is_built_once_per_shape(form: Form) -> None:
    problem = load_case("puma560-mnam-pso-353").problem()
    structure = structure_of(problem, form)
    built = build(structure)
    sizes = built.sizes
    assert sizes["variables"] == (3 if form is Form.REDUCED else 3 + 6 * 3 * 6)
    assert sizes["equalities"] == (0 if form is Form.REDUCED else 6 * 14)
    assert f"{sizes['inequalities']} inequalities" in str(built)
    other = Problem(problem.waypoints * 0.7, Limits(5.0, 9.0, joints=6), problem.curve)
    assert structure_of(other, form) == structure
    assert structure == Structure(problem.curve, 6, (1, 2), form)
