"""Papers about rows and their limits: what is said to keep them, and what rounding leaves open.

Each paper is drawn from its kind and a seed. `true` is the distance of the printed total from the
shortest one of the problem that was not rounded, which no reader of the digits knows: what a card
says of every value that rounds to them has to hold for this one.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from support.papers.claims import state_durations
from support.papers.drafts import Answer, Draft, answer, fitted, problem, shortest, some_shape
from support.papers.motions import FAMILIES, Array, NoCurveError
from support.papers.planted import HELD, first_fit
from support.papers.printing import last_place, moved, places_for, printed

APART = tuple(name for name, family in FAMILIES.items() if family.apart)
"""Families whose shortest motion this route knows, however many segments there are."""
FASTER = (0.4, 0.6)
"""Share of the durations that keep the limits of which too short ones are drawn."""


@dataclass(frozen=True)
class Paper:
    """A draft, and what is true of it."""

    draft: Draft
    true: float | None = None
    """Share by which its total lies above the shortest one, before anything was rounded."""
    cause: str = ""
    """Rule that names its fault; empty in an honest paper."""
    claim: str = ""
    """The claim that carries it."""


def row_paper(kind: str, seed: int) -> Paper:
    """A paper of a kind: one of `HONEST` or of `FAULTY`."""
    make = (HONEST | FAULTY)[kind]
    number = list(HONEST | FAULTY).index(kind)
    return first_fit(kind, lambda rng: make(rng, seed), 20261124, number, seed)


def _plain(rng: np.random.Generator, seed: int, families: tuple[str, ...] = HELD) -> Draft:
    draft = problem(rng, seed, str(rng.choice(families)))
    draft.other_reading = False
    draft.how = "round" if draft.how == "up" else draft.how
    return draft


def _row(rng: np.random.Generator, draft: Draft, name: str, h: Array, **more: Any) -> None:
    table = {"fast": "table-4", "slow": "table-3"}[name]
    where = {"where": table.replace("t", "T", 1).replace("-", " ")}
    state_durations(rng, draft, name, Answer(h, fitted(draft, h)), table=table, **where, **more)


def _too_fast(rng: np.random.Generator, draft: Draft) -> Array:
    """Durations that are far too short, whatever the digits stand for."""
    return answer(draft, some_shape(rng, draft), 0.0).durations * float(rng.uniform(*FASTER))


def _kept_durations(rng: np.random.Generator, draft: Draft) -> Array:
    return answer(draft, some_shape(rng, draft), float(rng.uniform(0.0, 0.2))).durations


def _coarse(rng: np.random.Generator, seed: int) -> tuple[Draft, Answer]:
    """A paper that prints few digits of way-points and limits, and its true shortest motion."""
    draft = _plain(rng, seed, APART)
    places = 0 if draft.units["position"] == "deg" else int(rng.integers(1, 3))
    si = draft.si(0)
    how = str(rng.choice(["round", "round", "cut"]))
    draft.points = [[printed(x / si, places, how) for x in row] for row in draft.true_points.T]
    draft.exact_points = False
    # Way-points that print alike stand still on paper alone.
    if any(len(set(row)) < len(row) for row in draft.points):
        raise NoCurveError("two way-points print alike")
    if rng.random() < 0.6:
        draft.exact_limits = False
        for order, texts in draft.limits.items():
            unit = draft.si(order)
            short = [printed(float(t), places_for(float(t), 2)) for t in texts]
            off = np.array([last_place(t) for t in short]) * rng.uniform(-0.49, 0.49, len(short))
            draft.limits[order] = short
            draft.true_limits[order] = (np.array([float(t) for t in short]) + off) * unit
    best = shortest(draft)
    assert best is not None
    return draft, best


def _before(rng: np.random.Generator, seed: int) -> Paper:
    """The state before an optimisation, or a rival's row, breaks limits; nobody says otherwise."""
    draft = _plain(rng, seed)
    rival = rng.random() < 0.5
    more = {"algorithm": "old"} if rival else {"state": "before"}
    _row(rng, draft, "slow", _too_fast(rng, draft), **more)
    _row(rng, draft, "fast", _kept_durations(rng, draft), algorithm="new")
    if rng.random() < 0.5:
        draft.claims.reverse()
    draft.say("kept", "within_limits", "fast")
    return Paper(draft)


