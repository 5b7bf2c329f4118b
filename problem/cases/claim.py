"""What a paper claims: one model per kind of quantity, every number as printed."""

from __future__ import annotations

from datetime import date
from enum import StrEnum
from typing import Annotated, Literal, Self

from pydantic import AfterValidator, Discriminator, Field, StrictInt, model_validator

from ..errors import TrajgapError
from ..printed import (
    Id,
    Length,
    Number,
    OneOrEachLength,
    Printed,
    PrintedRows,
    Strict,
    Text,
    fault,
    kinds_of,
)
from ..problem import Coupling


def _day(text: str) -> str:
    try:
        return date.fromisoformat(text).isoformat()
    except ValueError:
        raise TrajgapError(f"{text!r} is not a day; write it as 2026-01-31") from None


Day = Annotated[Text, AfterValidator(_day)]
"""A day of the calendar, such as "2026-01-31"."""


_NAMED = "name the curve there as the paper does"
"""How to fix a key that belongs to another curve than the problem's."""


class AuthorsAnswer(Strict):
    """What the authors were asked about a claim, and what they said."""

    sent: Day
    """When they were asked."""
    answered: Day | None = None
    """When they answered; absent while they have not."""
    outcome: str = ""
    """What came of it, in a sentence of ours."""


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
    answer: AuthorsAnswer | None = None
    """What the authors say of it, where they were asked."""


class TimeClaim(Claim):
    """What claims of a time have in common."""

    state: Literal["before"] | None = None
    """"before" for the state before an optimisation, of which no limit or optimum is claimed."""
    other_curve: Text | None = None
    """Name of the curve that it belongs to, where that is not the problem's own."""
    objective: Text | None = None
    """What was minimised for it, where that is not what the file says; "time" for time alone."""


class DurationsClaim(TimeClaim):
    """Segment durations, and their total where it is printed."""

    quantity: Literal["durations"]
    durations: Annotated[tuple[Length, ...], Field(min_length=1)]
    """Duration of each segment."""
    total: Length | None = None
    """Printed total."""
    blends: OneOrEachLength | None = None
    """Durations of the blends, where `other_curve` is linear segments with parabolic blends: one
    for all way-points or one for each, in the unit of time."""
    end_blends: Literal["within", "beyond"] | None = None
    """Whether the first and the last blend lie within the first and the last duration, or reach
    half beyond them; either if absent."""
    blend_acceleration: OneOrEachLength | None = None
    """Acceleration within the blends, where that is printed instead: one for all joints or one for
    each."""

    @model_validator(mode="after")
    def _blends_of_another_curve(self) -> Self:
        for key in ("blends", "blend_acceleration"):
            self.require(key, "other_curve", _NAMED)
        if self.blends is None and self.blend_acceleration is None:
            self.require("end_blends", "blends or blend_acceleration", "add one of them")
        if self.blends is not None and self.blend_acceleration is not None:
            raise fault(
                ".blend_acceleration",
                "cannot be combined with blends; keep one of the two, because the other follows "
                "from it",
            )
        return self


class MaximumClaim(TimeClaim):
    """The longest of several claims' durations, segment by segment."""

    quantity: Literal["maximum"]
    of: Annotated[tuple[Id, ...], Field(min_length=1)]
    """The claims whose durations are compared."""
    durations: Annotated[tuple[Length, ...], Field(min_length=1)]
    """Longest duration of each segment."""
    total: Length | None = None
    """Printed total."""


