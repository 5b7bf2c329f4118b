"""Verdicts on motions of every reader and interpolation, against rational arithmetic.

A trial draws a motion, writes it as a program would, reads the file, and judges it against limits
beside its exact peaks. Two motions must agree with what is said: the one that was drawn, and the
one that the written numbers are; both are what the file may stand for.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from support.exact_motions import Curve, Row, hermite, spline
from trajgap.problem import TrajgapError, Verdict
from trajgap.problem.motions import (
    MOTION_TOLERANCE,
    Interpolation,
    JointLimits,
    Motion,
    check_motion,
    check_samples,
    interpolated,
    read_motion,
)

from attacks.attack import demand, keep
from attacks.cases import Rng

READERS = ("csv", "parquet", "json", "yaml", "bag", "polynomials")
"""Files that motions are read from: tables, ROS messages, polynomials."""
_TOLERANCE = Fraction(MOTION_TOLERANCE)
"""Excess that counts as kept."""
_DIGIT = Fraction(1, 10**15)
"""Relative: limits and tolerances are rounded to float64."""
_NEAR = (1e-12, 1e-9, 1e-7, 1e-6, 1e-5, 1e-4, 1e-3, 0.03, 0.5)
"""How far from a peak its limit is, relatively."""
_STILL = Fraction(1, 10**6)
"""Share of a joint's largest speed below which it may count as standing."""
_DEGREES = {"linear": 1, "cubic": 3, "quintic": 5}
"""Of the polynomials between two rows."""

Table = list[list[Row]]
"""Rows of each joint."""


@dataclass(frozen=True)
class Written:
    """A motion as drawn, and as it stands in the file, in the file's unit."""

    drawn: Table
    shown: Table
    path: Path
    units: str
    noise: float | None
    time_noise: float | None


def _times(rng: Rng, count: int) -> list[float]:
    each = rng.uniform(0.2, 1.0, count)
    match int(rng.integers(4)):
        case 0:
            each[:] = 1.0
        case 1:
            each[int(rng.integers(1, count))] *= 10.0 ** -int(rng.integers(1, 7))
    scale = 10.0 ** float(rng.choice([-2, -1, 0, 0, 1]))
    start = float(rng.choice([0.0, 0.0, 7.5, 1000.0]))
    return [float(x) for x in start + scale * (np.cumsum(each) - each[0])]


def _curve(rng: Rng, times: list[float]) -> Curve:
    """A spline over fewer knots than there are samples, of any size."""
    knots = np.linspace(times[0], times[-1], int(rng.integers(4, 7)))
    knots[1:-1] += 0.3 * (knots[1] - knots[0]) * rng.uniform(-1, 1, knots.size - 2)
    size = 10.0 ** float(rng.choice([-3, 0, 0, 2]))
    exact = [Fraction(float(x)) for x in knots]
    return spline(exact, [Fraction(float(x)) for x in size * rng.normal(size=knots.size)])


def _sampled(rng: Rng, curve: Curve, times: list[float], rough: bool) -> list[Row]:
    """Samples of a curve; rough ones have derivatives of their own."""
    rows = []
    for t in map(Fraction, times):
        found = [float(curve.at(t, order)) for order in range(3)]
        if rough:
            found = [x * float(rng.uniform(0.5, 1.5)) for x in found]
        q, v, a = map(Fraction, found)
        rows.append(Row(t, (q, v, a)))
    return rows


def _through(rows: list[Row], how: str) -> Curve:
    if how == "spline":
        return spline([one.time for one in rows], [one.values[0] for one in rows])
    return hermite(rows, _DEGREES[how])


# --- files ----------------------------------------------------------------------------------------


def _form(rng: Rng, reader: str) -> str:
    if reader in ("parquet", "bag"):
        return ""
    fixed, short = int(rng.integers(2, 11)), int(rng.integers(3, 15))
    if reader in ("json", "yaml"):
        return str(rng.choice(["", f".{fixed}f"]))
    return str(rng.choice(["", ".17e", f".{fixed}f", f".{short}g", f".{short}e"]))


