"""Lower bounds of weighted limits over boxes of a C4 quintic spline, many leaves at once.

The argument is that of docs/explanation/certificates-quintic.md. The nodal equations come from the
jumps of q''' and q''''; arrays lead with the leaf. A sum Σ x_i v_i with |x_i| ≤ 1 is held by its
vectors, so products of theirs count: where vectors point to different sides, that is far less
than their norms say. Every result is a sum of products with fewer than 2000 roundings
on any path, 2.3e-13 of the same sum over absolute values: `ROUND` of that sum is taken off.
"""

from __future__ import annotations

from copy import copy
from dataclasses import dataclass
from math import comb
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from .boxes import SLACK, Array, Rows, least_of_quadratic, most_of_cubes, shapes
from .ranges import QUINTIC_PLACES
from .reading import Refused, need

ROUND = 1e-12
"""Of a sum over absolute values: four times what its roundings can amount to."""
BRIEFEST = 1e-40
"""Durations in a leaf with limits are above it, so nothing underflows."""
WIDEST = 0.6
"""Half-width of a leaf in 1/h, as a share of the middle, is below it: at 1 there is no bound."""

# Quintic with (q0, q1, v0, v1, a0, a1): rows of ascending powers; exact, entries are halves.
_AT = np.array(
    [[1, 0, 0, 0, 0, 0], [1] * 6, [0, 1, 0, 0, 0, 0], range(6), [0, 0, 2, 0, 0, 0],
     [p * (p - 1) for p in range(6)]], dtype=np.float64,
)  # fmt: skip
HERMITE = np.rint(2.0 * np.linalg.inv(_AT).T) / 2.0
"""Its basis, inverted instead of typed."""
_JUMPS = np.array(
    [24 * HERMITE[:, 4], -24 * HERMITE[:, 4] - 120 * HERMITE[:, 5], -6 * HERMITE[:, 3],
     6 * HERMITE[:, 3] + 24 * HERMITE[:, 4] + 60 * HERMITE[:, 5]]
)  # fmt: skip
"""q'''' and q''' that a segment adds to the jumps at its ends, by (q0, q1, v0, v1, a0, a1)."""
STIFFNESS, LOAD = _JUMPS[:, 2:], -_JUMPS[:, 1]
"""Of velocities and accelerations, and of the step (q₀ = 0, q₁ = Δq) on the other side."""
LOAD_POWERS = np.array([4, 4, 3, 3])
"""Powers of r = 1/h in the rows of b: q'''' brings r⁴, q''' brings r³."""
POWERS = LOAD_POWERS[:, None] - np.array([1, 1, 2, 2])
"""Powers of r in M: a velocity comes with h, an acceleration with h²."""


@dataclass(frozen=True, eq=False)
class Task:
    """What all leaves with limits have in common."""

    steps: Array
    """By segment and joint."""
    limits: Array
    """By joint and order, from 1 on; inf if there is none."""
    total: float
    basis: ClassVar[Array] = HERMITE[1:]
    """Powers of s in a piece with (step, v0, v1, a0, a1)."""

    def cap(self, rows: Rows) -> Array:
        """Limit of each row."""
        return np.asarray(self.limits[rows[..., 1], rows[..., 2] - 1])


