"""The bound over all motions: closed forms, dense grids, a linear program, identities, attacks."""

from __future__ import annotations

import json
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.optimize import linprog
from support.any_curve_proofs import certify_any, printed, proved
from support.checkout import ROOT
from support.joint_splines import rest_to_rest_time, spline_problem
from trajgap.compare.audits import waterfall
from trajgap.compare.audits.study import Study
from trajgap.nlp import Evidence
from trajgap.nlp.proofs import evidence
from trajgap.nlp.proofs.any_curve.estimate import estimate_any_curve
from trajgap.nlp.proofs.any_curve.exact import missing, question
from trajgap.nlp.proofs.any_curve.reach import furthest, reachable
from trajgap.nlp.proofs.any_curve.rows import BRAKE, REACH, UNIT, ReachRow, exact_row
from trajgap.nlp.proofs.document import certificate, shipped_folder
from trajgap.nlp.proofs.evidence import printed_problem_or_none
from trajgap.nlp.proofs.exact import exact_problem
from trajgap.nlp.proofs.outcome import Certified, Outcome
from trajgap.problem import (
    ClampedBSpline,
    Knots,
    Limits,
    Problem,
    load_case,
    published_ids,
)
from trajgap.verify import Subject
from trajgap.verify import verify_certificate as verify

Array = NDArray[np.float64]


def interval(problem: Problem, gap: float = 1e-6) -> tuple[float, float]:
    """A certified interval of the wanted width."""
    found = certify_any(problem, gap=gap, seconds=30)
    proved(found)
    assert found.outcome is Outcome.CERTIFIED, found
    assert found.upper is not None
    assert 0 <= found.gap <= gap
    return float(found.lower), float(found.upper)


@pytest.mark.parametrize("d", [0.3, -0.9, 4.0])
def test_one_segment_is_a_triangle_or_a_trapezium(d: float) -> None:
    low, high = interval(spline_problem([0.25, 0.25 + d], 1.5, 2.0), 1e-9)
    assert low <= rest_to_rest_time(d, 1.5, 2.0) * (1 + 1e-15)
    assert high >= rest_to_rest_time(d, 1.5, 2.0) * (1 - 1e-15)


def test_straight_way_points_cost_nothing() -> None:
    low, high = interval(spline_problem([0.0, 0.5, 0.8, 2.0], 1.5, 2.0))
    assert low <= rest_to_rest_time(2.0, 1.5, 2.0) <= high


def test_there_and_back_by_overshooting() -> None:
    # From rest to d at speed w in (√(4Ad + 2w²) − w)/A, or that of the velocity limit; back alike.
    w = np.linspace(0.0, 3.0, 300_001)
    d, a = 1.0, 2.0
    one = (np.sqrt(4 * a * d + 2 * w**2) - w) / a
    back = (np.sqrt(4 * a * d + 2 * w**2) + w) / a
    low, high = interval(spline_problem([0.0, d, 0.0], 10.0, a))
    assert low <= (one + back).min() <= high * (1 + 1e-9)


def test_velocity_limits_alone_are_a_sum_of_quotients() -> None:
    q = np.array([[0.0, 1.0], [0.5, -1.0], [0.25, 2.0]])
    low, high = interval(spline_problem(q, [1.0, 4.0]), 1e-9)
    assert low == pytest.approx(0.5 + 0.75, rel=1e-12)
    assert high > 0.5 + 0.75


def test_lower_duration_bounds_can_be_the_optimum() -> None:
    problem = spline_problem([0.0, 0.1, 0.3], 5.0, 50.0, duration_lower=[2.0, 3.0])
    low, high = interval(problem, 1e-9)
    assert low <= 5.0 <= high
    assert high == pytest.approx(5.0, rel=1e-9)


@pytest.mark.parametrize("ends", [(), ((1, 0.5),)])
def test_ends_free_or_moving(ends: tuple[tuple[int, float], ...]) -> None:
    problem = spline_problem([0.0, 1.0, 0.4], 1.25, 2.0, ends)
    low, high = interval(problem)
    known = estimate_any_curve(problem).total_time
    assert known is not None
    assert low <= known <= high * (1 + 1e-9)
    if not ends:
        assert high < interval(spline_problem([0.0, 1.0, 0.4], 1.25, 2.0))[0]


def test_acceleration_limits_alone() -> None:
    low, high = interval(spline_problem([0.0, 1.0], acceleration=2.0), 1e-9)
    assert low <= np.sqrt(2.0) <= high
    two = spline_problem([[0.0, 0.5], [1.0, 0.3], [0.5, 0.9]], acceleration=[2.0, 1.0])
    assert interval(two)[0] >= interval(two.joint(0))[0] * (1 - 1e-6)


