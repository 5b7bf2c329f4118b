"""Lower bound of weighted limits over a box of durations: compiled, safe in floating point.

Derivation and error argument: docs/explanation/certificates-quintic.md, whose symbols are used.
"""

from __future__ import annotations

import numpy as np

from .energy import ROUNDING, adjoint_part, coercivity, residual_part
from .nodal import LOAD, LOAD_POWERS, POWERS, STIFFNESS, apply_inverse, compiled, place, taylor


@compiled
def bound(  # type: ignore[no-untyped-def]
    n, joints, r, e, step, total, matrix, inverse, x0, slope,
    segment, joint, power, limit, shape, weight, tau,
):  # fmt: skip
    """Lower bound of Σ weight·(limit exceeded by) + tau·(Σ h − total) over the box.

    Row i says shape[i]·(r²Δ, r v0, r v1, a0, a1) ≤ limit[i]·r**power[i] in segment[i] of joint[i].
    −inf if the box is too wide for a bound. With x̃ = x0 + Σ_m X_m δ_m, X = slope, and any μ, the
    sum is, joint by joint,

        φᵀx + … = φᵀx0 + μᵀ(b − M x0) + … + πᵀ Σ_m X_m δ_m + πᵀM⁻¹ρ,  π = φ − M μ,  ρ = b − M x̃,

    where … is what depends on single durations. That and all before π is a polynomial of each r_k
    (``curve``) and a multiple of 1/r_k, so that

        sum ≥ value + firstᵀδ + ½ δᵀ second δ − third − Σ_joints ‖π‖‖ρ‖/κ.
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
        adjoint, rest = adjoint_part(n, r, e, inverse, matrix, phi[j], rough[j], mu, gain)
        residual = residual_part(n, r, e, inverse, matrix, step[:, j], x0[j], slope[j], reach)
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
        # 1/(p + δ) = 1/p − δ/p² + δ²/p³ − δ³/(p³(p + δ))
        c = tau - against[k]
        value += c / p0
        first[k] -= c / (p0 * p0)
        second[k, k] += 2.0 * c / (p0 * p0 * p0)
        third += abs(c) * ek**3 / (p0**3 * (p0 - ek))
        absolute += abs(tau) / (p0 - ek)
    for k in range(n):
        ek, slope_k, bend = e[k], first[k], second[k, k]
        # The least of slope·δ + ½ bend·δ² is at an end, or at the vertex.
        least = 0.5 * bend * ek * ek - abs(slope_k) * ek
        if bend > 0.0 and abs(slope_k) < bend * ek:
            least = -0.5 * slope_k * slope_k / bend
        value += least
        for m in range(k):
            value -= abs(second[k, m]) * ek * e[m]
    error = error / kappa * (1.0 + 1e-9)
    return value - third * (1.0 + 1e-9) - error - 10.0 * ROUNDING * absolute
