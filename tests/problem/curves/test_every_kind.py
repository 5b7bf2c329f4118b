"""Every kind of curve is asked the same: samples, batches, identities, gradients, refusals."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from support.b_splines import NATURAL, clamped, given, printed, uniform
from support.positions import WAYPOINTS, position_ratios
from support.same_question import DRESSES, SLOWER, same_question
from support.samples import DECLARATIONS, FREE, sample_problem
from trajgap.problem import (
    Array,
    Check,
    ClampedBSpline,
    Limits,
    Problem,
    Timing,
    TrajgapError,
    Verdict,
    check,
    cubic_spline,
    evaluate,
    extrema,
    fit,
    keeps_limits,
    peak_gradients,
    quintic_spline,
    rest_to_rest,
)
from trajgap.problem.curves.clamped_declaration import chord_fractions

FIRST, LAST, BENT = (0.5, -0.2, 0.0), (-0.3, 0.4, 0.7), (0.0, 1.1, -0.6)
MOVING = {
    "ends apart": cubic_spline(3, ((1, FIRST),), finish=((1, LAST),)),
    "quintic, ends apart": quintic_spline(3, ((1, FIRST), (2, LAST)), ((1, LAST), (2, BENT))),
    "mixed ends": cubic_spline(3, ((1, FIRST),), ((2, BENT),)),
    "natural cubic": cubic_spline(3, ((2, 0.0),)),
    "rest 9": rest_to_rest(3, 9),
}
"""Derivatives at the ends that differ between both ends and between joints."""
CLAMPED = {
    "-".join(map(str, kind)): kind
    for kind in (
        (3, "averaged-continued", "times", "timed"),
        (4, "averaged-continued", "chord", "stretched"),
        (5, "averaged-continued", "joint-chord", "timed"),
        (6, "averaged-continued", "chord", "timed"),
        (7, "averaged-continued", "joint-chord", "stretched"),
        (5, "waypoints", "times", "timed"),
        (5, "waypoints", "joint-chord", "stretched"),
    )
}
"""Every degree, and each choice of the others twice at least; test_clamped_spline has all."""
KNOTS = {"given knots": given(4), "given knots, stretched": printed(4)}
UNIFORM = (*map(str, Timing), NATURAL)
KINDS = (*DECLARATIONS, *FREE, *MOVING, *CLAMPED, *KNOTS, *UNIFORM)
each = pytest.mark.parametrize("name", KINDS)
Motion = tuple[Problem, Array, Array | None]


@cache
def motion(name: str, uneven: bool = False) -> Motion:
    """Shifted, unequal joints; limits of every quantity, their sides alike or not."""
    rng = np.random.default_rng(len(name))
    nodal = None
    if name in CLAMPED:
        problem, h = clamped(CLAMPED[name], 7, count=6)
    elif name in UNIFORM:
        problem, h = uniform(name, 6)
    elif name in MOVING:
        problem, h = Problem(WAYPOINTS, Limits(9.0), MOVING[name]), np.array([0.8, 1.3, 0.7])
    elif name in KNOTS:
        q = rng.normal(size=(5, 3)) * [0.4, 1.0, 2.0] + [-3.0, 0.5, 2.0]
        problem, h = Problem(q, Limits(9.0), KNOTS[name]), np.array([0.83, 1.12, 0.74, 1.21])
    else:
        curve = (DECLARATIONS | FREE)[name]
        problem, h = sample_problem(curve, 41)
        nodal = rng.normal(size=(curve.free, 3)) if curve.free else None
    peaks = np.abs([ends(problem, h, nodal, order) for order in (1, 2, 3, 4)]).max(axis=2).T
    sides = np.tile((peaks + 0.1) * rng.uniform(0.7, 1.5, (3, 4)), (2, 1, 1))
    if uneven:
        sides *= rng.uniform(0.5, 1.5, sides.shape)
    q = problem.waypoints
    room = rng.choice([0.003, 0.05, 0.4], (2, 3))
    room[0, 0] = room[1, 1] = np.inf
    low, high = q.min(axis=0) - room[0], q.max(axis=0) + room[1]
    limits = Limits(joints=3).with_sides(sides).with_positions(low, high)
    return replace(problem, limits=limits), h, nodal


def ends(problem: Problem, h: Array, nodal: Array | None, order: int) -> Array:
    """Least and largest value of each joint on dense samples of each piece, (joints, 2)."""
    found = fit(problem.curve, problem.waypoints, h, nodal)
    s = np.linspace(0.0, 1.0, 1001)
    pieces = range(len(found.breaks) - 1)
    joints = range(problem.waypoints.shape[1])
    y = [[found.values(k, j, order, s) for k in pieces] for j in joints]
    return np.array([[np.min(one), np.max(one)] for one in y])


def worst(found: Check, joints: tuple[str, ...], quantity: str) -> list[float]:
    peaks = [p for p in found.peaks if p.quantity == quantity]
    return [max(p.ratio for p in peaks if p.joint == joint) for joint in joints]


@pytest.mark.parametrize("uneven", [False, True])
@each
def test_checker_batch_and_dense_samples_agree(name: str, uneven: bool) -> None:
    problem, h, nodal = motion(name, uneven)
    # The last ones are slow enough for every limit but those of positions.
    batch = np.outer([1.0, 0.4, 1.7, 9.0, *[50.0] * 4], h)
    batch[4:] *= np.exp(np.random.default_rng(5).uniform(-1.5, 1.5, (4, h.size)))
    found = evaluate(problem, batch, nodal)
    for i, one in enumerate(batch):
        own = check(problem, one, nodal)
        assert own.worst is not None
        if own.worst.quantity == "curve":
            assert np.isinf(found.ratios[i]).all()
            assert np.isinf(found.positions[i]).all()
            assert not keeps_limits(problem, one[None], 5e-10)[0]
            continue
        for r, quantity in enumerate(problem.limits.quantities):
            ratios = worst(own, problem.joints, quantity)
            assert found.ratios[i, :, r] == pytest.approx(ratios, rel=1e-9, abs=1e-9)
        assert found.stretch[i] == pytest.approx(own.stretch, rel=1e-9)
        positions = worst(own, problem.joints, "position")
        assert found.positions[i] == pytest.approx(positions, rel=1e-7, abs=1e-9)
        if nodal is None:
            kept = keeps_limits(problem, one[None], 5e-10)[0]
            assert kept == (own.limits is Verdict.PASS)
    limits = problem.limits
    for r in range(limits.sides.shape[2]):
        least, most = ends(problem, h, nodal, r + 1).T
        below, above = limits.sides[:, :, r]
        sampled = np.maximum(0.0, np.maximum(-least / below, most / above))
        assert (sampled <= found.ratios[0, :, r] * (1 + 1e-9) + 1e-9).all()
        assert found.ratios[0, :, r] == pytest.approx(sampled, rel=1e-4, abs=1e-6)
    whole = position_ratios(
        ends(problem, h, nodal, 0), limits.position_lower, limits.position_upper
    )
    assert found.positions[0] == pytest.approx(whole, abs=1e-5)


@each
def test_extrema_hold_both_ends_and_every_turn_of_each_piece(name: str) -> None:
    problem, h, nodal = motion(name)
    found = fit(problem.curve, problem.waypoints, h, nodal)
    s = np.linspace(0.0, 1.0, 2001)
    for j in range(3):
        for order in range(4):
            points = extrema(found, j, order)
            assert [e.time for e in points] == sorted(e.time for e in points)
            assert {(e.joint, e.order) for e in points} == {(j, order)}
            for k in range(len(found.breaks) - 1):
                own = {e.s: e.value for e in points if e.segment == k}
                y = found.values(k, j, order, s)
                noise = 1e-9 * np.abs(y).max()
                steps = np.diff(y)
                turns = s[1:-1][(steps[:-1] * steps[1:] < 0) & (np.abs(steps[1:]) > noise)]
                for place in (0.0, *turns, 1.0):
                    near = min(own, key=lambda x: abs(x - place))
                    assert abs(near - place) <= (1e-3 if 0.0 < place < 1.0 else 0.0)
                at = np.array(list(own))
                np.testing.assert_allclose(
                    found.values(k, j, order, at), list(own.values()), rtol=1e-12, atol=1e-3 * noise
                )


@pytest.mark.parametrize("dress", DRESSES[1:-1])
@each
def test_another_dress_changes_no_ratio(name: str, dress: str) -> None:
    problem, h, nodal = motion(name, True)
    if dress == "reverse" and (nodal is not None or name in KNOTS):
        pytest.skip("what is given by hand is not turned here")
    other, durations = same_question(dress, problem, h)
    if nodal is not None:
        orders = np.array([order for _, order in problem.curve.free_derivatives])[:, None]
        nodal_of = {"mirror": -nodal, "slower": nodal / SLOWER**orders, "permute": nodal[:, ::-1]}
    one = evaluate(problem, h[None], nodal)
    again = evaluate(other, durations[None], None if nodal is None else nodal_of[dress])
    turned = slice(None, None, -1) if dress == "permute" else slice(None)
    for mine, theirs in ((one.ratios, again.ratios), (one.positions, again.positions)):
        np.testing.assert_allclose(theirs[:, turned], mine, rtol=1e-8, atol=1e-9)
    if nodal is None:
        assert check(other, durations).limits is check(problem, h).limits


@each
def test_a_joint_alone_moves_as_among_all(name: str) -> None:
    problem, h, nodal = motion(name)
    together = evaluate(problem, h[None], nodal)
    for j in range(3):
        alone, free = problem.joint(j), None if nodal is None else nodal[:, [j]]
        own = evaluate(alone, h[None], free)
        np.testing.assert_allclose(own.ratios[0, 0], together.ratios[0, j], rtol=1e-10, atol=1e-13)
        np.testing.assert_allclose(own.positions[0, 0], together.positions[0, j], rtol=1e-9)
        assert {p.joint for p in check(alone, h, free).peaks} == {str(j + 1)}


def held(problem: Problem) -> object:
    """The curve with its parameters as they are, though way-points move."""
    curve, q = problem.curve, problem.waypoints
    if not isinstance(curve, ClampedBSpline) or curve.parameters not in ("chord", "joint-chord"):
        return curve
    by_joint = tuple(chord_fractions(q[:, [j]])[0] for j in range(3))
    return replace(curve, fractions=chord_fractions(q) if curve.parameters == "chord" else by_joint)


@each
def test_gradients_are_differences_at_the_same_places(name: str) -> None:
    problem, h, nodal = motion(name)
    q, curve = problem.waypoints, held(problem)
    whole = fit(curve, q, h, nodal)
    points = [e for j in range(3) for r in range(4) for e in extrema(whole, j, r)]
    gradient = peak_gradients(problem, h, points, nodal)
    size = 1.0 + np.abs([e.value for e in points])

    def values(q: Array, h: Array, nodal: Array | None) -> Array:
        moved = fit(curve, q, h, nodal)
        at = [moved.values(e.segment, e.joint, e.order, np.array([e.s])) for e in points]
        return np.concatenate(at)

    for k in range(h.size):
        step = 5e-4 * h[k] * np.eye(h.size)[k]
        near, far = (values(q, h + x, nodal) - values(q, h - x, nodal) for x in (step, 2 * step))
        slope = (8 * near - far) / (12 * step[k])  # off by the fourth power of the step
        room = 1e-9 * (size + np.abs(slope).max())
        assert (np.abs(gradient.durations[:, k] - slope) <= room).all()
    owner, base = np.array([e.joint for e in points]), values(q, h, nodal)
    # Values are linear in way-points and free derivatives: whole steps are exact.
    for own, slopes in ((q, gradient.waypoints), (nodal, gradient.nodal)):
        for i, j in np.ndindex(0 if own is None else len(own), 3):
            moved = own.copy()
            moved[i, j] += 1.0
            ahead = values(moved, h, nodal) if own is q else values(q, h, moved)
            wanted = np.where(owner == j, slopes[:, i], 0.0)
            assert (np.abs(ahead - base - wanted) <= 1e-8 * (size + np.abs(wanted))).all()
    assert gradient.nodal.shape == (len(points), 0 if nodal is None else len(nodal))
    if curve.homogeneous and nodal is None:
        # f(c·h) = f(h)/cʳ, so h · ∂f/∂h = −r f.
        orders = np.array([e.order for e in points])
        room = 1e-8 * (1 + np.abs(gradient.durations).max(axis=1) + size)
        assert (np.abs(gradient.durations @ h + orders * base) <= room).all()


@each
def test_what_is_no_duration_is_refused_and_keeps_nothing(name: str) -> None:
    problem, h, nodal = motion(name)
    batch = np.tile(h, (6, 1))
    for i, bad in enumerate((0.0, -1.0, np.nan, np.inf, -np.inf)):
        batch[i, i % h.size] = bad
        with pytest.raises(TrajgapError, match="must all be positive and finite"):
            check(problem, batch[i], nodal)
    found = evaluate(problem, batch, nodal)
    alone = evaluate(problem, h[None], nodal)
    for name in ("ratios", "positions", "stretch"):
        assert np.isinf(getattr(found, name)[:5]).all()
        np.testing.assert_array_equal(getattr(found, name)[5], getattr(alone, name)[0])
    assert nodal is not None or not keeps_limits(problem, batch, 1e-9)[:5].any()
    n = h.size
    with pytest.raises(TrajgapError, match=rf"^durations: expected {n} \(one per segment\), got"):
        check(problem, np.ones(n + 1), nodal)
    with pytest.raises(TrajgapError, match=rf"a batch has shape \(vectors, {n}\)"):
        evaluate(problem, np.ones((2, n + 1)), nodal)
    rows = len(problem.waypoints)
    with pytest.raises(TrajgapError, match=rf"needs {rows} rows, got shape \({rows - 1}, 3\)"):
        fit(problem.curve, problem.waypoints[1:], h, nodal)
    with pytest.raises(TrajgapError, match=rf"needs {rows}, got {rows - 1}"):
        replace(problem, waypoints=problem.waypoints[1:])
    if nodal is not None:
        with pytest.raises(TrajgapError, match="give nodal derivatives of shape"):
            evaluate(problem, h[None])


@each
def test_waypoints_are_passed_at_their_times(name: str) -> None:
    problem, h, nodal = motion(name)
    found = fit(problem.curve, problem.waypoints, h, nodal)
    nodes = np.concatenate([[0.0], np.cumsum(h)])
    at = nodes[list(problem.curve.waypoint_breaks)]
    np.testing.assert_allclose(found(at), problem.waypoints, rtol=0, atol=1e-11)
    assert found.total_time == pytest.approx(h.sum(), rel=1e-14)
    for b, entries in enumerate(getattr(problem.curve, "prescribed", ())):
        for order, value in entries:
            np.testing.assert_allclose(found(nodes[b], order), value, atol=1e-9)


@pytest.mark.parametrize(
    ("durations", "message"),
    [
        ("abc", "not numbers; give seconds"),
        ([1.0, [2.0, 1.0], 2.0], "not numbers"),
        ([1.0, None, 2.0], "must all be positive and finite"),
        (1.0, r"expected 3 \(one per segment\), got 1$"),
        ([], r"expected 3 \(one per segment\), got 0$"),
        ([[1.0, 2.0, 3.0]], r"expected 3 .* got 3 in shape \(1, 3\)"),
        ([1.0, 1e-31, 2.0], r"\[1.0, 1e-31, 2.0\] s must all lie between 1e-30 and 1e\+30"),
        ([1e31, 1.0, 2.0], r"must all lie between 1e-30 and 1e\+30 s"),
    ],
)
def test_durations_refused(durations: object, message: str) -> None:
    problem = motion("quintic")[0]
    for judge in (lambda h: check(problem, h), lambda h: fit(problem.curve, problem.waypoints, h)):
        with pytest.raises(TrajgapError, match=f"^durations: .*{message}"):
            judge(durations)
