"""The bound over all motions: closed forms, dense grids, a linear program, identities, attacks."""

from __future__ import annotations

import copy
import json
from collections import Counter
from dataclasses import replace
from fractions import Fraction
from functools import lru_cache, partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import linprog
from support.alterations import changed, fields, get, put
from support.checkout import ROOT
from support.unjudged import unjudged
from trajgap.compare.audits import waterfall
from trajgap.compare.audits.study import Study
from trajgap.nlp import Evidence
from trajgap.nlp.proofs import evidence
from trajgap.nlp.proofs.any_curve import (
    certifier as family_free_certify,
)
from trajgap.nlp.proofs.any_curve import (
    rows as family_free_rows,
)
from trajgap.nlp.proofs.any_curve import (
    search as family_free_search,
)
from trajgap.nlp.proofs.any_curve.estimate import estimate_any_curve
from trajgap.nlp.proofs.any_curve.exact import missing, question
from trajgap.nlp.proofs.any_curve.proof import restored
from trajgap.nlp.proofs.any_curve.reach import furthest, reachable
from trajgap.nlp.proofs.any_curve.rows import BRAKE, REACH, UNIT, ExactRow, Row, exact_row
from trajgap.nlp.proofs.any_curve.search import Search
from trajgap.nlp.proofs.certifiers import certify
from trajgap.nlp.proofs.document import certificate, shipped_folder
from trajgap.nlp.proofs.exact import ExactProblem, exact_problem, printed_problem
from trajgap.nlp.proofs.outcome import Certified, Outcome, Progress
from trajgap.nlp.proofs.state import state_document
from trajgap.problem import (
    ClampedBSpline,
    Knots,
    Limits,
    Problem,
    TrajgapError,
    cubic_spline,
    load_case,
    published_ids,
)
from trajgap.verify import CertificateVerdict, Subject
from trajgap.verify import verify_certificate as verify

Array = NDArray[np.float64]
certify_any = partial(certify, subject=Subject.ANY)


def posed(
    waypoints: ArrayLike,
    velocity: ArrayLike = np.inf,
    acceleration: ArrayLike = np.inf,
    ends: tuple[tuple[int, float], ...] = ((1, 0.0),),
    **bounds: ArrayLike,
) -> Problem:
    q = np.asarray(waypoints, dtype=float)
    q = q[:, None] if q.ndim == 1 else q
    limits = Limits(np.asarray(velocity), np.asarray(acceleration), joints=q.shape[1])
    return Problem(q, limits, cubic_spline(len(q) - 1, ends), **bounds)


def proved(found: Certified) -> CertificateVerdict:
    """The certificate of a result, checked again, and found to say the same."""
    verdict = verify(certificate(found))
    assert verdict.proves, verdict
    assert not verdict.altered
    assert (verdict.lower, verdict.upper) == (found.lower, found.upper)
    assert verdict.infeasible == (found.outcome is Outcome.INFEASIBLE)
    assert verdict.subject is Subject.ANY
    return verdict


def interval(problem: Problem, gap: float = 1e-6) -> tuple[float, float]:
    """A certified interval of the wanted width."""
    found = certify_any(problem, gap=gap, seconds=30)
    proved(found)
    assert found.outcome is Outcome.CERTIFIED, found
    assert found.upper is not None
    assert 0 <= found.gap <= gap
    return float(found.lower), float(found.upper)


def from_rest(d: float, velocity: float, acceleration: float) -> float:
    if d * acceleration < velocity**2:
        return float(2 * np.sqrt(d / acceleration))
    return d / velocity + velocity / acceleration


@pytest.mark.parametrize("d", [0.3, -0.9, 4.0])
def test_one_segment_is_a_triangle_or_a_trapezium(d: float) -> None:
    low, high = interval(posed([0.25, 0.25 + d], 1.5, 2.0), 1e-9)
    assert low <= from_rest(abs(d), 1.5, 2.0) * (1 + 1e-15)
    assert high >= from_rest(abs(d), 1.5, 2.0) * (1 - 1e-15)


