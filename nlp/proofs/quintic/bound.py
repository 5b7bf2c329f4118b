"""Lower bound of weighted limits over a box of durations: compiled, safe in floating point.

Derivation and error argument: docs/certificates-quintic.md, whose symbols are used here. A box is
|r_k − r0_k| ≤ e_k in the inverse durations r = 1/h. The nodal velocities and accelerations x of
the C4 quintic solve M(r) x = b(r), M = Σ_k M_k(r_k) symmetric positive definite.
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
ROUNDING = 1e-12
"""Share of the sum of absolute values that covers every rounding (fewer than 2000 on any path)."""
_CHOOSE = np.array([[1, 0, 0, 0, 0], [1, 1, 0, 0, 0], [1, 2, 1, 0, 0], [1, 3, 3, 1, 0],
                    [1, 4, 6, 4, 1]], dtype=np.float64)  # fmt: skip
"""Binomial coefficients, up to those of r⁴."""
_SQUARINGS = 4
"""Of A before ‖A¹⁶‖^(1/16) bounds its largest eigenvalue, at rank 25 within 11 %."""
KERNELS = ("bound.py", "rows.py", "search.py", "windows.py")
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
def apply_inverse(inverse, right, out):  # type: ignore[no-untyped-def]
    """RᵀR right, into ``out``."""
    size = inverse.shape[0]
    half = np.zeros(size)
    for i in range(size):
        for m in range(i + 1):
            half[i] += inverse[i, m] * right[m]
    for i in range(size):
        v = 0.0
        for m in range(i, size):
            v += inverse[m, i] * half[m]
        out[i] = v


@compiled
def _energy(inverse, vector):  # type: ignore[no-untyped-def]
    """‖R vector‖."""
    size = vector.size
    first = 0
    while first < size and vector[first] == 0.0:
        first += 1
    total = 0.0
    for i in range(first, size):
        v = 0.0
        for m in range(first, i + 1):
            v += inverse[i, m] * vector[m]
        total += v * v
    return np.sqrt(total)


@compiled
def _absolute_energy(inverse, vector):  # type: ignore[no-untyped-def]
    """‖|R| vector‖ for a non-negative vector."""
    total = 0.0
    for i in range(vector.size):
        v = 0.0
        for m in range(i + 1):
            v += abs(inverse[i, m]) * vector[m]
        total += v * v
    return np.sqrt(total)


@compiled
def coercivity(n, r, e, inverse, matrix):  # type: ignore[no-untyped-def]
    """Lower bound of κ with M(r)⁻¹ ≼ RᵀR/κ all over the box; 0 if none is found."""
    size = inverse.shape[0]
    # ‖R M0 Rᵀ − 1‖ and its rounding: how far RᵀR is from M0⁻¹.
    half, defect = np.zeros((size, size)), 0.0
    rough = np.zeros((size, size))
    for i in range(size):
        for j in range(size):
            v, w = 0.0, 0.0
            for m in range(max(0, j - 3), min(i + 1, j + 4, size)):
                v += inverse[i, m] * matrix[m, j]
                w += abs(inverse[i, m] * matrix[m, j])
            half[i, j], rough[i, j] = v, w
    for i in range(size):
        total = 0.0
        for j in range(size):
            v, w = 0.0, 0.0
            for m in range(j + 1):
                v += half[i, m] * inverse[j, m]
                w += rough[i, m] * abs(inverse[j, m])
            total += abs(v - (1.0 if i == j else 0.0)) + ROUNDING * w
        defect = max(defect, total)
    if not defect < 1e-6:
        return 0.0
    # Velocity part of the energy with weights (e/r)²: its largest eigenvalue against M0.
    part, worst = np.zeros((size, size)), 0.0
    for k in range(n):
        share = e[k] / r[k]
        worst = max(worst, share)
        for a in range(2):
            i = place(k, a, n)
            for b in range(2):
                j = place(k, b, n)
                if i >= 0 and j >= 0:
                    part[i, j] += STIFFNESS[a, b] * taylor(3, 0, r[k]) * share * share
    if not worst < 1.0:
        return 0.0
    power = np.zeros((size, size))
    rounding = 0.0
    for i in range(size):
        for j in range(size):
            v, w = 0.0, 0.0
            for m in range(max(0, j - 3), min(i + 1, j + 4, size)):
                v += inverse[i, m] * part[m, j]
                w += abs(inverse[i, m] * part[m, j])
            half[i, j], rough[i, j] = v, w
    for i in range(size):
        total = 0.0
        for j in range(size):
            v, w = 0.0, 0.0
            for m in range(j + 1):
                v += half[i, m] * inverse[j, m]
                w += rough[i, m] * abs(inverse[j, m])
            if j <= i:
                power[i, j] = v
                power[j, i] = v
            total += w
        rounding = max(rounding, ROUNDING * total)
    largest, exponent = 1.0, 1.0
    for step in range(_SQUARINGS + 1):
        norm = 0.0
        for i in range(size):
            for j in range(size):
                norm += power[i, j] * power[i, j]
        norm = np.sqrt(norm)
        if not norm > 0.0:
            return 0.0
        largest *= norm**exponent
        if step == _SQUARINGS:
            break
        for i in range(size):
            for j in range(size):
                power[i, j] /= norm
        for i in range(size):
            for j in range(size):
                v = 0.0
                for m in range(size):
                    v += power[i, m] * power[m, j]
                half[i, j] = v
        power[:] = half
        exponent *= 0.5
    largest = (largest * (1.0 + 1e-9) + rounding) / (1.0 - defect)
    root = 1.0 - np.sqrt(largest)
    if not root > 0.0:
        return 0.0
    return (1.0 - worst) * root * root * (1.0 - defect) * (1.0 - 1e-9)


@compiled
def centre(n, joints, r, step, matrix, inverse, x0, slope):  # type: ignore[no-untyped-def]
    """Fill M0, R, and per joint x0 ≈ x(r) and slope[j, m] ≈ ∂x/∂r_m; False if it failed."""
    stiffness(n, r, matrix)
    if not inverse_factor(matrix, inverse):
        return False
    right = np.empty(matrix.shape[0])
    for j in range(joints):
        right[:] = 0.0
        for k in range(n):
            for a in range(4):
                i = place(k, a, n)
                if i >= 0:
                    right[i] += LOAD[a] * taylor(LOAD_POWERS[a], 0, r[k]) * step[k, j]
        apply_inverse(inverse, right, x0[j])
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
            apply_inverse(inverse, right, slope[j, m])
    return True


@compiled
def _times_part(n, k, order, r, vector, out):  # type: ignore[no-untyped-def]
    """Fill out[a] = (coefficient of δ**order in M_k) · vector, in the four places of segment k."""
    for a in range(4):
        v = 0.0
        for b in range(4):
            q = place(k, b, n)
            if q >= 0:
                v += STIFFNESS[a, b] * taylor(POWERS[a, b], order, r) * vector[q]
        out[a] = v


@compiled
def _spread(n, k, local, out, sign):  # type: ignore[no-untyped-def]
    """Add a segment's four numbers to a vector of unknowns."""
    for a in range(4):
        i = place(k, a, n)
        if i >= 0:
            out[i] += sign * local[a]