class Centre:
    """The splines at the centres of a batch of boxes: arrays (leaf, ...) in the docs' symbols.

    Parameters
    ----------
    low, high : ndarray, shape (leaf, segments)
    """

    def __init__(self, task: Task, low: Array, high: Array) -> None:
        need(
            bool((low > BRIEFEST).all() and (low <= high).all()),
            "a leaf that is too wide is not proved",
        )
        self.task, self.size, self.n = task, len(low), len(task.steps)
        ends = 1.0 / high, 1.0 / low
        self.r = 0.5 * (ends[0] + ends[1])
        self.e = 0.5 * (ends[1] - ends[0]) + 4.0 * SLACK * ends[1]
        need(bool((self.e < WIDEST * self.r).all()), "a leaf that is too wide is not proved")
        self._parts()
        # x⁰ and X by joint.
        load = self.load[:2, :, None] * task.steps.T[:, :, None]
        self.x0 = self._solve(self._placed(load[0]).sum(axis=2))
        moved = np.swapaxes(self.parted(self.x0) @ self.blocks[1], 1, 2)
        self.rise = rise = self._placed(load[1] - moved)
        self.slope = self._solve(rise.reshape(self.size, -1, rise.shape[-1])).reshape(rise.shape)

    def _parts(self) -> None:
        """Taylor coefficients of M and b, segment by segment, and R with RᵀR ≈ M0⁻¹."""
        # Unknowns of v₀, v₁, a₀ and a₁ of each segment; the last place is for those that are 0.
        way, order = np.arange(self.n)[:, None] + [0, 1, 0, 1], np.array([0, 0, 1, 1])
        self.places = list(np.where(way % self.n, 2 * (way - 1) + order, 2 * self.n - 2))
        powers, top = (x[..., None] ** np.arange(5) for x in (self.r, self.r + self.e))
        self.blocks = _taylor(STIFFNESS, POWERS, powers)[:4]
        self.m0 = self._assembled(self.blocks[0])
        self.load = _taylor(LOAD, LOAD_POWERS, powers)
        self.stiff_top = self._assembled(np.abs(STIFFNESS) * top[..., POWERS])
        self.load_top = self._placed(np.abs(LOAD) * top[..., LOAD_POWERS])
        try:
            self.root = np.linalg.inv(np.linalg.cholesky(self.m0))
        except np.linalg.LinAlgError:
            raise Refused("the matrix of a leaf is not positive definite") from None

    def parted(self, vectors: Array) -> Array:
        """What vectors (leaf, vector, unknown) say of each segment: (leaf, segment, vector, 4)."""
        found = np.zeros((*vectors.shape[:-1], vectors.shape[-1] + 1))
        found[..., :-1] = vectors
        return np.swapaxes(found.take(self.places, axis=-1), 1, 2)

    def _placed(self, own: Array) -> Array:
        """What is said of each segment (..., segment, 4), by unknown: (..., segment, unknown)."""
        found = np.zeros((*own.shape[:-1], 2 * self.n - 1))
        for k, i in enumerate(self.places):
            found[..., k, i] = own[..., k, :]
        return found[..., :-1]

    def _assembled(self, blocks: Array) -> Array:
        """The matrix of all unknowns from those of the segments (leaf, segment, 4, 4)."""
        found = np.zeros((len(blocks), 2 * self.n - 1, 2 * self.n - 1))
        for k, i in enumerate(self.places):
            found[:, i[:, None], i] += blocks[:, k]
        return found[:, :-1, :-1]

    def pick(self, leaf: NDArray[Any], joint: int | slice = slice(None)) -> Centre:
        """Some of the boxes, and of one joint."""
        own = copy(self)
        for name, value in vars(self).items():
            if isinstance(value, np.ndarray):
                value = value[:, joint] if name in ("x0", "rise", "slope") else value
                ordered = name in ("blocks", "load", "turned", "pushed")
                setattr(own, name, value[:, leaf] if ordered else value[leaf])
        own.size = len(own.r)
        return own

    def _framed(self, matrix: Array) -> tuple[Array, Array]:
        """R A Rᵀ, and the largest row sum of its rounding."""
        back = np.swapaxes(self.root, 1, 2)
        rough = np.abs(self.root) @ np.abs(matrix) @ np.abs(back)
        return self.root @ matrix @ back, ROUND * rough.sum(axis=2).max(axis=1)

    def _spectrum(self) -> tuple[Array, Array]:
        """Bounds (s, c) with s RᵀR ≼ M(r)⁻¹ ≼ c RᵀR all over each box; nan where none is found.

        M_k(r) = t·T M_k(r⁰) T with t = r/r⁰, T = diag(t, t, 1, 1) on (v, v, a, a), hence
        1/c = (1 − max e/r⁰)(1 − √λ)²(1 − d) and 1/s = (1 + max e/r⁰)(1 + √λ)²(1 + d),
        d = ‖R M⁰ Rᵀ − 1‖, λ the largest eigenvalue against M⁰ of its velocity block weighted with
        (e_k/r⁰_k)²: at most the 16th root of ‖A¹⁶‖, A its frame.
        """
        frame, rounding = self._framed(self.m0)
        off = np.abs(frame - np.eye(frame.shape[1])).sum(axis=2).max(axis=1) + rounding
        share = self.e / self.r
        moving = self.blocks[0] * (share**2)[..., None, None]
        moving[..., 2:, :] = 0.0
        moving[..., 2:] = 0.0
        power, rounding = self._framed(self._assembled(moving))
        power = 0.5 * (power + np.swapaxes(power, 1, 2))
        largest, exponent = np.ones(self.size), 1.0
        for _ in range(5):
            norm = np.sqrt((power * power).sum(axis=(1, 2)))
            largest *= norm**exponent
            exponent *= 0.5
            power = power / norm[:, None, None]
            power = power @ power
        largest = (largest * (1.0 + 1e-9) + rounding) / (1.0 - off)
        found = (off < 1e-6) & (largest < 1.0)
        wide, root = share.max(axis=1), np.sqrt(np.where(found, largest, np.nan))
        least = (1.0 - wide) * (1.0 - root) ** 2 * (1.0 - off) * (1.0 - 1e-9)
        most = (1.0 + wide) * (1.0 + root) ** 2 * (1.0 + off) * (1.0 + 1e-9)
        return 1.0 / most, 1.0 / least

    def _solve(self, right: Array) -> Array:
        return np.asarray(right @ np.swapaxes(self.root, 1, 2) @ self.root)

    def least(self, tau: Array, rows: Rows, weights: Array) -> Array:
        """Lower bound of each leaf's weighted sum; −inf if there is none.

        ``blame``, shape (leaf, segment), is left behind: by how much what was lost grows with the
        sides of a box, which proves nothing and tells where to cut.

        Parameters
        ----------
        tau : ndarray, shape (leaf,)
        rows : ndarray of int, shape (leaf, row, 5)
            Segment, joint, order, sign, place.
        weights : ndarray, shape (leaf, row)
        """
        n, r, e, task = self.n, self.r, self.e, self.task
        every, place = np.nonzero(weights)
        used, weight = rows[every, place], weights[every, place]
        k, j, order = used[:, 0], used[:, 1], used[:, 2]
        # Few digits: multiples of 2⁻⁵⁰ or so, every sum and product is exact.
        shape = (shapes(used, 6, QUINTIC_PLACES) @ task.basis.T) * weight[:, None]
        bent, moved = np.zeros((2, self.size, n))
        np.add.at(bent, (every, k), shape[:, 0] * task.steps[k, j])
        np.add.at(moved, (every, k), np.abs(shape[:, 0] * task.steps[k, j]))
        against = np.zeros((3, self.size, n))  # limits: constant, times r, times 1/r
        np.add.at(against, (np.array([0, 1, 0, 2])[order], every, k), task.cap(used) * weight)
        top, bottom = r + e, r - e
        size = (moved * top**2 + against[0] + against[1] * top + against[2] / bottom).sum(axis=1)
        size += np.abs(tau) * (task.total + (1.0 / bottom).sum(axis=1))
        # Taylor coefficients of what depends on one duration; joints add to them below.
        # 1/(r + δ) = 1/r − δ/r² + δ²/r³ − δ³/r⁴ + δ⁴/(r⁴(r + δ)).
        change = tau[:, None] - against[2]
        alone = [
            bent * r**2 - against[0] - against[1] * r + change / r,
            2.0 * bent * r - against[1] - change / r**2,
            bent + change / r**3,
            -change / r**4,
            np.zeros((self.size, n)),
        ]
        sums = {
            "alone": np.stack(alone, axis=1),
            "first": np.zeros((self.size, n)),
            "second": np.zeros((self.size, n, n)),
            "cubes": np.zeros((self.size, n, n, n)),
            "error": (np.abs(change) * e**4 / (r**4 * bottom)).sum(axis=1),
            "size": size,
            "blame": np.zeros((self.size, n)),
        }
        # R, R M_k,o for o ≥ 1, and R b_k,o for o ≥ 2, by what is said of each segment.
        self.sides = np.swapaxes(self.parted(self.root), 2, 3)
        self.turned = self.blocks[1:] @ self.sides
        self.pushed = (self.load[2:, :, :, None] @ self.sides)[:, :, :, 0]
        small, large = self._spectrum()
        middle, spread = 0.5 * (large + small), 0.5 * (large - small) + ROUND * large
        for joint in np.unique(j).tolist():
            mine = j == joint
            leaf, at = np.unique(every[mine], return_inverse=True)
            own, each = self.pick(leaf, joint), shape[mine, 1:]
            phi = np.zeros((2, own.size, n, 4))
            np.add.at(phi[0], (at, k[mine]), each)
            np.add.at(phi[1], (at, k[mine]), np.abs(each))
            parts = own._joint(task.steps[:, joint], phi, middle[leaf], spread[leaf])
            for name, part in parts.items():
                sums[name][leaf] += part
        self.blame, alone, cubes = sums["blame"], np.swapaxes(sums["alone"], 0, 1), sums["cubes"]
        same = np.arange(n)
        cubes[:, same, same, same] += alone[3] * e**3
        sums["second"][:, same, same] += 2.0 * alone[2]
        value = alone[0].sum(axis=1) - tau * task.total
        value += least_of_quadratic(sums["first"] + alone[1], sums["second"], e)
        error = sums["error"] + (np.abs(alone[4]) * e**4).sum(axis=1) + most_of_cubes(cubes)
        found = value - error * (1.0 + 1e-9) - 10.0 * ROUND * size
        return np.where(np.isfinite(found), found, -np.inf)

    def _joint(self, step: Array, phi: Array, middle: Array, spread: Array) -> dict[str, Array]:
        """One joint's part: F = φᵀx̃ + μᵀ(b − M x̃) + πᵀM⁻¹ρ, x̃ = x0 + Σ X_m δ_m.

        With π = φ − M μ and ρ = b − M x̃, πᵀM⁻¹ρ is ½(c + s)·(Rπ)ᵀ(Rρ) and what is at most
        ½(c − s)·‖Rπ‖‖Rρ‖. ``phi`` are those of velocities times r and of accelerations, then in
        absolute values. ``middle`` and ``spread`` are ½(c + s) and ½(c − s).
        """
        n, r, e, speed = self.n, self.r, self.e, phi[0] * [1, 1, 0, 0]
        x0, rise, slope = self.x0, self.rise, self.slope
        full = phi * np.stack([r, r + e])[..., None] ** [1, 1, 0, 0]
        right, high = self._placed(full).sum(axis=2)
        mu = self._solve(right[:, None])
        own = self.parted(np.concatenate([slope, x0[:, None], mu], axis=1))
        turned = own @ self.turned
        of_slope, of_x0, of_mu, mu = own[:, :, :n], own[:, :, n], own[:, :, n + 1], mu[:, 0]
        wide = np.abs(x0) + np.einsum("lm,lmi->li", e, np.abs(slope))
        reach = np.einsum("lki,k->li", self.load_top, np.abs(step))
        reach += np.einsum("lij,lj->li", self.stiff_top, wide)
        # π: constant, then Taylor parts of each segment.
        rest = right - np.einsum("lij,lj->li", self.m0, mu)
        weak = high + np.einsum("lij,lj->li", self.stiff_top, np.abs(mu))
        outer, loose = np.abs(self.root), np.abs(rest) + ROUND * weak
        swift = (speed[:, :, None] @ self.sides)[:, :, 0]
        adjoint = Part(
            (swift - turned[0, :, :, -1]) * e[:, :, None],
            turned[1, :, :, -1] * -(e**2)[:, :, None],
            (_length(turned[2, :, :, -1]) * e**3).sum(axis=1)
            + _length(np.einsum("lij,lj->li", outer, loose)),
        )
        # ρ: constant and linear parts, which are 0 but for rounding; then, o ≥ 2,
        # (b_o − M_o x0 − M_(o−1) X_k) δ_kᵒ of each segment k, and −M_o X_m δ_kᵒ δ_m for m ≠ k.
        zero = self._placed(self.load[0] * step[:, None]).sum(axis=1)
        zero -= np.einsum("lij,lj->li", self.m0, x0)
        linear = rise - slope @ self.m0
        loose = np.abs(zero) + np.einsum("lm,lmi->li", e, np.abs(linear)) + ROUND * reach
        each, (k, m) = np.arange(n), np.triu_indices(n, 1)
        k, m = np.append(each, k), np.append(each, m)
        flat = turned[0].reshape(self.size, n * (n + 2), -1)
        square = -flat.take((n + 2) * k + m, axis=1)
        square[:, n:] -= flat.take(((n + 2) * m + k)[n:], axis=1)
        third, fourth = (-turned[1:, :, :, :n]).reshape(2, self.size, n * n, -1)
        alone = self.pushed * step[:, None]
        alone[:2] -= turned[1:, :, :, n]
        square[:, :n] += alone[0]
        third[:, :: n + 1] += alone[1]
        fourth[:, :: n + 1] += alone[2]
        wide_3 = e[:, :, None] ** 2 * e[:, None]
        flat_3 = wide_3.reshape(self.size, -1)
        residual = Part(
            square * (e.take(k, axis=1) * e.take(m, axis=1))[:, :, None],
            third * flat_3[:, :, None],
            (_length(fourth) * flat_3 * e.repeat(n, axis=1)).sum(axis=1)
            + _length(np.einsum("lij,lj->li", outer, loose)),
        )
        moved = (self.blocks @ of_mu[..., None])[..., 0]
        curve = np.einsum("olka,lka->lok", self.load, of_mu) * step
        curve[:, :4] -= np.einsum("olka,lka->lok", moved, of_x0)
        curve[:, 0] += np.einsum("lka,lka->lk", full[0], of_x0)
        curve[:, 1] += np.einsum("lka,lka->lk", speed, of_x0)
        moved[1] -= speed
        mixed = -(of_slope @ moved[1:, ..., None])[..., 0]
        cubes = np.zeros((self.size, n, n, n))
        both = adjoint.leading @ np.swapaxes(residual.leading, 1, 2)
        cubes[:, :, k, m] = both * middle[:, None, None]
        cubes[:, each, each] += mixed[1] * wide_3
        error = middle * (ROUND * adjoint.lengths * residual.lengths + adjoint.beyond(residual))
        error += spread * adjoint.most * residual.most
        error += np.einsum("lkm,lk,lm->l", np.abs(mixed[2]), e**3, e)
        blame = (residual.shares * adjoint.most[:, None]) @ (np.eye(n)[k] + np.eye(n)[m])
        blame += adjoint.shares * residual.most[:, None]
        return {
            "alone": curve,
            "first": np.einsum("li,lmi->lm", rest, slope),
            "second": mixed[0] + np.swapaxes(mixed[0], 1, 2),
            "cubes": cubes,
            "error": error,
            "size": (high * wide).sum(axis=1) + (np.abs(mu) * reach).sum(axis=1),
            "blame": spread[:, None] * blame,
        }


