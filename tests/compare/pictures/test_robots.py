"""Robots as pictures: the arm on several motions, its workspace, and those of the documents."""

import json
import re
import runpy

import numpy as np
import pytest
from matplotlib.patches import PathPatch, Rectangle
from support.checkout import ROOT
from support.drawn import sound
from trajgap.compare.pictures import ArmMotion, arm_picture
from trajgap.compare.pictures.workspace import workspace_picture
from trajgap.nlp import retime
from trajgap.problem import Chain, TrajgapError, fit, load_robot
from trajgap.problem.robots.workspace import sample_workspace

WAYPOINTS = np.array([[0.1, -0.4], [0.7, 0.2], [1.3, -0.1]])
ARM = Chain("standard", a=[0.5, 0.3], alpha=[0.0, 0.0], d=[0.4, 0.0], name="two links")


def motion(label, total):
    times = np.linspace(0.0, total, 41)
    at = np.linspace(0.0, total, 3)
    return ArmMotion(label, times, np.column_stack([np.interp(times, at, w) for w in WAYPOINTS.T]))


def drawn(motions, **changes):
    given = {"name": "arm-two", "title": "Two links", **changes}
    page = arm_picture(ARM, motions, WAYPOINTS, **given)
    return page, json.loads(re.search(r'<script type="application/json">(.*?)</script>', page)[1])


def points(text):
    return np.array([[float(x) for x in pair.split(",")] for pair in text.split()])


def test_the_end_of_the_arm_meets_the_way_points() -> None:
    page, data = drawn([motion("slow", 2.0), motion("fast", 1.0)])
    marks = np.array(re.findall(r'<circle cx="([\d.]+)" cy="([\d.]+)"', page), dtype=float)
    assert len(marks) == 2 * len(WAYPOINTS)
    clock = np.array(data["clock"])
    for k, total in enumerate((2.0, 1.0)):
        for mark, share in zip(marks[:3], (0.0, 0.5, 1.0), strict=True):
            frame = int(np.argmin(np.abs(clock - share * total)))
            assert points(data["arms"][k][frame])[-1] == pytest.approx(mark, abs=0.11)


def test_a_picture_needs_nothing_from_outside_and_words_are_no_markup() -> None:
    page, _ = drawn([motion("<b>slow</b> & safe", 2.0)], title="<script>")
    assert "<b>" not in page
    assert "&lt;b&gt;slow" in page
    assert page.count("<script") == 2
    assert not re.search(r"https?:|src=|@import|url\(", page)


def test_what_cannot_be_drawn_is_refused() -> None:
    with pytest.raises(TrajgapError, match="0 motions; give one to 4"):
        drawn([])
    with pytest.raises(TrajgapError, match=r"short: angles of shape \(41, 2\).* 6 joints"):
        arm_picture(load_robot("puma560"), [motion("short", 1.0)], [[0.0] * 6], name="a", title="b")


CLOUD = sample_workspace(load_robot("puma560"), 500, 7)
PATH = np.array([[0.1, 0.2, 0.9], [-0.3, 0.1, 0.7], [0.2, -0.4, 1.1]])


def dots(axes):
    (cloud,) = (p for p in axes.patches if isinstance(p, PathPatch))
    return cloud.get_path().vertices[::2]


def test_three_views_of_the_same_points():
    figure = workspace_picture(
        CLOUD, waypoints=PATH, labels=["A", "B", "C"], missed=[False, True, False]
    )
    assert len(figure.axes) == 3
    spans = []
    for axes, (across, up) in zip(figure.axes, [(0, 1), (0, 2), (1, 2)], strict=True):
        np.testing.assert_allclose(dots(axes), CLOUD.points[:, [across, up]], rtol=1e-12)
        (box,) = (p for p in axes.patches if isinstance(p, Rectangle))
        np.testing.assert_allclose(box.get_xy(), CLOUD.lower[[across, up]])
        size = (CLOUD.upper - CLOUD.lower)[[across, up]]
        np.testing.assert_allclose([box.get_width(), box.get_height()], size)
        _, joined, reached, missed = axes.lines
        np.testing.assert_array_equal(joined.get_xydata(), PATH[:, [across, up]])
        np.testing.assert_array_equal(reached.get_xydata(), PATH[::2, [across, up]])
        np.testing.assert_array_equal(missed.get_xydata(), PATH[1:2, [across, up]])
        assert sorted(text.get_text() for text in axes.texts) == ["A", "B", "C"]
        spans += [np.ptp(axes.get_xlim()), np.ptp(axes.get_ylim())]
    np.testing.assert_allclose(spans, spans[0])
    assert figure.axes[0].get_xlabel() == "x, m"
    assert "500 positions, seed 7;" in figure.description
    assert "3 way-points, 1 of them out of reach" in figure.description
    assert figure.title == "Workspace of PUMA 560"


