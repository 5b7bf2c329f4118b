"""What moves over a box of durations, in the energy norm of its centre: compiled.

The norm is ‖y‖² = yᵀM0⁻¹y ≈ |R y|² with RᵀR ≈ M0⁻¹, M0 = M(r0). A box is |δ_k| ≤ e_k with
δ = r − r0. Of what is of lowest order in δ the vectors themselves are kept, Σ x_i v_i with
|x_i| ≤ 1, so that their products count: ‖Σ x_i v_i‖² ≤ Σ |v_iᵀv_j|, which is far less than
(Σ ‖v_i‖)² where they point to different sides. Higher orders and rounding count by their norms.
Vectors are rows, so that R v of all of them is one product with ``back`` = Rᵀ.
"""

from __future__ import annotations

import numpy as np

from .nodal import LOAD, LOAD_POWERS, POWERS, STIFFNESS, compiled, place, taylor

ROUNDING = 1e-12
"""Share of the sum of absolute values that covers every rounding (fewer than 2000 on any path)."""


@compiled
def norms(vectors):  # type: ignore[no-untyped-def]
    """Sum of the norms of the rows."""
    total = 0.0
    for i in range(vectors.shape[0]):
        total += np.sqrt(np.dot(vectors[i], vectors[i]))
    return total


@compiled
def leading_norm(vectors, share):  # type: ignore[no-untyped-def]
    """Bound of ‖Σ x_i v_i‖ for all |x_i| ≤ 1.

    ``share`` receives by how much it grows, relative to a vector's own growth: a proposal.
    """
    gram = np.abs(np.dot(vectors, vectors.T))
    total = np.sqrt(gram.sum() + ROUNDING * norms(vectors) ** 2)
    for i in range(vectors.shape[0]):
        share[i] = gram[i].sum() / max(total, 1e-300)  # any small number, where nothing moves
    return total


@compiled
def products(these, those):  # type: ignore[no-untyped-def]
    """Bound of |(Σ x_i v_i)ᵀ(Σ y_j w_j)| for all |x_i|, |y_j| ≤ 1."""
    return np.abs(np.dot(these, those.T)).sum() + ROUNDING * norms(these) * norms(those)


@compiled
def add_cubic(n, factor, pi1, rho2, cubic):  # type: ignore[no-untyped-def]
    """Add factor·(Σ x_a v_a)ᵀ(Σ x_k x_m w_km) to ``cubic``: one entry for each product of three.

    Entries stand at ``cubic[i, j, l]``, i ≤ j ≤ l. Returns the rounding of all of them together.
    """
    both = np.dot(pi1, rho2.T)
    for a in range(n):
        at = n
        for k in range(n):
            for m in range(k, n):
                row = k if m == k else at
                at += 0 if m == k else 1
                low, high = min(a, k), max(a, m)
                cubic[low, a + k + m - low - high, high] += factor * both[a, row]
    return factor * ROUNDING * norms(pi1) * norms(rho2)


@compiled
def spectrum(n, r, e, inverse, back, matrix):  # type: ignore[no-untyped-def]
    """Bounds (s, c) with s RᵀR ≼ M(r)⁻¹ ≼ c RᵀR all over the box; c = 0 if none is found.

    In t = r/r0, M_k(r) = t·T M_k(r0) T with T = diag(t, t, 1, 1). So, with W the velocity block of
    M0 whose segments are weighted with (e_k/r0_k)², the triangle inequality of the seminorm gives

        √(xᵀM(r)x) ≥ √(1 − max e/r0)·(√(xᵀM0 x) − √(xᵀW x)),
        1/c = (1 − max e/r0)·(1 − √λ)²·(1 − d),   1/s = (1 + max e/r0)·(1 + √λ)²·(1 + d),

    d = ‖R M0 Rᵀ − 1‖, λ ≤ ‖(R W Rᵀ)¹⁶‖^(1/16)/(1 − d) the largest eigenvalue of W against M0: at
    rank 25 within 11 %.
    """
    size = inverse.shape[0]
    outer, inner = np.abs(inverse), np.abs(back)
    off = np.abs(np.dot(np.dot(inverse, matrix), back) - np.eye(size))
    off += ROUNDING * np.dot(np.dot(outer, np.abs(matrix)), inner)
    defect = off.sum(axis=1).max()
    if not defect < 1e-6:
        return 0.0, 0.0
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
    power = np.dot(np.dot(inverse, part), back)
    power = 0.5 * (power + power.T)
    rounding = ROUNDING * np.dot(np.dot(outer, np.abs(part)), inner).sum(axis=1).max()
    largest, exponent = 1.0, 1.0
    for _ in range(5):  # norms of A, A², A⁴, A⁸ and A¹⁶, each divided by the one before
        norm = np.sqrt((power * power).sum())
        if not norm > 0.0:
            return 0.0, 0.0
        largest *= norm**exponent
        exponent *= 0.5
        power = power / norm
        power = np.dot(power, power)
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
def _spread(n, k, local, out, factor):  # type: ignore[no-untyped-def]
    """Add a segment's four numbers, times a factor, to a vector of unknowns."""
    for a in range(4):
        i = place(k, a, n)
        if i >= 0:
            out[i] += factor * local[a]


