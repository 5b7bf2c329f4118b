"""The schema of a case file, format 1."""

from __future__ import annotations

from decimal import Decimal
from math import isfinite
from typing import Annotated, Any, Literal, Self, get_origin

from pydantic import BeforeValidator, Field, StrictBool, StrictInt, WithJsonSchema, model_validator

from ..errors import TrajgapError
from ..files import MOST
from ..printed import (
    Id,
    JointLabels,
    Label,
    LengthUnit,
    Number,
    OneOrEachLength,
    OneOrEachLowerPosition,
    OneOrEachSized,
    OneOrEachUpper,
    OneOrEachUpperPosition,
    Printed,
    PrintedRows,
    Ratios,
    Strict,
    Text,
    describe,
    fault,
)
from ..problem import Coupling
from ..robots import DhTable, Equation
from .claim import AnyClaim
from .clue import AnyClue
from .declaration import InterpolantBlock
from .instances import InstancesBlock
from .joint_units import Units


class Source(Strict):
    """Where the numbers were printed."""

    kind: Literal["paper", "teaching", "software", "unpublished"] = "paper"
    """What printed them: a paper, an exam or a lecture, a library's tests, or nothing public."""
    authors: str = ""
    title: str = ""
    journal: str = ""
    year: StrictInt | None = None
    doi: str = ""
    note: str = ""


class Robot(Strict):
    """The robot and the labels of the joints, in the order of every per-joint list."""

    name: Text
    joints: JointLabels
    dh: DhTable | None = None
    """Its Denavit-Hartenberg table as printed."""
    model: Id | None = None
    """A robot shipped with the package, instead of `dh`."""

    @model_validator(mode="after")
    def _distinct(self) -> Self:
        for index, label in enumerate(self.joints):
            if label in self.joints[:index]:
                raise fault(f".joints[{index}]", f"joint {label!r} is named twice; rename one")
        if self.dh is not None and self.model is not None:
            raise fault(".model", "cannot be combined with dh; keep one of the two")
        return self


class RobotFile(Strict):
    """A robot as data: where its table stands, and the table."""

    format: Literal[1]
    id: Id
    name: Text
    source: Source
    dh: DhTable


class StraightLine(Strict):
    """A straight move of the robot's end, as the toolboxes' ``ctraj`` makes it."""

    first: tuple[Number, ...]
    """Exact angles of the robot's joints at its start, one each."""
    last: tuple[Number, ...]
    """The same at its end."""
    points: Annotated[StrictInt, Field(ge=2, le=MOST.poses)]
    """Poses on the line, both ends included."""


class Waypoints(Strict):
    """Joint angles at the way-points, as one row per joint or one row per way-point."""

    where: str = ""
    labels: tuple[str, ...] = ()
    """Names of the way-points."""
    joint_rows: PrintedRows | None = None
    """One row per joint, one number per way-point."""
    waypoint_rows: PrintedRows | None = None
    """One row per way-point, one number per joint."""
    line: StraightLine | None = None
    """Instead of rows: way-points whose poses lie on a straight line."""
    not_printed: Text | None = None
    """Why there are no rows, where the paper prints none; with `count`."""
    count: Annotated[StrictInt, Field(ge=2, le=MOST.waypoints)] | None = None
    """How many way-points there are, where none is printed."""

    @model_validator(mode="after")
    def _rectangular(self) -> Self:
        if self.not_printed is not None or self.count is not None:
            self._check_absent()
            return self
        given = (self.joint_rows, self.waypoint_rows, self.line)
        if sum(one is not None for one in given) != 1:
            raise fault("", "needs one of joint_rows, waypoint_rows and line; give one")
        if self.line is not None:
            self._check_labels()
            return self
        name = "joint_rows" if self.joint_rows is not None else "waypoint_rows"
        across = "way-point" if name == "joint_rows" else "joint"
        rows = self.joint_rows or self.waypoint_rows or ()
        for index, row in enumerate(rows):
            if len(row) != len(rows[0]):
                raise fault(
                    f".{name}[{index}]",
                    f"has {len(row)} numbers, but {name}[0] has {len(rows[0])}; "
                    f"give one number per {across}",
                )
        count = len(self.points)
        if count < 2:
            raise fault(f".{name}", "contains only one way-point; give at least two")
        if count > MOST.waypoints:
            raise fault(
                f".{name}",
                f"holds {count:,} way-points, but at most {MOST.waypoints:,} are read; leave some "
                "out",
            )
        self._check_labels()
        return self

    def _check_absent(self) -> None:
        if (self.joint_rows, self.waypoint_rows, self.line) != (None, None, None):
            name = "count" if self.not_printed is None else "not_printed"
            raise fault(f".{name}", "cannot be combined with rows; leave out one of the two")
        for name in ("not_printed", "count"):
            if getattr(self, name) is None:
                raise fault(f".{name}", "is missing; way-points without rows need both")
        self._check_labels()

    def _check_labels(self) -> None:
        if self.labels and len(self.labels) != self.number:
            raise fault(
                ".labels", f"{len(self.labels)} labels for {self.number} way-points; give one each"
            )

    @property
    def number(self) -> int:
        """How many way-points there are, printed or not."""
        if self.line is not None:
            return self.line.points
        return len(self.points) or self.count or 0

    @property
    def points(self) -> tuple[tuple[Printed, ...], ...]:
        """One row per way-point, one number per joint; empty if none is printed."""
        if self.waypoint_rows is not None:
            return self.waypoint_rows
        return tuple(zip(*(self.joint_rows or ()), strict=True))


