"""From a `Problem` to an unsolved, printable NLP in CasADi: durations and spline coefficients."""

from __future__ import annotations

import time
from dataclasses import dataclass
from enum import StrEnum
from typing import Any

import numpy as np

from ...problem import Array
from ...problem.curves import PERM, Condition, ConditionKind, Interpolant, layout
from .symbolic import ca

GRID = {1: 0, 2: 2, 3: 4, 4: 5}
"""Interior slots of a segment for a limited derivative of this polynomial degree."""


class Form(StrEnum):
    """What the NLP's variables are."""

    REDUCED = "reduced"
    """Durations and free nodal derivatives; coefficients are eliminated symbolically."""
    LIFTED = "lifted"
    """Durations and all coefficients, with the declaration's rows as equalities."""


@dataclass(frozen=True)
class Structure:
    """What the shape of the NLP depends on; problems that share it share one build.

    Attributes
    ----------
    interpolant : Interpolant
    joints : int
    orders : tuple of int
        Limited derivative orders (0 position, 1 velocity, 2 acceleration, 3 jerk).
    form : Form
    uneven : bool
        Whether lower limits are numbers of their own, and not those of the upper ones.
    """

    interpolant: Interpolant
    joints: int
    orders: tuple[int, ...]
    form: Form
    uneven: bool = False


@dataclass(frozen=True)
class SlotGroup:
    """Places in some segments at which one derivative of every joint is limited.

    A slot sits at parameter ``s``; where it follows an extremum, one chord-Newton step
    ``s − w p'(s)`` inside the NLP tracks it, so that values, gradients and Hessians are those of
    the moving extremum.
    """

    order: int
    segments: tuple[int, ...]
    place: float | None
    """A fixed end (0 or 1), or None for a slot that moves."""
    slot: int


@dataclass(frozen=True, eq=False)
class Formulation:
    """An NLP that is built but not solved.

    Attributes
    ----------
    structure : Structure
    groups : tuple of SlotGroup
        The inequality rows, in order; two blocks (upper, lower) of segments × joints each.
    variables, parameters : casadi matrices
    objective, equalities, inequalities : casadi matrices
    build_seconds : float
    """

    structure: Structure
    groups: tuple[SlotGroup, ...]
    variables: Any
    parameters: Any
    objective: Any
    equalities: Any
    inequalities: Any
    coefficients: Any
    build_seconds: float

    @property
    def sizes(self) -> dict[str, int]:
        """Number of variables, equalities and inequalities."""
        return {
            "variables": int(self.variables.numel()),
            "equalities": int(self.equalities.numel()),
            "inequalities": int(self.inequalities.numel()),
        }

    def __str__(self) -> str:
        s, n = self.structure, self.sizes
        names = ("position", "velocity", "acceleration", "jerk")
        return (
            f"minimise the total of {s.interpolant.segments} segment durations\n"
            f"  curve        {s.interpolant.name}, {s.joints} joint(s)\n"
            f"  form         {s.form}: {n['variables']} variables\n"
            f"  subject to   {n['equalities']} equalities, {n['inequalities']} inequalities on "
            + ", ".join(names[r] for r in s.orders)
        )


def slot_groups(interpolant: Interpolant, orders: tuple[int, ...]) -> tuple[SlotGroup, ...]:
    """Ends and interior slots of every limited derivative, grouped for whole-array operations."""
    n = interpolant.segments
    groups: list[SlotGroup] = []
    for r in orders:
        alive = [k for k in range(n) if interpolant.degrees[k] >= r]
        left = [
            k
            for k in alive
            if (k == 0 and not any(o == r for o, _ in interpolant.prescribed[0]))
            or (k > 0 and (interpolant.continuity[k - 1] < r or k - 1 not in alive))
        ]
        right = [
            k
            for k in alive
            if interpolant.degrees[k] > r
            and not any(o == r for o, _ in interpolant.prescribed[k + 1])
        ]
        if r == 0:
            left, right = [], []
            virtual = [b - 1 for b in interpolant.virtual]
            right = virtual
        if left:
            groups.append(SlotGroup(r, tuple(left), 0.0, -1))
        if right:
            groups.append(SlotGroup(r, tuple(right), 1.0, -1))
        slots = {k: interior_slots(interpolant.degrees[k] - r) for k in alive}
        for m in range(max(slots.values(), default=0)):
            having = tuple(k for k in alive if slots[k] > m)
            groups.append(SlotGroup(r, having, None, m))
    return tuple(groups)


