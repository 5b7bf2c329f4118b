"""Shortest motion near a start: quadratic steps in log durations on the exact extrema.

No barrier, no sampled places: every limit is linearised at its true extrema, the step is the least
point of a small quadratic program, and each accepted motion keeps every limit. It stays sharp
where durations differ by many powers of ten, because logarithms do not see the difference.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from ...problem import Array, Problem
from ..clock import time_up
from .limit_rows import ExactRows, exact_rows
from .starts import LogBox

STEPS = 80
"""Most steps of one descent; with a superlinear end 10 to 30 suffice."""
RESTORING_STEPS = 30
"""Most steps towards the limits from a start that exceeds them."""
KEPT = 1e-12
"""Excess that counts as kept: a thousandth of the checker's tolerance."""
WIDEST_STEP = 1.0
"""Trust region at the start, in log durations: a factor e."""
SMALLEST_STEP = 1e-10
"""Trust region at which a descent ends; the total is then settled to its square."""
GAIN = 1e-13
"""Relative gain below which a descent ends: rounding of the total."""
SLOW, PATIENCE = 1e-9, 6
"""A descent that gains less than this (relative) in so many steps creeps. It continues with a new
Hessian, and ends if it has gained no more since the last one."""
GOOD = 0.5
"""Share of the expected gain from which the trust region grows."""
PULL = 1e-3
"""Weight that keeps a step of restoration short; small beside the excess, whose weight is 1."""


def least_point(
    hessian: Array, slope: Array, rows: Array, room: Array
) -> tuple[Array, Array] | None:
    """Least ½dᵀHd + gᵀd with Ad ≤ b, and the multipliers; None if no d keeps the rows.

    None too where rounding has left H without a Cholesky factor, and where a number is not finite,
    as that of a row is at durations that define no curve.

    With H = LLᵀ, y = Lᵀd + L⁻¹g makes it the shortest y with Gy ≥ w, G = −AL⁻ᵀ, w = −b − AH⁻¹g,
    which non-negative least squares solve (Lawson and Hanson, Solving Least Squares Problems,
    chapter 23): of u ≥ 0 with least |[Gᵀ; wᵀ]u − e|, e the last unit vector, the residual ρ gives
    y = −ρ_{1..n}/ρ_{n+1}, and −u/ρ_{n+1} are the multipliers.
    """
    from scipy.linalg.lapack import dpotrf, dtrtri  # a quarter of a second, and few need it
    from scipy.optimize import nnls

    # Programs are so small that `cholesky` costs more than what it calls. A triangular solve with
    # several right-hand sides starts threads, which take a hundred times as long.
    lower, failed = dpotrf(hessian, lower=1)
    if failed:
        return None
    inverse, _ = dtrtri(lower, lower=1)
    shift, turned = inverse @ slope, rows @ inverse.T
    facing, needed = -turned, -room - turned @ shift
    stacked = np.vstack([facing.T, needed])
    if not np.isfinite(stacked).all():
        return None
    target = np.zeros(len(stacked))
    target[-1] = 1.0
    try:
        weights, _ = nnls(stacked, target, maxiter=20 * stacked.shape[1] + 100)
    except RuntimeError:
        return None
    residual = stacked @ weights - target
    if not residual[-1] < -1e-14:
        return None
    y = -residual[:-1] / residual[-1]
    step = inverse.T @ (y - shift)
    # Rows that all but contradict each other give a point far beyond them.
    if not (turned @ y - room - turned @ shift <= 1e-6 * (1.0 + np.abs(room))).all():
        return None
    return step, -weights / residual[-1]


def _walled(rows: ExactRows, box: LogBox, radius: float) -> tuple[Array, Array]:
    """Rows and their room, with the walls of the box and of the trust region."""
    z = np.log(rows.durations)
    one = np.eye(z.size)
    up = np.minimum(box.high - z, radius)
    down = np.minimum(z - box.low, radius)
    matrix = np.vstack([rows.gradient, one, -one])
    return matrix, np.concatenate([-rows.excess, np.maximum(up, 0.0), np.maximum(down, 0.0)])


