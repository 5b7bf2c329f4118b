"""The referee's converters: closed forms, and the planners' own values at many times."""

import sys
from itertools import pairwise
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.interpolate import PPoly
from support.benchmarks import benchmark
from trajgap.problem.motions import shortest


@pytest.fixture(scope="module")
def referee() -> Any:
    pytest.importorskip("toppra")
    before = list(sys.path)
    yield SimpleNamespace(**benchmark("referee"))
    sys.path[:] = before


@pytest.fixture(scope="module")
def planners(referee: Any) -> Any:
    return sys.modules["referee_planners"]


@pytest.fixture(scope="module")
def motions(referee: Any) -> Any:
    return sys.modules["referee_motions"]


def question(planners: Any, waypoints: Any) -> Any:
    places = np.asarray(waypoints, dtype=np.float64)
    ones = np.ones(places.shape[1])
    return planners.Question("1", places, 2.0 * ones, 4.0 * ones, 32.0 * ones)


def setting(planners: Any, name: str) -> Any:
    return next(one for one in planners.SETTINGS if one.name.startswith(name))


LINE = [[0.0, 0.0], [3.0, -1.0]]


def test_a_line_by_toppra_takes_the_closed_form_time(referee, planners):
    asked, own = question(planners, LINE), setting(planners, "ConstAccel, 500")
    best = referee.best_of(own, asked)
    assert best == pytest.approx(3.0 / 2.0 + 2.0 / 4.0)  # joint 1: 3 rad at 2 rad/s and 4 rad/s²
    answer = referee.judged(own, asked, own.solve(asked), 0.0)
    assert best * (1 - 1e-7) <= answer.time <= best * (1 + 1e-4)
    assert referee.kept(answer, 1e-6)
    assert answer.floor == pytest.approx(best)


def test_toppras_spline_overshoots_where_acceleration_switches_on_every_grid(referee, planners):
    """docs/measurements/planners.md says so: 8 to 11 % on 50, 200 and 800 cells."""
    asked, own = next(referee.random_questions("lines", 1)), setting(planners, "default")
    for cells in (50, 200, 800):
        motion = planners._toppra(asked, cells, "ParametrizeSpline")
        assert 1.08 < referee.judged(own, asked, motion, 0.0).ratios[1] < 1.11


def test_an_excess_and_a_jump_break_what_is_asked(referee):
    def answer(ratio: float, jump: float) -> Any:
        return referee.Answer("1", 1.0, (1.0, ratio), jump, 0.0, 1.0, 1.0, 0.0)

    assert referee.kept(answer(1.0 + 9e-7, 9e-7), 1e-6)
    assert not referee.kept(answer(1.0 + 2e-6, 0.0), 1e-6)
    assert not referee.kept(answer(0.5, 2e-6), 1e-6)


def test_floors_in_closed_form(referee, planners):
    second, third = setting(planners, "default"), setting(planners, "TOPP3-SOCP, 50")
    away_and_back = question(planners, [[0.0], [3.0], [1.0]])
    # 3 rad and back by 2 rad, each from rest to rest, because the joint stands where it turns.
    runs = shortest(3.0, 2.0, 4.0, np.inf) + shortest(2.0, 2.0, 4.0, np.inf)
    assert referee.floor_of(second, away_and_back) == pytest.approx(runs)
    assert referee.floor_of(third, away_and_back) == pytest.approx(runs)
    onwards = question(planners, [[0.0], [1.0], [3.0]])
    assert referee.floor_of(third, onwards) == pytest.approx(shortest(3.0, 2.0, 4.0, 32.0))
    # Joints that take turns: full speed on each segment counts.
    turns = question(planners, [[0.0, 0.0], [9.0, 0.0], [9.0, 9.0]])
    assert referee.floor_of(second, turns) == pytest.approx(9.0)


def test_every_planner_that_imports_is_above_its_floor_and_ends_at_the_goal(referee, planners):
    versions, missing = planners.present()
    asked = question(planners, [[0.0, 0.3], [1.0, -0.4], [0.2, 0.9], [1.1, 1.0]])
    for one in planners.SETTINGS:
        if one.planner not in versions or not referee.can_be_asked(one, asked):
            continue
        answer = referee.judged(one, asked, one.solve(asked), 0.0)
        assert answer.repaired >= answer.floor * (1 - 1e-9), one.name
        assert answer.end_error < 1e-9, one.name
    assert all("python -m pip install" in line for line in missing)