def interior_slots(degree: int) -> int:
    """Interior slots for a limited derivative of this degree: more than its turning points."""
    return GRID.get(degree, degree + 1) if degree > 0 else 0


def _take(matrix: Any, rows: tuple[int, ...] | list[int]) -> Any:
    return matrix[list(rows), :]


def _derivative(coefficients: list[Any], order: int, s: Any, rows: tuple[int, ...]) -> Any:
    """Scaled derivative d^order/ds^order at ``s`` for some segments (Horner over whole arrays)."""
    value: Any = 0
    for p in range(len(coefficients) - 1, order - 1, -1):
        value = value * s + float(PERM[p, order]) * _take(coefficients[p], rows)
    return value


def _row_groups(rows: tuple[Condition, ...]) -> dict[tuple[ConditionKind, int], list[int]]:
    groups: dict[tuple[ConditionKind, int], list[int]] = {}
    for i, row in enumerate(rows):
        groups.setdefault((row.kind, row.order), []).append(i)
    return groups


def _lifted_rows(
    interpolant: Interpolant, h: Any, coefficients: list[Any], values: Any, joints: int
) -> list[Any]:
    rows = interpolant.rows
    equations: list[Any] = []
    ones = np.ones((1, joints))
    for (kind, r), members in _row_groups(rows).items():
        at = [rows[i].at for i in members]
        if kind == ConditionKind.RIGHT_VALUE:
            scale = ca.mtimes(_take(h, at) ** r, ones)
            equation = (
                float(PERM[r, r]) * _take(coefficients[r], at) - _take(values, members) * scale
            )
        else:
            before = tuple(b - 1 for b in at)
            equation = _derivative(coefficients, r, 1.0, before)
            if kind == ConditionKind.LEFT_VALUE:
                scale = ca.mtimes(_take(h, before) ** r, ones)
                equation = equation - _take(values, members) * scale
            else:
                own = ca.mtimes(_take(h, at) ** r, ones)
                other = ca.mtimes(_take(h, before) ** r, ones)
                equation = equation * own - float(PERM[r, r]) * _take(coefficients[r], at) * other
        equations.append(ca.vec(equation))
    return equations


def _eliminated(interpolant: Interpolant, h: Any, values: Any, joints: int) -> list[Any]:
    """Coefficients as expressions in the durations and the rows' values."""
    plan = layout(interpolant)
    n, top = interpolant.segments, max(interpolant.degrees)
    known: dict[tuple[int, int], Any] = {}
    rows = range(plan.kinds.size)
    for i in rows:
        if plan.kinds[i] == ConditionKind.RIGHT_VALUE:
            k, r = int(plan.breaks[i]), int(plan.orders[i])
            known[k, r] = values[i, :] * h[k] ** r / float(PERM[r, r])
    matrix = ca.SX(plan.unknowns, plan.unknowns)
    right = ca.SX.zeros(plan.unknowns, joints)
    e = 0
    for i in rows:
        if plan.kinds[i] == ConditionKind.RIGHT_VALUE:
            continue
        b, r = int(plan.breaks[i]), int(plan.orders[i])
        k = b - 1
        for p in range(r, int(plan.degrees[k]) + 1):
            c = int(plan.column[k, p])
            if c >= 0:
                matrix[e, c] = float(PERM[p, r])
            else:
                right[e, :] -= float(PERM[p, r]) * known[k, p]
        if plan.kinds[i] == ConditionKind.LEFT_VALUE:
            right[e, :] += values[i, :] * h[k] ** r
        elif r <= plan.degrees[b]:
            own = (h[k] / h[b]) ** r * float(PERM[r, r])
            c = int(plan.column[b, r])
            if c >= 0:
                matrix[e, c] = -own
            else:
                right[e, :] += own * known[b, r]
        e += 1
    solved = ca.solve(matrix, right)
    coefficients = [ca.SX.zeros(n, joints) for _ in range(top + 1)]
    for k in range(n):
        for p in range(int(plan.degrees[k]) + 1):
            c = int(plan.column[k, p])
            coefficients[p][k, :] = solved[c, :] if c >= 0 else known[k, p]
    return coefficients


