"""Papers in which one printed number is misprinted: what it was meant to be is known.

The motion, its totals and its peaks are those of the numbers that were meant.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from support.papers.drafts import TIGHT, Draft, answer, some_shape
from support.papers.planted import HELD, UnfitError, first_fit, observed, restated, shared
from support.papers.printing import last_place

CLEAR = 3.0
"""Multiple of what rounding hides that a fault is at least: nobody could name a smaller one."""


@dataclass(frozen=True)
class Slipped:
    """A paper with one misprint."""

    draft: Draft
    printed: str
    meant: str


def slipped(kind: str, seed: int) -> Slipped:
    """A paper with a misprint of a kind."""

    def misprinted(rng: np.random.Generator) -> Slipped:
        draft = shared(rng, seed, HELD)
        if draft.segments > 5:
            raise UnfitError
        restated(rng, draft, answer(draft, some_shape(rng, draft), TIGHT))
        one = Slipped(draft, *SLIPS[kind](rng, draft))
        if not _clear(kind, draft):
            raise UnfitError
        return one

    return first_fit(kind, misprinted, 20261123, 26, list(SLIPS).index(kind), seed)


def named(one: Slipped, found: Any) -> bool:
    """Whether an audit names the misprint among its explanations."""
    said = f"is printed as {one.printed}, perhaps for {one.meant}."
    return any(said in e.change for cause in found.causes for e in cause.explanations)


def _clear(kind: str, draft: Draft) -> bool:
    """Whether the misprint shows beyond what rounding and cutting off hide."""
    claim = draft.claim("fast")
    if kind in ("total", "abstract"):
        unit = last_place(claim["durations"][0])
        text = claim["total"] if kind == "total" else draft.claim("abstract")["value"]
        far = abs(float(text) - sum(map(float, claim["durations"])))
        return far > CLEAR * len(claim["durations"]) * max(unit, last_place(text))
    shown = observed(draft)
    return shown.size > CLEAR * shown.room


def _misprint(rng: np.random.Generator, text: str) -> str:
    """One digit changed, two neighbours exchanged, or the point left out."""
    places = [k for k, c in enumerate(text) if c.isdigit()]
    how = rng.choice(["digit", "digit", "exchange", "point"])
    if how == "point" and "." in text and text.lstrip("-")[0] != "0":
        return text.replace(".", "")
    if how == "exchange" and len(places) > 1:
        k = int(rng.integers(len(places) - 1))
        one, other = places[k], places[k + 1]
        new = list(text)
        new[one], new[other] = new[other], new[one]
    else:
        k = int(rng.choice(places))
        new = list(text)
        new[k] = str((int(text[k]) + int(rng.integers(1, 10))) % 10)
    found = "".join(new)
    leading = found.lstrip("-")
    if found == text or not float(found) or (leading[0] == "0" and leading[1:2].isdigit()):
        raise UnfitError  # no number is printed as 02, and a limit of 0 is another question
    return found


def _limit(rng: np.random.Generator, draft: Draft) -> tuple[str, str]:
    order = int(rng.choice(list(draft.limits)))
    joint = int(rng.integers(draft.joints))
    meant = draft.limits[order][joint]
    draft.limits[order][joint] = _misprint(rng, meant)
    return draft.limits[order][joint], meant


def _waypoint(rng: np.random.Generator, draft: Draft) -> tuple[str, str]:
    joint, at = int(rng.integers(draft.joints)), int(rng.integers(len(draft.points[0])))
    meant = draft.points[joint][at]
    draft.points[joint][at] = _misprint(rng, meant)
    return draft.points[joint][at], meant


def _listed(name: str, key: str) -> Callable[[np.random.Generator, Draft], tuple[str, str]]:
    def plant(rng: np.random.Generator, draft: Draft) -> tuple[str, str]:
        claim = draft.claim(name)
        if key not in claim:
            raise UnfitError
        given = claim[key]
        at = int(rng.integers(len(given))) if isinstance(given, list) else 0
        meant = given[at] if isinstance(given, list) else given
        printed = _misprint(rng, meant)
        claim[key] = (
            [*given[:at], printed, *given[at + 1 :]] if isinstance(given, list) else printed
        )
        return printed, meant

    return plant


def _peak(rng: np.random.Generator, draft: Draft) -> tuple[str, str]:
    name = str(rng.choice(["peak-1", "peak-2"]))
    if not draft.has(name):
        raise UnfitError
    return _listed(name, "values" if "values" in draft.claim(name) else "value")(rng, draft)


def _abstract(rng: np.random.Generator, draft: Draft) -> tuple[str, str]:
    claim = draft.claim("fast")
    if "total" not in claim:
        raise UnfitError
    draft.state("abstract", "total_time", value=claim["total"], of="fast")
    return _listed("abstract", "value")(rng, draft)


SLIPS: dict[str, Callable[[np.random.Generator, Draft], tuple[str, str]]] = {
    "limit": _limit,
    "way-point": _waypoint,
    "duration": _listed("fast", "durations"),
    "total": _listed("fast", "total"),
    "peak": _peak,
    "abstract": _abstract,
}
"""What is misprinted."""
