"""Papers with one fault of known size, and what rounding of their digits explains by itself.

Each fault returns a draft with ``size``, how far the printed numbers are from what the fault-free
ones would have to be, and ``room``, how far rounded or cut-off digits alone could take them, to
first order: a fault whose size is below its room It is unknown whether from rounding by anybody.
"""

from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from decimal import Decimal
from typing import TypeVar

import numpy as np
from support.papers.claims import draw, peak_claim, state_durations, vertices_claim
from support.papers.drafts import Answer, Draft, answer, fitted
from support.papers.motions import FAMILIES, Array, Motion, NoCurveError, ratios, vertices
from support.papers.printing import ORDERS, last_place, moved, printed

Made = TypeVar("Made")
ATTEMPTS = 400
"""Papers drawn until one has what the fault needs."""
HELD = ("3-5-3", "4-3-4", "clamped cubic", "C4 quintic", "rest 5", "rest 7", "virtual cubic")
"""Families on which a broken limit can be proved however the digits were rounded."""


@dataclass(frozen=True)
class Planted:
    """A faulty paper."""

    draft: Draft
    size: float
    room: float


class UnfitError(Exception):
    """This paper has nothing that the fault could alter."""


Fault = Callable[[np.random.Generator, Draft], Planted]


def first_fit(what: str, make: Callable[[np.random.Generator], Made], *key: int) -> Made:
    """What is made of the first paper that has what it takes."""
    for attempt in range(ATTEMPTS):
        with suppress(UnfitError, NoCurveError):
            return make(np.random.default_rng([*key, attempt]))
    raise RuntimeError(f"{what}: no paper of {ATTEMPTS} can carry it")


def shared(rng: np.random.Generator, seed: int, families: tuple[str, ...]) -> Draft:
    """A paper in which all joints share their durations."""
    draft = draw(int(rng.integers(2**40)), families)
    draft.seed, draft.other_reading = seed, False
    if draft.coupling != "shared":
        raise UnfitError
    return draft


def planted(fault: str, seed: int) -> Planted:
    """A paper with a fault."""
    plant, families = FAULTS[fault]
    number = list(FAULTS).index(fault)
    return first_fit(
        fault, lambda rng: plant(rng, shared(rng, seed, families)), 20261123, number, seed
    )


def read(draft: Draft, name: str = "fast") -> tuple[Array, Array]:
    """Way-points and durations as printed, rad and s."""
    points = np.array([[float(t) for t in row] for row in draft.points]).T * draft.si(0)
    durations = [float(t) for t in draft.claim(name)["durations"]]
    return points, np.array(durations) * draft.si(-1)


def _spread(draft: Draft, measure: Callable[[Motion], float]) -> tuple[float, float]:
    """A number measured on the printed motion, and how far digits that are rounded or cut off
    move it, to first order."""
    points, durations = read(draft)
    own = measure(draft.family.fit(points, durations))
    reach = 0.0
    for k, text in enumerate(draft.claim("fast")["durations"]):
        other = durations.copy()
        other[k] += last_place(text) * draft.si(-1)
        reach += abs(measure(draft.family.fit(points, other)) - own)
    if not draft.exact_points:
        for j, row in enumerate(draft.points):
            for i, text in enumerate(row):
                others = points.copy()
                others[i, j] += last_place(text) * draft.si(0)
                reach += abs(measure(draft.family.fit(others, durations)) - own)
    return own, reach


def excess(draft: Draft) -> tuple[float, float]:
    """How far the printed motion is beyond its limits as a share, and the room of its digits."""
    limits = {o: np.array([float(t) for t in row]) * draft.si(o) for o, row in draft.limits.items()}
    own, reach = _spread(draft, lambda m: max(ratios(m, limits).values()))
    if not draft.exact_limits:
        loose = [last_place(t) / float(t) for row in draft.limits.values() for t in row]
        reach += own * max(loose)
    return own - 1.0, reach


