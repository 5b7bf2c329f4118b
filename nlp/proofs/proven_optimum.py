"""The solver's answer with what is proved of the same problem: by a certificate, or by a search."""

from __future__ import annotations

import math
import time
from contextlib import suppress
from dataclasses import replace
from fractions import Fraction
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ...problem import Array, Problem, TrajgapError, scale
from ...verify import Refused, Subject
from .. import optimum
from ..clock import seconds_left
from ..optimum import STARTS, Solution, close
from .certifiers import certify, prompt
from .document import all_shipped, problem_document, question, suite_documents
from .evidence import ProvedInterval, interval_in, proved, proved_again, with_interval
from .exact import ExactProblem, exact_problem

PROVING = 0.2
"""Share of the boxes that an audit allows one problem: about a second's worth."""
_ROUNDED = 8 * np.finfo(np.float64).eps
"""Relative distance within which floats are those of the printed numbers: a conversion of units
rounds three times, by half a unit of the last place each."""
_ANGLES = ("waypoints", "limits", "position_lower", "position_upper")
"""Parts of a problem in its unit of angle, some per power of a second."""
_TIMES = ("duration_lower", "duration_upper", "ratios")
"""Parts of a problem in seconds, or without a unit."""


def solve(
    problem: Problem,
    *,
    exact: ExactProblem | None = None,
    starts: int = STARTS,
    seed: int = 0,
    initial: ArrayLike | None = None,
    known: ArrayLike | None = None,
    known_nodal: ArrayLike | None = None,
    seconds: float = math.inf,
    prove: float = PROVING,
) -> Solution:
    """Shortest total time with shared durations, found by an exact NLP and proved if possible.

    If a certificate for exactly this problem ships with the package, it is verified. Otherwise a
    branch and bound searches for a lower bound, if the kind of curve has one and there are at most
    twelve segments. If nothing is proved within 1 %, a linear program bounds the total of any curve
    from below. The optimum lies between ``lower_bound`` and the total; the answer is *optimal* if
    both are at most a millionth apart.

    Parameters
    ----------
    problem : Problem
        Its coupling is ignored: durations are shared by all joints of the problem. See
        `solve_per_joint` for the other procedure.
    exact : ExactProblem, optional
        The same problem in the numbers that are printed. Without it the floats count as exact,
        unless a shipped certificate is about the printed numbers to which they are rounded.
    starts, seed, initial, known, known_nodal, seconds
        As in `trajgap.nlp.optimum.solve`.
    prove : float
        Budget of the branch and bound, as a share of what an audit allows one problem; 0 leaves out
        every bound that no shipped certificate proves. Boxes are counted, not seconds, so no answer
        depends on how busy the machine is; ``seconds`` still ends it.

    Returns
    -------
    Solution
        Never raises for a problem without answer: the status says so.

    Raises
    ------
    TrajgapError
        If ``initial`` or ``known`` has the wrong shape.
    """
    size = len(problem.waypoints), len(problem.joints)
    if exact is not None:
        interval = proved(exact)
    else:
        place = _place(problem, *size)
        interval = None if place is None else _proved(*size, place)
    began = time.perf_counter()
    if interval is not None and interval.durations is not None:
        proven = np.array([interval.durations], dtype=np.float64)
        known = proven if known is None else np.vstack([np.atleast_2d(known), proven])
    found = optimum.solve(
        problem,
        starts=starts,
        seed=seed,
        initial=initial,
        known=known,
        known_nodal=known_nodal,
        seconds=seconds,
        lower=0.0 if interval is None else float(interval.lower),
    )
    if interval is None and prove > 0:
        left = min(seconds_left(), seconds - (time.perf_counter() - began))
        interval = _searched(found, exact, prove, left)
    return with_interval(found, interval)


def _searched(
    found: Solution, exact: ExactProblem | None, prove: float, seconds: float
) -> ProvedInterval | None:
    """What is proved of an answer's problem: within a budget of boxes, or at once of any curve."""
    if not found.found or seconds <= 0:
        return None
    exact, interval = exact or exact_problem(found.problem), None
    # Nothing limits the total from below, or no certificate can state it.
    with suppress(TrajgapError, Refused):
        kind = prompt(exact) if found.infimum is None else None
        if kind is not None:
            boxes = max(1.0, round(prove * kind.allowance(exact)))
            answer = certify(
                exact, seconds=seconds, boxes=boxes, known=found.durations, certifier=kind
            )
            interval = interval_in(answer.verdict, answer.durations)
    if interval is not None and close(float(interval.lower), found.total_time):
        return interval
    lower = bound_any_curve(found, exact)
    if interval is not None:
        return replace(interval, lower=max(lower, interval.lower))
    return ProvedInterval(lower, None, None, False) if lower > 0 else None


