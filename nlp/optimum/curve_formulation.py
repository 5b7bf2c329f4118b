"""The NLP of any other curve: durations as variables, limits at places that follow the extrema."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache, lru_cache
from typing import Any

import numpy as np

from ...problem import Array, Curve, Problem
from ...problem.curves import MAX_COEFFICIENTS, roots_in_unit
from .clock import look_ahead, seconds_left
from .curve_symbols import Symbols, derived, evaluated, numbers, shape_key, symbols
from .ipopt import ipopt_options
from .stopping import look_at_clock
from .symbolic import ca

SLOWEST = 1e-4
"""Least dt/de where time is not linear, relative to the mean duration."""
SPEED = 4
"""Stands for the order of a row that keeps time increasing."""
DERIVING = 0.15
"""Seconds that CasADi takes to derive and order an NLP's derivatives, for each segment and each
second of writing it down: measured 0.11 to 0.14 for B-splines of 7 to 24 segments."""


@dataclass(frozen=True)
class CurveStructure:
    """What the shape of the NLP depends on; problems that share it share one build.

    Attributes
    ----------
    curve : Curve
    joints : int
    orders : tuple of int
        Limited derivative orders (0 position).
    key : tuple of int
        What else it depends on, see `shape_key`.
    """

    curve: Curve
    joints: int
    orders: tuple[int, ...]
    key: tuple[int, ...]


@dataclass(frozen=True)
class LimitPlace:
    """Where one derivative of one joint is limited: an end of a piece, or a slot that moves."""

    order: int
    joint: int
    piece: int
    end: float | None
    slot: int


@dataclass(frozen=True, eq=False)
class CurveFormulation:
    """An NLP that is built but not solved.

    A slot sits at parameter s; where it follows an extremum, the chord-Newton step
    s − w N_{r+1}(s) inside the NLP tracks it.
    """

    structure: CurveStructure
    symbols: Symbols
    places: tuple[LimitPlace, ...]
    parameters: Any
    inequalities: Any
    build_seconds: float

    @property
    def sizes(self) -> dict[str, int]:
        """Number of variables, equalities and inequalities."""
        return {
            "variables": int(self.symbols.durations.numel()),
            "equalities": 0,
            "inequalities": int(self.inequalities.numel()),
        }

    def __str__(self) -> str:
        s, n = self.structure, self.sizes
        return (
            f"minimise the total of {s.curve.segments} segment durations\n"
            f"  curve        {s.curve.name}, {s.joints} joint(s)\n"
            f"  subject to   {n['inequalities']} inequalities"
        )


def curve_structure(problem: Problem) -> CurveStructure:
    """The shape of a problem's NLP: curve, joints, and which derivatives are limited."""
    limits = problem.limits.derivatives
    usable = np.isfinite(limits) & (limits > 0)
    orders = tuple(r for r in (1, 2, 3) if usable[:, r - 1].any())
    if problem.limits.limits_position:
        orders = (0, *orders)
    joints = problem.waypoints.shape[1]
    return CurveStructure(problem.curve, joints, orders, shape_key(problem))


def _places(structure: CurveStructure, known: Symbols) -> tuple[LimitPlace, ...]:
    start, end = ({order for order, _ in side} for side in structure.curve.ends)
    found = []
    for r in structure.orders:
        for j, pieces in enumerate(known.pieces):
            last = len(pieces) - 1
            for k, piece in enumerate(pieces):
                joined = k > 0 and structure.curve.smooth_order(k) >= r
                if r and not joined and not (k == 0 and r in start):
                    found.append(LimitPlace(r, j, k, 0.0, -1))
                if r and len(piece.numerators[r]) > 1 and not (k == last and r in end):
                    found.append(LimitPlace(r, j, k, 1.0, -1))
                # One for each zero that the next numerator can have.
                slots = len(piece.numerators[r + 1]) - 1
                found += [LimitPlace(r, j, k, None, m) for m in range(slots)]
    for k in range(len(known.speeds)):
        found.append(LimitPlace(SPEED, 0, k, 0.0, -1))
        found.append(LimitPlace(SPEED, 0, k, None, 0))
    if known.speeds:
        found.append(LimitPlace(SPEED, 0, len(known.speeds) - 1, 1.0, -1))
    return tuple(found)


