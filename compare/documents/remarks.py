"""What goes with the word of a verdict, in the same breath: doubtful numbers, truisms, definitions.

A word of its own is not needed for these: the verdict is what it is, and the reader learns at once
what it is worth.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence

from ...problem.cases import Nature
from .finding import Caveat, CaveatKind, Judgement
from .vocabulary import ClaimVerdict, Confidence

DOUBTED = "rests on numbers that other printed numbers contradict"
"""How a caveat begins where a claim rests on a contradiction in print."""
POINTS = "rests on doubtful way-points"
"""How one begins where a claim was judged by motions through way-points that a finding doubts."""
BUILT = "true of any such curve"
"""How one begins where nothing that is printed could make the claim false."""
_KINDS = {
    Nature.DEFINITION: CaveatKind.DEFINITION,
    Nature.IDENTITY: CaveatKind.IDENTITY,
    Nature.AIM: CaveatKind.AIM,
    Nature.JUDGEMENT: CaveatKind.JUDGEMENT,
}
"""Kinds of caveats where nothing is claimed that numbers could decide."""
_BESIDE = {
    CaveatKind.BUILT: (ClaimVerdict.SUPPORTED, "by construction"),
    CaveatKind.DEFINITION: (ClaimVerdict.NOT_CHECKABLE, "a definition"),
    CaveatKind.IDENTITY: (ClaimVerdict.NOT_CHECKABLE, "a mathematical identity"),
    CaveatKind.AIM: (ClaimVerdict.NOT_CHECKABLE, "an aim"),
    CaveatKind.JUDGEMENT: (ClaimVerdict.NOT_CHECKABLE, "a judgement"),
}
"""What a caveat puts beside which verdict."""
_DOUBTS = {
    CaveatKind.DOUBTED: ((ClaimVerdict.SUPPORTED,), "numbers"),
    CaveatKind.POINTS: (
        tuple(v for v in ClaimVerdict if v is not ClaimVerdict.NOT_CHECKABLE),
        "way-points",
    ),
}
"""What a doubt is of, beside which verdicts: a word that is against a claim may rest on way-points,
and then they are in doubt for it as they are for one in its favour."""


def built_remark() -> str:
    """The caveat of a claim that holds by construction."""
    return f"{BUILT}, for any durations, so it is no evidence for the printed numbers"


def nature_caveat(nature: Nature) -> Caveat:
    """The caveat of a sentence that claims nothing that numbers could decide."""
    why = {
        Nature.DEFINITION: "it says how something is named or made, and claims no result",
        Nature.IDENTITY: "it is true whatever this paper prints",
        Nature.AIM: "it states a goal, not a result",
        Nature.JUDGEMENT: "it names no measure that could be computed",
    }
    kind = _KINDS[nature]
    return Caveat(kind, _BESIDE[kind][1], why[nature])


def qualified(verdict: str, beside: str) -> str:
    """A verdict with what stands beside it.

    Such as "supported, but on doubtful numbers". `verdict, beside`: of a `Judgement`.
    """
    return f"{verdict}, {beside}" if beside else verdict


def said_beside(verdict: ClaimVerdict, caveats: Iterable[Caveat]) -> str:
    """What stands beside a verdict; what holds by construction rests on no numbers at all.

    Such as "but on doubtful numbers"; empty if nothing does.
    """
    doubts, *others = _beside(verdict, caveats)
    joins = "and" if verdict is ClaimVerdict.DEPENDS else "but"
    return ", ".join([*([f"{joins} {doubts}"] if doubts else []), *others])


def _beside(verdict: ClaimVerdict, caveats: Iterable[Caveat]) -> list[str]:
    """What a verdict rests on that is doubted, empty if nothing is; then what else it is."""
    kinds = {caveat.kind for caveat in caveats}
    found = {k: said for k, (word, said) in _BESIDE.items() if word is verdict and k in kinds}
    doubts = [what for k, (words, what) in _DOUBTS.items() if verdict in words and k in kinds]
    doubted = bool(doubts) and CaveatKind.BUILT not in found
    return [f"on doubtful {' and '.join(doubts)}" if doubted else "", *found.values()]


def worth_little(judgements: Sequence[Judgement]) -> str:
    """How many of some claims hold by construction or on what is doubted; empty if none does.

    Such as "18 on doubtful numbers, 2 by construction".
    """
    counts = Counter(
        ", ".join(filter(None, _beside(judgement.verdict, judgement.caveats)))
        for judgement in judgements
        if judgement.verdict is ClaimVerdict.SUPPORTED
    )
    parts = [f"{count} {said}" for said, count in counts.items() if said]
    return ", ".join(parts)


def same_reason(text: str, where: str, own: str) -> str:
    """What stands instead of a reason that an earlier claim has given.

    `text, where`: words and place of the earlier claim. `own`: place of this one; where it is the
    same, the words tell them apart.
    """
    called = f"at {where}" if where != own else f"for “{text.rstrip('.')}”"
    return f"For the reason given {called}."


def claims_nothing(judgement: Judgement) -> bool:
    """Whether a claim that is not checkable states no result: a definition, an aim and the like."""
    undecided = judgement.verdict is ClaimVerdict.NOT_CHECKABLE
    return undecided and any(c.kind in _KINDS.values() for c in judgement.caveats)


def evident(judgement: Judgement) -> bool:
    """Whether a verdict is decided and says something of the paper: not by construction."""
    known = isinstance(judgement.confidence, Confidence)
    return known and not any(c.kind is CaveatKind.BUILT for c in judgement.caveats)
