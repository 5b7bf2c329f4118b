"""The largest acceleration while the speed grows, or while it falls, and what errors change."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..arrays import Array
from ..curves import Trajectory, bernstein, derived, roots_in_unit, valued


@dataclass(frozen=True)
class OneSided:
    """The largest |acceleration| of a joint on one side."""

    piece: int
    s: float
    value: float
    """Where on the piece, and what stands there, signed."""
    sure: float
    """Size that some instant surely reaches, errors included."""
    most: float
    """Size that none is above."""


def one_sided_extreme(
    trajectory: Trajectory, errors: Array, joint: int, sign: float, rest: float, part: int = 4096
) -> OneSided:
    """Largest |acceleration| of a joint while its speed grows (``sign`` 1) or falls (−1).

    Below the speed ``rest`` a joint counts as standing, and neither grows nor falls. Between roots
    of speed, acceleration and jerk all three keep their signs, so speed and acceleration are
    monotone there. Where the speed exceeds its error its sign is sure; on the rest of such an
    interval either sign counts for the bound above.

    Parameters
    ----------
    errors : ndarray, shape (pieces, orders, joints)
        Bound on what each derivative is off by, its rounding included.
    rest : float
        rad/s.
    part : int
        Pieces looked at together, those that may reach furthest first; most motions need one part.
    """
    v, a = (trajectory.derivatives(r)[:, :, joint] for r in (1, 2))
    blur, err = errors[:, 1, joint], errors[:, 2, joint]
    size = np.abs(bernstein(a)).max(axis=0)
    order = np.argsort(-(size + err), kind="stable")
    found = OneSided(0, 0.0, 0.0, 0.0, 0.0)
    for start in range(0, order.size, part):
        k = order[start : start + part]
        best = abs(found.value)
        if (size + err)[k[0]] <= best and (size - err)[order[start:]].max() <= found.sure:
            break
        here = _part(v[:, k], a[:, k], blur[k], err[k], sign, rest)
        # An acceleration below its own error may have either sign.
        unsure = float(np.minimum(2.0 * err[k], size[k] + err[k]).max())
        place = found if abs(here.value) <= best else here
        piece = found.piece if place is found else int(k[here.piece])
        found = OneSided(
            piece=piece,
            s=place.s,
            value=place.value,
            sure=max(found.sure, here.sure),
            most=max(found.most, here.most, unsure),
        )
    return found


def signed_parts(v: Array, a: Array) -> tuple[Array, Array, Array, Array]:
    """Pieces cut where speed, acceleration or jerk is 0, of shape (intervals, pieces).

    From coefficients of speed and acceleration, powers first. Ends of the intervals, and, at their
    middles, the speed and its product with the acceleration: above 0 the speed grows. Where there
    are fewer, the last intervals have no length.
    """
    roots = [roots_in_unit(one) for one in (v, a, derived(a, 1))]
    edge = np.zeros((1, v.shape[1]))
    inner = np.nan_to_num(np.concatenate(roots), nan=1.0)
    cuts = np.sort(np.concatenate([edge, inner, edge + 1.0]), axis=0)
    low, high = cuts[:-1], cuts[1:]
    middle = 0.5 * (low + high)
    speed = valued(v[:, None], middle)
    return low, high, speed, speed * valued(a[:, None], middle)


def one_sided_sizes(v: Array, a: Array) -> Array:
    """Largest |acceleration| of each piece while its speed grows, and while it falls; (2, pieces).

    From coefficients of speed and acceleration, powers first, without a bound on errors.
    """
    low, high, _, growth = signed_parts(v, a)
    tops = np.maximum(*(np.abs(valued(a[:, None], end)) for end in (low, high)))
    wide = low < high
    sides = [np.where(wide & (sign * growth > 0.0), tops, 0.0) for sign in (1.0, -1.0)]
    return np.asarray(np.max(sides, axis=1))


def _part(v: Array, a: Array, blur: Array, err: Array, sign: float, rest: float) -> OneSided:
    """The same of some pieces, powers first, apart from accelerations below their own error."""
    low, high, speed, growth = signed_parts(v, a)
    moving = (low < high) & (np.abs(speed) + blur > rest)
    turned = np.abs(valued(v[:, None], low)) > np.abs(valued(v[:, None], high))
    slow, fast = np.where(turned, high, low), np.where(turned, low, high)
    known = _near(v, slow, fast, blur)
    at_slow, at_fast = (np.abs(valued(a[:, None], one)) for one in (slow, fast))
    at_known = np.where(np.isnan(known), -np.inf, np.abs(valued(a[:, None], known)))
    counted = moving & (np.abs(speed) > rest) & (sign * growth > 0.0)
    top = np.where(counted, np.maximum(at_slow, at_fast), 0.0)
    surely = counted & ~np.isnan(known)
    sure = np.where(surely, np.maximum(at_known, at_fast) - err, 0.0)
    # Up to where it is known the speed may have the other sign, and the joint not stand.
    either = moving & ~counted & ~(known == slow) & (2.0 * blur > rest)
    far = np.where(np.isnan(known), at_fast, at_known)
    most = np.where(counted, top + err, np.where(either, np.maximum(at_slow, far) + err, 0.0))
    m, k = np.unravel_index(int(top.argmax()), top.shape)
    end = (fast if at_fast[m, k] > at_slow[m, k] else slow)[m, k]
    value = float(valued(a[:, k], end)) if top[m, k] > 0.0 else 0.0
    return OneSided(int(k), float(end), value, float(sure.max()), float(most.max()))


def _near(v: Array, start: Array, end: Array, least: Array) -> Array:
    """The place nearest to ``start`` where a speed that grows towards ``end`` exceeds ``least``.

    ``start`` itself if it does there, NaN if it nowhere does; else within 2⁻⁵⁰ of the way, on the
    far side.
    """
    found = np.where(np.abs(valued(v[:, None], start)) > least, start, np.nan)
    crossing = np.isnan(found) & (np.abs(valued(v[:, None], end)) > least)
    if crossing.any():
        lane = np.nonzero(crossing)[1]
        low, high, a, floor = start[crossing], end[crossing], v[:, lane], least[lane]
        for _ in range(50):
            middle = 0.5 * (low + high)
            beyond = np.abs(valued(a, middle)) > floor
            low, high = np.where(beyond, low, middle), np.where(beyond, middle, high)
        found[crossing] = high
    return found