def _length(vectors: Array) -> Array:
    """Norms along the last axis."""
    return np.asarray(np.sqrt(np.einsum("...i,...i->...", vectors, vectors)))


def _taylor(factors: Array, exponents: Rows, powers: Array) -> Array:
    """Coefficients of δᵒ in factors·(r + δ)^exponents, given powers of r: (o, leaf, segment, …)."""
    found = [
        np.vectorize(comb)(exponents, o) * factors * powers[..., np.maximum(exponents - o, 0)]
        for o in range(powers.shape[-1])
    ]
    return np.stack(found)


class Part:
    """Rπ or Rρ over each box: vectors of two orders with factors in [−1, 1], and a remainder.

    Parameters
    ----------
    leading, following : ndarray, shape (leaf, vector, unknown)
        Vectors of the lowest order, and of the next one.
    later : ndarray, shape (leaf,)
        Norm of the terms of higher order, and of what is 0 but for rounding, with all rounding.
    """

    def __init__(self, leading: Array, following: Array, later: Array) -> None:
        self.leading, self.following, self.later = leading, following, later
        self.lengths = _length(leading).sum(axis=1)
        self.second = _length(following).sum(axis=1)
        # ‖Σ x_i v_i‖² ≤ Σ |v_iᵀv_j|, to which each vector adds a share.
        each = np.abs(leading @ np.swapaxes(leading, 1, 2)).sum(axis=2)
        self.first: Array = np.sqrt(each.sum(axis=1) + ROUND * self.lengths**2)
        self.shares = each / np.maximum(self.first, 1e-300)[:, None]

    @property
    def most(self) -> Array:
        """The largest norm."""
        return np.asarray(self.first + self.second + self.later)

    def beyond(self, other: Part) -> Array:
        """The largest |xᵀy|, x of this part and y of the other, but for both lowest orders.

        |(Σ x_i v_i)ᵀ(Σ y_j w_j)| ≤ Σ |v_iᵀw_j| for all |x_i|, |y_j| ≤ 1.
        """
        near = np.abs(self.leading @ np.swapaxes(other.following, 1, 2)).sum(axis=(1, 2))
        near += np.abs(self.following @ np.swapaxes(other.leading, 1, 2)).sum(axis=(1, 2))
        near += ROUND * (self.lengths * other.second + self.second * other.lengths)
        near += self.second * other.second
        near += (self.first + self.second) * other.later + self.later * other.most
        return np.asarray(near)