def peak_distance(draft: Draft, claim: dict) -> tuple[float, float]:
    """How far a printed peak is from that of the printed motion as a share of it, and the room."""
    order = ORDERS.index(claim["derivative"])
    texts = claim.get("values") or [claim["value"]]
    found = []
    for j, text in enumerate(texts):

        def peak(motion: Motion, joint: int | None = j if "values" in claim else None) -> float:
            peaks = motion.peaks(order)
            return float(peaks.max() if joint is None else peaks[joint])

        own, reach = _spread(draft, peak)
        unit = draft.si(order)
        value = float(text) * unit
        room = reach + last_place(text) * unit
        points, durations = read(draft)
        motion = draft.family.fit(points, durations)
        size = abs(value - own)
        if value < own:  # a peak read off coarse samples may be lower
            times = np.arange(50) * motion.total / 50
            samples = np.abs(motion.at(times, order))
            column = samples.max() if "value" in claim else samples[:, j].max()
            room = max(room, own - float(column) + reach)
        found.append((size / max(own, 1e-300), max(room / max(own, 1e-300), 1e-300)))
    return max(found, key=lambda one: one[0] / one[1])


def restated(rng: np.random.Generator, draft: Draft, found: Answer, peaks: bool = True) -> None:
    """Print other durations, their peaks, and that they keep the limits; nothing else."""
    draft.claims.clear()
    draft.how = "round" if draft.how == "up" else draft.how
    state_durations(rng, draft, "fast", found, table="table-4", algorithm="new")
    draft.say("kept", "within_limits", "fast")
    if peaks:
        for order in (1, 2):
            draft.claims.append(peak_claim(rng, draft, found.motion, order, "exact", "fast"))


def _log_uniform(rng: np.random.Generator, low: float, high: float) -> float:
    return float(np.exp(rng.uniform(np.log(low), np.log(high))))


def _steps(rng: np.random.Generator, most: float) -> int:
    return round(_log_uniform(rng, 1, most)) * int(rng.choice([-1, 1]))


def _totals(draft: Draft, claim: dict) -> tuple[str, str]:
    texts = [draft.claim(claim[k]) for k in ("slower", "faster")]
    found = [t.get("total", t.get("value")) for t in texts]
    if None in found:
        raise UnfitError
    return found[0], found[1]


def _sum(rng: np.random.Generator, draft: Draft) -> Planted:
    claim = draft.claim("fast")
    if "total" not in claim:
        raise UnfitError
    draft.claims = [c for c in draft.claims if c["id"] in ("fast", "slow", "kept", "smooth")]
    claim["total"] = moved(claim["total"], _steps(rng, 300))
    if float(claim["total"]) <= 0:
        raise UnfitError
    parts = [Decimal(t) for t in claim["durations"]]
    far = float(Decimal(claim["total"]) - sum(parts))
    unit, last = last_place(claim["durations"][0]), last_place(claim["total"])
    # Each number rounded or cut off by itself, or all parts rounded up.
    below = max(len(parts) * unit / 2 + last, len(parts) * unit + last / 2)
    above = len(parts) * unit + last / 2
    total = float(sum(parts))
    return Planted(draft, abs(far) / total, (above if far > 0 else below) / total)


def _allowed(claim: dict) -> tuple[float, float, float]:
    """Least, nominal and largest total: its digits, or the sum of its parts, rounded or cut off."""
    total, parts = claim.get("total", claim.get("value")), claim.get("durations", [])
    nominal, last = float(total), last_place(total)
    ends = [nominal - last / 2, nominal + last]
    if parts:
        summed, wide = sum(map(float, parts)), len(parts) * last_place(parts[0])
        ends += [summed - wide / 2, summed + wide]
    return min(ends), nominal, max(ends)


def _percent_room(slow: dict, fast: dict, percent: str) -> tuple[float, float, float]:
    """Least, nominal and largest percentage that rounded or cut-off digits allow."""
    (s0, s, s1), (f0, f, f1), u = _allowed(slow), _allowed(fast), last_place(percent)
    return 100 * (1 - f1 / s0) - u, 100 * (1 - f / s), 100 * (1 - f0 / s1) + u / 2


def _percentage(rng: np.random.Generator, draft: Draft) -> Planted:
    if not draft.has("gain") or draft.claim("gain").get("base") != "slower":
        raise UnfitError
    claim = draft.claim("gain")
    _totals(draft, claim)
    claim["percent"] = moved(claim["percent"], _steps(rng, 100))
    sides = (draft.claim(claim[k]) for k in ("slower", "faster"))
    low, nominal, high = _percent_room(*sides, claim["percent"])
    far = float(claim["percent"]) - nominal
    return Planted(draft, abs(far), high - nominal if far > 0 else nominal - low)