def build_curve(structure: CurveStructure) -> CurveFormulation:
    """Build the NLP of a structure; all numbers enter as parameters.

    Parameters, in this order: those of the curve, reciprocals of the derivative limits (3 per
    joint), position bounds (low, high, whether each counts; 4 per joint), and for each moving
    slot its place and its Newton weight.
    """
    began = time.perf_counter()
    highest = max([1, *(r + 1 for r in structure.orders)])
    known = symbols(structure.curve, structure.joints, highest, structure.key)
    inverse = ca.SX.sym("inverse", 3, structure.joints)
    position = ca.SX.sym("position", 4, structure.joints)
    parameters = [known.parameters, ca.vec(inverse), ca.vec(position)]
    places = _places(structure, known)
    moving = sum(place.end is None for place in places)
    s, w = ca.SX.sym("s", moving), ca.SX.sym("w", moving)
    parameters += [s, w]
    rows: list[Any] = []
    at = 0
    for place in places:
        look_ahead()
        if place.order == SPEED:
            speed = known.speeds[place.piece]
            turning = derived(speed)
        else:
            piece = known.pieces[place.joint][place.piece]
            turning = piece.numerators[place.order + 1]
        if place.end is None:
            e = s[at] - w[at] * evaluated(turning, s[at])
            at += 1
        else:
            e = ca.SX(place.end)
        if place.order == SPEED:
            rows.append(SLOWEST - evaluated(speed, e))
            continue
        value = evaluated(piece.numerators[place.order], e)
        if place.order == 0:
            low, high, with_low, with_high = (position[i, place.joint] for i in range(4))
            rows += [(value - high) * with_high, (low - value) * with_low]
        else:
            value = value * inverse[place.order - 1, place.joint]
            room = piece.scale(place.order, e)
            rows += [value - room, -value - room]
    return CurveFormulation(
        structure=structure,
        symbols=known,
        places=places,
        parameters=ca.vertcat(*parameters),
        inequalities=ca.vertcat(*rows) if rows else ca.SX(0, 1),
        build_seconds=time.perf_counter() - began,
    )


@dataclass(frozen=True, eq=False)
class CompiledCurve:
    """A formulation with its solvers, and its turning polynomials as numbers.

    A solver is derived on its first use; `clock.TooLong` is raised where that is estimated to take
    longer than what is left of the time. ``turning`` maps durations and the curve's parameters to
    two matrices, one row per place and ascending powers: the numerator of the limited derivative,
    and that of the next.
    """

    formulation: CurveFormulation
    turning: Any
    build_seconds: float
    _solver: Callable[[bool, bool], Any]

    @property
    def cold(self) -> Any:
        """From a start; ends at the iteration at which the time is up."""
        return self._solver(False, seconds_left() < math.inf)

    @property
    def warm(self) -> Any:
        """From a neighbouring solution."""
        return self._solver(True, seconds_left() < math.inf)


@lru_cache(maxsize=32)
def compiled_curve(structure: CurveStructure) -> CompiledCurve:
    """Build a structure once, with a solver; raises `clock.TooLong` as its solvers do."""
    began = time.perf_counter()
    f = build_curve(structure)
    nlp = {
        "x": f.symbols.durations,
        "p": f.parameters,
        "f": ca.sum1(f.symbols.durations),
        "g": f.inequalities,
    }
    sizes = f.sizes
    stop = look_at_clock(sizes["variables"], sizes["inequalities"])

    @cache
    def solver(warm: bool, limited: bool) -> Any:
        look_ahead(DERIVING * structure.curve.segments * f.build_seconds)
        options = ipopt_options(warm)
        if limited:
            options["iteration_callback"] = stop
        return ca.nlpsol("warm" if warm else "cold", "ipopt", nlp, options)

    own, following = [], []
    for place in (p for p in f.places if p.slot == 0):
        if place.order == SPEED:
            speed = f.symbols.speeds[place.piece]
            own.append(_padded(speed))
            following.append(_padded(derived(speed)))
        else:
            piece = f.symbols.pieces[place.joint][place.piece]
            own.append(_padded(piece.numerators[place.order]))
            following.append(_padded(piece.numerators[place.order + 1]))
    empty = ca.SX(0, MAX_COEFFICIENTS)
    turning = ca.Function(
        "turning",
        [f.symbols.durations, f.symbols.parameters],
        [ca.vertcat(*own) if own else empty, ca.vertcat(*following) if own else empty],
    )
    built = CompiledCurve(f, turning, 0.0, solver)
    _ = built.cold
    return replace(built, build_seconds=time.perf_counter() - began)


