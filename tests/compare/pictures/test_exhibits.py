"""The further pictures of a page: jumps, control polygon, tent map, workspace, and their hooks."""

from fractions import Fraction
from itertools import combinations

import numpy as np
import pytest
from matplotlib.text import Annotation
from support.drawn import sound
from support.studies import changed, shipped
from trajgap.compare.audits import Pair, PrintedRow
from trajgap.compare.audits.rules.stated_curve import Vertex
from trajgap.compare.audits.study import Study
from trajgap.compare.pages.exhibits import exhibits_of_motion, exhibits_of_search
from trajgap.compare.pictures.drawing import Picture, drawing
from trajgap.compare.pictures.exhibits import (
    TentScatter,
    jump_picture,
    polygon_picture,
    tent_picture,
    tent_scatter,
    velocity_jumps,
)
from trajgap.compare.pictures.workspace import place_labels
from trajgap.problem import Limits, Printed, Problem, TrajgapError, file_name, three_five_three
from trajgap.problem.curves import control_vertices, uniform_cubic_b_spline
from trajgap.problem.printed.rounded import Interval

WAYPOINTS = np.array([[0.3, 1.9], [1.4, 1.2], [0.9, 2.6], [2.0, 2.1], [1.6, 0.7]])
DURATIONS = np.array([0.7, 1.1, 0.4, 0.9])
JOINTS = ("shoulder", "wrist")


@pytest.fixture(scope="module")
def stretched() -> Problem:
    curve = uniform_cubic_b_spline(5, "stretched")
    return Problem(WAYPOINTS, Limits(9.0, 90.0), curve, joints=JOINTS)


@pytest.fixture(scope="module")
def irb1600() -> Study:
    return shipped("irb1600-ga-cubic-bspline")


@pytest.fixture(scope="module")
def scatter() -> TentScatter:
    return tent_scatter(30, 7, (0.0, 5.0), 0.5)


def printed_vertices(shift: str = "0") -> list[Vertex]:
    """Vertices of the way-points as if printed with two decimals; the first of them shifted."""
    found = []
    for j, label in enumerate(JOINTS):
        for k, exact in enumerate(control_vertices(WAYPOINTS)[:, j]):
            digits = Printed(f"{exact + float(shift) * (j == k == 0):.2f}")
            half = Fraction(1, 50)
            allowed = Interval(Fraction(exact) - half, Fraction(exact) + half)
            found.append(Vertex(label, k, digits, allowed, allowed))
    return found


def test_jumps_are_those_of_the_slopes_of_the_control_polygon(stretched: Problem) -> None:
    # dq/de at way-point k is (V_{k+1} − V_{k−1})/2 on both sides; only the stretch differs.
    v = control_vertices(WAYPOINTS)
    slopes = (v[3:-1] - v[1:-3]) / 2
    expected = slopes * (1 / DURATIONS[1:] - 1 / DURATIONS[:-1])[:, None]
    found = velocity_jumps(stretched, DURATIONS)
    assert [(j.joint, j.break_index) for j in found] == [(n, k) for n in JOINTS for k in (1, 2, 3)]
    np.testing.assert_allclose([j.size for j in found], expected.T.ravel(), rtol=1e-12)
    np.testing.assert_allclose([j.time for j in found[:3]], np.cumsum(DURATIONS)[:3])


def test_a_smooth_motion_has_no_jump(stretched: Problem) -> None:
    smooth = Problem(WAYPOINTS[:4], Limits([9.0, 9.0], [90.0, 90.0]), three_five_three(), 0.1)
    assert velocity_jumps(smooth, DURATIONS[:3]) == ()
    assert "joint 1: no jump" in jump_picture(smooth, DURATIONS[:3], title="T").description
    jumping = jump_picture(stretched, DURATIONS, title="T").description
    assert "joint wrist: largest of 3 jumps: " in jumping


def test_jumps_need_shared_durations(stretched: Problem) -> None:
    with pytest.raises(TrajgapError, match=r"expected durations of shape \(4,\), got \(3,\)"):
        jump_picture(stretched, DURATIONS[:3], title="T")


