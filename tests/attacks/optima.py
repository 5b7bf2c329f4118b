"""Attacks on the solver: no search beats its optimum, nothing feasible is called infeasible."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from attacks.attack import Attack, demand, keep
from attacks.batch import form_of, searched
from attacks.cases import Rng, alone, draw_asked, near_limits
from attacks.curves import Array, Asked, NoCurve, excess, peaks

BEATEN = 1e-4
"""By how much, relative, a search must beat the optimum before that counts."""
_FAMILIES = ("3-5-3", "polynomials", "cubic-spline", "quintic-spline", "rest-to-rest", "jtraj")
"""Families that the batch of `batch` knows: piecewise polynomials with breaks at way-points."""
_JUMP = 1e-9
"""Share of a joint's peak from which two sides of a via-point differ by more than rounding."""


def _draw(rng: Rng, bounds: float, odd: float) -> Asked:
    family = str(rng.choice(_FAMILIES))
    scale = float(rng.choice([0.0, 0.0, 1.0, 4.0]))
    asked = draw_asked(rng, family, 4, 2, bounds, odd, scale)
    if rng.random() < 0.15:
        # One joint that must not move, and does not.
        way = asked.waypoints.copy()
        way[:, 0] = way[0, 0]
        asked = replace(asked, waypoints=way)
    return replace(asked, coupling="shared")


def _boxed(rng: Rng, asked: Asked) -> tuple[Asked, Array] | None:
    """Bounds that brute force knows to leave something feasible, if only a little."""
    try:
        h = near_limits(rng, asked, 0.7)
        h = h * float(1.0 + rng.choice([1e-3, 0.02, 0.2]))
        if excess(asked, h)[1] > 1:
            return None
    except NoCurve:
        return None
    tight = float(rng.choice([0.01, 0.1, 0.5]))
    lower = h * (1 - tight * rng.random(len(h)))
    upper = h * (1 + tight * rng.random(len(h)))
    return replace(asked, duration_lower=lower, duration_upper=upper), h


def _solved(asked: Asked, folder: Path) -> Any:
    from trajgap.nlp import solve
    from trajgap.problem import parse_case

    drawn = alone(asked)
    keep(folder, case=drawn.text)
    return solve(parse_case(drawn.text, "case.toml").problem(), starts=4, seed=0)


def _searched(
    asked: Asked, problem: Any, seed: int, decades: float, rounds: int, folder: Path
) -> tuple[float, Array] | None:
    """What a search finds where samples and the judge agree that it keeps every limit."""
    from trajgap.problem import check

    form = form_of(asked)
    found = None if form is None else searched(asked, form, seed, decades, rounds)
    if found is None or check(problem, found[1]).verdict != "pass":
        return None
    keep(folder, durations=",".join(f"{x:.17g}" for x in found[1]))
    return found


def _judged(asked: Asked, answer: Any, found: tuple[float, Array] | None) -> str | None:
    if answer.status == "infeasible":
        shown = found is not None
        demand(not shown, f"infeasible ({answer.why}), but a search finds {found}")
        return "infeasible"
    if answer.durations is None:
        # Nothing is claimed; yet what a plain search finds should not be missed.
        demand(found is None, f"{answer.status} ({answer.why}), but a search finds {found}")
        return str(answer.status)
    if answer.check.verdict == "pass":
        try:
            least, _ = excess(asked, answer.durations)
        except NoCurve:
            least = np.inf
        demand(least <= 1 + 1e-6, f"the answer exceeds a limit: {least:.9g}")
    if found is not None:
        why = f"{answer.status} {answer.best:.9g}, but a search finds {found[0]:.9g}"
        demand(answer.best <= found[0] * (1 + BEATEN), why)
    return str(answer.status)


def beaten(rng: Rng, folder: Path) -> str | None:
    """Free and bounded problems against differential evolution."""
    asked = _draw(rng, 0.3, 0.2)
    if form_of(asked) is None:
        return None
    answer, seed = _solved(asked, folder), int(rng.integers(1 << 30))
    return _judged(asked, answer, _searched(asked, answer.problem, seed, 3.0, 150, folder))


def degenerate(rng: Rng, folder: Path) -> str | None:
    """Way-points that nearly coincide: infima that are approached and not attained."""
    asked = _draw(rng, 0.0, 0.2)
    if len(asked.waypoints) < 3:
        return None
    way = asked.waypoints.copy()
    k = int(rng.integers(len(way) - 1))
    gap = 10.0 ** -float(rng.integers(3, 9)) * rng.normal(size=way.shape[1])
    way[k + 1] = way[k] + (0.0 if rng.random() < 0.2 else gap * np.abs(way).max())
    asked = replace(asked, waypoints=way)
    if form_of(asked) is None:
        return None
    answer, seed = _solved(asked, folder), int(rng.integers(1 << 30))
    found = _searched(asked, answer.problem, seed, 6.0, 200, folder)
    return None if found is None else _judged(asked, answer, found)


def _jumps(asked: Asked, h: Array) -> bool:
    """Whether velocity jumps, or acceleration where jerk is limited: limits are not kept there."""
    found = peaks(asked, h).jumps > _JUMP
    limited = np.isfinite(asked.sides[:, :, 2]).any(axis=0)
    return bool(found[:, 0].any() or (found[:, 1] & limited).any())


def tight_bounds(rng: Rng, folder: Path) -> str | None:
    """Narrow bounds around durations that keep every limit: never infeasible."""
    drawn = _boxed(rng, _draw(rng, 0.0, 0.1))
    if drawn is None or form_of(drawn[0]) is None:
        return None
    asked, h = drawn
    if not excess(asked, h)[1] <= 1 or _jumps(asked, h):
        return None
    answer = _solved(asked, folder)
    keep(folder, durations=",".join(f"{x:.17g}" for x in h))
    demand(answer.status != "infeasible", f"infeasible ({answer.why}), but durations keep all")
    missed = answer.durations is None
    demand(not missed, f"{answer.status} ({answer.why}), but durations keep all limits")
    demand(answer.best <= h.sum() * (1 + 1e-9), f"{answer.best} above the {h.sum()} known")
    return str(answer.status)


def _attack(name: str, tries: str, holds: str, trial: Any, share: float, quick: int) -> Attack:
    return Attack(name, tries, holds, trial, share, quick, inside=True)


ATTACKS = (
    _attack(
        "optima",
        "`solve` on random problems of up to three segments and two joints, with bounds, static "
        "joints, scales 1e±4; differential evolution on sampled totals",
        "no search beats the total by more than 1e-4; nothing found where it is called infeasible",
        beaten,
        3.0,
        3,
    ),
    _attack(
        "optima of nearly coincident way-points",
        "the same with two way-points 1e-3 to 1e-8 apart",
        "no search beats the total, or the infimum, by more than 1e-4",
        degenerate,
        2.0,
        2,
    ),
    _attack(
        "tight duration bounds",
        "bounds within 1, 10 or 50 % of durations that keep every limit",
        "an answer, at least as short as those durations",
        tight_bounds,
        2.0,
        4,
    ),
)
