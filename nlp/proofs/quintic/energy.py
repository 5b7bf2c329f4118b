"""What moves over a box of durations, in the energy norm of its centre: compiled.

The norm is ‖y‖² = yᵀM0⁻¹y ≈ |R y|² with RᵀR ≈ M0⁻¹, M0 = M(r0). A box is |δ_k| ≤ e_k with
δ = r − r0. Of what is of lowest order in δ the vectors themselves are kept, Σ x_i v_i with
|x_i| ≤ 1, so that their products count: ‖Σ x_i v_i‖² ≤ Σ |v_iᵀv_j|, which is far less than
(Σ ‖v_i‖)² where they point to different sides. Higher orders and rounding count by their norms.
"""

from __future__ import annotations

import numpy as np

from .nodal import LOAD, LOAD_POWERS, POWERS, STIFFNESS, compiled, place, taylor

ROUNDING = 1e-12
"""Share of the sum of absolute values that covers every rounding (fewer than 2000 on any path)."""
_SQUARINGS = 4
"""Of A before ‖A¹⁶‖^(1/16) bounds its largest eigenvalue, at rank 25 within 11 %."""


@compiled
def _rooted(inverse, vector, factor, out):  # type: ignore[no-untyped-def]
    """Fill out = factor·R vector."""
    size = vector.size
    first = 0
    while first < size and vector[first] == 0.0:
        out[first] = 0.0
        first += 1
    for i in range(first, size):
        v = 0.0
        for m in range(first, i + 1):
            v += inverse[i, m] * vector[m]
        out[i] = factor * v


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
def norms(vectors):  # type: ignore[no-untyped-def]
    """Sum of the norms of the rows."""
    total = 0.0
    for i in range(vectors.shape[0]):
        v = 0.0
        for q in range(vectors.shape[1]):
            v += vectors[i, q] * vectors[i, q]
        total += np.sqrt(v)
    return total


@compiled
def leading_norm(vectors, share):  # type: ignore[no-untyped-def]
    """Bound of ‖Σ x_i v_i‖ for all |x_i| ≤ 1.

    ``share`` receives by how much it grows, relative to a vector's own growth: a proposal.
    """
    total = 0.0
    share[:] = 0.0
    for i in range(vectors.shape[0]):
        for j in range(i + 1):
            v = 0.0
            for q in range(vectors.shape[1]):
                v += vectors[i, q] * vectors[j, q]
            v = abs(v)
            share[i] += v
            if j < i:
                share[j] += v
                v += v
            total += v
    total = np.sqrt(total + ROUNDING * norms(vectors) ** 2)
    for i in range(vectors.shape[0]):
        share[i] /= max(total, 1e-300)  # any small number, where nothing moves
    return total


@compiled
def products(these, those):  # type: ignore[no-untyped-def]
    """Bound of |(Σ x_i v_i)ᵀ(Σ y_j w_j)| for all |x_i|, |y_j| ≤ 1."""
    total = 0.0
    for i in range(these.shape[0]):
        for j in range(those.shape[0]):
            v = 0.0
            for q in range(these.shape[1]):
                v += these[i, q] * those[j, q]
            total += abs(v)
    return total + ROUNDING * norms(these) * norms(those)