def _duplicated(rng: np.random.Generator, draft: Draft) -> Planted:
    if not draft.has("gain") or "percent" not in draft.claim("gain"):
        raise UnfitError
    claim, fast, slow = (draft.claim(i) for i in ("gain", "fast", "slow"))
    if "algorithm" not in slow or "total" not in fast or len(fast["durations"]) < 3:
        raise UnfitError
    claim["faster"] = "fast"
    slow["durations"], slow["total"] = fast["durations"], fast["total"]
    _, _, high = _percent_room(fast, fast, claim["percent"])
    return Planted(draft, float(claim["percent"]), high)


def _swapped(rng: np.random.Generator, draft: Draft) -> Planted:
    restated(rng, draft, draft.answers["fast"], peaks=bool(rng.random() < 0.5))
    claim = draft.claim("fast")
    a, b = rng.choice(len(claim["durations"]), 2, replace=False) if draft.segments > 1 else (0, 0)
    texts = list(claim["durations"])
    if texts[a] == texts[b]:
        raise UnfitError
    texts[a], texts[b] = texts[b], texts[a]
    claim["durations"] = texts
    return observed(draft)


def observed(draft: Draft) -> Planted:
    """A fault that shows in a limit or a peak, whichever tells most."""
    seen = [excess(draft)]
    seen += [peak_distance(draft, c) for c in draft.claims if c["quantity"] == "peak"]
    size, room = max(seen, key=lambda one: one[0] / max(one[1], 1e-300))
    return Planted(draft, max(size, 0.0), max(room, 1e-300))


def _exchanged(rng: np.random.Generator, draft: Draft) -> Planted:
    if not draft.has("gain"):
        raise UnfitError
    claim = draft.claim("gain")
    slow, fast = _totals(draft, claim)
    if float(slow) <= float(fast):
        raise UnfitError
    for key in ("percent", "base", "seconds"):
        claim.pop(key, None)
    claim["slower"], claim["faster"] = claim["faster"], claim["slower"]
    room = (last_place(slow) + last_place(fast)) / float(slow)
    return Planted(draft, float(slow) / float(fast) - 1, room)


def _waypoint(rng: np.random.Generator, draft: Draft) -> Planted:
    restated(rng, draft, draft.answers["fast"])
    j, i = int(rng.integers(draft.joints)), int(rng.integers(len(draft.points[0])))
    text = draft.points[j][i]
    places = [k for k, c in enumerate(text) if c.isdigit()]
    k = int(rng.choice(places))
    other = str((int(text[k]) + int(rng.integers(1, 10))) % 10)
    if other == "0" and k == places[0] and text[k + 1 : k + 2].isdigit():
        other = "2" if text[k] == "1" else "1"  # no number is printed as 02
    draft.points[j][i] = text[:k] + other + text[k + 1 :]
    return observed(draft)


def _vertex(rng: np.random.Generator, draft: Draft) -> Planted:
    draft.claims = [c for c in draft.claims if c["quantity"] != "control_vertices"]
    claim = vertices_claim(rng, draft)
    draft.claims.append(claim)
    j, i = int(rng.integers(draft.joints)), int(rng.integers(len(claim["joint_rows"][0])))
    text = moved(claim["joint_rows"][j][i], _steps(rng, 300))
    claim["joint_rows"][j][i] = text
    points, _ = read(draft)
    own = vertices(points)[i, j] / draft.si(0)
    weights = np.abs(vertices(np.eye(len(points)))[i])
    last = 0.0 if draft.exact_points else last_place(draft.points[j][0])
    room, largest = weights.sum() * last + last_place(text), np.abs(vertices(points)).max()
    scale = largest / draft.si(0)
    return Planted(draft, abs(float(text) - own) / scale, room / scale)


def _discontinuity(rng: np.random.Generator, draft: Draft) -> Planted:
    h = float(draft.answers["fast"].durations.max())
    durations = np.full(draft.segments, h)
    restated(rng, draft, Answer(durations, fitted(draft, durations)), peaks=False)
    claim = draft.claim("fast")
    k = int(rng.integers(draft.segments))
    claim["durations"][k] = moved(claim["durations"][k], abs(_steps(rng, 300)))
    claim.pop("total", None)
    draft.claims = [claim]
    draft.say("smooth", "continuous", "fast")
    far = float(claim["durations"][k]) - float(claim["durations"][k - 1])
    own = float(claim["durations"][k])
    return Planted(draft, far / own, last_place(claim["durations"][k]) / own)