def _text(x: float, form: str) -> str:
    return format(x, form) if form else repr(x)


def _written(rows: Table, form: str, clock: str) -> Table:
    """The rows as their text says; of a message the whole nanoseconds of its times."""

    def number(x: Fraction) -> Fraction:
        return Fraction(_text(float(x), form))

    def moment(x: Fraction) -> Fraction:
        return (
            Fraction(round(x * 10**9), 10**9) if clock == "ns" else Fraction(_text(float(x), clock))
        )

    return [
        [Row(moment(r.time), (number(r.values[0]), number(r.values[1]), number(r.values[2])))
         for r in joint]
        for joint in rows
    ]  # fmt: skip


def _write(rng: Rng, reader: str, shown: Table, form: str, clock: str, folder: Path) -> Path:
    joints = [f"j{k + 1}" for k in range(len(shown))]
    words = ("", " velocity", " acceleration")
    names = ["time", *(f"{j}{w}" for w in words for j in joints)]
    rows = [
        [float(one.time), *(float(joint[k].values[o]) for o in range(3) for joint in shown)]
        for k, one in enumerate(shown[0])
    ]
    if reader == "csv":
        sign = str(rng.choice([",", ";", "\t"]))
        lines = [sign.join([_text(r[0], clock), *(_text(x, form) for x in r[1:])]) for r in rows]
        path = folder / "motion.csv"
        path.write_text("\n".join([sign.join(names), *lines]) + "\n", encoding="utf-8")
        return path
    if reader == "parquet":
        import pyarrow as pa
        from pyarrow import parquet

        path = folder / "motion.parquet"
        columns = [pa.array(c) for c in zip(*rows, strict=True)]
        parquet.write_table(pa.table(columns, names=names), path)
        return path
    points = []
    for k, row in enumerate(rows):
        whole, part = divmod(round(shown[0][k].time * 10**9), 10**9)
        parts = [row[1 + o * len(joints) : 1 + (o + 1) * len(joints)] for o in range(3)]
        points.append((parts, whole, part))
    if reader == "bag":
        return _bag(joints, points, folder)
    message = {
        "joint_names": joints,
        "points": [
            {
                "positions": parts[0],
                "velocities": parts[1],
                "accelerations": parts[2],
                "time_from_start": {"sec": whole, "nanosec": part},
            }
            for parts, whole, part in points
        ],
    }
    path = folder / f"motion.{reader}"
    if reader == "json":
        path.write_text(json.dumps(message), encoding="utf-8")
    else:
        import yaml

        path.write_text(yaml.safe_dump(message), encoding="utf-8")
    return path


def _bag(joints: list[str], points: Sequence[Any], folder: Path) -> Path:
    from rosbags.rosbag2 import Writer
    from rosbags.typesys import Stores, get_typestore

    store = get_typestore(Stores.ROS2_HUMBLE)
    kind, types = "trajectory_msgs/msg/JointTrajectory", store.types
    each = [
        types["trajectory_msgs/msg/JointTrajectoryPoint"](
            *(np.array(part) for part in parts),
            np.zeros(0),
            types["builtin_interfaces/msg/Duration"](whole, part),
        )
        for parts, whole, part in points
    ]
    header = types["std_msgs/msg/Header"](types["builtin_interfaces/msg/Time"](0, 0), "")
    path = folder / "bag"
    with Writer(path, version=9) as writer:
        connection = writer.add_connection("/plan", kind, typestore=store)
        writer.write(connection, 1, store.serialize_cdr(types[kind](header, joints, each), kind))
    return path


