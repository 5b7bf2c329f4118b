"""Compiled kernel of piecewise polynomials: least and largest positions, for batches."""

from __future__ import annotations

import numpy as np

from .kernel import LANES, MAX_COEFFICIENTS, compiled, fit_coefficients, lane_peaks, take_durations


@compiled
def batch_ranges(  # type: ignore[no-untyped-def]
    durations, values, kinds, breaks, orders, degrees, column, lower, upper, perm, ranges
):
    """Find the least and the largest position of every joint for many duration vectors.

    ``ranges[vector, joint, side]`` receives them, counted from where ``values`` counts from:
    −inf and inf where a duration is not positive and finite or a value overflows. Blocks and lanes
    are those of `kernel.batch_peaks`.
    """
    n, joints, unknowns = degrees.size, values.shape[1], column.max() + 1
    block = min(max(1, LANES // joints), durations.shape[0])
    h = np.empty((n, block))
    system = np.empty((unknowns, 2 * lower + upper + 1, block))
    right = np.empty((unknowns, joints * block))
    scaled = np.empty((n, MAX_COEFFICIENTS, joints * block))
    cuts = np.empty((MAX_COEFFICIENTS, joints * block))
    peak = np.empty(joints * block)
    room = np.empty((8, joints * block))
    state = (room[0], room[1], room[2], room[3], room[4], room[5], room[6], room[7])
    for first in range(0, durations.shape[0], max(1, block)):
        vectors = min(block, durations.shape[0] - first)
        for v in range(vectors):
            valid = take_durations(durations[first + v], h, v)
            ranges[first + v, :, 0] = np.inf if valid else -np.inf
            ranges[first + v, :, 1] = -np.inf if valid else np.inf
        fit_coefficients(
            h, vectors, values, kinds, breaks, orders, degrees, column, lower, upper, perm,
            system, right, scaled,
        )  # fmt: skip
        for k in range(n):
            for side in range(2):
                sign = 2.0 * side - 1.0
                lane_peaks(scaled[k], degrees[k], perm, joints * vectors, cuts, state, sign, peak)
                for v in range(vectors):
                    for j in range(joints):
                        top = peak[j * vectors + v]
                        if not top <= sign * ranges[first + v, j, side]:
                            ranges[first + v, j, side] = sign * (top if top == top else np.inf)