def test_the_polygon_shows_differences_and_marks_what_rounding_leaves_out() -> None:
    good = polygon_picture(WAYPOINTS, printed_vertices(), title="Polygon")
    assert "joint shoulder: 7 of 7 within rounding" in good.description
    bad = polygon_picture(WAYPOINTS, printed_vertices("0.5"), title="Polygon")
    assert "joint shoulder: 6 of 7 within rounding, at most 5.0e−1 apart" in bad.description
    assert "joint wrist: 7 of 7 within rounding" in bad.description
    strip = bad.axes[2].collections[1]
    assert len(np.unique(strip.get_facecolors(), axis=0)) == 2
    apart = strip.get_offsets()[:, 1]
    assert int(np.abs(apart).argmax()) == 0


def test_the_polygon_refuses_other_counts() -> None:
    with pytest.raises(TrajgapError, match="give two vertices more than way-points"):
        polygon_picture(WAYPOINTS[:4], printed_vertices(), title="T")


def test_the_collapse_is_where_the_powers_of_two_end(scatter: TentScatter) -> None:
    # A double is m/2ᵖ with m odd; every step takes one factor, then 1 maps to 0.
    p = Fraction(float(scatter.start)).denominator.bit_length() - 1
    assert scatter.orbit.zero_at == p + 1 <= 54
    assert scatter.orbit.exact_zero_at is None
    whole = (p + 1 + 6) // 7
    assert scatter.at_zero == 30 - whole
    assert (scatter.doubles[whole:] == 0).all()
    assert (scatter.exact[whole:] > 0).all()


def test_labels_overlap_neither_each_other_nor_the_points() -> None:
    points = np.array([[0.0, 0.0], [0.02, 0.01], [0.05, 0.0], [0.5, 0.9], [0.5, 0.9], [1.0, 1.0]])
    with drawing():
        figure = Picture("Labels", "", 4.0, 4.0)
        axes = figure.subplots()
        axes.plot(*points.T, "o")
        figure.draw_without_rendering()
        figure.set_layout_engine("none")
        place_labels(axes, points, ["alpha", "beta", "gamma", "delta", "epsilon", "last"])
        figure.draw_without_rendering()
    names = ["alpha", "beta", "gamma", "delta, epsilon", "last"]
    assert [t.get_text() for t in axes.texts] == names
    texts = [t for t in axes.texts if isinstance(t, Annotation)]
    boxes = [super(Annotation, t).get_window_extent() for t in texts]
    for one, two in combinations(boxes, 2):
        assert not one.overlaps(two)
    frame = axes.get_window_extent()
    for box in boxes:
        assert frame.x0 <= box.x0
        assert box.x1 <= frame.x1
        for place in axes.transData.transform(points):
            assert not box.contains(*place)


def test_the_polishing_case_shows_jumps_and_polygon(irb1600: Study) -> None:
    jumps, polygon, workspace = exhibits_of_motion(irb1600)
    assert (jumps.id, polygon.id, workspace.id) == ("jumps", "control-polygon", "workspace")
    picture, folded = jumps.blocks
    # Durations of 1 s throughout leave no jump; the times of the other reading are smooth.
    assert picture.name == file_name("jumps", "nine-segments", "after")
    assert "under 9 of 19 readings" in picture.caption
    # The default does not jump; the picture is of the first reading that does.
    stretched = "angles-rad-v-rad-a-rad-stretched"
    assert irb1600.case.labels[stretched] in picture.caption
    (grid,) = folded.blocks
    found = PrintedRow(irb1600, irb1600.case.claim("after"), Pair("nine-segments", stretched)).check
    assert len(grid.rows) == sum(j.order == 1 for j in found.jumps)
    (shown,) = polygon.blocks
    assert shown.document.count("12 of 12 within rounding") >= 6
    assert "The way-points are not drawn: joint" in workspace.blocks[0].caption
    assert exhibits_of_search(irb1600) == []


def test_the_palletiser_reaches_every_printed_position() -> None:
    """By the printed transforms; the other convention keeps two out of reach, which is no fault."""
    (workspace,) = exhibits_of_motion(shipped("irb460-pso-353"))
    (picture,) = workspace.blocks
    assert picture.name == "workspace"
    assert "standard convention" in picture.caption
    assert "Some joint values reach each of them" in picture.caption
    (far,) = exhibits_of_motion(changed("irb460-pso-353", ('["-0.450", ', '["-2.450", ')))
    assert "the end misses above place by " in far.blocks[0].caption


def test_exhibits_are_sound(stretched: Problem, scatter: TentScatter) -> None:
    sound(lambda: jump_picture(stretched, DURATIONS, title="Jumps"))
    sound(lambda: polygon_picture(WAYPOINTS, printed_vertices(), title="Polygon"))
    sound(lambda: tent_picture(scatter, unit="s", title="Tent"))
