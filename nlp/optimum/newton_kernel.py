"""Compiled: Newton descents on the exact limits, with two derivatives in log durations.

Everything for one problem happens in one call: the curve, every true extremum, the gradients, the
curvature of the Lagrangian by implicit differentiation, a small quadratic program, and a trust
region.
"""

from __future__ import annotations

import math

import numpy as np

from .newton_curve import NEAR, add_curvature, compiled, curve_at, rows_at
from .newton_program import filled, inverted, least_step

KEPT = 1e-12
"""Excess that counts as kept: a thousandth of the checker's tolerance."""
STEPS = 60
"""Most steps of one descent; with exact curvature six to twelve suffice."""
SETTLED = 1e-9
"""Step in log durations at which a descent ends: the next one would be its square."""
AGAIN, SAME = 0.01, 1e-6
"""Log durations, and log of the total, within which a descent has reached a known end."""
HEAVIEST = 1e7
"""Largest weight of the worst excess; where it still pays to exceed a limit, no motion is near."""
CONVERGED, STALLED, ABANDONED = 1, 0, 2
"""How a descent ends: at a least total, anywhere else, or on its way to a known end."""


@compiled
def _shares(z, slope):  # type: ignore[no-untyped-def]
    """Log of the total, and each duration's share of it."""
    top, total = -np.inf, 0.0
    for k in range(z.size):
        top = max(top, z[k])
    for k in range(z.size):
        slope[k] = math.exp(z[k] - top)
        total += slope[k]
    for k in range(z.size):
        slope[k] /= total
    return top + math.log(total)


@compiled
def _known(z, length, ends, found, count):  # type: ignore[no-untyped-def]
    """Whether an earlier descent has converged near a place, with the same total."""
    for i in range(count):
        if found[i, 0] == CONVERGED and length - found[i, 3] < SAME:
            away = 0.0
            for k in range(z.size):
                away = max(away, abs(z[k] - ends[i, k]))
            if away < AGAIN:
                return True
    return False


