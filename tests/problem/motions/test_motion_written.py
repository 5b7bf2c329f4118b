"""Motions to files and back, and from objects of other libraries: both say the same motion."""

import json
from types import SimpleNamespace

import numpy as np
import pytest
import yaml
from scipy.interpolate import BPoly, CubicSpline, PPoly, make_interp_spline
from trajgap.nlp import Solution, Status
from trajgap.problem import Limits, Problem, TrajgapError, Verdict, curves, fit
from trajgap.problem.motions import (
    JointLimits,
    MotionForm,
    as_motion,
    check_motion,
    csv_text,
    motion_text,
    read_back,
    sampled,
    shortest,
)

WAYPOINTS = np.array([[0.1, -2.0], [0.9, -1.2], [1.4, 0.4], [0.7, 1.0]])
H = np.array([0.71, 1.037, 0.553])
NAMES = ("j1", "j2")


def motion():
    return fit(curves.three_five_three(), WAYPOINTS, H)


@pytest.mark.parametrize("form", MotionForm)
@pytest.mark.parametrize("step", [0.01, 0.0123, 0.7])
def test_the_motion_comes_back(form, step):
    truth = motion()
    back = read_back(motion_text(truth, form, step, NAMES), form, "x")
    assert back.joints == NAMES
    assert back.total_time == pytest.approx(truth.total_time, abs=2e-9)
    at = np.linspace(0.0, truth.total_time * (1 - 1e-9), 400)
    exact = form is not MotionForm.CSV
    for order, loose in ((0, 1e-7), (1, 1e-7), (2, 1e-5)):
        error = np.abs(back(at, order) - truth(at, order)).max()
        # Rows between breaks alone round the corners of acceleration at the breaks.
        assert error < (loose if exact else 2.0 * step ** (3 - order) * 60)


def test_rows_are_a_grid_with_the_end():
    rows = sampled(motion(), 0.01, NAMES)
    assert rows.time[0] == 0.0
    assert rows.time[-1] == motion().total_time
    np.testing.assert_allclose(np.diff(rows.time)[:-1], 0.01, rtol=1e-9)
    assert 0.003 <= np.diff(rows.time)[-1] <= 0.013
    np.testing.assert_array_equal(rows.velocity, motion()(rows.time, 1))
    every = sampled(motion(), 0.01, NAMES, breaks=True)
    for one in motion().breaks:
        assert np.abs(every.time - one).min() < 1e-15
    assert np.diff(every.time).min() >= 0.003


def test_times_of_ros_are_whole_nanoseconds():
    message = json.loads(motion_text(motion(), MotionForm.ROS, 0.013, NAMES))
    assert message == yaml.safe_load(json.dumps(message))
    last = message["points"][-1]
    stamp = last["time_from_start"]["sec"] + 1e-9 * last["time_from_start"]["nanosec"]
    assert stamp == pytest.approx(motion().total_time, abs=1.1e-9)
    assert last["positions"] == pytest.approx([0.7, 1.0], abs=1e-12)
    assert max(map(abs, last["velocities"])) < 1e-12
    for point in message["points"]:
        assert set(point) == {
            "positions", "velocities", "accelerations", "effort", "time_from_start",
        }  # fmt: skip


def test_a_motion_that_starts_later_is_written_from_0():
    later = as_motion(CubicSpline([5.0, 6.0, 7.5, 8.0], np.array([[0.0], [1.0], [2.0], [0.0]])))
    rows = sampled(later, 0.1)
    assert (rows.time[0], rows.time[-1]) == (0.0, 3.0)
    np.testing.assert_allclose(rows.position, later(5.0 + rows.time))


