"""`trajgap check FILE` from the command line: verdict, units, precedence, one line of fault."""

import json
import time
from pathlib import Path

import numpy as np
import pytest
from support.command_line import assert_refused
from support.documents import assert_valid

URDF = """<robot name="a">
  <joint name="j1" type="revolute"><limit lower="-1" upper="3" velocity="1" effort="1"/></joint>
  <joint name="j2" type="revolute"><limit lower="-9" upper="9" velocity="5" effort="1"/></joint>
</robot>"""


@pytest.fixture(autouse=True)
def motion(folder: Path) -> None:
    """A rest-to-rest quintic of two joints: speed 15/8 · way / time at the middle."""
    s = np.linspace(0.0, 1.0, 101)
    shape = [
        10 * s**3 - 15 * s**4 + 6 * s**5,
        (30 * s**2 - 60 * s**3 + 30 * s**4) / 2.0,
        (60 * s - 180 * s**2 + 120 * s**3) / 4.0,
    ]
    ways = [1.0, -2.0]
    columns = [2.0 * s, *(way * one for one in shape for way in ways)]
    names = ["j1", "j2", "j1 velocity", "j2 velocity", "j1 acceleration", "j2 acceleration"]
    header = ",".join(["time", *names])
    np.savetxt("m.csv", np.column_stack(columns), delimiter=",", header=header, comments="")
    (folder / "arm.urdf").write_text(URDF)


def test_a_verdict_for_all_t_with_its_repair(run):
    flags = ["--urdf", "arm.urdf", "--interpolation", "quintic"]
    found = run.document("check", "m.csv", *flags, kind="motion_check")
    result = found["result"]
    assert result["verdict"] == "pass"
    assert result["slow_down"] == 1.0
    flags = ["--velocity", "0.75", *flags[2:]]
    slower = run.document("check", "m.csv", *flags)["result"]
    assert slower["verdict"] == "violated"
    assert slower["worst"]["joint"] == "j2"
    assert slower["worst"]["value"] == pytest.approx(-1.875)
    assert slower["worst"]["time"] == pytest.approx(1.0)
    assert slower["slow_down"] == pytest.approx(2.5)
    assert slower["feasible_time"] == pytest.approx(5.0)
    assert slower["floor"]["time"] == pytest.approx(2.0 / 0.75)


def test_without_interpolation_only_what_is_proved(run):
    found = run.document("check", "m.csv", "--velocity", "1.9")
    assert found["interpolation"] == "none"
    assert found["result"]["verdict"] == "undecided"
    assert "state an --interpolation" in found["result"]["open"][0]
    proved = run.document("check", "m.csv", "--velocity", "1.8")["result"]
    assert proved["verdict"] == "violated"
    assert proved["feasible_time"] is None


def test_the_terminal_speaks_in_the_units_of_the_file(run):
    flags = ["--velocity", "2,5", "--units", "deg,mm", "--interpolation", "quintic"]
    said = run.done("check", "m.csv", *flags)
    assert "joint j1, velocity 0.9375 deg/s against 2 deg/s at 1 s (limit from flags)" in said
    assert "mm/s" in said
    found = run.document("check", "m.csv", *flags)
    assert found["units"] == ["deg", "mm"]
    peaks = {p["joint"]: p["value"] for p in found["result"]["peaks"]}
    assert peaks == {"j1": pytest.approx(0.9375 * np.pi / 180), "j2": pytest.approx(-0.001875)}


@pytest.mark.parametrize(("limit", "word"), [(1.1, "pass"), (0.9, "violated")])
def test_a_grid_of_few_digits_says_what_follows_if_it_is_exact(run, limit, word):
    """Two rows 0.02 s apart, with times to 0.005 s: nearly any speed fits the digits."""
    table = np.loadtxt("m.csv", delimiter=",", skiprows=1)[:, :3]
    np.savetxt("g.csv", table, "%.2f,%.6f,%.6f", header="time,j1,j2", comments="")
    given = ("check", "g.csv", "--velocity", f"{limit * 15 / 16},{4 * limit}")
    told = run.done(*given, "--interpolation", "spline")
    assert "\nundecided: " in told
    assert f"the verdict is {word}: add --time-noise 0" in " ".join(told.split())
    again = run.done(*given, "--interpolation", "spline", "--time-noise", "0")
    assert f"\n{word}: " in again


