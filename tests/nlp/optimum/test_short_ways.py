"""Way-points that nearly coincide: a second optimum lies decades away in one duration."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from trajgap.nlp import Status
from trajgap.nlp.optimum import solve
from trajgap.nlp.optimum.basins import short_ways, shortened
from trajgap.problem import (
    Array,
    Interpolant,
    Limits,
    Problem,
    Verdict,
    check,
    cubic_spline,
    cubic_spline_virtual,
    rest_to_rest,
    three_five_three,
)

THREE_JOINTS = Problem(
    np.array(
        [
            [-0.006703151918133349, 0.02357311255660433, 0.03627987010293906],
            [-0.006703151918133349, 0.023814851003725396, 0.011674082939601095],
            [-0.006703151918133349, 0.035318238530796055, 0.014810366468128482],
            [-0.006703151918133349, 0.03531831894428825, 0.014810440812788738],
            [-0.006703151918133349, 0.0013402147961412833, 0.0201109695020113],
        ]
    ),
    Limits(acceleration=np.array([3.25e-10, 1.1164833816598415e-09, 4.4896859571091743e-10])),
    cubic_spline(4),
)
"""Seed 6324 of `benchmarks/solver_errors.py`."""
ONE_JOINT = Problem(
    np.array(
        [
            [2.200242341611587],
            [0.7581331027593896],
            [-0.7425996728356407],
            [1.2816131917152613],
            [1.2816736504180204],
        ]
    ),
    Limits(
        0.2267718671895878,
        0.10012727191372049,
        0.3337143830794538,
        position_lower=-1.289477474315656,
        position_upper=2.3673380891093343,
        joints=1,
    ),
    cubic_spline(4),
)
"""Seed 6821 of the same benchmark."""
TWICE = Problem(
    np.array([[-0.128821], [-0.131591], [-0.13159096838418718], [1.15022]]),
    Limits(5.36954, joints=1),
    cubic_spline(3),
)
"""Two short ways, one a hundred thousandth of the other: found by an attack, not by the search."""
ENTERING = Problem(
    np.array(
        [
            [-0.0278838, 0.00184774],
            [-0.0278838, -0.00326112],
            [-0.027883661775939168, -0.003261293270186826],
        ]
    ),
    Limits(acceleration=1.0, joints=2).with_sides(
        np.array(
            [
                [[np.inf, np.inf, np.inf], [np.inf, 0.00467441, np.inf]],
                [[np.inf, 0.00997806, np.inf], [np.inf, 0.00320589, np.inf]],
            ]
        )
    ),
    cubic_spline(2, ((1, -0.000241806),)),
)
"""It enters and leaves in motion: a joint that comes back to where it was covers more than its
span, and the limits hold at a ten thousandth of the other optimum's second duration alone."""
FOUND = {
    "three joints": (
        THREE_JOINTS,
        [18133.716463027973, 5891.3221114083035, 0.2708153744313308, 14055.006461182671],
        38115.9353,
    ),
    "one joint": (
        ONE_JOINT,
        [10.169164080186285, 10.834980580078096, 12.577021294959078, 0.040084570343837576],
        33.8391,
    ),
    "twice": (
        TWICE,
        [0.00098523223563552038, 7.8247720745806148e-09, 0.3187312810277706],
        0.3294088537,
    ),
    "entering": (ENTERING, [2.8729255591705578, 0.00071321653797503726], 3.21147828),
}
"""A problem, what differential evolution found, and the total of the other optimum, s."""

ROUNDED = 1 + 1e-9
"""Two searches that end in one optimum differ by rounding."""


@pytest.mark.parametrize("seed", [0, 1, *(pytest.param(k, marks=pytest.mark.slow) for k in (2, 3))])
@pytest.mark.parametrize("name", FOUND)
def test_the_optimum_with_a_far_shorter_segment_is_found(name: str, seed: int) -> None:
    problem, durations, other = FOUND[name]
    h = np.array(durations)
    assert check(problem, h).verdict is Verdict.PASS
    assert h.sum() < 0.9995 * other
    solution = solve(problem, seed=seed)
    assert solution.status is Status.CONVERGED or seed > 0
    assert solution.total_time <= h.sum() * ROUNDED
    assert solution.check.verdict is Verdict.PASS