def test_a_solution_gives_its_motion():
    problem = Problem(WAYPOINTS, Limits(3.0, 9.0), curves.three_five_three(), joints=NAMES)
    answer = Solution(problem, Status.CONVERGED, vector=H)
    np.testing.assert_array_equal(answer.trajectory.breaks, motion().breaks)
    rows = answer.sample(0.05)
    assert rows.joints == NAMES
    np.testing.assert_array_equal(rows.position, motion()(rows.time))
    curve, nodal = curves.piecewise((5, 5)), np.array([[0.4, -0.3], [0.2, 0.1]])
    free = Problem(WAYPOINTS[:3], Limits(3.0, 9.0), curve, joints=NAMES)
    rows = Solution(free, Status.FEASIBLE, vector=H[:2], nodal=nodal).sample(0.1)
    truth = fit(curve, WAYPOINTS[:3], H[:2], nodal)
    np.testing.assert_array_equal(rows.velocity, truth(rows.time, 1))
    nothing = Solution(problem, Status.INFEASIBLE, "the reason")
    for ask in (lambda: nothing.trajectory, lambda: nothing.sample(0.1)):
        with pytest.raises(TrajgapError, match="no motion: infeasible, the reason"):
            ask()


def test_a_curve_on_a_clock_of_its_own_is_sampled_but_is_no_polynomial():
    curve = curves.uniform_cubic_b_spline(4, "timed")
    clocked = fit(curve, WAYPOINTS, [0.8, 1.1, 0.9])
    rows = sampled(clocked, 0.01)
    np.testing.assert_allclose(rows.position[-1], WAYPOINTS[-1], atol=1e-9)
    with pytest.raises(TrajgapError, match="not polynomials in time"):
        motion_text(clocked, MotionForm.PPOLY, 0.01)


@pytest.mark.parametrize("step", [0.0, -1.0, np.nan, np.inf, 1e-12])
def test_a_step_is_a_time(step):
    with pytest.raises(TrajgapError, match="step: "):
        sampled(motion(), step)


def test_a_name_with_a_comma_is_no_column():
    with pytest.raises(TrajgapError, match="contains a separator"):
        csv_text(sampled(motion(), 0.1, ("a,b", "c")))


WAYS = np.array([[0.3, 1.0], [1.0, -0.5], [0.2, 0.4], [1.5, 2.0]])


def same(motion, truth, orders=(0, 1, 2), loose=1e-7):
    at = np.linspace(motion.breaks[0], motion.breaks[-1], 501)[1:-1]
    for order in orders:
        wanted = np.array([truth(float(t), order) for t in at])
        np.testing.assert_allclose(motion(at, order), wanted, rtol=loose, atol=loose)


def path():
    import toppra

    return toppra.SplineInterpolator([0.0, 0.4, 0.7, 1.3], WAYS)


def drake_polynomial(held):
    """What pydrake's PiecewisePolynomial offers: ascending coefficients from each break."""

    def matrix(k):
        rows = [[SimpleNamespace(GetCoefficients=lambda j=j: held.c[::-1, k, j])] for j in range(2)]
        return np.array(rows, dtype=object)

    return SimpleNamespace(get_segment_times=lambda: held.x.tolist(), getPolynomialMatrix=matrix)


def drake_spline(held):
    basis = SimpleNamespace(knots=lambda: held.t.tolist(), degree=lambda: 3)
    return SimpleNamespace(basis=lambda: basis, control_points=lambda: [c[:, None] for c in held.c])


DRAWN = np.random.default_rng(1).normal(size=(4, 3, 2))
HELD = {
    "Bernstein polynomials": BPoly(DRAWN, [1.0, 1.5, 3.0, 3.2]),
    "polynomials": PPoly(DRAWN, [0.0, 0.5, 2.0, 2.4]),
    "B-spline": make_interp_spline([0.0, 0.4, 0.7, 1.3], WAYS, k=3),
}
AS_THEY_ARE = {
    **{f"scipy's {name}": (one, one) for name, one in HELD.items()},
    "Drake's polynomials": (drake_polynomial(HELD["polynomials"]), HELD["polynomials"]),
    "Drake's B-spline": (drake_spline(HELD["B-spline"]), HELD["B-spline"]),
}