def test_flag_file_urdf_in_this_order(run):
    Path("l.yaml").write_text("joint_limits: {j2: {max_velocity: 3.0, max_jerk: 500}}\n")
    sources = ["--urdf", "arm.urdf", "--limits", "l.yaml", "--jerk", "400"]
    found = run.document("check", "m.csv", *sources, "--interpolation", "quintic")
    peak = {
        (p["joint"], p["quantity"]): (p["limit"], p["source"]) for p in found["result"]["peaks"]
    }
    assert peak["j2", "velocity"] == (-3.0, "l.yaml")
    assert peak["j1", "velocity"] == (1.0, "arm.urdf")
    assert peak["j2", "jerk"][1] == "flags"
    assert peak["j1", "position"][1] == "arm.urdf"


def test_strict_is_for_scripts(run):
    flags = ["check", "m.csv", "--interpolation", "quintic", "--velocity", "2"]
    rest = ["--position", "inf", "--acceleration", "inf", "--jerk", "inf"]
    for more, code in (([], 1), (rest, 0), (rest[:4], 1), ([*rest, "--velocity", "1"], 1)):
        found = run.document(*flags, *more, "--strict", code=code)
        assert found["result"]["verdict"] == ("violated" if "1" in more else "pass")
        lacking = {one["quantity"] for one in found["result"]["not_judged"]}
        assert lacking == {"position", "acceleration", "jerk"} - {x[2:] for x in more}
    for more in ([], rest):
        assert ("not judged" in run.done(*flags, *more)) == (more == [])


@pytest.mark.parametrize("misspelt", ["csv", "urdf", "yaml"])
def test_a_misspelt_joint_is_not_passed_over(run, misspelt):
    """Whichever file has the other name, the joint's limits are never dropped unnoticed."""
    Path("l.yaml").write_text("joint_limits: {j1: {max_velocity: 9}, j2: {max_velocity: 9}}\n")
    changed = {"csv": "m.csv", "urdf": "arm.urdf", "yaml": "l.yaml"}[misspelt]
    Path(changed).write_text(Path(changed).read_text().replace("j2", "j_2"))
    sources = ["--limits", "l.yaml", "--urdf", "arm.urdf", "--velocity", "2"]
    wanted = ("j_2", "j2") if misspelt == "csv" else ("j2", "j_2")
    file = "l.yaml" if misspelt == "csv" else changed
    ended = run("check", "m.csv", *sources, "--interpolation", "quintic")
    said = f"{file}: {wanted[0]}: is not a joint with limits there; rename it or add it;"
    assert_refused(ended, said, f"did you mean {wanted[1]!r}")


def test_thirty_thousand_samples_of_seven_joints(run):
    rng = np.random.default_rng(1)
    t = np.linspace(0.0, 30.0, 30_001)
    speed, phase = rng.uniform(0.5, 2.0, 7), rng.uniform(0, 6, 7)
    q = np.sin(speed * t[:, None] + phase)
    v = speed * np.cos(speed * t[:, None] + phase)
    header = "time," + ",".join([f"j{k}" for k in range(7)] + [f"j{k} velocity" for k in range(7)])
    np.savetxt("long.csv", np.column_stack([t, q, v]), "%.12g", ",", header=header, comments="")
    command = ["check", "long.csv", "--velocity", "2.1", "--interpolation", "cubic"]
    begun = time.process_time()
    # %.12g writes 0.001 s with three places, as a clock of milliseconds does.
    found = run.document(*command, "--time-noise", "0")["result"]
    taken = time.process_time() - begun
    assert found["verdict"] == "pass"
    sizes = [abs(p["value"]) for p in found["peaks"]]
    np.testing.assert_allclose(sizes, speed, rtol=1e-6)
    assert taken < 4.0  # 0.3 s; the rest is for a loaded machine


SLOW = pytest.mark.slow


@pytest.mark.parametrize(
    "form", [pytest.param("csv", marks=SLOW), "ros", pytest.param("ppoly", marks=SLOW)]
)
def test_the_motion_of_an_answer_is_written_and_read_back(run, form):
    found = run.document(
        "solve", "irb460-pso-353", "--problem", "limit-80", "--reading", "waypoints-deg",
        "--samples", "out.json", "--format", form, "--rate", "250",
    )  # fmt: skip
    assert_valid(found, "solve")
    written = found["written"]
    assert (written["file"], written["form"], written["rate"]) == ("out.json", form, 250.0)
    assert written["result"]["limits_verdict"] == "pass"
    assert written["result"]["worst"]["ratio"] == pytest.approx(1.0, abs=1e-6)
    assert written["result"]["total_time"] == pytest.approx(found["results"][0]["total_time"])
    if form != "csv":
        again = run.document("check", "out.json", "--velocity", "1.3962634", "--tolerance", "1e-6")
        assert again["result"]["limits_verdict"] == "pass"


