"""A paper drawn at random: claims that are true of its answers, printed as papers print."""

from typing import Any

import numpy as np
from support.papers.drafts import (
    Answer,
    Draft,
    answer,
    fitted,
    keeps,
    problem,
    shortest,
    some_shape,
    some_slack,
)
from support.papers.motions import FAMILIES, Motion, NoCurveError, Pieces, vertices
from support.papers.printing import ORDERS, TIMES, places_for, printed

SAMPLES = 100
"""Fewest samples of a motion from which a paper reads its peaks."""
SHORTEST = 1e-3
"""Share of the total that each segment takes in a paper that prints peaks: at rest in a shorter
one, a joint jerks by what rounding in double precision leaves of its position."""


def draw(seed: int, families: tuple[str, ...] = tuple(FAMILIES)) -> Draft:
    """A clean paper."""
    rng = np.random.default_rng([20261122, seed])
    while True:
        try:
            draft = problem(rng, seed, str(rng.choice(families)))
            if rng.random() < 0.15 and draft.name in _ALONE and draft.joints > 1:
                _joint_by_joint(rng, draft)
            else:
                _together(rng, draft)
        except NoCurveError:
            continue
        return draft


_ALONE = ("3-5-3", "clamped cubic", "rest 3", "rest 5", "C4 quintic", "4-3-4")
"""Families of which papers also take each joint separately."""


def time_text(draft: Draft, seconds: float, how: str | None = None, fewer: int = 0) -> str:
    """A time in the unit of the paper."""
    number = seconds / TIMES[draft.units["time"]]
    places = max(draft.places - fewer, 0)
    while not float(printed(number, places, how or draft.how)):  # nobody prints a duration of 0
        places += 1
    return printed(number, places, how or draft.how)


def _rounded_up(draft: Draft, found: Answer) -> Answer | None:
    """The printed durations as the answer itself, where they still keep the limits."""
    unit = TIMES[draft.units["time"]]
    texts = [printed(h / unit, draft.places, "up") for h in found.durations]
    durations = np.array([float(t) * unit for t in texts])
    try:
        if not keeps(draft, durations, found.joint):
            return None
    except NoCurveError:
        return None
    return Answer(durations, fitted(draft, durations, found.joint), found.joint)


def state_durations(
    rng: np.random.Generator, draft: Draft, name: str, found: Answer, **more: Any
) -> None:
    """Claim a set of durations, with its total in most papers."""
    draft.answers[name] = found
    how = draft.how
    if how == "up":
        higher = _rounded_up(draft, found)
        if higher is None:
            how = "round"
        else:
            found = draft.answers[name] = higher
    texts = [time_text(draft, h, how) for h in found.durations]
    claim: dict[str, Any] = {"id": name, "quantity": "durations", "durations": texts} | more
    if rng.random() < 0.85:
        claim["total"] = _total(rng, draft, texts, found.total, how)
    draft.claims.append(claim)


def _total(rng: np.random.Generator, draft: Draft, texts: list[str], true: float, how: str) -> str:
    """A total: that of the truth, or the sum of the printed digits, as papers add them up."""
    places = max(draft.places - (1 if rng.random() < 0.1 else 0), 0)
    unit = TIMES[draft.units["time"]]
    if how == "up" or rng.random() < 0.4:
        other = how if rng.random() < 0.5 else "round"
        return printed(round(sum(map(float, texts)), 9), places, other)
    other = how if rng.random() < 0.9 else "round"
    return printed(true / unit, places, other)


