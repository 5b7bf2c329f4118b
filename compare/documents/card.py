"""The verdict card: what an audit says of a case, in at most 80 words."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from .entry import Count, Entry, OrWhy
from .finding import Judgement
from .remarks import claims_nothing, evident
from .vocabulary import Confidence

CARD_WORDS = 80
"""Words of a card at most: what is read at a glance, and fits a phone's first screen."""


class VerdictCard(Entry):
    """The verdict in plain sentences: limits, optimum, improvement, then each error."""

    limits: str
    """Whether the printed durations keep the limits."""
    optimum: str
    """How far the printed total is from the optimum, or why that is not checkable."""
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
        return (*self.lines, *self.against, *beside)

    @property
    def lines(self) -> tuple[str, ...]:
        """What it says of limits, optimum, algorithm and improvement."""
        last = [one for one in (self.reached, self.improvement) if isinstance(one, str)]
        return (self.limits, self.optimum, *last)

    @property
    def against(self) -> tuple[str, ...]:
        """The errors, and how many more there are."""
        return (*self.errors, *([more_errors(self.more)] if self.more else []))

    @property
    def words(self) -> int:
        """How many words the card has."""
        return count_words(" ".join(self.sentences))


def tally(judgements: Sequence[Judgement]) -> str:
    """How many claims have a word, and how that is known: a line below a card.

    Such as "Verdicts on 31 claims: 8 follow from the printed digits, 17 are proven under a reading,
    6 are open."
    """
    own = [j for j in judgements if evident(j)]
    many = Counter(j.confidence for j in own if isinstance(j.confidence, Confidence))
    parts = [f"{many[one]} {forms[many[one] != 1]}" for one, forms in _KNOWN.items() if many[one]]
    held = sum(isinstance(j.confidence, Confidence) for j in judgements) - len(own)
    parts += [f"{held} {'holds' if held == 1 else 'hold'} by construction"] if held else []
    said = sum(claims_nothing(j) for j in judgements)
    left = len(judgements) - len(own) - held - said
    parts += [f"{left} {'is' if left == 1 else 'are'} open"] if left else []
    parts += [f"{said} {'states' if said == 1 else 'state'} no result"] if said else []
    count = f"{len(judgements)} claim{'' if len(judgements) == 1 else 's'}"
    return f"Verdicts on {count}: {', '.join(parts)}." if parts else "No claims."


_KNOWN = {
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
"""How verdicts are known, of one and of several."""


def more_errors(count: int) -> str:
    """The sentence for errors that a card has no room for."""
    return f"{count} more error{'s are' if count > 1 else ' is'} listed below."


def counted(verdict: str, count: int) -> str:
    """So many claims with a verdict: "1 depends on the reading", "3 depend on the reading"."""
    return f"{count} {verdict if count == 1 else verdict.replace('depends', 'depend')}"


def count_words(text: str) -> int:
    """Words of a text: what blanks separate, numbers and units included."""
    return len(text.split())
