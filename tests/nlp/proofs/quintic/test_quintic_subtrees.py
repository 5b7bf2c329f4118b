"""A C4 quintic search in parts: the tree of one search, wherever and in whatever order they run."""

from __future__ import annotations

import multiprocessing
from collections.abc import Callable
from concurrent.futures import Executor, Future, ProcessPoolExecutor, ThreadPoolExecutor
from fractions import Fraction
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from support.executors import LastFirst
from trajgap.nlp.proofs.certifiers import certify
from trajgap.nlp.proofs.exact import exact_problem
from trajgap.nlp.proofs.executors import Here
from trajgap.nlp.proofs.outcome import Outcome, Request
from trajgap.nlp.proofs.quintic import certifier, subtrees
from trajgap.nlp.proofs.quintic.leaves import Leaves
from trajgap.nlp.proofs.quintic.search import DONE, PAUSED, search
from trajgap.nlp.proofs.session import OutOfTime, Session, Shorter
from trajgap.problem import Limits, Problem, TrajgapError, quintic_spline

PROBLEM = Problem(
    np.array([[0.1, 0.5], [0.9, -0.2], [0.4, 0.3], [1.3, 0.7]]),
    Limits([1.0, 1.3], [2.1, 1.7], [11.0, 9.0]),
    quintic_spline(3),
)


def stage(total: float, executor: Executor, workers: int) -> tuple[subtrees.Stage, Leaves]:
    """The tree that proves ``total`` times the best total that is known."""
    session = Session(exact_problem(PROBLEM), Request(seconds=1e6, workers=workers))
    assert session.seek()
    kind = certifier._Search(session, executor)
    upper = session.upper
    tree = kind.stage(kind.rounded(upper * Fraction(total)))
    question = subtrees.Stage(kind.steps, kind.limits, float(tree.total), kind.library.terms, 0.0)
    return question, tree.leaves


def same(a: Leaves, b: Leaves) -> bool:
    return all(np.array_equal(x, y) for x, y in zip(a.arrays, b.arrays, strict=True))


def whole(question: subtrees.Stage) -> Leaves:
    """The same tree by one call of the kernel."""
    n, joints = question.steps.shape
    low, high = np.zeros((600, n)), np.zeros((600, n))
    lowest = certifier.shortest(exact_problem(PROBLEM))
    low[0], high[0] = [float(x) for x in lowest], question.total
    leaves = Leaves.empty((1 << 18, 1 << 18, 1 << 20))
    code = search(
        n, joints, question.steps, question.limits, question.total, question.windows,
        low, high, np.array([1]), 10**7, 0.0, *leaves.arrays, np.zeros(3, np.int64),
    )  # fmt: skip
    assert code == DONE
    return leaves.trimmed()


