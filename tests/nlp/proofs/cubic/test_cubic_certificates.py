"""Certificates of C2 cubic splines: dense search, closed forms, identities, and attacks."""

from __future__ import annotations

import copy
import json
from dataclasses import replace
from fractions import Fraction
from functools import lru_cache
from typing import Any

import numpy as np
import pytest
from support.alterations import changed, get, places, put
from support.checkout import ROOT
from support.unjudged import unjudged
from support.unlucky import answering
from trajgap.nlp.proofs.answer import keeps_limits
from trajgap.nlp.proofs.certifiers import certify
from trajgap.nlp.proofs.cubic import (
    certifier as cubic_certify,
)
from trajgap.nlp.proofs.cubic import (
    ranges as cubic_ranges,
)
from trajgap.nlp.proofs.cubic import (
    tree as cubic_tree,
)
from trajgap.nlp.proofs.cubic.certifier import CUBIC
from trajgap.nlp.proofs.cubic.proof import Target, least
from trajgap.nlp.proofs.cubic.ranges import a_priori, narrowed, with_rho
from trajgap.nlp.proofs.cubic.relaxation import Relaxation
from trajgap.nlp.proofs.cubic.system import PLACES, CubicSystem, cubic_system
from trajgap.nlp.proofs.cubic.tree import Prover
from trajgap.nlp.proofs.document import certificate, problem_document
from trajgap.nlp.proofs.exact import exact_problem, printed_problem
from trajgap.nlp.proofs.outcome import Certified, Outcome, Progress, Request
from trajgap.nlp.proofs.state import state_document
from trajgap.problem import (
    Interpolant,
    Limits,
    Problem,
    TrajgapError,
    cubic_spline,
    cubic_spline_virtual,
    evaluate,
    fit,
    load_case,
)
from trajgap.verify import MOST_INTEGER, TICKS, read_problem
from trajgap.verify import verify_certificate as verify
from trajgap.verify.cubic.box import Box
from trajgap.verify.cubic.system import Cubic
from trajgap.verify.reading import Clock

EXAMPLE = ROOT / "docs" / "examples" / "gasparetto-zanotto2008.toml"
NATURAL = ((2, 0.0),)


def random_curve(rng: np.random.Generator) -> Interpolant:
    kind = int(rng.integers(0, 4))
    if kind == 3:
        return cubic_spline_virtual(3)
    count = int(rng.integers(2, 4))
    curve = cubic_spline(count, NATURAL if kind == 1 else ((1, 0.0),))
    if kind < 2:
        return curve
    ends = (curve.prescribed[0], *curve.prescribed[1:-1], NATURAL)
    return Interpolant(curve.degrees, curve.continuity, ends, name="clamped, then natural")


def random_problem(seed: int) -> Problem:
    """Small problem with unequal joints; every kind of limit, bound and end turns up."""
    rng = np.random.default_rng(seed)
    curve, joints = random_curve(rng), int(rng.integers(1, 3))
    waypoints = curve.segments + 1 - len(curve.virtual)
    q = rng.normal(0.3, 1.0, (waypoints, joints))
    scale = rng.uniform(0.3, 3.0, (3, joints))
    some = rng.random(3) < 0.6
    some[0] |= not some.any() or curve.prescribed[0] == NATURAL
    v, a, j = (scale[i] if some[i] else np.full(joints, np.inf) for i in range(3))
    lower = rng.uniform(0.1, 1.0, curve.segments) if rng.random() < 0.4 else 0.0
    upper = rng.uniform(4.0, 9.0, curve.segments) if rng.random() < 0.3 else np.inf
    return Problem(q, Limits(v, a, j), curve, lower, upper)


def dense_best(problem: Problem, count: int = 40_000) -> float:
    """Smallest total over many directions, each stretched as little as it may be."""
    rng = np.random.default_rng(1)
    n = problem.segments
    shares = rng.dirichlet(np.full(n, 0.8), count)
    for width in (0.3, 0.1, 0.03):
        totals = _totals(problem, shares)
        near = shares[np.argsort(totals)[:50]]
        moved = np.repeat(near, 200, axis=0) * np.exp(rng.normal(0, width, (10_000, n)))
        shares = np.vstack([shares, moved / moved.sum(axis=1, keepdims=True)])
    return float(_totals(problem, shares).min())


