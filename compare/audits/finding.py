"""What an audit says: findings of rules with permanent ids, and a verdict on each claim."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass, replace
from enum import StrEnum

from ...nlp import Evidence
from ..gaps import Gap


class Severity(StrEnum):
    """How much a finding weighs; tied to its conclusion, never to a digit."""

    ERROR = "error"
    """A proof of digits, counts, enclosures or a shorter motion contradicts something printed, or
    shows that two printed things contradict each other, whatever the reading."""
    WARNING = "warning"
    """Printed things do not fit together, a best known value speaks against a statement, or a
    proof contradicts something printed under some admissible readings and not under all."""
    INFO = "info"
    """A fact beside the claim, or support for it."""


class ClaimVerdict(StrEnum):
    """What can be said of a claim."""

    SUPPORTED = "supported"
    REFUTED = "refuted"
    NOT_CHECKABLE = "not checkable"
    INCONSISTENT = "inconsistent"
    """Two printed things contradict each other; neither alone is refuted."""


class Scope(StrEnum):
    """Under how many of the admissible readings a verdict holds."""

    ALL = "all"
    SOME = "some"
    NO = "no"
    """Decided under no reading."""


class Basis(StrEnum):
    """What a finding rests on."""

    DIGITS = "printed digits"
    """Interval arithmetic on the printed numbers alone."""
    COUNT = "count"
    """Conditions counted against coefficients."""
    ENCLOSURE = "rounding box"
    """True peaks over the box of all inputs that print alike."""
    CHECK = "check"
    """True peaks at the printed point."""
    IDENTITY = "identity"
    """A scaling law that needs no solver."""
    OPTIMUM = "optimum"
    """A reference value of the exact side."""
    REPLAY = "replay"
    """Seeded runs of the algorithm under the listed choices."""
    KINEMATICS = "kinematics"
    """Forward kinematics of the printed table of the robot."""
    TEXT = "text"
    """What the extracted text carries or does not."""


@dataclass(frozen=True)
class Finding:
    """One conclusion of one rule.

    Attributes
    ----------
    rule : str
        Permanent id, e.g. "TG101".
    severity : Severity
    verdict : ClaimVerdict
    scope : Scope
        Under how many admissible readings the verdict of this finding holds.
    evidence : Evidence
        Of the reference value used; ``none`` where none is used.
    basis : Basis
    claim, problem, reading : str or None
        What it is about; None means it does not depend on it.
    printed, computed : str or None
        The printed digits, and what was computed, with units.
    gap : Gap or None
    message : str
        One or two sentences with the numbers.
    decides : bool
        Whether the finding enters the verdict on its claim.
    """

    rule: str
    severity: Severity
    verdict: ClaimVerdict
    scope: Scope
    evidence: Evidence
    basis: Basis
    claim: str | None
    problem: str | None
    reading: str | None
    printed: str | None
    computed: str | None
    gap: Gap | None
    message: str
    decides: bool = True


def gist(message: str) -> str:
    """What a message says apart from its numbers: its words up to the first colon.

    Examples
    --------
    >>> gist("Jumps at 8 breaks, by 0.5 rad/s: joint 2") == gist("Jumps at 9 breaks, by 2 rad/s.")
    True
    """
    return re.sub(r"\d[\d.]*", "#", message.partition(":")[0]).rstrip(".")


@dataclass(frozen=True)
class Judgement:
    """The verdict on one claim over all admissible readings."""

    claim: str
    verdict: ClaimVerdict
    scope: Scope
    evidence: Evidence
    why: str
    readings: tuple[tuple[str, ClaimVerdict], ...] = ()
    """The verdict under each reading by itself."""


@dataclass(frozen=True)
class Rule:
    """A rule's permanent id and what it looks at."""

    id: str
    title: str


