"""The checker and the batched evaluation: identities, known answers, every verdict and reason."""

import dataclasses
import itertools
from fractions import Fraction

import numpy as np
import pytest
from support import exact_route
from support.samples import DECLARATIONS, FREE, sample_problem
from support.uneven import LIMITS as UNEVEN
from trajgap.problem import (
    QUANTITIES,
    Interpolant,
    Limits,
    Problem,
    TrajgapError,
    Verdict,
    check,
    cubic_spline,
    evaluate,
    extrema,
    fit,
    piecewise,
    quintic_spline,
    reachable_total,
    rest_to_rest,
    three_five_three,
    uniform_cubic_b_spline,
)
from trajgap.problem.checks import checker
from trajgap.problem.checks.jumps import jumps_of
from trajgap.problem.curves import Trajectory


def one_joint(waypoints: list[float], curve: Interpolant, **limits: float | np.ndarray) -> Problem:
    return Problem(np.array(waypoints)[:, None], Limits(**limits, joints=1), curve)


@pytest.mark.parametrize("name", [*DECLARATIONS, *FREE])
def test_values_lie_within_the_stated_error(name: str) -> None:
    interpolant = (DECLARATIONS | FREE)[name]
    problem, _ = sample_problem(interpolant, 31, joints=2)
    rng = np.random.default_rng(7)
    for spread in (0.3, 1.2):
        h = 10.0 ** rng.uniform(-spread, spread, interpolant.segments)
        nodal = rng.normal(size=(interpolant.free, 2)) if interpolant.free else None
        for p in check(problem, h, nodal).peaks:
            j, order = problem.joints.index(str(p.joint)), QUANTITIES.index(p.quantity) + 1
            extra = {}
            if nodal is not None:
                extra = dict(zip(interpolant.free_derivatives, nodal[:, j], strict=True))
            pieces = exact_route.fitted(interpolant, problem.waypoints[:, j], h, extra)
            truth = Fraction(exact_route.peak(pieces, h, order))
            assert abs(Fraction(abs(p.value)) - truth) <= Fraction(p.error)
            assert p.error <= 1e-9 * max(1.0, abs(p.value))
            batch = evaluate(problem, [h], nodal).ratios[0, j, order - 1]
            assert batch == pytest.approx(float(truth) / p.limit, rel=1e-10)


@pytest.mark.parametrize("segments", [3, 130])
def test_the_error_of_a_peak_covers_all_other_extrema(segments: int) -> None:
    """Each may lie beyond the peak by its own error: few pieces are searched one by one."""
    rng = np.random.default_rng(segments)
    q, h = rng.normal(size=(segments + 1, 2)), rng.uniform(0.5, 1.0, segments)
    motion = fit(rest_to_rest(segments, 5), q, h)
    sides = rng.uniform(1.0, 9.0, (2, 2, 3))
    limits = Limits(joints=2).with_sides(sides).with_positions([-9.0] * 2, [9.0] * 2)
    problem = Problem(q, limits, rest_to_rest(segments, 5))
    points = {(r, j): extrema(motion, j, r) for r in range(4) for j in (0, 1)}
    size = np.array([[max(abs(e.value) for e in points[r, j]) for j in (0, 1)] for r in range(4)])
    for _ in range(6):
        error = size * rng.uniform(0.0, 1.0, (segments, 4, 2)) ** 4
        uneven = iter(checker._derivative_peaks(problem, h, motion, error))
        for j, r in itertools.product((0, 1), (1, 2, 3)):
            ends = [(e.value, float(error[e.segment, r, j])) for e in points[r, j]]
            ratios = [
                (sign * v + e) / sides[side, j, r - 1]
                for side, sign in ((0, -1), (1, 1))
                for v, e in ends
            ]
            peak = next(uneven)
            assert peak.ratio + peak.error / peak.limit >= max(ratios) - 1e-12
        for peak in checker._position_peaks(problem, h, motion, error):
            j, sign = problem.joints.index(str(peak.joint)), np.sign(peak.limit)
            reach = max(sign * e.value + float(error[e.segment, 0, j]) for e in points[0, j])
            assert sign * peak.value + peak.error >= reach - 1e-12