@compiled
def _adjoint_part(n, r, e, inverse, matrix, phi, rough, mu, gain):  # type: ignore[no-untyped-def]
    """Energy bound of π = φ − M μ over the box, and its constant; Taylor parts into ``gain``.

    ``rough`` is φ with absolute values in its sums.
    """
    size = mu.size
    rest = np.zeros(size)
    for k in range(n):
        for a in range(4):
            i = place(k, a, n)
            if i >= 0:
                rest[i] += phi[k, a] * (r[k] if a < 2 else 1.0)
    for i in range(size):
        for m in range(size):
            rest[i] -= matrix[i, m] * mu[m]
    slack = np.zeros(size)
    local, vector = np.empty(4), np.empty(size)
    total = 0.0
    for k in range(n):
        top = r[k] + e[k]
        for order in range(1, 4):
            _times_part(n, k, order, r[k], mu, local)
            for a in range(4):
                gain[k, order, a] = -local[a]
                if order == 1 and a < 2:
                    gain[k, order, a] += phi[k, a]
            vector[:] = 0.0
            _spread(n, k, gain[k, order], vector, 1.0)
            total += _energy(inverse, vector) * e[k] ** order
        for a in range(4):
            i = place(k, a, n)
            if i < 0:
                continue
            v = rough[k, a] * (top if a < 2 else 1.0)
            for b in range(4):
                q = place(k, b, n)
                if q >= 0:
                    v += abs(STIFFNESS[a, b]) * taylor(POWERS[a, b], 0, top) * abs(mu[q])
            slack[i] += ROUNDING * v
    for i in range(size):
        slack[i] += abs(rest[i])
    return total + _absolute_energy(inverse, slack), rest


