"""Lower bound of weighted limits over a box of durations: compiled, safe in floating point.

Derivation and error argument: docs/explanation/certificates-quintic.md, whose symbols are used.
"""

from __future__ import annotations

import numpy as np

from .energy import (
    ROUNDING,
    add_cubic,
    adjoint_part,
    leading_norm,
    norms,
    products,
    residual_part,
    spectrum,
)
from .nodal import LOAD, LOAD_POWERS, POWERS, STIFFNESS, compiled, place, taylor


@compiled
def bound(  # type: ignore[no-untyped-def]
    n, joints, r, e, step, total, matrix, inverse, x0, slope,
    segment, joint, power, limit, shape, weight, tau, blame,
):  # fmt: skip
    """Lower bound of Σ weight·(limit exceeded by) + tau·(Σ h − total) over the box.

    Row i says shape[i]·(r²Δ, r v0, r v1, a0, a1) ≤ limit[i]·r**power[i] in segment[i] of joint[i].
    −inf if the box is too wide for a bound. With x̃ = x0 + Σ_m X_m δ_m, X = slope, and any μ, the
    sum is, joint by joint,

        φᵀx + … = φᵀx0 + μᵀ(b − M x0) + … + πᵀ Σ_m X_m δ_m + πᵀM⁻¹ρ,  π = φ − M μ,  ρ = b − M x̃,

    where … is what depends on single durations. That and all before π is a polynomial of each r_k
    (``curve``) and a multiple of 1/r_k, so that

        sum ≥ value + firstᵀδ + ½ δᵀ second δ − |cubic(δ)| − later orders − Σ_joints error,
        πᵀM⁻¹ρ = ½(c + s)·(Rπ)ᵀ(Rρ) + what is at most ½(c − s)·‖Rπ‖‖Rρ‖,  s RᵀR ≼ M⁻¹ ≼ c RᵀR,

    where the lowest order of (Rπ)ᵀ(Rρ) is cubic too: its terms join the others before their
    absolute values are taken.
    """
    size, back = matrix.shape[0], inverse.T.copy()
    small, large = spectrum(n, r, e, inverse, back, matrix)
    if not large > 0.0:
        return -np.inf
    middle = 0.5 * (large + small)
    spread = 0.5 * (large - small) + ROUNDING * large
    cubic = np.zeros((n, n, n))
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
    later_orders, error = 0.0, 0.0
    third = n * (n + 1) // 2
    fourth = third + n * n
    pi_share, rho_share = np.empty(n), np.empty(third)
    blame[:] = 0.0
    right, reach = np.zeros(size), np.zeros(size)
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
        mu = np.dot(back, np.dot(inverse, right))
        pi, loose, rest = adjoint_part(n, r, e, back, matrix, phi[j], rough[j], mu, gain)
        rho, rho_loose = residual_part(n, r, e, back, matrix, step[:, j], x0[j], slope[j], reach)
        pi1, pi2, rho2, rho3 = pi[:n], pi[n : 2 * n], rho[:third], rho[third:fourth]
        adjoint, residual = leading_norm(pi1, pi_share), leading_norm(rho2, rho_share)
        later, rho_later = norms(pi[2 * n :]) + loose, norms(rho[fourth:]) + rho_loose
        n2, n3 = norms(pi2), norms(rho3)
        most, rho_most = adjoint + n2 + later, residual + n3 + rho_later
        error += add_cubic(n, middle, pi1, rho2, cubic)
        along = products(pi1, rho3) + products(pi2, rho2) + n2 * n3
        along += (adjoint + n2) * rho_later + later * rho_most
        error += middle * along + spread * most * rho_most
        at = n
        for k in range(n):
            blame[k] += spread * (pi_share[k] * rho_most + 2.0 * rho_share[k] * most)
            for m in range(k + 1, n):
                blame[k] += spread * rho_share[at] * most
                blame[m] += spread * rho_share[at] * most
                at += 1
        wide = np.abs(x0[j]) + np.dot(e, np.abs(slope[j]))
        first += np.dot(slope[j], rest)
        absolute += np.dot(np.abs(mu), reach)
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
                    elif order == 2:
                        low, high = min(k, m), max(k, m)
                        cubic[low, k, high] += v * e[k] * e[k] * e[m]
                    else:
                        later_orders += abs(v) * e[k] ** order * e[m]
    value = -tau * total
    for k in range(n):
        p0, ek = r[k], e[k]
        for p in range(5):
            value += curve[k, p] * taylor(p, 0, p0)
            first[k] += curve[k, p] * taylor(p, 1, p0)
            second[k, k] += 2.0 * curve[k, p] * taylor(p, 2, p0)
            cubic[k, k, k] += curve[k, p] * taylor(p, 3, p0) * ek**3
        later_orders += abs(curve[k, 4]) * ek**4
        # 1/(p + δ) = 1/p − δ/p² + δ²/p³ − δ³/p⁴ + δ⁴/(p⁴(p + δ))
        c = tau - against[k]
        value += c / p0
        first[k] -= c / (p0 * p0)
        second[k, k] += 2.0 * c / (p0 * p0 * p0)
        cubic[k, k, k] -= c * ek**3 / p0**4
        later_orders += abs(c) * ek**4 / (p0**4 * (p0 - ek))
        absolute += abs(tau) / (p0 - ek)
    for k in range(n):
        # x_k x_m ≥ −½(x_k² + x_m²), so that products of two take from the squares.
        bend = second[k, k] * e[k] * e[k]
        for m in range(n):
            if m != k:
                bend -= abs(second[k, m]) * e[k] * e[m]
        # The least of slope·x + ½ bend·x², |x| ≤ 1, is at an end, or at the vertex.
        lean = abs(first[k]) * e[k]
        value += -0.5 * lean * lean / bend if lean < bend else 0.5 * bend - lean
    third = np.abs(cubic).sum()
    for i in range(n):
        for k in range(i, n):
            for m in range(k, n):
                v = abs(cubic[i, k, m])
                blame[i] += v
                blame[k] += v
                blame[m] += v
    return value - (third + later_orders + error) * (1.0 + 1e-9) - 10.0 * ROUNDING * absolute
