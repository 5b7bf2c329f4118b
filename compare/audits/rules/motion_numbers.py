"""A printed number of a motion beside what the motion gives, and beside what digits leave open."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ....problem import Array, Printed, TrajgapError
from ....problem.cases import AnyClaim, MeasureClaim, ValueClaim
from ...documents import Basis, ClaimVerdict, Finding
from ..rounding import RoundingBox
from ..row import Row
from .corners import Look, largest_change
from .loose_curves import FITTING, misfit
from .printed_digits import hull
from .wording import UNEXPLAINED, called

Meant = Callable[[Array, Array], dict[str, float]]
"""From way-points and durations to what a number may be, each in words."""
SAMPLES = (50, 100, 200, 500, 1000)
"""Numbers of samples of which a paper may have taken a mean, with or without the last instant."""


@dataclass(frozen=True)
class NumberBeside:
    """A printed number beside one of the motion, all in the unit of the paper.

    ``reach`` is how far the motion's number changes over what rounds to the printed digits: to
    first order, and where that does not reach the printed number the largest change that is found,
    if it is larger. ``far`` is the same over what is cut off to them; ``low`` and ``high`` are what
    samples give.
    """

    printed: Printed
    meaning: str
    exact: float
    reach: float
    far: float
    low: float
    high: float

    @property
    def met(self) -> bool:
        """Whether the motion's number rounds to the printed digits, all others as printed."""
        own = self.printed.interval
        return bool(own.lower <= self.exact <= own.upper)

    @property
    def fits(self) -> str:
        """How the two agree; empty if they do not."""
        own = self.printed.interval
        if float(own.lower) <= self.exact + self.reach and self.exact - self.reach <= own.upper:
            return "equal within the rounding of the printed digits"
        wide = hull(self.printed)
        far = self.far
        if float(wide.lower) <= self.exact + far and self.exact - far <= wide.upper:
            return "as digits that are cut off instead of rounded give it"
        if float(wide.lower) <= self.high + far and self.low - far <= wide.upper:
            return f"as {SAMPLES[0]} or more samples of the motion give it"
        return ""


def nearest_number(
    printed: Printed,
    meant: Meant,
    samples: Sequence[Mapping[str, float]],
    durations: RoundingBox,
    waypoints: RoundingBox,
    spread: float = 0.0,
) -> NumberBeside:
    """A printed number beside the one that it is nearest to, of those that it may be.

    Parameters
    ----------
    printed : Printed
    meant : callable
        In the unit of the paper.
    samples : sequence of dict
        What samples of the printed motion give instead, in the same words; may be empty.
    durations : RoundingBox, shape (segments,)
    waypoints : RoundingBox, shape (way-points, joints)
    spread : float
        Further change that rounding allows, in the unit of the paper.

    Returns
    -------
    NumberBeside
    """
    at_print = meant(waypoints.value, durations.value)
    reach = dict.fromkeys(at_print, 0.0)
    for moved in _each_moved(durations, waypoints, "upper"):
        for words, value in meant(*moved).items():
            reach[words] += abs(value - at_print[words])
    tried = []
    for words, value in at_print.items():
        sampled = [one[words] for one in samples] or [value]
        near, far = reach[words] + spread, 2 * (reach[words] + spread)
        tried.append(NumberBeside(printed, words, value, near, far, min(sampled), max(sampled)))
    fitting = [one for one in tried if one.fits]
    if not fitting:
        for i, one in enumerate(tried):
            near, far = (
                _farthest(meant, one.meaning, durations, waypoints, share) for share in (1.0, 2.0)
            )
            near, far = near + spread, far + 2 * spread
            tried[i] = replace(one, reach=max(one.reach, near), far=max(one.far, far))
        fitting = [one for one in tried if one.fits]
    return min(fitting or tried, key=lambda one: abs(one.exact - float(printed.fraction)))


def _farthest(
    meant: Meant,
    words: str,
    durations: RoundingBox,
    waypoints: RoundingBox,
    share: float,
) -> float:
    """Largest change of a number that is found in the rounding box, ``share`` as wide."""

    def look(h: RoundingBox, q: RoundingBox) -> Look:
        here = meant(q.value, h.value)[words]

        def changes(end: str) -> Array:
            found = []
            for moved in _each_moved(h, q, end):
                try:
                    found.append(meant(*moved)[words] - here)
                except TrajgapError:  # a duration that is not positive, or no curve
                    found.append(np.nan)
            return np.array(found)

        return Look(here, changes("lower"), changes("upper"))

    return largest_change(durations, waypoints, share, look)


def _each_moved(h: RoundingBox, q: RoundingBox, end: str) -> Iterator[tuple[Array, Array]]:
    """Way-points and durations with one number at an end: the durations first, row by row."""
    for k in np.ndindex(h.value.shape):
        yield q.value, _with(h.value, k, getattr(h, end))
    for k in np.ndindex(q.value.shape):
        yield _with(q.value, k, getattr(q, end)), h.value


def _with(values: Array, k: tuple[int, ...], others: Array) -> Array:
    found = values.copy()
    found[k] = others[k]
    return found


def finding_of_numbers(
    row: Row[AnyClaim],
    rule: str,
    claim: MeasureClaim | ValueClaim,
    found: Sequence[tuple[str | None, NumberBeside]],
    unit: Callable[[str | None], str],
    name: Callable[[str | None, NumberBeside], str],
) -> Finding:
    """The finding on the printed numbers of a claim beside those of one motion.

    Parameters
    ----------
    row : Row
        The durations whose motion it is.
    rule : str
    claim : MeasureClaim or ValueClaim
    found : sequence of (str or None, NumberBeside)
        With the joint of each; not empty.
    unit : callable
        Of a joint's number.
    name : callable
        What a joint's number is called.

    Returns
    -------
    Finding
        It tells what does not fit, or everything where all of it does.
    """
    wrong = [(joint, one) for joint, one in found if not one.fits]
    said = [
        f"{name(joint, one)} is {one.exact:.6g} {unit(joint)}, printed is {one.printed}, "
        f"{one.fits or UNEXPLAINED}"
        for joint, one in (wrong or found)
    ]
    verdict, note = misfit(row) if wrong else FITTING
    clash = verdict is ClaimVerdict.INCONSISTENT
    return Finding(
        rule=rule,
        verdict=verdict,
        basis=Basis.CHECK if all(one.met for _, one in found) else Basis.COMPUTED,
        claim=claim.id,
        problem=row.problem,
        reading=row.reading,
        printed=", ".join(map(str, claim.printed)),
        computed="; ".join(
            f"{one.exact:.6g} ± {one.reach:.1g} {unit(joint)}" for joint, one in found
        ),
        kind=", ".join("fits" if one.fits else "off" for _, one in (wrong or found)),
        sentences=(f"Of the printed durations ({called(row.claim)}): {'; '.join(said)}.", note),
        root=f"{claim.quantity}s of {row.claim.id}" if clash else "",
        between=(claim.id, row.claim.id) if clash else (),
    )
