"""What papers call curves, and how a case file declares the curve that each name means."""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from difflib import get_close_matches

LITERATURE: dict[str, tuple[str, dict[str, object]]] = {
    "natural-cubic": ("cubic-spline", {"end_orders": [2]}),
    "clamped-cubic": ("cubic-spline", {"end_orders": [1]}),
    "cubic-b-spline": ("cubic-spline-virtual", {}),
    "quintic-b-spline": ("quintic-spline", {}),
    "3-3-3": ("polynomials", {"degrees": [3, 3, 3], "end_orders": [1]}),
    "4-3-4": ("polynomials", {"degrees": [4, 3, 4]}),
    "cubic-polynomials": ("rest-to-rest", {"degree": 3}),
    "quintic-polynomials": ("rest-to-rest", {"degree": 5}),
    "septic-polynomials": ("rest-to-rest", {"degree": 7}),
}
"""Names that papers give to curves, and how a case file declares them. An interpolating cubic or
quintic B-spline through way-points is a C2 cubic or C4 quintic spline at rest at both ends."""
_CHOSEN = "chosen: write a reading for each other meaning that the paper admits"
"""What is said beside keys that a name of a curve leaves open."""
_NOTES = {
    "quintic-spline-virtual": "no motion is the shortest unless [durations] has a lower bound",
}
"""What whoever names a family should know."""
_NEEDED: dict[str, dict[str, object]] = {
    "uniform-cubic-b-spline": {"time": "timed"},
    "clamped-b-spline": {"knots": "averaged-continued", "parameters": "times"},
}
"""What families need that their names do not say: the choice under which each is a smooth motion in
time; a reading for each other one is the paper's to admit."""
_ALIASES: dict[str, tuple[str, dict[str, object]]] = {
    "cubic spline": ("cubic-spline", {}),
    "cubic natural spline": LITERATURE["natural-cubic"],
    "cubic natural": LITERATURE["natural-cubic"],
    "natural spline": LITERATURE["natural-cubic"],
    "clamped cubic spline": LITERATURE["clamped-cubic"],
    "clamped spline": LITERATURE["clamped-cubic"],
    "clamped cubic": LITERATURE["clamped-cubic"],
    "cubic spline virtual": ("cubic-spline-virtual", {}),
    "quintic spline virtual": ("quintic-spline-virtual", {}),
    "septic spline": ("septic-spline", {}),
    "bspline cubic": LITERATURE["cubic-b-spline"],
    "bspline cubic uniform": ("uniform-cubic-b-spline", {}),
    "bspline clamped cubic": ("clamped-b-spline", {"degree": 3}),
    "quintic spline": ("quintic-spline", {}),
    "bspline quintic": LITERATURE["quintic-b-spline"],
    "bspline clamped quintic": ("clamped-b-spline", {"degree": 5}),
    "bspline septic": ("clamped-b-spline", {"degree": 7}),
    "bspline clamped septic": ("clamped-b-spline", {"degree": 7}),
    "cubic polynomial": LITERATURE["cubic-polynomials"],
    "polynomial quintic": LITERATURE["quintic-polynomials"],
    "polynomial septic": LITERATURE["septic-polynomials"],
    "nonic polynomial": ("rest-to-rest", {"degree": 9}),
}
"""Names by their words in the order of the alphabet, less what says nothing."""
_WORDS = {
    "splines": "spline",
    "bsplines": "bspline",
    "polynomials": "polynomial",
    "third": "cubic",
    "3rd": "cubic",
    "3": "cubic",
    "fifth": "quintic",
    "5th": "quintic",
    "5": "quintic",
    "seventh": "septic",
    "7th": "septic",
    "7": "septic",
    "heptic": "septic",
    "ninth": "nonic",
    "9th": "nonic",
    "9": "nonic",
    "2": "two",
}
"""Other forms of the words of names."""
_SAYING_NOTHING = {
    "a", "and", "at", "by", "curve", "curves", "degree", "function", "functions",
    "interpolated", "interpolating", "interpolation", "joint", "knot", "knots", "method", "of",
    "order", "piecewise", "point", "points", "segments", "the", "through", "trajectories",
    "trajectory", "via", "way", "waypoint", "waypoints", "with",
}  # fmt: skip
"""Words that tell no curve from another."""
_OF_COURSE = {"cubic": "c2", "quintic": "c4", "septic": "c6", "virtual": "two"}
"""Words, and what they imply: the continuity of a spline, the number of virtual points."""
_PROFILES = (
    "lspb", "trapezoidal", "trapezoid", "parabolic", "blends", "scurve", "doubles", "sinejerk",
)  # fmt: skip
"""Words of profiles of velocity, which start and end each segment at rest."""
_ANGELES = {"3-4-5": 5, "4-5-6-7": 7, "5-6-7-8-9": 9}
"""Names of one polynomial from rest to rest by the powers that it has (Angeles, Fundamentals of
Robotic Mechanical Systems): not degrees of segments."""
_USUAL = (
    (2, (1, 2)), (2, (1,)), (2, (1, 2, 3)), (3, (1, 2)), (3, (1, 2, 3)), (4, (1, 2)),
    (6, (1, 2, 3)),
)  # fmt: skip
"""Continuity and orders at rest that papers use, the most usual first."""
_MISSPELT = 0.8
"""Likeness from which one word is taken for a misspelt other one."""


