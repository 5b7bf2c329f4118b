"""Limits of a URDF: position, velocity, and since 1.2 acceleration, deceleration and jerk."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from xml.parsers import expat

from ..errors import CaseError, TrajgapError
from ..files import MOST, read_regular
from ..motions import BRAKING
from ..printed import read_float
from .moveit import read_moveit
from .precedence import Range, StatedLimits

_MOVING = ("revolute", "continuous", "prismatic")
"""Types of joints with one value that moves."""
_SIZES = ("velocity", "acceleration", BRAKING, "jerk")
"""Attributes of ``limit`` that bound sizes; the last three since URDF 1.2."""


def read_urdf(path: Path) -> StatedLimits:
    """Read the limits of a URDF's joints.

    Parameters
    ----------
    path : Path
        Of ``<limit lower upper velocity acceleration deceleration jerk>`` every attribute that is
        present is read; ``lower`` or ``upper`` alone leaves the other at 0, as the format says. A
        continuous joint with limits has no position range. Fixed, floating and planar joints and
        those that mimic another are ignored.

    Raises
    ------
    CaseError
        If it is not a URDF, or declares entities.
    """
    name = str(path)
    data = read_regular(path, MOST.robot_bytes, "give the URDF alone, without meshes")
    reader = _Reader(name)
    parser = expat.ParserCreate()
    parser.StartElementHandler = reader.begin
    parser.EndElementHandler = reader.end
    parser.StartDoctypeDeclHandler = reader.doctype
    reader.line = lambda: int(parser.CurrentLineNumber)
    try:
        parser.Parse(data, True)
    except expat.ExpatError as error:
        what = expat.ErrorString(error.code)
        raise CaseError(
            name, f"line {error.lineno}", f"not valid XML, {what}; correct the syntax"
        ) from None
    except CaseError:
        raise
    except (LookupError, ValueError):
        raise CaseError(name, "", "has an encoding that is not known; save it as UTF-8") from None
    if not reader.ranges:
        raise CaseError(name, "", "has no joint that moves and has limits; give the arm's URDF")
    return StatedLimits(name, reader.ranges, slides=reader.slides)


def read_limits(path: Path) -> StatedLimits:
    """Read a URDF (``.urdf``, ``.xml``), or MoveIt's joint_limits.yaml."""
    return (read_urdf if path.suffix.lower() in (".urdf", ".xml") else read_moveit)(path)


class _Reader:
    """What is kept of the elements while a URDF streams by."""

    def __init__(self, name: str) -> None:
        self.name = name
        self.path: list[str] = []
        self.ranges: dict[str, dict[str, Range]] = {}
        self.slides: dict[str, bool] = {}
        self.joint = ""
        self.kind = ""
        self.limit: dict[str, str] | None = None
        self.mimics = False
        self.line: Callable[[], int] = lambda: 0

    def fault(self, field: str, reason: str) -> CaseError:
        where = ": ".join(x for x in (f"line {self.line()}", field) if x)
        return CaseError(self.name, where, reason)

    def doctype(self, *_: object) -> None:
        raise self.fault("", "declares a document type; remove it, entities are not read")

    def begin(self, tag: str, attributes: dict[str, str]) -> None:
        if len(self.path) > 50:
            raise self.fault("", "is nested too deeply; give a URDF")
        if not self.path and tag != "robot":
            raise self.fault("", f"begins with <{tag[:40]}>, but a URDF begins with <robot>")
        self.path.append(tag)
        if self.path == ["robot", "joint"]:
            self.joint, self.kind = attributes.get("name", ""), attributes.get("type", "")
            self.limit, self.mimics = None, False
            if not self.joint:
                raise self.fault("joint", "has no name; name it")
            if self.joint in self.ranges:
                raise self.fault(self.joint, "occurs twice; name each joint once")
        elif self.path == ["robot", "joint", "limit"]:
            if self.limit is not None:
                raise self.fault(self.joint, "has two limits; keep one")
            self.limit = attributes
        elif self.path == ["robot", "joint", "mimic"]:
            self.mimics = True

    def end(self, _: str) -> None:
        if self.path == ["robot", "joint"] and self.kind in _MOVING and not self.mimics:
            self.ranges[self.joint] = self._ranges(self.limit or {})
            self.slides[self.joint] = self.kind == "prismatic"
        self.path.pop()

    def _ranges(self, limit: dict[str, str]) -> dict[str, Range]:
        ranges: dict[str, Range] = {}
        for quantity in _SIZES:
            if quantity in limit:
                size = self._number(limit, quantity)
                if size < 0:
                    raise self.fault(f"{self.joint}: {quantity}", "is negative; give a size")
                ranges[quantity] = (-size, size)
        if self.kind != "continuous":
            if "lower" in limit or "upper" in limit:
                low = self._number(limit, "lower") if "lower" in limit else 0.0
                high = self._number(limit, "upper") if "upper" in limit else 0.0
                ranges["position"] = (low, high)
            elif limit:
                raise self.fault(
                    f"{self.joint}: limit", "has no lower and upper; give both, in rad or m"
                )
        elif limit:
            ranges["position"] = (-math.inf, math.inf)
        return ranges

    def _number(self, limit: dict[str, str], key: str) -> float:
        try:
            return read_float(limit[key])
        except TrajgapError as error:
            fix = "run xacro first" if "$" in limit[key] else "give one"
            raise self.fault(f"{self.joint}: {key}", f"{error}; {fix}") from None
