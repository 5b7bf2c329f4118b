"""How far the durations of each joint can vary while its total stays within a given slack."""

from __future__ import annotations

import itertools

import numpy as np

from ...problem import Array, Problem, check, fit
from .program import Program
from .rounds import OPTIONS as OPTIONS_OF_ROUNDS
from .rows import NEAR, near_rows
from .symbolic import ca

ROUNDS = 12
"""Rounds from one optimum: a bound against endless shrinking of the region; two to four suffice."""
REGION = 0.05
"""Share by which a first round may change a duration: near an optimum the extrema hardly move."""
LEFT = 1e-8
"""Relative change of the durations at which the rounds end."""
OPTIONS = OPTIONS_OF_ROUNDS | {"ipopt.mu_init": 1e-4, "ipopt.tol": 1e-9}
"""Options of IPOPT, begun near a solution: with a small barrier."""


class Nearby:
    """One objective over the durations of some joints, each within its cap, by rounds of the NLP.

    Without weights it is the sum over segments of the longest duration; with weights that of the
    one joint's weighted durations.
    """

    def __init__(self, problems: list[Problem], unit: float, caps: list[float]) -> None:
        self._problems, self._unit, self._caps = problems, unit, np.array(caps) / unit
        none = np.zeros(problems[0].segments)
        self._programs = [Program(problem, unit, none) for problem in problems]

    def reached(self, starts: list[Array], weights: Array | None) -> list[Array]:
        """Durations of each joint at which the objective is least near the starts, s."""
        h, radius = [start.copy() for start in starts], REGION
        for _ in range(ROUNDS):
            new = self._round(h, radius, weights)
            moved = max(float(np.abs(a / b - 1).max()) for a, b in zip(new, h, strict=True))
            if all(
                check(q, d).stretch <= 1 + 1e-4 * radius
                for q, d in zip(self._problems, new, strict=True)
            ):
                h = new
                if moved < LEFT:
                    break
            else:
                radius *= 0.25
        return h

    def _round(self, h: list[Array], radius: float, weights: Array | None) -> list[Array]:
        n = self._problems[0].segments
        top = ca.MX.sym("longest", n)
        variables, given, low, high = [top], [np.max(h, axis=0) / self._unit], [], []
        expressions, least, most = [], [], []
        for program, own, cap in zip(self._programs, h, self._caps, strict=True):
            motion = fit(program.problem.curve, program.problem.waypoints, own)
            rows, ends = near_rows(program, motion, NEAR), program.ends
            x = program.pack(motion, own)
            bounds = program.bounds()
            low.append(
                np.maximum(bounds[0], np.where(np.arange(x.size) < n, x * (1 - radius), -np.inf))
            )
            high.append(
                np.minimum(bounds[1], np.where(np.arange(x.size) < n, x * (1 + radius), np.inf))
            )
            variables.append(program.variables)
            given.append(x)
            room, upper = program.rooms(rows.places, rows.sign), rows.sign > 0
            expressions += [
                program.equalities,
                program.at_places(ends, np.zeros(ends.s.size)),
                program.at_places(rows.places, rows.weight),
                ca.sum1(program.durations),
                program.durations - top,
            ]
            zero = np.zeros(program.equalities.numel())
            edges = [program.rooms(ends, np.full(ends.s.size, sign)) for sign in (-1.0, 1.0)]
            none = np.full(n, -np.inf)
            least += [zero, edges[0], np.where(upper, -np.inf, room), [0.0], none]
            most += [zero, edges[1], np.where(upper, room, np.inf), [cap], np.zeros(n)]
        first = self._programs[0].durations
        objective = ca.sum1(top) if weights is None else ca.dot(ca.DM(weights), first)
        free = np.full(n, np.inf)
        held = free if weights is None else np.full(n, 10.0 * given[0].max())
        nlp = {"x": ca.vertcat(*variables), "f": objective, "g": ca.vertcat(*expressions)}
        result = ca.nlpsol("near", "ipopt", nlp, OPTIONS)(
            x0=np.concatenate([given[0] if weights is None else held, *given[1:]]),
            lbx=np.concatenate([np.zeros(n) if weights is None else held, *low]),
            ubx=np.concatenate([held, *high]),
            lbg=np.concatenate(least),
            ubg=np.concatenate(most),
        )
        answer, at, found = np.asarray(result["x"]).ravel(), n, []
        for program in self._programs:
            own = answer[at : at + n] * self._unit
            problem = program.problem
            found.append(np.clip(own, problem.duration_lower, problem.duration_upper))
            at += program.variables.numel()
        return found


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
    unit = float(np.mean([h.mean() for h in optima]))
    least = [
        _kept(problem, h)
        for problem, h in zip(
            problems, Nearby(problems, unit, caps).reached(optima, None), strict=True
        )
    ]
    lowest = given
    if all(h.sum() <= cap * (1 + 1e-8) for h, cap in zip(least, caps, strict=True)):
        lowest = min(given, float(np.max(least, axis=0).sum()))
    n = problems[0].segments
    subsets = [
        subset for size in range(1, n + 1) for subset in itertools.combinations(range(n), size)
    ]
    reach: dict[tuple[int, tuple[int, ...]], float] = {}
    for j, (problem, optimum, cap) in enumerate(zip(problems, optima, caps, strict=True)):
        alone = Nearby([problem], unit, [cap])
        for subset in subsets:
            chosen = list(subset)
            reach[j, subset] = float(optimum[chosen].sum())
            if len(subset) == n:
                reach[j, subset] = cap
                continue
            weights = np.zeros(n)
            weights[chosen] = -1.0
            h = _kept(problem, alone.reached([optimum], weights)[0])
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
