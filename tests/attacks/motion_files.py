"""Motions drawn in rational numbers, and written as programs write them, for every reader."""

import json
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from support.exact_motions import Curve, Row, hermite, spline

from attacks.cases import Rng

READERS = ("csv", "parquet", "json", "yaml", "bag", "polynomials")
"""Files that motions are read from: tables, ROS messages, polynomials."""
DEGREES = {"linear": 1, "cubic": 3, "quintic": 5}
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


def some_times(rng: Rng, count: int) -> list[float]:
    each = rng.uniform(0.2, 1.0, count)
    match int(rng.integers(4)):
        case 0:
            each[:] = 1.0
        case 1:
            each[int(rng.integers(1, count))] *= 10.0 ** -int(rng.integers(1, 7))
    scale = 10.0 ** float(rng.choice([-2, -1, 0, 0, 1]))
    start = float(rng.choice([0.0, 0.0, 7.5, 1000.0]))
    return [float(x) for x in start + scale * (np.cumsum(each) - each[0])]


def some_curve(rng: Rng, times: list[float]) -> Curve:
    """A spline over fewer knots than there are samples, of any size."""
    knots = np.linspace(times[0], times[-1], int(rng.integers(4, 7)))
    knots[1:-1] += 0.3 * (knots[1] - knots[0]) * rng.uniform(-1, 1, knots.size - 2)
    size = 10.0 ** float(rng.choice([-3, 0, 0, 2]))
    exact = [Fraction(float(x)) for x in knots]
    return spline(exact, [Fraction(float(x)) for x in size * rng.normal(size=knots.size)])


def sampled(rng: Rng, curve: Curve, times: list[float], rough: bool) -> list[Row]:
    """Samples of a curve; rough ones have derivatives of their own."""
    rows = []
    for t in map(Fraction, times):
        found = [float(curve.at(t, order)) for order in range(3)]
        if rough:
            found = [x * float(rng.uniform(0.5, 1.5)) for x in found]
        q, v, a = map(Fraction, found)
        rows.append(Row(t, (q, v, a)))
    return rows


def through(rows: list[Row], how: str) -> Curve:
    if how == "spline":
        return spline([one.time for one in rows], [one.values[0] for one in rows])
    return hermite(rows, DEGREES[how])


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


def write(
    rng: Rng,
    reader: str,
    shown: Table,
    folder: Path,
    form: str = "",
    clock: str = "",
    joints: Sequence[str] = ("j1", "j2"),
) -> Path:
    """A file of rows, all joints at the same times."""
    joints = list(joints)[: len(shown)]
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
        path.write_text(json.dumps(message), "utf-8")
    else:
        import yaml

        path.write_text(yaml.safe_dump(message), "utf-8")
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


def some_file(rng: Rng, reader: str, how: str, drawn: Table, folder: Path) -> Written:
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
        path = write(rng, reader, shown, folder, form, clock)
        time_noise += 1e-9 if clock == "ns" else 0.0
        return Written(drawn, shown, path, units, noise, time_noise)
    shown = _written(drawn, form, clock)
    path = write(rng, reader, shown, folder, form, clock)
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


def polynomials(rng: Rng, curves: list[Curve], folder: Path) -> tuple[list[Curve], Path]:
    """The polynomials of a file are the motion: their coefficients as float64."""
    breaks = [float(x) for x in curves[0].breaks]
    floats = [[[float(x) for x in c] for c in one.pieces] for one in curves]
    coefficients = [
        [[one[k][p] for one in floats] for p in reversed(range(len(floats[0][0])))]
        for k in range(len(breaks) - 1)
    ]
    path = folder / "motion.json"
    path.write_text(json.dumps({"breaks": breaks, "coefficients": coefficients}))
    times = [Fraction(x) for x in breaks]
    exact = [Curve(times, [[Fraction(x) for x in c] for c in one]) for one in floats]
    return exact, path
