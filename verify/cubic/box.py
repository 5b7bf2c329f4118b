"""Boxes of durations, and ranges of a C2 cubic spline's unknowns over them.

All numbers are whole: sides in ticks, ranges in multiples of 1/FINE, and what these are computed
from in multiples of 1/_INNER. Whatever is rounded is rounded outward, which only weakens a range.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from math import ceil, floor, isfinite
from operator import mul

from ..ranges import TICKS
from ..reading import Clock
from .system import FINE, Cubic, Sides, least_of

_INNER = 2**80
"""What the ranges are computed from is in multiples of 1/_INNER: where a span is almost 0, so is
the determinant of the equations, and an inverse of 1e6 times ranges of 1e6 magnify a rounding."""
_ROUNDS = 6
"""Of narrowing one range by the others: more gain nothing that the next box would not."""

Range = tuple[int, int] | None
"""In multiples of 1/FINE; None: unbounded."""


@dataclass(eq=False)
class Box:
    """Part of the durations below the cap."""

    low: list[int]
    high: list[int]
    """Sides in ticks."""
    x: list[list[Range]]
    """[joint][unknown]."""
    floor: int = 0
    """The total is at least this many ticks."""
    empty: bool = False
    """Nothing below the cap is feasible in it."""

    def again(self) -> Box:
        """A copy, of which nothing is shared."""
        x = [list(row) for row in self.x]
        return Box(list(self.low), list(self.high), x, self.floor, self.empty)

    def move(self, cubic: Cubic, coordinate: int, sign: int, value: int) -> None:
        """Move a side inward: the lower one for sign 1."""
        if sign > 0:
            self.low[coordinate] = max(self.low[coordinate], value)
        else:
            self.high[coordinate] = min(self.high[coordinate], value)
        self.trim(cubic)

    def trim(self, cubic: Cubic) -> None:
        """The spans sum up to less than the cap; a piece is shorter than its span."""
        m, cap = cubic.m, int(cubic.cap * TICKS)
        total = sum(self.low[:m])
        for t in range(m):
            self.high[t] = min(self.high[t], cap - total + self.low[t])
        for h, t, _ in cubic.rho:
            self.high[h] = min(self.high[h], self.high[t])
        self.floor = max(self.floor, total)
        self.empty |= any(a > b for a, b in zip(self.low, self.high, strict=True))
        self.empty |= self.floor >= cap

    def sides(self, cubic: Cubic) -> Sides:
        """Lower and upper end of every coordinate, both ρ included."""
        out = [
            (Fraction(a, TICKS), Fraction(b, TICKS))
            for a, b in zip(self.low, self.high, strict=True)
        ]
        for h, t, _ in cubic.rho:
            most = out[h][1] ** 2 / out[t][0] if out[t][0] else out[h][1]
            least = out[h][0] ** 2 / out[t][1] if out[t][1] else Fraction(0)
            out.append((least, max(least, min(most, out[h][1]))))
        return out

    def narrow(self, cubic: Cubic, clock: Clock) -> None:
        """Narrow the ranges by the limits, then by the equations (`_Centre`)."""
        sides = self.sides(cubic)
        self._from_limits(cubic, sides)
        if any(sides[t][0] <= 0 for t, _ in cubic.moving.values()):
            return
        centre = _Centre(cubic, sides, clock)
        if not centre.inverse:
            return
        change = centre.change()
        for j, row in enumerate(self.x):
            if None not in row:
                self._contract(j, *centre.offset(j), change)

    def _from_limits(self, cubic: Cubic, sides: Sides) -> None:
        """|v| and |a| by the limits, Markov's inequality, and jerk since a rest of a.

        A parabola within ±V on a length h has |slope| ≤ 8V/h (2n²/h for degree n).
        """
        n = cubic.n
        least, most = (
            [
                sum(x * sides[c][0 if (x > 0) == lower else 1] for c, x in piece.items())
                for piece in cubic.lengths
            ]
            for lower in (True, False)
        )
        reach = [max([0, *(least[k] for k in (b - 1, b) if 0 <= k < n)]) for b in range(n + 1)]
        if cubic.virtual:
            reach[1] = max(reach[1], sides[0][0] / 2)
            reach[n - 1] = max(reach[n - 1], sides[cubic.m - 1][0] / 2)
        for j in range(cubic.joints):
            v, a = cubic.fastest(j)
            jerk = cubic.limits[j][2]
            for b in range(n + 1):
                bounds = [a]
                if v is not None and reach[b]:
                    bounds.append(8 * v / reach[b])
                for order, since in zip(cubic.ends, (most[:b], most[b:]), strict=True):
                    if jerk is not None and order != 1:
                        bounds.append(jerk * sum(since))
                self._cut(j, b, bounds)
            for w in range(n + 1, cubic.size):
                self._cut(j, w, [v])

    def _cut(self, j: int, v: int, bounds: list[Fraction | None]) -> None:
        """|x| is at most each of the bounds."""
        least = least_of(bounds)
        if least is not None:
            most = ceil(least * FINE)
            self._between(j, v, -most, most)

    def _between(self, j: int, v: int, low: int, high: int) -> None:
        old = self.x[j][v]
        new = (low, high) if old is None else (max(low, old[0]), min(high, old[1]))
        self.x[j][v] = new
        self.empty |= new[0] > new[1]

    def _contract(
        self, j: int, middle: list[int], offset: list[int], change: list[list[int]]
    ) -> None:
        """|x − middle| ≤ offset + change·|x − middle|, again and again."""
        step = _INNER // FINE
        base = [_up(x, _INNER**3 // FINE) for x in offset]
        for _ in range(_ROUNDS):
            both = zip((r for r in self.x[j] if r is not None), middle, strict=True)
            radius = [_up(max(abs(a * step - x), abs(b * step - x)), step) for (a, b), x in both]
            for v, line in enumerate(change):
                reach = base[v] + _up(sum(map(mul, line, radius)), _INNER)
                self._between(j, v, middle[v] // step - reach, _up(middle[v], step) + reach)
            if self.empty:
                return


class _Centre:
    """The equations at the centre c of a box, and what they say all over it.

    With M(y) = M(c) + Σ (y_k − c_k)B_k, Y ≈ M(c)⁻¹ and x̃ ≈ Y b(c), M(y)x = b(y) says (Krawczyk)

        x − x̃ = Y(b(c) − M(c)x̃) + Y Σ (y_k − c_k)(b'_k − B_k x̃)
                + (I − Y M(c) − Σ (y_k − c_k) Y B_k)(x − x̃),

    b'_k the slope of b from c_k to y_k. The first line is `offset`, the second `change`. Numbers
    are in multiples of 1/_INNER.
    """

    def __init__(self, cubic: Cubic, sides: Sides, clock: Clock) -> None:
        self.cubic, self.clock = cubic, clock
        self.ends = [(floor(a * _INNER), ceil(b * _INNER)) for a, b in sides]
        self.centre = [(a + b) // 2 for a, b in self.ends]
        self.half = [b - c for (_, b), c in zip(self.ends, self.centre, strict=True)]
        self.rows: list[dict[int, int]] = [{} for _ in range(cubic.size)]
        self.linear: list[list[tuple[int, int, int]]] = [[] for _ in sides]
        for i, equation in enumerate(cubic.equations):
            for key, a in equation.items():
                v, factor = key, _INNER
                if not isinstance(key, int):
                    k, v = key
                    factor = self.centre[k]
                    self.linear[k].append((i, v, a))
                self.rows[i][v] = self.rows[i].get(v, 0) + a * factor
        self.inverse = self._inverse()

    def _inverse(self) -> list[list[int]]:
        """Y, by Gauss-Jordan elimination in floats; empty if they find none."""
        n = len(self.rows)
        table = [
            [row.get(v, 0) / _INNER for v in range(n)] + [float(i == v) for v in range(n)]
            for i, row in enumerate(self.rows)
        ]
        for k in range(n):
            self.clock.check()
            pivot = max(range(k, n), key=lambda i: abs(table[i][k]))
            table[k], table[pivot] = table[pivot], table[k]
            scale = table[k][k]
            if not scale:
                return []
            table[k] = [x / scale for x in table[k]]
            for i in range(n):
                factor = table[i][k]
                if i != k and factor:
                    table[i] = [x - factor * z for x, z in zip(table[i], table[k], strict=True)]
        found = [[x * _INNER for x in line[n:]] for line in table]
        known = all(isfinite(x) for line in found for x in line)
        return [[int(x) for x in line] for line in found] if known else []

    def change(self) -> list[list[int]]:
        """|I − Y M(c)| + Σ half_k |Y B_k|, [unknown][unknown]."""
        out = []
        for r, line in enumerate(self.inverse):
            self.clock.check()
            left = [0] * len(line)
            left[r] = _INNER**2
            for factor, row in zip(line, self.rows, strict=True):
                for v, x in row.items():
                    left[v] -= factor * x
            total = [abs(x) for x in left]
            for entries, width in zip(self.linear, self.half, strict=True):
                moved: dict[int, int] = {}
                for i, v, x in entries:
                    moved[v] = moved.get(v, 0) + line[i] * x
                for v, x in moved.items():
                    total[v] += width * abs(x)
            out.append([_up(x, _INNER) for x in total])
        return out

    def offset(self, joint: int) -> tuple[list[int], list[int]]:
        """x̃ of a joint, and how far the first line of the equation goes, in 1/_INNER³."""
        force = {
            t: (i, sign * 6 * self.cubic.steps[t][joint])
            for i, (t, sign) in self.cubic.moving.items()
        }
        right = [0] * len(self.rows)
        for t, (i, f) in force.items():
            right[i] = f.numerator * _INNER**2 // (f.denominator * self.centre[t])
        x = [sum(map(mul, line, right)) // _INNER for line in self.inverse]
        miss = [
            b * _INNER - sum(a * x[v] for v, a in row.items())
            for b, row in zip(right, self.rows, strict=True)
        ]
        pulls: list[tuple[int, list[dict[int, int]]]] = []
        for k, (entries, width) in enumerate(zip(self.linear, self.half, strict=True)):
            pull: dict[int, int] = {}
            for i, v, a in entries:
                pull[i] = pull.get(i, 0) + a * x[v]
            both = [pull, dict(pull)]
            if k in force:
                # (1/T − 1/c) = −(T − c)/(cT), for T at either end.
                i, f = force[k]
                for own, side in zip(both, self.ends[k], strict=True):
                    slope = f.numerator * _INNER**3 // (f.denominator * self.centre[k] * side)
                    own[i] = own.get(i, 0) + slope
            pulls.append((width, both))
        out = []
        for line in self.inverse:
            self.clock.check()
            total = abs(sum(map(mul, line, miss)))
            for width, both in pulls:
                total += width * max(abs(sum(line[i] * p for i, p in one.items())) for one in both)
            # What each entry of b(c), and each slope, lost in being rounded down.
            out.append(total + sum(map(abs, line)) * (_INNER + sum(self.half)))
        return x, out


def _up(x: int, unit: int) -> int:
    """A quotient, rounded up."""
    return -(-x // unit)