@compiled
def _largest_parts(n, k, top, vector, out):  # type: ignore[no-untyped-def]
    """Add |M_k| · vector to a vector of unknowns, for 1/h up to ``top``."""
    for a in range(4):
        i = place(k, a, n)
        for b in range(4):
            q = place(k, b, n)
            if i >= 0 and q >= 0:
                out[i] += abs(STIFFNESS[a, b]) * taylor(POWERS[a, b], 0, top) * vector[q]


@compiled
def adjoint_part(n, r, e, back, matrix, phi, rough, mu, gain):  # type: ignore[no-untyped-def]
    """Rπ over the box, π = φ − M μ; Taylor parts of π go into ``gain``.

    Returns (Taylor parts of Rπ, by order and segment; norm of rounding; the constant part of π).

    With M_k,o the coefficient of δ_k**o in M_k, and φ_k,1 that of φ (its velocities carry r),

        π = rest + Σ_k Σ_o gain[k, o]·δ_k**o,  rest = φ(r0) − M0 μ,
        gain[k, 1] = φ_k,1 − M_k,1 μ,  gain[k, o] = −M_k,o μ for o = 2, 3.

    ``rough`` is φ with absolute values in its sums.
    """
    size = mu.size
    rest, size_of = -np.dot(matrix, mu), np.zeros(size)
    vectors, local, far = np.zeros((3 * n, size)), np.empty(4), np.abs(mu)
    for k in range(n):
        top = r[k] + e[k]
        for order in range(1, 4):
            _times_part(n, k, order, r[k], mu, local)
            for a in range(4):
                gain[k, order, a] = -local[a]
                if order == 1 and a < 2:
                    gain[k, order, a] += phi[k, a]
            _spread(n, k, gain[k, order], vectors[(order - 1) * n + k], e[k] ** order)
        for a in range(4):
            i = place(k, a, n)
            if i >= 0:
                rest[i] += phi[k, a] * (r[k] if a < 2 else 1.0)
                size_of[i] += rough[k, a] * (top if a < 2 else 1.0)
        _largest_parts(n, k, top, far, size_of)
    slack = np.dot(np.abs(rest) + ROUNDING * size_of, np.abs(back))
    return np.dot(vectors, back), np.sqrt(np.dot(slack, slack)), rest


@compiled
def residual_part(n, r, e, back, matrix, step, x0, slope, reach):  # type: ignore[no-untyped-def]
    """Rρ over the box, ρ = b − M (x0 + Σ slope_m δ_m).

    Returns (its parts, norm of what is 0 but for rounding).

    With b_k,o and M_k,o the coefficients of δ_k**o and X = slope,

        ρ = (b − M x0)(r0) + Σ_k (b_k,1 − M_k,1 x0 − M0 X_k)·δ_k
            + Σ_k Σ_(o ≥ 2) (b_k,o − M_k,o x0 − M_k,o−1 X_k)·δ_k**o
            − Σ_(k ≠ m) Σ_o M_k,o X_m·δ_k**o·δ_m.

    The first line is 0 but for rounding, if x0 and X are what `centre` takes them for. Of the parts
    those of second order stand first, n squares and the pairs of k < m, then n² of third order and
    n² of fourth: cubes first, then δ_k²·δ_m. ``reach[i]`` receives the sum of the absolute values
    of row i's terms.
    """
    size, third = x0.size, n * (n + 1) // 2
    fourth = third + n * n
    vectors = np.zeros((fourth + n * n, size))
    zero, linear = -np.dot(matrix, x0), -np.dot(slope, matrix)
    wide, local = np.abs(x0) + np.dot(e, np.abs(slope)), np.empty(4)
    parts = np.empty((n, n, 3, 4))
    for k in range(n):
        for m in range(n):
            for order in range(3):
                _times_part(n, k, order + 1, r[k], slope[m], parts[k, m, order])
    reach[:] = 0.0
    at, mixed = n, n
    for k in range(n):
        top = r[k] + e[k]
        for a in range(4):
            i = place(k, a, n)
            if i >= 0:
                zero[i] += LOAD[a] * step[k] * taylor(LOAD_POWERS[a], 0, r[k])
                reach[i] += abs(LOAD[a] * step[k]) * taylor(LOAD_POWERS[a], 0, top)
        _largest_parts(n, k, top, wide, reach)
        for order in range(1, 5):
            _times_part(n, k, order, r[k], x0, local)
            for a in range(4):
                local[a] = LOAD[a] * step[k] * taylor(LOAD_POWERS[a], order, r[k]) - local[a]
                if order > 1:
                    local[a] -= parts[k, k, order - 2, a]
            if order == 1:
                _spread(n, k, local, linear[k], 1.0)
            else:
                first = 0 if order == 2 else third if order == 3 else fourth
                _spread(n, k, local, vectors[first + k], e[k] ** order)
        for m in range(n):
            if m == k:
                continue
            _spread(n, k, parts[k, m, 1], vectors[third + mixed], -(e[k] ** 2) * e[m])
            _spread(n, k, parts[k, m, 2], vectors[fourth + mixed], -(e[k] ** 3) * e[m])
            mixed += 1
            if m > k:
                _spread(n, k, parts[k, m, 0], vectors[at], -e[k] * e[m])
                _spread(n, m, parts[m, k, 0], vectors[at], -e[k] * e[m])
                at += 1
    slack = ROUNDING * reach + np.abs(zero) + np.dot(e, np.abs(linear))
    slack = np.dot(slack, np.abs(back))
    return np.dot(vectors, back), np.sqrt(np.dot(slack, slack))
