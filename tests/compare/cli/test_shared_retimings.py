"""A path is timed once, however many readings leave a joint the same optimum."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from trajgap.compare.cli import solving
from trajgap.nlp import Solution, Status
from trajgap.nlp.retiming import retime
from trajgap.problem import Limits, Problem, fit, three_five_three


def test_the_same_motion_within_the_same_limits_is_timed_once(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    asked = []
    monkeypatch.setattr(solving, "retime", lambda *given: asked.append(given) or retime(*given))
    q = np.array([[0.13], [0.81], [0.32], [1.07]])
    problem = Problem(q, Limits([1.6], [4.0]), three_five_three())
    answer = Solution(problem, Status.FEASIBLE, durations=np.array([1.3, 1.1, 1.7]))
    longer = replace(answer, durations=np.array([1.3, 1.1, 1.8]))
    bounded = replace(answer, problem=replace(problem, duration_lower=np.full(3, 0.3)))
    slower = replace(answer, problem=replace(problem, limits=Limits([1.6], [3.0])))
    mirrored = replace(answer, problem=replace(problem, waypoints=-q))
    known: solving._Retimings = {}
    found = [
        solving._retimed(one, known) for one in (answer, longer, bounded, slower, mirrored, answer)
    ]
    assert len(asked) == 4
    assert found[2] is found[0] is found[5]
    for one, said in zip((answer, longer, bounded, slower, mirrored), found, strict=False):
        problem, h = one.problem, one.durations
        alone = retime(fit(problem.curve, problem.waypoints, h), problem.limits)
        assert str(said) == str(alone)
