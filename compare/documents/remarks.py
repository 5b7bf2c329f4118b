"""What goes with the word of a verdict, in the same breath: doubted numbers, truisms, definitions.

A word of its own is not needed for these: the verdict is what it is, and the reader learns at once
what it is worth.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence

from ...problem.cases import Nature
from .finding import Judgement
from .vocabulary import ClaimVerdict, Confidence

DOUBTED = "rests on numbers that other printed numbers contradict"
"""How a caveat begins where a claim rests on a contradiction in print."""
POINTS = "rests on doubted way-points"
"""How one begins where a claim was judged by motions through way-points that a finding doubts."""
BUILT = "true of any such curve"
"""How one begins where nothing that is printed could make the claim false."""
_STATED = {
    Nature.DEFINITION: "a definition",
    Nature.IDENTITY: "a mathematical identity",
    Nature.AIM: "an aim",
    Nature.JUDGEMENT: "a judgement",
}
"""How one begins where nothing is claimed that numbers could decide."""
_BESIDE = {
    BUILT: (ClaimVerdict.SUPPORTED, "by construction"),
    **{said: (ClaimVerdict.NOT_CHECKABLE, said) for said in _STATED.values()},
}
"""What stands beside which verdict, by the beginning of a caveat."""
_DOUBTS = {
    DOUBTED: ((ClaimVerdict.SUPPORTED,), "numbers"),
    POINTS: (tuple(v for v in ClaimVerdict if v is not ClaimVerdict.NOT_CHECKABLE), "way-points"),
}
"""What a doubt is of, beside which verdicts: a word that is against a claim may rest on way-points,
and then they are in doubt for it as they are for one in its favour."""


def built_remark() -> str:
    """The caveat of a claim that holds by construction."""
    return f"{BUILT}, whatever the durations, so that it is no evidence for the printed numbers"


def nature_remark(nature: Nature) -> str:
    """The caveat of a sentence that claims nothing that numbers could decide."""
    why = {
        Nature.DEFINITION: "it says how something is called or made, and claims no result",
        Nature.IDENTITY: "it holds whatever this paper prints",
        Nature.AIM: "it says what is wanted, not what was reached",
        Nature.JUDGEMENT: "no measure is named that could be computed",
    }
    return f"{_STATED[nature]}: {why[nature]}"


def qualified(verdict: str, caveats: Iterable[object]) -> str:
    """A verdict with what goes with it.

    Parameters
    ----------
    verdict : str
    caveats : iterable of object
        Their texts.

    Returns
    -------
    str
        Such as "supported, but on doubted numbers".
    """
    return ", ".join([verdict, *_beside(verdict, caveats)])


def _beside(verdict: str, caveats: Iterable[object]) -> list[str]:
    """What stands beside a verdict; what holds by construction rests on no numbers at all."""
    texts = list(map(str, caveats))
    found = {
        start: said
        for start, (word, said) in _BESIDE.items()
        if word == verdict and any(text.startswith(start) for text in texts)
    }
    doubts = [
        what
        for start, (words, what) in _DOUBTS.items()
        if verdict in words and any(text.startswith(start) for text in texts)
    ]
    if doubts and BUILT not in found:
        joins = "and" if verdict == ClaimVerdict.DEPENDS else "but"
        return [f"{joins} on doubted {' and '.join(doubts)}", *found.values()]
    return list(found.values())


def worth_little(judgements: Sequence[Judgement]) -> str:
    """How many of some claims hold by construction or on what is doubted; empty where none does.

    Parameters
    ----------
    judgements : sequence of Judgement

    Returns
    -------
    str
        Such as "18 on doubted numbers, 2 by construction".
    """
    counts = Counter(
        said.removeprefix("but ")
        for judgement in judgements
        if judgement.verdict is ClaimVerdict.SUPPORTED
        for said in _beside(judgement.verdict, judgement.caveats)
    )
    parts = [f"{count} {said}" for said, count in counts.items()]
    return ", ".join(parts)


def same_reason(text: str, where: str, own: str) -> str:
    """What stands in place of a reason that an earlier claim has given.

    Parameters
    ----------
    text, where : str
        Words and place of the earlier claim.
    own : str
        Place of this one; where it is the same, the words tell them apart.

    Returns
    -------
    str
    """
    called = f"at {where}" if where != own else f"for “{text.rstrip('.')}”"
    return f"For the reason given {called}."


def claims_nothing(judgement: Judgement) -> bool:
    """Whether a claim that is not checkable states no result: a definition, an aim and the like."""
    starts = tuple(f"{said}:" for said in _STATED.values())
    undecided = judgement.verdict is ClaimVerdict.NOT_CHECKABLE
    return undecided and any(str(caveat).startswith(starts) for caveat in judgement.caveats)


def evident(judgement: Judgement) -> bool:
    """Whether a verdict is decided and says something of the paper: not by construction."""
    known = isinstance(judgement.confidence, Confidence)
    return known and not any(str(caveat).startswith(BUILT) for caveat in judgement.caveats)