class LimitsBlock(Strict):
    """Limits as printed: one for all joints or one per joint; absent or inf means none.

    One per joint may be a pair: the least value, 0 or less, and the largest, 0 or more. That of
    deceleration holds while the speed falls, in the unit of acceleration, whose own limit then
    holds while the speed grows.
    """

    where: str = ""
    velocity: OneOrEachSized = None
    acceleration: OneOrEachSized = None
    deceleration: OneOrEachUpper = None
    jerk: OneOrEachSized = None
    snap: OneOrEachSized = None
    position_lower: OneOrEachLowerPosition = None
    position_upper: OneOrEachUpperPosition = None


class Durations(Strict):
    """Bounds on the segment durations, one for all segments or one per segment; their ratios."""

    where: str = ""
    lower: OneOrEachLength | None = None
    """Shortest duration; 0 (the default) means positive."""
    upper: OneOrEachUpper = None
    """Longest duration; none by default."""
    ratios: Ratios | None = None
    """Ratios of the durations, of any scale, where only the total is chosen: one number per
    segment, "equal", or "chord" for the lengths between the way-points. "free" (the default)
    chooses each duration."""


class ProblemData(Strict):
    """What can be said for the whole file and changed by a problem or a reading."""

    units: Units = Units()
    waypoints: Waypoints | None = None
    limits: LimitsBlock = LimitsBlock()
    interpolant: InterpolantBlock | None = None
    durations: Durations = Durations()
    coupling: Coupling | None = None


class Override(ProblemData):
    """A `ProblemData` that changes another one; units, limits and durations key by key."""

    joints: JointLabels | None = None
    """The joints that take part; all if absent. Per-joint lists keep listing every joint."""
    turns: dict[str, tuple[StrictInt, ...]] = Field(default_factory=dict)
    """Whole turns added to the printed angles of a joint, one number per way-point."""


class ProblemBlock(Override):
    """One of the problems that the paper states."""

    id: Id
    title: str = ""
    where: str = ""
    why: str = ""


class Reading(Override):
    """An admissible way of reading what the paper prints, with its justification."""

    id: Id
    label: Label | None = None
    """What it means, in a few words that stand for it in reports; made from what it changes if
    absent."""
    why: Text
    default: StrictBool = False
    default_why: Text | None = None
    """Why it is the default, where several are admissible; with `default`."""
    interpolant_of: tuple[Id, ...] = ()
    """Problems whose interpolant it changes; every problem if empty."""

    @model_validator(mode="after")
    def _changes_one(self) -> Self:
        if self.default_why is not None and not self.default:
            raise fault(".default_why", "requires default = true; add it, or leave this out")
        if self.interpolant_of and self.interpolant is None:
            raise fault(".interpolant_of", "requires an interpolant; add it, or leave this out")
        return self


