"""Proof that no motion whatsoever is shorter, checked again: standard library only.

Why the proof holds is in docs/certificates-family-free.md; the symbols are the same here.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise
from typing import Any

from .verify_answer import read_answer
from .verify_problem import Bounds, Proved, Stated, need, number, read_problem, whole

UNIT = 10**10
_LARGEST = 10**18
Zero = Fraction(0)


@dataclass(frozen=True)
class _Question:
    steps: list[list[Fraction]]  # [segment][joint], between way-points
    velocity: list[Bounds]
    acceleration: list[Bounds]
    shortest: list[Fraction]
    longest: list[Fraction | None]
    ends: tuple[Fraction | None, Fraction | None]


def prove(document: dict[str, Any]) -> Proved:
    """Prove a certificate of kind "family-free" again.

    Parameters
    ----------
    document : dict

    Returns
    -------
    Proved

    Raises
    ------
    Refused
        If it does not prove its claim.
    """
    problem, claim, proof = read_problem(document["problem"]), document["claim"], document["proof"]
    asked = _question(problem, document["problem"])
    total, cap, lower = number(proof["total"]), number(proof["cap"]), number(claim["lower"])
    need(0 < total <= cap, "the total exceeds the cap below which the boxes lie")
    need(lower <= total, "the lower bound exceeds the total that is proved")
    _prove_total(asked, total, cap, proof)
    answer = read_answer(claim)
    if claim["infeasible"] is True:
        need(answer is None, "infeasible, but with an answer")
        top = [x for x in asked.longest if x is not None]
        late = len(top) == len(asked.longest) and lower > sum(top)
        need(late, "infeasible only above the sum of all upper bounds")
        return Proved(lower, None, True)
    if answer is None:
        return Proved(lower)
    _check_motion(problem, asked, answer[0], proof["speeds"])
    return Proved(lower, answer[1])


def _question(problem: Stated, data: dict[str, Any]) -> _Question:
    q, n = problem.waypoints, len(problem.shortest)
    given = problem.declaration
    if given is None:
        virtual: list[int] = []
        stated = data.get("ends", [None, None])
        need(len(stated) == 2, "ends: shape")
        start, end = (None if x is None else number(x) for x in stated)
    else:
        virtual = given.virtual
        start, end = given.prescribed[0].get(1), given.prescribed[-1].get(1)
    need(n > 0 and len(q) == n + 1 - len(virtual), "way-points: shape")
    spans: list[list[int]] = []
    for k in range(n):
        if k in virtual:
            spans[-1].append(k)
        else:
            spans.append([k])
    longest: list[Fraction | None] = []
    for span in spans:
        tops = [x for x in (problem.longest[k] for k in span) if x is not None]
        longest.append(sum(tops, Zero) if len(tops) == len(span) else None)
    return _Question(
        [[b - a for a, b in zip(*rows, strict=True)] for rows in pairwise(q)],
        [row[0] for row in problem.limits],
        [row[1] for row in problem.limits],
        [sum((problem.shortest[k] for k in span), Zero) for span in spans],
        longest,
        (start, end),
    )


# --- the lower bound ------------------------------------------------------------------------------


def _prove_total(asked: _Question, total: Fraction, cap: Fraction, proof: dict[str, Any]) -> None:
    """Whether every motion, with all durations positive, takes at least ``total``."""
    joints = range(len(asked.velocity))
    least = list(asked.shortest)
    for k, steps in enumerate(asked.steps):
        for step, limit in zip(steps, asked.velocity, strict=True):
            if step and limit is not None:
                need(limit[1] > 0, "a joint that moves has the velocity limit 0")
                least[k] = max(least[k], abs(step) / limit[1])
    # A total below the cap leaves a segment at most what the others do not need.
    spare = cap - sum(least)
    most = [
        low + spare if top is None else min(top, low + spare)
        for low, top in zip(least, asked.longest, strict=True)
    ]
    if any(low > high for low, high in zip(least, most, strict=True)):
        return
    speeds = [_speed(asked, j, cap) for j in joints]
    rows = proof["rows"]
    boxes = _boxes(list(zip(least, most, strict=True)), proof["tree"])
    need(len(boxes) == len(proof["leaves"]), "leaves and tree differ in number")
    for at, (box, leaf) in enumerate(zip(boxes, proof["leaves"], strict=True)):
        which = [rows[whole(i, 0, len(rows) - 1)] for i in leaf[::2]]
        weights = [number(x) for x in leaf[1::2]]
        need(len(which) == len(weights) and all(w >= 0 for w in weights), f"leaf {at}: weights")
        proved = _least_total(asked, speeds, box, list(zip(which, weights, strict=True)))
        need(proved >= total, f"leaf {at} proves only {float(proved):.12g} s")


def _speed(asked: _Question, joint: int, cap: Fraction) -> Fraction | None:
    """No motion with a total below the cap is faster; None if nothing bounds the speed."""
    velocity, acceleration = asked.velocity[joint], asked.acceleration[joint]
    if velocity is not None:
        return velocity[1]
    known = [abs(v) for v in asked.ends if v is not None]
    return min(known) + acceleration[1] * cap if known and acceleration is not None else None


def _boxes(
    whole_box: list[tuple[Fraction, Fraction]], tree: Any
) -> list[list[tuple[Fraction, Fraction]]]:
    """Leaves of a tree in preorder: [segment, place] cuts a box, lower part first; 0 is a leaf."""
    stack, found = [whole_box], []
    for entry in tree:
        need(bool(stack), "the tree has too many entries")
        box = stack.pop()
        if type(entry) is int and entry == 0:
            found.append(box)
            continue
        k, place = whole(entry[0], 0, len(box) - 1), number(entry[1])
        low, high = box[k]
        need(low < place < high, "a cut lies outside its box")
        stack.append([*box[:k], (place, high), *box[k + 1 :]])
        stack.append([*box[:k], (low, place), *box[k + 1 :]])
    need(not stack, "the tree leaves a part open")
    return found


def _least_total(
    asked: _Question,
    speeds: list[Fraction | None],
    box: list[tuple[Fraction, Fraction]],
    weighted: Sequence[tuple[Any, Fraction]],
) -> Fraction:
    """Least value of Σh − Σ weight·(left − right) over a box and all speeds within bounds."""
    result = Zero
    slope: dict[tuple[int, int], Fraction] = {}
    times = [Fraction(1)] * len(box)
    for row, weight in weighted:
        k, joint = whole(row[1], 0, len(box) - 1), whole(row[2], 0, len(speeds) - 1)
        v_max, bend = speeds[joint], asked.acceleration[joint]
        need(v_max is not None and bend is not None, "a row leans on a limit that is not there")
        assert v_max is not None
        assert bend is not None
        need(v_max > 0 and bend[1] > 0, "a row leans on a limit of 0")
        time, first, last, right = _row(row, asked.steps[k][joint], v_max, bend[1], box[k])
        result += weight * right
        times[k] -= weight * time
        slope[k, joint] = slope.get((k, joint), Zero) - weight * first
        slope[k + 1, joint] = slope.get((k + 1, joint), Zero) - weight * last
    result += sum(min(c * low, c * high) for c, (low, high) in zip(times, box, strict=True))
    for (at, joint), c in slope.items():
        end = asked.ends[0] if at == 0 else asked.ends[1] if at == len(box) else None
        v_max = speeds[joint]
        assert v_max is not None
        result += c * end if end is not None else -abs(c) * v_max
    return result


def _row(
    row: Any, step: Fraction, v_max: Fraction, bend: Fraction, sides: tuple[Fraction, Fraction]
) -> tuple[Fraction, Fraction, Fraction, Fraction]:
    """time·h + first·v₀ + last·v₁ ≥ right, for every motion of one joint through a segment."""
    kind, sign = row[0], row[3]
    # A sign 1.0 would turn every product with it into a float.
    need(type(sign) is int and sign in (1, -1), "sign")
    if kind == "change":  # A·h ≥ ∓(v₁ − v₀)
        return bend, Fraction(sign), Fraction(-sign), Zero
    way = sign * step
    need(way >= 0, "a row looks the wrong way")
    m0, m1 = (Fraction(whole(x, -_LARGEST, _LARGEST), UNIT) for x in row[4:6])
    if kind == "reach":
        n = whole(row[6], 0, _LARGEST) / (UNIT * v_max)
        per_peak = (m0 * (2 - m0) + m1 * (2 - m1)) / (2 * bend) - way * n**2
        right = 2 * way * n + (per_peak * v_max if per_peak < 0 else 0)
        return Fraction(1), sign * m0 / bend, sign * m1 / bend, right
    need(kind == "brake", f"unknown row {kind!r}")
    low, high = sides
    need(low > 0, "a row leans on a least duration that is 0")
    chord = way / (low * high)  # way/h ≤ chord·(low + high − h)
    time = bend * (m0**2 + m1**2) / 2 - chord
    right = -chord * (low + high) - v_max * abs(1 - m0 - m1)
    return time, -sign * m0, -sign * m1, right


# --- the answer -----------------------------------------------------------------------------------


def _check_motion(problem: Stated, asked: _Question, h: list[Fraction], speeds: Any) -> None:
    """Whether some motion through the way-points keeps its limits with these durations."""
    need(len(h) == len(asked.steps), "answer: one duration per segment between way-points")
    for k, x in enumerate(h):
        top = asked.longest[k]
        inside = x > 0 and x >= asked.shortest[k] and (top is None or x <= top)
        need(inside, f"answer: duration {k + 1} is outside its bounds")
    for j, (velocity, bend) in enumerate(zip(asked.velocity, asked.acceleration, strict=True)):
        steps = [row[j] for row in asked.steps]
        if not any(steps) and all(v in (None, 0) for v in asked.ends):
            # It stays where it is.
            low, high, place = *(side[j] for side in problem.position), problem.waypoints[0][j]
            inside = (low is None or low[1] <= place) and (high is None or place <= high[0])
            need(inside, f"answer: joint {j + 1} is outside its position limits")
            continue
        need(problem.limits[j][2] is None, "answer: jerk is limited")
        free = problem.position[0][j] is None and problem.position[1][j] is None
        need(free, "answer: position is limited")
        named = f"answer: joint {j + 1}, segment"
        top = None if velocity is None else velocity[0]
        if bend is None:
            # Any mean speed strictly inside the limits is met by steep ramps.
            for k, step in enumerate(steps):
                need(top is None or abs(step) < top * h[k], f"{named} {k + 1} is too fast")
            need(all(v is None or top is None or abs(v) <= top for v in asked.ends), "answer: ends")
            continue
        v = [number(row[j]) for row in speeds]
        need(len(v) == len(h) + 1, "answer: one speed per way-point")
        ends = zip(asked.ends, (v[0], v[-1]), strict=True)
        need(all(want in (None, have) for want, have in ends), "answer: speed at an end")
        need(top is None or max(map(abs, v)) <= top, "answer: velocity at a way-point")
        for k, step in enumerate(steps):
            a, b = v[k], v[k + 1]
            need(abs(b - a) <= bend[0] * h[k], f"{named} {k + 1} exceeds the acceleration")
            least = -_furthest(-a, -b, h[k], top, bend[0])
            most = _furthest(a, b, h[k], top, bend[0])
            need(least <= step <= most, f"{named} {k + 1} is out of reach")


def _furthest(a: Fraction, b: Fraction, h: Fraction, top: Fraction | None, bend: Fraction) -> Any:
    """Integral of min(a + bend·t, b + bend·(h − t), top), for |b − a| ≤ bend·h."""
    meet = (h + (b - a) / bend) / 2
    corners = [Zero, meet, h]
    if top is not None and a + bend * meet > top:
        corners = [Zero, (top - a) / bend, h - (top - b) / bend, h]
    level = [min(a + bend * t, b + bend * (h - t)) for t in corners]
    level = level if top is None else [min(x, top) for x in level]
    pairs = zip(corners[:-1], corners[1:], level[:-1], level[1:], strict=True)
    return sum((t1 - t0) * (x + y) / 2 for t0, t1, x, y in pairs)