def _totals(problem: Problem, shares: np.ndarray) -> np.ndarray:
    shares = np.maximum(shares, 1e-9)
    stretch = evaluate(problem, shares).stretch
    stretch = np.maximum(stretch, (problem.duration_lower / shares).max(axis=1))
    stretch[(shares * stretch[:, None] > problem.duration_upper).any(axis=1)] = np.inf
    return np.asarray(stretch * shares.sum(axis=1))


def attack(seed: int, gap: float = 0.1, seconds: float = 5.0) -> Outcome:
    problem = random_problem(seed)
    found = certify(problem, gap=gap, seconds=seconds)
    best = dense_best(problem)
    if found.outcome is Outcome.INFEASIBLE:
        assert best == np.inf
    else:
        assert float(found.lower) <= best * (1 + 1e-9)
        if found.upper is not None:
            assert found.lower <= found.upper
            assert found.durations is not None
            assert keeps_limits(exact_problem(problem), found.durations)
    if found.proof is not None:
        verdict = verify(certificate(found))
        assert verdict.proves, verdict
        assert (verdict.lower, verdict.upper) == (found.lower, found.upper)
    return found.outcome


@pytest.mark.parametrize("seed", range(4))
def test_dense_search_never_leaves_the_interval(seed: int) -> None:
    attack(seed)


@pytest.mark.slow
def test_dense_search_never_leaves_the_interval_of_two_hundred_problems() -> None:
    outcomes = [attack(seed, 0.05, 20.0) for seed in range(4, 204)]
    # Without limits of acceleration some take longer; all of them are proved to hold.
    decided = outcomes.count(Outcome.CERTIFIED) + outcomes.count(Outcome.INFEASIBLE)
    assert decided >= 150


# --- closed forms and identities ------------------------------------------------------------------


@pytest.mark.parametrize(
    ("limits", "total"),
    [
        (Limits(1.25), 1.5 * 3 / 1.25),
        (Limits(np.inf, 2.5), np.sqrt(6 * 3 / 2.5)),
        (Limits(np.inf, np.inf, 1.75), np.cbrt(12 * 3 / 1.75)),
    ],
)
def test_one_clamped_piece_has_a_closed_form(limits: Limits, total: float) -> None:
    problem = Problem([[-1.0], [2.0]], limits, cubic_spline(1))
    # `certify` prefers the closed form of rest-to-rest polynomials.
    found = CUBIC.run(exact_problem(problem), Request(gap=1e-3))
    assert found.outcome is Outcome.CERTIFIED
    assert float(found.lower) <= total * (1 + 1e-12)
    assert float(found.upper or 0) == pytest.approx(total, rel=1e-7)
    assert verify(certificate(found)).proves


def test_a_natural_spline_along_a_line_has_constant_speed() -> None:
    problem = Problem([[0.5], [1.5], [4.5], [5.0]], Limits(1.5, 0.5), cubic_spline(3, NATURAL))
    found = certify(problem, gap=1e-4)
    assert found.outcome is Outcome.CERTIFIED
    assert float(found.lower) <= 4.5 / 1.5 <= float(found.upper or 0) * (1 + 1e-12)


def base_problem() -> Problem:
    q = np.array([[0.2, -0.3], [1.3, 0.4], [0.6, 1.1]])
    return Problem(q, Limits([1.1, 0.9], [1.9, 2.3], [7.0, 9.0]), cubic_spline_virtual(3))


@lru_cache(maxsize=1)
def base() -> Certified:
    return certify(base_problem(), gap=0.02)


def meets(one: Certified, other: Certified, factor: float) -> bool:
    assert one.upper is not None
    assert other.upper is not None
    low, high = float(other.lower) / factor, float(other.upper) / factor
    return low <= float(one.upper) * (1 + 1e-9) and float(one.lower) <= high * (1 + 1e-9)