@dataclass(frozen=True)
class Meant:
    """A curve as a case file declares it."""

    family: str
    keys: Mapping[str, object]
    note: str = ""
    """What whoever fills in the file should know; may be empty."""

    def written(self) -> str:
        """The keys of the block, in one line."""
        keys = {"family": self.family, **self.keys}
        return ", ".join(f"{key} = {json.dumps(value)}" for key, value in keys.items())


def meant_by(name: str, families: Iterable[str]) -> Meant | None:
    """The curve that a name means, if it is known and means one."""
    if name in families:
        return _completed(name, {})
    degrees = _degrees(name)
    if name in LITERATURE:
        family, keys = LITERATURE[name]
    elif degrees:
        return _by_degrees(degrees)
    else:
        family, keys = _ALIASES.get(" ".join(sorted(_words(name))), ("", {}))
    return _completed(family, keys) if family else None


def _completed(family: str, keys: Mapping[str, object]) -> Meant:
    """A curve with what its family needs beside."""
    needed = _NEEDED.get(family, {})
    return Meant(family, {**keys, **needed}, _CHOSEN if needed else _NOTES.get(family, ""))


def unknown(name: str, families: Iterable[str]) -> str:
    """That a name is not known, and which ones are: the nearest only where every word is theirs."""
    known = (*families, *LITERATURE)
    every = f"{', '.join(known)}, or degrees such as 4-3-3-4"
    words = _words(name)
    if any(word in _PROFILES for word in words):
        return (
            f"{name!r} is a profile from rest to rest, not a curve through way-points; state its "
            f"total as a claim with other_curve and profile. Curves: {every}"
        )
    named = {one: _words(one) for one in known if not _degrees(one)}
    vocabulary = {word for each in named.values() for word in each}
    close = [get_close_matches(word, vocabulary, n=1, cutoff=_MISSPELT) for word in words]
    meant = {found[0] for found in close if found}
    near = [one for one, each in named.items() if meant <= each] if words and all(close) else []
    fewest = min((len(named[one]) for one in near), default=0)
    shown = " or ".join(sorted(one for one in near if len(named[one]) == fewest))
    said = f"did you mean {shown}? All: " if shown else "use one of "
    return f"{name!r} is not known; {said}{every}"


def _words(name: str) -> set[str]:
    """The words of a name that tell it from others, each in one form."""
    text = re.sub(r"\bb[-\s]?(?=splines?\b)", "b", name.lower())
    text = re.sub(r"\b(s[-\s]curves?|double[-\s]s)\b", "scurve", text)
    text = re.sub(r"\b(sine|sinusoidal|trigonometric)[-\s]jerk\b", "sinejerk", text)
    found = {_WORDS.get(word, word) for word in re.findall(r"[a-z0-9]+", text)}
    for word, what_goes_without_saying in _OF_COURSE.items():
        if word in found:
            found.discard(what_goes_without_saying)
    return found - _SAYING_NOTHING


def _degrees(name: str) -> tuple[int, ...]:
    """The degrees of which a name consists, such as 4-3-4; empty if it has other words."""
    found = re.search(r"(?<![0-9])[1-9](?:[-‐-―−\s]?[1-9]){2,}(?![0-9])", name)
    if found is None:
        return ()
    rest = name[: found.start()] + name[found.end() :]
    if _words(rest) - {"polynomial", "spline"}:
        return ()
    return tuple(int(digit) for digit in re.findall("[1-9]", found[0]))


def _by_degrees(degrees: tuple[int, ...]) -> Meant:
    """The curve with a degree for each segment, at rest at both ends as far as that settles it."""
    name = "-".join(map(str, degrees))
    if name == "3-5-3":
        return Meant(name, {})
    if name in _ANGELES:
        return Meant("rest-to-rest", {"degree": _ANGELES[name]})
    coefficients = sum(degree + 1 for degree in degrees)
    segments = len(degrees)

    def conditions(continuity: int, orders: tuple[int, ...]) -> int:
        return 2 * segments + continuity * (segments - 1) + 2 * len(orders)

    for continuity, orders in _USUAL:
        if conditions(continuity, orders) == coefficients and continuity < max(degrees):
            return Meant("polynomials", _declared(degrees, continuity, orders))
    fewest = conditions(2, (1, 2))
    free = coefficients - fewest
    if free < 0:
        return Meant("polynomials", _declared(degrees, 2, (1, 2)))
    note = (
        f"{coefficients} coefficients and {fewest} conditions: say what settles the other {free}, "
        "and lower free"
    )
    return Meant("polynomials", {**_declared(degrees, 2, (1, 2)), "free": free}, note)


def _declared(
    degrees: tuple[int, ...], continuity: int, orders: tuple[int, ...]
) -> dict[str, object]:
    """Keys of a block of polynomials, less those that say what is so anyway."""
    keys: dict[str, object] = {"degrees": list(degrees)}
    if continuity != 2:
        keys["continuity"] = continuity
    if orders != (1, 2):
        keys["end_orders"] = list(orders)
    return keys
