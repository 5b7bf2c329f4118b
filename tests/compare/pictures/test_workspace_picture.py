"""The picture of a workspace: what it draws, what it says, the same bytes each time."""

from __future__ import annotations

import re

import numpy as np
import pytest
from matplotlib.patches import PathPatch, Rectangle
from support.drawn import sound
from trajgap.compare.pictures.workspace import workspace_picture
from trajgap.problem.cases.robot_file import load_robot
from trajgap.problem.errors import TrajgapError
from trajgap.problem.robots.workspace import sample_workspace

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


def test_numbers_are_of_all_samples_though_fewer_are_drawn(monkeypatch):
    from trajgap.compare.pictures import workspace as module

    monkeypatch.setattr(module, "_LARGEST_CLOUD", 50)
    figure = workspace_picture(CLOUD, title="cloud")
    assert len(dots(figure.axes[0])) == 50
    assert "500 positions, seed 7, the first 50 drawn;" in figure.description
    assert "way-points" not in figure.description
    assert figure.title == "cloud"


def test_every_dot_reaches_the_svg_and_no_raster_does():
    document = sound(lambda: workspace_picture(CLOUD, waypoints=PATH))
    assert max(path.count("h0") for path in re.findall(r'\bd="([^"]*)"', document)) == 500


def test_a_flat_workspace_has_no_minus_zero():
    flat = sample_workspace(load_robot("irb460"), 200, 1)
    assert "y 0.000 to 0.000" in workspace_picture(flat).description


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
