"""Boxes of durations, and ranges of a C2 cubic spline's unknowns over them.

Ranges are rounded outward to multiples of 1/FINE, which only weakens them.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from math import ceil, floor

from ..ranges import TICKS
from ..reading import Clock
from .system import ZERO, Cubic, smaller

FINE = 2**44
"""Ranges are multiples of 1/FINE: fine enough for gaps of 1e-9, and no number grows in a tree."""
_INNER = 2**80
"""What the ranges are computed from is in multiples of 1/_INNER: where a span is almost 0, so is
the determinant of the equations, and an inverse of 1e6 times ranges of 1e6 magnify a rounding."""
_ROUNDS = 6
"""Of narrowing one range by the others: more gain nothing that the next box would not."""
_SINGULAR = 1e-12
"""A pivot below it is taken for 0: without an inverse the ranges stay what they are."""

Range = tuple[Fraction, Fraction] | None
"""None: unbounded."""


class Box:
    """Sides in ticks, ranges of the unknowns, floor of the total."""

    def __init__(
        self, cubic: Cubic, low: list[int], high: list[int], x: list[list[Range]], floor_: int
    ) -> None:
        self.cubic, self.low, self.high, self.x, self.floor = cubic, low, high, x, floor_
        self.empty = False
        self.trim()

    def trim(self) -> None:
        """The spans sum up to less than the cap; a piece is shorter than its span."""
        m, cap = self.cubic.m, int(self.cubic.cap * TICKS)
        total = sum(self.low[:m])
        for t in range(m):
            self.high[t] = min(self.high[t], cap - total + self.low[t])
        for h, t, _ in self.cubic.rho():
            self.high[h] = min(self.high[h], self.high[t])
        self.floor = max(self.floor, total)
        self.empty |= any(a > b for a, b in zip(self.low, self.high, strict=True))
        self.empty |= self.floor >= cap

    def sides(self) -> list[tuple[Fraction, Fraction]]:
        """Lower and upper end of every coordinate, both ρ included."""
        out = [
            (Fraction(a, TICKS), Fraction(b, TICKS))
            for a, b in zip(self.low, self.high, strict=True)
        ]
        for h, t, _ in self.cubic.rho():
            most = out[h][1] ** 2 / out[t][0] if out[t][0] else out[h][1]
            least = out[h][0] ** 2 / out[t][1] if out[t][1] else ZERO
            out.append((least, max(least, min(most, out[h][1]))))
        return out

    def narrow(self, clock: Clock) -> None:
        """Narrow the ranges by the limits, then by the equations at the centre of the box.

        With M(y) = M(c) + Σ (y_k − c_k)B_k, Y ≈ M(c)⁻¹ and x̃ ≈ Y b(c), M(y)x = b(y) says (Krawczyk)

            x − x̃ = Y(b(c) − M(c)x̃) + Y Σ (y_k − c_k)(b'_k − B_k x̃)
                    + (I − Y M(c) − Σ (y_k − c_k) Y B_k)(x − x̃),

        b'_k the slope of b from c_k to y_k. The first line is ``offset``, the second ``change``.
        """
        cubic, sides = self.cubic, self.sides()
        self._from_limits(sides)
        moving = [(i, t, sign) for i, (t, sign) in cubic.moved.items() if any(cubic.steps[t])]
        if any(sides[t][0] <= 0 for _, t, _ in moving):
            return
        centre = [Fraction(floor((a + b) / 2 * _INNER), _INNER) for a, b in sides]
        half = [max(b - c, c - a) for (a, b), c in zip(sides, centre, strict=True)]
        rows: list[dict[int, Fraction]] = []
        linear: list[list[tuple[int, int, Fraction]]] = [[] for _ in sides]
        for i, equation in enumerate(cubic.equations):
            row: dict[int, Fraction] = {}
            for key, a in equation.items():
                v = key if isinstance(key, int) else key[1]
                row[v] = row.get(v, ZERO) + (a if isinstance(key, int) else a * centre[key[0]])
                if not isinstance(key, int):
                    linear[key[0]].append((i, v, a))
            rows.append(row)
        y = _inverse(rows, clock)
        if y is None:
            return
        known = [j for j in range(cubic.joints) if None not in self.x[j]]
        middles: dict[int, list[Fraction]] = {}
        offsets: dict[int, list[Fraction]] = {}
        for j in known:
            clock.check()
            force = {i: sign * 6 * cubic.steps[t][j] for i, t, sign in moving}
            right = {i: force[i] / centre[t] for i, t, _ in moving}
            x = [_nearest(sum((line[i] * b for i, b in right.items()), ZERO)) for line in y]
            miss = [
                right.get(i, ZERO) - sum((a * x[v] for v, a in row.items()), ZERO)
                for i, row in enumerate(rows)
            ]
            pulls: list[tuple[Fraction, dict[int, Fraction], dict[int, Fraction]]] = []
            for k, entries in enumerate(linear):
                ends: list[dict[int, Fraction]] = []
                # (1/T − 1/c) = −(T − c)/(cT), for T at either end.
                for side in sides[k]:
                    pull: dict[int, Fraction] = {}
                    for i, v, a in entries:
                        pull[i] = pull.get(i, ZERO) + a * x[v]
                    for i, t, _ in moving:
                        if t == k:
                            pull[i] = pull.get(i, ZERO) + force[i] / (centre[k] * side)
                    ends.append({i: _nearest(p) for i, p in pull.items()})
                pulls.append((half[k], ends[0], ends[1]))
            offset = []
            for line in y:
                clock.check()
                total: Fraction = abs(sum((a * b for a, b in zip(line, miss, strict=True)), ZERO))
                for width, first, second in pulls:
                    total += width * max(
                        abs(sum((line[i] * p for i, p in end.items()), ZERO))
                        for end in (first, second)
                    )
                # What rounding the pulls lost: half a unit for each of them.
                total += sum(map(abs, line), ZERO) * sum(half, ZERO) / _INNER
                offset.append(total)
            middles[j], offsets[j] = x, offset
        change = _changes(y, rows, linear, half, clock)
        for j in known:
            clock.check()
            self._contract(j, middles[j], offsets[j], change)

    def _from_limits(self, sides: Sequence[tuple[Fraction, Fraction]]) -> None:
        """|v| and |a| by the limits, Markov's inequality, and jerk since a rest of a.

        A parabola within ±V on a length h has |slope| ≤ 8V/h (2n²/h for degree n).
        """
        cubic, n = self.cubic, self.cubic.n
        least, most = (
            [
                sum((x * sides[c][0 if (x > 0) == lower else 1] for c, x in piece.items()), ZERO)
                for piece in cubic.lengths
            ]
            for lower in (True, False)
        )
        reach = [max([ZERO, *(least[k] for k in (b - 1, b) if 0 <= k < n)]) for b in range(n + 1)]
        if cubic.virtual:
            reach[1] = max(reach[1], sides[0][0] / 2)
            reach[n - 1] = max(reach[n - 1], sides[cubic.m - 1][0] / 2)
        for j in range(cubic.joints):
            v, a = cubic.fastest(j)
            jerk = cubic.limits[j][2]
            for b in range(n + 1):
                bound = a
                if v is not None and reach[b]:
                    bound = smaller(bound, 8 * v / reach[b])
                if jerk is not None and cubic.ends[0] != 1:
                    bound = smaller(bound, jerk * sum(most[:b], ZERO))
                if jerk is not None and cubic.ends[1] != 1:
                    bound = smaller(bound, jerk * sum(most[b:], ZERO))
                self._cut(j, b, bound)
            for w in range(n + 1, cubic.size):
                self._cut(j, w, v)

    def _cut(self, j: int, v: int, bound: Fraction | None) -> None:
        if bound is not None:
            self._between(j, v, -bound, bound)

    def _between(self, j: int, v: int, low: Fraction, high: Fraction) -> None:
        low, high = Fraction(floor(low * FINE), FINE), Fraction(ceil(high * FINE), FINE)
        old = self.x[j][v]
        new = (low, high) if old is None else (max(low, old[0]), min(high, old[1]))
        self.x[j][v] = new
        self.empty |= new[0] > new[1]

    def _contract(
        self, j: int, middle: list[Fraction], offset: list[Fraction], change: list[list[int]]
    ) -> None:
        """|x − middle| ≤ offset + change·|x − middle|, again and again, in units of 1/FINE."""
        base = [ceil(x * FINE) for x in offset]
        for _ in range(_ROUNDS):
            radius = []
            for x, r in zip(middle, self.x[j], strict=True):
                assert r is not None
                radius.append(ceil(max(abs(r[0] - x), abs(r[1] - x)) * FINE))
            for v, line in enumerate(change):
                moved = sum(a * b for a, b in zip(line, radius, strict=True)) // _INNER + 1
                reach = Fraction(base[v] + moved, FINE)
                self._between(j, v, middle[v] - reach, middle[v] + reach)
            if self.empty:
                return


def _nearest(x: Fraction) -> Fraction:
    return Fraction(round(x * _INNER), _INNER)


def _inverse(rows: Sequence[dict[int, Fraction]], clock: Clock) -> list[list[Fraction]] | None:
    """About the inverse, by Gauss-Jordan elimination in floats; None if singular."""
    n = len(rows)
    table = [
        [float(row.get(v, 0)) for v in range(n)] + [float(i == v) for v in range(n)]
        for i, row in enumerate(rows)
    ]
    for k in range(n):
        clock.check()
        pivot = max(range(k, n), key=lambda i: abs(table[i][k]))
        if abs(table[pivot][k]) < _SINGULAR:
            return None
        table[k], table[pivot] = table[pivot], table[k]
        scale = table[k][k]
        table[k] = [x / scale for x in table[k]]
        for i in range(n):
            if i != k and table[i][k]:
                factor = table[i][k]
                table[i] = [x - factor * z for x, z in zip(table[i], table[k], strict=True)]
    return [[_nearest(Fraction(x)) for x in line[n:]] for line in table]


def _changes(
    y: Sequence[Sequence[Fraction]],
    rows: Sequence[dict[int, Fraction]],
    linear: Sequence[Sequence[tuple[int, int, Fraction]]],
    half: Sequence[Fraction],
    clock: Clock,
) -> list[list[int]]:
    """|I − Y M(c)| + Σ half_k |Y B_k|, rounded up, in units of 1/_INNER."""
    out = []
    for r, line in enumerate(y):
        clock.check()
        left = [Fraction(int(r == v)) for v in range(len(rows))]
        for i, row in enumerate(rows):
            for v, x in row.items():
                left[v] -= line[i] * x
        total = [abs(x) for x in left]
        for entries, width in zip(linear, half, strict=True):
            moved: dict[int, Fraction] = {}
            for i, v, x in entries:
                moved[v] = moved.get(v, ZERO) + line[i] * x
            for v, x in moved.items():
                total[v] += width * abs(x)
        out.append([ceil(x * _INNER) for x in total])
    return out
