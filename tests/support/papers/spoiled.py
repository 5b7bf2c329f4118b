"""A paper drawn at random with several of its numbers and sentences wrong: a first draft."""

from collections.abc import Callable

import numpy as np
from support.papers.claims import draw
from support.papers.drafts import Draft
from support.papers.printing import moved, printed

Spoil = Callable[[np.random.Generator, Draft], bool]
"""Makes one thing wrong; whether the paper has it."""


def spoiled(seed: int) -> tuple[Draft, tuple[str, ...]]:
    """A draft with two to four faults, and their names."""
    rng = np.random.default_rng([20261123, seed])
    while True:
        draft = draw(int(rng.integers(2**40)))
        draft.seed = seed
        names = rng.permutation(list(FAULTS))[: int(rng.integers(2, 5))]
        done = tuple(str(name) for name in names if FAULTS[str(name)](rng, draft))
        if len(done) >= 2:
            return draft, done


def _one(rng: np.random.Generator, draft: Draft, quantity: str) -> dict | None:
    """Any claim about a quantity."""
    found = [c for c in draft.claims if c["quantity"] == quantity]
    return found[int(rng.integers(len(found)))] if found else None


def _shortened(rng: np.random.Generator, draft: Draft) -> bool:
    """Durations of a row that are too short, with their sum, and said to keep the limits."""
    row = _one(rng, draft, "durations")
    if row is None:
        return False
    factor = float(rng.uniform(0.7, 0.98))
    row["durations"] = [_scaled(text, factor) for text in row["durations"]]
    if "total" in row:
        places = len(row["total"].partition(".")[2])
        row["total"] = printed(sum(map(float, row["durations"])), places)
    if not draft.has("said-kept"):
        draft.say("said-kept", "within_limits", row["id"])
    return True


def _scaled(text: str, factor: float) -> str:
    places = len(text.partition(".")[2])
    new = printed(float(text) * factor, places)
    return new if float(new) else text


def _said(draft: Draft, name: str) -> dict | None:
    return draft.claim(name) if draft.has(name) else None


def _other(rng: np.random.Generator, claim: dict | None, *keys: str) -> bool:
    """Other digits under the first of these keys that the claim has."""
    key = next((key for key in keys if key in (claim or {})), None)
    if claim is None or key is None:
        return False
    given = claim[key]
    claim[key] = [_moved(rng, t) for t in given] if isinstance(given, list) else _moved(rng, given)
    return True


def _called_optimal(rng: np.random.Generator, draft: Draft) -> bool:
    """A motion longer than it need be, called the shortest."""
    row = _one(rng, draft, "durations")
    if row is None or draft.has("optimal"):
        return False
    if rng.random() < 0.5:
        row["durations"] = [_scaled(text, 1.3) for text in row["durations"]]
    draft.say("optimal", "optimal", row["id"])
    return True


def _moved(rng: np.random.Generator, text: str) -> str:
    """Other digits, not further away than by about a quarter."""
    units = abs(float(text)) * 10 ** len(text.partition(".")[2])
    steps = max(int(units * rng.uniform(0.02, 0.25)), 2)
    return moved(text, steps * int(rng.choice([-1, 1])) if units > 2 * steps else steps)


FAULTS: dict[str, Spoil] = {
    "durations too short": _shortened,
    "total": lambda rng, draft: _other(rng, _one(rng, draft, "durations"), "total"),
    "abstract": lambda rng, draft: _other(rng, _said(draft, "abstract"), "value"),
    "percentage": lambda rng, draft: _other(rng, _said(draft, "gain"), "percent", "seconds"),
    "peak": lambda rng, draft: _other(rng, _one(rng, draft, "peak"), "value", "values"),
    "called optimal": _called_optimal,
}
"""What is made wrong, in words."""
