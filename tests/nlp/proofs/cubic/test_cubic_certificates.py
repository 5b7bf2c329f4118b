"""Certificates of C2 cubic splines: dense search, closed forms, identities, and attacks."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from support.cubic_problems import NATURAL, base, base_problem, both, random_problem
from trajgap.nlp.proofs.certifiers import certify
from trajgap.nlp.proofs.cubic.certifier import CUBIC
from trajgap.nlp.proofs.cubic.proof import Target
from trajgap.nlp.proofs.cubic.ranges import a_priori, narrowed
from trajgap.nlp.proofs.cubic.relaxation import Relaxation
from trajgap.nlp.proofs.cubic.system import CubicSystem, cubic_system
from trajgap.nlp.proofs.cubic.tree import Prover
from trajgap.nlp.proofs.document import certificate, problem_document
from trajgap.nlp.proofs.exact import exact_problem
from trajgap.nlp.proofs.outcome import Certified, Outcome, Request
from trajgap.problem import (
    Limits,
    Problem,
    cubic_spline,
    evaluate,
    fit,
)
from trajgap.verify import TICKS, read_problem
from trajgap.verify import verify_certificate as verify
from trajgap.verify.cubic.box import Box
from trajgap.verify.cubic.system import Cubic
from trajgap.verify.reading import Clock

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
