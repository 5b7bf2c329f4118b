"""TG601: joint way-points and Cartesian way-points against the printed chain."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import combinations, product

import numpy as np

from ....problem import Array, Measured, is_linear, shown_bound, to_si
from ....problem.cases import Cartesian, Column, Statement, StatementClaim
from ....problem.robots import Chain, Convention, DhTable, JointKind, Proximity, proximity
from ...documents import Basis, ClaimVerdict, Finding, enumerated
from ..study import Study
from .rule_group import Explained, rule_group

_CUT_OFF = 2.0
"""Multiple of what rounding explains up to which digits that were cut off explain a miss."""

_APART = "not set beside"
"""Kind of what says why angles and positions are not compared."""
Joints = dict[str, tuple[Measured, ...]]
"""Angles of the printed joints at every way-point."""


@dataclass(frozen=True, eq=False)
class _Match:
    """One convention: distances of all positions, as printed and over the signs of the twists."""

    convention: Convention
    near: tuple[Proximity, ...]
    slack: tuple[float, ...]
    signed: tuple[tuple[Proximity, ...], ...]
    """The same for every other choice of signs."""
    radial: float
    """Largest miss of the distance from the base's origin beyond rounding, or 0, m."""
    unsigned: tuple[int, float] | None = None
    """The position that is missed most with the best signs of twists, angles and coordinates, and
    by how much at least, m; None if none is shown to be missed, or nothing was looked for."""

    @property
    def fits(self) -> bool:
        """Whether every position is met within rounding, as printed."""
        return _fits(self.near, self.slack)

    @property
    def misses(self) -> bool:
        """Whether some position is missed, rounded or cut off, whatever the signs."""
        most = [_CUT_OFF * one for one in self.slack]
        every = (zip(near, most, strict=True) for near in (self.near, *self.signed))
        return all(any(one.lower > far for one, far in each) for each in every)

    @property
    def worst(self) -> float:
        """Largest distance over the positions, with the best signs, m."""
        return min(max(n.lower for n in near) for near in (self.near, *self.signed))


TG601 = Explained(
    "TG601",
    "Joint and Cartesian way-points are consistent with the printed chain",
    "Do printed joint angles and printed positions fit the printed table of the robot? "
    "Positions are computed from the angles; joints that are not printed may have any angle.",
    "Supported if they fit within rounding; inconsistent, with a warning, if no angles "
    "reach a position, rounded or cut off. If extracted text may have lost signs of the "
    "table, every sign is tried.",
    "For any angles of joints 1 and 3, the end stays at least 0.78 m away from a printed position.",
    basis=Basis.KINEMATICS,
)


@rule_group(TG601)
def judge_kinematics(study: Study) -> Iterator[Finding]:
    """Set the joint table against the printed positions, for every reading."""
    statements = (c for c in study.case.claims if isinstance(c, StatementClaim))
    # The statement that angles and positions belong together, if one is made.
    own = next((c.id for c in statements if c.checks == "kinematics"), None)
    for found in _found(study):
        yield found.model_copy(update={"claim": own})


def _found(study: Study) -> Iterator[Finding]:
    case, dh = study.case, study.case.dh
    if not case.cartesian:
        return
    if dh is None:
        said = "Positions of the end are printed, but no table of the robot."
        yield TG601.finding(None, _APART, said)
        return
    for reading in study.readings:
        chains: dict[object, tuple[str, Statement]] = {}
        for pid, rid in study.pairs:
            statement = case.statement(pid, rid)
            same = statement.waypoints.points, statement.units.position
            if rid == reading:
                chains.setdefault(same, (pid, statement))
        for pid, statement in chains.values():
            yield _compared(study, dh, statement, reading, pid if len(chains) > 1 else None)


def _compared(
    study: Study, dh: DhTable, statement: Statement, rid: str, pid: str | None
) -> Finding:
    printed = study.case.chain()
    assert printed is not None
    joints = _joints(study, statement)
    named = [(i, label) for i, label in enumerate(printed.labels) if label in joints]
    kinds = dict(zip(printed.labels, printed.kinds, strict=True))
    free = [label for label in printed.labels if label not in joints]
    sliding = [label for label in free if kinds[label] is JointKind.PRISMATIC]
    # Those of the problem agree with the table since the file was read.
    apart = [
        column.joint
        for column in study.case.columns
        if column.joint in joints
        and is_linear(_column_unit(column, statement))
        != (kinds.get(column.joint) is JointKind.PRISMATIC)
    ]
    places = _places(study, statement)
    if sliding or apart or any(k is None for k, _ in places):
        why = (
            f"joint {sliding[0]} slides, and its positions are not printed"
            if sliding
            else f"the unit of joint {apart[0]} is not that of its kind in the robot's table"
            if apart
            else "the numbers of positions and way-points differ"
        )
        said = f"Positions cannot be compared with joint angles: {why}."
        return TG601.finding(None, _APART, said, reading=rid)
    matches = []
    for convention in dh.conventions:
        flips: list[tuple[int, ...]] = [()]
        if dh.alpha_signs == "uncertain":
            flips += [
                tuple(c) for n in range(len(dh.twisted)) for c in combinations(dh.twisted, n + 1)
            ]
        matches.append(_match(study, dh, convention, joints, places, flips))
    return _judged(study, statement, rid, pid, [label for _, label in named], places, matches)


