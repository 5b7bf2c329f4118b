"""Why a claim has its word: what decides, each reason once, and under which readings it holds.

Terminal, JSON, pages and site tell reasons in the words of this module.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import accumulate

from .vocabulary import ClaimVerdict

DECIDING = (ClaimVerdict.REFUTED, ClaimVerdict.INCONSISTENT, ClaimVerdict.SUPPORTED)
"""What decides, the strongest first: a proof outweighs what only agrees."""


@dataclass(frozen=True)
class Said:
    """What one deciding finding says of a claim."""

    verdict: str
    rule: str
    kind: str
    sentences: tuple[str, ...]
    reading: str | None = None
    """None if it depends on none."""


@dataclass(frozen=True)
class Named:
    """What the readings of a case are called."""

    labels: Mapping[str, str] = field(default_factory=dict)
    """What each means in words."""
    implausible: Mapping[str, str] = field(default_factory=dict)
    """Why some are implausible, in numbers."""
    default: str = ""
    """The reading whose numbers are shown where several give the same reason."""


NAMELESS = Named()
"""Readings that are called by their ids."""


@dataclass(frozen=True)
class Reason:
    """What decides, once for all readings under which it is the same but for its numbers."""

    verdict: str
    rule: str
    each: tuple[tuple[tuple[str, ...], tuple[str, ...]], ...]
    """Sentences, with the readings under which they are these to the digit."""

    @property
    def sentences(self) -> tuple[str, ...]:
        """As the first of its readings has them."""
        return self.each[0][0]

    @property
    def readings(self) -> tuple[str, ...]:
        """Every reading under which it holds."""
        return tuple(reading for _, where in self.each for reading in where)


def grouped(said: Iterable[Said], computed: Sequence[str], named: Named = NAMELESS) -> list[Reason]:
    """What decides, each reason once.

    The strongest word first; of one word those of the default reading first, and those of
    implausible readings last. `said`: of one claim. `computed`: the readings that were computed.
    """
    texts: dict[tuple[str, str, str, int], dict[tuple[str, ...], dict[str, None]]] = {}
    for one in said:
        if one.verdict in DECIDING:
            # What names more things has more sentences.
            key = one.verdict, one.rule, one.kind, len(one.sentences)
            alike = texts.setdefault(key, {})
            own = computed if one.reading is None else (one.reading,)
            alike.setdefault(one.sentences, {}).update(dict.fromkeys(own))

    def where(readings: Iterable[str]) -> tuple[str, ...]:
        """Readings in their order, the default one in front."""
        return tuple(sorted(readings, key=lambda reading: reading != named.default))

    found = [
        Reason(verdict, rule, tuple((text, where(alike[text])) for text in group))
        for (verdict, rule, *_), alike in texts.items()
        for group in _disjoint(alike, named.default)
    ]
    words = list(map(str, DECIDING))
    return sorted(
        found,
        key=lambda r: (
            words.index(r.verdict),
            named.default not in r.readings,
            all(reading in named.implausible for reading in r.readings),
        ),
    )


def _disjoint(
    alike: Mapping[tuple[str, ...], Mapping[str, None]], default: str
) -> list[list[tuple[str, ...]]]:
    """Texts in groups in which no reading gives two; that of the default reading leads."""
    groups: list[list[tuple[str, ...]]] = []
    for text in sorted(alike, key=lambda text: default not in alike[text]):
        for group in groups:
            if all(alike[text].keys().isdisjoint(alike[other]) for other in group):
                group.append(text)
                break
        else:
            groups.append([text])
    return groups


def with_readings(
    one: Reason,
    computed: Sequence[str],
    named: Named = NAMELESS,
    *,
    word: bool = False,
    why: bool = False,
) -> tuple[str, ...]:
    """The sentences of a reason, the first with the readings under which it holds.

    `computed`: the readings that were computed. `word`: whether its word stands in front: where
    readings give different ones. `why`: whether an implausible reading has its reason beside it.
    """
    text, notes = _under(one.readings, computed, named, why=why)
    if len(one.each) > 1:
        # Where a sentence names its readings, none is named again.
        first = quoted(one.readings[0], named.labels)
        notes += ["numbers of the first" if first in text else f"numbers of {first}"]
    elif len(one.readings) == len(computed) and not word:
        return one.sentences
    first, *others = one.sentences
    return f"{capital(_worded(one, noted(text, *notes), computed, word))}: {first}", *others


def _worded(one: Reason, where: str, computed: Sequence[str], word: bool) -> str:
    """Where a reason holds, with its word in front if it is not the word of every reading.

    What holds under every reading decides none of them alone where they differ.
    """
    return f"{one.verdict} {where}" if word and len(one.readings) < len(computed) else where


def in_full(
    one: Reason, computed: Sequence[str], named: Named = NAMELESS, *, word: bool = False
) -> list[str]:
    """Every text of a reason with all its readings named; nothing is left out."""
    found = []
    for sentences, readings in one.each:
        where = under(readings, computed, named, most=len(computed))
        found.append(f"{capital(_worded(one, where, computed, word))}: {' '.join(sentences)}")
    return found


def opened(sentences: tuple[str, ...], words: int) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """As many sentences as have room in so many words, one at least; and the rest."""
    ends = accumulate(len(sentence.split()) for sentence in sentences)
    shown = max(1, sum(end <= words for end in ends))
    return sentences[:shown], sentences[shown:]


def under(
    readings: Sequence[str],
    computed: Sequence[str],
    named: Named = NAMELESS,
    most: int = 2,
    *,
    why: bool = False,
) -> str:
    """Under which readings something holds, in words.

    Such as "under “angles in degrees”" or "under 12 of 16 readings". `computed`: all readings that
    were computed. `most`: readings that are named; of more the number is given, and the exceptions
    if they are few. `why`: whether an implausible reading has its reason beside it.
    """
    text, notes = _under(readings, computed, named, most, why=why)
    return noted(text, *notes)


def _under(
    readings: Sequence[str], computed: Sequence[str], named: Named, most: int = 2, *, why: bool
) -> tuple[str, list[str]]:
    """The words of `under`, and what stands in brackets behind them."""
    labels, far = named.labels, named.implausible
    left = [one for one in computed if one not in readings]
    if not left:
        return ("under both readings" if len(computed) == 2 else "under every reading"), []
    if len(readings) <= most:
        which = enumerated(quoted(one, labels) for one in readings)
        if len(readings) == 1 and readings[0] in far:
            return f"under the implausible {which}", [far[readings[0]]] if why else []
        return f"under {which}", [implausibly(readings, far)]
    notes = [implausibly(readings, far)]
    if len(left) <= 2:
        notes.append(f"not under {enumerated(quoted(one, labels) for one in left)}")
    return f"under {len(readings)} of {len(computed)} readings", notes


def among(readings: Sequence[str], count: int, far: Iterable[str] = ()) -> str:
    """How many of all readings, and how many of these are implausible.

    Such as "13 of 19 readings (5 implausible)". `count`: of all readings. `far`: those that are
    implausible.
    """
    return noted(f"{len(readings)} of {count} readings", implausibly(readings, far))


def implausibly(readings: Sequence[str], far: Iterable[str]) -> str:
    """How many of some readings are implausible; empty if none is."""
    many = len(set(readings) & set(far))
    every = many == len(readings)
    return f"{'all' if every and many > 1 else many} implausible" if many else ""


def noted(text: str, *notes: str) -> str:
    """A text with notes in one pair of brackets behind it; those that are empty are left out."""
    said = "; ".join(filter(None, notes))
    return f"{text} ({said})" if said else text


def quoted(reading: str, labels: Mapping[str, str]) -> str:
    """A reading as it stands in a sentence."""
    return f"“{labels.get(reading, reading)}”"


def ranged(low: float, high: float, spec: str) -> str:
    """Both ends of an interval in a format; one number where they print alike."""
    return " to ".join(dict.fromkeys(format(end, spec) for end in (low, high)))


def capital(text: str) -> str:
    """A text that begins a sentence."""
    return text[:1].upper() + text[1:]


def enumerated(parts: Iterable[object]) -> str:
    """Things in a row: "1, 2 and 3"."""
    *most, last = map(str, parts)
    return f"{', '.join(most)} and {last}" if most else last
