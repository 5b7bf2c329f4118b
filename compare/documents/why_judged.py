"""Why a claim has its word: what decides, each reason once, and under which readings it holds.

Terminal, JSON, pages and site tell reasons in the words of this module.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field

from .vocabulary import ClaimVerdict

DECIDING = (ClaimVerdict.REFUTED, ClaimVerdict.INCONSISTENT, ClaimVerdict.SUPPORTED)
"""What decides, the strongest first: a proof outweighs what only agrees."""
_FEW = 2
"""Readings that a sentence names; of more it gives the number."""
_NUMBERS = re.compile(
    r"[-−+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?"
    r"|(?:\brad\b|\bdeg\b|°)(?:/s[²³]?|/min\b)?|\brpm\b|\b[cm]?m/(?:s[²³]?|min\b)|\b[cm]m\b"
)
"""Numbers and the units behind them: what reasons that are alike may differ in."""


@dataclass(frozen=True)
class Said:
    """What one deciding finding says of a claim.

    Attributes
    ----------
    verdict, message, rule : str
    reading : str or None
        None where it depends on none.
    """

    verdict: str
    message: str
    rule: str
    reading: str | None = None


@dataclass(frozen=True)
class Named:
    """What the readings of a case are called.

    Attributes
    ----------
    labels : mapping of str to str
        What each means in words.
    implausible : mapping of str to str
        Why some are implausible, in numbers.
    default : str
        The reading whose numbers are shown where several give the same reason.
    """

    labels: Mapping[str, str] = field(default_factory=dict)
    implausible: Mapping[str, str] = field(default_factory=dict)
    default: str = ""


NAMELESS = Named()
"""Readings that are called by their ids."""


@dataclass(frozen=True)
class Reason:
    """What decides, once for all readings under which it is the same but for its numbers.

    Attributes
    ----------
    verdict, message : str
        As the first of its readings has it.
    rules : tuple of str
    readings : tuple of str
        Every reading under which it holds.
    each : tuple of (str, tuple of str)
        Every message, with the readings under which it is that to the digit.
    """

    verdict: str
    message: str
    rules: tuple[str, ...]
    readings: tuple[str, ...]
    each: tuple[tuple[str, tuple[str, ...]], ...]


def grouped(said: Iterable[Said], computed: Sequence[str], named: Named = NAMELESS) -> list[Reason]:
    """What decides, each reason once.

    Parameters
    ----------
    said : iterable of Said
        Of one claim.
    computed : sequence of str
        The readings that were computed.
    named : Named

    Returns
    -------
    list of Reason
        The strongest word first; of one word those of the default reading first, and those of
        implausible readings last.
    """
    messages: dict[tuple[str, str], tuple[dict[str, None], dict[str, None]]] = {}
    for one in said:
        if one.verdict in DECIDING:
            rules, where = messages.setdefault((one.verdict, one.message), ({}, {}))
            rules[one.rule] = None
            under_them = computed if one.reading is None else (one.reading,)
            where.update(dict.fromkeys(under_them))
    # The default reading is the first of those under which it holds.
    for key, (rules, where) in messages.items():
        first = [reading for reading in where if reading == named.default]
        messages[key] = (rules, dict.fromkeys([*first, *where]))
    found = [
        Reason(
            verdict=group[0][0],
            message=group[0][1],
            rules=tuple(dict.fromkeys(r for key in group for r in messages[key][0])),
            readings=tuple(r for key in group for r in messages[key][1]),
            each=tuple((key[1], tuple(messages[key][1])) for key in group),
        )
        for group in _alike({key: where for key, (_, where) in messages.items()}, named)
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


def _alike(
    messages: Mapping[tuple[str, str], Mapping[str, None]], named: Named
) -> list[list[tuple[str, str]]]:
    """Messages that differ in numbers alone, as long as no reading gives two of them."""
    found: dict[tuple[str, str], list[list[tuple[str, str]]]] = {}
    # The sort is stable: those of the default reading lead, the others keep their order.
    for key in sorted(messages, key=lambda key: named.default not in messages[key]):
        groups = found.setdefault((key[0], _NUMBERS.sub("#", key[1])), [])
        for group in groups:
            if not any(reading in messages[other] for other in group for reading in messages[key]):
                group.append(key)
                break
        else:
            groups.append([key])
    return [group for groups in found.values() for group in groups]


def with_readings(
    one: Reason,
    computed: Sequence[str],
    named: Named = NAMELESS,
    *,
    word: bool = False,
    why: bool = False,
) -> str:
    """A reason with the readings under which it holds, in one text.

    Parameters
    ----------
    one : Reason
    computed : sequence of str
        The readings that were computed.
    named : Named
    word : bool
        Whether its word stands in front: where readings give different ones.
    why : bool
        Whether an implausible reading has its reason beside it.

    Returns
    -------
    str
    """
    text, notes = _under(one.readings, computed, named, _FEW, why=why)
    if len(one.each) > 1:
        # Where a sentence names its readings, none is named again.
        first = quoted(one.readings[0], named.labels)
        notes += ["numbers of the first" if first in text else f"numbers of {first}"]
    elif len(one.readings) == len(computed) and not word:
        return one.message
    return f"{capital(_worded(one, noted(text, *notes), computed, word))}: {one.message}"


def _worded(one: Reason, where: str, computed: Sequence[str], word: bool) -> str:
    """Where a reason holds, with its word in front if it is not the word of every reading.

    What holds under every reading decides none of them alone where they differ.
    """
    return f"{one.verdict} {where}" if word and len(one.readings) < len(computed) else where


def in_full(
    one: Reason, computed: Sequence[str], named: Named = NAMELESS, *, word: bool = False
) -> list[str]:
    """Every message of a reason with all its readings named; nothing is left out."""
    return [
        f"{capital(_worded(one, where, computed, word))}: {message}"
        for message, readings in one.each
        for where in (under(readings, computed, named, most=len(computed)),)
    ]


def under(
    readings: Sequence[str],
    computed: Sequence[str],
    named: Named = NAMELESS,
    most: int = _FEW,
    *,
    why: bool = False,
) -> str:
    """Under which readings something holds, in words.

    Parameters
    ----------
    readings : sequence of str
    computed : sequence of str
        All readings that were computed.
    named : Named
    most : int
        Readings that are named; of more the number is given, and the exceptions if they are few.
    why : bool
        Whether an implausible reading has its reason beside it.

    Returns
    -------
    str
        Such as "under “angles in degrees”" or "under 12 of 16 readings".
    """
    text, notes = _under(readings, computed, named, most, why=why)
    return noted(text, *notes)


def _under(
    readings: Sequence[str], computed: Sequence[str], named: Named, most: int, *, why: bool
) -> tuple[str, list[str]]:
    """The words of `under`, and what stands in brackets behind them."""
    labels, far = named.labels, named.implausible
    left = [one for one in computed if one not in readings]
    if not left:
        return ("under both readings" if len(computed) == 2 else "under every reading"), []
    if len(readings) <= most:
        which = _and([quoted(one, labels) for one in readings])
        if len(readings) == 1 and readings[0] in far:
            return f"under the implausible {which}", [far[readings[0]]] if why else []
        return f"under {which}", [implausibly(readings, far)]
    notes = [implausibly(readings, far)]
    if len(left) <= _FEW:
        notes.append(f"not under {_and([quoted(one, labels) for one in left])}")
    return f"under {len(readings)} of {len(computed)} readings", notes


def among(readings: Sequence[str], count: int, far: Iterable[str] = ()) -> str:
    """How many of all readings, and how many of these are implausible.

    Parameters
    ----------
    readings : sequence of str
    count : int
        Of all readings.
    far : iterable of str
        Those that are implausible.

    Returns
    -------
    str
        Such as "13 of 19 readings (5 implausible)".
    """
    return noted(f"{len(readings)} of {count} readings", implausibly(readings, far))


def implausibly(readings: Sequence[str], far: Iterable[str]) -> str:
    """How many of some readings are implausible; empty where none is."""
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


def _and(parts: Sequence[str]) -> str:
    *most, last = parts
    return f"{', '.join(most)} and {last}" if most else last