def _together(rng: np.random.Generator, draft: Draft) -> None:
    best = shortest(draft) if rng.random() < 0.6 else None
    trials = [answer(draft, some_shape(rng, draft), some_slack(rng)) for _ in range(3)]
    trials.sort(key=lambda a: a.total)
    fast, slow = best or trials[0], trials[-1]
    several = rng.random() < 0.7
    if several:
        before = rng.random() < 0.4
        more = {"state": "before"} if before else {"algorithm": "old"}
        if before and rng.random() < 0.5:
            durations = slow.durations * float(rng.uniform(0.9, 1.5))
            if durations.sum() > fast.total:
                slow = Answer(durations, fitted(draft, durations))
        state_durations(rng, draft, "slow", slow, table="table-3", **more)
    state_durations(rng, draft, "fast", fast, table="table-4", algorithm="new")
    fast = draft.answers["fast"]
    _abstract(rng, draft)
    if several:
        _improvement(rng, draft)
    named = ["fast"]
    if several and "algorithm" in draft.claim("slow"):
        named.append("slow")
    _say(rng, draft, 0.7, "kept", "within_limits", *named)
    if best is not None:
        _say(rng, draft, 1.0, "optimal", "optimal", "fast")
    _peaks(rng, draft)
    _qualities(rng, draft)


def _abstract(rng: np.random.Generator, draft: Draft) -> None:
    if rng.random() > 0.6:
        return
    claim = draft.claim("fast")
    if "total" in claim and rng.random() < 0.6:
        value = claim["total"]
    else:
        how = "round" if draft.how == "up" else draft.how
        value = time_text(draft, draft.answers["fast"].total, how, int(rng.integers(0, 2)))
    said = {"of": "fast"} if rng.random() < 0.5 else {}
    draft.state("abstract", "total_time", value=value, algorithm="new", **said)


def _improvement(rng: np.random.Generator, draft: Draft) -> None:
    slow, fast = draft.answers["slow"].total, draft.answers["fast"].total
    if slow < 1.002 * fast or rng.random() > 0.8:
        return
    unit = TIMES[draft.units["time"]]
    faster = "abstract" if draft.has("abstract") and rng.random() < 0.4 else "fast"
    claim: dict[str, Any] = {"slower": "slow", "faster": faster}
    texts = [draft.claim(i).get("total", draft.claim(i).get("value")) for i in ("slow", faster)]
    how = "cut" if draft.how == "cut" and rng.random() < 0.7 else "round"
    if None not in texts and rng.random() < 0.6:
        slow, fast = (float(t) * unit for t in texts)  # computed from the digits, as readers would
    elif draft.how == "up":
        return
    kind = rng.random()
    if kind < 0.7:
        base = "slower" if rng.random() < 0.7 else "faster"
        share = 100 * (slow - fast) / (slow if base == "slower" else fast)
        claim["percent"] = printed(share, int(rng.integers(0, 3)), how)
        if rng.random() < 0.5:
            claim["base"] = base
    elif kind < 0.85:
        claim["seconds"] = printed((slow - fast) / unit, draft.places, how)
    elif None not in texts and float(texts[0]) <= float(texts[1]):
        return
    draft.state("gain", "improvement", **claim)


def _say(rng: np.random.Generator, draft: Draft, chance: float, *said: str, **more: Any) -> None:
    if rng.random() < chance:
        draft.say(*said, **more)


def _peaks(rng: np.random.Generator, draft: Draft, of: str = "fast") -> None:
    motion, durations = draft.answers[of].motion, draft.answers[of].durations
    for order in (1, 2, 3):
        if rng.random() > 0.4 or (order == 3 and draft.family.smooth < 2):
            continue
        way = str(rng.choice(["exact", "exact", "sampled", "cut", "norm"]))
        claim = peak_claim(rng, draft, motion, order, way, of)
        if durations.min() > SHORTEST * durations.sum():
            draft.claims.append(claim)


def peak_claim(
    rng: np.random.Generator, draft: Draft, motion: Motion, order: int, way: str, of: str
) -> dict[str, Any]:
    """Claim the peaks of a motion, read off in one of the ways that papers do."""
    unit = draft.si(order)
    count = SAMPLES * int(rng.integers(1, 6))
    samples = motion.at(np.arange(count) * motion.total / count, order)
    if way == "norm":
        values = np.array([np.linalg.norm(samples, axis=1).max()])
    elif way == "sampled":
        values = np.abs(samples).max(axis=0)
    else:
        values = motion.peaks(order)
    if way != "norm" and rng.random() < 0.5:
        values = values.max(keepdims=True)
        key = "value"
    else:
        key = "value" if way == "norm" else "values"
    significant = int(rng.integers(3, 6))
    how = "cut" if way == "cut" else "round"
    texts = [printed(x / unit, places_for(x / unit, significant), how) for x in values]
    claim = {"id": f"peak-{order}", "quantity": "peak", "derivative": ORDERS[order], "of": of}
    return claim | {key: texts[0] if key == "value" else texts}


