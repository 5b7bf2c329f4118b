"""Files with motions of every format, and one clear line for each that is none."""

import datetime as dt
import json
from decimal import Decimal
from fractions import Fraction
from itertools import pairwise
from unittest.mock import Mock

import numpy as np
import pytest
import yaml
from attacks.motion_files import READERS, write as write_rows
from scipy.interpolate import CubicSpline
from support.exact_motions import Row, hermite, value
from support.refusals import Refusal, each_refusal
from trajgap.problem import CaseError
from trajgap.problem.motions import Interpolation, Motion, interpolated, read_motion, rosbag

HEADER = "time,arm 1,arm 1 velocity,arm-2,arm-2 velocity\n"
ROWS = "0,1,0,2,0\n0.5,1.5,2,1,-1\n1.25,2,0,3,0\n"


def write(folder, name, text):
    path = folder / name
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return path


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("a.csv", HEADER + ROWS),
        ("a.txt", "# exported\n\n" + (HEADER + ROWS).replace(",", ";")),
        ("a.tsv", (HEADER + ROWS).replace(",", "\t")),
        ("b.csv", "\ufeff" + HEADER.replace("arm 1 velocity", "vel/arm 1") + ROWS),
        ("c.csv", "arm 1,arm-2,T,arm 1.qd,arm-2 vel\n1,2,0,0,0\n1.5,1,.5,2,-1\n2,3,1.25,0,0\n"),
    ],
)
def test_tables(tmp_path, name, text):
    read = read_motion(write(tmp_path, name, text))
    samples = read.content
    assert samples.joints == ("arm 1", "arm-2")
    assert samples.time.tolist() == [0.0, 0.5, 1.25]
    assert samples.position.tolist() == [[1.0, 2.0], [1.5, 1.0], [2.0, 3.0]]
    assert samples.velocity.tolist() == [[0.0, 0.0], [2.0, -1.0], [0.0, 0.0]]
    assert samples.acceleration is None
    assert read.format == "CSV"


@pytest.mark.parametrize("header", ["q1,qd1,q2,qd2", "q1,dq1,q2,dQ2", "pos1,v1,pos2,vel2"])
def test_numbered_columns_of_velocities_are_no_joints(tmp_path, header):
    """As logs of q1, qd1 have them; A1 and E1 beside each other stay two joints."""
    rows = "0,1,9,2,8\n1,3,7,4,6\n"
    samples = read_motion(write(tmp_path, "a.csv", f"time,{header}\n{rows}")).content
    assert samples.joints == tuple(header.split(",")[::2])
    assert samples.position.tolist() == [[1.0, 2.0], [3.0, 4.0]]
    assert samples.velocity.tolist() == [[9.0, 8.0], [7.0, 6.0]]
    axes = read_motion(write(tmp_path, "b.csv", f"time,A1,A2,E1,V1\n{rows}")).content
    assert axes.joints == ("A1", "A2", "E1", "V1")
    for aside in ("q1_effort", "effort_1", "tau1", "current", "Joint 1 torque [Nm]", "jerk_q1"):
        text = f"time,q1,{aside},q2,current position\n{rows}"
        found = read_motion(write(tmp_path, "c.csv", text)).content
        assert found.joints == ("q1", "q2", "current")
        assert found.position.tolist() == [[1.0, 2.0, 8.0], [3.0, 4.0, 6.0]]
    with pytest.raises(CaseError, match="no column holds positions"):
        read_motion(write(tmp_path, "d.csv", f"time,tau1,tau2,effort_1,current\n{rows}"))


