"""The verdict card, and what stands beside the word of a verdict."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence

from ...problem.cases import Nature
from .entry import Count, Entry, OrWhy
from .finding import Caveat, CaveatKind, Judgement
from .vocabulary import ClaimVerdict, Confidence

CARD_WORDS = 100
"""Words below the verdict of a card at most: what fits a phone's first screen."""


class VerdictCard(Entry):
    """The verdict in a few words, then what it rests on: errors, limits, optimum, improvement."""

    verdict: str
    """What became of the claims, and whether a result is optimal and keeps the limits."""
    limits: OrWhy[str]
    """Whether the printed durations keep the limits."""
    optimum: OrWhy[str]
    """How far the printed total is from the optimum, or why that cannot be checked."""
    reached: OrWhy[str]
    """How near the paper's algorithm gets when it is run many times."""
    improvement: OrWhy[str]
    """Whether the claimed improvement follows from what is printed."""
    errors: tuple[str, ...]
    """One sentence for each cause of severity error, while the words last."""
    more: Count
    """Errors that the words left no room for; `causes` has them all."""
    explanation: OrWhy[str]
    """The most charitable explanation that the numbers allow."""

    @property
    def sentences(self) -> tuple[str, ...]:
        """Everything that the card says, in order."""
        beside = [self.explanation] if isinstance(self.explanation, str) else []
        return (self.verdict, *self.against, *self.lines, *beside)

    @property
    def lines(self) -> tuple[str, ...]:
        """What it says of limits, optimum, algorithm and improvement."""
        every = (self.limits, self.optimum, self.reached, self.improvement)
        return tuple(one for one in every if isinstance(one, str))

    @property
    def against(self) -> tuple[str, ...]:
        """The errors, and how many more there are."""
        return (*self.errors, *([more_errors(self.more)] if self.more else []))

    @property
    def words(self) -> int:
        """How many words stand below the verdict."""
        return count_words(" ".join(self.sentences[1:]))


def tally(judgements: Sequence[Judgement]) -> str:
    """How many claims have a word, and how that is known: a line below a card.

    Such as "Verdicts on 31 claims: 8 follow from the printed digits, 17 are proven under a reading,
    6 are open."
    """
    own = [j for j in judgements if evident(j)]
    many = Counter(j.confidence for j in own if isinstance(j.confidence, Confidence))
    known = {
        Confidence.DIGITS: ("follows from the printed digits", "follow from the printed digits"),
        Confidence.PROVEN: ("rests on a proof under a reading", "rest on proofs under a reading"),
        Confidence.COMPUTED: ("is computed under a reading", "are computed under a reading"),
        Confidence.BEST_KNOWN: ("rests on a best known motion", "rest on best known motions"),
        Confidence.UNCONVERGED: (
            "rests on a search that did not converge",
            "rest on searches that did not converge",
        ),
        Confidence.REPLAY: ("rests on replays", "rest on replays"),
    }
    parts = [f"{many[one]} {forms[many[one] != 1]}" for one, forms in known.items() if many[one]]
    held = sum(isinstance(j.confidence, Confidence) for j in judgements) - len(own)
    parts += [f"{held} {'holds' if held == 1 else 'hold'} by construction"] if held else []
    said = sum(claims_nothing(j) for j in judgements)
    left = len(judgements) - len(own) - held - said
    parts += [f"{left} {'is' if left == 1 else 'are'} open"] if left else []
    parts += [f"{said} {'states' if said == 1 else 'state'} no result"] if said else []
    count = f"{len(judgements)} claim{'' if len(judgements) == 1 else 's'}"
    return f"Verdicts on {count}: {', '.join(parts)}." if parts else "No claims."


def more_errors(count: int) -> str:
    """The sentence for errors that a card has no room for."""
    return f"{count} more error{'s are' if count > 1 else ' is'} listed below."


def counted(verdict: str, count: int) -> str:
    """So many claims with a verdict: "1 depends on the reading", "3 depend on the reading"."""
    return f"{count} {verdict if count == 1 else verdict.replace('depends', 'depend')}"


def count_words(text: str) -> int:
    """Words of a text: what blanks separate, numbers and units included."""
    return len(text.split())


DOUBTED = "rests on numbers that other printed numbers contradict"
"""How a caveat begins where a claim rests on a contradiction in print."""
POINTS = "rests on doubtful way-points"
"""How one begins where a claim was judged by motions through way-points that a finding doubts."""
BUILT = "true of any such curve"
"""How one begins where nothing that is printed could make the claim false."""
_BESIDE = {
    CaveatKind.BUILT: (ClaimVerdict.SUPPORTED, "by construction"),
    CaveatKind.DEFINITION: (ClaimVerdict.NOT_CHECKABLE, "a definition"),
    CaveatKind.IDENTITY: (ClaimVerdict.NOT_CHECKABLE, "a mathematical identity"),
    CaveatKind.AIM: (ClaimVerdict.NOT_CHECKABLE, "an aim"),
    CaveatKind.JUDGEMENT: (ClaimVerdict.NOT_CHECKABLE, "a judgement"),
}
"""What a caveat puts beside which verdict."""


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
    kind = CaveatKind[nature.name]
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
    # What a doubt is of, beside which verdicts: a word that is against a claim may rest on way-
    # points, and then they are in doubt for it as they are for one in its favour.
    doubtful = {
        CaveatKind.DOUBTED: ((ClaimVerdict.SUPPORTED,), "numbers"),
        CaveatKind.POINTS: (
            tuple(v for v in ClaimVerdict if v is not ClaimVerdict.NOT_CHECKABLE),
            "way-points",
        ),
    }
    doubts = [what for k, (words, what) in doubtful.items() if verdict in words and k in kinds]
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
    return undecided and any(
        c.kind and c.kind.name in Nature.__members__ for c in judgement.caveats
    )


def evident(judgement: Judgement) -> bool:
    """Whether a verdict is decided and says something of the paper: not by construction."""
    known = isinstance(judgement.confidence, Confidence)
    return known and not any(c.kind is CaveatKind.BUILT for c in judgement.caveats)