def test_straight_way_points_cost_nothing() -> None:
    low, high = interval(posed([0.0, 0.5, 0.8, 2.0], 1.5, 2.0))
    assert low <= from_rest(2.0, 1.5, 2.0) <= high


def test_there_and_back_by_overshooting() -> None:
    # From rest to d at speed w in (√(4Ad + 2w²) − w)/A, or that of the velocity limit; back alike.
    w = np.linspace(0.0, 3.0, 300_001)
    d, a = 1.0, 2.0
    one = (np.sqrt(4 * a * d + 2 * w**2) - w) / a
    back = (np.sqrt(4 * a * d + 2 * w**2) + w) / a
    low, high = interval(posed([0.0, d, 0.0], 10.0, a))
    assert low <= (one + back).min() <= high * (1 + 1e-9)


def test_velocity_limits_alone_are_a_sum_of_quotients() -> None:
    q = np.array([[0.0, 1.0], [0.5, -1.0], [0.25, 2.0]])
    low, high = interval(posed(q, [1.0, 4.0]), 1e-9)
    assert low == pytest.approx(0.5 + 0.75, rel=1e-12)
    assert high > 0.5 + 0.75


def test_lower_duration_bounds_can_be_the_optimum() -> None:
    problem = posed([0.0, 0.1, 0.3], 5.0, 50.0, duration_lower=[2.0, 3.0])
    low, high = interval(problem, 1e-9)
    assert low <= 5.0 <= high
    assert high == pytest.approx(5.0, rel=1e-9)


@pytest.mark.parametrize("ends", [(), ((1, 0.5),)])
def test_ends_free_or_moving(ends: tuple[tuple[int, float], ...]) -> None:
    problem = posed([0.0, 1.0, 0.4], 1.25, 2.0, ends)
    low, high = interval(problem)
    known = estimate_any_curve(problem).total_time
    assert known is not None
    assert low <= known <= high * (1 + 1e-9)
    if not ends:
        assert high < interval(posed([0.0, 1.0, 0.4], 1.25, 2.0))[0]


def test_acceleration_limits_alone() -> None:
    low, high = interval(posed([0.0, 1.0], acceleration=2.0), 1e-9)
    assert low <= np.sqrt(2.0) <= high
    two = posed([[0.0, 0.5], [1.0, 0.3], [0.5, 0.9]], acceleration=[2.0, 1.0])
    assert interval(two)[0] >= interval(two.joint(0))[0] * (1 - 1e-6)


def test_a_joint_that_brakes_for_another_needs_boxes() -> None:
    # Joint 1 would fly through the first segment, but joint 2 makes it last.
    problem = posed([[0.0, 0.0], [0.2, 1.0], [3.0, 1.1]], [3.0, 1.4], [2.0, 4.0])
    found = certify_any(problem, gap=1e-7)
    assert found.outcome is Outcome.CERTIFIED
    assert found.nodes > 1
    proved(found)


def random_problem(rng: np.random.Generator, segments: int, joints: int) -> Problem:
    q = rng.normal(size=(segments + 1, joints))
    return posed(q, rng.uniform(0.8, 3.0, joints), rng.uniform(1.0, 6.0, joints))


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
    found = certify_any(posed([0.0, 1.0, 0.0], 1.0, 2.0, duration_upper=[1.2, 1.3]))
    assert found.outcome is Outcome.INFEASIBLE
    assert proved(found).infeasible
    late = certify_any(posed([0.0, 1.0, 0.0], 1.0, 2.0, duration_upper=[0.5, 9.0]))
    assert late.outcome is Outcome.INFEASIBLE
    assert proved(late).infeasible
    half = certify_any(posed([0.0, 1.0, 0.0], 1.0, 2.0, duration_upper=[1.2, np.inf]))
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
    asked = question(exact_problem(posed([0.0, d, 1.0], velocity, acceleration)))
    box = ((Fraction(h * others[0]), Fraction(h * others[1])),) * 2
    a, b = (round(s * UNIT) for s in slopes)
    row = Row(kind, 0, 0, sign, a, b, round(others[2] * UNIT))
    exact = exact_row(asked, row, box, Fraction(velocity))
    left = exact.time * Fraction(h) + exact.start * Fraction(v0) + exact.end * Fraction(v1)
    assert left - exact.right >= -1e-9 * (1 + abs(exact.right))