RULES = (
    Rule("TG101", "A printed total is the sum of its printed parts"),
    Rule("TG102", "Printed longest durations are the longest of the printed rows"),
    Rule("TG103", "A printed improvement follows from the printed totals"),
    Rule("TG104", "Tables under different names print different digits"),
    Rule("TG105", "Two places that print the same total agree"),
    Rule("TG106", "Unrelated columns do not repeat each other's digits"),
    Rule("TG107", "The conditions stated fit the number of coefficients"),
    Rule("TG201", "Printed durations keep the limits for all t, over the rounding box"),
    Rule("TG202", "Position, velocity and acceleration are continuous"),
    Rule("TG203", "Printed peaks are those of the printed durations"),
    Rule("TG204", "The limits are used up by the printed durations"),
    Rule("TG205", "Printed control vertices follow from the printed way-points"),
    Rule("TG206", "Acceleration jumps where it is said to"),
    Rule("TG301", "Totals of one path under two velocity limits obey the scaling law"),
    Rule("TG302", "A printed total beside the optimum of its own formulation"),
    Rule("TG303", "A printed total beside the optimum with shared durations"),
    Rule("TG401", "An improvement beside the spread over seeds"),
    Rule("TG402", "A printed total beside replays of its algorithm"),
    Rule("TG403", "Convergence within a number of iterations, beside replays"),
    Rule("TG404", "A relative claim beside a family of instances drawn from the robot's workspace"),
    Rule("TG501", "Not checkable from the text"),
    Rule("TG601", "Joint and Cartesian way-points are consistent with the printed chain"),
)
"""Every rule; an id is never reused."""


def judge(claim: str, findings: Iterable[Finding], readings: Iterable[str]) -> Judgement:
    """Combine the deciding findings about one claim into its verdict.

    Under each reading a claim is refuted if a deciding finding refutes it, else inconsistent if
    one contradicts it, else supported if one supports it, else not checkable. A verdict that
    holds under some readings only says so; what no reading decides is not checkable.
    """
    about = [f for f in findings if f.claim == claim]
    own = [f for f in about if f.decides]
    order = (ClaimVerdict.REFUTED, ClaimVerdict.INCONSISTENT, ClaimVerdict.SUPPORTED)
    each: list[tuple[str, ClaimVerdict]] = []
    for reading in readings:
        there = {f.verdict for f in own if f.reading in (None, reading)}
        found = next((v for v in order if v in there), ClaimVerdict.NOT_CHECKABLE)
        each.append((reading, found))
    per_reading = [v for _, v in each]
    decided = [v for v in per_reading if v is not ClaimVerdict.NOT_CHECKABLE]
    if not decided:
        beside = [f"{f.rule}, which decides nothing: {f.message}" for f in about if not f.decides]
        why = next((f.message for f in own), next(iter(beside), "no rule applies to this claim"))
        nothing = ClaimVerdict.NOT_CHECKABLE
        return Judgement(claim, nothing, Scope.NO, Evidence.NONE, why, tuple(each))
    verdict = next(v for v in order if v in decided)
    if verdict is not ClaimVerdict.SUPPORTED and decided.count(verdict) < len(per_reading):
        supported = decided.count(ClaimVerdict.SUPPORTED)
        if supported:
            verdict = ClaimVerdict.SUPPORTED
    scope = Scope.ALL if per_reading.count(verdict) == len(per_reading) else Scope.SOME
    behind = [f for f in own if f.verdict is verdict]
    rank = [Evidence.NONE, Evidence.CERTIFIED, Evidence.BEST_KNOWN]
    evidence = max((f.evidence for f in behind), key=rank.index, default=Evidence.NONE)
    against = [f for f in own if f.verdict in order[:2] and f.verdict is not verdict]
    said = [f"{f.rule}: {f.message}" for f in behind]
    said += [f"But {f.verdict} under {f.reading or 'all'}, {f.rule}: {f.message}" for f in against]
    why = " ".join(dict.fromkeys(said))
    return Judgement(claim, verdict, scope, evidence, why, tuple(each))


def weigh(findings: Iterable[Finding], judgements: Iterable[Judgement]) -> tuple[Finding, ...]:
    """Findings whose severity fits the verdict on their claim.

    What a proof says under one reading is an error only where the claim falls under every
    admissible reading; otherwise it is a warning, for the reading may not be the one meant.

    Parameters
    ----------
    findings : iterable of Finding
    judgements : iterable of Judgement
        Of the claims, over all admissible readings.

    Returns
    -------
    tuple of Finding
        In their order.
    """
    against = (ClaimVerdict.REFUTED, ClaimVerdict.INCONSISTENT)
    fallen = {
        j.claim for j in judgements if j.readings and all(v in against for _, v in j.readings)
    }
    return tuple(
        replace(f, severity=Severity.WARNING)
        if f.severity is Severity.ERROR and f.reading is not None and f.claim not in fallen
        else f
        for f in findings
    )