@pytest.mark.parametrize("pieces", [1, 2, 5, 130])
def test_steps_beyond_the_errors_on_both_sides_are_jumps(pieces: int) -> None:
    """Of unrelated polynomials, by scipy's values at the two ends of every break."""
    rng = np.random.default_rng(pieces)
    problem, _ = sample_problem(rest_to_rest(pieces, 3), pieces)
    h, scaled = rng.uniform(0.5, 2.0, pieces), rng.normal(size=(pieces, 4, 3))
    curve = Trajectory(h, scaled, (3,) * pieces)
    held, at = curve.polynomial, curve.breaks[1:-1]
    steps = np.array([held(at, r) - held(np.nextafter(at, 0.0), r) for r in range(3)])
    for _ in range(9):
        error = rng.uniform(0.0, 6.0, (pieces, 4, 3)) * rng.uniform(0.0, 1.0, (pieces, 1, 1))
        both = (error[1:, :3] + error[:-1, :3]).transpose(1, 0, 2)
        expected = [
            (b + 1, problem.joints[j], r, pytest.approx(at[b]), pytest.approx(steps[r, b, j]))
            for b, j, r in np.argwhere((np.abs(steps) > both).transpose(1, 2, 0)).tolist()
        ]
        found, _ = jumps_of(problem, curve, error)
        assert [(j.break_index, j.joint, j.order, j.time, j.size) for j in found] == expected
        assert len(expected) > 0 or pieces < 3


def test_evaluate_overflow_is_infinite() -> None:
    problem, _ = sample_problem(three_five_three(), 1)
    ratios = evaluate(problem, [[1e-200, 1.0, 1.0], [1.0, 1e-300, 1.0], [5e-324, 1.0, 1.0]]).ratios
    assert np.isinf(ratios[:, :, 2]).all()
    assert not np.isnan(ratios).any()


def test_evaluate_shapes() -> None:
    problem, h = sample_problem(three_five_three(), 1)
    empty = evaluate(problem, np.empty((0, 3)))
    assert (empty.ratios.shape, empty.stretch.shape) == ((0, 3, 3), (0,))
    both = np.stack([h, 2 * h])
    ratios = evaluate(problem, both).ratios
    np.testing.assert_array_equal(evaluate(problem, np.asfortranarray(both)).ratios, ratios)
    whole, same = (evaluate(problem, [h]).ratios for h in ([1, 2, 3], [1.0, 2.0, 3.0]))
    np.testing.assert_array_equal(whole, same)
    for wrong in (h, [[1.0, 2.0]], np.ones((2, 2, 3)), np.ones((2, 4))):
        with pytest.raises(TrajgapError, match=r"durations: a batch has shape \(vectors, 3\), got"):
            evaluate(problem, wrong)
    for wrong in ("abc", [[1.0, "x", 2.0]], [[1.0, 2.0, 3.0], [1.0]]):
        with pytest.raises(TrajgapError, match=r"durations: not numbers; give seconds"):
            evaluate(problem, wrong)


@pytest.mark.parametrize(
    ("duration", "tolerance", "verdict"),
    [
        (1.0, 1e-9, Verdict.PASS),
        (1 + 2e-9, 1e-9, Verdict.PASS),
        (1 - 0.9e-9, 1e-9, Verdict.PASS),
        (1 - 1.1e-9, 1e-9, Verdict.VIOLATED),
        (0.5, 1e-9, Verdict.VIOLATED),
        (1 - 1e-4, 1e-3, Verdict.PASS),
        (1 - 1e-12, 0.0, Verdict.VIOLATED),
        (1.0, 0.0, Verdict.UNDECIDED),
    ],
)
def test_tolerance_decides(duration: float, tolerance: float, verdict: Verdict) -> None:
    problem = one_joint([0.2, 1.2], rest_to_rest(1, 3), velocity=1.5)
    assert check(problem, [duration], tolerance=tolerance).verdict is verdict
    # What is violated stays violated, whatever is undecided beside it.
    pair = Problem([[0.2, 0.2], [1.4, 1.2]], Limits(1.5), rest_to_rest(1, 3))
    assert check(pair, [1.0], tolerance=0.0).verdict is Verdict.VIOLATED