@pytest.fixture
def small_parts(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(subtrees, "_PART", 8)
    monkeypatch.setattr(subtrees, "_CHUNK", 4)


@pytest.mark.usefixtures("small_parts")
def test_parts_join_to_the_tree_of_one_search(monkeypatch: pytest.MonkeyPatch) -> None:
    question, here = stage(0.9995, Here(), 1)
    assert int(here.sizes[0]) > 10 * 8, "too few boxes for many parts"
    assert same(here, whole(question))
    with ThreadPoolExecutor(3) as threads:
        assert same(here, stage(0.9995, threads, 3)[1])
    late = LastFirst()
    waited = subtrees.wait

    def finishing(running: Any, timeout: float, when: str) -> Any:
        late.finish()
        return waited(running, timeout, when)

    monkeypatch.setattr(subtrees, "wait", finishing)
    assert same(here, stage(0.9995, late, 4)[1])


def test_parts_run_in_other_processes() -> None:
    _, here = stage(0.9, Here(), 1)
    with ProcessPoolExecutor(2, multiprocessing.get_context("spawn")) as processes:
        assert same(here, stage(0.9, processes, 2)[1])


@pytest.mark.usefixtures("small_parts")
def test_the_first_in_preorder_ends_the_search() -> None:
    """Directions that seem to be shorter are looked at wherever they turn up; the first decides."""
    question, _ = stage(0.9, Here(), 1)
    question = subtrees.Stage(
        question.steps, question.limits, question.total, question.windows, 1.3 * question.total
    )
    root = subtrees.Root(
        np.array([float(x) for x in certifier.shortest(exact_problem(PROBLEM))]),
        np.full(3, question.total),
    )

    def shorter(executor: Executor, workers: int) -> np.ndarray:
        asked = 0

        def look(durations: np.ndarray) -> bool:
            nonlocal asked
            asked += 1
            if durations[0] > durations[2]:  # true of some boxes, not of the first
                raise Shorter(durations)
            return True

        with pytest.raises(Shorter) as found:
            subtrees.search_all(question, root, look, lambda *_: 60.0, executor, workers)
        assert asked > 1
        return found.value.durations

    first = shorter(Here(), 1)
    with ThreadPoolExecutor(3) as threads:
        for _ in range(3):
            assert np.array_equal(first, shorter(threads, 3))


def test_a_tree_that_is_too_deep_ends_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(subtrees, "_STACK", 4)
    with pytest.raises(OutOfTime):
        stage(0.9995, Here(), 1)


@pytest.mark.usefixtures("small_parts")
def test_the_clock_ends_it_and_leaves_nothing_waiting() -> None:
    asked = 0

    def watch(waiting: int, boxes: int) -> float:
        nonlocal asked
        asked += 1
        if asked > 2:
            raise OutOfTime
        return 60.0

    question, _ = stage(0.9995, Here(), 1)
    lowest = certifier.shortest(exact_problem(PROBLEM))
    root = subtrees.Root(np.array([float(x) for x in lowest]), np.full(3, question.total))
    late = LastFirst()
    with pytest.raises(OutOfTime):
        subtrees.search_all(question, root, lambda _: True, watch, late, 2)
    assert asked == 3
    assert late.held
    assert all(future.cancelled() for future, _ in late.held)


def test_a_part_that_waited_for_its_turn_ends_when_all_do(monkeypatch: pytest.MonkeyPatch) -> None:
    """What is handed out ahead begins late, and has no more time than what was handed out first."""
    question, _ = stage(0.9995, Here(), 1)
    lowest = certifier.shortest(exact_problem(PROBLEM))
    root = subtrees.Root(np.array([float(x) for x in lowest]), np.full(3, question.total))
    monkeypatch.setattr(subtrees, "_CHUNK", 4)
    monkeypatch.setattr(
        subtrees, "time", SimpleNamespace(time=lambda: 100.0, monotonic=lambda: 5.0)
    )
    assert subtrees.search_part(question, root, 60.0, 100.0 + 1.0).boxes > 100
    late = subtrees.search_part(question, root, 60.0, 100.0 - 1.0)
    assert (late.code, late.boxes) == (PAUSED, 4)
    asked: list[float] = []

    class Noting(Here):
        def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
            asked.append(args[-1])
            return super().submit(fn, *args, **kwargs)

    subtrees.search_all(question, root, lambda _: True, lambda *_: 7.0, Noting(), 1)
    assert set(asked) == {107.0}


def test_long_splines_are_looked_at_as_often_as_short_ones() -> None:
    assert subtrees.between_looks(2) == subtrees.between_looks(8) == subtrees._CHUNK
    boxes = [subtrees.between_looks(n) for n in range(8, 27)]
    assert boxes == sorted(boxes, reverse=True)
    # A box takes time of the third power.
    assert all(k * n**3 <= boxes[0] * 8**3 for n, k in enumerate(boxes, 8))
    assert boxes[-1] >= 1


def test_the_result_is_the_same_on_two_threads() -> None:
    one, two = (certify(PROBLEM, gap=0.05, seconds=1e6, workers=workers) for workers in (1, 2))
    assert one.outcome is two.outcome is Outcome.CERTIFIED
    assert (one.lower, one.upper, one.durations) == (two.lower, two.upper, two.durations)
    assert one.proof.document() == two.proof.document()


def test_workers_are_counted_from_one() -> None:
    with pytest.raises(TrajgapError, match="workers must be 1 or more"):
        certify(PROBLEM, workers=0)
