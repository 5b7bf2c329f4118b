"""Ratios of durations as part of a question."""

from __future__ import annotations

import pickle
from dataclasses import replace

import numpy as np
import pytest
from trajgap.nlp import problem_seal
from trajgap.problem import Limits, Problem, TrajgapError, cubic_spline, cubic_spline_virtual

Q = np.array([[0.2, -1.0], [0.5, -0.6], [0.5, 0.6]])


def problem_with(ratios: object, **other: object) -> Problem:
    return Problem(Q, Limits(1.0), cubic_spline(2), ratios=ratios, **other)


@pytest.mark.parametrize(
    ("ratios", "shares"),
    [
        ("equal", [0.5, 0.5]),
        ("chord", [0.5 / 1.7, 1.2 / 1.7]),
        ([1, 3], [0.25, 0.75]),
        ([1e200, 3e200], [0.25, 0.75]),
        ((1e-310, 3e-310), [0.25, 0.75]),
    ],
)
def test_their_scale_is_irrelevant(ratios, shares) -> None:
    problem = problem_with(ratios)
    np.testing.assert_allclose(problem.shares, shares, rtol=1e-12)
    for same in (problem.joint(1), problem.hull, replace(problem, name="x")):
        assert same.shares.tolist() == problem.shares.tolist()
    assert pickle.loads(pickle.dumps(problem)).shares.tolist() == problem.shares.tolist()
    assert not problem.ratios.flags.writeable


def test_without_them_each_duration_is_chosen() -> None:
    problem = Problem(Q, Limits(1.0), cubic_spline(2))
    assert problem.ratios is problem.shares is problem.unscaled is None


@pytest.mark.parametrize(
    ("ratios", "said"),
    [
        ([1, 2, 3], r"ratios: expected 2, one per segment, got 3"),
        (1.0, r"ratios: expected 2, one per segment, got 1"),
        ([1, 0], r"ratios: every one must be positive and finite"),
        ([1, np.inf], r"ratios: every one must be positive and finite"),
        ([1, np.nan], r"ratios: every one must be positive and finite"),
        ([1, 1e13], r"ratios: the largest is more than 1e\+12 times the smallest; correct them"),
        ([1, "x"], r'ratios: not numbers; give one per segment, "equal" or "chord"'),
        ("even", r"ratios: 'even' is unknown; give one number per segment"),
    ],
)
def test_bad_ratios_are_one_line(ratios, said: str) -> None:
    with pytest.raises(TrajgapError, match=said):
        problem_with(ratios)


def test_chord_lengths_need_steps_at_every_segment() -> None:
    with pytest.raises(TrajgapError, match="between way-points 2 and 3, which coincide"):
        Problem([[0.0], [1.0], [1.0]], Limits(1.0), cubic_spline(2), ratios="chord")
    with pytest.raises(TrajgapError, match='"chord" needs a way-point at every end of the 4'):
        Problem(Q, Limits(1.0), cubic_spline_virtual(3), ratios="chord")


def test_the_seal_of_a_question_holds_its_ratios() -> None:
    free = Problem(Q, Limits(1.0), cubic_spline(2))
    seals = {
        problem_seal(one)
        for one in (free, problem_with("equal"), problem_with("chord"), problem_with([1, 3]))
    }
    assert len(seals) == 4
    assert problem_seal(problem_with([2, 6])) == problem_seal(problem_with([1, 3]))
    assert problem_seal(problem_with([5, 5])) == problem_seal(problem_with("equal"))