SPEEDS = np.sin(np.linspace(0.0, np.pi, 11)) * [[1.0], [-3.0]]
"""Of two joints, in 11 samples at 0.1 s."""


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda q, v: (q, v), None),
        (lambda q, v: (q[[0, 0, *range(1, 11), 10]], v[[0, 0, *range(1, 11), 10]]), None),
        (lambda q, v: (q, np.rad2deg(v)), "velocity: is in deg/s if positions are in rad"),
        (lambda q, v: (np.rad2deg(q), v), "velocity: is in rad/s if positions are in deg"),
        (lambda q, v: (q, 30.0 * v), None),
        (lambda q, v: (q % (2 * np.pi), v), r"joint b: steps by a turn at 0.[0-9] s; if it"),
        (lambda q, v: (np.where(q < -0.9, q - 6.0, q), v), None),
    ],
)
def test_logs_with_repeated_rows_other_units_and_wrapped_angles(tmp_path, change, words):
    times = np.linspace(0.0, 1.0, 11)
    way = np.insert(np.cumsum((SPEEDS[:, 1:] + SPEEDS[:, :-1]) / 20, axis=1), 0, 0.0, axis=1)
    q, v = change(np.column_stack([way[0] + 0.1, way[1] + 0.5, times])[:, :2], SPEEDS.T)
    if len(q) > 11:
        times = times[[0, 0, *range(1, 11), 10]]
    table = np.column_stack([np.arange(len(q)) * 0, times, q, v])
    text = "\n".join(",".join(f"{x:.9f}" for x in one) for one in table)
    path = write(tmp_path, "log.csv", f"index,time,a,b,a velocity,b velocity\n{text}\n")
    if words is None:
        assert read_motion(path).content.position.shape == (11, 2)
    else:
        with pytest.raises(CaseError, match=words):
            read_motion(path)


def test_a_table_without_header_in_units_of_its_own(tmp_path):
    path = write(tmp_path, "a.csv", "0 180 1000\n1 90 500\n")
    samples = read_motion(path, ("deg", "mm"), (1.8, 2.0), ("turn", "slide")).content
    assert samples.joints == ("turn", "slide")
    np.testing.assert_allclose(samples.position, [[np.pi, 1.0], [np.pi / 2, 0.5]])
    np.testing.assert_allclose(samples.margin, [np.pi / 100, 0.002])
    assert read_motion(path).joints == ("1", "2")


def test_polynomials_by_piece_and_as_scipy_has_them(tmp_path):
    one = CubicSpline([0.0, 0.3, 1.0, 1.6], np.random.default_rng(6).normal(size=(4, 2)))
    named = {"joints": ["x", "y"]}
    by_piece = named | {"breaks": one.x.tolist(), "coefficients": one.c.swapaxes(0, 1).tolist()}
    by_power = named | {"x": one.x.tolist(), "c": one.c.tolist()}
    at, degrees = np.linspace(0.0, 1.6, 50), {"units": {"position": "deg"}}
    for found, units, factor in (
        (by_piece, (), 1.0),
        (by_power, (), 1.0),
        (by_piece, [("deg",)], np.pi / 180),
        (by_piece | degrees, (), np.pi / 180),
    ):
        read = read_motion(write(tmp_path, "p.json", json.dumps(found)), *units)
        assert isinstance(read.content, Motion)
        assert read.joints == ("x", "y")
        np.testing.assert_allclose(read.content(at), factor * one(at), atol=1e-12)


def message(stamp):
    point = {"positions": [0.1, 0.2], "velocities": [0.0, 0.0], "accelerations": [], "effort": []}
    later = {**point, "positions": [0.4, 0.1], "time_from_start": stamp(1, 250_000_000)}
    points = [{**point, "time_from_start": stamp(0, 0)}, later]
    return {"joint_names": ["j1", "j2"], "points": points}


STAMPS = {
    "ROS 2": lambda s, n: {"sec": s, "nanosec": n},
    "ROS 1": lambda s, n: {"secs": s, "nsecs": n},
    "Foxglove": lambda s, n: {"sec": s, "nsec": n},
    "seconds": lambda s, n: s + n * 1e-9,
}
WRAPPED = {
    "JointTrajectory": lambda m: m,
    "FollowJointTrajectory": lambda m: {"trajectory": m, "path_tolerance": []},
    "RobotTrajectory": lambda m: {"joint_trajectory": m},
    "DisplayTrajectory": lambda m: {"model_id": "", "trajectory": [{"joint_trajectory": m}]},
}


