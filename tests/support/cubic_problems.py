"""Problems of cubic splines that are certified."""

from __future__ import annotations

from fractions import Fraction
from functools import lru_cache

import numpy as np
from trajgap.nlp.proofs.certifiers import certify
from trajgap.nlp.proofs.cubic.system import CubicSystem, capped, cubic_system
from trajgap.nlp.proofs.cubic.tree import Prover
from trajgap.nlp.proofs.document import problem_document
from trajgap.nlp.proofs.exact import exact_problem
from trajgap.nlp.proofs.outcome import Certified
from trajgap.problem import (
    Interpolant,
    Limits,
    Problem,
    cubic_spline,
    cubic_spline_virtual,
)
from trajgap.verify import TICKS, read_problem

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


def base_problem() -> Problem:
    q = np.array([[0.2, -0.3], [1.3, 0.4], [0.6, 1.1]])
    return Problem(q, Limits([1.1, 0.9], [1.9, 2.3], [7.0, 9.0]), cubic_spline_virtual(3))


@lru_cache(maxsize=1)
def base() -> Certified:
    return certify(base_problem(), gap=0.02)


def prover_of(problem: Problem, total: Fraction | None = None) -> Prover:
    """What carries out steps below a total; of 11 units of time by default."""
    stated = read_problem(problem_document(exact_problem(problem)))
    if total is not None:
        return Prover(cubic_system(stated, total))
    units = cubic_system(stated, Fraction(11)).units
    return Prover(CubicSystem(stated, capped(stated, units["powers"], units["second"], 11 * TICKS)))
