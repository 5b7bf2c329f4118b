"""A search through boxes in parts: the same tree, wherever and in whatever order they run."""

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from fractions import Fraction
from functools import cache

import numpy as np
import pytest
from support.papers.motions import FAMILIES
from support.proof_runs import LastFirst
from trajgap.nlp.clock import RunClock
from trajgap.nlp.proofs.certifiers import certify
from trajgap.nlp.proofs.crew import ProofCrew
from trajgap.nlp.proofs.declared import search
from trajgap.nlp.proofs.declared.certifier import BoxStages
from trajgap.nlp.proofs.driver import grow
from trajgap.nlp.proofs.exact import exact_problem
from trajgap.nlp.proofs.outcome import Request
from trajgap.nlp.proofs.quintic.certifier import QuinticStages
from trajgap.nlp.proofs.session import Session, Shorter
from trajgap.problem import Limits, Problem, TrajgapError, quintic_spline
from trajgap.verify import OutOfTime

LIMITS = Limits([1.0, 1.3], [2.1, 1.7], [11.0, 9.0])
PROBLEM = Problem([[0.1, 0.5], [0.9, -0.2], [0.4, 0.3], [1.3, 0.7]], LIMITS, quintic_spline(3))
KINDS = pytest.mark.parametrize("stages", [BoxStages, QuinticStages])


@cache
def best() -> tuple[Fraction, ...]:
    """A good answer."""
    one = Session(exact_problem(PROBLEM), Request())
    one.seek()
    assert one.durations is not None
    return one.durations


def session(some: ProofCrew | None = None, seconds: float = np.inf) -> Session:
    it = Session(exact_problem(PROBLEM), Request(clock=RunClock(seconds), crew=some or ProofCrew()))
    it.durations = best()
    return it


def curves_of(stages: type[BoxStages], part: int = 8) -> search.Curves:
    """What is said of boxes for a total just below the best that is known, in small parts."""
    own = stages(session())
    total = sum(best()) * Fraction(9995, 10000)
    curves, _, _ = own.curves(own.rounded(total) if stages is QuinticStages else total)
    curves.part = part
    return curves


def found_of(
    curves: search.Curves,
    one: Session,
    look: Callable[[np.ndarray], None] = lambda _: None,
    watch: Callable[[int, int], None] = lambda *_: None,
) -> search.Found:
    boxes = search.BoxSearch(curves, look, watch)
    boxes.least = 4
    grow(boxes, [[(1, curves.kind.root())]], one)
    return boxes.found


@KINDS
def test_parts_join_to_one_tree(stages: type[BoxStages], monkeypatch: pytest.MonkeyPatch) -> None:
    curves = curves_of(stages)
    here = found_of(curves, session())
    assert len(here.cuts) > 5 * 8, "too few boxes for many parts"
    with ThreadPoolExecutor(3) as threads:
        assert here == found_of(curves, session(ProofCrew(3, threads)))
    assert here == found_of(curves, session(ProofCrew(4, LastFirst(monkeypatch))))
    # Every cut has both its parts, and every part is cut or excluded.
    below = {child for node in here.cuts for child in (2 * node, 2 * node + 1)}
    assert below | {1} == {*here.cuts, *here.leaves}
    assert not set(here.cuts) & set(here.leaves)


@KINDS
@pytest.mark.usefixtures("at_once")
def test_parts_run_in_other_processes(stages: type[BoxStages]) -> None:
    curves = curves_of(stages)
    here = found_of(curves, session())
    with ProofCrew(2) as some:
        assert here == found_of(curves, session(some))
        assert some.processes == 2


def test_directions_are_looked_at_in_the_same_order_anywhere() -> None:
    curves = curves_of(QuinticStages)

    def shorter(some: ProofCrew) -> np.ndarray:
        asked = 0

        def look(durations: np.ndarray) -> None:
            nonlocal asked
            asked += 1
            if asked > 2:
                raise Shorter(durations)

        with pytest.raises(Shorter) as found:
            found_of(curves, session(some), look)
        return found.value.durations

    first = shorter(ProofCrew())
    with ThreadPoolExecutor(3) as threads:
        for _ in range(3):
            assert np.array_equal(first, shorter(ProofCrew(3, threads)))


@pytest.mark.parametrize("place", ["MOST_DEPTH", "_NARROW"])
def test_boxes_that_are_too_small_end_it(place: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(search, place, {"MOST_DEPTH": 4, "_NARROW": 10.0}[place])
    with pytest.raises(search.TooSmall):
        found_of(curves_of(QuinticStages), session())
    with pytest.raises(OutOfTime):
        QuinticStages(session()).stage(Fraction(4))


def test_the_clock_ends_it_and_leaves_nothing_waiting(monkeypatch: pytest.MonkeyPatch) -> None:
    asked = 0

    def watch(waiting: int, boxes: int) -> None:
        nonlocal asked
        asked += 1
        if asked > 5:
            raise OutOfTime

    late = LastFirst(monkeypatch)
    with pytest.raises(OutOfTime):
        found_of(curves_of(QuinticStages), session(ProofCrew(2, late)), watch=watch)
    assert asked == 6
    assert len(late.handed) > 3
    assert all(future.done() for future in late.handed)


def test_a_part_ends_with_the_time_of_its_search() -> None:
    curves = curves_of(QuinticStages, part=10**6)
    root = [(1, curves.kind.root())]
    assert search.search_part(curves, root).found.boxes > 100
    one = session(seconds=1e-9)
    with one.searching():
        assert search.search_part(curves, root).found.boxes == 1
    with pytest.raises(OutOfTime):
        found_of(curves, one)


@KINDS
def test_the_middle_of_a_box_is_the_spline_there(stages: type[BoxStages]) -> None:
    """Against scipy: pieces, and their change with the logarithm of each duration."""
    curves = curves_of(stages)
    h, way = np.array([0.5, 0.35, 0.7]) * float(curves.kind.most), PROBLEM.waypoints
    step = 1e-5

    def middle(at: np.ndarray) -> search.Middle:
        return curves.middle(np.array([[at * 0.98, at / 0.98]]))

    def spline(at: np.ndarray) -> np.ndarray:
        return FAMILIES["C4 quintic"].fit(way - way[0], at).coefficients

    own = middle(h)
    assert own.h[0] == pytest.approx(h, rel=1e-3)
    largest = np.abs(spline(own.h[0])).max(axis=(0, 1)) / np.abs(own.pieces[0]).max(axis=(0, 1))
    unit = 2.0 ** np.rint(np.log2(largest))
    np.testing.assert_allclose(own.pieces[0][:, 1:] * unit, spline(own.h[0])[:, 1:], atol=1e-6)
    for m in range(3):
        there = [own.h[0] * np.exp(step * sign * (np.arange(3) == m)) for sign in (-1, 1)]
        slope = (spline(there[1]) - spline(there[0]))[:, 1:] / (2 * step)
        np.testing.assert_allclose(own.moved[0, m][:, 1:] * unit, slope, atol=1e-4)


def test_workers_are_counted_from_one() -> None:
    with pytest.raises(TrajgapError, match="workers must be 1 or more"):
        certify(PROBLEM, workers=0)