def bound_any_curve(found: Solution, exact: ExactProblem) -> Fraction:
    """No motion of an answer's problem is shorter on any curve, s; 0 if nothing is proved.

    Parameters
    ----------
    exact : ExactProblem
        The problem in rational numbers.
    """
    from .any_curve import bound_at_once  # half a second to import; most answers need none

    with suppress(Refused):
        breaks = list(found.problem.curve.waypoint_breaks)
        times = np.concatenate([[0.0], found.durations.cumsum()])[breaks]
        speeds = found.trajectory(times, 1) / _factors(exact.unit, len(exact.joints))
        return min(bound_at_once(exact, np.diff(times), speeds), Fraction(found.best))
    return Fraction(0)


def _place(problem: Problem, waypoints: int, joints: int) -> int | None:
    """Which of the certificates of its size is about a problem, whatever it is called, if any.

    A problem in floats is that of a certificate if each of its numbers is the printed one, rounded.
    """
    angles = _declared_waypoints(waypoints, joints)
    near = np.isclose(angles, problem.waypoints, 2.0 * _ROUNDED, 0.0).all(axis=(1, 2))
    if not near.any():  # of nearly every problem
        return None
    try:
        wanted = question(problem_document(exact_problem(problem)))
    except Refused:  # a number with more digits than a certificate may state
        return None
    every = _declared_certificates(waypoints, joints)
    return next((k for k in np.flatnonzero(near).tolist() if _same(every[k][1], wanted)), None)


@lru_cache(maxsize=64)
def _declared_certificates(
    waypoints: int, joints: int
) -> tuple[tuple[dict[str, Any], dict[str, Any]], ...]:
    """Certificates about declared curves of one size, each with its problem in rationals."""
    every = (*all_shipped(), *suite_documents(waypoints - 1, joints))
    declared = [one for one in every if one["claim"]["subject"] == Subject.DECLARED]
    asked = [(one, question(one["problem"])) for one in declared]
    return tuple(
        (one, stated)
        for one, stated in asked
        if (len(stated["waypoints"]), len(stated["joints"])) == (waypoints, joints)
    )


@lru_cache(maxsize=64)
def _declared_waypoints(waypoints: int, joints: int) -> Array:
    """Way-points of these certificates in SI, shape (certificate, way-point, joint)."""
    every = [
        _floats(stated["waypoints"]).reshape(waypoints, joints) * _factors(stated["unit"], joints)
        for _, stated in _declared_certificates(waypoints, joints)
    ]
    return np.array(every).reshape(-1, waypoints, joints)


@lru_cache(maxsize=256)
def _proved(waypoints: int, joints: int, place: int) -> ProvedInterval | None:
    """What one of `_declared_certificates` proves, proved again once a process."""
    document, _ = _declared_certificates(waypoints, joints)[place]
    return proved_again(document)


def _same(stated: dict[str, Any], wanted: dict[str, Any]) -> bool:
    """Whether a certificate's problem is one in radians and seconds; names do not matter."""
    if stated.keys() != wanted.keys():
        return False
    factors = _factors(stated["unit"], len(stated["joints"]))
    for key in stated.keys() - {"unit", "joints"}:
        if key in _ANGLES or key in _TIMES:
            one, other = _floats(stated[key]), _floats(wanted[key])
            if key == "waypoints":
                one = one * np.tile(factors, len(stated[key]))
            elif key in _ANGLES:
                each = zip(stated[key], factors, strict=True)
                one = np.concatenate([_floats(own) * factor for own, factor in each])
            alike = one.shape == other.shape
            if not alike or not np.isclose(one, other, _ROUNDED, 0.0, equal_nan=True).all():
                return False
        elif stated[key] != wanted[key]:
            return False
    return True


def _factors(units: str, joints: int) -> Array:
    """How much of SI the unit of each joint is."""
    each = units.split(",")
    found = np.array([float(scale(one).bounds[0]) for one in each])
    return found if len(each) == joints else np.full(joints, found[0])


def _floats(part: Any) -> Array:
    """A part of a problem as one row of floats; nan where there is none."""
    if isinstance(part, list):
        return np.concatenate([_floats(x) for x in part]) if part else np.empty(0)
    if part is None:
        return np.array([np.nan])
    if isinstance(part, tuple):  # a number with a power of π
        return np.array([float(part[0]) * math.pi ** part[1]])
    return np.array([float(part)])