def _suboptimal(rng: np.random.Generator, draft: Draft) -> Planted:
    if not draft.has("optimal"):
        raise UnfitError
    best, size = draft.answers["fast"], _log_uniform(rng, 1e-4, 0.3)
    restated(rng, draft, best, peaks=False)
    _, room = excess(draft)
    durations = best.durations * (1 + size)
    restated(rng, draft, Answer(durations, fitted(draft, durations)), peaks=False)
    draft.say("optimal", "optimal", "fast")
    claim = draft.claim("fast")
    claim.pop("total", None)
    up = 1.5 * len(durations) * last_place(claim["durations"][0]) * draft.si(-1) / best.total
    return Planted(draft, size, room + up)


def _other_clock(rng: np.random.Generator, draft: Draft) -> Planted:
    if draft.joints < 2:
        raise UnfitError
    shape = np.exp(rng.normal(0, 0.2, draft.segments))
    own = [answer(draft, shape, 0.0, joint) for joint in range(draft.joints)]
    slowest = max(own, key=lambda a: a.total)
    if min(a.total for a in own) >= slowest.total:
        raise UnfitError
    restated(rng, draft, Answer(slowest.durations, fitted(draft, slowest.durations)), peaks=False)
    peaks = np.array([a.motion.peaks(1)[0] for a in own]) / draft.si(1)
    values = [printed(x, 4) for x in peaks]
    draft.state("peak-1", "peak", derivative="velocity", of="fast", values=values)
    size, room = peak_distance(draft, draft.claim("peak-1"))
    return Planted(draft, size, room)


def _exceeded(rng: np.random.Generator, draft: Draft) -> Planted:
    found = draft.answers["fast"]
    over = 1 + _log_uniform(rng, 1e-4, 0.3)
    own = ratios(found.motion, draft.true_limits)
    factor = max((ratio / over) ** (1 / order) for order, ratio in own.items())
    durations = found.durations * factor
    restated(rng, draft, Answer(durations, fitted(draft, durations)), peaks=False)
    return Planted(draft, *excess(draft))


def _at_samples(rng: np.random.Generator, draft: Draft) -> Planted:
    found = draft.answers["fast"]
    count = int(rng.integers(4, 60))
    times = np.arange(count) * found.total / (count - 1)
    seen = {
        order: float((np.abs(found.motion.at(times, order)).max(axis=0) / limit).max())
        for order, limit in draft.true_limits.items()
    }
    durations = found.durations * max(x ** (1 / order) for order, x in seen.items())
    restated(rng, draft, Answer(durations, fitted(draft, durations)), peaks=False)
    size, room = excess(draft)
    if size <= 0:
        raise UnfitError
    return Planted(draft, size, room)


def _unit(rng: np.random.Generator, draft: Draft) -> Planted:
    restated(rng, draft, draft.answers["fast"], peaks=bool(rng.random() < 0.5))
    order = int(rng.choice(list(draft.limits)))
    unit = draft.units[ORDERS[order]]
    other = unit.replace("deg", "rad") if "deg" in unit else unit.replace("rad", "deg")
    draft.units[ORDERS[order]] = other
    return observed(draft)


FAULTS: dict[str, tuple[Fault, tuple[str, ...]]] = {
    "sum": (_sum, tuple(FAMILIES)),
    "percentage": (_percentage, tuple(FAMILIES)),
    "table printed twice": (_duplicated, tuple(FAMILIES)),
    "durations swapped": (_swapped, HELD),
    "before and after exchanged": (_exchanged, tuple(FAMILIES)),
    "way-point digit": (_waypoint, HELD),
    "control vertex digit": (_vertex, ("stretched uniform", "timed uniform")),
    "discontinuity": (_discontinuity, ("stretched uniform",)),
    "suboptimal called optimal": (_suboptimal, tuple(FAMILIES)),
    "another clock": (_other_clock, HELD),
    "limit exceeded": (_exceeded, HELD),
    "kept at samples only": (_at_samples, HELD),
    "unit of a limit": (_unit, HELD),
}
"""Each fault, and the families of curves that it is planted in."""