def restored(problem: Problem, h: Array, box: LogBox) -> ExactRows:
    """Limits at a vector of the box with the least excess that is found near ``h``.

    Each step minimises ½(t + 1)² + ½ρ|d|² over steps d and excesses t, every linearised limit at
    most t: far from the limits it lowers the worst one, near them it goes a little further in.
    """
    rows = exact_rows(problem, np.exp(box.inside(np.log(h))))
    radius, n = WIDEST_STEP, h.size
    for _ in range(RESTORING_STEPS):
        if time_up() or rows.worst <= KEPT or not np.isfinite(rows.worst) or radius < SMALLEST_STEP:
            break
        matrix, room = _walled(rows, box, radius)
        elastic = np.zeros((len(matrix), 1))
        elastic[: len(rows.excess)] = -1.0
        weights = np.append(np.full(n, PULL), 1.0)
        slope = np.append(np.zeros(n), 1.0)
        found = least_point(np.diag(weights), slope, np.hstack([matrix, elastic]), room)
        if found is None:
            break
        z = box.inside(np.log(rows.durations) + found[0][:n])
        trial = exact_rows(problem, np.exp(z))
        expected = rows.worst - max(float(found[0][n]), 0.0)
        if trial.worst <= KEPT or trial.worst < rows.worst - 0.1 * expected:
            rows, radius = trial, min(2.0 * radius, 4.0)
        elif trial.worst < rows.worst:
            rows, radius = trial, 0.5 * radius
        else:
            radius = 0.25 * min(radius, float(np.abs(found[0][:n]).max()) or radius)
    return rows


def _onto_limits(problem: Problem, h: Array, box: LogBox) -> ExactRows:
    """The nearest vector at the limits: by a uniform stretch where the box allows it, else Newton.

    A stretch leaves the path and its positions as they are.
    """
    rows = exact_rows(problem, np.exp(box.inside(np.log(h))))
    for _ in range(5):
        if not np.isfinite(rows.worst):
            break
        z = np.log(rows.durations)
        stretch = float(rows.excess[rows.stretched].max(initial=-np.inf))
        outside = rows.excess[~rows.stretched].max(initial=-np.inf) > KEPT
        free = np.isfinite(stretch) and not outside and problem.curve.homogeneous
        if rows.worst <= KEPT:
            if not (free and stretch < -KEPT and (z + stretch >= box.low).all()):
                break
            return exact_rows(problem, np.exp(z + stretch))
        if free and (z + stretch <= box.high).all():
            return rows.longer(stretch)
        matrix, room = _walled(rows, box, WIDEST_STEP)
        found = least_point(np.eye(z.size), np.zeros(z.size), matrix, room)
        if found is None:
            break
        trial = exact_rows(problem, np.exp(box.inside(z + found[0])))
        if not trial.worst < rows.worst:
            break
        rows = trial
    return rows


@dataclass(frozen=True, eq=False)
class Descent:
    """Where a descent ended: durations, s, and the excess, at most `KEPT` if limits are kept.

    It is converged where no step gained any more.
    """

    durations: Array
    excess: float
    converged: bool
    steps: int

    @property
    def feasible(self) -> bool:
        """Whether every limit is kept."""
        return self.excess <= KEPT