def test_scaling_angles_and_time_scales_the_interval() -> None:
    p = base_problem()
    v, a, j = p.limits.derivatives.T
    slow = Problem(p.waypoints * 3, Limits(v * 3 / 7, a * 3 / 49, j * 3 / 343), p.curve)
    found = certify(slow, gap=0.02)
    assert found.outcome is Outcome.CERTIFIED
    assert meets(base(), found, 7.0)
    assert float(found.upper or 0) == pytest.approx(7 * float(base().upper or 0), rel=1e-6)


def test_the_way_back_takes_as_long_and_a_turned_joint_too() -> None:
    p = base_problem()
    back = Problem(p.waypoints[::-1] * [1.0, -1.0], p.limits, p.curve)
    assert meets(base(), certify(back, gap=0.02), 1.0)


def test_a_joint_alone_is_not_slower() -> None:
    exact = exact_problem(base_problem())
    for j in range(2):
        alone = certify(exact.joint(j), gap=0.1)
        assert alone.lower <= (base().upper or 0)


# --- the equations --------------------------------------------------------------------------------


def unknowns(system: CubicSystem, problem: Problem, h: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Coordinates and unknowns (scaled) of the spline through the way-points, from its fit."""
    curve = fit(problem.curve, problem.waypoints, h)
    breaks = np.concatenate([[0.0], np.cumsum(h)])
    unit, angle = 2.0**system.second, 2.0 ** np.array(system.powers)
    a = np.array([curve(t, 2) for t in breaks]) * unit**2 / angle
    v = np.array([curve(breaks[b], 1) for b in system.breaks]) * unit / angle
    ends = breaks[system.breaks]
    y = list(np.diff(ends) / unit)
    if system.virtual:
        y += [h[0] / unit, h[-1] / unit]
        y += [y[system.spans] ** 2 / y[0], y[system.spans + 1] ** 2 / y[system.spans - 1]]
    return np.array(y), np.vstack([a, v])


@pytest.mark.parametrize("seed", range(8))
def test_equations_and_conditions_are_those_of_the_spline(seed: int) -> None:
    problem = random_problem(seed)
    exact = exact_problem(problem)
    system = cubic_system(exact, Fraction(11))
    h = np.random.default_rng(seed).uniform(0.5, 2.0, problem.segments)
    y, x = unknowns(system, problem, h)
    for terms, moved in system.equations():
        left = sum(c * x[v] for v, c in terms.by.items())
        left = left + sum(c * y[k] * x[v] for (k, v), c in terms.product.items())
        right = np.zeros(system.joints)
        if moved is not None:
            t, sign = moved
            right = np.array([6 * sign * float(s) / y[t] for s in system.steps[t]])
        assert left == pytest.approx(right, abs=1e-9)
    curve = fit(problem.curve, problem.waypoints, h)
    began = np.concatenate([[0.0], np.cumsum(h)])
    for row in system.starting_rows():
        terms = system.row(row, Fraction(8))
        j = max(row.joint, 0)
        value = sum(c * x[v, j] for v, c in terms.by.items()) + float(terms.constant)
        value += sum(c * y[k] * x[v, j] for (k, v), c in terms.product.items())
        value += sum(float(c) * y[k] for k, c in terms.along.items())
        unit, angle = 2.0**system.second, 2.0 ** system.powers[j]
        if row.kind == "velocity":
            rough, s = system.virtual and row.index in (0, system.spans - 1), row.place / PLACES
            piece = system.breaks[row.index] + (1 if rough and row.index == 0 else 0)
            last = rough and row.index > 0
            t = began[piece] + (h[piece] * (1 - s if last else s))
            limit = problem.limits.velocity[j]
            sign = -row.sign if last else row.sign
            expected = (sign * curve(t, 1)[j] - limit) * unit / angle
        elif row.kind == "jerk":
            jump = curve(began[row.index + 1], 2)[j] - curve(began[row.index], 2)[j]
            limit = problem.limits.jerk[j] * h[row.index]
            expected = (row.sign * jump - limit) * unit**2 / angle
        elif row.kind == "lower":
            expected = (problem.duration_lower[row.index] - h[row.index]) / unit
        else:
            expected = (h[row.index] - problem.duration_upper[row.index]) / unit
        assert value == pytest.approx(expected, abs=1e-8)


def both(problem: Problem, cap: int) -> tuple[Prover, Cubic]:
    """Solver and verifier for one problem, by their own routes."""
    exact = exact_problem(problem)
    prover = Prover(cubic_system(exact, Fraction(11)), cap)
    proof = {"powers": list(prover.system.powers), "second": prover.system.second, "cap": cap}
    return prover, Cubic(read_problem(problem_document(exact)), proof)


@pytest.mark.parametrize("seed", range(8))
def test_solver_and_verifier_read_the_same_system(seed: int) -> None:
    prover, cubic = both(random_problem(seed), 11 * TICKS)
    system = prover.system
    for i, (terms, moved) in enumerate(system.equations()):
        assert cubic.equations[i] == {**terms.by, **terms.product}
        assert cubic.moved.get(i) == moved
    for row in system.starting_rows():
        terms = system.row(row, prover.total)
        joint, own, along, constant = cubic.condition(
            [row.kind, row.joint, row.index, row.sign, row.place]
        )
        assert (joint, along, constant) == (row.joint, terms.along, terms.constant)
        assert {k: x for k, x in own.items() if x} == {**terms.by, **terms.product}


@pytest.mark.parametrize("seed", range(8))
def test_ranges_hold_what_the_limits_allow(seed: int) -> None:
    # Boxes around feasible durations: the spline's own unknowns must be in both sets of ranges.
    problem = random_problem(seed)
    rng = np.random.default_rng(seed)
    h = rng.uniform(0.5, 2.0, problem.segments)
    free = Problem(problem.waypoints, problem.limits, problem.curve)
    h *= float(evaluate(free, h[None]).stretch[0]) * 1.001
    exact = exact_problem(free)
    system = cubic_system(exact, Fraction(float(h.sum()) * 1.2))
    unit = 2.0**system.second
    cap = int(h.sum() / unit * 1.2 * TICKS)
    prover, proof = Prover(system, cap), {"powers": list(system.powers), "second": system.second}
    cubic = Cubic(read_problem(problem_document(exact)), {**proof, "cap": cap})
    y, x = unknowns(system, free, h)
    for width in (0.02, 0.2, 0.6):
        low = np.floor(y[: system.free] * (1 - width * rng.random(system.free)) * TICKS)
        high = np.ceil(y[: system.free] * (1 + width * rng.random(system.free)) * TICKS)
        root = prover.root()
        root.low, root.high = [int(z) for z in low], [int(z) for z in high]
        prover.trim(root)
        side = prover.side(root)
        assert (side.low <= y).all()
        assert (y <= side.high).all()
        found = narrowed(system, side, *a_priori(system, side, prover.total))
        assert found is not None
        assert (found[0] <= x + 1e-9).all()
        assert (x <= found[1] + 1e-9).all()
        nothing: list[list[Any]] = [[None] * cubic.size for _ in range(cubic.joints)]
        box = Box(cubic, list(root.low), list(root.high), nothing, 0)
        box.narrow(Clock(60.0))
        for j, row in enumerate(box.x):
            for v, bounds in enumerate(row):
                if bounds is None:
                    assert not np.isfinite(found[1][v, j])
                    continue
                assert float(bounds[0]) <= x[v, j] + 1e-9
                assert x[v, j] <= float(bounds[1]) + 1e-9
                # The verifier must not be weaker than what the solver relied on.
                assert float(bounds[0]) >= found[0][v, j] - 1e-12
                assert float(bounds[1]) <= found[1][v, j] + 1e-12


def test_weights_without_the_target_prove_nothing_about_it() -> None:
    prover, _ = both(base_problem(), 11 * TICKS)
    box = prover.root()
    prover.narrow(box)
    relaxation = Relaxation(prover.system, prover.system.starting_rows(), prover.total)
    found = relaxation.over(prover.side(box), box.ranges).bound(Target(0, -1))
    assert found is not None
    assert prover.bound(box, Target(0, -1), found.weights) is not None
    assert prover.bound(box, Target(0, -1), replace(found.weights, scale=0)) is None


def test_a_bound_with_any_weights_holds_at_feasible_points() -> None:
    # Weights are arbitrary: whatever they are, the bound must stay below the target.
    problem = base_problem()
    rng = np.random.default_rng(3)
    h = rng.uniform(0.5, 2.0, problem.segments)
    h *= float(evaluate(problem, h[None]).stretch[0]) * 1.0001
    exact = exact_problem(problem)
    system = cubic_system(exact, Fraction(float(h.sum()) * 1.1))
    y, _ = unknowns(system, problem, h)
    total = Fraction(float(y[: system.spans].sum() * 1.05))
    rows = system.starting_rows()
    for width in (0.01, 0.1, 0.4):
        side = with_rho(
            system, y[: system.free] * (1 - width), y[: system.free] * (1 + 0.5 * width)
        )
        ranges = narrowed(system, side, *a_priori(system, side, total))
        assert ranges is not None
        program = Relaxation(system, rows, total).over(side, ranges)
        for k in range(system.free):
            for sign in (1, -1):
                found = program.bound(Target(k, sign))
                assert found is not None
                weights = found.weights
                for key in weights.equations:
                    weights.equations[key] += int(rng.integers(-(2**19), 2**19))
                for row in weights.rows:
                    weights.rows[row] += int(rng.integers(0, 2**19))
                weights.mix[...] = rng.integers(0, 33, weights.mix.shape)
                bound = least(system, total, Target(k, sign), weights, side, ranges)
                assert bound <= sign * y[k] * weights.scale * (1 + sign * 1e-12)


# --- attacks --------------------------------------------------------------------------------------


def unlucky(monkeypatch: pytest.MonkeyPatch, seconds: float) -> tuple[float, Certified]:
    """Certify with an answer 10 % above the best known and no search for a better one."""
    best = base()
    assert best.durations is not None
    worse = tuple(h * Fraction(11, 10) for h in best.durations)

    answering(monkeypatch, lambda call, initial: worse)
    monkeypatch.setattr(cubic_certify._Watch, "improve", lambda *_: None)
    return float(best.upper or 0), certify(base_problem(), gap=0.02, seconds=seconds)


def test_an_answer_that_is_not_optimal_is_never_certified(monkeypatch: pytest.MonkeyPatch) -> None:
    optimum, found = unlucky(monkeypatch, 4.0)
    assert found.outcome is Outcome.INTERVAL
    assert 0.5 * optimum < found.lower <= optimum


def test_a_broken_relaxation_is_caught(monkeypatch: pytest.MonkeyPatch) -> None:
    true = cubic_ranges.implied
    base()

    def broken(system: CubicSystem, cap: Fraction) -> list[tuple[float, float]]:
        return [(0.7 * v, 0.7 * a) for v, a in true(system, cap)]

    for module in (cubic_ranges, cubic_tree, cubic_certify):
        monkeypatch.setattr(module, "implied", broken)
    raw = unjudged(monkeypatch)
    optimum, found = unlucky(monkeypatch, 20.0)
    assert raw[-1].lower > optimum, "the attack above would not have seen it"
    assert not verify(certificate(raw[-1])).proves
    assert (found.outcome, found.lower, found.proof) == (Outcome.OPEN, 0, None)


def test_a_worse_local_answer_is_replaced(monkeypatch: pytest.MonkeyPatch) -> None:
    best = base()
    assert best.durations is not None
    double = tuple(h * 2 for h in best.durations)
    calls = answering(monkeypatch, lambda call, initial: double if call == 1 else True)
    found = certify(base_problem(), gap=0.02)
    assert len(calls) > 1
    assert found.outcome is Outcome.CERTIFIED
    assert float(found.upper or 0) == pytest.approx(float(best.upper or 0), rel=1e-6)
    assert verify(certificate(found)).proves


def interrupted(after: int) -> Certified:
    def report(progress: Progress) -> None:
        if progress.nodes >= after and progress.open_boxes >= 3:
            raise KeyboardInterrupt

    return certify(base_problem(), gap=1e-3, report=report)


def test_a_stopped_run_goes_on_where_it_stopped() -> None:
    first = interrupted(12)
    assert first.outcome is Outcome.INTERVAL
    assert first.proposals is not None
    assert first.open_boxes > 0
    assert 1e-3 < first.gap < 1
    assert verify(certificate(first)).proves
    state = json.loads(json.dumps(state_document(first)))
    assert verify(state).lower == first.lower
    second = certify(base_problem(), gap=1e-3, resume=state)
    assert second.outcome is Outcome.CERTIFIED
    assert verify(certificate(second)).proves
    whole = certify(base_problem(), gap=1e-3)
    assert second.nodes < whole.nodes


def test_an_altered_state_is_refused() -> None:
    def stop(_: Progress) -> None:
        raise KeyboardInterrupt

    document = json.loads(json.dumps(state_document(interrupted(12))))
    rng = np.random.default_rng(0)
    for part, key in (("proposals", "tree"), ("proposals", "root"), ("proof", "tree")):
        found_places = [p for p in places({"proof": document[part]}) if p[1] == key]
        refused = 0
        for path in [found_places[i] for i in rng.integers(0, len(found_places), 8)]:
            wrong = json.loads(json.dumps(document))
            put({"proof": wrong[part]}, path, 2**27 + int(rng.integers(0, 2**20)))
            try:
                found = certify(base_problem(), gap=1e-3, resume=wrong, report=stop)
            except TrajgapError as error:
                refused += "resume" in str(error)
                continue
            assert found.lower <= (base().upper or 0)
        # The root of a proposal is not read: it is computed.
        assert refused > 0 or key == "root"

    def wrong_in(part: str, **change: Any) -> dict[str, Any]:
        return {**document, part: {**document[part], **change}}

    with pytest.raises(TrajgapError, match="kind"):
        certify(base_problem(), resume=wrong_in("proposals", kind="three-piece"))
    with pytest.raises(TrajgapError, match="malformed"):
        certify(base_problem(), resume={**document, "proposals": {"kind": "cubic"}})
    # As a power of ten it would fill the memory.
    with pytest.raises(TrajgapError, match="malformed"):
        certify(base_problem(), resume=wrong_in("claim", durations=["1e999999999"] * 2))


def test_no_time_gives_what_mean_velocities_say() -> None:
    found = certify(base_problem(), seconds=0.0)
    assert found.outcome is Outcome.INTERVAL
    assert float(found.lower) == pytest.approx(1.1 / 1.1 + 0.7 / 0.9, rel=1e-6)
    assert verify(certificate(found)).proves


def test_durations_that_no_trajectory_keeps_are_proved_infeasible() -> None:
    p = base_problem()
    best = base()
    assert best.durations is not None
    upper = [float(h) * 0.9 for h in best.durations]
    found = certify(Problem(p.waypoints, p.limits, p.curve, 0.0, upper))
    assert found.outcome is Outcome.INFEASIBLE
    document = certificate(found)
    verdict = verify(document)
    assert verdict.proves
    assert verdict.infeasible
    document["problem"]["duration_upper"] = [str(h * 2) for h in best.durations]
    assert not verify(document).proves


def test_durations_far_too_short_are_proved_infeasible_within_the_range_of_a_proof() -> None:
    # Mean speeds alone ask for 100 s each: more ticks than the integers of a proof may have.
    problem = Problem([[0.0], [1.0], [2.0], [3.0]], Limits(0.01, 1.0), cubic_spline(3), 0.0, 5.0)
    found = certify(problem)
    assert found.outcome is Outcome.INFEASIBLE
    assert found.verdict is not None
    assert found.verdict.infeasible
    document = certificate(found)
    assert max(document["proof"]["root"]) <= document["proof"]["cap"] <= MOST_INTEGER


def test_a_spline_that_is_too_long_for_a_certificate_is_not_covered() -> None:
    many = Problem(np.arange(66.0)[:, None], Limits(1.0, 1.0), cubic_spline(65))
    with pytest.raises(TrajgapError, match="more than 64 segments"):
        certify(many)


def test_what_is_not_covered_is_said() -> None:
    q = [[0.2], [1.1], [-0.4]]
    with pytest.raises(TrajgapError, match="nothing limits"):
        certify(Problem(q, Limits(np.inf, 2.0), cubic_spline(2, NATURAL)))
    with pytest.raises(TrajgapError, match="not covered"):
        certify(Problem(q[:2], Limits(1.0), cubic_spline_virtual(2)))


@lru_cache(maxsize=1)
def small() -> str:
    """A certificate with few steps and every kind of number in it, as JSON."""
    q = [[0.25], [1.0], [-0.375]]
    limits = Limits([1.0], [2.0], [8.0])
    problem = Problem(q, limits, cubic_spline(2), (0.5, 0.25), (6.0, 5.0))
    return json.dumps(certificate(certify(problem, gap=0.0005)))


def stated(data: dict[str, Any]) -> Problem:
    """The problem in a certificate, by a second route."""
    p = data["problem"]

    def numbers(row: list[Any], absent: float) -> list[float]:
        return [absent if x is None else float(Fraction(x)) for x in row]

    v, a, j = np.array([numbers(row, np.inf) for row in p["limits"]]).T
    return Problem(
        np.array([numbers(row, 0.0) for row in p["waypoints"]]),
        Limits(v, a, j),
        cubic_spline(2),
        numbers(p["duration_lower"], 0.0),
        numbers(p["duration_upper"], np.inf),
    )


def mutate_all(per_place: int, seed: int) -> dict[str, int]:
    rng = np.random.default_rng(seed)
    counts = {"refused": 0, "still proves": 0}
    for path in places(json.loads(small())):
        for _ in range(per_place):
            data = json.loads(small())
            put(data, path, changed(get(data, path), rng))
            verdict = verify(data)
            counts["still proves" if verdict.proves else "refused"] += 1
            if verdict.proves:
                assert verdict.lower is not None
                best = dense_best(stated(data), 2000)
                assert float(verdict.lower) <= best * (1 + 1e-9), path
                assert verdict.infeasible <= (best == np.inf)
    return counts


def test_no_altered_number_proves_a_false_statement() -> None:
    counts = mutate_all(1, 0)
    assert counts["refused"] > counts["still proves"] > 0


@pytest.mark.slow
def test_no_altered_number_proves_a_false_statement_many_times() -> None:
    counts = mutate_all(40, 1)
    assert min(counts.values()) > 100


def test_alterations_in_favour_of_the_claim_are_refused() -> None:
    true = json.loads(small())
    assert verify(true).proves
    claim, proof = true["claim"], true["proof"]
    higher = str(Fraction(claim["lower"]) * Fraction(101, 100))

    def refused(change: Any) -> bool:
        data = copy.deepcopy(true)
        change(data)
        return not verify(data).proves

    assert refused(lambda d: d["claim"].update(lower=higher))
    tick = Fraction(2) ** proof["second"] / TICKS
    total = Fraction(proof["total"]) + 100_000 * tick
    more = {"total": str(total), "cap": proof["cap"] + 100_000}
    assert refused(lambda d: d["proof"].update(more))
    assert refused(lambda d: d["proof"].update(total=str(total)))
    assert refused(lambda d: d["proof"].update(tree=[]))
    assert refused(lambda d: d["proof"].update(tree=[["."]]))
    assert refused(lambda d: d["proof"].update(tree=[["?"]]))
    assert refused(lambda d: d["proof"].update(root=[x + 2**24 for x in proof["root"]]))
    assert refused(lambda d: d["problem"]["limits"][0].__setitem__(1, "2.2"))
    assert refused(lambda d: d["problem"].update(duration_lower=["0", "0"], virtual=[1]))
    # Floats would spoil exactness: they are no integers.
    assert refused(lambda d: d["proof"].update(cap=float(proof["cap"])))
    for row in proof["rows"]:
        signed = [[*r[:3], float(r[3]), r[4]] if r is row else r for r in proof["rows"]]
        assert refused(lambda d, signed=signed: d["proof"].update(rows=signed))
    moved = [i for i, step in enumerate(proof["tree"]) if step[0] == "t"]
    assert moved
    for i in moved:
        step = proof["tree"][i]
        inward = [*step[:3], step[3] + step[2] * 50_000, *step[4:]]
        tree = [inward if k == i else s for k, s in enumerate(proof["tree"])]
        assert refused(lambda d, tree=tree: d["proof"].update(tree=tree))


def test_the_example_s_certificate_is_fresh_and_proves() -> None:
    case = load_case(EXAMPLE)
    exact = printed_problem(case.statement(case.problems[0].id, case.readings[0].id))
    document = json.loads(EXAMPLE.with_suffix(".certificate.json").read_text("utf-8"))
    assert document["problem"] == problem_document(exact), "run benchmarks/cubic_certificates.py"
    verdict = verify(document)
    assert verdict.proves
    assert not verdict.altered
    assert verdict.lower is not None
    assert verdict.upper is not None
    assert verdict.upper - verdict.lower <= verdict.upper / 100
    # The paper's compromise between time and jerk is no least time, and lies above.
    assert verdict.upper < Fraction("9.05")
    assert len(json.dumps(document)) < 200_000
    page = (EXAMPLE.parents[1] / "certificates-cubic.md").read_text("utf-8")
    line = next(x for x in page.splitlines() if x.startswith(f"| `{EXAMPLE.stem}` | 5 |"))
    printed = [Fraction(cell.strip()) for cell in line.split("|")[3:5]]
    assert [float(x) for x in printed] == pytest.approx(
        [float(verdict.lower), float(verdict.upper)], abs=6e-5
    )


@pytest.mark.parametrize("seed", range(6))
def test_ranges_of_a_span_that_almost_vanishes_are_the_same_on_both_sides(seed: int) -> None:
    # Coincident way-points and a velocity limit alone: nothing keeps the span from 0.
    rng = np.random.default_rng([44, seed])
    q = np.array([[-0.3], [-0.3], [0.8], [0.4]]) if seed % 2 else np.array([[-0.3], [0.8], [0.8]])
    first = seed % 2 == 1
    problem = Problem(q, Limits([1.0]), cubic_spline_virtual(len(q)))
    prover, cubic = both(problem, 11 * TICKS)
    spans, root = prover.system.spans, prover.root()
    y = rng.uniform(1.0, 3.0, prover.system.free)
    k, h = (0, spans) if first else (spans - 1, spans + 1)
    y[k] = rng.uniform(1e-6, 4e-6)
    y[spans], y[spans + 1] = 0.4 * y[0], 0.6 * y[spans - 1]
    y[h] = 0.7 * y[k]
    root.low = [int(z * (1 - 1e-3) * TICKS) for z in y]
    root.high = [int(z * (1 + 1e-3) * TICKS) + 1 for z in y]
    prover.trim(root)
    side = prover.side(root)
    found = narrowed(prover.system, side, *a_priori(prover.system, side, prover.total))
    assert found is not None
    box = Box(cubic, list(root.low), list(root.high), [[None] * cubic.size], 0)
    box.narrow(Clock(60.0))
    for v, bounds in enumerate(box.x[0]):
        assert bounds is not None
        slack = 1e-9 * (1.0 + abs(found[1][v, 0]))
        assert float(bounds[0]) >= found[0][v, 0] - slack
        assert float(bounds[1]) <= found[1][v, 0] + slack
