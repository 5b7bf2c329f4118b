"""An instance as a file that needs nothing of trajgap: every condition of its curve is listed."""

from __future__ import annotations

import math
import tomllib
from collections.abc import Iterable
from importlib.resources import files
from typing import Any, cast

from ..curves import Interpolant
from ..limits import QUANTITIES, USUAL
from .instance import BenchmarkInstance
from .shelf import suite_version

FORMAT = "trajgap-suite-instance-1"
"""First line of every plain file; docs/suite/index.md describes it."""

LOADER = """\
import tomllib
from math import perm

import numpy as np
from scipy.interpolate import PPoly


def load(file):
    with open(file, "rb") as opened:
        return tomllib.load(opened)


def curve(one, h):  # the motion with durations h; its columns are the joints
    n, degree = len(h), max(one["degrees"])

    def at(k, s, r):  # r-th derivative of piece k at the share s of its duration
        row = np.zeros((n, degree + 1))
        row[k] = [perm(p, r) * s ** max(p - r, 0) / h[k] ** r for p in range(degree + 1)]
        return row.ravel()

    rest, rows = np.zeros(len(one["waypoints"][0])), []
    fixed = [(b, 0, q) for b, q in zip(one["breaks"], one["waypoints"])] + one["prescribed"]
    for b, r, q in fixed:  # both pieces that meet at break b take the value
        rows += [(at(k, s, r), q) for k, s in [(b - 1, 1.0), (b, 0.0)] if 0 <= k < n]
    for b, r in one["joined"]:  # the r-th derivative does not jump at break b
        rows += [(at(b - 1, 1.0, r) - at(b, 0.0, r), rest)]
    for k, d in enumerate(one["degrees"]):
        rows += [(at(k, 0.0, p), rest) for p in range(d + 1, degree + 1)]
    left, right = zip(*rows)
    c = np.linalg.solve(left, right).reshape(n, degree + 1, -1).transpose(1, 0, 2)
    c = c / np.power.outer(h, np.arange(degree + 1)).T[:, :, None]
    return PPoly(c[::-1], np.cumsum([0, *h]))


def peaks(one, h):  # largest |velocity|, |acceleration|, |jerk| over their limits, joint by joint
    found = []
    for r, name in enumerate(["velocity", "acceleration", "jerk"], 1):
        for j, limit in enumerate(one[name]):
            q = curve(one, h).derivative(r)
            q = PPoly(q.c[:, :, j], q.x)
            flat = q.derivative().roots(extrapolate=False) if len(q.c) > 1 else np.array([])
            ends = [np.polyval(piece, [0, step]) for piece, step in zip(q.c.T, h)]
            values = [*q(flat[np.isfinite(flat)]), *np.ravel(ends)]
            found.append(max(map(abs, values)) / limit)
    return np.reshape(found, (3, -1))
"""
"""Reads a plain file with numpy and scipy alone; docs/suite/index.md shows it, a test runs it."""


def plain_text(instance: BenchmarkInstance) -> str:
    """An instance as TOML, in the unit of angle of its case file, every number exact."""
    file = files("trajgap.problem.suite.cases").joinpath(f"{instance.name}.toml")
    raw = tomllib.loads(file.read_text(encoding="utf-8"))
    # The suite holds declared piecewise polynomials alone.
    curve = cast(Interpolant, instance.problem().curve)
    joints = [None] * instance.joints
    limits = {key: raw["limits"].get(key, [math.inf for _ in joints]) for key in QUANTITIES[:USUAL]}
    known: list[tuple[str, object]] = [
        ("format", FORMAT),
        ("suite", suite_version()),
        ("name", instance.name),
        ("title", raw["title"]),
        ("source", raw["source"]["title"]),
        ("angle", raw["units"]["position"]),
        ("waypoints", raw["waypoints"]["waypoint_rows"]),
        *limits.items(),
        ("degrees", curve.degrees),
        ("breaks", curve.waypoint_breaks),
        ("prescribed", _prescribed(curve, instance.joints)),
        ("joined", _joined(curve)),
        ("duration_lower", [raw["durations"]["lower"]] * curve.segments),
        ("duration_upper", [raw["durations"]["upper"]] * curve.segments),
        ("lower", instance.lower),
        ("upper", instance.upper),
        ("evidence", str(instance.evidence)),
        ("durations", instance.durations),
        ("case_sha256", instance.case_sha256),
    ]
    if instance.certificate_sha256 is not None:
        known.append(("certificate_sha256", instance.certificate_sha256))
    return "".join(f"{key} = {_toml(value)}\n" for key, value in known)


def _prescribed(curve: Interpolant, joints: int) -> list[tuple[int, int, list[float]]]:
    """Break, order, and value of each joint."""
    return [
        (b, order, list(map(float, value if isinstance(value, tuple) else (value,) * joints)))
        for b, entries in enumerate(curve.prescribed)
        for order, value in entries
    ]


def _joined(curve: Interpolant) -> list[tuple[int, int]]:
    """Break and order of each derivative that is continuous and not prescribed."""
    inner = enumerate(curve.continuity, 1)
    return [
        (b, order)
        for b, continuity in inner
        for order in range(0 if b in curve.virtual else 1, continuity + 1)
        if order not in dict(curve.prescribed[b])
    ]


def _toml(value: object) -> str:
    if isinstance(value, str):
        return '"' + value.replace("\\", "\\\\").replace('"', '\\"') + '"'
    if isinstance(value, float):
        return "inf" if math.isinf(value) else repr(value)
    if isinstance(value, Iterable):
        rows: list[Any] = list(value)
        nested = bool(rows) and isinstance(rows[0], list | tuple)
        inside = [_toml(row) for row in rows]
        if nested:
            return "[\n" + "".join(f"  {row},\n" for row in inside) + "]"
        return f"[{', '.join(inside)}]"
    return str(value)
