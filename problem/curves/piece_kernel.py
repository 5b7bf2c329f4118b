"""Compiled kernel of long motions: true extremes of every derivative over many pieces.

A piece whose coefficients cannot reach past what is found already is left at once, so that a
hundred thousand pieces cost little more than to look at them.
"""

from __future__ import annotations

import numpy as np

from .kernel import MAX_COEFFICIENTS, compiled, roots_in_unit

_ROUNDING = 32 * 2.0**-52
"""Relative to the sum of a polynomial's absolute terms: Horner's rounding for ten coefficients is
20 · 2⁻⁵³, and that of the place of an extremum is of second order."""


@compiled
def _derived(scaled, k, j, order, perm, b):  # type: ignore[no-untyped-def]
    """Coefficients of a derivative in s; returns their number, at least 1."""
    powers = scaled.shape[1]
    if order >= powers:
        b[0] = 0.0
        return 1
    for p in range(order, powers):
        b[p - order] = perm[p, order] * scaled[k, p, j]
    return powers - order


@compiled
def _at(b, n, s):  # type: ignore[no-untyped-def]
    value = b[n - 1]
    for i in range(n - 2, -1, -1):
        value = value * s + b[i]
    return value


@compiled
def _turns(b, n, d, work, roots):  # type: ignore[no-untyped-def]
    """Places in (0, 1) where a polynomial turns; returns their number."""
    for i in range(1, n):
        d[i - 1] = i * b[i]
    return roots_in_unit(d, n - 2, work, roots) if n > 2 else 0


@compiled
def _rounding(b, n, scale):  # type: ignore[no-untyped-def]
    """Bound on the rounding of every value on a piece."""
    terms = 0.0
    for i in range(n):
        terms += abs(b[i])
    return scale * _ROUNDING * terms


@compiled
def piece_extremes(scaled, durations, error, perm, found, place, inner, outer):  # type: ignore[no-untyped-def]
    """Least and largest value of derivatives 0 to 3 of every joint.

    ``scaled[piece, power, joint]`` are ascending in s; ``error[piece, order, joint]`` bounds what
    each derivative is off by, rounding apart. ``found[joint, order, side]`` gets the values,
    ``place[..., 0 and 1]`` piece and s, ``outer`` what no value is beyond, and ``inner`` what some
    value surely reaches, errors included.
    """
    b, d = np.empty(MAX_COEFFICIENTS), np.empty(MAX_COEFFICIENTS)
    roots = np.empty(MAX_COEFFICIENTS)
    work = np.empty((MAX_COEFFICIENTS, MAX_COEFFICIENTS))
    for ends in (found, inner, outer):
        ends[:, :, 0], ends[:, :, 1] = np.inf, -np.inf
    for k in range(scaled.shape[0]):
        for j in range(scaled.shape[2]):
            scale = 1.0
            for r in range(4):
                n = _derived(scaled, k, j, r, perm, b)
                spread = 0.0
                for i in range(1, n):
                    spread += abs(b[i])
                err = _rounding(b, n, scale) + error[k, r, j]
                top, bottom = (b[0] + spread) * scale, (b[0] - spread) * scale
                if (
                    top + err > found[j, r, 1]
                    or bottom - err < found[j, r, 0]
                    or top - err > inner[j, r, 1]
                    or bottom + err < inner[j, r, 0]
                ):
                    count = _turns(b, n, d, work, roots)
                    for m in range(count + 2):
                        s = 0.0 if m == 0 else (1.0 if m == count + 1 else roots[m - 1])
                        value = _at(b, n, s) * scale
                        if value < found[j, r, 0]:
                            found[j, r, 0] = value
                            place[j, r, 0, 0], place[j, r, 0, 1] = k, s
                        if value > found[j, r, 1]:
                            found[j, r, 1] = value
                            place[j, r, 1, 0], place[j, r, 1, 1] = k, s
                        inner[j, r, 0] = min(inner[j, r, 0], value + err)
                        inner[j, r, 1] = max(inner[j, r, 1], value - err)
                        outer[j, r, 0] = min(outer[j, r, 0], value - err)
                        outer[j, r, 1] = max(outer[j, r, 1], value + err)
                scale /= durations[k]