def build(structure: Structure) -> Formulation:
    """Build the NLP of a structure; all numbers enter as parameters.

    Parameters
    ----------
    structure : Structure

    Returns
    -------
    Formulation

    Notes
    -----
    In s = (t − t_k)/h_k the limits read |p⁽ʳ⁾(s)| ≤ L hʳ. Parameters, in this order: the values
    of the declaration's rows (way-points, prescribed derivatives), the reciprocals of the
    derivative limits (upper ones before lower ones, where they are uneven), position bounds, and
    for each moving slot its place and its Newton weight.
    """
    began = time.perf_counter()
    interpolant, joints = structure.interpolant, structure.joints
    n, top = interpolant.segments, max(interpolant.degrees)
    reduced = structure.form is Form.REDUCED
    symbol = ca.SX if reduced else ca.MX
    h = symbol.sym("h", n)
    row_count = layout(interpolant).kinds.size if reduced else len(interpolant.rows)
    values = symbol.sym("values", row_count, joints)
    inverse_limits = symbol.sym("inverse_limits", 6 if structure.uneven else 3, joints)
    position = symbol.sym("position", 4, joints)
    parameters = [ca.vec(values), ca.vec(inverse_limits), ca.vec(position)]
    equalities: list[Any] = []
    if reduced:
        nodal = symbol.sym("nodal", interpolant.free, joints)
        rows = symbol(values)
        plan = layout(interpolant)
        for i in np.flatnonzero(plan.nodal >= 0):
            rows[int(i), :] = nodal[int(plan.nodal[i]), :]
        coefficients = _eliminated(interpolant, h, rows, joints)
        variables = ca.vertcat(h, ca.vec(nodal))
    else:
        coefficients = [symbol.sym(f"c{p}", n, joints) for p in range(top + 1)]
        equalities = _lifted_rows(interpolant, h, coefficients, values, joints)
        variables = ca.vertcat(h, *[ca.vec(c) for c in coefficients])
    groups = slot_groups(interpolant, structure.orders)
    inequalities: list[Any] = []
    for number, group in enumerate(groups):
        r, segments = group.order, group.segments
        size = (len(segments), joints)
        if group.place is None:
            place = symbol.sym(f"s{number}", *size)
            weight = symbol.sym(f"w{number}", *size)
            parameters += [ca.vec(place), ca.vec(weight)]
            s = place - weight * _derivative(coefficients, r + 1, place, segments)
        else:
            s = group.place
        value = _derivative(coefficients, r, s, segments)
        tall = np.ones((len(segments), 1))
        if r == 0:
            low, high, with_low, with_high = (ca.mtimes(tall, position[i, :]) for i in range(4))
            upper, lower = (value - high) * with_high, (low - value) * with_low
        else:
            room = ca.mtimes(_take(h, segments) ** r, np.ones((1, joints)))
            below = value * ca.mtimes(tall, inverse_limits[r + 2, :]) if structure.uneven else None
            value = value * ca.mtimes(tall, inverse_limits[r - 1, :])
            upper, lower = value - room, -(value if below is None else below) - room
        inequalities += [ca.vec(upper), ca.vec(lower)]
    empty = symbol(0, 1)
    return Formulation(
        structure=structure,
        groups=groups,
        variables=variables,
        parameters=ca.vertcat(*parameters),
        objective=ca.sum1(h),
        equalities=ca.vertcat(*equalities) if equalities else empty,
        inequalities=ca.vertcat(*inequalities) if inequalities else empty,
        coefficients=ca.vertcat(*[ca.vec(c) for c in coefficients]),
        build_seconds=time.perf_counter() - began,
    )


def pack_parameters(
    values: Array,
    inverse_limits: Array,
    position: Array,
    places: list[Array],
    weights: list[Array],
) -> Array:
    """Parameter vector of a formulation, in the order that `build` documents."""
    parts = [values.ravel("F"), inverse_limits.ravel("F"), position.ravel("F")]
    for place, weight in zip(places, weights, strict=True):
        parts += [place.ravel("F"), weight.ravel("F")]
    return np.concatenate(parts)
