"""A C4 quintic search in parts: the tree of one search, wherever and in whatever order they run."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from support.executors import LastFirst
from trajgap.nlp.proofs import crew
from trajgap.nlp.proofs.certifiers import certify
from trajgap.nlp.proofs.clock import RunClock
from trajgap.nlp.proofs.crew import ProofCrew
from trajgap.nlp.proofs.driver import grow
from trajgap.nlp.proofs.exact import exact_problem
from trajgap.nlp.proofs.outcome import Request
from trajgap.nlp.proofs.quintic import certifier, subtrees
from trajgap.nlp.proofs.quintic.leaves import Leaves
from trajgap.nlp.proofs.quintic.search import DONE, search
from trajgap.nlp.proofs.session import Session, Shorter
from trajgap.problem import Limits, Problem, TrajgapError, quintic_spline
from trajgap.verify import OutOfTime

PROBLEM = Problem(
    np.array([[0.1, 0.5], [0.9, -0.2], [0.4, 0.3], [1.3, 0.7]]),
    Limits([1.0, 1.3], [2.1, 1.7], [11.0, 9.0]),
    quintic_spline(3),
)


def session(some: ProofCrew | None = None, seconds: float = np.inf) -> Session:
    return Session(
        exact_problem(PROBLEM), Request(clock=RunClock(seconds), crew=some or ProofCrew())
    )


def stage(
    total: float, some: ProofCrew | None = None, **sizes: int
) -> tuple[subtrees.Stage, Leaves]:
    """The tree that proves ``total`` times the best total that is known."""
    one = session(some)
    assert one.seek()
    kind = certifier.Stages(one)
    tree_total = kind.rounded(one.upper * Fraction(total))
    question = subtrees.Stage(
        kind.steps, kind.limits, float(tree_total), kind.library.terms, 0.0, **sizes
    )
    return question, leaves_of(question, one)


def root_of(question: subtrees.Stage) -> subtrees.Root:
    lowest = certifier.shortest(exact_problem(PROBLEM))
    return subtrees.Root(np.array([float(x) for x in lowest]), np.full(3, question.total))


def leaves_of(
    question: subtrees.Stage,
    one: Session,
    look: Callable[[np.ndarray], bool] = lambda _: True,
    watch: Callable[[int, int], None] = lambda *_: None,
) -> Leaves:
    parts = subtrees.Parts(question, look, watch)
    grow(parts, [root_of(question)], one)
    return parts.leaves


def same(a: Leaves, b: Leaves) -> bool:
    return all(np.array_equal(x, y) for x, y in zip(a.arrays, b.arrays, strict=True))


def whole(question: subtrees.Stage) -> Leaves:
    """The same tree by one call of the kernel."""
    n, joints = question.steps.shape
    low, high = np.zeros((600, n)), np.zeros((600, n))
    low[0], high[0] = root_of(question).low, question.total
    leaves = Leaves.empty((1 << 18, 1 << 18, 1 << 20))
    code = search(
        n, joints, question.steps, question.limits, question.total, question.windows,
        low, high, np.array([1]), 10**7, 0.0, *leaves.arrays, np.zeros(3, np.int64),
    )  # fmt: skip
    assert code == DONE
    return leaves.trimmed()


SMALL = {"part": 8}


@pytest.fixture
def at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """Processes are started for the first pieces."""
    monkeypatch.setattr(crew.ProofCrew, "worth", 0.0)


def test_parts_join_to_the_tree_of_one_search(monkeypatch: pytest.MonkeyPatch) -> None:
    question, here = stage(0.9995, **SMALL)
    assert int(here.sizes[0]) > 10 * 8, "too few boxes for many parts"
    assert same(here, whole(question))
    with ThreadPoolExecutor(3) as threads:
        assert same(here, stage(0.9995, ProofCrew(3, threads), **SMALL)[1])
    late, waited = LastFirst(), crew.wait

    def finishing(futures: Any, timeout: float) -> Any:
        late.finish(1)
        return waited(futures, 0.0)

    monkeypatch.setattr(crew, "wait", finishing)
    assert same(here, stage(0.9995, ProofCrew(4, late), **SMALL)[1])


@pytest.mark.usefixtures("at_once")
def test_parts_run_in_other_processes() -> None:
    _, here = stage(0.9995, **SMALL)
    with ProofCrew(2) as some:
        assert same(here, stage(0.9995, some, **SMALL)[1])
        assert some.processes == 2


def test_the_first_in_preorder_ends_the_search() -> None:
    """Directions that seem to be shorter are looked at wherever they turn up; the first decides."""
    question, _ = stage(0.9, **SMALL)
    question = replace(question, look=1.3 * question.total)

    def shorter(some: ProofCrew) -> np.ndarray:
        asked = 0

        def look(durations: np.ndarray) -> bool:
            nonlocal asked
            asked += 1
            if durations[0] > durations[2]:  # true of some boxes, not of the first
                raise Shorter(durations)
            return True

        with pytest.raises(Shorter) as found:
            leaves_of(question, session(some), look)
        assert asked > 1
        return found.value.durations

    first = shorter(ProofCrew())
    with ThreadPoolExecutor(3) as threads:
        for _ in range(3):
            assert np.array_equal(first, shorter(ProofCrew(3, threads)))


def test_a_tree_that_is_too_deep_ends_it() -> None:
    with pytest.raises(OutOfTime):
        stage(0.9995, stack=4)


def test_the_clock_ends_it_and_leaves_nothing_waiting(monkeypatch: pytest.MonkeyPatch) -> None:
    asked = 0

    def watch(waiting: int, boxes: int) -> None:
        nonlocal asked
        asked += 1
        if asked > 3:
            raise OutOfTime

    question, _ = stage(0.9995, **SMALL)
    late, waited, every = LastFirst(), crew.wait, set[Any]()

    def finishing(futures: Any, timeout: float) -> Any:
        every.update(future for future, _ in late.held)
        late.finish(1)
        return waited(futures, 0.0)

    monkeypatch.setattr(crew, "wait", finishing)
    with pytest.raises(OutOfTime):
        leaves_of(question, session(ProofCrew(2, late)), watch=watch)
    assert asked == 4
    assert len(every) > 3
    assert all(future.done() for future in every)


def test_a_part_ends_with_the_time_of_its_search() -> None:
    question, _ = stage(0.9995)
    assert subtrees.search_part(question, root_of(question)).boxes > 100
    one = session(seconds=1e-9)
    with one.searching():
        late = subtrees.search_part(question, root_of(question))
    assert late.boxes <= question.between_looks
    with pytest.raises(OutOfTime):
        leaves_of(question, one)


def test_long_splines_are_looked_at_as_often_as_short_ones() -> None:
    def between(segments: int) -> int:
        steps = np.zeros((segments, 1))
        return subtrees.Stage(steps, np.zeros((1, 3)), 1.0, np.zeros(0), 0.0).between_looks

    assert between(2) == between(8) == 500
    boxes = [between(n) for n in range(8, 27)]
    assert boxes == sorted(boxes, reverse=True)
    # A box takes time of the third power.
    assert all(k * n**3 <= boxes[0] * 8**3 for n, k in enumerate(boxes, 8))
    assert boxes[-1] >= 1


def test_workers_are_counted_from_one() -> None:
    with pytest.raises(TrajgapError, match="workers must be 1 or more"):
        certify(PROBLEM, workers=0)