def test_every_dot_reaches_the_svg_and_no_raster_does():
    document = sound(lambda: workspace_picture(CLOUD, waypoints=PATH))
    assert max(path.count("h0") for path in re.findall(r'\bd="([^"]*)"', document)) == 500


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"waypoints": [[1, 2]]}, "waypoints: shape (1, 2), or not finite; give (way-points, 3)"),
        ({"waypoints": [[1, 2, np.nan]]}, "waypoints: shape (1, 3), or not finite; give"),
        ({"waypoints": [["a", 1, 2]]}, "waypoints: not numbers; give positions, m"),
        ({"waypoints": PATH, "labels": ["A"]}, "labels: 1 for 3 way-points; give one each"),
        ({"labels": ["A"]}, "labels: 1 for 0 way-points; give one each"),
        ({"waypoints": PATH, "missed": [True]}, "missed: 1 for 3 way-points; give one each"),
    ],
)
def test_faults(options, message):
    with pytest.raises(TrajgapError, match=re.escape(message)):
        workspace_picture(CLOUD, **options)


def described(svg: str) -> str:
    found = re.search(r"<desc[^>]*>(.*?)</desc>", svg, re.DOTALL)
    return found[1]


@pytest.mark.slow
def test_pictures_in_the_documents_carry_todays_numbers() -> None:
    programs = runpy.run_path(str(ROOT / "docs/make_pictures.py"))
    made = {**dict(programs["exhibits"]()), "papers": programs["papers"]()}
    pages = "".join(page.read_text("utf-8") for page in (ROOT / "docs").rglob("*.md"))
    pages += (ROOT / "README.md").read_text("utf-8")
    for name, document in made.items():
        shown = (ROOT / f"docs/pictures/{name}.svg").read_text("utf-8")
        assert described(shown) == described(document), "run `python docs/make_pictures.py`"
        assert f"pictures/{name}.svg" in pages


def arm_shown() -> dict:
    page = (ROOT / "docs/pictures/arm-puma560.html").read_text("utf-8")
    return json.loads(re.search(r'<script type="application/json">(.*?)</script>', page)[1])


def test_the_arm_in_the_gallery_carries_the_times_of_the_results() -> None:
    path = ROOT / "docs/results/puma560-mnam-pso-353.json"
    steps = json.loads(path.read_text("utf-8"))["cases"][0]["waterfalls"][0]["steps"]
    times = {step["name"]: step["time"] for step in steps}
    shared = times["optimum of the same curve, shared durations"]
    printed, best, retimed = arm_shown()["totals"]
    assert printed == pytest.approx(times["sum of the printed durations"], abs=1e-4)
    assert best == pytest.approx(shared, abs=1e-4)
    assert retimed < best


@pytest.mark.slow
def test_the_retimed_arm_is_that_of_the_checked_retiming() -> None:
    made = runpy.run_path(str(ROOT / "docs/make_pictures.py"))
    problem, motions = made["arm_motions"]()
    printed = fit(problem.curve, problem.waypoints, [1.044, 1.258, 1.225])
    least = retime(printed, problem.limits).extrapolated
    assert arm_shown()["totals"] == pytest.approx([m.times[-1] for m in motions], abs=1e-3)
    assert motions[2].times[-1] == pytest.approx(least, rel=5e-3)
