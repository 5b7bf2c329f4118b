"""Misprints that a case may hold: another number, the case with it, and the motions then."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from decimal import Decimal
from itertools import combinations
from math import tau
from typing import Any, cast

import numpy as np

from ...problem import (
    QUANTITIES,
    Array,
    Case,
    Limits,
    Printed,
    Problem,
    Quantity,
    evaluate,
    from_si,
)
from ...problem.cases import (
    AnyClaim,
    Claim,
    ImprovementClaim,
    MaximumClaim,
    PeakClaim,
    TotalTimeClaim,
    ValueClaim,
    motions_of,
)
from ..documents import Explanation, Finding
from .printed_row import PrintedRow
from .rules import box_reach, largest
from .stated import RowClaim, place

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
            change=f"{spot.name} is printed as {was.text}, perhaps for {other.text}.",
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
    where, path = f" in {place(claim)}" if named else "", _claim_path(case, claim)
    return [
        Spot(f"The duration of segment {k + 1}{where}", (*path, "durations", k), number)
        for k, number in enumerate(case.printed_durations(claim))
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
        numbers = (("percentage", "percent", claim.percent), ("saving", "seconds", claim.seconds))
        return [Spot(f"The {name}", (*path, key), n) for name, key, n in numbers if n is not None]
    if not isinstance(claim, PeakClaim | ValueClaim):
        return []
    name = f"The {claim.quantity} of {claim.derivative}"
    if claim.value is not None:
        return [Spot(name, (*path, "value"), claim.value)]
    each = enumerate(zip(case.robot.joints, claim.values or (), strict=False))
    return [Spot(f"{name} of joint {label}", (*path, "values", j), n) for j, (label, n) in each]


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


# --- motions of what is changed -------------------------------------------------------------------

_Tried = tuple[Sequence[Slip], Array, Array]
"""Changes of one kind; the peaks of the motions that they lead to, and the limits, both of the
shape (changes, joints, 3)."""


def changes_of_motion(
    row: PrintedRow[RowClaim], finding: Finding, claim: AnyClaim
) -> tuple[list[tuple[Slip, bool]], Explanation | None]:
    """Changes that may settle what is said of a motion, and whether they reach a limit.

    The likeliest first; and what only brings the motion nearer to its limits.
    """
    problem, worst = row.posed(), row.check.worst
    if worst is None or worst.quantity in ("curve", "duration"):
        return [], None
    if problem.limits.uneven or problem.curve.free:
        return [], None
    printed = _peaks(problem, row.durations.value[None])
    before = float(_ratios(printed, problem.limits.derivatives).max())
    ranked: list[tuple[tuple[int, bool, int, float], Slip]] = []
    best: tuple[float, Slip] | None = None
    # How far digits that are rounded or cut off move peaks, to first order, as a share of them.
    orders = range(1, 1 + len(row.posed().limits.quantities))
    tops = [top for order in orders for top in largest(row, order) if top.value != 0.0]
    room = 2.0 * max((box_reach(row, top) / abs(top.value) for top in tops), default=0.0)
    least = max(1 + room, before if finding.rule != "TG201" else 0.0)
    off = int(_offs(row, problem, printed, room)[0])
    # Of a peak that does not fit, only what makes it fit is an explanation.
    most = off - 1 if isinstance(claim, PeakClaim) else off
    for slips, peaks, sizes in _changes(row, finding, printed[0]):
        offs = _offs(row, problem, peaks, room)
        ratios = _ratios(peaks, sizes).max(axis=(1, 2))
        for slip, ratio, far in zip(slips, ratios, offs, strict=True):
            away = bool(ratio < 1 - room)
            # A leading digit could always make a duration long enough, so a change by more than
            # half that no other printed number speaks for explains nothing.
            telling = far < off or not away or slip.share <= 1.5
            if ratio <= least and far <= most and telling and not _breaks_sum(row.claim, slip):
                ranked.append(((int(far), away, slip.slips, slip.share), slip))
            elif slip.share == 1.0 and (best is None or ratio < best[0]):
                best = float(ratio), slip  # an exchange or a turn
    ranked += _other_values(row, claim, problem, printed[0], room)
    ranked.sort(key=lambda one: one[0])
    nearer = None
    # Where less than a tenth of the excess goes, nothing is explained.
    if finding.rule == "TG201" and best is not None and best[0] - 1 <= 0.9 * (before - 1):
        nearer = Explanation(
            change=best[1].change,
            effect=f"Then the largest ratio to a limit falls from {before:.4g} to {best[0]:.4g}, "
            "and a limit is still broken.",
            settles=False,
        )
    return [(slip, not key[1]) for key, slip in ranked], nearer


def _ratios(peaks: Array, limits: Array) -> Array:
    """Ratios of peaks to limits; 0 where both are 0."""
    with np.errstate(invalid="ignore", divide="ignore"):
        found: Array = np.nan_to_num(peaks[..., : limits.shape[-1]] / limits, nan=0.0)
    return found


def _other_values(
    row: PrintedRow[Claim], claim: AnyClaim, problem: Problem, peaks: Array, room: float
) -> Iterator[tuple[tuple[int, bool, int, float], Slip]]:
    """Other printed peaks, where they are those of the motion as printed."""
    if not isinstance(claim, PeakClaim):
        return
    order = QUANTITIES.index(claim.derivative)
    spots = values(row.study.case, claim)
    for (label, _), spot in zip(row.study.printed_numbers(claim), spots, strict=True):
        if label is not None and label not in problem.joints:
            continue
        joints = slice(None) if label is None else problem.joints.index(label)
        here = float(np.max(peaks[joints, order]))
        if _meets(row, claim, spot.number, label, here, room):
            continue
        for slip in misprints(spot):
            if _meets(row, claim, slip.edits[0][1], label, here, room):
                yield (0, False, slip.slips, slip.share), slip


def _meets(
    row: PrintedRow[Claim],
    claim: PeakClaim,
    number: Printed,
    label: str | None,
    peak: float,
    room: float,
) -> bool:
    """Whether a printed peak is near that of a motion, as digits go."""
    meant = row.measured(number, claim.derivative, label)
    return abs(meant.value - peak) <= room * peak + meant.upper - meant.lower


def _breaks_sum(row: RowClaim, slip: Slip) -> bool:
    """Whether a change takes the durations of a row from their printed total."""
    if row.total is None or slip.edits[0][0][-2] != "durations":
        return False
    far = [
        abs(sum(n.fraction for n in each) - row.total.fraction)
        for each in (row.durations, _durations_with(row, slip))
    ]
    room = len(row.durations) * max(n.unit for n in (*row.durations, row.total))
    return far[1] > max(far[0], room)


def _durations_with(row: RowClaim, slip: Slip) -> list[Printed]:
    """The durations of a row with a change made."""
    found = list(row.durations)
    for path, number in slip.edits:
        found[int(path[-1])] = number
    return found


def _changes(row: PrintedRow[RowClaim], finding: Finding, printed: Array) -> Iterator[_Tried]:
    """Other durations, way-points and limits, with the peaks that follow."""
    case, problem = row.study.case, row.posed()
    statement, sizes = row.statement, problem.limits.derivatives
    h = row.durations.value
    spots = durations(case, row.claim)
    slips = [*exchanges(spots), *of_rows(case, row.claim)]
    slips += [s for spot in spots for s in misprints(spot)]
    times = np.array(
        [
            [statement.si(n, "time").value for n in _durations_with(row.claim, slip)]
            for slip in slips
        ]
    )
    if slips:
        yield slips, _peaks(problem, times.reshape(-1, h.size)), sizes[None]
    ratios = _ratios(printed, sizes)
    # A way-point moves its joint alone, so no other joint may be beyond a limit already.
    beyond = ratios.max(axis=1) > 1.0
    for j in np.flatnonzero(beyond if finding.rule == "TG201" else np.ones_like(beyond)):
        label = problem.joints[j]
        at = case.robot.joints.index(label)
        spots = waypoints(case, *row.pair, label)
        slips = [s for spot in spots for s in misprints(spot, signed=True)]
        unit = statement.unit("position", at)
        if spots and unit and not problem.linear[j]:
            slips += turns(spots, label, unit, list(problem.waypoints[:, j]))
        peaks = np.tile(printed, (len(slips), 1, 1))
        paths = [spot.path for spot in spots]
        columns = np.tile(problem.waypoints[:, j], (len(slips), 1))
        for k, slip in enumerate(slips):
            path, number = slip.edits[0]
            # Whole turns between a printed angle and the one that is meant stay.
            printed_one = spots[paths.index(path)].number
            was, now = (statement.si(n, "position", joint=at).value for n in (printed_one, number))
            columns[k, paths.index(path)] += now - was
        if slips:
            alone = problem.joint(int(j))
            each = (replace(alone, waypoints=column[:, None]) for column in columns)
            peaks[:, j] = [_peaks(one, h[None])[0, 0] for one in each]
            yield slips, peaks, sizes[None]
        for r in np.flatnonzero(ratios[j] > 1.0):
            yield from _other_limits(row, problem, printed, int(j), int(r))


def _other_limits(
    row: PrintedRow[Claim], problem: Problem, printed: Array, joint: int, order: int
) -> Iterator[_Tried]:
    """Other limits of a quantity of a joint, or of all joints where one number holds for all."""
    quantity, label = cast(Quantity, QUANTITIES[order]), problem.joints[joint]
    case, statement = row.study.case, row.statement
    at = case.robot.joints.index(label)
    slips, sizes = [], []
    for spot in limits(case, *row.pair, quantity, label):
        for slip in misprints(spot):
            number = slip.edits[0][1]
            size = problem.limits.derivatives.copy()
            whose = joint if spot.path[-1] == at else slice(None)
            size[whose, order] = statement.si(number, quantity, joint=at).value
            slips.append(slip)
            sizes.append(size)
    if slips:
        yield slips, np.tile(printed, (len(slips), 1, 1)), np.array(sizes)


def _peaks(problem: Problem, times: Array) -> Array:
    """Largest absolute derivatives, shape (batch, joints, orders), rad and s."""
    plain = Limits(1.0, 1.0, 1.0, snap=1.0, joints=len(problem.joints))
    return evaluate(replace(problem, limits=plain), times).ratios


def _offs(row: PrintedRow[Claim], problem: Problem, peaks: Array, room: float) -> Array:
    """How many printed peaks of a row are far from those of each changed motion."""
    off, case = np.zeros(len(peaks)), row.study.case
    for claim in case.claims:
        if not isinstance(claim, PeakClaim) or row.claim not in motions_of(case.claims, claim):
            continue
        order = QUANTITIES.index(claim.derivative)
        for label, number in row.study.printed_numbers(claim):
            if label is not None and label not in problem.joints:
                continue
            own = peaks[:, :, order]
            here = own.max(axis=1) if label is None else own[:, problem.joints.index(label)]
            off += [not _meets(row, claim, number, label, x, room) for x in here]
    return off
