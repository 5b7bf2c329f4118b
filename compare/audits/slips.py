"""Misprints that a case may hold: one printed number instead of another, and the case with it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from decimal import Decimal
from itertools import combinations
from math import tau
from typing import Any

from ...problem import Case, Printed, from_si
from ...problem.cases import (
    AnyClaim,
    ImprovementClaim,
    MaximumClaim,
    PeakClaim,
    TotalTimeClaim,
    ValueClaim,
)
from .stated import place

Path = tuple[str | int, ...]
"""Where a number stands in a case file: keys and places in lists."""


@dataclass(frozen=True)
class Spot:
    """A printed number that may be misprinted: how a sentence calls it, and where it stands."""

    name: str
    path: Path
    number: Printed


@dataclass(frozen=True)
class Slip:
    """One change of what is printed.

    Attributes
    ----------
    change : str
        As a sentence.
    edits : tuple of (Path, Printed)
        The numbers that stand in the place of others.
    slips : int
        How many slips it takes: one for a digit, two neighbours exchanged, a point or a sign.
    share : float
        How much the number changes, as a factor of 1 or more; infinite where its sign does.
    kind : str
        The key of the number, or what else may have happened.
    """

    change: str
    edits: tuple[tuple[Path, Printed], ...]
    slips: int
    share: float
    kind: str

    def case(self, case: Case) -> Case:
        """The case with the change made."""
        document = case.document
        for path, number in self.edits:
            document = _edited(document, path, number)
        return Case(document, case.file)


def _edited(block: Any, path: Path, number: Printed) -> Any:
    """A block of a case file with another number at a place."""
    if not path:
        return number
    head, *rest = path
    if isinstance(head, int):
        return (*block[:head], _edited(block[head], tuple(rest), number), *block[head + 1 :])
    return block.model_copy(update={head: _edited(getattr(block, head), tuple(rest), number)})


def misprints(spot: Spot, signed: bool = False) -> Iterator[Slip]:
    """One digit changed, two neighbours exchanged, the point moved or left out, a sign lost."""
    was = spot.number
    for other in was.slips():
        if other.fraction == was.fraction or (other.fraction <= 0 and not signed):
            continue
        ratio = float(other.fraction / was.fraction) if was.fraction else 0.0
        yield Slip(
            change=f"{spot.name} may be misprinted: {other.text} instead of {was.text}.",
            edits=((spot.path, Printed(other.text, exact=was.exact)),),
            slips=1,
            share=max(ratio, 1 / ratio) if ratio > 0 else float("inf"),
            kind=[key for key in spot.path if isinstance(key, str)][-1],
        )


# --- where numbers stand --------------------------------------------------------------------------


def _claim_path(case: Case, claim: AnyClaim) -> Path:
    return "claims", next(k for k, one in enumerate(case.claims) if one.id == claim.id)


def durations(case: Case, claim: AnyClaim, named: bool = False) -> list[Spot]:
    """The durations of a claim; their names say where they stand if asked to."""
    where = f" in {place(claim)}" if named else ""
    return [
        Spot(
            f"The duration of segment {k + 1}{where}",
            (*_claim_path(case, claim), "durations", k),
            n,
        )
        for k, n in enumerate(case.printed_durations(claim))
    ]


def totals(case: Case, claim: AnyClaim, named: bool = False) -> list[Spot]:
    """The total of a claim, if it prints one."""
    key = "value" if isinstance(claim, TotalTimeClaim) else "total"
    number = getattr(claim, key, None)
    where = f" in {place(claim)}" if named else ""
    if not isinstance(number, Printed):
        return []
    return [Spot(f"The total{where}", (*_claim_path(case, claim), key), number)]


def values(case: Case, claim: AnyClaim) -> list[Spot]:
    """The numbers of a claim of a derivative, or of an improvement."""
    path = _claim_path(case, claim)
    if isinstance(claim, ImprovementClaim):
        found = (("percentage", "percent"), ("saving", "seconds"))
        return [
            Spot(f"The {name}", (*path, key), getattr(claim, key))
            for name, key in found
            if getattr(claim, key) is not None
        ]
    if not isinstance(claim, PeakClaim | ValueClaim):
        return []
    name = f"{'peak' if isinstance(claim, PeakClaim) else 'value'} of {claim.derivative}"
    if claim.value is not None:
        return [Spot(f"The {name}", (*path, "value"), claim.value)]
    return [
        Spot(f"The {name} of joint {label}", (*path, "values", j), number)
        for j, (label, number) in enumerate(
            zip(case.robot.joints, claim.values or (), strict=False)
        )
    ]


def limits(case: Case, pid: str, rid: str, quantity: str, joint: str) -> list[Spot]:
    """The limit of a quantity that holds for a joint under a problem and a reading."""
    path = _last_layer(case, pid, rid, "limits", quantity)
    given = getattr(case.statement(pid, rid).limits, quantity)
    if isinstance(given, Printed):
        return [Spot(f"The limit of {quantity}", path, given)]
    at = case.robot.joints.index(joint)
    if not isinstance(given, tuple) or not isinstance(given[at], Printed):
        return []
    return [Spot(f"The limit of {quantity} of joint {joint}", (*path, at), given[at])]


def waypoints(case: Case, pid: str, rid: str, joint: str) -> list[Spot]:
    """The way-points of a joint under a problem and a reading."""
    block = case.statement(pid, rid).waypoints
    path = _last_layer(case, pid, rid, "waypoints")
    at = case.robot.joints.index(joint)
    found = []
    # Angles on a line are computed, not printed.
    printed = block.line is None and bool(block.joint_rows or block.waypoint_rows)
    for w, row in enumerate(block.points if printed else ()):
        place_in = (
            ("joint_rows", at, w) if block.joint_rows is not None else ("waypoint_rows", w, at)
        )
        label = block.labels[w] if w < len(block.labels) else str(w + 1)
        found.append(Spot(f"Way-point {label} of joint {joint}", (*path, *place_in), row[at]))
    return found


def _last_layer(case: Case, pid: str, rid: str, block: str, key: str = "") -> Path:
    """The path of a block in the layer that a problem under a reading takes it from."""
    document = case.document
    layers: list[tuple[Path, Any]] = [((), document)]
    layers += [(("problems", k), p) for k, p in enumerate(document.problems) if p.id == pid]
    layers += [(("readings", k), r) for k, r in enumerate(document.readings) if r.id == rid]
    found: Path = ()
    for path, layer in layers:
        own = getattr(layer, block)
        if own is not None and (not key or key in own.model_fields_set):
            found = path
    return (*found, block, key) if key else (*found, block)


# --- changes that are no misprint of one number ---------------------------------------------------


def exchanges(spots: Sequence[Spot]) -> Iterator[Slip]:
    """Two durations of one row in each other's place."""
    for (i, one), (k, other) in combinations(enumerate(spots), 2):
        if one.number.fraction == other.number.fraction:
            continue
        yield Slip(
            change=f"Durations {i + 1} and {k + 1} may have been exchanged in print.",
            edits=((one.path, other.number), (other.path, one.number)),
            slips=2,
            share=1.0,
            kind="exchange",
        )


