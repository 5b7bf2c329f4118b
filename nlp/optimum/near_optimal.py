"""How far the durations of each joint can vary while its total stays within a given slack."""

from __future__ import annotations

import itertools
from dataclasses import replace
from functools import lru_cache
from typing import Any

import numpy as np

from ...problem import Array, Problem, check, fit
from .formulation import Formulation, Structure, pack_parameters
from .ipopt import compiled, structure_of
from .near_newton import applies, reached
from .symbolic import ca
from .tracking import (
    Scaled,
    pack,
    place_slots,
    scaled_problem,
    unpack,
    variable_bounds,
)

_PASSES = 12
"""Solves from one optimum: a bound against endless shrinking of the region."""
_OPTIONS = {
    "print_time": False,
    "show_eval_warnings": False,  # the status says where a function is not defined
    "ipopt.print_level": 0,
    "ipopt.sb": "yes",
    "ipopt.tol": 1e-9,
    "ipopt.constr_viol_tol": 1e-10,
    "ipopt.bound_relax_factor": 0.0,
    "ipopt.mu_init": 1e-4,
    "ipopt.max_iter": 200,
}
"""Options of IPOPT as `ipopt.ipopt_options`, begun near a solution (small barrier)."""


@lru_cache(maxsize=32)
def _nlp(structures: tuple[Structure, ...], longest: bool) -> Any:
    """One NLP over several joints, each within its cap; all numbers are parameters.

    Objective: the sum over segments of the longest duration (``longest``), or a weighted sum of
    the first joint's durations.
    """
    n = structures[0].interpolant.segments
    top = ca.SX.sym("longest", n)
    weights = ca.SX.sym("weights", n)
    caps = ca.SX.sym("caps", len(structures))
    variables, parameters, equal, below = [top], [weights, caps], [], []
    for i, structure in enumerate(structures):
        f = compiled(structure).formulation
        own = ca.Function("own", [f.variables, f.parameters], [f.equalities, f.inequalities])
        x = ca.SX.sym(f"x{i}", f.variables.numel())
        p = ca.SX.sym(f"p{i}", f.parameters.numel())
        e, g = own(x, p)
        variables.append(x)
        parameters.append(p)
        equal.append(e)
        below += [g, ca.sum1(x[:n]) - caps[i]]
        if longest:
            below.append(x[:n] - top)
    objective = ca.sum1(top) if longest else ca.dot(weights, variables[1][:n]) + ca.sumsqr(top)
    e, g = ca.vertcat(*equal), ca.vertcat(*below)
    nlp = {
        "x": ca.vertcat(*variables),
        "p": ca.vertcat(*parameters),
        "f": objective,
        "g": ca.vertcat(e, g),
    }
    return ca.nlpsol("near", "ipopt", nlp, _OPTIONS), e.numel(), g.numel()


def _improve(
    problems: list[Problem],
    starts: list[Array],
    caps: list[float],
    weights: Array | None,
) -> list[Array]:
    """Durations of each joint that optimise the objective near ``starts``, slots on extrema."""
    structures = tuple(structure_of(p) for p in problems)
    formulations: list[Formulation] = [compiled(s).formulation for s in structures]
    n = problems[0].segments
    unit = float(np.mean([h.mean() for h in starts]))
    scaled: list[Scaled] = [
        scaled_problem(p, f, unit) for p, f in zip(problems, formulations, strict=True)
    ]
    solver, equalities, inequalities = _nlp(structures, weights is None)
    low_g = np.concatenate([np.zeros(equalities), np.full(inequalities, -np.inf)])
    h = [start.copy() for start in starts]
    radius = 0.05
    for _ in range(_PASSES):
        top = np.max(h, axis=0) / unit if weights is None else np.zeros(n)
        x0, low, high = [top], [np.zeros(n)], [np.full(n, np.inf)]
        p = [np.zeros(n) if weights is None else weights, np.array(caps) / unit]
        for problem, f, s, own in zip(problems, formulations, scaled, h, strict=True):
            x = pack(problem, f, s, own, None)
            wide = variable_bounds(problem, f, unit, 0.0)
            wide[0][:n] = np.maximum(wide[0][:n], x[:n] * (1 - radius))
            wide[1][:n] = np.minimum(wide[1][:n], x[:n] * (1 + radius))
            trajectory = fit(problem.curve, problem.waypoints, own)
            trajectory = replace(trajectory, scaled=trajectory.scaled / s.angle_unit)
            places, newton = place_slots(f, trajectory)
            p.append(pack_parameters(s.values, s.inverse_limits, s.position, places, newton))
            x0.append(x)
            low.append(wide[0])
            high.append(wide[1])
        result = solver(
            x0=np.concatenate(x0),
            p=np.concatenate(p),
            lbx=np.concatenate(low),
            ubx=np.concatenate(high),
            lbg=low_g,
            ubg=np.zeros(low_g.size),
        )
        answer = np.asarray(result["x"]).ravel()
        at, moved, new = n, 0.0, []
        for problem, f, s, own in zip(problems, formulations, scaled, h, strict=True):
            size = f.sizes["variables"]
            fresh, _ = unpack(problem, f, s, answer[at : at + size])
            new.append(np.clip(fresh, problem.duration_lower, problem.duration_upper))
            moved = max(moved, float(np.abs(fresh / own - 1).max()))
            at += size
        if all(
            check(q, d).stretch <= 1 + 1e-4 * radius for q, d in zip(problems, new, strict=True)
        ):
            h = new
            if moved < 1e-8:
                break
        else:
            radius *= 0.25
    return h