@pytest.mark.parametrize("units", ["rad", "deg,mm"])
def test_a_repaired_table_takes_the_same_way_within_the_limits(run, units):
    flags = ["--velocity", "0.75", "--acceleration", "1.2", "--jerk", "9", "--units", units]
    flags += ["--interpolation", "quintic"]
    found = run.document("check", "m.csv", *flags, "--repair", "slow.csv", kind="motion_check")
    repaired = found["repaired"]
    assert found["result"]["verdict"] == "violated"
    assert repaired["result"]["verdict"] == "pass"
    assert repaired["slow_down"] == pytest.approx(found["result"]["slow_down"])
    before, after = (np.loadtxt(x, delimiter=",", skiprows=1) for x in ("m.csv", "slow.csv"))
    powers = np.array([-1, 0, 0, 1, 1, 2, 2])
    np.testing.assert_allclose(after * repaired["slow_down"] ** powers, before, atol=1e-12)
    again = run.document("check", "slow.csv", *flags)["result"]
    assert again == repaired["result"]
    assert again["total_time"] == pytest.approx(found["result"]["feasible_time"])


def test_a_repaired_message_and_polynomials_come_as_they_came_in(run, folder):
    flags = ["--velocity", "0.75"]
    text = run.done("check", "m.csv", *flags, "--interpolation", "quintic", "--repair", "s.csv")
    assert "s.csv: the motion 2.500000 times slower, as csv; read back: pass" in text
    points = [
        {"positions": [0.0, 0.0], "time_from_start": {"sec": 0, "nanosec": 0}},
        {"positions": [1.0, -2.0], "time_from_start": {"sec": 1, "nanosec": 333333333}},
    ]
    message = {"joint_names": ["j1", "j2"], "points": points}
    (folder / "goal.json").write_text(json.dumps(message))
    found = run.document("check", "goal.json", *flags, "--repair", "slow.yaml")["repaired"]
    assert found["result"]["verdict"] == "pass"
    slow = json.loads((folder / "slow.yaml").read_text())["points"]
    assert [one["positions"] for one in slow] == [one["positions"] for one in points]
    assert slow[1]["time_from_start"] == {"sec": 2, "nanosec": pytest.approx(666666667, abs=1)}
    assert slow[0]["velocities"] == []
    cubic = {"joints": ["j1"], "x": [1.0, 3.0], "c": [[[-0.25]], [[0.75]], [[0.0]], [[0.0]]]}
    (folder / "p.json").write_text(json.dumps(cubic))
    found = run.document("check", "p.json", "--velocity", "0.5", "--repair", "q.json")["repaired"]
    assert found["result"]["verdict"] == "pass"
    assert found["slow_down"] == pytest.approx(1.5)
    assert json.loads((folder / "q.json").read_text())["breaks"] == [1.0, pytest.approx(4.0)]


def test_a_repaired_file_is_read_back_whatever_was_stated_of_the_first(run, folder):
    """Units and names are of the first file: polynomials state their own, tables have a header."""
    cubic = {"joints": ["j1"], "x": [1.0, 3.0], "c": [[[-25.0]], [[75.0]], [[0.0]], [[0.0]]]}
    (folder / "p.json").write_text(json.dumps(cubic))
    flags = ["--velocity", "50", "--units", "deg", "--repair", "q.json"]
    found = run.document("check", "p.json", *flags)["repaired"]
    assert found["result"]["verdict"] == "pass"
    assert found["slow_down"] == pytest.approx(1.5)
    np.savetxt("h.csv", [[0, 0], [1, 1], [2, 3], [3, 4], [4, 4]], delimiter=",")
    flags = ["--joints", "arm", "--velocity", "0.5", "--interpolation", "spline"]
    flags += ["--repair", "s.csv"]
    found = run.document("check", "h.csv", *flags)["repaired"]
    assert found["result"]["verdict"] == "pass"
    assert (folder / "s.csv").read_text().startswith("time,arm\n")