# --- attacks --------------------------------------------------------------------------------------


@lru_cache(maxsize=1)
def attacked() -> tuple[Problem, str]:
    problem = posed([[0.0, 0.0], [0.25, 1.0], [3.0, 1.125]], [3.0, 1.5], [2.0, 4.0])
    found = certify_any(problem, gap=1e-5)
    return problem, json.dumps(certificate(found))


def test_falsified_rows_are_seen_and_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    problem, _ = attacked()
    honest = certify_any(problem, gap=1e-5)

    def stronger(asked: Any, row: Row, box: Any, speed: Fraction) -> ExactRow:
        found = exact_row(asked, row, box, speed)
        return replace(found, right=found.right + Fraction(1, 20) * abs(found.right))

    monkeypatch.setattr(family_free_rows, "exact_row", stronger)
    raw = unjudged(monkeypatch)
    found = certify_any(problem, gap=1e-5)
    assert raw[0].upper is not None
    assert raw[0].lower >= honest.lower
    verdict = verify(certificate(raw[0]))
    assert not verdict.proves
    assert "proves only" in verdict.reason
    assert (found.outcome, found.lower, found.proof) == (Outcome.OPEN, 0, None)


def poor(monkeypatch: pytest.MonkeyPatch) -> Problem:
    """A problem for which the local solver's first answer is 5 % too long."""
    first = family_free_certify._first_motion

    def longer(*given: Any) -> Any:
        motion = first(*given)
        assert motion is not None
        slow = Fraction(21, 20)
        return (
            tuple(h * slow for h in motion[0]),
            tuple(tuple(v / slow for v in row) for row in motion[1]),
        )

    monkeypatch.setattr(family_free_certify, "_first_motion", longer)
    return attacked()[0]


def test_a_poor_first_answer_is_replaced(monkeypatch: pytest.MonkeyPatch) -> None:
    problem, _ = attacked()
    honest = certify_any(problem, gap=1e-6)
    found = certify_any(poor(monkeypatch), gap=1e-6)
    proved(found)
    assert found.outcome is Outcome.CERTIFIED
    assert found.upper is not None
    assert honest.upper is not None
    assert float(found.upper) == pytest.approx(float(honest.upper), rel=1e-6)


def test_an_answer_that_is_not_optimal_is_never_certified(monkeypatch: pytest.MonkeyPatch) -> None:
    problem, _ = attacked()
    honest = certify_any(problem, gap=1e-6)
    monkeypatch.setattr(family_free_certify, "_local_motion", lambda *_: None)
    found = certify_any(poor(monkeypatch), gap=1e-6, seconds=1.0)
    assert found.outcome is Outcome.INTERVAL
    assert honest.upper is not None
    assert found.lower <= honest.upper
    assert proved(found).upper == found.upper


def test_a_bound_that_is_too_high_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    problem, _ = attacked()

    def higher(*given: Any) -> Fraction:
        return family_free_rows.bound(*given) * Fraction(1001, 1000)

    monkeypatch.setattr(family_free_search, "bound", higher)
    raw = unjudged(monkeypatch)
    assert certify_any(problem, gap=1e-2).proof is None
    assert not verify(certificate(raw[0])).proves


