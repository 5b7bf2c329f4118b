"""Lower bounds of weighted limits over boxes of any declared curve, many boxes at once.

The argument is that of docs/explanation/certificates-declared.md, with its symbols; arrays lead
with the box. Whatever solves an equation (Y ≈ S⁻¹, E ≈ D S⁻¹, x₀, μ, and the bounds v, ξ, w) is a
hint: its floats are taken as exact, and what it leaves over is bounded. All else is sums of
products with fewer than 8000 roundings on any path, 9e-13 of the same sum over absolute values:
`ROUND` of that sum is taken off, or added where a bound from above is wanted.
"""

from __future__ import annotations

from contextlib import suppress
from itertools import pairwise

import numpy as np

from .boxes import Array, Rows, least_of_quadratic, most_of_cubes, shapes
from .declared_form import Form
from .ranges import PLACES

ROUND = 1e-12
"""Of a sum over absolute values: more than its roundings can amount to."""
ROOM = 1e-6
"""By which hints are larger than the bounds that they are to pass as: far more than rounding."""
SLIGHT = 1e-30
"""Added to bounds that have to be positive: angles and the total are about 1 here."""
BRIEFEST = 1e-9
"""Durations in a leaf with limits are above it, in units of about the total: nothing underflows."""
LARGEST = 1e12
"""Of the entries of the hints, for the same reason; beyond, a leaf is not proved."""