def _qualities(rng: np.random.Generator, draft: Draft, of: str = "fast") -> None:
    """What is said of the curve in words and counts."""
    family, motion = draft.family, draft.answers[of].motion
    if family.smooth >= 2:
        _say(rng, draft, 0.4, "smooth", "continuous", of)
    elif (
        family.smooth == 1
        and isinstance(motion, Pieces)
        and motion.jumps(2).max() > 0.01 * motion.peaks(2).max()
    ):
        _say(rng, draft, 0.4, "jumps", "jumps", of)
    if 1 in family.still:
        _say(rng, draft, 0.4, "rest", "at_rest", of)
    if family.degrees is not None and rng.random() < 0.4:
        draft.state("conditions", "conditions", **_conditions(rng, draft, of))
    if "uniform" in draft.name and rng.random() < 0.7:
        draft.claims.append(vertices_claim(rng, draft))
    ranges = np.ptp(np.array([[float(t) for t in row] for row in draft.points]), axis=1)
    if len(ranges) > 1 and np.ptp(np.sort(ranges)[-2:]) > 0.05 * ranges.max():
        joint = str(int(ranges.argmax()) + 1)
        _say(rng, draft, 0.2, "widest", "varies_most", joint=joint)
    _say(rng, draft, 0.2, "wear", "none", not_checkable="no measure is defined")


def _conditions(rng: np.random.Generator, draft: Draft, of: str) -> dict[str, Any]:
    family, n = draft.family, draft.segments
    degrees, rest = list(family.degrees(n)), len(family.still)
    claim: dict[str, Any] = {
        "rest_at": "all" if family.at_all else "ends",
        "orders": list(family.still),
        "degrees": degrees,
        "continuity": family.smooth,
        "of": [of],
    }
    if rng.random() < 0.5:
        inner = 2 * rest if family.at_all else family.smooth
        claim["count"] = str(2 * n + 2 * rest + (n - 1) * inner)
    return claim


def vertices_claim(rng: np.random.Generator, draft: Draft) -> dict[str, Any]:
    """Claim the control vertices of the uniform cubic B-spline."""
    rows = (vertices(draft.true_points) / draft.si(0)).T
    texts = draft.points[0][0]
    places = len(texts.split(".")[1]) if "." in texts else 0
    how = str(rng.choice(["round", "cut"]))
    places += int(rng.integers(0, 2))
    digits = [[printed(x, places, how) for x in row] for row in rows]
    return {"id": "vertices", "quantity": "control_vertices", "joint_rows": digits}


def _joint_by_joint(rng: np.random.Generator, draft: Draft) -> None:
    draft.coupling = "per-joint"
    draft.other_reading = False
    best = rng.random() < 0.5
    names, found = [], []
    for joint in range(draft.joints):
        one = shortest(draft, joint) if best else None
        best = best and one is not None
        one = one or answer(draft, some_shape(rng, draft), some_slack(rng), joint)
        names.append(f"joint-{joint + 1}")
        label = {"joint": str(joint + 1), "table": "table-3", "algorithm": "new"}
        state_durations(rng, draft, names[-1], one, **label)
        found.append(draft.answers[names[-1]])
    _say(rng, draft, 1.0, "kept", "within_limits", *names)
    if best:
        _say(rng, draft, 1.0, "optimal", "optimal", *names)
    longest = np.max([one.durations for one in found], axis=0)
    how = "round" if draft.how == "up" else draft.how
    texts = [time_text(draft, h, how) for h in longest]
    total = _total(rng, draft, texts, float(longest.sum()), how)
    draft.state("longest", "maximum", of=names, durations=texts, total=total)