def restated(data: dict[str, Any]) -> Problem:
    """The question in a file, as far as it matters, in floats."""
    problem = data["problem"]

    def numbers(values: list[Any], none: float = np.inf) -> list[float]:
        return [none if x is None else float(Fraction(x)) for x in values]

    ends = tuple((1, float(Fraction(v))) for r, v in problem["prescribed"][0] if r == 1)
    return posed(
        [numbers(row) for row in problem["waypoints"]],
        numbers([row[0] for row in problem["limits"]]),
        numbers([row[1] for row in problem["limits"]]),
        ends,
        duration_lower=numbers(problem["duration_lower"]),
        duration_upper=numbers(problem["duration_upper"]),
    )


def alter_every_field(per_field: int, seed: int) -> Counter[str]:
    """Alter one number after the other; what still proves must be true of the problem in the file.

    End velocities are altered together: the problem prescribes the same at both ends.
    """
    _, text = attacked()
    rng = np.random.default_rng(seed)
    outcomes: Counter[str] = Counter()
    base = json.loads(text)
    estimates = {json.dumps(base["problem"]): estimate_any_curve(restated(base)).total_time}
    for name, paths in fields(base).items():
        for k in rng.integers(0, len(paths), per_field):
            data = json.loads(text)
            put(data, paths[k], changed(get(data, paths[k]), rng))
            if name.startswith("problem.prescribed"):
                data["problem"]["prescribed"][-1] = data["problem"]["prescribed"][0]
            verdict = verify(data)
            if data == base or not verdict.proves:
                outcomes["the same" if data == base else "refused"] += 1
                continue
            outcomes["still proves"] += 1
            assert verdict.altered
            assert not verdict.infeasible
            key = json.dumps(data["problem"])
            if key not in estimates:
                estimates[key] = estimate_any_curve(restated(data)).total_time
            true = estimates[key]
            assert verdict.lower is not None
            if true is not None:
                assert verdict.lower <= true * (1 + 1e-12), paths[k]
                assert verdict.upper is None or verdict.upper >= true * (1 - 1e-9), paths[k]
    return outcomes


def test_whatever_still_proves_after_an_alteration_is_true() -> None:
    outcomes = alter_every_field(5, 0)
    assert outcomes["refused"] > 40
    assert outcomes["still proves"] > 20


@pytest.mark.slow
def test_hundreds_of_alterations_of_each_field_prove_nothing_false() -> None:
    outcomes = alter_every_field(300, 1)
    assert outcomes["refused"] > 2000
    assert outcomes["still proves"] > 1000


FIRST = "the first leaf"
"""In a path: its place in the tree."""


@pytest.mark.parametrize(
    ("path", "value", "reason"),
    [
        (("claim", "lower"), "9", "exceeds the total"),
        (("claim", "upper"), "1", "exceed the upper bound"),
        (("claim", "infeasible"), True, "infeasible"),
        (("proof", "total"), "9", "cap"),
        (("proof", "cap"), "0.5", "cap"),
        (("claim", "speeds", 1, 0), "0", "reach"),
        (("claim", "speeds", 1, 0), "3.5", "velocity"),
        (("claim", "speeds", 0, 0), "0.001", "end"),
        (("claim", "speeds"), None, "no speeds"),
        (("claim", "subject"), "the declared curve", "speeds belong to"),
        (("proof", "tree"), [["."], ["."]], "proves only|too many"),
        (("proof", "tree"), [["/", 0, "1"], ["."]], "proves only|cut"),
        (("proof", "tree"), [0, ["."], ["."]], "no number"),
        (("proof", "tree", 0), ["?"], "open"),
        (("proof", "tree", FIRST), ["."], "proves only"),
        (("proof", "tree", FIRST), [".", 0, "-1"], "weight"),
        (("problem", "limits", 0, 2), "4", "jerk"),
        (("problem", "position_upper", 0), "9", "position"),
        (("problem", "duration_lower", 0), "2", "bounds"),
    ],
)
def test_alterations_in_favour_of_the_claim(
    path: tuple[str | int, ...], value: Any, reason: str
) -> None:
    data = copy.deepcopy(json.loads(attacked()[1]))
    leaf = next(k for k, node in enumerate(data["proof"]["tree"]) if node[0] == ".")
    put(data, tuple(leaf if key == FIRST else key for key in path), value)
    verdict = verify(data)
    assert not verdict.proves
    assert any(word in verdict.reason for word in reason.split("|")), verdict


