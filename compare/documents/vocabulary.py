"""The words of an audit, each with its one explanation: pages, docs and JSON Schema read them here.

A word is a member of an enumeration, and the docstring below it is its explanation.
"""

from __future__ import annotations

import ast
import inspect
from dataclasses import dataclass
from enum import StrEnum
from itertools import pairwise

from ...nlp import Evidence, Outcome, Route, Status
from ...problem import Coupling, Verdict
from ...problem.motions import Interpolation, MotionForm
from ...verify import Subject


class Severity(StrEnum):
    """How much a finding weighs; tied to its conclusion, never to a digit."""

    ERROR = "error"
    """A proof contradicts something printed, or shows that two printed statements contradict each
    other, under any reading."""
    WARNING = "warning"
    """A proof contradicts something printed under some readings and not under all, printed things
    do not fit together, or a best known value speaks against a statement."""
    INFO = "info"
    """A fact about the claim, or support for it."""


class Urgency(StrEnum):
    """How much hangs on a piece of advice."""

    CONTRADICTED = "contradicted"
    """A reader can prove it wrong from the draft alone."""
    DOUBTFUL = "doubtful"
    """Wrong under some reading, or it contradicts another printed number."""
    FOLLOWS = "follows"
    """Right as it is, but wrong once the other changes are made."""
    OPEN = "open"
    """It cannot be checked from what is printed, or the answer depends on the reading."""


class ClaimVerdict(StrEnum):
    """Verdict on a claim."""

    SUPPORTED = "supported"
    """The computation agrees with the claim."""
    REFUTED = "refuted"
    """A proof contradicts the claim: interval arithmetic on the printed digits, a count of
    conditions, an enclosure that holds however the digits were rounded, a scaling law, or a
    checked motion that is shorter than one called optimal."""
    NOT_CHECKABLE = "not checkable"
    """The text contains nothing that decides it, and the reason is given."""
    INCONSISTENT = "inconsistent"
    """Two printed statements contradict each other; neither alone is refuted."""
    DEPENDS = "depends on the reading"
    """The admissible readings of the text give different verdicts; the report shows each with its
    reading."""


AGAINST = (ClaimVerdict.REFUTED, ClaimVerdict.INCONSISTENT, ClaimVerdict.DEPENDS)
"""Verdicts that speak against a claim, the gravest first."""


class Scope(StrEnum):
    """Under how many admissible readings of the text the verdict holds.

    If they disagree, or only some of them were computed, it holds under some.
    """

    ALL = "all"
    SOME = "some"
    NO = "no"


class Basis(StrEnum):
    """What a finding rests on."""

    DIGITS = "printed digits"
    """Interval arithmetic on the printed numbers alone."""
    COUNT = "count"
    """Conditions counted against coefficients."""
    ENCLOSURE = "rounding box"
    """True peaks, however the printed digits were rounded."""
    CHECK = "check"
    """True peaks at the printed point."""
    COMPUTED = "computed"
    """The same, but the effect of rounding in other digits, and of sampling, is estimated, not
    enclosed."""
    IDENTITY = "identity"
    """A scaling law that needs no solver."""
    OPTIMUM = "optimum"
    """A reference value of the exact side, or a checked motion."""
    REPLAY = "replay"
    """Seeded runs of the algorithm under the listed choices. They may fail to reproduce a number,
    but never refute it."""
    KINEMATICS = "kinematics"
    """Forward kinematics of the printed table of the robot."""
    TEXT = "text"
    """What the extracted text contains or lacks."""


class Confidence(StrEnum):
    """How a verdict is known: what would have to be wrong for it to fall."""

    DIGITS = "printed digits"
    """It follows from the printed digits alone, whatever the reading: sums, percentages, counts of
    conditions, comparisons of tables."""
    PROVEN = "proven under a reading"
    """It follows from the curve, way-points and limits as a reading has them: by an enclosure over
    the rounding, by exact extrema of the printed motion, or by a certified bound."""
    COMPUTED = "computed under a reading"
    """It follows from exact extrema of the printed motion as a reading has it; the effect of
    rounding in the other printed digits, or of sampling, is estimated, not enclosed."""
    BEST_KNOWN = "best known"
    """It rests on the best motion found under a reading, with nothing proved below it."""
    UNCONVERGED = "not converged"
    """It rests on a checked motion at which a search stopped early: shorter ones are expected."""
    REPLAY = "replay"
    """It rests on seeded runs of the algorithm under listed choices; no verdict is of this kind,
    and findings that are only inform."""


