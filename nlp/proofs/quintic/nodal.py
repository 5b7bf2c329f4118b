"""The nodal equations of the C4 quintic, and their solution at the centre of a box: compiled.

With r = 1/h, the velocities and accelerations x at the inner way-points make ½∫(q''')² least over
all curves through the way-points: M(r) x = b(r) with, over the segments k,

    M = Σ_k M_k(r_k),  M_k[a, b] = STIFFNESS[a, b]·r_k**POWERS[a, b],
    b = Σ_k b_k(r_k),  b_k[a] = LOAD[a]·r_k**LOAD_POWERS[a]·Δ_k,

symmetric and positive definite. Symbols are those of docs/explanation/certificates-quintic.md.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ....problem.curves import compiler

STIFFNESS = np.array(
    [[192.0, 168.0, 36.0, -24.0], [168.0, 192.0, 24.0, -36.0], [36.0, 24.0, 9.0, -3.0],
     [-24.0, -36.0, -3.0, 9.0]]
)  # fmt: skip
"""∫(q''')² of a quintic on [0, 1] in its end velocities and accelerations (v0, v1, a0, a1)."""
POWERS = np.array([[3, 3, 2, 2], [3, 3, 2, 2], [2, 2, 1, 1], [2, 2, 1, 1]])
"""Power of r in each entry of ``STIFFNESS`` for a segment of duration 1/r."""
LOAD = np.array([360.0, 360.0, 60.0, -60.0])
"""−∂²/∂x∂Δ of ½∫(q''')², a step Δ of position moving the quintic: b without its powers of r."""
LOAD_POWERS = np.array([4, 4, 3, 3])
"""Right-hand side b of a segment is ``LOAD · r**LOAD_POWERS`` times its step of position."""
BASIS = np.array(
    [[0.0, 0.0, 0.0, 10.0, -15.0, 6.0], [0.0, 1.0, 0.0, -6.0, 8.0, -3.0],
     [0.0, 0.0, 0.0, -4.0, 7.0, -3.0], [0.0, 0.0, 0.5, -1.5, 1.5, -0.5],
     [0.0, 0.0, 0.0, 0.5, -1.0, 0.5]]
)  # fmt: skip
"""Quintic with (step, v0, v1, a0, a1) on [0, 1], ascending powers of s."""
_CHOOSE = np.array([[1, 0, 0, 0, 0], [1, 1, 0, 0, 0], [1, 2, 1, 0, 0], [1, 3, 3, 1, 0],
                    [1, 4, 6, 4, 1]], dtype=np.float64)  # fmt: skip
"""Binomial coefficients, up to those of r⁴."""
KERNELS = ("bound.py", "energy.py", "nodal.py", "rows.py", "search.py", "windows.py")
"""Every file of compiled functions here: they call each other, so they share a stamp."""
compiled = compiler(*(Path(__file__).with_name(name) for name in KERNELS))
"""Compiles a function of one of these files."""


@compiled
def place(k, a, n):  # type: ignore[no-untyped-def]
    """Index of unknown (v0, v1, a0, a1)[a] of segment k; −1 at the ends, where it is 0."""
    node = k + (a & 1)
    if node == 0 or node == n:
        return -1
    return 2 * (node - 1) + (a >> 1)


@compiled
def taylor(power, order, r):  # type: ignore[no-untyped-def]
    """Coefficient of δ**order in (r + δ)**power."""
    if order > power:
        return 0.0
    value = _CHOOSE[power, order]
    for _ in range(power - order):
        value *= r
    return value


@compiled
def stiffness(n, r, matrix):  # type: ignore[no-untyped-def]
    """Fill M(r)."""
    matrix[:] = 0.0
    for k in range(n):
        for a in range(4):
            i = place(k, a, n)
            for b in range(4):
                j = place(k, b, n)
                if i >= 0 and j >= 0:
                    matrix[i, j] += STIFFNESS[a, b] * taylor(POWERS[a, b], 0, r[k])


@compiled
def inverse_factor(matrix, inverse):  # type: ignore[no-untyped-def]
    """Approximate R with RᵀR ≈ M⁻¹, lower triangular; False if M is not positive definite."""
    size = matrix.shape[0]
    low = np.zeros((size, size))
    for j in range(size):
        d = matrix[j, j]
        for m in range(max(0, j - 4), j):
            d -= low[j, m] * low[j, m]
        if not d > 0.0:
            return False
        d = np.sqrt(d)
        low[j, j] = d
        for i in range(j + 1, min(size, j + 4)):
            v = matrix[i, j]
            for m in range(max(0, i - 4), j):
                v -= low[i, m] * low[j, m]
            low[i, j] = v / d
    inverse[:] = 0.0
    for c in range(size):
        inverse[c, c] = 1.0 / low[c, c]
        for i in range(c + 1, size):
            v = 0.0
            for m in range(max(c, i - 4), i):
                v -= low[i, m] * inverse[m, c]
            inverse[i, c] = v / low[i, i]
    return True


@compiled
def centre(n, joints, r, step, matrix, inverse, x0, slope):  # type: ignore[no-untyped-def]
    """Fill M0, R, and per joint x0 ≈ x(r) and slope[j, m] ≈ ∂x/∂r_m; False if it failed.

    ∂x/∂r_m = M⁻¹(∂b_m/∂r_m − ∂M_m/∂r_m x): only segment m depends on r_m.
    """
    stiffness(n, r, matrix)
    if not inverse_factor(matrix, inverse):
        return False
    right, weight = np.empty(matrix.shape[0]), np.dot(inverse.T, inverse)
    for j in range(joints):
        right[:] = 0.0
        for k in range(n):
            for a in range(4):
                i = place(k, a, n)
                if i >= 0:
                    right[i] += LOAD[a] * taylor(LOAD_POWERS[a], 0, r[k]) * step[k, j]
        x0[j] = np.dot(weight, right)
        for m in range(n):
            right[:] = 0.0
            for a in range(4):
                i = place(m, a, n)
                if i < 0:
                    continue
                right[i] += LOAD[a] * taylor(LOAD_POWERS[a], 1, r[m]) * step[m, j]
                for b in range(4):
                    q = place(m, b, n)
                    if q >= 0:
                        right[i] -= STIFFNESS[a, b] * taylor(POWERS[a, b], 1, r[m]) * x0[j, q]
            slope[j, m] = np.dot(weight, right)
    return True