@compiled
def _residual_part(n, r, e, inverse, matrix, step, x0, slope, reach):  # type: ignore[no-untyped-def]
    """Energy bound of ρ = b − M (x0 + Σ slope_m δ_m) over the box; ``reach`` bounds |M| x and b.

    ``reach[i]`` receives the sum of the absolute values of row i's terms.
    """
    size = x0.size
    slack, vector = np.zeros(size), np.empty(size)
    wide = np.abs(x0)
    for m in range(n):
        wide += e[m] * np.abs(slope[m])
    reach[:] = 0.0
    for k in range(n):
        top = r[k] + e[k]
        for a in range(4):
            i = place(k, a, n)
            if i < 0:
                continue
            v = abs(LOAD[a] * step[k]) * taylor(LOAD_POWERS[a], 0, top)
            for b in range(4):
                q = place(k, b, n)
                if q >= 0:
                    v += abs(STIFFNESS[a, b]) * taylor(POWERS[a, b], 0, top) * wide[q]
            reach[i] += v
    for i in range(size):
        slack[i] = ROUNDING * reach[i]
    parts = np.empty((n, n, 3, 4))
    for k in range(n):
        for m in range(n):
            for order in range(3):
                _times_part(n, k, order + 1, r[k], slope[m], parts[k, m, order])
    zero, local = np.zeros(size), np.empty(4)
    total = 0.0
    for k in range(n):
        for a in range(4):
            local[a] = LOAD[a] * step[k] * taylor(LOAD_POWERS[a], 0, r[k])
        _spread(n, k, local, zero, 1.0)
        for order in range(1, 5):
            _times_part(n, k, order, r[k], x0, local)
            for a in range(4):
                local[a] = LOAD[a] * step[k] * taylor(LOAD_POWERS[a], order, r[k]) - local[a]
                if order > 1:
                    local[a] -= parts[k, k, order - 2, a]
            vector[:] = 0.0
            _spread(n, k, local, vector, 1.0)
            if order > 1:
                total += _energy(inverse, vector) * e[k] ** order
                continue
            for i in range(size):
                for q in range(size):
                    vector[i] -= matrix[i, q] * slope[k, q]
                slack[i] += e[k] * abs(vector[i])
        for m in range(n):
            if m == k:
                continue
            for order in range(1, 3):
                vector[:] = 0.0
                _spread(n, k, parts[k, m, order], vector, 1.0)
                total += _energy(inverse, vector) * e[k] ** (order + 1) * e[m]
            if m > k:
                vector[:] = 0.0
                _spread(n, k, parts[k, m, 0], vector, 1.0)
                _spread(n, m, parts[m, k, 0], vector, 1.0)
                total += _energy(inverse, vector) * e[k] * e[m]
    for i in range(size):
        for q in range(size):
            zero[i] -= matrix[i, q] * x0[q]
        slack[i] += abs(zero[i])
    return total + _absolute_energy(inverse, slack)


