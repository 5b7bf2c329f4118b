"""Verdicts on motions of every reader and interpolation, against rational arithmetic.

A trial draws a motion, writes it as a program would, reads the file, and judges it against limits
beside its exact peaks. Two motions must agree with what is said: the one that was drawn, and the
one that the written numbers are; both are what the file may stand for.
"""

from dataclasses import replace
from fractions import Fraction
from itertools import pairwise
from pathlib import Path

import numpy as np
from support.exact_motions import Curve, Row
from trajgap.problem import TrajgapError, Verdict, motions

from attacks.attack import demand, keep
from attacks.cases import Rng
from attacks.motion_files import (
    READERS,
    polynomials,
    sampled,
    some_curve,
    some_file,
    some_times,
    through,
)

_TOLERANCE = Fraction(motions.MOTION_TOLERANCE)
"""Excess that counts as kept."""
_DIGIT = Fraction(1, 10**15)
"""Relative: limits and tolerances are rounded to float64."""
_NEAR = (1e-12, 1e-9, 1e-7, 1e-6, 1e-5, 1e-4, 1e-3, 0.03, 0.5)
"""How far from a peak its limit is, relatively."""
_STILL = Fraction(1, 10**6)
"""Share of a joint's largest speed below which it may count as standing."""


def excess(
    given: motions.JointLimits, curves: list[Curve], still: Fraction, slower: Fraction
) -> Fraction:
    """Largest peak over its limit, less 1; of positions over half of their range."""
    most = Fraction(-1)
    for j, curve in enumerate(curves):
        ranges = curve.ranges
        braking = float(given.deceleration[j])
        for r, (low, high) in enumerate(ranges):
            lower, upper = float(given.lower[j, r]), float(given.upper[j, r])
            if r == 2 and np.isfinite(braking):
                top = max(abs(x) for x in ranges[1])
                sides = zip(curve.one_sided(still * top), (upper, braking), strict=True)
                for peak, limit in sides:
                    if np.isfinite(limit):
                        most = max(most, peak / slower**2 / Fraction(limit) - 1)
                continue
            for end, limit, sign in ((high, upper, 1), (low, lower, -1)):
                if not np.isfinite(limit):
                    continue
                if r == 0:
                    half = (Fraction(upper) - Fraction(lower)) / 2
                    most = max(most, sign * (end - Fraction(limit)) / half)
                else:
                    most = max(most, sign * end / slower**r / abs(Fraction(limit)) - 1)
    return most


def _limits(rng: Rng, curves: list[Curve], factor: Fraction) -> motions.JointLimits | None:
    """One limit near its peak, the others some way off or none, one-sided ones among them."""
    count = len(curves)
    lower, upper = np.full((count, 4), -np.inf), np.full((count, 4), np.inf)
    braking = np.full(count, np.inf)
    ranges = [one.ranges for one in curves]
    for j in range(count):
        for r in range(4):
            low, high = (float(x * factor) for x in ranges[j][r])
            size = max(abs(low), abs(high))
            if size == 0.0 or (r and rng.random() < 0.4) or (r == 0 and rng.random() < 0.6):
                continue
            wide = float(rng.uniform(1.2, 3.0)) * size
            lower[j, r], upper[j, r] = -wide, wide
            if r and rng.random() < 0.3:
                if rng.random() < 0.5:
                    lower[j, r] = -np.inf
                else:
                    upper[j, r] = np.inf
    j, r = int(rng.integers(count)), int(rng.integers(4))
    near = 1.0 + float(rng.choice(_NEAR)) * float(rng.choice([-1.0, 1.0]))
    if rng.random() < 0.5:
        near /= 1.0 + 1e-6
    low, high = (float(x * factor) for x in ranges[j][r])
    side = int(abs(high) >= abs(low)) if rng.random() < 0.8 else int(rng.integers(2))
    end = high if side else low
    if (r and (end > 0) != bool(side)) or end == 0.0 or not np.isfinite(end * near):
        return None
    if r == 0:
        middle = 0.5 * (low + high)
        half = 0.5 * (high - low) * near
        if not half > 1e-9 * abs(middle):
            return None
        lower[j, 0], upper[j, 0] = middle - half, middle + half
    else:
        (upper if side else lower)[j, r] = end * near
    if rng.random() < 0.15:
        grows, falls = (float(x * factor) for x in curves[j].one_sided(Fraction(0)))
        if grows > 0 and falls > 0:
            scale = (near, 2.0) if rng.random() < 0.5 else (2.0, near)
            upper[j, 2], braking[j] = grows * scale[0], falls * scale[1]
            lower[j, 2] = -upper[j, 2]
    names = tuple(f"j{k + 1}" for k in range(count))
    return motions.JointLimits(names, lower, upper, braking)