def _joints(study: Study, statement: Statement) -> Joints:
    """Angles of every printed joint: those of the problems, and those in columns of their own."""
    rows = statement.waypoints.points
    found = {
        label: tuple(statement.si(row[j], "position", joint=j) for row in rows)
        for j, label in enumerate(statement.labels)
    }
    for column in study.case.columns:
        if column.joint is not None and len(column.values) == len(rows):
            unit = _column_unit(column, statement)
            found[column.joint] = tuple(to_si(v, unit) for v in column.values)
    return found


def _column_unit(column: Column, statement: Statement) -> str:
    """The unit of a printed joint beside those of the problems."""
    unit = statement.units.position
    return unit if isinstance(unit, str) else column.unit


def _bounded(chain: Chain, joints: Joints) -> Chain:
    """The chain with printed joints that slide bounded by their positions: its arms are finite."""
    lower, upper = chain.lower.copy(), chain.upper.copy()
    for i, label in enumerate(chain.labels):
        if chain.kinds[i] is JointKind.PRISMATIC:
            lower[i] = min(one.lower for one in joints[label])
            upper[i] = max(one.upper for one in joints[label])
    return replace(chain, lower=lower, upper=upper)


def _places(study: Study, statement: Statement) -> list[tuple[int | None, Cartesian]]:
    """Printed positions with the index of their way-point; None if there is none."""
    labels, count = statement.waypoints.labels, len(statement.waypoints.points)
    places = study.case.cartesian
    found: list[tuple[int | None, Cartesian]] = []
    for k, place in enumerate(places):
        at = k if len(places) == count else None
        if place.waypoint is not None:
            at = labels.index(place.waypoint) if place.waypoint in labels else None
        found.append((at, place))
    return found


def _match(
    study: Study,
    dh: DhTable,
    convention: Convention,
    joints: Joints,
    places: list[tuple[int | None, Cartesian]],
    flips: list[tuple[int, ...]],
) -> _Match:
    variants = []
    for flipped in flips:
        chain = study.case.chain(convention, flipped)
        assert chain is not None
        variants.append(_bounded(chain, joints))
    near: list[list[Proximity]] = [[] for _ in variants]
    slack, radial = [], 0.0
    for k, place in places:
        assert k is not None
        held, loose = _held(variants[0], joints, k)
        xyz = [to_si(number, place.unit) for number in place.values]
        point = np.array([m.value for m in xyz])
        halves = np.array([(m.upper - m.lower) / 2 for m in xyz])
        # Float arithmetic alone could leave 1e-9 m.
        allowed = dh.rounding(variants[0]) + loose + float(np.linalg.norm(halves)) + 1e-9
        slack.append(allowed)
        for found, chain in zip(near, variants, strict=True):
            found.append(proximity(chain, point, held))
        away = min(proximity(chain, point, held, radial=True).lower for chain in variants)
        radial = max(radial, away if away > allowed else 0.0)
    first, *others = (tuple(found) for found in near)
    match = _Match(convention, first, tuple(slack), tuple(others), radial)
    if not (others and match.misses):
        return match
    return replace(match, unsigned=_unsigned(variants, joints, places, first, slack))


def _unsigned(
    variants: list[Chain],
    joints: Joints,
    places: list[tuple[int | None, Cartesian]],
    near: tuple[Proximity, ...],
    slack: list[float],
) -> tuple[int, float] | None:
    """A position that is missed beyond rounding whatever minus signs the text has lost.

    Each sign may be lost by itself, so one position that no signs lead to is enough: those
    that are missed most as printed are tried first.
    """
    for at in sorted(range(len(places)), key=lambda at: -near[at].lower):
        k, place = places[at]
        assert k is not None
        point = np.array([to_si(number, place.unit).value for number in place.values])
        held, _ = _held(variants[0], joints, k)
        least = min(
            proximity(chain, xyz, angles, tolerance=0.1 * slack[at]).lower
            for chain in variants
            for xyz in _signs(point)
            for angles in _signs(held)
        )
        if least > _CUT_OFF * slack[at]:
            return at, least
    return None


def _signs(values: Array) -> list[Array]:
    """Some numbers with every choice of their signs; free ones and zeros have none."""
    signed = [(v, -v) if np.isfinite(v) and v != 0.0 else (v,) for v in values]
    return [np.array(one) for one in product(*signed)]


def _held(chain: Chain, joints: Joints, k: int) -> tuple[Array, float]:
    """Joint values at a way-point, NaN where not printed, and what their rounding moves."""
    held, loose = np.full(chain.joints, np.nan), 0.0
    for i, label in enumerate(chain.labels):
        if label in joints:
            angle = joints[label][k]
            held[i] = angle.value
            loose += float(chain.arms[i]) * (angle.upper - angle.lower) / 2
    return held, loose