def _shaken(rng: Rng, rows: Table, noise: float, clock: float) -> Table:
    """What was measured: rows within the noise of those that are shown, all at the same times."""
    shift = [Fraction(float(x)) for x in clock * rng.uniform(-1, 1, len(rows[0]))]
    return [
        [
            Row(r.time + dt, (r.values[0] + Fraction(noise * float(rng.uniform(-1, 1))),
                              *r.values[1:]))
            for r, dt in zip(joint, shift, strict=True)
        ]
        for joint in rows
    ]  # fmt: skip


def _file(rng: Rng, reader: str, how: str, drawn: Table, folder: Path) -> Written:
    form = _form(rng, reader)
    clock = "ns" if reader in ("json", "yaml", "bag") else _form(rng, reader)
    units = "rad"
    if reader in ("csv", "parquet"):
        units = str(rng.choice(["rad", "rad", "deg", "mm"]))
    step = float(min(b.time - a.time for a, b in pairwise(drawn[0])))
    size = max(abs(float(r.values[0])) for joint in drawn for r in joint)
    stated = str(rng.choice(["nothing", "nothing", "exact", "measured"]))
    noise = size * float(rng.choice([1e-12, 1e-8, 1e-4]))
    time_noise = step * float(rng.choice([0.0, 1e-9, 1e-4]))
    if how == "none" and stated == "measured":
        # Samples of the curve, measured and then written: with every digit.
        form = ""
        clock = clock if clock == "ns" else ""
        shown = _written(_shaken(rng, drawn, noise, time_noise), form, clock)
        path = _write(rng, reader, shown, form, clock, folder)
        time_noise += 1e-9 if clock == "ns" else 0.0
        return Written(drawn, shown, path, units, noise, time_noise)
    shown = _written(drawn, form, clock)
    path = _write(rng, reader, shown, form, clock, folder)
    if stated == "exact":
        return Written(shown, shown, path, units, 0.0, 0.0)
    # The controller is given what stands there.
    truth = shown if how == "controller" else drawn
    if stated == "nothing":
        return Written(truth, shown, path, units, None, None)
    truth = [
        [Row(s.time, (s.values[0], *k.values[1:])) for s, k in zip(one, two, strict=True)]
        for one, two in zip(_shaken(rng, shown, noise, time_noise), truth, strict=True)
    ]
    return Written(truth, shown, path, units, noise, time_noise)


def _polynomials(rng: Rng, curves: list[Curve], folder: Path) -> tuple[list[Curve], Path]:
    """The polynomials of a file are the motion: their coefficients as float64."""
    breaks = [float(x) for x in curves[0].breaks]
    floats = [[[float(x) for x in c] for c in one.pieces] for one in curves]
    coefficients = [
        [[one[k][p] for one in floats] for p in reversed(range(len(floats[0][0])))]
        for k in range(len(breaks) - 1)
    ]
    path = folder / "motion.json"
    path.write_text(json.dumps({"breaks": breaks, "coefficients": coefficients}))
    exact = [
        Curve([Fraction(x) for x in breaks], [[Fraction(x) for x in c] for c in one])
        for one in floats
    ]
    return exact, path


# --- limits ---------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Limits:
    """Of a check, with what rational arithmetic says of them."""

    given: JointLimits

    def excess(self, curves: list[Curve], still: Fraction, slower: Fraction) -> Fraction:
        """Largest peak over its limit, less 1; of positions over half of their range."""
        most = Fraction(-1)
        for j, curve in enumerate(curves):
            ranges = curve.ranges
            braking = float(self.given.deceleration[j])
            for r, (low, high) in enumerate(ranges):
                lower, upper = float(self.given.lower[j, r]), float(self.given.upper[j, r])
                if r == 2 and np.isfinite(braking):
                    top = max(abs(x) for x in ranges[1])
                    grows, falls = curve.one_sided(still * top)
                    for peak, limit in ((grows, upper), (falls, braking)):
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
                        over = sign * end / slower**r
                        most = max(most, over / abs(Fraction(limit)) - 1)
        return most


def _limits(rng: Rng, curves: list[Curve], factor: Fraction) -> Limits | None:
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
    return Limits(JointLimits(names, lower, upper, braking))