@pytest.mark.parametrize("stamp", STAMPS.values(), ids=STAMPS)
@pytest.mark.parametrize("wrap", WRAPPED.values(), ids=WRAPPED)
@pytest.mark.parametrize("ending", ["json", "yaml"])
def test_ros_messages(tmp_path, stamp, wrap, ending):
    found = wrap(message(stamp))
    text = json.dumps(found) if ending == "json" else yaml.safe_dump(found) + "---\n"
    read = read_motion(write(tmp_path, f"m.{ending}", text))
    assert read.controller
    samples = read.content
    assert samples.joints == ("j1", "j2")
    assert samples.time.tolist() == [0.0, 1.25]
    assert samples.position.tolist() == [[0.1, 0.2], [0.4, 0.1]]
    assert samples.acceleration is None


def test_the_controllers_choice_between_each_pair(tmp_path):
    rows = [  # time, position, velocity, acceleration
        (0.0, 0.3, 0.0, 0.0),
        (0.7, 1.0, 1.5, -0.5),
        (1.0, 1.4, 0.2, None),
        (1.9, 0.0, None, None),
        (2.5, 0.5, 0.0, 1.0),
    ]
    points = [
        {
            "positions": [p],
            "velocities": [] if v is None else [v],
            "accelerations": [] if a is None else [a],
            "time_from_start": {"sec": int(t), "nanosec": round((t - int(t)) * 1e9)},
        }
        for t, p, v, a in rows
    ]
    text = json.dumps({"joint_names": ["j"], "points": points})
    samples = read_motion(write(tmp_path, "m.json", text)).content
    motion = interpolated(samples, Interpolation.CONTROLLER)
    for (t0, *first), (t1, *last) in pairwise(rows):
        # What both ends state: positions alone, velocities too, or all.
        stated = sum(None not in pair for pair in zip(first, last, strict=True))
        ends = [(t, [Fraction(x or 0) for x in one]) for t, one in ((t0, first), (t1, last))]
        one = hermite([Row(Fraction(t), tuple(x)) for t, x in ends], 2 * stated - 1)
        for part in (0.0, 0.2, 0.9):
            place = Fraction(part * (t1 - t0))
            wanted = float(value(one.pieces[0], place))
            assert motion(t0 + float(place))[0] == pytest.approx(wanted, abs=1e-9)
    assert motion.between.startswith("straight lines and cubic Hermite and quintic Hermite")


def bomb(levels):
    text = "a0: &a0 [x, x, x, x, x, x, x, x, x]\n"
    for k in range(1, levels):
        text += f"a{k}: &a{k} [" + ", ".join([f"*a{k - 1}"] * 9) + "]\n"
    return text + f"joint_names: *a{levels - 1}\npoints: *a{levels - 1}\n"


def merges(levels):
    text = "a0: &a0 {x: 1}\n"
    for k in range(1, levels):
        text += f"a{k}: &a{k}\n  <<: [" + ", ".join([f"*a{k - 1}"] * 9) + "]\n"
    return text


@each_refusal("motions")
def test_one_clear_line(tmp_path, one: Refusal):
    path = write(tmp_path, one.name, one.text(""))
    one.said_by(lambda: read_motion(path), str(path) + "…")


@pytest.mark.parametrize(
    ("name", "text", "message"),
    [
        ("binary.csv", b"time,a\n0,\0\n", "binary"),
        ("latin.csv", b"time,gelenk-\xe4\n0,1\n", "not UTF-8"),
        ("latin.yaml", b"a: \xe4\n", "not UTF-8"),
        ("control.yaml", "a: \x07\n", "not valid YAML"),
        ("wide.csv", ",".join(["1"] * 500) + "\n", "too many"),
        ("deep.json", "[" * 200_000, "nested too deeply"),
        ("deep.yaml", "[" * 100_000, "nested too deeply"),
        ("dashes.yaml", "- " * 100_000, "nested too deeply"),
        ("indent.yaml", "\n".join(" " * k + "a:" for k in range(3000)), "nested too deeply"),
        ("long.yaml", "a: " + "9" * 10_000, "."),
        ("bomb.yaml", bomb(12), "joint_names: is not a list"),
        ("merge.yaml", merges(12), "a merge key"),
    ],
)
def test_what_is_too_much_or_no_text(tmp_path, name, text, message):
    path = write(tmp_path, name, text)
    with pytest.raises(CaseError, match=message) as caught:
        read_motion(path)
    assert str(caught.value).startswith(str(path))
    assert "\n" not in str(caught.value)
    assert len(str(caught.value)) < 600