class Task:
    """What all boxes have in common.

    Parameters
    ----------
    form : Form
    caps : ndarray, shape (2, joints, 4)
        Limits of orders 0 to 3 on the lower and the upper side, as sizes with the sign of the side
        taken off: σ q⁽ʳ⁾ ≤ caps[(1 + σ)/2]; inf if there is none.
    total : float
    """

    def __init__(self, form: Form, caps: Array, total: float) -> None:
        self.form, self.caps, self.total = form, caps, total
        self.segments, self.powers, self.unknowns = form.basis.shape
        self.joints, n = caps.shape[1], self.segments
        self.half = 0.5 * form.orders
        """κ = r/2 of each derivative that is to agree."""
        self.breaks = len(form.sides)
        self.at = np.zeros((self.unknowns, self.breaks))
        self.at[np.arange(self.unknowns), form.breaks] = 1.0
        ends = np.searchsorted(form.breaks, np.arange(self.breaks + 1))
        self.groups = [slice(int(a), int(b)) for a, b in pairwise(ends)]
        """What is to agree at each break."""
        before, behind = form.sides.T
        # Neighbours beyond an end are the last row, which does not move.
        segments = np.eye(n + 1, n)
        self.across = segments[behind] - segments[before]
        """ζ of the breaks from δ of the segments."""

    def cap(self, rows: Rows) -> Array:
        """Limit of each row."""
        return np.asarray(self.caps[(1 + rows[..., 3]) // 2, rows[..., 1], rows[..., 2]])


class Centre:
    """The curve at the centres of a batch of boxes.

    Parameters
    ----------
    low, high : ndarray, shape (box, segments)
    """

    def __init__(self, task: Task, low: Array, high: Array) -> None:
        self.task, form = task, task.form
        h = np.sqrt(low * high)
        self.h = h
        # Logarithm and quotient, and powers below, are near to their last digits.
        self.e = np.log(np.maximum(high / h, h / low)) * (1.0 + ROUND) + ROUND
        self.z = self.e @ np.abs(task.across).T
        self.u = task.half * self.z[:, form.breaks]
        self.t = np.tanh(self.u) * (1.0 + ROUND)
        before, behind = form.sides[form.breaks].T
        wide = np.concatenate([h, np.ones((len(h), 1))], axis=1)
        gain = (np.sqrt(wide[:, behind] / wide[:, before]) ** form.orders)[:, :, None]
        ends, starts, p = gain * form.ends, form.starts / gain, [task.unknowns]
        s_, s = np.split(ends - starts, p, axis=2)
        self.d_, d = np.split(ends + starts, p, axis=2)
        self.s_, self.s, self.d = s_, -s, -d
        self.top, self.fixed = np.split(np.abs(ends) + np.abs(starts), p, axis=2)
        self.y = inverted(s_)
        self.hint = self.d_ @ self.y
        self.x = -self.y @ s
        self.x += self.y @ (self.s - s_ @ self.x)
        self.g = self.d_ @ self.x - self.d
        self.usual = (low > BRIEFEST).all(axis=1) & (low <= high).all(axis=1)

    def _reach(self) -> None:
        """What the hints leave over, with all rounding, and bounds that are to hold all over."""
        s_, top, fixed = self.s_, self.top, self.fixed
        one, hint, y = np.eye(self.task.unknowns), np.abs(self.hint), np.abs(self.y)
        self.rest = np.abs(self.s - s_ @ self.x) + ROUND * (fixed + top @ np.abs(self.x))
        inverse = np.abs(one - self.y @ s_) + ROUND * (one + y @ top)
        slope = np.abs(self.d_ - self.hint @ s_) + ROUND * (top + hint @ top)
        loose = hint @ self.rest + ROUND * (fixed + top @ np.abs(self.x))
        # |g| ≤ v and |x − x₀| ≤ ξ: see the page.
        self.pull = hint * self.t[:, None, :]
        size = np.abs(self.g)
        least = 1e-9 * size.max(axis=1, keepdims=True, initial=0.0) + SLIGHT
        self.v = self._reached(size + loose + least)
        self.xi = (1.0 + ROOM) * (y @ (self.rest + self.t[:, :, None] * self.v)) + SLIGHT
        more = (1.0 + ROUND) * (size + loose + SLIGHT + slope @ self.xi + self.pull @ self.v)
        held = (self.v > more).all(axis=(1, 2))
        more = y @ (self.rest + self.t[:, :, None] * self.v) + inverse @ self.xi
        held &= (self.xi > (1.0 + ROUND) * (more + 0.5 * SLIGHT)).all(axis=(1, 2))
        usual = np.maximum(hint, y).max(axis=(1, 2), initial=0.0) < LARGEST
        self.held = held & usual & self.usual
        self.slack = loose + slope @ self.xi

    def _reached(self, from_: Array) -> Array:
        """A little more than (1 − |E| T)⁻¹ of bounds; not positive where there is no such bound."""
        one = np.eye(self.task.unknowns)
        return np.asarray((1.0 + ROOM) * (inverted(one - self.pull) @ from_))

    def least(self, tau: Array, rows: Rows, weights: Array) -> Array:
        """Lower bound of each box's sum of weighted limits and τ (Σ h/total − 1); −inf for none.

        Parameters
        ----------
        tau : ndarray, shape (box,)
        rows : ndarray of int, shape (box, row, 5)
            Segment, joint, order, sign, place.
        weights : ndarray, shape (box, row)
            ≥ 0; a limit of order 1 or more counts as 1 at the centre of its segment.
        """
        self._reach()
        task, form, n = self.task, self.task.form, self.task.segments
        segment, joint, order = rows[..., 0], rows[..., 1], rows[..., 2]
        box = np.arange(len(tau))[:, None]
        cap = task.cap(rows)
        here = np.where(weights > 0.0, cap, 1.0)
        share = np.where(order > 0, weights / (here * self.h[box, segment] ** order), weights)
        shape = shapes(rows, task.powers, PLACES) * share[..., None]
        against = np.where(order > 0, weights, weights * here)
        # φ by joint, its constant, and both over absolute values.
        phi = np.zeros((len(tau), task.joints, task.unknowns))
        phi_top = np.zeros_like(phi)
        basis, fixed = form.basis[segment], form.fixed[segment, :, joint]
        np.add.at(phi, (box, joint), np.einsum("lcp,lcpx->lcx", shape, basis))
        np.add.at(phi_top, (box, joint), np.einsum("lcp,lcpx->lcx", np.abs(shape), np.abs(basis)))
        value = (shape * fixed).sum(axis=(1, 2)) - against.sum(axis=1) - tau
        size = (np.abs(shape * fixed)).sum(axis=(1, 2)) + np.abs(against).sum(axis=1) + np.abs(tau)
        value += np.einsum("ljx,lxj->l", phi, self.x)
        size += np.einsum("ljx,lxj->l", phi_top, np.abs(self.x))
        mu = phi @ self.y
        size_mu = np.abs(mu)
        left = np.abs(phi - mu @ self.s_) + ROUND * (phi_top + size_mu @ self.top)
        error = np.einsum("ljx,lxj->l", left, self.xi)
        error += np.einsum("ljp,lpj->l", size_mu, self.rest)
        # δ_g of the page, three times as it comes in.
        slack = self.slack + self.pull @ (self.slack + self.pull @ self.slack)
        error += np.einsum("ljp,lp,lpj->l", size_mu, self.t, slack)
        error += self._tail(mu)
        one, two, three, rest, big = self._orders(mu)
        error += rest
        size += big
        gradient = one @ task.across
        bend = task.across.T @ (two + np.swapaxes(two, 1, 2)) @ task.across
        for _ in range(3):  # from breaks to segments, one place after the other
            three = np.tensordot(three, task.across, (1, 0))
        # Limits W e^{rδ} and the total, which depend on one duration each.
        each = np.arange(n)
        lasting = tau[:, None] * self.h / task.total
        value += lasting.sum(axis=1)
        parts = [(1, lasting)]
        for r in range(1, 4):
            held = np.zeros((len(tau), n))
            np.add.at(held, (box, segment), np.where(order == r, weights, 0.0))
            parts.append((r, -held))
        for r, factor in parts:
            gradient += r * factor
            bend[:, each, each] += r * r * factor
            three[:, each, each, each] += r**3 / 6.0 * factor
            wide = r * self.e
            top = np.abs(factor)
            error += (top * wide**4 / 24.0 * np.exp(wide)).sum(axis=1)
            size += (top * (1.0 + wide + wide**2 + wide**3)).sum(axis=1)
        e = self.e
        three *= e[:, :, None, None] * e[:, None, :, None] * e[:, None, None]
        error += most_of_cubes(three)
        value += least_of_quadratic(gradient, bend, e)
        found = value - error * (1.0 + 1e-9) - 2.0 * ROUND * size
        there = np.isfinite(here).all(axis=1) & self.held
        return np.where(there & np.isfinite(found), found, -np.inf)

    def _tail(self, mu: Array) -> Array:
        """At most |μᵀ ΘE ΘE ΘE Θ g|, as âᵀw with a = μᵀΘEΘ and w ≥ |(1 + EΘ)⁻¹ EΘEΘ g₀|.

        Orders of one break move together: what they add up to counts.
        """
        task, u, t, z = self.task, self.u, self.t, self.z
        hint = np.abs(self.hint)
        off = u**3 / 3.0
        # EΘg₀ by the break of Θ, and what replacing θ by κζ leaves over.
        slope = self.hint * task.half
        by = np.stack([slope[:, :, one] @ self.g[:, one] for one in task.groups], axis=2)
        loose = np.einsum("lsp,lp,lpj->lsj", hint, off, np.abs(self.g))
        flat = by.reshape(*by.shape[:2], -1)
        twice = np.stack([slope[:, :, one] @ flat[:, one] for one in task.groups], axis=2)
        twice = twice.reshape(*twice.shape[:3], *by.shape[2:])
        twice = 0.5 * (twice + np.swapaxes(twice, 2, 3))
        top = np.einsum("lscbj,lc,lb->lsj", np.abs(twice), z, z)
        top += hint @ (off[:, :, None] * np.einsum("lqbj,lb->lqj", np.abs(by), z))
        top += self.pull @ loose
        moved = u[:, :, None] * (hint @ (u[:, :, None] * np.abs(self.g)))
        top += ROUND * (hint @ moved) + self.pull @ (self.pull @ self.slack) + SLIGHT
        w = self._reached(top)
        held = (w > (1.0 + ROUND) * (top + self.pull @ w)).all(axis=(1, 2))
        size = np.abs(mu)
        moved = mu * task.half
        first = np.stack([moved[:, :, one] @ self.hint[:, one] for one in task.groups], axis=3)
        a = np.einsum("ljqb,lb->ljq", np.abs(first), z)
        a += (size * off[:, None, :]) @ hint + ROUND * ((size * u[:, None, :]) @ hint)
        tail = np.einsum("ljq,lq,lqj->l", a, t, w)
        return np.where(held, tail, np.inf)

    def _orders(self, mu: Array) -> tuple[Array, Array, Array, Array, Array]:
        """Taylor parts in ζ of −μᵀΘg₀ + μᵀΘEΘg₀ − μᵀΘEΘEΘg₀ of orders 1 to 3.

        Also what replacing tanh by its series leaves over, and the sum over absolute values.
        """
        task, u, e = self.task, self.u, self.hint
        at, size_e = task.at, np.abs(self.hint)
        q = np.einsum("ljp,lqj->lpq", mu, self.g)
        top = np.einsum("ljp,lqj->lpq", np.abs(mu), np.abs(self.g))
        half, diagonal = task.half, np.einsum("lpp->lp", q)
        one = -(diagonal * half) @ at
        pair = q * e * half[:, None] * half
        two = at.T @ pair @ at
        turned = np.swapaxes(e * half[:, None], 1, 2)
        moved = np.stack([turned[:, :, one] @ q[:, one] for one in task.groups], axis=2)
        moved = (moved * (e * half)[:, :, None, :]) @ at
        three = -np.einsum("lqbd,qc->lbcd", moved, at * half[:, None])
        b = np.arange(task.breaks)
        three[:, b, b, b] += (diagonal * half**3 / 3.0) @ at
        size = np.abs(q)
        spot = np.einsum("lpp->lp", size)
        rest = (spot * u**5).sum(axis=1) * (2.0 / 15.0)
        cube = u**3
        through = (size_e * u[:, None, :]) @ size_e
        both = size * (size_e + through)
        rest += np.einsum("lpq,lp,lq->l", both, cube, u) / 3.0
        rest += np.einsum("lpq,lp,lq->l", both, u, cube) / 3.0
        third = (size_e * cube[:, None, :]) @ size_e
        rest += np.einsum("lps,lp,ls->l", size * third, u, u) / 3.0
        big = (np.einsum("lpp->lp", top) * (u + cube)).sum(axis=1)
        big += np.einsum("lpq,lp,lq->l", top * (size_e + through), u, u)
        return one, two, three, rest, big


def inverted(matrices: Array) -> Array:
    """Hints at inverses; nan for what has none."""
    try:
        return np.asarray(np.linalg.inv(matrices))
    except np.linalg.LinAlgError:
        found = np.full_like(matrices, np.nan)
        for at, one in enumerate(matrices):
            with suppress(np.linalg.LinAlgError):
                found[at] = np.linalg.inv(one)
        return found