def _padded(a: list[Any]) -> Any:
    return ca.horzcat(*a, *[ca.SX(0)] * (MAX_COEFFICIENTS - len(a)))


@dataclass(frozen=True, eq=False)
class ScaledCurve:
    """Parameters of the curve and limits in units in which durations and angles are of order 1."""

    time_unit: float
    curve: Array
    rest: Array


def scaled_curve(problem: Problem, time_unit: float) -> ScaledCurve:
    """Numbers of a problem for its formulation."""
    span = np.ptp(problem.waypoints, axis=0)
    angle = np.where(span > 0, span, 1.0)
    limits = problem.limits.derivatives * time_unit ** np.arange(1, 4) / angle[:, None]
    usable = np.isfinite(limits) & (limits > 0)
    inverse = np.where(usable, 1.0 / np.where(usable, limits, 1.0), 0.0)
    low, high = problem.limits.position_lower, problem.limits.position_upper
    first = problem.waypoints[0]
    position = np.array(
        [
            np.where(np.isfinite(low), low - first, 0.0) / angle,
            np.where(np.isfinite(high), high - first, 0.0) / angle,
            np.isfinite(low).astype(float),
            np.isfinite(high).astype(float),
        ]
    )
    # Chords are lengths of the joint vector as it is, not in these units.
    curve = problem.curve.fixed_by(problem.waypoints)
    own = numbers(curve, (problem.waypoints - first) / angle)
    return ScaledCurve(time_unit, own, np.concatenate([inverse.T.ravel("F"), position.ravel("F")]))


def follow(
    built: CompiledCurve, scaled: ScaledCurve, durations: Array | None
) -> tuple[Array, Array]:
    """Places and Newton weights of the moving slots; on a grid without durations."""
    places: list[Array] = []
    weights: list[Array] = []
    groups: list[int] = []
    for place in built.formulation.places:
        if place.slot == 0:
            groups.append(1)
        elif place.slot > 0:
            groups[-1] += 1
    own: Array = np.empty((0, 0))
    following = own
    if durations is not None:
        both = built.turning(durations / scaled.time_unit, scaled.curve)
        own, following = (np.asarray(m.full(), dtype=np.float64) for m in both)
    for i, count in enumerate(groups):
        s, w = np.arange(1, count + 1) / (count + 1), np.zeros(count)
        if durations is not None:
            _put(own[i], following[i], s, w)
        places.append(s)
        weights.append(w)
    if not places:
        return np.empty(0), np.empty(0)
    return np.concatenate(places), np.concatenate(weights)


def _put(a: Array, turning: Array, places: Array, weights: Array) -> None:
    """Move the nearest free slot onto each zero of ``turning``, largest values first."""
    polynomial = np.polynomial.polynomial
    size = float(np.abs(turning).sum())
    degree = int(np.max(np.flatnonzero(np.abs(turning) > 1e-14 * size), initial=0))
    if degree < 1:
        return
    zeros = roots_in_unit(turning[: degree + 1])
    zeros = zeros[~np.isnan(zeros)]
    slope = polynomial.polyval(zeros, polynomial.polyder(turning))
    free = list(range(places.size))
    for i in np.argsort(-np.abs(polynomial.polyval(zeros, a)), kind="stable"):
        if not free:
            break
        slot = min(free, key=lambda m: abs(places[m] - zeros[i]))
        free.remove(slot)
        places[slot] = zeros[i]
        if abs(slope[i]) > 1e-3 * size:
            weights[slot] = 1.0 / slope[i]


def packed(scaled: ScaledCurve, places: Array, weights: Array) -> Array:
    """Parameter vector in the order that `build_curve` documents."""
    return np.concatenate([scaled.curve, scaled.rest, places, weights])
