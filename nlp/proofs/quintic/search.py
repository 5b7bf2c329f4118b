"""Depth-first bisection of the simplex of durations: every leaf with what excludes it."""

from __future__ import annotations

import numpy as np

from ....verify import MOST_WEIGHT
from .bound import bound
from .nodal import centre, compiled
from .rows import MOST, candidates, simplex
from .windows import excluding_window

EMPTY, WINDOW, LIMITS = 0, 1, 2
"""Kinds of leaves: no durations of this total, a condition of all motions, weighted limits."""
DONE, PAUSED, FULL, SHORTER, DEEP = 0, 1, 2, 3, 4
"""Why the search returned."""
SPARE = 1e-9
"""Part of the limits by which a leaf must exceed them, so that another evaluation agrees."""
_SLACK = 1e-12
"""Share that boxes are widened by, as in `trajgap.verify`: far more than the rounding of sums."""


@compiled
def clip(n, low, high, total, least, most):  # type: ignore[no-untyped-def]
    """Shrink a box to durations that can add up to the total; False if there are none."""
    below, above = 0.0, 0.0
    for k in range(n):
        below += low[k]
        above += high[k]
    slack = _SLACK * (above + total)
    for k in range(n):
        least[k] = max(low[k], total - (above - high[k]) - slack)
        most[k] = min(high[k], total - (below - low[k]) + slack)
        if not least[k] <= most[k]:
            return False
    return True


@compiled
def cut(low, high):  # type: ignore[no-untyped-def]
    """Where a side is bisected: the geometric mean, or nearer to the top of a side that is wide."""
    return np.sqrt(low * high) if low > 0.1 * high else 0.3 * high


@compiled
def inverse_box(n, low, high, r, e):  # type: ignore[no-untyped-def]
    """Centre and half-widths of a box in 1/h; False if it is too wide for `bound`.

    The verifier takes the same ones: durations above 1e-40, so that nothing underflows, and
    half-widths below 0.6 of the centre; at 1 there is no bound.
    """
    for k in range(n):
        if not low[k] > 1e-40:
            return False
        a, b = 1.0 / high[k], 1.0 / low[k]
        r[k] = 0.5 * (a + b)
        e[k] = 0.5 * (b - a) + 4.0 * _SLACK * b
        if not e[k] < 0.6 * r[k]:
            return False
    return True


@compiled
def _share_out(count, norms, weight, tau, share):  # type: ignore[no-untyped-def]
    """Weights of the rows and tau as whole numbers: any positive multiple proves the same.

    The largest weight is 2²⁰. Weights below ``kept`` are left out: they sum up to 1,
    and short leaves are cheap.
    """
    kept = 1e-5
    top = 0.0
    for c in range(count):
        if weight[c] > kept:
            top = max(top, weight[c] / norms[c])
    scale = min(2.0**20 / top, MOST_WEIGHT / max(abs(tau), 1e-300))
    for c in range(count):
        share[c] = np.rint(weight[c] / norms[c] * scale) if weight[c] > kept else 0.0
    return np.rint(tau * scale)


@compiled
def _excluded(  # type: ignore[no-untyped-def]
    n, joints, r, e, step, limits, total, matrix, inverse, x0, slope,
    count, ids, shapes, norms, share, tau, blame,
):  # fmt: skip
    """Whether rows with their shares exclude the box, with something to spare.

    ``blame`` receives how much of what is in the way grows with each side.
    """
    kept = 0
    for c in range(count):
        if share[c] > 0.0:
            kept += 1
    segment, joint = np.empty(kept, np.int64), np.empty(kept, np.int64)
    power, limit = np.empty(kept, np.int64), np.empty(kept)
    shape, weight = np.empty((kept, 5)), np.empty(kept)
    q, scale = 0, 0.0
    for c in range(count):
        if share[c] > 0.0:
            segment[q], joint[q] = ids[c, 0], ids[c, 1]
            power[q] = 2 - ids[c, 2]
            limit[q] = limits[ids[c, 1], ids[c, 2] - 1]
            shape[q] = shapes[c]
            weight[q] = share[c]
            scale += share[c] * norms[c]
            q += 1
    reached = bound(
        n, joints, r, e, step, total, matrix, inverse, x0, slope,
        segment, joint, power, limit, shape, weight, tau, blame,
    )  # fmt: skip
    return reached > SPARE * scale


@compiled
def _worst_side(  # type: ignore[no-untyped-def]
    n, low, high, e, count, value, gradient, weight, blame
):
    """The side to cut: wide, with rows that change along it, and to blame for a failed bound.

    What is proved does not depend on it. Of the rules tried on two of the twenty problems of
    docs/explanation/certificates-quintic.md this one left a third fewer boxes than the widest side.
    A wide side is cut even where no row changes along it: it counts with a tenth of the limits, and
    from 0.02 to 1 the number of boxes differed by a tenth.
    """
    axis, most = 0, -1.0
    for k in range(n):
        width = np.log(high[k] / max(low[k], 1e-6 * high[k]))
        if count > 0:
            mean, top = 0.0, 0.0
            for c in range(count):
                change = abs(gradient[c, k]) * e[k]
                mean += weight[c] * change
                top = max(top, change * max(0.0, 1.0 + value[c]))
            width *= mean + top + 0.1
            if blame[k] > 0.0:
                width *= blame[k]
        if width > most:
            most, axis = width, k
    return axis