@compiled
def descents(  # type: ignore[no-untyped-def]
    starts, begin, stop, steps, low, high, values, kinds, breaks, orders, degrees, column, smooth,
    inverse_limits, ranges, span, perm, current, fresh, system, right, work, rows, room, weights,
    square, line, active, ends, found,
):  # fmt: skip
    """Descend from ``starts[begin:stop]`` (log durations) to ``ends``, in at most ``steps``.

    An end that is known from an earlier start, one before ``begin`` too, is not gone to again.

    ``found[i]`` receives how it ended, the largest excess, the number of steps, and the log of the
    total. The exact penalty log Σh + ρ·max(0, excess) is lowered in a trust region (Fletcher's
    Sl∞QP); a step that gains too little is followed by a second one from beyond the limits. With 0
    steps the starts are only stretched to the limits. The arrays from ``current`` on are room.
    """
    n = degrees.size
    size = n + 1
    hessian, bent, factor, solved, image = square[0], square[1], square[2], square[3], square[4]
    gram, curved = square[5:7].reshape(size, 2 * size), square[7]
    slope, step, second, held, turned = line[0], line[1], line[2], line[3], line[4]
    dual, move, z, trial, first = line[5], line[6], line[7, :n], line[8, :n], line[9, :n]
    moving, other, adjoint, own = line[10, :n], line[11, :n], work[13], work[14]
    searching = steps > 0
    for start in range(begin, stop):
        for k in range(n):
            trial[k] = starts[start, k]
        found[start, 0], found[start, 1], found[start, 2] = STALLED, np.inf, 0.0
        found[start, 3] = np.inf
        heavy, radius, settled, phase, taken = 10.0, 1.0, False, 0, 0
        reach, gain, merit, best, length, worst, over, count = 1.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0
        while True:
            # Look at the place to try.
            for k in range(n):
                trial[k] = min(max(trial[k], low[k]), high[k])
                other[k] = trial[k]
            x, slopes, inverse, excess, gradient, s_of, place = fresh
            regular = curve_at(
                trial, values, kinds, breaks, orders, degrees, column, perm, inverse, x, slopes,
                searching, system, right,
            )  # fmt: skip
            if not regular and phase == 0:
                break
            count_new, beyond, outside = 0, np.inf, np.inf
            if regular:
                count_new, beyond, outside = rows_at(
                    trial, degrees, smooth, inverse_limits, ranges, span, perm, x, slopes,
                    searching, excess, gradient, place, s_of, NEAR if searching else 0.0, work,
                )  # fmt: skip
            if phase == 1 and regular:  # what a second step starts from, before any stretch
                full = filled(trial, low, high, reach, count_new, excess, gradient, rows, room)
                _shares(trial, slope)
                slope[n] = heavy
            # Stretch all durations alike to the limits: that moves no coefficient.
            if regular and abs(beyond) < np.inf:
                stretch = beyond
                for k in range(n):
                    stretch = max(min(stretch, high[k] - trial[k]), low[k] - trial[k])
                for k in range(n):
                    trial[k] += stretch
                for i in range(count_new):
                    if place[i, 1] > 0:
                        excess[i] -= stretch
                beyond -= stretch
            beyond = max(beyond, outside)
            length_new = _shares(trial, dual)
            after = length_new + heavy * max(0.0, beyond) if regular else np.inf
            if phase == 0 or (after < best and after < merit + 1e-15 * max(1.0, abs(merit))):
                best, length, worst, count = after, length_new, beyond, count_new
                over = max(0.0, worst)
                for k in range(n):
                    z[k] = trial[k]
                current, fresh = fresh, current
            if phase == 0:
                for i in range(size):
                    for m in range(size):
                        hessian[i, m] = 0.0
                    hessian[i, i] = dual[i] + 0.05 if i < n else 1.0
                best = np.inf
            elif (
                phase == 1 and not merit - best > 0.4 * gain and reach >= 1e-6 and regular
                and least_step(
                    solved, slope, rows, room, full, second, weights,
                    active, held, image, turned, gram, dual, move,
                )
            ):  # fmt: skip
                for k in range(n):
                    trial[k] = other[k] + second[k]
                phase = 2
                continue
            if phase > 0:
                if best == np.inf:
                    radius = 0.25 * min(radius, reach)
                elif merit - best > 0.4 * gain:
                    radius = min(1.0, max(radius, 2.0 * reach))
                elif merit - best < 0.1 * gain:
                    radius = max(1e-10, 0.5 * reach)
                settled = reach < SETTLED and over <= KEPT
                if settled or radius < 1e-11 or taken >= steps:
                    break
                if over <= KEPT and _known(z, length, ends, found, start):
                    break
            if taken >= steps:
                break
            # The next step: a first program for the multipliers, a second one with their curvature.
            x, slopes, inverse, excess, gradient, s_of, place = current
            ready = False
            while taken < steps:
                taken += 1
                _shares(z, slope)
                slope[n] = heavy
                full = filled(z, low, high, radius, count, excess, gradient, rows, room)
                for turn in range(2):
                    shift = 0.0
                    ready = False
                    if turn == 1:
                        for i in range(size):
                            for m in range(size):
                                bent[i, m] = 0.0
                        for k in range(n):
                            bent[k, k] = slope[k]
                            for m in range(n):
                                bent[k, m] -= slope[k] * slope[m]
                        bent[n, n] = 1.0
                        for i in range(count):
                            if weights[i] > 1e-12:
                                add_curvature(
                                    z, place[i, 0], place[i, 1], place[i, 2], place[i, 3],
                                    place[i, 4], s_of[i], weights[i], values, kinds, breaks,
                                    orders, degrees, column, perm, span, inverse, x, slopes, bent,
                                    adjoint, own, first, moving, curved,
                                )  # fmt: skip
                                # On rows that stay active this changes the multipliers alone.
                                for k in range(n):
                                    for m in range(n):
                                        bent[k, m] += 2.0 * gradient[i, k] * gradient[i, m]
                    for _ in range(30):
                        if turn == 1:
                            for i in range(size):
                                for m in range(size):
                                    hessian[i, m] = bent[i, m]
                                hessian[i, i] += shift if i < n else 0.0
                        if inverted(hessian, factor, solved):
                            ready = True
                            break
                        shift = max(1e-3, 4.0 * shift)
                    ready = ready and least_step(
                        solved, slope, rows, room, full, step, weights,
                        active, held, image, turned, gram, dual, move,
                    )  # fmt: skip
                    if not ready:
                        break
                if not ready:
                    break
                left = max(0.0, step[n])
                if not (left > 1e-10 and left > 0.9 * over and heavy < HEAVIEST):
                    break
                heavy *= 10.0  # the weight is too small for the limits, here at least
            if not ready:
                break
            reach, gain = 0.0, heavy * (over - max(0.0, step[n]))
            for k in range(n):
                reach = max(reach, abs(step[k]))
                gain -= slope[k] * step[k]
                trial[k] = z[k] + step[k]
            if not gain > 1e-15 or reach < 1e-13:
                settled = over <= KEPT
                break
            merit, best, phase = length + heavy * over, np.inf, 1
        if phase == 0 and best == 0.0:
            continue
        for k in range(n):
            ends[start, k] = z[k]
        near = not settled and searching and over <= KEPT and _known(z, length, ends, found, start)
        found[start, 0] = CONVERGED if settled else (ABANDONED if near else STALLED)
        found[start, 1], found[start, 2], found[start, 3] = worst, taken, length
