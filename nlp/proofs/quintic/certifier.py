"""Certified interval of the least total of a C4 quintic spline, by stages of rising totals."""

from __future__ import annotations

import math
import time
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ....problem import Interpolant, Problem, TrajgapError, Verdict, check, evaluate
from ....verify import MOST_POWER, MOST_QUINTIC_JOINTS, MOST_QUINTIC_SEGMENTS, SMALLEST
from ...optimum import solve
from ..answer import float_problem, prove_feasible
from ..exact import ExactProblem, decimal
from ..outcome import Certified, Certifier, Given, Outcome, Progress, Request
from .leaves import Leaves
from .search import DONE, FULL, PAUSED, SHORTER, search
from .windows import Windows, windows

Array = NDArray[np.float64]

_STAGES = (0.3, 0.2, 0.1, 0.05, *(x * 10.0**-k for k in range(2, 7) for x in (2.0, 1.0, 0.5)))
_SAFE = 0.9
_UNIT = 2**30
_CHUNK = 500
_STACK = 600
_SLIGHT = 1e-7
_WORTH = 1.5
_NEAR = 8
"""Powers of two by which a size may differ from 1 before the units are changed."""
_REST = ((1, 0.0), (2, 0.0))


@dataclass(frozen=True)
class Units:
    """Joint j is measured in 2**powers[j] of the problem's unit of angle, time in 2**second s."""

    powers: tuple[int, ...]
    second: int

    @property
    def time(self) -> Fraction:
        """In s."""
        return Fraction(2) ** self.second


@dataclass(frozen=True, eq=False)
class Tree:
    """Bisections of the simplex of durations that prove a total; both in the units of the proof."""

    units: Units
    total: Fraction
    low: tuple[Fraction, ...]
    windows: Windows
    leaves: Leaves

    def document(self) -> dict[str, Any]:
        """Kind "quintic-spline" of docs/certificates-quintic.md."""
        return {
            "kind": "quintic-spline",
            "total": decimal(self.total * self.units.time),
            "powers": list(self.units.powers),
            "second": self.units.second,
            "low": [decimal(x * self.units.time) for x in self.low],
            **self.leaves.document(self.windows),
        }


class _Shorter(Exception):
    """Durations whose total is below the target."""

    def __init__(self, durations: Array) -> None:
        self.durations = durations


class _Stop(Exception):
    """Time is up, or boxes are as small as they may get."""


def _declares(problem: ExactProblem) -> bool:
    curve = problem.curve
    return (
        isinstance(curve, Interpolant)
        and curve.segments > 1
        and set(curve.degrees) == {5}
        and set(curve.continuity) == {4}
        and not curve.virtual
    )


def _missing(problem: ExactProblem) -> str | None:
    inner = ((),) * (problem.segments - 1)
    if problem.piecewise.prescribed != (_REST, *inner, _REST):
        return f"{problem.curve.name}: only rest with zero acceleration at both ends is covered"
    if problem.segments > MOST_QUINTIC_SEGMENTS or len(problem.joints) > MOST_QUINTIC_JOINTS:
        return f"more than {MOST_QUINTIC_SEGMENTS} segments or {MOST_QUINTIC_JOINTS} joints"
    units = _units(problem)
    own = problem.in_units(units.powers, units.second)
    q = own.waypoints
    sizes = [abs(b - a) for k in range(len(q) - 1) for a, b in zip(q[k], q[k + 1], strict=True)]
    sizes += [x.high for row in own.limits for x in row if x is not None]
    if not all(x == 0 or SMALLEST < x < 1 / SMALLEST for x in sizes):
        return "a step or a limit is of unusual size"
    if all(problem.duration_lower):
        return None
    if not np.isfinite(_limits(problem)).any() and not any(problem.duration_lower):
        return "nothing limits the total from below"
    moving = np.asarray(_steps(problem).any(axis=0), dtype=np.bool_)
    if not (np.isfinite(_limits(problem)[:, :2]) & moving[:, None]).any():
        return "no joint that moves has a velocity or acceleration limit"
    return None