# --- the trial ------------------------------------------------------------------------------------


def _scaled(curves: list[Curve], factor: Fraction) -> list[Curve]:
    if factor == 1:
        return curves
    return [Curve(one.breaks, [[factor * x for x in c] for c in one.pieces]) for one in curves]


_FACTORS = {"rad": 1.0, "deg": np.pi / 180.0, "mm": 1e-3}
"""What a number in a unit is in rad or m."""


def verdicts(rng: Rng, folder: Path) -> str | None:
    """One motion through one reader and one interpolation."""
    reader = str(rng.choice(READERS, p=[0.36, 0.14, 0.16, 0.1, 0.08, 0.16]))
    how = str(rng.choice([str(x) for x in Interpolation]))
    count = int(rng.integers(4, 9))
    times = _times(rng, count)
    bases = [_curve(rng, times) for _ in range(int(rng.integers(1, 3)))]
    rough = rng.random() < 0.5 and how != "none"
    drawn = [_sampled(rng, base, times, rough) for base in bases]
    if rng.random() < 0.1:
        still = drawn[0][0].values[0]
        drawn[0] = [Row(r.time, (still, Fraction(0), Fraction(0))) for r in drawn[0]]
        bases[0] = Curve([drawn[0][0].time, drawn[0][-1].time], [[still]])
    between = "quintic" if how == "controller" else how
    keep(folder, case=f"{reader} {how}")
    if reader == "polynomials":
        how = between = str(rng.choice(["linear", "cubic", "quintic", "spline"]))
        truths, path = _polynomials(rng, [_through(one, how) for one in drawn], folder)
        meant, units, stated = [truths], "rad", {}
        how = "polynomials"
    else:
        written = _file(rng, reader, how, drawn, folder)
        path, units = written.path, written.units
        stated = {"time_noise": written.time_noise}
        if written.noise is not None:
            stated["noise"] = (written.noise,)
        ordered = all(
            a.time < b.time
            for table in (written.drawn, written.shown)
            for a, b in pairwise(table[0])
        )
        if not ordered:
            return "samples at one time"
        if how == "none":
            # The curve itself goes through what was drawn, and through nothing else.
            meant = [bases] if written.drawn is drawn else []
        else:
            meant = [[_through(j, between) for j in t] for t in (written.drawn, written.shown)]
    factor = Fraction(_FACTORS[units])
    meant = [_scaled(one, factor) for one in meant]
    aim = meant[int(rng.integers(len(meant)))] if meant else _scaled(bases, factor)
    limits = _limits(rng, aim, Fraction(1))
    if limits is None:
        return None
    keep(folder, limits=f"{limits.given.lower}\n{limits.given.upper}\n{limits.given.deceleration}")
    try:
        content = read_motion(path, (units,), **stated).content  # type: ignore[arg-type]
        asked = JointLimits(
            content.joints, limits.given.lower, limits.given.upper, limits.given.deceleration
        )
        if isinstance(content, Motion):
            found = check_motion(content, asked)
        elif how == "none":
            found = check_samples(content, asked)
        else:
            found = check_motion(interpolated(content, Interpolation(how)), asked)
    except TrajgapError:
        return f"{reader} {how}: refused"
    word = f"{reader} {how}: {found.verdict}"
    for curves in meant:
        over = limits.excess(curves, _STILL, Fraction(1)) > _TOLERANCE + _DIGIT
        kept = limits.excess(curves, Fraction(0), Fraction(1)) <= _TOLERANCE - _DIGIT
        demand(not (over and found.limits is Verdict.PASS), f"{word}, and a peak exceeds")
        demand(not (kept and found.limits is Verdict.VIOLATED), f"{word}, and every peak keeps")
        _continuous(curves, how, found.verdict, word)
        if found.feasible_time is not None:
            slow = Fraction(found.stretch)
            left = limits.excess(curves, _STILL, slow)
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
