"""What a paper claims: one model per kind of quantity, every number as printed."""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import Discriminator, Field, StrictInt, model_validator

from ..fields import Id, Length, Number, PrintedRows, Strict, Text, fault
from ..printed import Printed
from ..problem import Coupling


class Claim(Strict):
    """What every claim has in common."""

    id: Id
    """Permanent name of the claim, unique in the file."""
    where: Text
    """Place in the paper: section, table, row, abstract."""
    text: str = ""
    """What the paper says, in English."""
    problem: Id | None = None
    """The problem that it speaks about; all problems if absent."""
    joint: str | None = None
    """Joint label; the whole robot if absent."""
    algorithm: Id | None = None
    """The algorithm whose result it states."""
    coupling: Coupling | None = None
    """How the joints share the stated durations; as the problem has it if absent."""
    table: Id | None = None
    """The table that prints it."""
    printed_tables: tuple[Id, ...] = ()
    """Further tables that the claim speaks about."""


class TimeClaim(Claim):
    """What claims of a time have in common."""

    state: Literal["before"] | None = None
    """"before" for the state before an optimisation, of which no limit or optimum is claimed."""
    other_curve: Text | None = None
    """Name of the curve that it belongs to, where that is not the problem's own."""


class DurationsClaim(TimeClaim):
    """Segment durations, and their total where it is printed."""

    quantity: Literal["durations"]
    durations: Annotated[tuple[Length, ...], Field(min_length=1)]
    """Duration of each segment."""
    total: Length | None = None
    """Printed total."""


class MaximumClaim(TimeClaim):
    """The longest of several claims' durations, segment by segment."""

    quantity: Literal["maximum"]
    of: Annotated[tuple[Id, ...], Field(min_length=1)]
    """The claims whose durations are compared."""
    durations: Annotated[tuple[Length, ...], Field(min_length=1)]
    """Longest duration of each segment."""
    total: Length | None = None
    """Printed total."""


class TotalTimeClaim(TimeClaim):
    """A total time printed by itself."""

    quantity: Literal["total_time"]
    of: Id | None = None
    """The claim of durations whose total it states, where that is printed elsewhere."""
    value: Length
    """Total time."""


class ImprovementClaim(Claim):
    """One total is shorter than another, by a percentage or a time if either is printed."""

    quantity: Literal["improvement"]
    slower: Id
    """The claim that states the longer total."""
    faster: Id
    """The claim that states the shorter total."""
    percent: Number | None = None
    """Reduction in percent of `base`."""
    base: Literal["slower", "faster"] | None = None
    """What the percentage is a share of; either total where the text leaves it open."""
    seconds: Number | None = None
    """Reduction in the unit of time of the file."""

    @model_validator(mode="after")
    def _two_claims(self) -> Self:
        if self.slower == self.faster:
            raise fault(".faster", "is the same claim as slower; name two claims")
        if self.base is not None and self.percent is None:
            raise fault(".base", "goes with percent; add it, or leave this out")
        return self


class PeakClaim(Claim):
    """The largest absolute value of a derivative: one number, or one for each joint."""

    quantity: Literal["peak"]
    of: Id | None = None
    """The claim of durations whose motion it describes; the only one that fits if absent."""
    derivative: Literal["velocity", "acceleration", "jerk"]
    """Which derivative."""
    value: Length | None = None
    """Largest absolute value, in the file's unit of that derivative."""
    values: Annotated[tuple[Length, ...], Field(min_length=1)] | None = None
    """The same of each joint, in the order of the robot's joints."""

    @model_validator(mode="after")
    def _one_or_each(self) -> Self:
        if (self.value is None) == (self.values is None):
            raise fault(".value", "or values is needed, and not both; give one of them")
        if self.values is not None and self.joint is not None:
            raise fault(".joint", "does not go with values, one per joint; leave it out")
        return self

    @property
    def printed(self) -> tuple[Printed, ...]:
        """Its numbers, one or one for each joint."""
        return self.values or (() if self.value is None else (self.value,))


class ConvergenceClaim(Claim):
    """An algorithm converges within a number of iterations."""

    quantity: Literal["convergence"]
    iterations: Length
    """Number of iterations."""


class ConditionsClaim(Claim):
    """Conditions on the curve that can be counted against its coefficients."""

    quantity: Literal["conditions"]
    rest_at: Literal["ends", "all"]
    """Where the derivatives are said to vanish: at both ends, or at all way-points."""
    orders: tuple[Annotated[StrictInt, Field(ge=1)], ...]
    """Orders of the derivatives said to vanish (1 velocity, 2 acceleration)."""
    degrees: Annotated[tuple[Annotated[StrictInt, Field(ge=1, le=9)], ...], Field(min_length=1)]
    """Polynomial degree of each segment."""
    continuity: Annotated[StrictInt, Field(ge=0)] = 2
    """Highest derivative said to be continuous at the via-points."""
    count: Length | None = None
    """Number of conditions, where it is printed."""
    of: tuple[Id, ...] = ()
    """Claims of durations on whose motion the rest is evaluated; those of its problem if empty."""


class ControlVerticesClaim(Claim):
    """Control vertices of the uniform cubic B-spline through the way-points.

    In the unit of the way-points, in the same order of joints.
    """

    quantity: Literal["control_vertices"]
    joint_rows: PrintedRows
    """One row per joint: two more numbers than way-points."""


class StatementClaim(Claim):
    """A claim in words."""

    quantity: Literal["statement"]
    checks: Literal["within_limits", "continuous", "jumps", "at_rest", "optimal", "none"]
    """How it can be checked on the claims named in ``of``; "jumps" says that acceleration does,
    "at_rest" that velocity is 0 at both ends."""
    of: tuple[Id, ...] = ()
    """The claims whose durations it speaks about."""
    not_checkable: str | None = None
    """Why it cannot be checked; needed exactly if ``checks`` is "none"."""

    @model_validator(mode="after")
    def _reason(self) -> Self:
        if (self.checks == "none") != bool(self.not_checkable):
            raise fault(
                ".not_checkable",
                'goes with checks = "none" and only with it; say why it cannot be checked, '
                "or how it can",
            )
        return self


AnyClaim = Annotated[
    DurationsClaim
    | MaximumClaim
    | TotalTimeClaim
    | ImprovementClaim
    | PeakClaim
    | ConvergenceClaim
    | ConditionsClaim
    | ControlVerticesClaim
    | StatementClaim,
    Discriminator("quantity"),
]
"""Any kind of claim, told apart by ``quantity``."""

QUANTITY_KINDS = (
    "durations",
    "maximum",
    "total_time",
    "improvement",
    "peak",
    "convergence",
    "conditions",
    "control_vertices",
    "statement",
)
"""The values of ``quantity``."""
