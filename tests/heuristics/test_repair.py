"""Repair by uniform stretch: the checker's own times, exact accounting, and its limits."""

from dataclasses import replace

import numpy as np
import pytest
from support.two_joints import WITH_JERK, two_joints
from trajgap.heuristics import (
    GA,
    PSO,
    WOA,
    DeathPenalty,
    ImprovedWOA,
    Stretch,
    run,
    run_many,
)
from trajgap.heuristics.repair import judge_of
from trajgap.problem import (
    Limits,
    Problem,
    TrajgapError,
    Verdict,
    check,
    cubic_spline,
    quintic_spline,
)


def problem_with(**changes: object) -> Problem:
    bounds = {"duration_lower": 0.1, "duration_upper": 9.0}
    return two_joints(**{"limits": WITH_JERK, **bounds, **changes})


def test_fitness_is_what_the_checker_calls_feasible_and_tight_time() -> None:
    problem = problem_with(duration_lower=0.0, duration_upper=np.inf)
    batch = np.exp(np.random.default_rng(5).uniform(np.log(0.4), np.log(3.0), (40, 3)))
    repaired, rescaled = Stretch(problem)(batch), Stretch(problem, shorten=True)(batch)
    found = [check(problem, h) for h in batch]
    np.testing.assert_allclose(repaired, [f.feasible_time for f in found], rtol=1e-12)
    np.testing.assert_allclose(rescaled, [f.tight_time for f in found], rtol=1e-12)
    assert 5 < sum(f.verdict is Verdict.PASS for f in found) < 35
    assert (rescaled <= repaired).all()


def test_decoded_durations_keep_every_limit_and_touch_one() -> None:
    problem = problem_with()
    batch = np.random.default_rng(6).uniform(0.15, 0.6, (40, 3))
    for h in Stretch(problem).decode(batch):
        found = check(problem, h)
        assert found.verdict is Verdict.PASS
        assert found.worst is not None
        assert found.worst.ratio == pytest.approx(1.0, abs=1e-12)


def test_what_keeps_the_limits_is_not_touched() -> None:
    problem = problem_with()
    batch = np.random.default_rng(7).uniform(1.5, 3.0, (20, 3))
    assert np.isfinite(DeathPenalty(problem)(batch)).all()
    np.testing.assert_array_equal(Stretch(problem).decode(batch), batch)
    np.testing.assert_array_equal(Stretch(problem)(batch), DeathPenalty(problem)(batch))
    np.testing.assert_array_equal(DeathPenalty(problem).decode(batch), batch)


@pytest.mark.parametrize("penalty", [np.inf, 1e6])
@pytest.mark.parametrize(
    "durations",
    [
        [0.0, 1.5, 1.5],
        [-1.5, 1.5, 1.5],
        [np.nan, 1.5, 1.5],
        [1.5, np.inf, 1.5],
        [1.5, 9.01, 1.5],
        [0.05, 1.5, 1.5],
        [1e-3, 1e-3, 0.5],
    ],
)
def test_what_no_stretch_mends(durations: list[float], penalty: float) -> None:
    """The last one would need more than 9 s in a segment, the one before less than 0.1 s."""
    objective = Stretch(problem_with(duration_upper=[9.0, 9.0, 9.0]), penalty)
    batch = np.array([durations, [1.9, 1.9, 1.9]])
    np.testing.assert_array_equal(objective(batch), [penalty, 1.9 + 1.9 + 1.9])
    np.testing.assert_array_equal(objective.decode(batch), batch)


def test_a_stretch_may_lift_a_duration_over_its_lower_bound() -> None:
    problem = problem_with(duration_lower=0.3)
    h = np.array([[0.2, 0.25, 0.2]])
    assert DeathPenalty(problem)(h)[0] == np.inf
    decoded = Stretch(problem).decode(h)
    assert (decoded >= 0.3).all()
    assert Stretch(problem)(h)[0] == decoded.sum()


@pytest.mark.parametrize(("limits", "shorten"), [([5.0, 0.0], False), ([np.inf, np.inf], True)])
def test_what_has_no_scale(limits: list[float], shorten: bool) -> None:
    """A joint that moves with limit 0 has none that is long enough, no limit none that is short."""
    objective = Stretch(problem_with(limits=Limits(limits), duration_lower=0.0), shorten=shorten)
    assert objective(np.full((1, 3), 1.5))[0] == np.inf


def test_a_prescribed_derivative_cannot_be_stretched() -> None:
    problem = problem_with(curve=cubic_spline(3, ((1, 0.5),)))
    DeathPenalty(problem)
    with pytest.raises(TrajgapError, match=r"^stretch: a prescribed .* use the death penalty"):
        Stretch(problem)


def test_handlings_by_name() -> None:
    assert isinstance(judge_of(problem_with(), np.inf, "death-penalty"), DeathPenalty)
    stretch, rescale = (judge_of(problem_with(), np.inf, name) for name in ("stretch", "rescale"))
    assert isinstance(stretch, Stretch)
    assert isinstance(rescale, Stretch)
    assert (stretch.shorten, rescale.shorten) == (False, True)
    with pytest.raises(TrajgapError, match=r"^objective: 'streched' is unknown; .*'stretch'"):
        run(PSO(), problem_with(), 0, 1, objective="streched")


@pytest.mark.parametrize(
    "algorithm",
    [
        WOA(),
        *(pytest.param(a, marks=pytest.mark.slow) for a in (ImprovedWOA(), GA(iterations=300))),
    ],
    ids=lambda a: a.kind,
)
def test_its_effect_on_the_kind_of_problem_of_the_whale_paper(algorithm: WOA) -> None:
    """Eight way-points, six joints: every seed ends shorter than any does under the penalty."""
    way = np.random.default_rng(0).uniform(-2, 2, (8, 6))
    problem = Problem(way, Limits(2.0, 5.0), quintic_spline(7), 0.0, 5.0)
    if isinstance(algorithm, GA):
        algorithm = replace(algorithm, position_range=(0.0, 5.0))
    penal, stretched = (
        [r.reported_time for r in run_many(algorithm, problem, range(6), objective=handling)]
        for handling in ("death-penalty", "stretch")
    )
    assert np.median(stretched) < np.median(penal)
    assert max(stretched) < np.median(penal)
