"""What an audit says: findings of rules with permanent ids, and a verdict on each claim."""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import Enum, auto
from typing import Annotated, Any

from pydantic import AfterValidator, Field, PlainSerializer, WithJsonSchema

from ...nlp import Evidence
from ...problem import shown_bound
from .entry import Entry, OrLeftOut, OrWhy, Real, Why
from .vocabulary import Basis, ClaimVerdict, Confidence, GapKind, Scope, Severity
from .why_judged import capital, opened

UNCERTIFIED = Why("not certified")
"""Why there is no lower bound, where no certificate proves one."""


def _evidence(data: dict[str, Any]) -> Evidence:
    return Evidence.BEST_KNOWN if isinstance(data.get("lower"), Why) else Evidence.CERTIFIED


UNDECIDED = Why("it decides nothing")
"""Why a finding that is not checkable has no confidence."""


def _severity(data: dict[str, Any]) -> Severity:
    """What a verdict weighs, unless its rule says otherwise."""
    weights = {ClaimVerdict.REFUTED: Severity.ERROR, ClaimVerdict.INCONSISTENT: Severity.WARNING}
    return weights.get(data["verdict"], Severity.INFO)


def _confidence(data: dict[str, Any]) -> Confidence | Why:
    """How a finding is known, from what it rests on, its reading and its reference."""
    if data.get("basis") is Basis.REPLAY:
        return Confidence.REPLAY
    if data.get("verdict") is ClaimVerdict.NOT_CHECKABLE:
        return UNDECIDED
    if data.get("evidence") is Evidence.BEST_KNOWN:
        return Confidence.BEST_KNOWN
    if data.get("evidence") is Evidence.UNCONVERGED:
        return Confidence.UNCONVERGED
    if data.get("basis") is Basis.COMPUTED:
        return Confidence.COMPUTED
    # What needs no curve and no motion: under no reading in particular, digits alone decide.
    digits_alone = (Basis.DIGITS, Basis.COUNT, Basis.IDENTITY, Basis.TEXT)
    own = data.get("reading") is None and data.get("basis") in digits_alone
    return Confidence.DIGITS if own else Confidence.PROVEN


def _begun(parts: tuple[str, ...]) -> tuple[str, ...]:
    """Sentences without empty ones, the first with a capital, whatever place it begins with."""
    first, *others = filter(None, parts)
    return capital(first), *others


def _whole(data: dict[str, Any]) -> str:
    return " ".join(data["sentences"])


def _opening(data: dict[str, Any]) -> str | None:
    # Words of the opening of a reason: a verdict and its numbers have room.
    shown, rest = opened(data["sentences"], 60)
    return " ".join(shown) if rest else None


class Reference(Entry):
    """A reference time: the best known value, and a certified lower bound if there is one."""

    upper: Real
    """Total of a feasible trajectory, s."""
    lower: OrWhy[float] = UNCERTIFIED
    """Certified lower bound on the optimum, s."""
    evidence: Evidence = Field(default_factory=_evidence)
    """Certified if there is a lower bound, else best known; of a solution, that of its search."""

    @property
    def width(self) -> float | None:
        """How far the optimum may lie below the best known value; None if nothing is certified."""
        return None if isinstance(self.lower, Why) else 1 - self.lower / self.upper


def percent_ends(low: float, high: float) -> tuple[str, str]:
    """Both ends of a range of percentages, rounded outwards to decimals that both share.

    These give the end that lies further from 0 three digits.
    """
    far = max(abs(low), abs(high))
    places = max(0, 2 - math.floor(math.log10(far))) if far else 0
    return shown_bound(low, "lower", places=places), shown_bound(high, "upper", places=places)


def percent_digits(low: float, high: float) -> tuple[str, ...]:
    """A range of percentages: one number where its three digits show no width, or both ends."""
    if high - low < max(0.005 * abs(low), 5e-4):
        return (f"{(low + high) / 2:.3g}",)
    return percent_ends(low, high)


def at_least_percent(share: float) -> str:
    """A share as a percentage that is not larger: a decimal, or two digits below 1 %."""
    percent = 100 * share
    if percent >= 1:
        return f"{shown_bound(percent, 'lower', places=1)} %"
    return f"{shown_bound(percent, 'lower', digits=2)} %"


class Gap(Entry):
    """Relative distance of a time from the optimum, never clipped."""

    kind: GapKind
    lowest: Real
    """(T − U)/U at the low end of the time's interval; negative if T is below the reference."""
    highest: Real
    """(T − U)/U at its high end; relative to the lower bound instead, if one is certified."""
    reference: Reference

    @property
    def many_times(self) -> bool:
        """Whether the time is too many times the reference for a percentage."""
        return self.lowest > 10

    @property
    def percent(self) -> str:
        """The interval in percent, or as a factor if the time is many times the reference."""
        if self.many_times:
            return f"{shown_bound(1 + self.lowest, 'lower', digits=4)} times the reference"
        ends = percent_digits(100 * self.lowest, 100 * self.highest)
        return f"{' to '.join(one if one.startswith('-') else f'+{one}' for one in ends)} %"

    def __str__(self) -> str:
        said = f"{self.percent} ({self.kind}, reference {self.reference.evidence})"
        # `highest` is relative to the proven bound, where there is one.
        undercut = self.highest < 0 and not isinstance(self.reference.lower, Why)
        return f"{said}; no motion within the limits is that short" if undercut else said