def _limits(problem: ExactProblem) -> Array:
    """Looser ends of the limits, shape (joints, 3); a limit of 0 takes no part."""
    limits = problem.derivative_limits()
    return np.asarray(np.where(limits > 0.0, limits, np.inf), dtype=np.float64)


def _steps(problem: ExactProblem) -> Array:
    q = problem.waypoints
    return np.array(
        [[float(b - a) for a, b in zip(q[k], q[k + 1], strict=True)] for k in range(len(q) - 1)]
    )


def _below(value: Fraction) -> Fraction:
    """A float not above, few digits behind the point."""
    whole = value * _UNIT
    return Fraction(whole.numerator // whole.denominator, _UNIT)


def shortest(problem: ExactProblem) -> tuple[Fraction, ...]:
    """Least durations by their bounds and by the mean velocities, as floats."""
    q, out = problem.waypoints, []
    for k, low in enumerate(problem.duration_lower):
        for j, (velocity, *_) in enumerate(problem.limits):
            if velocity is not None and velocity.high > 0:
                low = max(low, abs(q[k + 1][j] - q[k][j]) / velocity.high)
        out.append(_below(low))
    return tuple(out)


@dataclass(eq=False)
class _Run:
    """Everything here is in the units of the proof."""

    problem: ExactProblem
    units: Units
    request: Request
    began: float
    answer: tuple[Fraction, ...] | None = None
    lower: Fraction = Fraction(0)
    proof: Tree | Given | None = None
    nodes: int = 0
    open_boxes: int = 0

    def __post_init__(self) -> None:
        self.floats = float_problem(self.problem)
        self.deadline = self.began + self.request.seconds
        self.low = shortest(self.problem)
        self.steps, self.limits = _steps(self.problem), _limits(self.problem)

    @property
    def upper(self) -> Fraction | None:
        """Total of the answer."""
        return None if self.answer is None else sum(self.answer, Fraction(0))

    def stage(self, target: Fraction, library: Windows) -> Tree:
        """Prove that no total is below ``target``."""
        if time.perf_counter() > self.deadline:
            raise _Stop
        n, joints = self.steps.shape
        total = float(target)
        low, high = np.zeros((_STACK, n)), np.zeros((_STACK, n))
        low[0], high[0] = [float(x) for x in self.low], total
        depth, counts = np.array([1]), np.zeros(3, np.int64)
        leaves, wary, patience = Leaves.empty(), True, _CHUNK
        upper = 0.0 if self.upper is None else float(self.upper) * (1.0 - _SLIGHT)
        while True:
            code = search(
                n, joints, self.steps, self.limits, total, library.terms, low, high, depth,
                patience, upper if wary and patience > 1 else 0.0, *leaves.arrays, counts,
            )  # fmt: skip
            self.nodes += int(counts[0])
            counts[:] = 0
            self.open_boxes = int(depth[0])
            self._tell()
            if code == DONE:
                return Tree(self.units, target, self.low, library, leaves)
            if code == FULL:
                leaves = leaves.larger()
            patience = 1 if code == SHORTER else _CHUNK
            if code == SHORTER:
                at = depth[0] - 1
                wary = self._improve(2.0 / (1.0 / low[at] + 1.0 / high[at]), upper)
            elif code not in (DONE, FULL, PAUSED) or time.perf_counter() > self.deadline:
                raise _Stop

    def _improve(self, durations: Array, upper: float) -> bool:
        """Raise `_Shorter` if the direction of ``durations`` holds a total below ``upper``.

        False if it does but for bounds that stretching cannot mend: more would follow.
        """
        stretch = float(evaluate(self.floats, durations[None]).stretch[0])
        stretch = max(stretch, float((self.floats.duration_lower / durations).max()))
        found = durations * stretch
        if not found.sum() < upper:
            return True
        if check(self.floats, found).verdict is Verdict.PASS:
            raise _Shorter(found)
        return False

    def _tell(self) -> None:
        if self.request.report is None:
            return
        seconds = time.perf_counter() - self.began
        upper = float("inf") if self.upper is None else float(self.upper)
        gap = 1.0 - float(self.lower) / upper if np.isfinite(upper) else float("inf")
        rate, time_ = self.nodes / max(seconds, 1e-9), float(self.units.time)
        lower = float(self.lower) * time_
        self.request.report(Progress(lower, upper * time_, gap, self.open_boxes, self.nodes, rate))


def _certify(exact: ExactProblem, request: Request) -> Certified:
    began, units = time.perf_counter(), _units(exact)
    own = exact.in_units(units.powers, units.second)
    run = _Run(own, units, request, began)
    if request.resume is not None:
        run.answer, run.proof = _over(request.resume.durations, units.time), request.resume.proof
        run.lower = request.resume.lower / units.time
    stopped = True
    try:
        run.answer = _shorter_of(run.answer, _answer(run.floats, own, request.seed, None))
        stopped = run.answer is None or not _raise_lower(run)
    except (KeyboardInterrupt, _Stop):
        pass
    upper = run.upper
    if upper is not None and upper < run.lower:
        raise TrajgapError("certify: the proof contradicts the answer, one of them is wrong")
    if upper is None:
        outcome = Outcome.OPEN
    elif not stopped and upper - run.lower <= upper * Fraction(request.gap):
        outcome = Outcome.CERTIFIED
    else:
        outcome = Outcome.INTERVAL
    return Certified(
        exact,
        outcome,
        run.lower * units.time,
        None if upper is None else upper * units.time,
        _over(run.answer, 1 / units.time),
        run.nodes,
        run.open_boxes if stopped else 0,
        time.perf_counter() - run.began,
        run.proof,
        outcome is not Outcome.CERTIFIED,
    )


def _over(durations: tuple[Fraction, ...] | None, unit: Fraction) -> tuple[Fraction, ...] | None:
    return None if durations is None else tuple(h / unit for h in durations)


def _units(exact: ExactProblem) -> Units:
    """Units in which steps and total are not far from 1; those of the problem where they are not.

    Weights, multipliers and totals of a proof have ranges, which these units keep to.
    """
    steps, limits = np.abs(_steps(exact)), _limits(exact)
    powers = [_power(float(column.max())) for column in steps.T]
    least = np.array([float(x) for x in exact.duration_lower])
    with np.errstate(divide="ignore"):
        for order in (1, 2, 3):
            needs = (steps / limits[:, order - 1]) ** (1.0 / order)
            least = np.maximum(least, needs.max(axis=1))
    return Units(tuple(powers), _power(float(least.sum())))


def _power(size: float) -> int:
    """Of two, for a size far from 1; else 0."""
    power = math.frexp(size)[1] if size > 0.0 else 0
    return 0 if abs(power) <= _NEAR else max(-MOST_POWER, min(MOST_POWER, power))


def _raise_lower(run: _Run) -> bool:
    """Prove one target after the other; False if an improvement is too slight to prove."""
    assert run.answer is not None
    library = windows(run.steps, run.limits, np.array([float(h) for h in run.answer]))
    while True:
        assert run.upper is not None
        upper, last = run.upper, _SAFE * run.request.gap
        gaps = [*(g for g in _STAGES if g > _WORTH * last), last]
        targets = [_below(upper * (1 - Fraction(g))) for g in gaps]
        try:
            for target in targets:
                if target > run.lower:
                    run.proof = run.stage(target, library)
                    run.lower = target
            return True
        except _Shorter as found:
            better = _answer(run.floats, run.problem, run.request.seed, found.durations)
            if better is None or sum(better) >= upper:
                return False
            run.answer = better


def _answer(
    floats: Problem, exact: ExactProblem, seed: int, initial: Array | None
) -> tuple[Fraction, ...] | None:
    """Feasible durations of the local solver, or else the ones it started from."""
    solution = solve(floats, seed=seed, initial=initial)
    tries = [h for h in (solution.durations, initial) if h is not None]
    found = [h for h in (prove_feasible(exact, h) for h in tries) if h is not None]
    return min(found, key=sum, default=None)


def _shorter_of(
    one: tuple[Fraction, ...] | None, other: tuple[Fraction, ...] | None
) -> tuple[Fraction, ...] | None:
    return min([h for h in (one, other) if h is not None], key=sum, default=None)


QUINTIC = Certifier("C4 quintic splines at rest at the ends", _declares, _missing, _certify)