class Rounding(StrEnum):
    """What holds for printed durations, however their digits were rounded."""

    KEEPS = "keeps"
    """The printed point itself keeps every limit for all t."""
    CONSISTENT = "consistent"
    """Some values that round to the printed digits keep every limit, and they are exhibited."""
    BREAKS = "breaks"
    """A limit is broken however the digits were rounded: a rigorous lower bound
    of the worst ratio over the whole rounding box exceeds 1."""
    UNDECIDED = "undecided"
    """Neither was shown."""


class Keeping(StrEnum):
    """The words of `Rounding` under one reading, digits rounded or cut off, and one more."""

    KEEPS = "keeps"
    CONSISTENT = "consistent"
    DISCONTINUOUS = "discontinuous"
    """The printed point keeps every limit inside the segments; its velocity jumps between them."""
    BREAKS = "breaks"
    UNDECIDED = "undecided"


class Speaks(StrEnum):
    """On which side a clue stands about one reading; it decides no verdict."""

    FOR = "for"
    """The result computed under the reading agrees with what is printed or known."""
    AGAINST = "against"
    """It does not fit."""


class GapKind(StrEnum):
    """The quantity that a gap refers to."""

    OPTIMALITY = "optimality gap"
    """(T − U)/U for a motion that keeps its limits, with U the reference total; an interval if T is
    printed. Never clipped: below the reference it is negative."""
    REPORTED = "difference of reported time"
    """The same number for a time whose motion is not shown to keep its limits."""


class Effect(StrEnum):
    """What a reduction of the total is due to."""

    BOTH = "both together"
    """Curve and algorithm: the procedure of the paper against the other one."""
    ALGORITHM = "algorithm alone"
    """The two algorithms on the curve of the paper's procedure."""
    CURVE = "curve alone"
    """The two curves at their best known totals, without any algorithm."""


class Worth(StrEnum):
    """What `verify` says of a file."""

    PROVES = "proves"
    """Its claim is proved."""
    ALTERED = "altered, still proves"
    """Its claim is proved, but a seal does not match: the file was altered."""
    REFUSED = "refused"
    """Its claim is not proved."""
    OUT_OF_TIME = "out of time"
    """The time ran out before anything was decided."""


class Uncovered(StrEnum):
    """How a certification ended that did not begin."""

    NOT_COVERED = "not covered"
    """No method for this curve; the reason is given."""


class MotionQuantity(StrEnum):
    """What is limited of a joint."""

    POSITION = "position"
    """Angle, or position of a sliding joint."""
    VELOCITY = "velocity"
    """Its derivative."""
    ACCELERATION = "acceleration"
    """Where `deceleration` is limited too: while the speed grows."""
    DECELERATION = "deceleration"
    """Acceleration while the speed falls."""
    JERK = "jerk"
    """Derivative of the acceleration."""


class Limited(StrEnum):
    """What is limited."""

    VELOCITY = "velocity"
    """Of a joint."""
    ACCELERATION = "acceleration"
    """Of a joint; where its deceleration has a limit of its own, while the speed grows."""
    DECELERATION = "deceleration"
    """Of a joint: its acceleration while the speed falls."""
    JERK = "jerk"
    """Of a joint."""
    SNAP = "snap"
    """Of a joint: the derivative of its jerk."""
    POSITION = "position"
    """Angle of a joint, or position of a sliding joint."""
    DURATION = "duration"
    """Of a segment."""
    CURVE = "curve"
    """The durations define no curve."""


UNITS = {
    "position": "rad",
    "velocity": "rad/s",
    "acceleration": "rad/s²",
    "deceleration": "rad/s²",
    "jerk": "rad/s³",
    "snap": "rad/s⁴",
}
"""Units of what is limited, as everything is computed of joints that turn."""


def si_unit(quantity: str, linear: bool) -> str:
    """The unit in which a quantity of a joint is computed, by whether the joint slides."""
    return UNITS[quantity].replace("rad", "m") if linear else UNITS[quantity]