def _moved(
    problems: list[Problem],
    starts: list[Array],
    caps: list[float],
    weights: Array | None,
) -> list[Array]:
    """`_improve` by Newton steps where they settle: some hundred such answers make one range."""
    found = reached(problems, starts, caps, weights) if applies(problems) else None
    if found is None:
        found = _improve(problems, starts, caps, weights)
    return [_kept(problem, h) for problem, h in zip(problems, found, strict=True)]


def _kept(problem: Problem, h: Array) -> Array:
    """Durations made feasible by the (tiny) uniform stretch that they may need."""
    stretch = max(1.0, check(problem, h).stretch)
    return np.asarray(np.clip(h * stretch, problem.duration_lower, problem.duration_upper))


def longest_per_segment_range(
    problems: list[Problem], optima: list[Array], slack: float
) -> tuple[float, float]:
    """Range of Σ_k max_j h_jk while each joint keeps its limits and its total within ``slack``.

    Parameters
    ----------
    problems : list of Problem
        One-joint problems with the same number of segments.
    optima : list of ndarray, shape (segments,)
        Durations of each joint's own best known optimum, s.
    slack : float
        Allowed excess of each joint's total over its optimum, s.

    Returns
    -------
    lowest, highest : float
        Found by local optimisation from the optima, s: an inner estimate of the range. The
        highest value goes through every assignment of segments to the joints that set them.
    """
    caps = [float(h.sum()) + slack for h in optima]
    given = float(np.max(optima, axis=0).sum())
    least = _moved(problems, optima, caps, None)
    lowest = given
    if all(h.sum() <= cap * (1 + 1e-8) for h, cap in zip(least, caps, strict=True)):
        lowest = min(given, float(np.max(least, axis=0).sum()))
    n = problems[0].segments
    subsets = [
        subset for size in range(1, n + 1) for subset in itertools.combinations(range(n), size)
    ]
    reach: dict[tuple[int, tuple[int, ...]], float] = {}
    for j, (problem, optimum, cap) in enumerate(zip(problems, optima, caps, strict=True)):
        for subset in subsets:
            chosen = list(subset)
            reach[j, subset] = float(optimum[chosen].sum())
            if len(subset) == n:
                reach[j, subset] = cap
                continue
            weights = np.zeros(n)
            weights[chosen] = -1.0
            h = _moved([problem], [optimum], [cap], weights)[0]
            if h.sum() <= cap * (1 + 1e-8):
                reach[j, subset] = max(reach[j, subset], float(h[chosen].sum()))
    return lowest, max(given, _best_assignment(reach, len(problems), n))


def _best_assignment(
    reach: dict[tuple[int, tuple[int, ...]], float], joints: int, segments: int
) -> float:
    """Largest total over all ways to give each segment to one joint (dynamic programme)."""
    best: dict[tuple[int, ...], float] = {(): 0.0}
    for j in range(joints):
        extended = dict(best)
        for done, total in best.items():
            left = [k for k in range(segments) if k not in done]
            for size in range(1, len(left) + 1):
                for subset in itertools.combinations(left, size):
                    key = tuple(sorted(done + subset))
                    value = total + reach[j, subset]
                    extended[key] = max(extended.get(key, -np.inf), value)
        best = extended
    return best[tuple(range(segments))]
