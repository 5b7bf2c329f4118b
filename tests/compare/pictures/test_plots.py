"""The pictures: what they show, where they show it, and that they are the same every time."""

import re
import subprocess
import sys
import xml.etree.ElementTree as ElementTree
from dataclasses import replace
from itertools import combinations, product

import matplotlib
import numpy as np
import pytest
from matplotlib.text import Text
from support.drawn import DURATIONS, STEPS, fall, sound
from trajgap.compare.pictures.drawing import THEME, Picture, embedded, shown, svg
from trajgap.compare.pictures.gap_bands import waterfall_picture
from trajgap.compare.pictures.motion import motion_picture
from trajgap.compare.pictures.panels import POINTS, beyond
from trajgap.problem import Limits, Problem, TrajgapError, extrema, fit
from trajgap.problem.curves.uniform import TimedUniformBSpline

SVG = "{http://www.w3.org/2000/svg}"

HOSTILE = '$\\frac{1}{ </title><script>alert("x")</script> --> 轨迹 \x07 _x'

NAMES = ("curves", "jerk", "waterfall", "convergence", "joints", "endings", "landscape")


@pytest.mark.parametrize("name", NAMES)
def test_every_picture_is_sound(pictures: dict[str, Picture], name: str) -> None:
    sound(lambda: pictures[name])


def test_a_picture_does_not_depend_on_users_settings_or_earlier_pictures(problem: Problem) -> None:
    plain = svg(motion_picture(problem, DURATIONS, title="Motion"))
    settings = {"font.size": 20, "font.family": "serif", "lines.linewidth": 9, "svg.hashsalt": "b"}
    with matplotlib.rc_context(settings):
        svg(motion_picture(problem, 2 * DURATIONS, title="Another"))
        assert svg(motion_picture(problem, DURATIONS, title="Motion")) == plain
        assert matplotlib.rcParams["font.size"] == 20


def test_pyplot_is_never_loaded() -> None:
    modules = ["drawing", "motion", "totals_map", "searches", "gap_bands"]
    program = "import sys\n" + "".join(f"import trajgap.compare.pictures.{m}\n" for m in modules)
    program += "sys.exit('matplotlib.pyplot' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", program], check=False).returncode == 0


def test_embedding_gives_own_ids_and_colours_of_the_page(pictures: dict[str, Picture]) -> None:
    document = embedded(svg(pictures["landscape"]), "here")
    root = ElementTree.fromstring(document)
    names = [e.get("id") for e in root.iter() if e.get("id")]
    assert len(names) == len(set(names))
    assert all(str(n).startswith("here-") for n in names)
    used = re.findall(r'href="#([^"]+)"|url\(#([^)]+)\)', document)
    assert used
    assert {a or b for a, b in used} <= set(names)
    assert root.get("aria-labelledby") == "here-title here-desc"
    assert "var(--ink)" in document
    assert not any(colour in document for colour in THEME.values())


def test_text_of_case_files_is_drawn_as_it_stands_and_cannot_break_out(problem: Problem) -> None:
    hostile = replace(problem, joints=(HOSTILE, "_b"))
    picture = motion_picture(hostile, DURATIONS, title=HOSTILE, note=HOSTILE)
    document = svg(picture)
    root = ElementTree.fromstring(document)
    assert "script" not in {e.tag.removeprefix(SVG) for e in root.iter()}
    assert "</title><script>" in str(root.findtext(f"{SVG}title"))
    assert "<!--" not in document
    waterfall = STEPS[4].model_copy(update={"name": HOSTILE, "note": HOSTILE})
    ElementTree.fromstring(svg(waterfall_picture(fall(STEPS[0], waterfall), title=HOSTILE)))


def test_text_is_cut_with_an_ellipsis_and_lacks_no_glyph() -> None:
    assert shown("a  b\n c") == "a b c"
    assert shown("轨x\x07") == "?x?"
    assert shown("one two three four", 8) == "one two…"
    assert shown("one two three four", 8, 2) == "one two\nthree…"
    assert shown("way-points", 6) == "way-p…"
    assert shown("", 5) == ""


@pytest.mark.parametrize("name", NAMES)
def test_no_two_labels_overlap(pictures: dict[str, Picture], name: str) -> None:
    picture = pictures[name]
    picture.draw_without_rendering()
    labels = [t for t in picture.findobj(Text) if t.get_visible() and t.get_text().strip()]
    ticks = {id(t) for axes in picture.axes for t in _hidden_ticks(axes)}
    boxes = [(t.get_text(), t.get_window_extent()) for t in labels if id(t) not in ticks]
    for (one, a), (other, b) in combinations(boxes, 2):
        across = min(a.x1, b.x1) - max(a.x0, b.x0)
        down = min(a.y1, b.y1) - max(a.y0, b.y0)
        assert min(across, down) <= 1.0, (one, other)
    whole = picture.bbox
    for text, box in boxes:
        assert box.x0 >= whole.x0 - 1, text
        assert box.x1 <= whole.x1 + 1, text