def _fits(near: tuple[Proximity, ...], slack: tuple[float, ...]) -> bool:
    return all(n.upper <= s for n, s in zip(near, slack, strict=True))


_OPEN = {
    "other signs": "With other signs of the twists, the angles or the positions, which the text "
    "may have lost, no printed position is shown to be out of reach.",
    "other twists": "With other signs of the twists, which the text may have lost, the end meets "
    "every printed position.",
    "undecided": "It is not decided whether rounding, or digits cut off, explain the distances to "
    "the printed positions.",
}
"""Why nothing is decided, by the kind of the finding."""


def _judged(
    study: Study,
    statement: Statement,
    rid: str,
    pid: str | None,
    printed: list[str],
    places: list[tuple[int | None, Cartesian]],
    matches: list[_Match],
) -> Finding:
    chain = study.case.chain()
    assert chain is not None
    free = [label for label in chain.labels if label not in printed]
    names = [place.label or place.id for _, place in places]
    numbers = "values" if any(statement.linear) else "angles"
    units = statement.units.position
    read_in = ", ".join(units) if isinstance(units, tuple) else str(units)
    given = f"The {numbers} of {_named(printed)} are read in {read_in}"
    given += f"; {_named(free)} may have any value." if free else "."
    fitting = next((m for m in matches if m.fits), None)
    if fitting is not None:
        far = max(n.upper for n in fitting.near)
        verdict, kind = ClaimVerdict.SUPPORTED, "meets"
        said: tuple[str, ...] = (
            f"The end meets every printed position within {_up(far)} m "
            f"({fitting.convention} convention), and rounding explains {_up(max(fitting.slack))} "
            "m.",
            given,
        )
    else:
        listed = "; ".join(
            f"{', '.join(f'{n} {_down(p.lower)}' for n, p in zip(names, m.near, strict=True))} m "
            f"({m.convention} convention)"
            for m in matches
        )
        rounding = ", ".join(_up(s) for s in matches[0].slack)
        nearest = (
            given,
            f"The end then stays at least this far from the printed positions: {listed}.",
            f"Rounding explains at most {rounding} m.",
        )
        lost = any(m.signed and m.misses and m.unsigned is None for m in matches)
        if all(m.misses for m in matches) and not lost:
            verdict, kind = ClaimVerdict.INCONSISTENT, "misses"
            do = "does" if len(free) == 1 else "do"
            whatever = f", whatever {_named(free)} {do}" if free else ""
            said = (
                f"On the robot as printed, the printed {numbers} do not lead to the printed "
                f"positions{whatever}.",
                *nearest,
                *_whatever(matches, names),
                "The base frame, the zeros of the angles and the origin of the last frame as the "
                "end are those of the table.",
            )
        else:
            verdict = ClaimVerdict.NOT_CHECKABLE
            signed = any(_fits(near, m.slack) for m in matches for near in m.signed)
            kind = "other signs" if lost else "other twists" if signed else "undecided"
            said = _OPEN[kind], *nearest
    worst = "; ".join(f"{_down(m.worst)} m ({m.convention})" for m in matches)
    return TG601.finding(
        None,
        kind,
        *said,
        verdict=verdict,
        problem=pid,
        reading=rid,
        printed="; ".join(dict.fromkeys(place.where for _, place in places)),
        computed=f"smallest distance from the farthest position: {worst}",
        doubts=tuple(printed) if verdict is ClaimVerdict.INCONSISTENT else (),
    )


def _named(labels: list[str]) -> str:
    """Joints in a sentence."""
    return f"joint{'s' * (len(labels) > 1)} {enumerated(labels)}"


def _whatever(matches: list[_Match], names: list[str]) -> Iterator[str]:
    """What holds whatever the signs that the text may have lost, and the axes of the base."""
    missed = [(m, *m.unsigned) for m in matches if m.unsigned is not None]
    if missed:
        worst = enumerated(f"{names[at]} {_down(far)} m ({m.convention})" for m, at, far in missed)
        yield (
            "For all signs of the twists, the angles and the positions, the end misses a printed "
            f"position: {worst} at least."
        )
    turned = [f"{_down(m.radial)} m ({m.convention})" for m in matches if m.radial > 0]
    if turned:
        met = [str(m.convention) for m in matches if not m.radial > 0]
        besides = f"; in the {enumerated(met)} convention it may agree" if met else ""
        yield (
            "For any other axes of the base, the distance from its origin still differs by up to "
            f"{enumerated(turned)}{besides}."
        )


def _down(metres: float) -> str:
    """Three decimals that do not say more than the number."""
    return shown_bound(metres, "lower", places=3)


def _up(metres: float) -> str:
    if metres > 5e-4:
        return shown_bound(metres, "upper", places=3)
    return shown_bound(metres, "upper", digits=1)
