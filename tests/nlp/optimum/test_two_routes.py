"""The descent and the NLP, which share no search and no derivative, end at the same totals.

Of some problems of every family `test_identities` says so quickly.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress

import numpy as np
import pytest
from trajgap.nlp import Status, with_other_route
from trajgap.nlp.optimum import solve
from trajgap.problem import (
    CaseError,
    Limits,
    Problem,
    cubic_spline,
    load_case,
    piecewise,
    published_ids,
    quintic_spline,
    rest_to_rest,
    septic_spline,
    three_five_three,
)
from trajgap.problem.suite import list_instances, load_instance

SAME = 1e-8
"""Relative difference of the two totals: both are a local optimum to some 1e-10."""


def random_problem(number: int) -> Problem:
    """Up to three joints through a random walk of up to four segments, some within bounds."""
    generator = np.random.default_rng(1000 + number)
    n = int(generator.integers(2, 5))
    curve = (
        three_five_three(),
        piecewise((4, 3, 4)),
        cubic_spline(n),
        quintic_spline(n),
        septic_spline(max(n, 3)),
        rest_to_rest(n, 5),
    )[number % 6]
    joints = int(generator.integers(1, 4))
    q = np.cumsum(generator.normal(size=(curve.segments + 1, joints)), axis=0)
    jerk = generator.uniform(5.0, 60.0, joints) if number % 3 == 0 else np.inf
    limits = Limits(generator.uniform(1, 6, joints), generator.uniform(1, 8, joints), jerk)
    bounds = (0.01, float(generator.uniform(2.0, 6.0))) if number % 5 == 1 else (0.0, np.inf)
    return Problem(q, limits, curve, *bounds)


def published() -> Iterator[Problem]:
    """Every problem of every published case under every reading."""
    for name in published_ids():
        case = load_case(name)
        for problem, reading in case.selections():
            with suppress(CaseError):  # one case prints no way-points
                yield case.problem(problem, reading)


def assert_same(problem: Problem) -> bool:
    """Whether there was a total to set beside another."""
    found = with_other_route(solve(problem))
    if not found.found or found.status is Status.NOT_ATTAINED:
        return False
    assert found.other_total is not None, problem.name
    assert found.other_total == pytest.approx(found.total_time, rel=SAME, abs=0.0), problem.name
    return True


NEIGHBOURS = {1114: 1.2e-4, 1426: 2.5e-4}
"""C6 septics from whose longer motion the NLP goes down into the basin beside, by how much more."""


@pytest.mark.slow
def test_two_thousand_random_problems() -> None:
    rest = [number for number in range(2000) if number not in NEIGHBOURS]
    assert sum(assert_same(random_problem(number)) for number in rest) >= 1900
    for number, more in NEIGHBOURS.items():
        found = with_other_route(solve(random_problem(number)))
        assert found.total_time * (1 - SAME) <= found.other_total <= found.total_time * (1 + more)


@pytest.mark.slow
def test_the_whole_suite_and_every_published_problem() -> None:
    names = [one.name for one in list_instances()]
    assert all(assert_same(load_instance(name).problem()) for name in names)
    assert all(map(assert_same, published()))
