"""The arm on several motions: what is drawn is where the arm is, and nothing comes from outside."""

import json
import re

import numpy as np
import pytest
from trajgap.compare.pictures import ArmMotion, arm_picture
from trajgap.problem import Chain, TrajgapError, load_robot

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


def test_the_base_stands_still_and_the_fast_arm_waits_at_its_end() -> None:
    _, data = drawn([motion("slow", 2.0), motion("fast", 1.0)])
    fast, clock = data["arms"][1], np.array(data["clock"])
    waiting = {fast[k] for k in np.flatnonzero(clock >= 1.0)}
    assert len(waiting) == 1
    assert len(set(data["arms"][0])) > 60
    assert data["totals"] == [2.0, 1.0]
    # The base link does not move; the shadow stands on the floor below it.
    bases = {one.split()[0] for one in (*fast, *data["floors"][1])}
    assert len(bases) == 1


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