def test_a_way_of_a_four_thousandth_does_not_double_the_total() -> None:
    """A wide search and one in each decade ended at 11.0149 s and called it converged."""
    q = np.array(
        [[1.484778779903787], [2.4527124613154476], [2.453231749977215], [3.635560953069724]]
    )
    limits = Limits(4.18091532271024, 1.5164655868293293, joints=1)
    problem = Problem(q, limits, three_five_three())
    h = np.array([2.508573678, 0.000448553, 3.063363273])
    assert check(problem, h).verdict is Verdict.PASS
    assert solve(problem).total_time <= h.sum()


def test_the_same_reversed_in_time() -> None:
    problem, durations, _ = FOUND["one joint"]
    turned = replace(problem, waypoints=problem.waypoints[::-1])
    assert solve(turned).total_time <= sum(durations) * ROUNDED


@pytest.mark.parametrize(
    ("rows", "curve", "segments"),
    [
        ([[0, 0], [1, 2], [1.01, 2.02], [3, 4]], cubic_spline(3), [1]),
        ([[0, 0], [1, 2], [1.01, 2.2], [3, 4]], cubic_spline(3), []),
        ([[0, 0], [0, 2], [0, 2], [0, 4]], cubic_spline(3), [1]),
        ([[0, 0], [1, 2], [1.01, 2.02], [3, 4]], three_five_three(), [1]),
        # A cubic spline with virtual breaks: the first and the last way lie over two segments.
        ([[0, 0], [0.01, 0.01], [1, 2], [1.01, 2.02], [3, 4]], cubic_spline_virtual(5), [3]),
    ],
)
def test_ways_that_are_short(
    rows: list[list[float]], curve: Interpolant, segments: list[int]
) -> None:
    problem = Problem(np.array(rows, dtype=float), Limits(1.0, joints=2), curve)
    assert short_ways(problem) == segments


def test_a_way_is_short_beside_what_a_joint_covers_that_enters_in_motion() -> None:
    assert short_ways(ENTERING) == [1]
    assert short_ways(replace(ENTERING, curve=cubic_spline(2))) == []


def test_starts_are_shorter_by_powers_of_ten_in_a_short_way_alone() -> None:
    """Down to 2.7e-4 s, which the way takes at the velocity limit."""
    answer = np.array([10.16655583, 10.83811028, 12.54426111, 0.2902423])
    starts = shortened(ONE_JOINT, answer, np.full(4, 1e-5))
    assert starts[:, 3] == pytest.approx(0.2902423 / 10.0 ** np.arange(1, 4), rel=1e-12)
    assert (starts[:, :3] == answer[:3]).all()


def test_no_start_where_a_bound_is_above_it() -> None:
    problem = replace(ONE_JOINT, duration_lower=np.array([0.0, 0.0, 0.0, 0.2]))
    answer = np.array([10.16655583, 10.83811028, 12.54426111, 0.2902423])
    assert shortened(problem, answer, np.full(4, 1e-5)).shape == (0, 4)


def test_segments_that_stand_alone_are_not_searched_again(monkeypatch: pytest.MonkeyPatch) -> None:
    def never(*_: object) -> Array:
        raise AssertionError("searched")

    monkeypatch.setattr("trajgap.nlp.optimum.solver.shortened", never)
    rows = np.array([[0.0], [1.0], [1.0001], [2.0]])
    assert solve(Problem(rows, Limits(1.0, 1.0, joints=1), rest_to_rest(3, 5))).total_time > 0


def test_a_way_of_billionths_has_an_attained_optimum() -> None:
    """Its duration cannot go to 0, since the way takes time at the velocity limit."""
    q = np.array([[-1.01242], [-1.63634], [0.667012], [0.6670120075188035]])
    problem = Problem(q, Limits(31.6217), cubic_spline(3))
    # What differential evolution on samples found.
    known = [0.0409030746, 0.109872101, 7.03078214e-10]
    assert check(problem, known).verdict is Verdict.PASS
    found = solve(problem)
    assert found.status is Status.CONVERGED
    assert found.best < sum(known)