def _hidden_ticks(axes: matplotlib.axes.Axes) -> list[Text]:
    hidden = []
    for axis in (axes.xaxis, axes.yaxis):
        low, high = sorted(axis.get_view_interval())
        for tick in [*axis.get_major_ticks(), *axis.get_minor_ticks()]:
            out = not low - 1e-9 <= tick.get_loc() <= high + 1e-9 or not axes.axison
            hidden += [t for t in (tick.label1, tick.label2) if out or not t.get_visible()]
    if not axes.axison:
        hidden += [axes.xaxis.label, axes.yaxis.label]
    return hidden


def test_peaks_stand_at_their_exact_places(problem: Problem, pictures: dict[str, Picture]) -> None:
    trajectory = fit(problem.curve, problem.waypoints, DURATIONS)
    panels = np.array(pictures["curves"].axes).reshape(2, 3)
    for j in range(2):
        for r in (1, 2):
            top = max(extrema(trajectory, j, r), key=lambda e: abs(e.value))
            marks = [a for a in panels[j, r].lines if a.get_marker() == "o"]
            assert [m.get_xydata().tolist() for m in marks] == [[[top.time, top.value]]]
            limit = problem.limits.derivatives[j, r - 1]
            share = f"{100 * abs(top.value) / limit:.2f} % of ±{limit:g}"
            assert share in panels[j, r].get_title(loc="right")


def test_limits_and_way_points_are_drawn(problem: Problem, pictures: dict[str, Picture]) -> None:
    panels = np.array(pictures["jerk"].axes).reshape(2, 4)
    own = np.array([[0.7, 0.5, 0.6], [0.9, 0.8, 1.0]])
    apart = np.array(motion_picture(problem, own, title="Joints").axes).reshape(2, 3)
    for j in range(2):
        for r, limit in enumerate((*problem.limits.derivatives[j, :2], (80.0, 200.0)[j]), start=1):
            heights = {line.get_ydata()[0] for line in panels[j, r].lines if line.is_dashed()}
            assert heights == {-limit, limit}
        # Each joint may have durations of its own.
        for panel, durations in ((panels[j, 0], DURATIONS), (apart[j, 0], own[j])):
            (points,) = [a for a in panel.lines if a.get_marker() == "o"]
            assert points.get_ydata().tolist() == problem.waypoints[:, j].tolist()
            assert points.get_xdata().tolist() == pytest.approx([0, *np.cumsum(durations)])


@pytest.mark.parametrize("clock", [False, True])
def test_stretches_beyond_a_limit_are_finer_than_a_pixel(problem: Problem, clock: bool) -> None:
    """Where time is not a polynomial of e, too."""
    h = 0.6 * DURATIONS
    if clock:
        rng = np.random.default_rng(5)
        h = rng.uniform(0.7, 1.3, 3)
        limits = Limits([1.0, 1.2], [2.0, 3.0])
        problem = Problem(rng.normal(0.3, 1.0, (4, 2)), limits, TimedUniformBSpline(4))
    trajectory = fit(problem.curve, problem.waypoints, h)
    times = np.linspace(0.0, h.sum(), 2_001)[1:-1]
    some = 0
    for j, r in product(range(2), (1, 2)):
        top = float(problem.limits.derivatives[j, r - 1])
        ends = np.array(beyond(trajectory, j, r, -top, top)).reshape(-1, 2)
        some += len(ends)
        inside = ends[(ends > 1e-9) & (ends < h.sum() - 1e-9)]
        np.testing.assert_allclose(np.abs(trajectory(inside, r)[:, j]), top, rtol=1e-2)
        over = np.abs(trajectory(times, r)[:, j]) > top
        marked = ((times[:, None] > ends[:, 0]) & (times[:, None] < ends[:, 1])).any(axis=1)
        near = (np.abs(times[:, None] - ends.ravel()) < h.sum() / POINTS).any(axis=1)
        assert (over == marked)[~near].all()
    assert some > 2
    assert "over" in svg(motion_picture(problem, h, title="over"))


def test_curves_refuse_durations_of_another_shape(problem: Problem) -> None:
    message = r"curves: expected durations of shape \(3,\) or \(2, 3\), got \(3, 2\)"
    with pytest.raises(TrajgapError, match=message):
        motion_picture(problem, np.ones((3, 2)), title="Motion")
