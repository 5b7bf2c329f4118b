"""Least durations of segments: none above those of a motion that keeps the limits, some equal."""

from fractions import Fraction
from itertools import pairwise

import pytest
from trajgap.verify.floors import least_durations
from trajgap.verify.problem import Declaration, StatedProblem

REST = {1: [Fraction(0)]}
CALM = REST | {2: [Fraction(0)]}
TINY = Fraction(1, 1000)


def motion(order: int, values: list[int], h: list[Fraction]) -> list[Fraction]:
    """Positions at the breaks where a derivative has these values, one on each piece, from rest."""
    state, found = [Fraction(0)] * order, [Fraction(0)]
    for value, step in zip(values, h, strict=True):
        terms = [*state, Fraction(value)]
        for r in range(order):
            state[r] = sum(
                (x * step**k / (1, 1, 2, 6)[k] for k, x in enumerate(terms[r:])), Fraction(0)
            )
        found.append(state[0])
    return found


def question(
    q: list[Fraction],
    limits: dict[int, Fraction],
    continuity: int,
    start: dict[int, list[Fraction]],
    finish: dict[int, list[Fraction]],
) -> StatedProblem:
    """Of one joint; limits by order, lower ones of velocity under −1."""
    n = len(q) - 1
    sizes = [(limits[r], limits[r]) if r in limits else None for r in (1, 2, 3)]
    below = [(limits[-1], limits[-1]) if -1 in limits else sizes[0], *sizes[1:]]
    larger = [None if x is None or y is None else max(x, y) for x, y in zip(sizes, below)]  # noqa: B905
    declared = Declaration([3] * n, [continuity] * (n - 1), [start, *[{}] * (n - 1), finish], [])
    return StatedProblem(
        [[x] for x in q], [larger], [[below], [sizes]], [[None], [None]],
        [Fraction(0)] * n, [None] * n, declared, None, [[None], [None]],
    )  # fmt: skip


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize(
    ("order", "values", "h", "smooth", "end", "equal"),
    [
        # All the way at the limit of speed.
        (1, [1, 1], [1, 2], 0, {}, (0, 1)),
        # Speeding up and braking; the segments beside the peak go at nearly A·total/2.
        (2, [1, 1, -1, -1], [1, TINY, TINY, 1], 1, REST, (0, 1, 2, 3)),
        (3, [1, -1, -1, 1], [1, 1, 1, 1], 2, CALM, (0, 3)),
        # Two jerks between which the speed is nearly constant, and a short segment there.
        (3, [1, -1, 0, -1, 1], [1, 1, TINY, 1, 1], 2, CALM, (0, 4)),
    ],
)
def test_a_motion_that_keeps_its_limits_takes_no_less(order, values, h, smooth, end, equal, sign):
    h = [Fraction(x) for x in h]
    q = [sign * 7 * x for x in motion(order, values, h)]
    found = least_durations(question(q, {order: Fraction(7)}, smooth, end, end), sum(h))
    assert all(least <= own for least, own in zip(found, h, strict=True))
    assert all(found[k] >= h[k] * (1 - TINY) for k in equal)


@pytest.mark.parametrize(("u", "w"), [(0, 0), (3, 3), (-3, -3), (5, -2), (-1, 4)])
def test_with_limited_jerk_no_motion_is_faster_than_the_parabola_over_its_chord(u, w):
    """v = u + (w − u)t/T ± J t(T − t)/2 has the largest speed that J allows, at every t."""
    total, jerk = Fraction(4), Fraction(7)
    ends = {1: [Fraction(u)]}, {1: [Fraction(w)]}
    for sign in (1, -1):

        def place(t, sign=sign):
            return u * t + (w - u) * t**2 / (2 * total) + sign * jerk * (
                total * t**2 / 4 - t**3 / 6
            )  # fmt: skip

        at = [x * total / 40 for x in range(41)]
        h = [b - a for a, b in pairwise(at)]
        problem = question([place(Fraction(x)) for x in at], {3: jerk}, 2, *ends)
        found = least_durations(problem, total)
        assert all(least <= own for least, own in zip(found, h, strict=True))
        if u == w and sign * u >= 0:
            assert max(least / own for least, own in zip(found, h, strict=True)) > 1 - TINY


def test_each_direction_has_its_own_limit_of_speed():
    limits = {1: Fraction(2), -1: Fraction(5)}
    q = [Fraction(0), Fraction(6), Fraction(-4)]
    assert least_durations(question(q, limits, 0, {}, {}), Fraction(99)) == [3, 2]


@pytest.mark.parametrize(
    ("limited", "continuity", "start", "finish"),
    [
        # It moves at an end,
        (2, 1, REST, {}),
        (2, 1, {}, REST),
        # its speed jumps,
        (2, 0, REST, REST),
        # its acceleration jumps,
        (3, 1, REST, REST),
        # it moves at an end.
        (3, 2, REST, {}),
        (3, 2, {}, REST),
    ],
)
def test_nothing_follows_where_speed_may_come_from_elsewhere(limited, continuity, start, finish):
    """A limit so small that with ends at rest no such way were possible in the time."""
    q = [Fraction(x) for x in (0, 1, 2, 3)]
    problem = question(q, {limited: TINY}, continuity, start, finish)
    assert least_durations(problem, Fraction(3))[1] == 0
