"""True certificates and states of every kind, to be altered: shipped ones, and drawn problems'."""

from __future__ import annotations

import json
from functools import cache, lru_cache
from typing import Any

import numpy as np

from attacks.cases import Rng, alone, draw_asked
from attacks.curves import Asked
from attacks.sandbox import call

KINDS: dict[str, tuple[str, dict[str, Any], float]] = {
    "rest-to-rest": ("rest-to-rest", {}, 1e-6),
    "declared": ("3-5-3", {}, 0.05),
    "declared, 4-3-4": ("polynomials", {"degrees": [4, 3, 4]}, 0.05),
    "stretched": ("uniform-cubic-b-spline", {"time": "stretched"}, 1e-6),
    "cubic": ("cubic-spline", {}, 0.1),
    "cubic, virtual": ("cubic-spline-virtual", {}, 0.2),
    "quintic-spline": ("quintic-spline", {}, 0.2),
    "any-curve": ("cubic-spline", {}, 0.1),
    "any-curve, moving": ("cubic-spline", {}, 0.1),
}
"""Family, what its declaration must say, and the gap to prove, by kind of proof."""
SEARCHED = tuple(k for k in KINDS if k not in ("rest-to-rest", "stretched") and "any" not in k)
"""Kinds whose runs can be cut short; the others, closed or small, are done at once."""
_EACH = 3
"""Different certificates of each kind that are altered."""
_TRIED = 3
"""Problems drawn until one is covered: of 27, one had a segment in which nothing moves."""
MAKE_SECONDS = 20.0
"""For making one of them."""
STATE_SECONDS = (0.2, 1.0, 5.0)
"""For a stopped run, until it has proved something: on a busy machine the first is too short."""


def _certified(kind: str, number: int, seconds: float) -> list[dict[str, Any]]:
    """The certificate of a drawn problem, and the state of a run cut short; in a child."""
    family, wanted, gap = KINDS[kind]
    asked = _drawn(family, wanted, number, kind == "any-curve, moving")

    def make() -> list[dict[str, Any]]:
        from trajgap.nlp import certificate, certify
        from trajgap.nlp.proofs import state_document
        from trajgap.problem import parse_case
        from trajgap.verify import Subject

        problem = parse_case(alone(asked).text, "case.toml").problem()
        subject = Subject.ANY if kind.startswith("any-curve") else Subject.DECLARED
        made: list[dict[str, Any]] = []
        for goal, limits in ((gap, (seconds,)), (1e-9, STATE_SECONDS)):
            for limit in limits:
                found = certify(problem, subject=subject, gap=goal, seconds=limit)
                if found.proof is not None:
                    break
            state = state_document(found)
            made += [certificate(found)] if found.proof is not None else []
            made += [state] if state is not None else []
        return made

    ran = call(make, 6 * seconds)
    return [] if ran.value is None else list(ran.value)


def _drawn(family: str, wanted: dict[str, Any], number: int, moving: bool = False) -> Asked:
    for attempt in range(1000):
        rng = np.random.default_rng([number, attempt])
        asked = draw_asked(rng, family, 4, 2, bounds=0.3, odd=0.1)
        small = 3 <= len(asked.waypoints) <= 4 and bool(asked.moving.any()) == moving
        small = small and "finish_orders" not in asked.block
        if moving:
            small = small and any(np.ptp(v) > 0 for v in asked.ends.values())
        limited = bool(np.isfinite(asked.sides[:, :, :2]).all())
        if small and limited and all(asked.block.get(k) == v for k, v in wanted.items()):
            return asked
    raise RuntimeError(f"{family}: nothing drawn")


@cache
def _pool(kind: str, number: int, seconds: float) -> tuple[str, ...]:
    """What is made of a kind; of a problem that is not covered, nothing, and the next is drawn."""
    for drawn in range(number, number + _TRIED * _EACH, _EACH):
        made = _certified(kind, drawn, seconds)
        if made:
            return tuple(json.dumps(d) for d in made)
    return ()


@lru_cache(maxsize=1)
def _shipped() -> tuple[str, ...]:
    from trajgap.nlp.proofs.document import shipped_folder

    return tuple(p.read_text("utf-8") for p in sorted(shipped_folder().glob("*.json")))


def some_proof(rng: Rng, states: bool) -> dict[str, Any] | None:
    """A true certificate, or a state."""
    if not states and rng.random() < 0.2:
        text = _shipped()[rng.integers(len(_shipped()))]
        return dict(json.loads(text))
    kind = str(rng.choice(SEARCHED if states else list(KINDS)))
    pool = [json.loads(x) for x in _pool(kind, int(rng.integers(_EACH)), MAKE_SECONDS)]
    fitting = [d for d in pool if ("state" in d["format"]) == states]
    # What proves nothing yet has little to alter.
    fitting = [d for d in fitting if d["proof"]] or fitting
    return dict(fitting[rng.integers(len(fitting))]) if fitting else None
