"""Made-up case files, a line for each claim: what tests of single rules are tried on."""

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import pytest
from support.toml_text import Bare, block

QUINTIC = {"family": "rest-to-rest", "degree": 5}
"""Peaks at 15 d/(8 h) for a way d in h."""
CUBIC = {"family": "rest-to-rest", "degree": 3}
"""Peaks at 3 d/(2 h)."""
Numbers = str | Sequence[object]


def slow(seeds: Iterable[int]) -> list[Any]:
    """Seeds that the quick suite leaves out."""
    return [pytest.param(seed, marks=pytest.mark.slow) for seed in seeds]


def _listed(given: Numbers) -> list[object]:
    """Digits as printed, with spaces between them, or numbers that are meant exactly."""
    return list(given.split() if isinstance(given, str) else given)


def entry(table: str, /, **keys: Any) -> str:
    """One more entry of a list of the file."""
    return "\n" + block(f"[[{table}]]", keys) + "\n"


def claim(name: str, quantity: str, **keys: Any) -> str:
    return entry("claims", **{"id": name, "quantity": quantity, "where": name} | keys)


def row(name: str, durations: Numbers, **keys: Any) -> str:
    return claim(name, "durations", durations=_listed(durations), **keys)


def total(name: str, value: object, **keys: Any) -> str:
    return claim(name, "total_time", value=value, **keys)


def gain(slower: str, faster: str, **keys: Any) -> str:
    """A claimed improvement."""
    return claim("gain", "improvement", slower=slower, faster=faster, **keys)


def sentence(name: str, checks: str, *of: str, **keys: Any) -> str:
    return claim(name, "statement", checks=checks, **({"of": list(of)} if of else {}) | keys)


def peak(name: str, of: str, derivative: str, value: Numbers, **keys: Any) -> str:
    """One number, or the numbers of all joints."""
    number = {"value": value} if isinstance(value, str) else {"values": list(value)}
    return claim(name, "peak", of=of, derivative=derivative, **number, **keys)


def algorithms(*names: str) -> str:
    return "".join(entry("algorithms", id=name, name=name) for name in names)


def tables(*numbers: int, **keys: Any) -> str:
    return "".join(
        entry("tables", id=f"table-{k}", where=f"Table {k}", title="t", **keys) for k in numbers
    )


def readings(**changes: Mapping[str, Any]) -> str:
    """Readings by their ids, each with what it changes."""
    return "".join(entry("readings", id=k, why=k, **change) for k, change in changes.items())


def paper(
    rows: Sequence[Numbers],
    *parts: str,
    curve: Mapping[str, Any] = QUINTIC,
    angle: str = "rad",
    units: Mapping[str, Any] | None = None,
    waypoints: Mapping[str, Any] | None = None,
    bounds: Mapping[str, Any] | None = None,
    head: Mapping[str, Any] | None = None,
    robot: Mapping[str, Any] | None = None,
    **limits: Any,
) -> str:
    """A case file of the way-points of each joint, and of the parts that follow."""
    orders = ("velocity", "acceleration", "jerk")
    powers = zip(orders, ("s", "s^2", "s^3"), strict=True)
    own = {"position": angle, **{name: f"{angle}/{power}" for name, power in powers}, "time": "s"}
    joints = [str(j + 1) for j in range(len(rows))]
    blocks = [
        block("", {"format": 1, "id": "made-up", "title": "made up"} | dict(head or {})),
        block("[source]", {"year": 2024}),
        block("[robot]", {"name": "arm", "joints": joints} | dict(robot or {})),
        block("[units]", own | dict(units or {})),
        block("[waypoints]", {"joint_rows": [_listed(r) for r in rows]} | dict(waypoints or {})),
        block("[limits]", limits),
        block("[interpolant]", dict(curve)),
        *([block("[durations]", dict(bounds))] if bounds else []),
    ]
    return "\n".join(blocks).strip() + "\n" + "".join(parts)


def one_joint(points: str, limit: str, time: str, checks: str, *parts: str) -> str:
    """One joint from rest to rest, a row, and a sentence on it; points and limit as in the file."""
    claims = row("d", time, where="Table 2"), sentence("s", checks, "d", where="abstract")
    head = {"id": "fair", "title": "one joint from rest to rest"}
    return paper([[Bare(points)]], *claims, *parts, head=head, velocity=Bare(limit))


ARM = {"convention": "standard", "length_unit": "m", "angle_unit": "deg"}
"""How a robot's table is stated, beside its numbers."""
TWO_UNITS = readings(header={}, degrees={"units": {"velocity": "deg/s"}})
"""The unit of a limit as printed, and another one."""