def test_a_row_must_not_look_the_wrong_way() -> None:
    data = json.loads(attacked()[1])
    at = next(i for i, row in enumerate(data["proof"]["rows"]) if row[0] == "brake")
    data["proof"]["rows"][at][3] *= -1
    verdict = verify(data)
    assert not verdict.proves
    assert "wrong way" in verdict.reason


def by_hand(problem: Problem, total: str, rows: list[Any], leaf: list[Any]) -> dict[str, Any]:
    """A certificate of one box that no solver wrote, sealed."""
    document = json.loads(json.dumps(certificate(certify_any(problem))))
    document["claim"] |= {"lower": total, "upper": None, "durations": None, "speeds": None}
    document["proof"] |= {"total": total, "cap": total, "rows": rows, "tree": [[".", *leaf]]}
    return dict(document)


@pytest.mark.parametrize("sign", [1.0, True])
def test_nothing_is_proved_in_floats(sign: Any) -> None:
    # With floats in it a product could overflow, and inf prove any total.
    whole = 10**118
    row = ["reach", 0, 0, sign, 0, 0, 95 * 10**8]
    document = by_hand(posed([0.0, 1.0], 1.0, 1.0), "9" * 120, [row], [0, "1"])
    document["problem"]["waypoints"] = [["0"], [str(whole)]]
    verdict = verify(document)
    assert not verdict.proves
    assert "sign" in verdict.reason
    row[3] = 1
    assert "proves only" in verify(document).reason


@pytest.mark.parametrize(("key", "bound"), [("position_upper", "4"), ("position_lower", "6")])
def test_a_joint_that_stays_where_it_must_not_be_has_no_answer(key: str, bound: str) -> None:
    found = certify_any(posed([[0.0, 5.0], [1.0, 5.0]], 1.0, 1.0))
    document = json.loads(json.dumps(certificate(found)))
    assert document["claim"]["upper"] is not None
    document["problem"][key] = [None, "5"]
    assert verify(document).proves
    document["problem"][key] = [None, bound]
    verdict = verify(document)
    assert not verdict.proves
    assert "position" in verdict.reason
    side = {key: (np.inf if key == "position_upper" else -np.inf, float(bound))}
    limits = Limits(1.0, 1.0, joints=2, **side)
    problem = replace(posed([[0.0, 5.0], [1.0, 5.0]], 1.0, 1.0), limits=limits)
    found = certify_any(problem)
    assert found.upper is None
    assert proved(found).lower is not None


# --- what is not covered, and stopping ------------------------------------------------------------


def test_jerk_and_position_limits_keep_the_lower_bound_alone() -> None:
    plain = posed([0.0, 1.0, 0.5], 1.0, 2.0)
    known = certify_any(plain)
    jerk = replace(plain, limits=Limits(1.0, 2.0, 9.0, joints=1))
    walls = replace(plain, limits=Limits(1.0, 2.0, np.inf, -1.0, 1.01, joints=1))
    for problem in (jerk, walls):
        found = certify_any(problem)
        assert found.upper is None
        assert found.durations is None
        assert found.lower == known.lower
        assert proved(found).upper is None