@pytest.mark.parametrize("ending", ["csv", "json", "yaml", "parquet", "bag"])
def test_what_is_no_file(tmp_path, ending):
    import os

    path = tmp_path / f"x.{ending}"
    with pytest.raises(CaseError, match="no such file"):
        read_motion(path)
    os.mkfifo(path)
    with pytest.raises(CaseError, match="not a regular file"):
        read_motion(path)


def test_units_and_noise_are_checked(tmp_path):
    path = write(tmp_path, "a.csv", "0,1,2\n1,2,3\n")
    ros = write(tmp_path, "m.json", json.dumps(message(STAMPS["ROS 2"])))
    poly = write(tmp_path, "p.json", '{"breaks": [0, 1], "coefficients": [[[1]]]}')
    stated = write(tmp_path, "s.json", poly.read_text()[:-1] + ', "units": {"position": "deg"}}')
    assert read_motion(stated, ("deg",)).units == read_motion(stated).units == ("deg",)
    for given, wanted in (
        ((path, ("turn",)), "--units: 'turn' is unknown"),
        ((path, ("deg", "deg", "mm")), "3 units for 2 joints"),
        ((path, ("deg",), (1.0, 2.0, 3.0)), "3 numbers for 2 joints"),
        ((path, ("deg",), (-1.0,)), "noise"),
        ((ros, ("deg",)), "in rad and m"),
        ((poly, ("deg",), (0.1,)), "applies to samples only"),
        ((stated, ("rad",)), "--units: the file itself states deg; leave it out"),
    ):
        with pytest.raises(CaseError, match=wanted):
            read_motion(*given)


@pytest.mark.parametrize("reader", [one for one in READERS if one != "polynomials"])
def test_every_reader_reads_the_same_rows(tmp_path, reader):
    """As programs write them; CSV with every separator."""
    pytest.importorskip("rosbags" if reader == "bag" else "pyarrow")
    table = [
        [Row(Fraction(2 * k + 1, 4), (Fraction(k + j, 2), Fraction(k, 4), Fraction(j, 8)))
         for k in range(4)]
        for j in range(2)
    ]  # fmt: skip
    for seed in range(9 if reader == "csv" else 1):
        path = write_rows(np.random.default_rng(seed), reader, table, tmp_path)
        samples = read_motion(path).content
        assert samples.joints == ("j1", "j2")
        assert samples.time.tolist() == [row.time for row in table[0]]
        for order in range(3):
            wanted = [[joint[k].values[order] for joint in table] for k in range(4)]
            assert samples.given(order).tolist() == wanted


def test_a_bag_holds_a_trajectory_and_is_readable(tmp_path, monkeypatch):
    pytest.importorskip("rosbags")
    rows = [[Row(Fraction(k), (Fraction(k),) * 3) for k in range(2)]]
    bag = write_rows(np.random.default_rng(0), "bag", rows, tmp_path)
    with pytest.raises(CaseError, match="no topic with a trajectory; topics: /plan"):
        read_motion(bag, topic="/other")
    with monkeypatch.context() as patched:
        patched.setattr(rosbag, "_plain", Mock(side_effect=ValueError))
        with pytest.raises(CaseError, match=r"no readable bag \(ValueError\)"):
            read_motion(bag)
    for one in bag.glob("*.db3"):
        one.write_bytes(b"not a data base")
    with pytest.raises(CaseError, match="no readable bag"):
        read_motion(bag)


pyarrow = pytest.importorskip("pyarrow")
parquet = pytest.importorskip("pyarrow.parquet")


def test_what_is_no_parquet(tmp_path):
    (tmp_path / "b.parquet").write_bytes(b"PAR1 no")
    with pytest.raises(CaseError, match="no Parquet table"):
        read_motion(tmp_path / "b.parquet")


DAY = dt.datetime(2026, 1, 1, 23, 59, 58)
STEPS = [0.25, 0.75, 1.5]  # s
LATER = [DAY + dt.timedelta(seconds=one) for one in STEPS]