@compiled
def bound(  # type: ignore[no-untyped-def]
    n, joints, r, e, step, total, matrix, inverse, x0, slope,
    segment, joint, power, limit, shape, weight, tau,
):  # fmt: skip
    """Lower bound of Σ weight·(limit exceeded by) + tau·(Σ h − total) over the box.

    Row i says shape[i]·(r²Δ, r v0, r v1, a0, a1) ≤ limit[i]·r**power[i] in segment[i] of joint[i].
    −inf if the box is too wide for a bound.
    """
    size = matrix.shape[0]
    kappa = coercivity(n, r, e, inverse, matrix)
    if not kappa > 0.0:
        return -np.inf
    phi, rough = np.zeros((joints, n, 4)), np.zeros((joints, n, 4))
    curve, against = np.zeros((n, 5)), np.zeros(n)
    absolute = abs(tau) * total
    active = np.zeros(joints, np.bool_)
    for i in range(segment.size):
        k, j, w = segment[i], joint[i], weight[i]
        active[j] = True
        for a in range(4):
            phi[j, k, a] += w * shape[i, a + 1]
            rough[j, k, a] += abs(w * shape[i, a + 1])
        curve[k, 2] += w * shape[i, 0] * step[k, j]
        top = r[k] + e[k]
        absolute += abs(w * shape[i, 0] * step[k, j]) * top * top
        if power[i] < 0:
            against[k] += w * limit[i]
            absolute += abs(w) * limit[i] / (r[k] - e[k])
        else:
            curve[k, power[i]] -= w * limit[i]
            absolute += abs(w) * limit[i] * (top if power[i] == 1 else 1.0)
    second, first = np.zeros((n, n)), np.zeros(n)
    third, error = 0.0, 0.0
    mu, right, reach = np.zeros(size), np.zeros(size), np.zeros(size)
    gain = np.zeros((n, 4, 4))
    for j in range(joints):
        if not active[j]:
            continue
        right[:] = 0.0
        for k in range(n):
            for a in range(4):
                i = place(k, a, n)
                if i >= 0:
                    right[i] += phi[j, k, a] * (r[k] if a < 2 else 1.0)
        apply_inverse(inverse, right, mu)
        adjoint, rest = _adjoint_part(n, r, e, inverse, matrix, phi[j], rough[j], mu, gain)
        residual = _residual_part(n, r, e, inverse, matrix, step[:, j], x0[j], slope[j], reach)
        error += adjoint * residual
        wide = np.abs(x0[j])
        for m in range(n):
            wide += e[m] * np.abs(slope[j, m])
            for i in range(size):
                first[m] += rest[i] * slope[j, m, i]
        for i in range(size):
            absolute += abs(mu[i]) * reach[i]
        for k in range(n):
            top = r[k] + e[k]
            for a in range(4):
                i = place(k, a, n)
                if i < 0:
                    continue
                degree = 1 if a < 2 else 0
                curve[k, degree] += phi[j, k, a] * x0[j, i]
                absolute += rough[j, k, a] * (top if a < 2 else 1.0) * wide[i]
                curve[k, LOAD_POWERS[a]] += mu[i] * LOAD[a] * step[k, j]
                for b in range(4):
                    q = place(k, b, n)
                    if q >= 0:
                        curve[k, POWERS[a, b]] -= mu[i] * STIFFNESS[a, b] * x0[j, q]
            for m in range(n):
                for order in range(1, 4):
                    v = 0.0
                    for a in range(4):
                        i = place(k, a, n)
                        if i >= 0:
                            v += gain[k, order, a] * slope[j, m, i]
                    if order == 1:
                        second[k, m] += v
                        second[m, k] += v
                    else:
                        third += abs(v) * e[k] ** order * e[m]
    value = -tau * total
    for k in range(n):
        p0, ek = r[k], e[k]
        for p in range(5):
            value += curve[k, p] * taylor(p, 0, p0)
            first[k] += curve[k, p] * taylor(p, 1, p0)
            second[k, k] += 2.0 * curve[k, p] * taylor(p, 2, p0)
        for order in range(3, 5):
            v = 0.0
            for p in range(5):
                v += curve[k, p] * taylor(p, order, p0)
            third += abs(v) * ek**order
        c = tau - against[k]
        value += c / p0
        first[k] -= c / (p0 * p0)
        second[k, k] += 2.0 * c / (p0 * p0 * p0)
        third += abs(c) * ek**3 / (p0**3 * (p0 - ek))
        absolute += abs(tau) / (p0 - ek)
    for k in range(n):
        ek, slope_k, bend = e[k], first[k], second[k, k]
        least = 0.5 * bend * ek * ek - abs(slope_k) * ek
        if bend > 0.0 and abs(slope_k) < bend * ek:
            least = -0.5 * slope_k * slope_k / bend
        value += least
        for m in range(k):
            value -= abs(second[k, m]) * ek * e[m]
    error = error / kappa * (1.0 + 1e-9)
    return value - third * (1.0 + 1e-9) - error - 10.0 * ROUNDING * absolute
