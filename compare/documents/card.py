"""The verdict card: what an audit says of a case, in at most 80 words."""

from __future__ import annotations

from .entry import Count, Entry, OrWhy

CARD_WORDS = 80
"""Words of a card at most: what is read at a glance, and fits a phone's first screen."""


class VerdictCard(Entry):
    """The verdict in plain sentences: limits, optimum, improvement, then each error."""

    limits: str
    """Whether the printed durations keep the limits."""
    optimum: str
    """How far the printed total is from the optimum, or why that is not checkable."""
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
        found = [self.limits, self.optimum]
        found += [self.improvement] if isinstance(self.improvement, str) else []
        found += self.errors
        found += [more_errors(self.more)] if self.more else []
        return (*found, *([self.explanation] if isinstance(self.explanation, str) else []))

    @property
    def words(self) -> int:
        """How many words the card has."""
        return count_words(" ".join(self.sentences))


def more_errors(count: int) -> str:
    """The sentence for errors that a card has no room for."""
    return f"{count} more error{'s stand' if count > 1 else ' stands'} below."


def count_words(text: str) -> int:
    """Words of a text: what blanks separate, numbers and units included."""
    return len(text.split())