def test_a_joint_that_brakes_for_another_needs_boxes() -> None:
    # Joint 1 would fly through the first segment, but joint 2 makes it last.
    problem = spline_problem([[0.0, 0.0], [0.2, 1.0], [3.0, 1.1]], [3.0, 1.4], [2.0, 4.0])
    found = certify_any(problem, gap=1e-7)
    assert found.outcome is Outcome.CERTIFIED
    assert found.nodes > 1
    proved(found)


def random_problem(rng: np.random.Generator, segments: int, joints: int) -> Problem:
    q = rng.normal(size=(segments + 1, joints))
    return spline_problem(q, rng.uniform(0.8, 3.0, joints), rng.uniform(1.0, 6.0, joints))


def reached(step: float, v0: Array, v1: Array, h: Array, v: float, a: float) -> Any:
    return reachable(step, *np.broadcast_arrays(v0, v1, h), v, a)  # type: ignore[arg-type]


def grid_feasible(problem: Problem, h: Array, speeds: Array) -> NDArray[np.bool_]:
    """Which duration vectors, shape (batch, 2 or 3), allow a motion with gridded node speeds."""
    good, rest = np.ones(len(h), dtype=bool), np.zeros(1)
    for j, (v, a) in enumerate(
        zip(problem.limits.velocity, problem.limits.acceleration, strict=True)
    ):
        steps, w = np.diff(problem.waypoints[:, j]), speeds * v
        so_far = reached(steps[0], rest, w, h[:, 0, None], v, a)
        for k in range(1, len(steps) - 1):
            onward = reached(steps[k], w[:, None], w, h[:, k, None, None], v, a)
            so_far = (so_far[:, :, None] & onward).any(axis=1)
        good &= (so_far & reached(steps[-1], w, rest, h[:, -1, None], v, a)).any(axis=1)
    return good


@pytest.mark.parametrize("seed", range(9))
def test_dense_grids_never_beat_the_bound_and_come_near_it(seed: int) -> None:
    rng = np.random.default_rng(seed)
    problem = random_problem(rng, 2, 1 + seed % 3)
    low, high = interval(problem)
    known = estimate_any_curve(problem).durations
    assert known is not None
    wide = np.exp(rng.uniform(-1.5, 1.5, (1000, 2))) * known
    near = (1 + rng.uniform(-0.05, 0.05, (1000, 2))) * known
    h = np.concatenate([wide, near, [known * 1.01]])
    good = grid_feasible(problem, h, np.linspace(-1, 1, 201))
    best = float(h[good].sum(axis=1).min())
    assert low <= best <= 1.03 * high


@pytest.mark.parametrize("seed", range(3))
def test_grids_of_three_segments(seed: int) -> None:
    rng = np.random.default_rng(100 + seed)
    problem = random_problem(rng, 3, 2)
    low, high = interval(problem)
    known = estimate_any_curve(problem).durations
    assert known is not None
    h = np.concatenate([np.exp(rng.normal(0, 0.2, (300, 3))) * known, [known * 1.02]])
    good = grid_feasible(problem, h, np.linspace(-1, 1, 61))
    assert low <= float(h[good].sum(axis=1).min()) <= 1.05 * high


@pytest.mark.parametrize("seed", [700, 701])
def test_seven_segments_and_six_joints(seed: int) -> None:
    interval(random_problem(np.random.default_rng(seed), 7, 6), 1e-6)