def _scaled(curves: list[Curve], factor: Fraction) -> list[Curve]:
    if factor == 1:
        return curves
    return [Curve(one.breaks, [[factor * x for x in c] for c in one.pieces]) for one in curves]


_FACTORS = {"rad": 1.0, "deg": np.pi / 180.0, "mm": 1e-3}
"""What a number in a unit is in rad or m."""


def verdicts(rng: Rng, folder: Path) -> str | None:
    """One motion through one reader and one interpolation."""
    reader = str(rng.choice(READERS, p=[0.36, 0.14, 0.16, 0.1, 0.08, 0.16]))
    how = str(rng.choice([str(x) for x in motions.Interpolation]))
    count = int(rng.integers(4, 9))
    times = some_times(rng, count)
    bases = [some_curve(rng, times) for _ in range(int(rng.integers(1, 3)))]
    rough = rng.random() < 0.5 and how != "none"
    drawn = [sampled(rng, base, times, rough) for base in bases]
    if rng.random() < 0.1:
        still = drawn[0][0].values[0]
        drawn[0] = [Row(r.time, (still, Fraction(0), Fraction(0))) for r in drawn[0]]
        bases[0] = Curve([drawn[0][0].time, drawn[0][-1].time], [[still]])
    between = "quintic" if how == "controller" else how
    keep(folder, case=f"{reader} {how}")
    if reader == "polynomials":
        how = between = str(rng.choice(["linear", "cubic", "quintic", "spline"]))
        truths, path = polynomials(rng, [through(one, how) for one in drawn], folder)
        meant, units, stated = [truths], "rad", {}
        how = "polynomials"
    else:
        written = some_file(rng, reader, how, drawn, folder)
        path, units = written.path, written.units
        stated = {"time_noise": written.time_noise}
        if written.noise is not None:
            stated["noise"] = (written.noise,)
        rows = pairwise(written.drawn[0]), pairwise(written.shown[0])
        ordered = all(a.time < b.time for pairs in rows for a, b in pairs)
        if not ordered:
            return "samples at one time"
        if how == "none":
            # The curve itself goes through what was drawn, and through nothing else.
            meant = [bases] if written.drawn is drawn else []
        else:
            meant = [[through(j, between) for j in t] for t in (written.drawn, written.shown)]
    factor = Fraction(_FACTORS[units])
    meant = [_scaled(one, factor) for one in meant]
    aim = meant[int(rng.integers(len(meant)))] if meant else _scaled(bases, factor)
    limits = _limits(rng, aim, Fraction(1))
    if limits is None:
        return None
    keep(folder, limits=f"{limits.lower}\n{limits.upper}\n{limits.deceleration}")
    try:
        content = motions.read_motion(path, (units,), **stated).content  # type: ignore[arg-type]
        asked = replace(limits, joints=content.joints)
        if isinstance(content, motions.Motion):
            found = motions.check_motion(content, asked)
        elif how == "none":
            found = motions.check_samples(content, asked)
        else:
            found = motions.check_motion(
                motions.interpolated(content, motions.Interpolation(how)), asked
            )
    except TrajgapError:
        return f"{reader} {how}: refused"
    word = f"{reader} {how}: {found.verdict}"
    for curves in meant:
        over = excess(limits, curves, _STILL, Fraction(1)) > _TOLERANCE + _DIGIT
        kept = excess(limits, curves, Fraction(0), Fraction(1)) <= _TOLERANCE - _DIGIT
        demand(not (over and found.limits is Verdict.PASS), f"{word}, and a peak exceeds")
        demand(not (kept and found.limits is Verdict.VIOLATED), f"{word}, and every peak keeps")
        _continuous(curves, how, found.verdict, word)
        if found.feasible_time is not None:
            slow = Fraction(found.stretch)
            left = excess(limits, curves, _STILL, slow)
            demand(left <= 3 * _TOLERANCE, f"{word}, and the repair leaves {float(left):.3g}")
    demand(not (how == "none" and found.verdict is Verdict.PASS), "samples alone pass")
    return word


def _continuous(curves: list[Curve], how: str, verdict: Verdict, word: str) -> None:
    """No pass where the speed jumps, no jump told of a curve that has none."""
    for curve in curves:
        speed = max(abs(x) for x in curve.ranges[1])
        if curve.jumps(1) > speed / 10**6:
            demand(verdict is not Verdict.PASS, f"{word}, and the speed jumps")
    if verdict is Verdict.DISCONTINUOUS:
        jumping = any(curve.jumps(order) > 0 for curve in curves for order in range(3))
        demand(jumping and how not in ("spline", "quintic"), f"{word}, and nothing jumps")