class ProfiledClaim(TimeClaim):
    """What claims of a profile of velocity have in common."""

    profile: (
        Literal[
            "trapezoidal",
            "s-curve",
            "sine-jerk",
            "fourth-order",
            "biagiotti-melchiorri",
            "jerk-impulses",
        ]
        | None
    ) = None
    """The profile of `other_curve`, where it is one that joins the way-points segment by segment:
    the shortest with constant acceleration and speed, with constant jerk, or with jerk in half
    sines; with constant snap; that of the algorithm of Biagiotti and Melchiorri, which is not
    always the shortest; or that of Riboli et al. with a plateau speed. It is at rest at way-points
    in between, and at the ends as the interpolant prescribes."""
    path: Literal["straight", "curve", "sampled"] | None = None
    """How the joints go together: "straight" in a profile, on a straight line between way-points,
    all by one time law; each by itself if absent. Without a profile, timed anew from rest to rest:
    "curve" along the path of the problem's curve at its fixed ratios; "sampled" along a path which
    the way-points sample and the curve approximates."""
    deceleration: OneOrEachLength | None = None
    """Trapezoids: largest acceleration while the speed falls, in the unit of acceleration, where it
    differs from that while the speed grows."""
    snap: OneOrEachLength | None = None
    """Fourth-order profiles: largest derivative of the jerk, in the unit of jerk per unit of
    time."""
    plateau: Number | None = None
    """Profiles of jerk impulses: the velocity that is kept between both ends, with its sign."""

    @property
    def along_path(self) -> bool:
        """Whether the total is of a motion along the path of the problem's curve."""
        return self.path in ("curve", "sampled")

    @model_validator(mode="after")
    def _on_another_curve(self) -> Self:
        self.require("profile", "other_curve", _NAMED)
        if self.path == "straight":
            self.require("path", "profile")
        if self.along_path and (self.profile is not None or self.other_curve is None):
            raise fault(".path", f'"{self.path}" requires other_curve, and excludes profile')
        for key, profile, needed in (
            ("deceleration", "trapezoidal", False),
            ("snap", "fourth-order", True),
            ("plateau", "jerk-impulses", True),
        ):
            given = getattr(self, key) is not None
            if given and self.profile != profile:
                raise fault(
                    f".{key}", f'goes with profile = "{profile}" only; add that, or leave it out'
                )
            if needed and not given and self.profile == profile:
                raise fault(f".{key}", f'is missing; profile "{profile}" needs it')
        return self


class TotalTimeClaim(ProfiledClaim):
    """A total time printed by itself."""

    quantity: Literal["total_time"]
    of: Id | None = None
    """The claim of durations whose total it states, where that is printed elsewhere."""
    value: Length
    """Total time."""


class PhasesClaim(ProfiledClaim):
    """The phases of a profile of one segment, printed with their total or instead of it."""

    quantity: Literal["phases"]
    phases: tuple[Length, Length, Length]
    """How long it accelerates in the direction of the way, keeps its speed, and accelerates against
    that direction."""
    ramps: tuple[Length, Length] | None = None
    """How long the jerk lasts at the start of the first phase and at the end of the last one."""

    @model_validator(mode="after")
    def _of_a_profile(self) -> Self:
        if self.profile is None:
            raise fault(".profile", "is missing; name the profile that has these phases")
        return self


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
        self.require("base", "percent")
        return self


class MotionValueClaim(Claim):
    """What claims of a derivative of a motion have in common: one number, or one for each joint."""

    of: Id | None = None
    """The claim of durations whose motion it describes; the only one that fits if absent. Of a peak
    or a value also the claim of a profile."""
    derivative: Literal["velocity", "acceleration", "jerk"]
    """Which derivative."""
    value: Length | None = None
    """The number, in the file's units."""
    values: Annotated[tuple[Length, ...], Field(min_length=1)] | None = None
    """The same of each joint, in the order of the robot's joints."""

    @model_validator(mode="after")
    def _one_or_each(self) -> Self:
        if (self.value is None) == (self.values is None):
            raise fault(".value", "or values is needed, but not both; give one of them")
        if self.values is not None and self.joint is not None:
            raise fault(".joint", "cannot be combined with values, one per joint; leave it out")
        return self

    @property
    def printed(self) -> tuple[Printed, ...]:
        """Its numbers, one or one for each joint."""
        return self.values or (() if self.value is None else (self.value,))


class PeakClaim(MotionValueClaim):
    """The largest absolute value of a derivative."""

    quantity: Literal["peak"]


class MeasureClaim(MotionValueClaim):
    """A mean or an integral of a derivative over the motion.

    One number for several joints is that of their Euclidean norm, of the largest joint, or the mean
    of the joints.
    """

    quantity: Literal["measure"]
    measure: Literal["mean", "rms", "integral", "integral-square"]
    """"mean" of the absolute value and "rms" in the derivative's unit; "integral" of the absolute
    value in that times the unit of time; "integral-square" in its square times the unit of time."""