@pytest.mark.parametrize(
    ("kind", "values", "times"),
    [
        *((f"timestamp('{unit}')", LATER, [0, 0.5, 1.25]) for unit in ("ms", "us", "ns")),
        ("timestamp('ns', 'Asia/Tokyo')", LATER, [0, 0.5, 1.25]),
        ("timestamp('s')", [3, 5, 6], [0, 2, 3]),
        ("duration('s')", [3, 5, 6], [3, 5, 6]),
        ("duration('ms')", [250, 750, 1500], [0.25, 0.75, 1.5]),
        ("duration('us')", [250, 750, 1500], [0.00025, 0.00075, 0.0015]),
        ("duration('ns')", [250, 750, 1500], [2.5e-7, 7.5e-7, 1.5e-6]),
        ("time32('s')", [3, 5, 6], [0, 2, 3]),
        ("time32('ms')", [250, 750, 1500], [0, 0.5, 1.25]),
        ("time64('us')", [250, 750, 1500], [0, 0.0005, 0.00125]),
        ("time64('ns')", [250, 750, 1500], [0, 5e-7, 1.25e-6]),
        ("date32()", [3, 5, 6], [0, 172800, 259200]),
        ("date64()", [3 * 86400000, 5 * 86400000, 6 * 86400000], [0, 172800, 259200]),
        ("float32()", [0.25, 0.75, 1.5], STEPS),
        ("decimal128(5, 2)", [Decimal("0.25"), Decimal("0.75"), Decimal("1.50")], STEPS),
        ("dictionary(int8(), float64())", [0.25, 0.75, 1.5], STEPS),
        ("dictionary(int8(), int64())", [1, 2, 3], "int64 without a unit"),
        ("int64()", [1, 2, 3], "time: holds int64 without a unit; name it time_s"),
        ("uint8()", [1, 2, 3], "holds uint8 without a unit"),
        ("decimal128(5, 0)", [Decimal(1), Decimal(2), Decimal(3)], "without a unit"),
        ("bool_()", [False, True, True], "holds bool"),
        ("string()", ["0.1", "0.2", "0.3"], "holds string, which is not a number"),
        ("list_(float64())", [[0.1], [0.2], [0.3]], "which is not a number"),
        ("struct([('sec', int32())])", [{"sec": 1}] * 3, "which is not a number"),
        ("float64()", [0.25, None, 1.5], "has no time in row 2"),
        ("null()", [None] * 3, "has no time in row 1"),
        ("float64()", [0.25, float("nan"), 1.5], "number 2 is not finite"),
        ("timestamp('ns')", [-(2**63) + 1, 0, 2**63 - 1], "spans more time than can be read"),
    ],
)
def test_times_of_a_parquet_file_by_their_type(tmp_path, kind, values, times):
    of = eval(f"pyarrow.{kind}", {**vars(pyarrow), "pyarrow": pyarrow})
    column = pyarrow.array(values, of)
    path = tmp_path / "a.parquet"
    parquet.write_table(pyarrow.table({"time": column, "a": [1.0, 2.0, 4.0]}), path)
    if isinstance(times, str):
        with pytest.raises(CaseError, match=times):
            read_motion(path)
        return
    np.testing.assert_allclose(read_motion(path).content.time, times, rtol=1e-15)


@pytest.mark.parametrize(
    ("label", "values", "wanted"),
    [
        ("a", [True, False], "a: holds bool, which is not a number"),
        ("a", ["1", "2"], "a: holds string"),
        ("a", [dt.timedelta(1), dt.timedelta(2)], "a: holds duration"),
        ("a", [DAY, DAY], "a: holds timestamp"),
        ("a", [1.0, None], "joint a in sample 2 is not finite"),
        ("a", [2**62 + 1, 0], "no Parquet table"),  # float64 would round it
        ("__index_level_0__", [1, 2], "is the index of a data frame"),
    ],
)
def test_positions_of_a_parquet_file_are_numbers(tmp_path, label, values, wanted):
    parquet.write_table(pyarrow.table({"time_s": [0, 1], label: values}), tmp_path / "a.parquet")
    with pytest.raises(CaseError, match=wanted):
        read_motion(tmp_path / "a.parquet")