def meanings(*enums: type[StrEnum]) -> dict[str, str]:
    """The words of enumerations that are explained there, with their explanations.

    Word to the docstring below it, in the order of the members; of a word that several explain, the
    first one's.
    """
    found: dict[str, str] = {}
    for words in enums:
        (declared,) = ast.parse(inspect.getsource(words)).body
        body = declared.body if isinstance(declared, ast.ClassDef) else []
        for member, below in pairwise(body):
            match member, below:
                case ast.Assign(targets=[ast.Name(name)]), ast.Expr(ast.Constant(str(text))):
                    found.setdefault(str(words[name]), " ".join(text.split()))
    return found


def meaning(words: type[StrEnum]) -> str:
    """What an enumeration tells apart: its docstring, on one line."""
    return " ".join((words.__doc__ or "").split())


@dataclass(frozen=True)
class Words:
    """Words that one key of the documents may hold."""

    key: str
    """As docs/reference/command-line.md names it."""
    enums: tuple[type[StrEnum], ...]
    table: str = ""
    """Name of the table in the docs that explains them; empty if the list of keys does."""


VOCABULARY = (
    Words("`status`", (Status,)),
    Words("`route`", (Route,)),
    Words("`coupling`", (Coupling,)),
    Words("`verdict` of a check", (Verdict,)),
    Words("`keeping`", (Keeping,)),
    Words("`speaks`: a clue about a reading", (Speaks,)),
    Words("`rounding_verdict`", (Rounding,), "rounding"),
    Words(
        "`evidence`; of a verdict or a finding the word for its reference", (Evidence,), "evidence"
    ),
    Words("`outcome`", (Outcome, Uncovered), "outcome"),
    Words("`worth`", (Worth,)),
    Words("`subject`", (Subject,)),
    Words("`severity`", (Severity,), "severity"),
    Words("`verdict` on a claim", (ClaimVerdict,), "claims"),
    Words("`urgency` of advice", (Urgency,)),
    Words("`scope`: how many readings", (Scope,)),
    Words("`basis`", (Basis,)),
    Words("`confidence` of a verdict or a finding", (Confidence,), "confidence"),
    Words("`effect` of a reduction", (Effect,)),
    Words("`kind` of a gap", (GapKind,)),
    Words("`quantity`", (Limited,)),
    Words("`quantity` of a motion from elsewhere", (MotionQuantity,)),
    Words("`interpolation`", (Interpolation,)),
    Words("`form` of a written motion", (MotionForm,)),
)
"""Every set of words in the documents, in the order of docs/reference/command-line.md."""

TIMES = {
    "feasible time": "T·max(1, c*): all durations stretched until every limit is kept.",
    "tight time": "T·c*: all durations rescaled until a limit is just reached.",
}
"""Times that are not members of an enumeration and stand beside the gaps."""

TERMS = {
    "reading": "One way to understand what the text leaves open; everything is computed under each "
    "reading that the text admits.",
    "shared durations": "All joints pass each way-point together, so they share the segment "
    "durations.",
    "at these ratios": "The question fixes the ratios of the segment durations, so only their "
    "total is chosen. Durations in other ratios answer another question.",
    "relaxed family": "Curves of degree 5 or more in every segment, C2, through the same "
    "way-points, within the same limits and end conditions; the optimiser uses the remaining "
    "freedom.",
    "TOPPRA": "The fastest motion along the path of a given curve, under velocity and acceleration "
    "limits only; on grids, extrapolated.",
    "any curve through the way-points": "The fastest motion of bounded velocity and acceleration "
    "on any curve; the joints are synchronised at the way-points only.",
    "KKT residual": "Scaled distance from the first-order conditions of an optimum; a value near "
    "0 means that they hold, which does not prove a global optimum.",
    "on doubtful numbers": "A verdict rests on printed numbers that others in the same paper "
    "contradict; neither side is taken.",
    "on doubtful way-points": "According to a finding, the way-points of a verdict may be "
    "misprinted.",
    "by construction": "True of every curve of that kind, whatever the printed numbers, so it is "
    "no evidence for them.",
    "starts at best": "How many starts of the local solver ended at the lowest total found.",
}
"""Terms of the pages that are not members of an enumeration: steps, optima and runs."""


@dataclass(frozen=True)
class Rule:
    """A rule's permanent id and what it looks at."""

    id: str
    title: str