def test_a_duration_at_its_bound_is_kept_without_any_tolerance() -> None:
    plain = one_joint([0.2, 1.2], rest_to_rest(1, 3), velocity=2.0)
    problem = dataclasses.replace(plain, duration_lower=0.9, duration_upper=0.9)
    assert check(problem, [0.9], tolerance=0.0).verdict is Verdict.PASS


def test_rounding_that_hides_the_limit_is_undecided() -> None:
    # Near 2 : 3 this system is singular; 1e-12 from there its coefficients have four digits.
    quartics = Interpolant((4, 4), (3,), (((3, 0.0),), ((2, 0.0),), ((1, 0.0),)))
    h, size = [2.0, 3.0 * (1 + 1e-12)], 1.0
    for factor, verdict in ((1.0, None), (1.0, "undecided"), (0.5, "violated"), (2.0, "pass")):
        found = check(one_joint([0.3, 1.1, -0.4], quartics, velocity=factor * size), h)
        assert verdict in (None, found.verdict)
        size = abs(found.peaks[0].value)
        assert found.peaks[0].error > 1e-6 * size


@pytest.mark.parametrize("blur", [0.0, 1e-7, 1e6])
@pytest.mark.parametrize(
    ("order", "curve", "verdict"),
    [
        (1, cubic_spline(2), Verdict.PASS),
        (2, piecewise((3, 3), 1, ((1, 0.0), (2, 0.0)), finish=((1, 0.0),)), Verdict.DISCONTINUOUS),
    ],
)
def test_what_a_wide_bound_leaves_open_a_closer_one_decides(
    order: int, curve: Interpolant, verdict: Verdict, blur: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A limit and its ratio, or a jump of the acceleration, where the jerk is limited."""
    problem = one_joint([0.0, 0.4, -0.3], curve, velocity=5.0, jerk=1e9)
    known, enclosed, asked = check(problem, [1.0, 0.7]), Interpolant.enclosed, []

    def widened(self, *given):
        found = enclosed(self, *given)
        error = found.error + blur * (np.arange(5) == order)[:, None]
        return dataclasses.replace(
            found, bound=lambda: error, closer=lambda: asked.append(1) or found
        )

    monkeypatch.setattr(Interpolant, "enclosed", widened)
    again = check(problem, [1.0, 0.7])
    assert (again.verdict, again.limits, again.jumps) == (known.verdict, known.limits, known.jumps)
    assert known.verdict is verdict
    assert again.peaks == known.peaks
    # An error too small to hide anything still blurs the ratio of what is limited.
    assert bool(asked) is (blur > (0 if order == 1 else 1))


def test_velocity_jump_is_discontinuous() -> None:
    lines = piecewise((1, 1, 1), 0, ())
    problem = one_joint([0.3, 1.0, 0.6, 0.8], lines, velocity=5.0, acceleration=7.0)
    result = check(problem, [0.5, 0.4, 1.0])
    assert result.verdict is Verdict.DISCONTINUOUS
    assert [(j.order, j.break_index) for j in result.jumps] == [(1, 1), (1, 2)]
    assert result.feasible_time is result.tight_time is None
    assert result.feasible_why == "the motion jumps at a break, which stretching does not repair"
    assert result.tight_why == result.feasible_why
    # a limit that is exceeded is said first
    slow = one_joint([0.3, 1.0, 0.6, 0.8], lines, velocity=1.0)
    assert check(slow, [0.5, 0.4, 1.0]).verdict is Verdict.VIOLATED
    # equal slopes: no jump
    straight = one_joint([0.3, 0.5, 0.9, 1.0], lines, velocity=5.0)
    assert check(straight, [0.2, 0.4, 0.1]).verdict is Verdict.PASS


def test_acceleration_jump_counts_where_jerk_is_limited() -> None:
    rest = rest_to_rest(2, 3)
    free = Limits([5, 5], [20, 20])
    limited = Limits([5, 5], [20, 20], [np.inf, 900])
    waypoints = np.array([[0.1, 0.4], [0.5, 1.0], [0.3, 1.9]])
    result = check(Problem(waypoints, free, rest), [0.8, 0.9])
    assert result.verdict is Verdict.PASS
    assert {(j.order, j.joint) for j in result.jumps} == {(2, "1"), (2, "2")}
    assert check(Problem(waypoints, limited, rest), [0.8, 0.9]).verdict is Verdict.DISCONTINUOUS
    still = waypoints.copy()
    still[:, 1] = 0.4
    assert check(Problem(still, limited, rest), [0.8, 0.9]).verdict is Verdict.PASS


@pytest.mark.parametrize("limited", [False, True])
def test_nothing_limited_or_nothing_moves(limited: bool) -> None:
    problem, h = sample_problem(three_five_three(), 1, limits=Limits(joints=3))
    if limited:
        still, limits = np.full((4, 3), 0.7), Limits([1, 0, 1], 2, 3)
        problem = dataclasses.replace(problem, waypoints=still, limits=limits)
    result = check(problem, h)
    assert result.verdict is Verdict.PASS
    assert (result.stretch, result.max_violation) == (0.0, 0.0)
    assert limited or (result.worst, result.peaks) == (None, ())
    assert result.feasible_time == pytest.approx(h.sum())
    assert result.tight_time is None
    why = "nothing moves or nothing is limited, so the total time can shrink to 0"
    assert result.tight_why == why
    assert not evaluate(problem, [h]).ratios.any()


def test_what_rounding_hides_has_no_repair() -> None:
    # A straight line at constant speed, 3 rad in 6 ns: its acceleration is 0, and nobody sees it.
    line = uniform_cubic_b_spline(2, "timed")
    hidden = check(one_joint([13.8194, 10.6226], line, acceleration=126.6), [5.6e-9])
    assert hidden.verdict is Verdict.UNDECIDED
    assert hidden.worst is not None
    assert hidden.worst.error > hidden.worst.limit
    assert hidden.feasible_time is hidden.tight_time is None
    assert hidden.feasible_why == "rounding errors hide whether a stretch repairs it"
    assert hidden.tight_why == hidden.feasible_why
    seen = check(one_joint([13.8194, 10.6226], line, acceleration=126.6), [5.6e-3])
    assert seen.verdict is Verdict.PASS
    assert seen.feasible_time == pytest.approx(5.6e-3)


def test_position_within_one_ulp_of_its_limit_is_undecided() -> None:
    bump = Interpolant((3,), (), (((1, 1e-8),), ((1, 0.0),)))
    q = np.array([[300.0], [300.0]])
    top = max(e.value for e in extrema(fit(bump, q, [1.0]), 0, 0))
    assert top > 300.0
    limits = Limits(9, position_lower=300.0 - 1e-8, position_upper=np.nextafter(top, 0.0), joints=1)
    result = check(Problem(q, limits, bump), [1.0])
    assert result.worst is not None
    assert result.worst.ratio > 1 + 1e-9
    assert result.verdict is Verdict.UNDECIDED


@pytest.mark.parametrize(
    ("at", "lower", "upper", "verdict", "worst", "feasible", "tight"),
    [
        (1.0, 0.0, np.inf, "pass", None, "", ""),
        # Exactly at a bound is inside, and not the worst peak.
        (1.0, 1.0, 1.0, "pass", None, "", ""),
        (2.0, 2.0, 2.0, "pass", None, "", "below its lower bound"),
        (1.0, [1, 1.25, 1], np.inf, "violated", (1, 1.25), "below its lower bound", None),
        (1.0, 0.0, [1, 1, 0.5], "violated", (2, 2.0), "exceeds its upper bound", None),
        # Too fast, and the repair would be too slow.
        (0.5, 0.0, 0.8, "violated", None, "exceeds its upper bound", None),
        # Feasible, but the free rescaling would be too fast.
        (2.0, 1.5, np.inf, "pass", None, "", "below its lower bound"),
    ],
)
def test_duration_bounds(at, lower, upper, verdict, worst, feasible, tight) -> None:
    problem, h = sample_problem(three_five_three(), 3)
    h = h * check(problem, h).stretch
    bounds = {"duration_lower": h * lower, "duration_upper": h * upper}
    found = check(dataclasses.replace(problem, **bounds), at * h)
    assert found.verdict == verdict
    assert found.worst is not None
    assert found.worst.quantity == "duration" if worst else found.worst.quantity in QUANTITIES
    if worst:
        assert (found.worst.segment, found.worst.joint, found.worst.time) == (worst[0], None, None)
        assert found.worst.ratio == pytest.approx(worst[1])
    assert (found.feasible_time is None) == bool(feasible)
    assert feasible in str(found.feasible_why)
    if not feasible:
        assert found.feasible_time == pytest.approx(at * h.sum())
    if tight is not None:
        assert (found.tight_time is None) == bool(tight)
        assert tight in str(found.tight_why)


def test_summary_reads_on_one_screen() -> None:
    problem = one_joint([1.2, 1.9], rest_to_rest(1, 3), velocity=2.0)
    found = check(problem, [0.4])
    assert found.worst is not None
    assert (found.worst.margin, found.max_violation) == pytest.approx((1 - 1.3125, 0.3125))
    assert str(found).splitlines() == [
        "violated (for all t, relative tolerance 1e-09)",
        "total time      0.400000 s",
        "worst           joint 1 velocity 2.625 against 2 (ratio 1.312500000) at t = 0.200000 s",
        "feasible time   0.525000 s",
        "tight time      0.525000 s",
    ]


@pytest.mark.parametrize("uneven", [False, True])
@pytest.mark.parametrize("curve", [three_five_three(), quintic_spline(3), cubic_spline(3)])
def test_a_reachable_total_holds_for_all_of_the_box(curve: Interpolant, uneven: bool) -> None:
    rng = np.random.default_rng(11)
    q = np.array([[0.2, -1.0], [0.9, 0.3], [0.4, 1.1], [1.3, 0.6]])
    limits = UNEVEN if uneven else Limits([1.5, 2.0], [4.0, 6.0], [60.0, 90.0])
    problem, h = Problem(q, limits, curve), np.array([0.8, 0.9, 1.1])
    total = reachable_total(problem, h, q - 0.03, q + 0.05)
    for _ in range(100):
        other = dataclasses.replace(problem, waypoints=q + rng.uniform(-0.03, 0.05, q.shape))
        assert check(other, h * total / h.sum()).verdict is Verdict.PASS
    exact = reachable_total(problem, h, q, q)
    assert exact == pytest.approx(check(problem, h).feasible_time, rel=1e-8)
    bounded = dataclasses.replace(problem, duration_upper=0.5)
    ranged = dataclasses.replace(problem, limits=limits.with_positions([-2.0] * 2, [2.0] * 2))
    for unknown in (bounded, ranged):
        assert reachable_total(unknown, h, q, q) is None


def test_a_still_segment_of_any_length_does_not_blur_the_peak_of_another() -> None:
    """Errors grow as 1/h³: with a still segment of 1e-5 s they once hid a limit that is met."""
    q = np.array([[0.10379], [-0.035097], [-0.035097], [0.009476]])
    problem = Problem(q, Limits(jerk=2813.87), rest_to_rest(3, 5))
    h = np.array([0.2, 1e-5, 0.2])
    h[[0, 2]] *= check(problem, h).stretch
    verdict = check(problem, h)
    assert verdict.verdict is Verdict.PASS
    assert verdict.worst.error < 1e-12 * verdict.worst.limit
    assert check(problem, [h[0] * (1 - 1e-8), *h[1:]]).verdict is Verdict.VIOLATED