def test_ruckigs_stops_take_the_closed_form_time(referee, planners):
    pytest.importorskip("ruckig")
    asked, own = question(planners, [*LINE, [2.5, 1.0]]), setting(planners, "rest at each")
    motion = own.solve(asked)
    times = [shortest(3.0, 2.0, 4.0, 32.0), shortest(2.0, 2.0, 4.0, 32.0)]
    assert motion.total_time == pytest.approx(sum(times), rel=1e-9)
    at = np.append(0.0, np.cumsum(times))
    np.testing.assert_allclose(motion(at), asked.waypoints, atol=1e-9)
    np.testing.assert_allclose(motion(at, 1), 0.0, atol=1e-9)


def test_a_timed_path_is_the_path_at_that_place(motions):
    path = PPoly(np.array([[[1.0], [-1.0]], [[0.0], [2.0]], [[1.0], [1.0]]]), [0.0, 1.0, 2.0])
    grid = np.linspace(0.0, 2.0, 9)
    times, laws = motions.steps(grid, grid * (2.0 - grid))  # s'² = s(2 − s) at the stations
    motion = motions.timed(path, times, laws, "test")
    for k, (begin, end) in enumerate(pairwise(times)):
        at = np.linspace(begin, end, 7)[1:-1]
        place = np.polyval(laws[k][::-1], at - begin)
        np.testing.assert_allclose(motion(at, 0), path(place), atol=1e-13)
    assert [
        float(np.polyval(law[::-1], b - a))
        for law, (a, b) in zip(laws, pairwise(times), strict=True)
    ] == pytest.approx(grid[1:].tolist())


@pytest.mark.parametrize("bend", [-3.0, 0.0, 1e-9, 2.5])
def test_a_profile_of_third_order_has_its_own_speed_and_acceleration(motions, bend):
    """With a(s) = s'² quadratic in s, s'' = a'/2: told at every place, by its own closed form."""

    def square(s: Any) -> Any:
        return 1.0 + 0.8 * s + bend * s * (s - 1.0)

    stations = np.linspace(0.0, 1.0, 6)
    pushes = 0.4 + bend * (stations - 0.5)
    profile = SimpleNamespace(a=square(stations), b=pushes, num_stationary=(0, 0))
    spans = [quad(lambda s: square(s) ** -0.5, x, y)[0] for x, y in pairwise(stations)]
    times = np.concatenate([[0.0], np.cumsum(spans)])
    line = PPoly(np.array([[[2.0]], [[0.5]]]), [0.0, 1.0])
    motion = motions.third_order(line, stations, profile, times)
    at = np.linspace(0.0, times[-1], 301)[1:-1]
    s = (motion(at, 0)[:, 0] - 0.5) / 2.0
    np.testing.assert_allclose(motion(times[:-1], 0)[:, 0], 0.5 + 2.0 * stations[:-1], atol=1e-12)
    np.testing.assert_allclose((motion(at, 1)[:, 0] / 2.0) ** 2, square(s), rtol=1e-9)
    np.testing.assert_allclose(motion(at, 2)[:, 0] / 2.0, 0.4 + bend * (s - 0.5), atol=1e-8)
    # Jerk: s''' = (a'/2)'·s' = bend·s'.
    np.testing.assert_allclose(motion(at, 3)[:, 0] / 2.0, bend * square(s) ** 0.5, atol=1e-6)


def test_stationary_ends_of_a_profile_are_cubic(motions):
    """s = size·t³ up to the first station, and its mirror image at the end."""
    stations = np.array([0.0, 0.2, 0.8, 1.0])
    profile = SimpleNamespace(a=np.array([0.0, 1, 1, 0]), b=np.zeros(4), num_stationary=(1, 1))
    times = np.array([0.0, 0.6, 1.2, 1.8])  # 3·0.2/√1, 0.6/√1, 3·0.2/√1
    line = PPoly(np.array([[[1.0]], [[0.0]]]), [0.0, 1.0])
    motion = motions.third_order(line, stations, profile, times)
    at = np.linspace(0.0, 0.6, 50)[1:-1]
    size = 0.2 / 0.6**3
    for order, wanted in enumerate((size * at**3, 3 * size * at**2, 6 * size * at)):
        np.testing.assert_allclose(motion(at, order)[:, 0], wanted, atol=1e-12)
    np.testing.assert_allclose(1.0 - motion(1.8 - at, 0)[:, 0], size * at**3, atol=1e-12)
    np.testing.assert_allclose(motion(np.array([0.9]), 1), 1.0, atol=1e-12)
