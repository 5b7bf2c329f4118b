"""Proof that no motion whatsoever is shorter, and whether an answer is one.

Why the proof holds is in docs/explanation/certificates-any-curve.md; the symbols are the same here.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise
from typing import Any

from .answer import check_durations
from .problem import StatedProblem
from .ranges import MOST_ROWS, MOST_TANGENT, MOST_WEIGHTS, TANGENT_UNIT
from .reading import Clock, listed, need, number, required, sign_of, weights, whole
from .tree import ProofKind, Subject

Zero = Fraction(0)
_NO_LIMIT = "a row leans on a limit that is not there"
"""Said of a speed or an acceleration without a bound: a row needs both."""

Sides = list[tuple[Fraction, Fraction]]
"""A box: least and largest duration of each span between way-points."""


@dataclass(frozen=True)
class Spans:
    """The question as it stands for any curve: by spans between way-points."""

    steps: list[list[Fraction]]
    """[span][joint]: from one way-point to the next."""
    shortest: list[Fraction]
    longest: list[Fraction | None]


def spans_of(problem: StatedProblem) -> Spans:
    """What remains of a problem if the curve is left open: virtual way-points do not count."""
    virtual = [] if problem.declaration is None else problem.declaration.virtual
    firsts = [k for k in range(problem.segments) if k not in virtual]
    held = [slice(a, b) for a, b in pairwise([*firsts, problem.segments])]
    tops = [problem.longest[span] for span in held]
    return Spans(
        [[b - a for a, b in zip(*rows, strict=True)] for rows in pairwise(problem.waypoints)],
        [sum(problem.shortest[span], Zero) for span in held],
        [None if None in each else sum(filter(None, each), Zero) for each in tops],
    )


# --- the lower bound ------------------------------------------------------------------------------


@dataclass(frozen=True)
class _Row:
    """time·h + first·v₀ + last·v₁ ≥ right, for every motion of a joint through a span."""

    kind: str
    span: int
    joint: int
    sign: int
    m0: int
    m1: int
    n: int

    def terms(
        self, step: Fraction, v_max: Fraction, bend: Fraction, sides: tuple[Fraction, Fraction]
    ) -> tuple[Fraction, Fraction, Fraction, Fraction]:
        """The factors time, first and last, and the right-hand side.

        From the docs, for d ≥ 0 the mirrored step, c = (m₀(2 − m₀) + m₁(2 − m₁))/2A − dn² and
        l ≤ h ≤ u:

        - reach: h + (m₀v₀ + m₁v₁)/A ≥ 2dn + min(0, cV),
        - brake: A(m₀² + m₁²)h/2 + d(l + u − h)/lu + |1 − m₀ − m₁|V ≥ m₀v₀ + m₁v₁.
        """
        sign = self.sign
        if self.kind == "change":  # A·h ≥ ∓(v₁ − v₀)
            return bend, Fraction(sign), Fraction(-sign), Zero
        way = sign * step
        need(way >= 0, "a row points in the wrong direction")
        m0, m1 = Fraction(self.m0, TANGENT_UNIT), Fraction(self.m1, TANGENT_UNIT)
        if self.kind == "reach":
            n = Fraction(self.n, TANGENT_UNIT) / v_max
            per_peak = (m0 * (2 - m0) + m1 * (2 - m1)) / (2 * bend) - way * n**2
            right = 2 * way * n + (per_peak * v_max if per_peak < 0 else 0)
            return Fraction(1), sign * m0 / bend, sign * m1 / bend, right
        low, high = sides
        need(low > 0, "a row leans on a least duration that is 0")
        chord = way / (low * high)  # way/h ≤ chord·(low + high − h)
        time = bend * (m0**2 + m1**2) / 2 - chord
        right = -chord * (low + high) - v_max * abs(1 - m0 - m1)
        return time, -sign * m0, -sign * m1, right


class AnyCurve(ProofKind[Sides]):
    """Boxes of durations, in each of which weighted rows bound the total."""

    subject = Subject.ANY
    keys = ("cap", "rows")

    def read(self, proof: dict[str, Any]) -> None:
        """The cap of the total, and the table of rows."""
        self._asked = spans_of(self.problem)
        self._cap = number(proof["cap"])
        need(0 < self.total <= self._cap, "the total exceeds the cap below which the boxes lie")
        rows = listed(proof["rows"], "rows", MOST_ROWS)
        self._rows = [self.row(row) for row in self.clock.each(rows)]
        self.speeds = [self._speed(joint) for joint in range(self.problem.joints)]

    def row(self, entry: Any) -> _Row:
        """Read [kind, span, joint, sign, m₀, m₁, n]."""
        kind, span, joint, sign, m0, m1, n = listed(entry, "a row", 7, 7)
        need(kind in ("change", "reach", "brake"), "a row of an unknown kind")
        k, j = whole(span, 0, len(self._asked.steps) - 1), whole(joint, 0, self.problem.joints - 1)
        m0, m1 = (whole(m, -MOST_TANGENT, MOST_TANGENT) for m in (m0, m1))
        return _Row(kind, k, j, sign_of(sign), m0, m1, whole(n, 0, MOST_TANGENT))

    def _speed(self, joint: int) -> Fraction | None:
        """No motion with a total below the cap is faster; None if nothing bounds the speed."""
        velocity, acceleration, _ = self.problem.limits[joint]
        if velocity is not None:
            return velocity[1]
        known = [abs(v) for v in (side[joint] for side in self.problem.ends) if v is not None]
        if not known or acceleration is None:
            return None
        return min(known) + acceleration[1] * self._cap

    def root(self) -> Sides:
        """Durations by their bounds, the mean velocities, and what a total below the cap leaves."""
        asked = self._asked
        least = list(asked.shortest)
        for k, steps in enumerate(asked.steps):
            for step, (limit, *_) in zip(steps, self.problem.limits, strict=True):
                if step and limit is not None:
                    need(limit[1] > 0, "a joint that moves has the velocity limit 0")
                    least[k] = max(least[k], abs(step) / limit[1])
        # A total below the cap leaves a span at most what the others do not need.
        spare = self._cap - sum(self.clock.each(least), Zero)
        return [
            (low, low + spare if top is None else min(top, low + spare))
            for low, top in zip(least, asked.longest, strict=True)
        ]

    def cut(self, box: Sides, coordinate: int, place: Any) -> tuple[Sides, Sides]:
        """At the stated duration."""
        k, at = whole(coordinate, 0, len(box) - 1), number(place)
        low, high = box[k]
        need(low < at < high, "a cut lies outside its box")
        return (
            [*box[:k], (low, at), *box[k + 1 :]],
            [*box[:k], (at, high), *box[k + 1 :]],
        )

    def leaf(self, box: Sides, data: list[Any]) -> None:
        """[row, weight, row, weight, …]: they bound the total from below in the box."""
        if any(low > high for low, high in box):
            return  # no durations at all
        stated = weights(data, len(self._rows), MOST_WEIGHTS)
        weighted = [(self._rows[row], number(weight)) for row, weight in stated]
        need(all(weight >= 0 for _, weight in weighted), "a weight is negative")
        proved = self.least_total(box, weighted)
        need(proved >= self.total, f"it proves only {float(proved):.12g} s")

    def least_total(self, box: Sides, weighted: Sequence[tuple[_Row, Fraction]]) -> Fraction:
        """Least value of Σh − Σ weight·(left − right) over a box and all speeds within bounds.

        Every motion has left ≥ right and so Σh ≥ that; it is linear, least at ends of the sides.
        """
        asked, result = self._asked, Zero
        slope: dict[tuple[int, int], Fraction] = {}
        fastest: dict[int, Fraction] = {}
        times = [Fraction(1)] * len(box)
        for row, weight in weighted:
            self.clock.check()
            k, joint = row.span, row.joint
            v_max = fastest[joint] = required(self.speeds[joint], _NO_LIMIT)
            bend = required(self.problem.limits[joint][1], _NO_LIMIT)[1]
            need(v_max > 0 and bend > 0, "a row leans on a limit of 0")
            time, first, last, right = row.terms(asked.steps[k][joint], v_max, bend, box[k])
            result += weight * right
            times[k] -= weight * time
            slope[k, joint] = slope.get((k, joint), Zero) - weight * first
            slope[k + 1, joint] = slope.get((k + 1, joint), Zero) - weight * last
        for c, (low, high) in self.clock.each(zip(times, box, strict=True)):
            result += min(c * low, c * high)
        for (at, joint), c in slope.items():
            self.clock.check()
            side = 0 if at == 0 else 1 if at == len(box) else None
            end = None if side is None else self.problem.ends[side][joint]
            result += c * end if end is not None else -abs(c) * fastest[joint]
        return result


# --- the answer -----------------------------------------------------------------------------------


def check_motion(
    problem: StatedProblem,
    h: Sequence[Fraction],
    speeds: list[list[Fraction]] | None,
    clock: Clock,
) -> None:
    """Refuse durations with which no motion through the way-points keeps its limits.

    Parameters
    ----------
    h : sequence of Fraction
        Durations between way-points, s.
    speeds : list, [way-point][joint], or None
        Velocities at the way-points, for joints whose acceleration is limited.

    Raises
    ------
    Refused
        With the joint and the segment.
    """
    alike = problem.sides[0] == problem.sides[1]
    need(alike, "answer: lower and upper limits differ, which no answer of any curve keeps")
    asked = spans_of(problem)
    check_durations(h, asked.shortest, asked.longest)
    for j, (velocity, bend, jerk) in enumerate(problem.limits):
        clock.check()
        steps = [row[j] for row in asked.steps]
        given = [side[j] for side in problem.ends]
        if not any(steps) and all(v in (None, 0) for v in given):
            # It stays where it is.
            low, high, place = *(side[j] for side in problem.position), problem.waypoints[0][j]
            inside = (low is None or low[1] <= place) and (high is None or place <= high[0])
            need(inside, f"answer: joint {j + 1} is outside its position limits")
            continue
        need(jerk is None, "answer: jerk is limited")
        free = problem.position[0][j] is None and problem.position[1][j] is None
        need(free, "answer: position is limited")
        named = f"answer: joint {j + 1}, segment"
        top = None if velocity is None else velocity[0]
        if bend is None:
            # Any mean speed strictly inside the limits is met by steep ramps.
            for k, step in enumerate(steps):
                need(top is None or abs(step) < top * h[k], f"{named} {k + 1} is too fast")
            need(all(v is None or top is None or abs(v) <= top for v in given), "answer: ends")
            continue
        need(bend[0] > 0, f"answer: joint {j + 1} moves with the acceleration limit 0")
        v = [row[j] for row in required(speeds, "answer: no speeds at the way-points")]
        ends = zip(given, (v[0], v[-1]), strict=True)
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