@compiled
def add_cubic(n, factor, pi1, rho2, cubic):  # type: ignore[no-untyped-def]
    """Add factor·(Σ x_a v_a)ᵀ(Σ x_k x_m w_km) to ``cubic``: one entry for each product of three.

    Entries stand at ``cubic[i, j, l]``, i ≤ j ≤ l. Returns the rounding of all of them together.
    """
    for a in range(n):
        at = n
        for k in range(n):
            for m in range(k, n):
                row = k if m == k else at
                at += 0 if m == k else 1
                v = 0.0
                for q in range(pi1.shape[1]):
                    v += pi1[a, q] * rho2[row, q]
                low, high = min(a, k), max(a, m)
                cubic[low, a + k + m - low - high, high] += factor * v
    return factor * ROUNDING * norms(pi1) * norms(rho2)


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
def spectrum(n, r, e, inverse, matrix):  # type: ignore[no-untyped-def]
    """Bounds (s, c) with s RᵀR ≼ M(r)⁻¹ ≼ c RᵀR all over the box; c = 0 if none is found.

    In t = r/r0, M_k(r) = t·T M_k(r0) T with T = diag(t, t, 1, 1). So, with W the velocity block of
    M0 whose segments are weighted with (e_k/r0_k)², the triangle inequality of the seminorm gives

        √(xᵀM(r)x) ≥ √(1 − max e/r0)·(√(xᵀM0 x) − √(xᵀW x)),
        1/c = (1 − max e/r0)·(1 − √λ)²·(1 − d),   1/s = (1 + max e/r0)·(1 + √λ)²·(1 + d),

    d = ‖R M0 Rᵀ − 1‖, λ ≤ ‖(R W Rᵀ)¹⁶‖^(1/16)/(1 − d) the largest eigenvalue of W against M0.
    """
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
        return 0.0, 0.0
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
        return 0.0, 0.0
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
            return 0.0, 0.0
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
    root = np.sqrt(largest)
    if not root < 1.0:
        return 0.0, 0.0
    least = (1.0 - worst) * (1.0 - root) ** 2 * (1.0 - defect) * (1.0 - 1e-9)
    most = (1.0 + worst) * (1.0 + root) ** 2 * (1.0 + defect) * (1.0 + 1e-9)
    return 1.0 / most, 1.0 / least


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
def adjoint_part(  # type: ignore[no-untyped-def]
    n, r, e, inverse, matrix, phi, rough, mu, gain, pi1, pi2
):
    """Rπ over the box, π = φ − M μ; Taylor parts of π into ``gain``, of Rπ into ``pi1``, ``pi2``.

    Returns (norm of the third order, norm of rounding, the constant part of π).

    With M_k,o the coefficient of δ_k**o in M_k, and φ_k,1 that of φ (its velocities carry r),

        π = rest + Σ_k Σ_o gain[k, o]·δ_k**o,  rest = φ(r0) − M0 μ,
        gain[k, 1] = φ_k,1 − M_k,1 μ,  gain[k, o] = −M_k,o μ for o = 2, 3.

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
    later = 0.0
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
            if order == 1:
                _rooted(inverse, vector, e[k], pi1[k])
            elif order == 2:
                _rooted(inverse, vector, e[k] * e[k], pi2[k])
            else:
                later += _energy(inverse, vector) * e[k] ** order
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
    return later, _absolute_energy(inverse, slack), rest


@compiled
def residual_part(  # type: ignore[no-untyped-def]
    n, r, e, inverse, matrix, step, x0, slope, reach, rho2, rho3
):
    """Rρ over the box, ρ = b − M (x0 + Σ slope_m δ_m): its parts into ``rho2`` and ``rho3``.

    Returns (norm of the fourth order, norm of what is 0 but for rounding).

    With b_k,o and M_k,o the coefficients of δ_k**o and X = slope,

        ρ = (b − M x0)(r0) + Σ_k (b_k,1 − M_k,1 x0 − M0 X_k)·δ_k
            + Σ_k Σ_(o ≥ 2) (b_k,o − M_k,o x0 − M_k,o−1 X_k)·δ_k**o
            − Σ_(k ≠ m) Σ_o M_k,o X_m·δ_k**o·δ_m.

    The first line is 0 but for rounding, if x0 and X are what `centre` takes them for.
    ``rho2`` receives n squares, then the pairs of k < m; ``rho3`` n cubes, then δ_k²·δ_m.
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
    later, at, to = 0.0, n, n
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
            if order == 2:
                _rooted(inverse, vector, e[k] * e[k], rho2[k])
                continue
            if order == 3:
                _rooted(inverse, vector, e[k] ** 3, rho3[k])
                continue
            if order > 3:
                later += _energy(inverse, vector) * e[k] ** order
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
                _spread(n, k, parts[k, m, order], vector, -1.0)
                if order == 1:
                    _rooted(inverse, vector, e[k] * e[k] * e[m], rho3[to])
                    to += 1
                else:
                    later += _energy(inverse, vector) * e[k] ** (order + 1) * e[m]
            if m > k:
                vector[:] = 0.0
                _spread(n, k, parts[k, m, 0], vector, -1.0)
                _spread(n, m, parts[m, k, 0], vector, -1.0)
                _rooted(inverse, vector, e[k] * e[m], rho2[at])
                at += 1
    for i in range(size):
        for q in range(size):
            zero[i] -= matrix[i, q] * x0[q]
        slack[i] += abs(zero[i])
    return later, _absolute_energy(inverse, slack)