@compiled
def _near(v, n, start, end, least):  # type: ignore[no-untyped-def]
    """The place nearest to ``start`` where a speed that grows towards ``end`` exceeds ``least``.

    ``start`` itself if it does there, −1 if it nowhere does; else within 2⁻⁵⁰ of the way, on the
    far side.
    """
    if abs(_at(v, n, start)) > least:
        return start
    if not abs(_at(v, n, end)) > least:
        return -1.0
    low, high = start, end
    for _ in range(50):
        middle = 0.5 * (low + high)
        if abs(_at(v, n, middle)) > least:
            high = middle
        else:
            low = middle
    return high


@compiled
def one_sided_extreme(scaled, durations, error, perm, j, sign, rest, place):  # type: ignore[no-untyped-def]
    """Largest |acceleration| of a joint while its speed grows (``sign`` 1) or falls (−1).

    Returns that, what some instant surely reaches, and what none is above, errors included. Below
    the speed ``rest`` a joint counts as standing, and neither grows nor falls. ``place`` gets
    piece, s and the signed value.

    Between roots of speed, acceleration and jerk all three keep their signs, so that speed and
    acceleration are monotone there. Where the speed exceeds its error its sign is sure; on the rest
    of such an interval either sign counts for the bound above.
    """
    b, d = np.empty(MAX_COEFFICIENTS), np.empty(MAX_COEFFICIENTS)
    v = np.empty(MAX_COEFFICIENTS)
    roots = np.empty(MAX_COEFFICIENTS)
    cuts = np.empty(3 * MAX_COEFFICIENTS)
    work = np.empty((MAX_COEFFICIENTS, MAX_COEFFICIENTS))
    best, sure, most = 0.0, 0.0, 0.0
    for k in range(scaled.shape[0]):
        h = durations[k]
        nv = _derived(scaled, k, j, 1, perm, v)
        n = _derived(scaled, k, j, 2, perm, b)
        size = 0.0
        for i in range(n):
            size += abs(b[i])
        scale = 1.0 / (h * h)
        err = _rounding(b, n, scale) + error[k, 2, j]
        if size * scale + err <= best and size * scale - err <= sure:
            continue
        blur = (_rounding(v, nv, 1.0 / h) + error[k, 1, j]) * h
        # An acceleration below its own error may have either sign.
        most = max(most, 2.0 * err)
        cuts[0] = 0.0
        count = 1
        for one in range(3):
            if one == 0:
                m = roots_in_unit(v, nv - 1, work, roots)
            elif one == 1:
                m = roots_in_unit(b, n - 1, work, roots)
            else:
                m = _turns(b, n, d, work, roots)
            for i in range(m):
                cuts[count] = roots[i]
                count += 1
        cuts[count] = 1.0
        count += 1
        cuts[:count].sort()
        for i in range(count - 1):
            middle = 0.5 * (cuts[i] + cuts[i + 1])
            speed = _at(v, nv, middle)
            if abs(speed) + blur <= rest * h:
                continue
            slow, fast = cuts[i], cuts[i + 1]
            if abs(_at(v, nv, slow)) > abs(_at(v, nv, fast)):
                slow, fast = fast, slow
            known = _near(v, nv, slow, fast, blur)
            if abs(speed) > rest * h and sign * speed * _at(b, n, middle) > 0.0:
                for end in (cuts[i], cuts[i + 1]):
                    signed = _at(b, n, end) * scale
                    most = max(most, abs(signed) + err)
                    if abs(signed) > best:
                        best = abs(signed)
                        place[0], place[1], place[2] = k, end, signed
                if known >= 0.0:
                    sure = max(sure, abs(_at(b, n, known)) * scale - err)
                    sure = max(sure, abs(_at(b, n, fast)) * scale - err)
            elif known != slow and 2.0 * blur > rest * h:
                # Up to there the speed may have the other sign, and the joint not stand.
                far = fast if known < 0.0 else known
                for end in (slow, far):
                    most = max(most, abs(_at(b, n, end)) * scale + err)
    return best, sure, most