class ValueClaim(MotionValueClaim):
    """A position or a derivative at one place of the motion, with its sign."""

    quantity: Literal["value"]
    derivative: Literal["position", "velocity", "acceleration", "jerk"]  # type: ignore[assignment]
    """What it is a value of; "position" for the joint's own angle or length."""
    value: Number | None = None
    values: Annotated[tuple[Number, ...], Field(min_length=1)] | None = None
    place: Text | None = None
    """"start", "finish", "largest" or "smallest" over the motion, or a way-point: its label, or its
    number from 1 where way-points have none."""
    time: Length | None = None
    """Instead of a place: the instant, from the start on."""

    @model_validator(mode="after")
    def _one_place(self) -> Self:
        if (self.place is None) == (self.time is None):
            raise fault(".place", "or time is needed, but not both; give one of them")
        return self


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


class Nature(StrEnum):
    """What a sentence is that claims no result which numbers could decide."""

    DEFINITION = "definition"
    """How something is called, made or set up."""
    IDENTITY = "identity"
    """Mathematics that holds whatever the paper prints."""
    AIM = "aim"
    """What is wanted, not what was reached."""
    JUDGEMENT = "judgement"
    """An opinion of which no measure is named."""


class StatementClaim(Claim):
    """A claim in words."""

    quantity: Literal["statement"]
    checks: Literal[
        "within_limits",
        "continuous",
        "jumps",
        "at_rest",
        "optimal",
        "kinematics",
        "varies_most",
        "varies_much",
        "above",
        "equations",
        "none",
    ]
    """How it can be checked on the claims named in ``of``; "jumps" says that acceleration does,
    "at_rest" that velocity is 0 at both ends. Without ``of``: "kinematics" says that the joint
    angles and the positions agree, "varies_most" and "varies_much" that ``joint`` does, "above"
    that the first of ``positions`` lies above the second, "equations" that those of the file hold
    on the printed robot."""
    of: tuple[Id, ...] = ()
    """The claims whose durations it speaks about."""
    derivative: Literal["velocity", "acceleration"] | None = None
    """The highest derivative that a "continuous" sentence names; absent if it names none."""
    positions: tuple[Id, ...] = ()
    """Two printed positions, where ``checks`` is "above"."""
    against: Id | None = None
    """Another algorithm that the claim's own is compared with: replays of both stand beside it."""
    not_checkable: str | None = None
    """Why it cannot be checked; needed exactly if ``checks`` is "none"."""
    nature: Nature | None = None
    """What it is where it claims no result; with ``checks`` "none" only."""

    @model_validator(mode="after")
    def _reason(self) -> Self:
        if self.nature is not None and self.checks != "none":
            raise fault(".nature", 'requires checks = "none"; remove it, or set checks = "none"')
        if (self.checks == "none") != bool(self.not_checkable):
            raise fault(
                ".not_checkable",
                'is required with checks = "none", and allowed only there; state why the sentence '
                "cannot be checked, or choose another check",
            )
        if self.derivative is not None and self.checks != "continuous":
            raise fault(".derivative", 'is allowed only with checks = "continuous"; remove it')
        if (self.checks == "above") != (len(self.positions) == 2):
            raise fault(
                ".positions", 'names two positions, and is allowed only with checks = "above"'
            )
        if self.checks in ("varies_most", "varies_much") and self.joint is None:
            how = self.checks.removeprefix("varies_")
            raise fault(".joint", f"is missing; name the joint that is said to vary {how}")
        self.require("against", "algorithm", "name the one that is compared with it")
        return self


AnyClaim = Annotated[
    DurationsClaim
    | MaximumClaim
    | TotalTimeClaim
    | PhasesClaim
    | ImprovementClaim
    | PeakClaim
    | MeasureClaim
    | ValueClaim
    | ConvergenceClaim
    | ConditionsClaim
    | ControlVerticesClaim
    | StatementClaim,
    Discriminator("quantity"),
]
"""Any kind of claim, told apart by ``quantity``."""

QUANTITY_KINDS = kinds_of(AnyClaim, "quantity")
"""The values of ``quantity``."""