@pytest.mark.parametrize(
    ("problem", "reason"),
    [
        (posed([1.0, 1.0], 1.0, 1.0), "nothing moves"),
        (posed([0.0, 1.0]), "nothing that moves is limited"),
        (posed([0.0, 1.0], 0.0, 1.0), "velocity limit is 0"),
        (posed([0.0, 1.0], 1.0, 0.0), "acceleration limit is 0"),
        (posed([0.0, 1.0], acceleration=1.0, ends=()), "its ends are free"),
        (posed([0.0, 1.0], 1.0, 1.0, ends=((1, 2.0),)), "exceeds the limit"),
        (posed([0.0, 1.0, 1.0, 2.0], 1.0, 1.0), "nothing moves in segment 2"),
    ],
)
def test_what_is_not_covered_is_said(problem: Problem, reason: str) -> None:
    with pytest.raises(TrajgapError, match=reason):
        certify_any(problem)


def test_a_stopped_run_has_a_proof_and_goes_on() -> None:
    problem = printed("puma560-mnam-pso-353", "six-joints", "durations-positive")
    seen: list[Progress] = []
    stopped = certify_any(problem, gap=1e-7, seconds=0.0, report=seen.append)
    assert stopped.outcome is Outcome.INTERVAL
    assert stopped.lower > 0
    assert seen
    proved(stopped)
    state = json.loads(json.dumps(state_document(stopped)))
    first = certify_any(problem, gap=1e-7, resume=state)
    proved(first)
    assert first.outcome is Outcome.CERTIFIED
    assert first.lower >= stopped.lower
    bad: list[tuple[tuple[str | int, ...], Any]] = [
        (("tree",), [["/", 0, "99"], ["."], ["."]]),
        (("tree",), [["/", 0, "x"], ["."], ["."]]),
        (("rows", 0, 2), 99),
        (("rows", 0, 0), "magic"),
        (("tree",), [["?"]]),
    ]
    search = Search(question(problem), Fraction(state["proof"]["cap"]))
    for path, value in bad:
        broken = copy.deepcopy(state)
        put(broken["proof"], path, value)
        with pytest.raises(TrajgapError, match="resume: the state is not proved"):
            certify_any(problem, resume=broken)
        # Whoever reads it trusts it no more than that.
        if value != [["?"]]:
            with pytest.raises(TrajgapError, match="cannot be resumed"):
                restored(search, broken["proof"], 1.0)
    with pytest.raises(TrajgapError, match="about another problem"):
        certify(problem, resume=state)


def test_ctrl_c_keeps_what_is_proved() -> None:
    def stop(_: Progress) -> None:
        raise KeyboardInterrupt

    problem = printed("puma560-mnam-pso-353", "six-joints", "durations-positive")
    found = certify_any(problem, report=stop)
    assert found.outcome is Outcome.INTERVAL
    proved(found)


# --- shipped problems -----------------------------------------------------------------------------


def printed(case: str, problem: str, reading: str) -> ExactProblem:
    return printed_problem(load_case(case).statement(problem, reading))


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
                if not statement.complete or missing(printed_problem(statement)) is not None:
                    continue
                name = f"{case_id}, {problem.id}, {reading.id}"
                found = evidence.proved(printed_problem(statement), Subject.ANY)
                assert found is not None, f"{name}: run benchmarks/family_free_bound.py"
                assert found.upper is not None
                assert found.upper - found.lower <= found.upper / 10**5, name
                estimate = estimate_any_curve(statement.problem(), starts=1).total_time
                assert estimate is not None
                assert float(found.lower) <= estimate * (1 + 1e-12), name
                assert float(found.upper) == pytest.approx(estimate, rel=1e-9), name


def test_the_table_in_the_docs_is_that_of_the_files() -> None:
    page = ROOT / "docs" / "certificates-any-curve.md"
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
    assert low == pytest.approx(interval(posed([0.0, 1.0, 0.2], 1.0, 2.0, ends))[0], rel=1e-5)
    data = certificate(certify_any(problem))
    assert ("ends" in data["problem"]) == (1 in orders)
    if 1 in orders:
        del data["problem"]["ends"]
        assert not verify(data).proves