def of_rows(case: Case, claim: AnyClaim) -> Iterator[Slip]:
    """A duration of a longest row that is another row's: the longest one in its place."""
    if not isinstance(claim, MaximumClaim):
        return
    rows = [case.printed_durations(case.claim(other)) for other in claim.of]
    for k, spot in enumerate(durations(case, claim)):
        longest = max((row[k] for row in rows if k < len(row)), key=lambda n: n.fraction)
        if longest.fraction > spot.number.fraction > 0:
            yield Slip(
                change=f"{spot.name} may have been taken from another row: {longest.text} instead "
                f"of {spot.number.text}.",
                edits=((spot.path, longest),),
                slips=1,
                share=float(longest.fraction / spot.number.fraction),
                kind="row",
            )


def turns(spots: Sequence[Spot], joint: str, unit: str, radians: Sequence[float]) -> Iterator[Slip]:
    """Angles of a joint a full turn further or less far."""
    # A double-precision angle in radians holds twelve decimals of a turn.
    turn = Decimal(str(round(from_si(tau, unit), 12)))
    for w, spot in enumerate(spots):
        for sign in (-1, 1):
            number = spot.number.decimal + sign * turn
            yield Slip(
                change=f"The angle of joint {joint} at way-point {w + 1} may be meant modulo a "
                f"full turn: {radians[w] + sign * tau:.6g} rad instead of {radians[w]:.6g} rad.",
                edits=((spot.path, Printed(f"{number:f}", exact=spot.number.exact)),),
                slips=2,
                share=1.0,
                kind="turn",
            )