@pytest.mark.parametrize("name", AS_THEY_ARE)
def test_objects_of_scipy_and_drake_are_read_as_they_are(name):
    given, held = AS_THEY_ARE[name]
    motion = as_motion(given, ("x", "y"))
    assert as_motion(motion) is motion
    same(motion, lambda t, order: held(t, nu=order))


def test_one_joint_of_scipy_needs_no_second_axis():
    assert as_motion(PPoly([[1.0], [2.0]], [0.0, 1.0]), ("a",))(0.5).tolist() == [2.5]
    spline = make_interp_spline(np.arange(6.0), np.arange(6.0) ** 2, k=3)
    assert as_motion(spline)(2.5)[0] == pytest.approx(6.25)


def test_toppras_path():
    same(as_motion(path()), path())


@pytest.mark.parametrize("how", ["ParametrizeConstAccel", "ParametrizeSpline"])
def test_toppras_answers_are_read_as_they_are(how):
    import toppra
    from toppra import algorithm, constraint

    velocity = constraint.JointVelocityConstraint([2.0, 3.0])
    acceleration = constraint.JointAccelerationConstraint([5.0, 9.0])
    toppra.setup_logging("ERROR")
    answer = algorithm.TOPPRA(
        [velocity, acceleration], path(), gridpoints=np.linspace(0, 1.3, 60), parametrizer=how
    ).compute_trajectory(0.0, 0.0)
    motion = as_motion(answer)
    assert motion.total_time == pytest.approx(answer.duration)
    same(motion, answer, orders=(0, 1), loose=1e-6)
    found = check_motion(motion, JointLimits.from_values(motion.joints, [2.0, 3.0], [5.0, 9.0]))
    # Its constraints hold at grid points: between them the acceleration is larger.
    at = np.linspace(1e-6, answer.duration - 1e-6, 4001)
    seen = np.abs(answer(at, 2)).max(axis=0) / [5.0, 9.0]
    assert found.worst.ratio >= seen.max() * (1 - 1e-9)
    assert found.verdict is Verdict.VIOLATED


def test_toppras_grid_may_meet_knots_up_to_rounding():
    """1/3 as a knot and as a grid point differ by rounding: no step of that length arises."""
    from toppra import SplineInterpolator
    from toppra.parametrizer import ParametrizeConstAccel

    knots = np.array([0.0, 1.0, 2.0, 3.0]) / 3.0
    grid = np.linspace(0.0, 1.0, 151)
    grid[50], grid[100] = np.nextafter(knots[1], 0.0), np.nextafter(knots[2], 1.0)
    speeds = np.sqrt(grid * (1.0 - grid))
    answer = ParametrizeConstAccel(SplineInterpolator(knots, WAYS), grid, speeds)
    motion = as_motion(answer)
    assert motion.durations.size == 150
    same(motion, answer, orders=(0, 1, 2))


def test_ruckigs_profiles():
    """From rest, they take as long as the closed form says."""
    ruckig = pytest.importorskip("ruckig")
    rng = np.random.default_rng(5)
    for speed in [0.5] * 20 + [0.0] * 40:
        asked = ruckig.InputParameter(3)
        asked.current_position, asked.target_position = rng.normal(size=(2, 3)).tolist()
        asked.current_velocity = rng.uniform(-speed, speed, 3).tolist()
        limits = rng.uniform(0.6, 3.0, (3, 3)) * [[1.0], [3.0], [20.0]]
        asked.max_velocity, asked.max_acceleration, asked.max_jerk = limits.tolist()
        answer = ruckig.Trajectory(3)
        ruckig.Ruckig(3).calculate(asked, answer)
        motion = as_motion(answer, ("a", "b", "c"))
        assert motion.total_time == pytest.approx(answer.duration)
        if not speed:
            ways = np.subtract(asked.target_position, asked.current_position)
            times = [shortest(d, *limits[:, j]) for j, d in enumerate(ways)]
            assert answer.duration == pytest.approx(max(times), rel=1e-9)
        same(motion, lambda t, order, a=answer: a.at_time(t)[order], loose=1e-6)
        found = check_motion(motion, JointLimits.from_values(motion.joints, *limits))
        assert found.verdict is Verdict.PASS, str(found)
        assert found.worst.ratio == pytest.approx(1.0, abs=1e-6)