def _unsaid(rng: np.random.Generator, seed: int) -> Paper:
    """A row that breaks limits, of a method or of none; no sentence is about limits."""
    draft = _plain(rng, seed)
    more = {"algorithm": "new"} if rng.random() < 0.5 else {}
    _row(rng, draft, "fast", _too_fast(rng, draft), **more)
    return Paper(draft)


def _rounded(rng: np.random.Generator, seed: int) -> Paper:
    """The shortest total, to all its digits, beside way-points and limits with few."""
    draft, best = _coarse(rng, seed)
    draft.places += 2
    _row(rng, draft, "fast", best.durations, algorithm="new")
    draft.say("optimal", "optimal", "fast")
    return Paper(draft, 0.0)


def _elsewhere(rng: np.random.Generator, seed: int) -> Paper:
    """The shortest total, printed once beside its durations and once without."""
    draft, best = _coarse(rng, seed)
    _row(rng, draft, "fast", best.durations, algorithm="new")
    fast = draft.claim("fast")
    fast.pop("total", None)
    _stated(draft, best.total)
    draft.say("optimal", "optimal", "fast")
    return Paper(draft, 0.0)


def _stated(draft: Draft, seconds: float) -> None:
    value = printed(seconds / draft.si(-1), draft.places, draft.how)
    draft.state("abstract", "total_time", where="abstract", of="fast", value=value)


def _longer(rng: np.random.Generator, seed: int) -> Paper:
    """A total above the shortest one by a known share; nothing says that it is the shortest."""
    draft, best = _coarse(rng, seed)
    share = float(np.exp(rng.uniform(np.log(1e-3), np.log(0.3))))
    _row(rng, draft, "fast", best.durations * (1 + share), algorithm="new")
    draft.say("kept", "within_limits", "fast")
    return Paper(draft, share)


HONEST: dict[str, Callable[[np.random.Generator, int], Paper]] = {
    "a row nobody vouches for": _before,
    "no sentence on limits": _unsaid,
    "few digits of the inputs": _rounded,
    "a total elsewhere": _elsewhere,
    "a known distance": _longer,
}
"""Kinds of papers in which nothing is wrong."""


def _said(rng: np.random.Generator, seed: int) -> Paper:
    """The row that is said to keep the limits breaks them; one that is not said to does too."""
    draft = _plain(rng, seed)
    _row(rng, draft, "slow", _too_fast(rng, draft), state="before")
    _row(rng, draft, "fast", _too_fast(rng, draft), algorithm="new")
    draft.say("kept", "within_limits", "fast")
    return Paper(draft, cause="TG201", claim="fast")


def _rival(rng: np.random.Generator, seed: int) -> Paper:
    """A sentence says that both rows keep the limits; the rival's does not."""
    draft = _plain(rng, seed)
    _row(rng, draft, "slow", _too_fast(rng, draft), algorithm="old")
    _row(rng, draft, "fast", _kept_durations(rng, draft), algorithm="new")
    draft.say("kept", "within_limits", "slow", "fast")
    return Paper(draft, cause="TG201", claim="slow")


def _other_total(rng: np.random.Generator, seed: int) -> Paper:
    """The durations are the shortest; the total that the abstract prints of them is not theirs."""
    paper = _elsewhere(rng, seed)
    claim = paper.draft.claim("abstract")
    steps = float(claim["value"]) * float(rng.uniform(0.02, 0.1)) / last_place(claim["value"])
    claim["value"] = moved(claim["value"], max(round(steps), 3 * paper.draft.segments))
    return Paper(paper.draft, cause="TG105", claim="abstract")


FAULTY: dict[str, Callable[[np.random.Generator, int], Paper]] = {
    "the row that is said to keep": _said,
    "the rival's row that is said to keep": _rival,
    "another total in the abstract": _other_total,
}
"""Kinds of papers with one fault."""
