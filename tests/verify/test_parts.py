"""A tree whose parts are judged elsewhere is proved only if every one of them is."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Iterator
from functools import cache
from itertools import islice
from typing import Any

import numpy as np
import pytest
from support.certificate_kinds import text
from trajgap.nlp import certificate, certify
from trajgap.problem import Limits, Problem, cubic_spline
from trajgap.verify import verify_certificate


@cache
def certified(kind: str) -> str:
    """A certificate with parts enough, as JSON."""
    if kind == "quintic-spline":
        return text(kind)
    way = np.array([[0.0, 0.3], [0.7, -0.4], [0.1, 0.9], [0.8, 0.2]])
    problem = Problem(way, Limits(1.0, 2.0, 9.0, joints=2), cubic_spline(3))
    return json.dumps(certificate(certify(problem, gap=1e-3)))


Parts = Iterable[tuple[Any, ...]]
Work = Callable[..., Any]


def here(work: Work, common: Any, parts: Parts) -> Iterator[Any]:
    """Every part, judged in this process."""
    return (work(common, *part) for part in parts)


def backwards(work: Work, common: Any, parts: Parts) -> Iterator[Any]:
    found = [work(common, *part) for part in reversed(list(parts))]
    return reversed(found)


def none_begun(work: Work, common: Any, parts: Parts) -> Iterator[Any]:
    """No part is even asked for."""
    return iter(())


def first_alone(work: Work, common: Any, parts: Parts) -> Iterator[Any]:
    """The others are not asked for."""
    return (work(common, *part) for part in islice(parts, 1))


def lost(work: Work, common: Any, parts: Parts) -> Iterator[Any]:
    """The result of the last part does not come back."""
    return iter([work(common, *part) for part in parts][:-1])


@pytest.mark.parametrize("kind", ["cubic-spline", "quintic-spline"])
@pytest.mark.parametrize("spread", [here, backwards])
def test_parts_prove_what_the_whole_does(kind: str, spread: Any) -> None:
    whole = verify_certificate(json.loads(certified(kind)))
    parts = verify_certificate(json.loads(certified(kind)), spread=spread)
    assert whole.proves
    assert parts == whole


@pytest.mark.parametrize(
    ("kind", "spread"),
    [
        ("cubic-spline", none_begun),
        ("cubic-spline", lost),
        ("quintic-spline", none_begun),
        ("quintic-spline", first_alone),  # the cubic tree is small enough to be one part
        ("quintic-spline", lost),
    ],
)
def test_a_part_that_nobody_judges_proves_nothing(kind: str, spread: Any) -> None:
    verdict = verify_certificate(json.loads(certified(kind)), spread=spread)
    assert not verdict.proves
    assert "a part of the tree was not judged" in verdict.reason