def test_steps_of_roundings_length_are_no_pieces():
    steps = [[500.0, 500.0], [500.0 + 1e-11, 500.0]]
    still = SimpleNamespace(
        duration=1000.0,
        profiles=[[SimpleNamespace(t=one) for one in steps]],
        at_time=lambda t: ([t, 2.0 * t], [1.0, 2.0], [0.0, 0.0], [0.0, 0.0]),
    )
    motion = as_motion(still)
    np.testing.assert_allclose(motion.durations, [500.0, 500.0])
    same(motion, lambda t, order: [[t, 2.0 * t], [1.0, 2.0], [0.0, 0.0]][order])


def stamped(message, clock):
    """A message of ROS as an object with the fields of its clock."""
    points = []
    for one in message["points"]:
        at = one["time_from_start"]
        named = dict(zip(clock, (at["sec"], at["nanosec"]), strict=True))
        fields = one | {"time_from_start": SimpleNamespace(**named)}
        points.append(SimpleNamespace(**{k: tuple(v) if v == [] else v for k, v in fields.items()}))
    return SimpleNamespace(joint_names=message["joint_names"], points=points)


def test_a_message_of_ros_is_the_motion_that_its_controller_follows():
    text = motion_text(motion(), MotionForm.ROS, 0.05, NAMES)
    plain = json.loads(text)
    truth = read_back(text, MotionForm.ROS, "x")
    given = [plain, {"goal": {"trajectory": plain}}]
    given += [stamped(plain, clock) for clock in (("sec", "nanosec"), ("secs", "nsecs"))]
    for one in given:
        found = as_motion(one)
        assert found.joints == NAMES
        np.testing.assert_array_equal(found.breaks, truth.breaks)
        np.testing.assert_array_equal(found.scaled, truth.scaled)
    for joints in (NAMES, ()):
        assert as_motion(plain, joints).joints == NAMES
    with pytest.raises(TrajgapError, match="the message itself names j1, j2; leave them out"):
        as_motion(plain, ("a", "b"))


def test_a_message_as_rosbags_has_it():
    typesys = pytest.importorskip("rosbags.typesys")
    types = typesys.get_typestore(typesys.Stores.ROS2_HUMBLE).types
    of = {name.rpartition("/")[2]: one for name, one in types.items()}
    none = np.empty(0)
    points = [
        of["JointTrajectoryPoint"](
            np.array(q), np.zeros(2), none, none, of["Duration"](sec, nanosec)
        )
        for q, sec, nanosec in (([0.1, 0.2], 0, 0), ([0.5, 0.1], 1, 500_000_000))
    ]
    header = of["Header"](of["Time"](0, 0), "")
    found = as_motion(of["JointTrajectory"](header, list(NAMES), points))
    np.testing.assert_array_equal(found.breaks, [0.0, 1.5])
    np.testing.assert_allclose(found([0.0, 0.75, 1.5]), [[0.1, 0.2], [0.3, 0.15], [0.5, 0.1]])


def test_messages_without_one_trajectory_are_refused():
    with pytest.raises(TrajgapError, match="the message contains 0 trajectories; give one"):
        as_motion({"points": []})
    plain = json.loads(motion_text(motion(), MotionForm.ROS, 0.5, NAMES))
    with pytest.raises(TrajgapError, match="the message contains 2 trajectories; give one"):
        as_motion({"trajectory": [plain, plain]})
    lost = SimpleNamespace(joint_names=["a"], points=[SimpleNamespace(positions=[0.0])] * 2)
    words = r"JointTrajectory: points\[0\].time_from_start: is missing"
    with pytest.raises(TrajgapError, match=words):
        as_motion(lost)