def descend(
    problem: Problem, start: Array, box: LogBox, ends: Iterable[Descent] = (), near: float = 0.0
) -> Descent:
    """Shorten a motion within its limits until no step gains.

    The curve is a determined one of any kind; the start, s, need not keep the limits. If a motion
    comes within ``near`` of an earlier end in log durations and is no shorter, it ends there.
    """
    rows = _onto_limits(problem, start, box)
    if rows.worst > KEPT:
        rows = restored(problem, rows.durations, box)
    if rows.worst > KEPT:
        return Descent(rows.durations, rows.worst, False, 0)
    total = float(rows.durations.sum())
    hessian, began = _first_hessian(rows), total
    radius, taken, history = WIDEST_STEP, 0, [total]
    for taken in range(1, STEPS + 1):
        if time_up():
            break
        for end in ends:
            away = np.abs(np.log(end.durations / rows.durations)).max()
            if away <= near and end.durations.sum() <= total:
                return end
        slope = rows.durations / total
        matrix, room = _walled(rows, box, radius)
        found = least_point(hessian, slope, matrix, np.maximum(room, 0.0))
        creeps = len(history) > PATIENCE and history[-1 - PATIENCE] < total * (1.0 + SLOW)
        if found is None or creeps:
            if began < total * (1.0 + SLOW):
                break
            # Made along a bent valley, the Hessian may fit no longer.
            hessian, radius, began, history = _first_hessian(rows), WIDEST_STEP, total, [total]
            continue
        step, weights = found
        size = float(np.abs(step).max())
        expected = -float(slope @ step)
        if not expected > GAIN or size < SMALLEST_STEP:
            return Descent(rows.durations, rows.worst, True, taken)
        trial = _onto_limits(problem, np.exp(np.log(rows.durations) + step), box)
        if not _gain(total, trial) > GOOD * expected:
            # Limits bend: a second step from beyond them follows the valley, a stretch leaves it.
            beyond = exact_rows(problem, np.exp(box.inside(np.log(rows.durations) + step)))
            matrix, room = _walled(beyond, box, size)
            bent = least_point(hessian, beyond.durations / total, matrix, room)
            if bent is not None:
                other = _onto_limits(problem, np.exp(np.log(beyond.durations) + bent[0]), box)
                trial = max(trial, other, key=lambda one: _gain(total, one))
        after = float(trial.durations.sum())
        if trial.worst <= KEPT and after < total * (1.0 - 1e-15):
            hessian = _curved(hessian, rows, trial, weights[: len(rows.excess)])
            good = _gain(total, trial) > GOOD * expected
            radius = min(2.0 * radius, WIDEST_STEP) if good else 0.5 * max(size, 0.5 * radius)
            rows, total = trial, after
            history.append(total)
        else:
            radius = 0.25 * min(radius, size)
            if radius < SMALLEST_STEP:
                return Descent(rows.durations, rows.worst, True, taken)
    return Descent(rows.durations, rows.worst, False, taken)


def _first_hessian(rows: ExactRows) -> Array:
    """That of the total in log durations, over the total, and a little more."""
    return np.diag(rows.durations / rows.durations.sum() + 1e-4)


def _gain(total: float, rows: ExactRows) -> float:
    """Relative gain of a motion over a total; -inf if it exceeds a limit."""
    return 1.0 - float(rows.durations.sum()) / total if rows.worst <= KEPT else -np.inf


def _curved(hessian: Array, before: ExactRows, after: ExactRows, weights: Array) -> Array:
    """The damped BFGS update (Powell 1978) of the Lagrangian's Hessian; extrema are matched."""
    step = np.log(after.durations / before.durations)
    total = float(before.durations.sum())
    change = (after.durations - before.durations) / total
    for i in np.flatnonzero(weights > 0):
        twin = after.twin(before, int(i))
        if twin is None:
            return hessian
        change += weights[i] * (after.gradient[twin] - before.gradient[i])
    image = hessian @ step
    bend = float(step @ image)
    if not bend > 0.0:
        return hessian
    along = float(step @ change)
    share = 1.0 if along >= 0.2 * bend else 0.8 * bend / (bend - along)
    mixed = share * change + (1.0 - share) * image
    updated = hessian - np.outer(image, image) / bend + np.outer(mixed, mixed) / float(step @ mixed)
    bends = np.linalg.eigvalsh(updated)
    return np.asarray(updated) if bends[0] > 1e-10 * bends[-1] else hessian