class Finding(Entry):
    """One conclusion of one rule."""

    rule: Annotated[str, Field(pattern=r"^TG[0-9]{3}$")]
    """Permanent id, e.g. "TG101"."""
    verdict: ClaimVerdict = ClaimVerdict.NOT_CHECKABLE
    severity: Severity = Field(default_factory=_severity)
    scope: Scope = Scope.NO
    """Under how many admissible readings the verdict of this finding holds; set by the audit."""
    evidence: Evidence = Evidence.NONE
    """Whether the reference value is best known or certified; none if none is used."""
    basis: Basis
    decides: bool = True
    """Whether the finding enters the verdict on its claim."""
    claim: str | None = None
    """What it is about; null if it is about the case or a table and judges no claim."""
    problem: str | None = None
    """Null if it depends on none."""
    reading: str | None = None
    """Null if it depends on none."""
    confidence: OrWhy[Confidence] = Field(default_factory=_confidence)
    """How it is known; null if it decides nothing."""
    printed: str | None = None
    """The printed digits, with units."""
    computed: str | None = None
    """What was computed, with units."""
    gap: OrWhy[Gap] = Why("no time is compared with an optimum")
    kind: Annotated[str, Field(min_length=1)]
    """Key shared by findings of a rule that differ only in their numbers."""
    sentences: Annotated[tuple[str, ...], AfterValidator(_begun)] = Field(exclude=True)
    """The result, then conditions and what was tried, all with their numbers; not in JSON."""
    message: str = Field(default_factory=_whole)
    """All sentences in one text."""
    root: str = Field(default="", exclude=True)
    """Key that findings of one cause share; empty if it shares none; not in JSON."""
    follows: tuple[str, ...] = Field(default=(), exclude=True)
    """Roots that imply it, if they are found; not in JSON."""
    built: bool = Field(default=False, exclude=True)
    """Whether it holds for every curve of the declared kind, whatever is printed; not in JSON."""
    between: tuple[str, ...] = Field(default=(), exclude=True)
    """Claims that contradict each other: neither side is taken; not in JSON."""
    doubts: tuple[str, ...] = Field(default=(), exclude=True)
    """Joints whose printed way-points it puts in doubt; not in JSON."""
    farthest: str = Field(default="", exclude=True)
    """Claim to whose total `gap` refers; not in JSON."""

    def adding(self, *sentences: str) -> Finding:
        """The same finding with more to say."""
        said = (*self.sentences, *sentences)
        return self.model_copy(update={"sentences": said, "message": " ".join(said)})


class CaveatKind(Enum):
    """What a caveat speaks of."""

    JUMPING = auto()
    """A motion's velocity jumps."""
    DOUBTED = auto()
    """Printed numbers contradict each other."""
    POINTS = auto()
    """It was judged by motions through way-points that a finding puts in doubt."""
    SOME_POINTS = auto()
    """It was, but not by these alone."""
    BUILT = auto()
    """A claim holds of any curve of its kind."""
    DEFINITION = auto()
    """A sentence defines something."""
    IDENTITY = auto()
    """It is true whatever the paper prints."""
    AIM = auto()
    """It says what is wanted."""
    JUDGEMENT = auto()
    """It names no measure that could be computed."""


@dataclass(frozen=True)
class Caveat:
    """What goes with a word: its kind for the code; what it says, and why, for the reader.

    JSON has its words alone, so that one that was read from there has no kind.
    """

    kind: CaveatKind | None
    says: str
    why: str = ""

    def __str__(self) -> str:
        return f"{self.says}: {self.why}" if self.why else self.says


class Judgement(Entry):
    """The verdict on one claim over all admissible readings."""

    claim: str
    verdict: ClaimVerdict
    scope: Scope
    evidence: Evidence
    confidence: OrWhy[Confidence] = Why("nothing decides it")
    """How it is known: a contradiction like its strongest finding, support like its weakest."""
    sentences: tuple[str, ...] = Field(default=(), exclude=True)
    """What decides, or why nothing does; not in JSON."""
    why: str = Field(default_factory=_whole)
    """All sentences in one text."""
    opening: OrLeftOut[str] = Field(default_factory=_opening)
    """The first sentences of a long reason, for places without room; null for a shorter one."""
    caveats: tuple[
        Annotated[Caveat, PlainSerializer(str), WithJsonSchema({"type": "string"})], ...
    ] = ()
    """Remarks on the verdict, such as a curve whose velocity jumps or a contradiction in print."""
    caveats_in_short: tuple[str, ...] = ()
    """Each of them without its reason."""
    beside: str = ""
    """Addition shown with the verdict everywhere, such as "but on doubtful numbers"."""
    readings: dict[str, ClaimVerdict]
    """The verdict under each reading separately."""
    informs: bool = Field(default=False, exclude=True)
    """Whether ``why`` comes from a finding that only informs and is not the reason for the
    verdict."""