def discrete_motion(problem: Problem, h: Array, cells: int) -> bool:
    """Whether a velocity that is linear on every cell keeps the limits: a linear program."""
    steps = np.repeat(h / cells, cells)
    n = len(steps)
    areas = np.zeros((len(h), n + 1))
    for i in range(n):
        areas[i // cells, i : i + 2] += steps[i] / 2
    change = np.eye(n + 1)[1:] - np.eye(n + 1)[:-1]
    for j, (v, a) in enumerate(
        zip(problem.limits.velocity, problem.limits.acceleration, strict=True)
    ):
        bounds = [(0, 0), *[(-v, v)] * (n - 1), (0, 0)]
        found = linprog(
            np.zeros(n + 1),
            A_ub=np.vstack([change, -change]),
            b_ub=np.tile(a * steps, 2),
            A_eq=areas,
            b_eq=np.diff(problem.waypoints[:, j]),
            bounds=bounds,
        )
        if found.status == 2:
            return False
        assert found.status == 0
    return True


@pytest.mark.parametrize("seed", range(4))
def test_fixed_durations_agree_with_a_linear_program(seed: int) -> None:
    rng = np.random.default_rng(40 + seed)
    problem = random_problem(rng, 3, 2)
    shares = rng.uniform(0.5, 1.5, 3)
    low, high = 0.1, 40.0
    while high - low > 0.002 * high:
        middle = (low + high) / 2
        feasible = discrete_motion(problem, middle * shares, 48)
        low, high = (low, middle) if feasible else (middle, high)

    def fixed(scale: float) -> Certified:
        h = scale * shares
        found = certify_any(replace(problem, duration_lower=h, duration_upper=h))
        proved(found)
        return found

    # The linear program is a restriction: its motions are motions.
    assert fixed(high).outcome is Outcome.CERTIFIED
    assert fixed(0.97 * low).outcome is Outcome.INFEASIBLE


def test_too_short_upper_bounds_are_infeasible() -> None:
    found = certify_any(spline_problem([0.0, 1.0, 0.0], 1.0, 2.0, duration_upper=[1.2, 1.3]))
    assert found.outcome is Outcome.INFEASIBLE
    assert proved(found).infeasible
    late = certify_any(spline_problem([0.0, 1.0, 0.0], 1.0, 2.0, duration_upper=[0.5, 9.0]))
    assert late.outcome is Outcome.INFEASIBLE
    assert proved(late).infeasible
    half = certify_any(spline_problem([0.0, 1.0, 0.0], 1.0, 2.0, duration_upper=[1.2, np.inf]))
    assert half.outcome is Outcome.OPEN
    assert half.proof is None


@pytest.mark.parametrize("seed", range(4))
def test_identities(seed: int) -> None:
    rng = np.random.default_rng(70 + seed)
    problem = random_problem(rng, 3, 3)
    limits = problem.limits
    first = interval(problem, 1e-5)

    def same(other: Problem, factor: float) -> None:
        low, high = interval(other, 1e-5)
        assert low <= factor * first[1]
        assert factor * first[0] <= high

    same(replace(problem, waypoints=-problem.waypoints + 3.0), 1.0)
    same(replace(problem, waypoints=problem.waypoints[::-1].copy()), 1.0)
    order = rng.permutation(3)
    swapped = Limits(limits.velocity[order], limits.acceleration[order])
    same(replace(problem, waypoints=problem.waypoints[:, order], limits=swapped), 1.0)
    slow = Limits(limits.velocity / 3, limits.acceleration / 9)
    same(replace(problem, limits=slow), 3.0)
    units = np.array([57.3, 1e-3, 1.0])
    scaled = Limits(limits.velocity * units, limits.acceleration * units)
    same(replace(problem, waypoints=problem.waypoints * units, limits=scaled), 1.0)


def test_more_joints_or_tighter_limits_never_lower_the_optimum() -> None:
    problem = random_problem(np.random.default_rng(5), 3, 3)
    whole = interval(problem)
    for j in range(3):
        assert interval(problem.joint(j))[0] <= whole[1]
    tight = Limits(problem.limits.velocity * 0.8, problem.limits.acceleration)
    assert interval(replace(problem, limits=tight))[1] >= whole[0]


# --- rows -----------------------------------------------------------------------------------------


@settings(max_examples=200, deadline=None)
@given(
    st.tuples(*[st.floats(-1, 1)] * 2),
    st.floats(0.02, 6),
    st.floats(0, 1),
    st.tuples(*[st.floats(-3, 3)] * 2),
    st.tuples(st.floats(0.01, 1), st.floats(1, 50), st.floats(0, 50)),
    st.sampled_from([REACH, BRAKE]),
)
def test_rows_hold_for_every_motion(
    ends: tuple[float, float],
    h: float,
    mix: float,
    slopes: tuple[float, float],
    others: tuple[float, float, float],
    kind: int,
) -> None:
    velocity, acceleration = 1.0, 1.5
    v0, v1 = ends
    high = furthest(*map(np.asarray, (v0, v1, h, velocity, acceleration)))
    if not np.isfinite(high):
        return
    low = -furthest(*map(np.asarray, (-v0, -v1, h, velocity, acceleration)))
    d = float(low + mix * (high - low))
    sign = 1 if d >= 0 else -1
    asked = question(exact_problem(spline_problem([0.0, d, 1.0], velocity, acceleration)))
    box = ((Fraction(h * others[0]), Fraction(h * others[1])),) * 2
    a, b = (round(s * UNIT) for s in slopes)
    row = ReachRow(kind, 0, 0, sign, a, b, round(others[2] * UNIT))
    exact = exact_row(asked, row, box, Fraction(velocity))
    left = exact.time * Fraction(h) + exact.start * Fraction(v0) + exact.end * Fraction(v1)
    assert left - exact.right >= -1e-9 * (1 + abs(exact.right))


@pytest.mark.parametrize("least", ["at-least-0.3", "positive"])
def test_puma_to_nine_digits(least: str) -> None:
    found = certify_any(
        printed("puma560-mnam-pso-353", "six-joints", f"durations-{least}"), gap=1e-9
    )
    assert found.outcome is Outcome.CERTIFIED
    proved(found)
    known = estimate_any_curve(load_case("puma560-mnam-pso-353").statement("six-joints").problem())
    assert known.total_time is not None
    assert float(found.lower) <= known.total_time * (1 + 1e-12)
    assert float(found.upper or 0) == pytest.approx(known.total_time, rel=1e-9)


def shipped_bounds() -> dict[str, Path]:
    return {path.stem: path for path in sorted(shipped_folder().glob("*.any-curve.json"))}


def test_every_shipped_question_has_a_bound_that_is_proved() -> None:
    for case_id in published_ids():
        case = load_case(case_id)
        for problem in case.problems:
            for reading in case.readings:
                statement = case.statement(problem.id, reading.id)
                exact = printed_problem_or_none(statement) if statement.complete else None
                if exact is None or missing(exact) is not None:
                    continue
                name = f"{case_id}, {problem.id}, {reading.id}"
                found = evidence.proved(exact, Subject.ANY)
                assert found is not None, f"{name}: run benchmarks/any_curve_bound.py"
                assert found.upper is not None
                assert found.upper - found.lower <= found.upper / 10**5, name
                estimate = estimate_any_curve(statement.problem(), starts=1).total_time
                assert estimate is not None
                assert float(found.lower) <= estimate * (1 + 1e-12), name
                assert float(found.upper) == pytest.approx(estimate, rel=1e-9), name


def test_the_table_in_the_docs_is_that_of_the_files() -> None:
    page = ROOT / "docs" / "explanation" / "certificates-any-curve.md"
    rows = {}
    for line in page.read_text("utf-8").splitlines():
        cells = [cell.strip() for cell in line.strip("|").split("|")]
        if len(cells) == 8 and cells[0].startswith("`"):
            rows[cells[0].strip("`")] = cells
    paths = shipped_bounds()
    assert set(rows) == set(paths)
    for name, cells in rows.items():
        claim = json.loads(paths[name].read_text("utf-8"))["claim"]
        lower, upper = Fraction(claim["lower"]), Fraction(claim["upper"])
        least, most = (Fraction(cell) for cell in cells[1:3])
        assert 0 <= lower - least < Fraction(1, 10**9), f"{name}: rounded outwards"
        assert 0 <= most - upper < Fraction(1, 10**9), f"{name}: rounded outwards"
        assert cells[3] == f"{float(1 - lower / upper):.1e}", name
        assert int(cells[6]) == paths[name].stat().st_size < 200_000, name


def test_no_declared_curve_is_shorter() -> None:
    exact = printed("puma560-mnam-pso-353", "six-joints", "durations-positive")
    declared, any_curve = evidence.proved(exact), evidence.proved(exact, Subject.ANY)
    assert declared is not None
    assert any_curve is not None
    assert declared.upper is not None
    assert any_curve.lower < declared.lower
    assert any_curve.lower / declared.upper < Fraction(1, 2)


def test_the_waterfall_ends_at_the_bound() -> None:
    study = Study(load_case("puma560-mnam-pso-353"), seeds=2, reading="durations-positive")
    step = waterfall._free(study, "six-joints", "durations-positive")
    assert step.evidence is Evidence.CERTIFIED
    assert isinstance(step.low, float)
    assert isinstance(step.high, float)
    assert 0 < step.high - step.low <= 1e-8
    number = step.note.split(" s: certified, gap ")[0].rsplit(" ", 1)[1]
    assert step.note.startswith(
        f"no motion within the limits is shorter than {number} s: certified"
    )
    assert 0 <= step.low - float(number) < 1e-5


@pytest.mark.parametrize("orders", [(1, 2), (2,)])
def test_end_velocities_of_other_kinds_of_curve_are_stated(orders: tuple[int, ...]) -> None:
    curve = ClampedBSpline(3, 3, Knots.CONTINUED, end_orders=orders)
    problem = Problem(np.array([[0.0], [1.0], [0.2]]), Limits(1.0, 2.0, joints=1), curve)
    low, _ = interval(problem)
    ends = ((1, 0.0),) if 1 in orders else ()
    assert low == pytest.approx(
        interval(spline_problem([0.0, 1.0, 0.2], 1.0, 2.0, ends))[0], rel=1e-5
    )
    data = certificate(certify_any(problem))
    assert ("ends" in data["problem"]) == (1 in orders)
    if 1 in orders:
        del data["problem"]["ends"]
        assert not verify(data).proves