def _setting(raw: object) -> object:
    if isinstance(raw, list):
        return [_setting(item) for item in raw]
    if isinstance(raw, Decimal):
        if not isfinite(float(raw)):
            raise TrajgapError(f"{raw} is not a finite number of float64; give a finite one")
        return float(raw)
    if isinstance(raw, bool | int | float | str):
        return raw
    raise TrajgapError(f"{describe(raw)} is not a setting; give a number, a string or a list")


Setting = Annotated[
    Any,
    BeforeValidator(_setting),
    WithJsonSchema({"type": ["number", "string", "boolean", "array"]}),
]


class AlgorithmBlock(Strict):
    """An algorithm of the paper and its settings."""

    id: Id
    name: Text
    kind: Text | None = None
    """Which implementation replays it, such as "pso"; none if absent."""
    settings: dict[str, Setting] = Field(default_factory=dict)
    """Settings as printed."""
    chosen: dict[str, Setting] = Field(default_factory=dict)
    """Settings that the paper does not print, as chosen here."""
    where: str = ""
    open: tuple[Text, ...] = ()
    """What the paper leaves open, and what was chosen."""

    @model_validator(mode="after")
    def _printed_or_chosen(self) -> Self:
        for key in self.chosen.keys() & self.settings.keys():
            raise fault(f".chosen.{key}", "is both printed and chosen; keep one of the two")
        return self

    @property
    def parameters(self) -> dict[str, Any]:
        """All settings, printed and chosen."""
        return {**self.settings, **self.chosen}


class Table(Strict):
    """A printed table that groups claims."""

    id: Id
    where: Text
    title: str = ""
    algorithm: Id | None = None


class Assumption(Strict):
    """Something the paper leaves open, and what was chosen."""

    id: Id
    text: Text
    choice: Text
    affects: tuple[Text, ...] = ()
    """Ids of the claims, tables, algorithms, problems or readings, or names of blocks."""


class Column(Strict):
    """Printed numbers that are neither problem data nor part of a claim."""

    id: Id
    where: Text
    unit: str = ""
    values: Annotated[tuple[Number, ...], Field(min_length=1)]
    joint: Text | None = None
    """The robot's joint whose angles at the way-points these are, in the unit of position."""
    note: str = ""


class Cartesian(Strict):
    """A printed position of the robot's end at one way-point."""

    id: Id
    where: Text
    label: str = ""
    waypoint: Text | None = None
    """Label of the joint way-point that it belongs to; by position in both lists if absent."""
    unit: LengthUnit
    values: tuple[Number, ...]
    """x, y, z in the base frame."""
    note: str = ""

    @model_validator(mode="after")
    def _three(self) -> Self:
        if len(self.values) != 3:
            raise fault(".values", f"has {len(self.values)} numbers; give x, y and z")
        return self


class NotCheckable(Strict):
    """Something that the text extraction may have damaged."""

    id: Id
    where: Text
    what: Text
    why: Text


class Transcription(Strict):
    """Who typed the numbers of the file, and who compared them with the paper."""

    by: Text
    """Who typed them, and from what."""
    checked_by: str = ""
    """Who compared them with the paper, and how; empty where nobody has."""


class CaseFile(ProblemData):
    """A case file: what one paper prints, and how it can be read."""

    format: Literal[1]
    id: Id
    title: Text
    source: Source
    robot: Robot
    objective: Text | None = None
    """What the paper minimises, if not time alone."""
    transcription: Transcription | None = None
    problems: tuple[ProblemBlock, ...] = ()
    readings: tuple[Reading, ...] = ()
    algorithms: tuple[AlgorithmBlock, ...] = ()
    families: tuple[InstancesBlock, ...] = ()
    tables: tuple[Table, ...] = ()
    claims: tuple[AnyClaim, ...] = ()
    clues: tuple[AnyClue, ...] = ()
    assumptions: tuple[Assumption, ...] = ()
    columns: tuple[Column, ...] = ()
    cartesian: tuple[Cartesian, ...] = ()
    equations: tuple[Equation, ...] = ()
    not_checkable: tuple[NotCheckable, ...] = ()


LISTS = tuple(
    name for name, one in CaseFile.model_fields.items() if get_origin(one.annotation) is tuple
)
"""Lists of blocks with ids, in the order in which their faults are listed."""


def case_schema() -> dict[str, Any]:
    """JSON Schema of a case file, for editors."""
    schema = CaseFile.model_json_schema()
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        **schema,
        "title": "trajgap case file, format 1",
    }