def test_whole_nanoseconds_are_slowed_down_once_more(run, folder):
    """1 rad within 1300.4 ns: in 1300 ns, as a message rounds them, the limit is exceeded."""
    stamps = [{"sec": 0, "nanosec": 1000 * k} for k in range(2)]
    points = [{"positions": [float(k)], "time_from_start": at} for k, at in enumerate(stamps)]
    (folder / "fast.json").write_text(json.dumps({"joint_names": ["j1"], "points": points}))
    flags = ["--velocity", str(1.0 / 1300.4e-9), "--repair", "SLOW.JSON"]
    found = run.document("check", "fast.json", *flags)["repaired"]
    assert found["result"]["verdict"] == "pass"
    slow = json.loads((folder / "SLOW.JSON").read_text())["points"]
    assert slow[1]["time_from_start"]["nanosec"] == 1301


def test_what_no_slow_down_repairs_is_not_written(run, folder):
    flags = ["--position", "-1:1", "--interpolation", "quintic", "--repair", "slow.csv"]
    found = run.document("check", "m.csv", *flags)
    assert found["repaired"] is None
    assert "slowing down does not change the path" in found["repaired_why"]
    assert not (folder / "slow.csv").exists()
    ended = run("check", "m.csv", "--velocity", "9", *flags[2:5], "s.json")
    assert_refused(ended, "s.json", "--repair", "use .csv or .txt")
    assert not (folder / "s.json").exists()


@pytest.mark.parametrize("kind", ["png", "svg", "pdf"])
def test_a_picture_of_the_motion_is_written(run, folder, kind):
    flags = ["--velocity", "0.75", "--interpolation", "quintic", "--plot", f"motion.{kind}"]
    found = run.document("check", "m.csv", *flags, kind="motion_check")
    assert found["picture"] == f"motion.{kind}"
    head = {"png": b"\x89PNG", "svg": b"<?xml", "pdf": b"%PDF"}[kind]
    assert (folder / f"motion.{kind}").read_bytes().startswith(head)
    assert "picture" not in run.document("check", "m.csv", *flags[:4])


def test_a_picture_has_the_units_of_the_file_and_says_so(run, folder):
    flags = ["--velocity", "0.75", "--units", "deg", "--plot", "m.svg"]
    assert "m.svg: the motion with its limits" in run.done("check", "m.csv", *flags)
    text = (folder / "m.svg").read_text()
    assert "m.csv, interpolation none" in text
    assert "joint j2: largest velocity -1.8" in text
    assert "deg/s at" in text


def test_what_cannot_be_plotted_is_refused(run, folder):
    flags = ["--velocity", "1", "--plot"]
    words = ("m.jpg", "--plot", "end it with one of .png, .svg, .pdf")
    assert_refused(run("check", "m.csv", *flags, "m.jpg"), *words)
    (folder / "there.png").write_bytes(b"")
    assert_refused(run("check", "m.csv", *flags, "there.png"), "--plot", "already exists")
    durations = ["check", "mine.toml", "--durations", "1,1,1", "--plot", "m.png"]
    assert_refused(run(*durations), "--plot is for a motion")
    assert not (folder / "m.png").exists()


def test_a_urdf_says_which_joints_slide(run, folder: Path):
    (folder / "arm.urdf").write_text(URDF.replace("revolute", "prismatic", 1))
    flags = ["--urdf", "arm.urdf", "--interpolation", "quintic"]
    assert run.document("check", "m.csv", *flags, kind="motion_check")["units"] == ["m", "rad"]
    # In degrees the slide would keep a limit that it exceeds 57 times.
    for unit, joint, such in (("deg", "j1: slides", "m,deg"), ("mm", "j2: turns", "mm,rad")):
        words = f"arm.urdf: {joint}, but its unit is {unit}; give one unit", f"such as {such}"
        assert_refused(run("check", "m.csv", *flags, "--units", unit), *words)
    found = run.document("check", "m.csv", *flags, "--units", "mm,deg", kind="motion_check")
    assert found["units"] == ["mm", "deg"]


def test_a_log_in_seconds_since_1970_is_shown_to_a_millisecond(run, folder: Path):
    rows = [f"{1_700_000_000 + 0.125 * k:.3f},{0.1 * k}" for k in range(9)]
    (folder / "log.csv").write_text("\n".join(["time,j1", *rows]) + "\n")
    shown = run.done("check", "log.csv", "--velocity", "0.5", "--interpolation", "linear")
    assert "at 1700000000.625 s" in shown
    assert "e+09" not in shown