@compiled
def search(  # type: ignore[no-untyped-def]
    n, joints, step, limits, total, library, stack_low, stack_high, depth, nodes, look,
    tree, kinds, starts, ids_out, share_out, tau_out, sizes, counts,
):  # fmt: skip
    """Work on the stack until it is empty, ``nodes`` boxes are visited or the room is full.

    ``sizes`` = (letters, leaves, rows) written so far, ``depth[0]`` the height of the stack.
    Letters are 0 for a leaf, k + 1 for a cut of duration k, the lower part first. Leaf i of kind
    `LIMITS` has rows ``starts[i] : starts[i + 1]``; of kind `WINDOW` one, whose first number is the
    condition's. A direction whose total seems to be below ``look`` ends the search, with its box on
    top of the stack. ``counts`` = (boxes, boxes with a centre, boxes with a bound) so far.
    """
    size = 2 * (n - 1)
    matrix, inverse = np.empty((size, size)), np.empty((size, size))
    x0, slope = np.empty((joints, size)), np.empty((joints, n, size))
    low, high = np.empty(n), np.empty(n)
    r, e, blame = np.empty(n), np.empty(n), np.empty(n)
    ids = np.empty((MOST, 5), np.int64)
    value, norms = np.empty(MOST), np.empty(MOST)
    weight, share = np.empty(MOST), np.empty(MOST)
    gradient, shapes = np.empty((MOST, n)), np.empty((MOST, 5))
    for _ in range(nodes):
        if depth[0] == 0:
            return DONE
        if depth[0] + 2 > stack_low.shape[0]:
            return DEEP
        if (
            sizes[0] + 1 > tree.size or sizes[1] + 2 > kinds.size
            or sizes[2] + MOST > ids_out.shape[0]
        ):  # fmt: skip
            return FULL
        at = depth[0] - 1
        leaf, tau, used, count = -1, 0.0, 0, 0
        blame[:] = 0.0
        counts[0] += 1
        if not clip(n, stack_low[at], stack_high[at], total, low, high):
            leaf = EMPTY
        else:
            f, tau = excluding_window(n, library, low, high, np.float64(total))
            if f >= 0:
                leaf, used = WINDOW, 1
                ids_out[sizes[2], 0] = f
                share_out[sizes[2]] = 1.0
            elif inverse_box(n, low, high, r, e) and centre(
                n, joints, r, step, matrix, inverse, x0, slope
            ):
                counts[1] += 1
                count = candidates(
                    n, joints, r, step, limits, x0, slope, ids, value, gradient, shapes, norms
                )
                least, tau = simplex(n, count, value, gradient, r, e, total, weight)
                if least > 0.0:
                    counts[2] += 1
                    tau = _share_out(count, norms, weight, tau, share)
                    if _excluded(
                        n, joints, r, e, step, limits, total, matrix, inverse, x0, slope,
                        count, ids, shapes, norms, share, tau, blame,
                    ):  # fmt: skip
                        leaf = LIMITS
                        for c in range(count):
                            if share[c] > 0.0:
                                ids_out[sizes[2] + used] = ids[c]
                                share_out[sizes[2] + used] = share[c]
                                used += 1
                if leaf < 0 and look > 0.0:
                    reached, stretch = 0.0, 0.0
                    for k in range(n):
                        reached += 1.0 / r[k]
                    for c in range(count):
                        stretch = max(stretch, (1.0 + value[c]) ** (1.0 / ids[c, 2]))
                    if reached * stretch < look:
                        stack_low[at] = low
                        stack_high[at] = high
                        return SHORTER
        if leaf >= 0:
            tree[sizes[0]] = 0
            sizes[0] += 1
            kinds[sizes[1]] = leaf
            tau_out[sizes[1]] = tau
            starts[sizes[1]] = sizes[2]
            sizes[1] += 1
            sizes[2] += used
            starts[sizes[1]] = sizes[2]
            depth[0] -= 1
            continue
        axis = _worst_side(n, low, high, e, count, value, gradient, weight, blame)
        middle = cut(low[axis], high[axis])
        stack_low[at] = low
        stack_high[at] = high
        stack_low[at + 1] = low
        stack_high[at + 1] = high
        stack_low[at, axis] = middle
        stack_high[at + 1, axis] = middle
        tree[sizes[0]] = axis + 1
        sizes[0] += 1
        depth[0] += 1
    return DONE if depth[0] == 0 else PAUSED
