"""Audits of curves with virtual breaks: what durations alone do not say, and other segments."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from trajgap.compare import ClaimVerdict, audit, write_report
from trajgap.compare.audits import CaseAudit
from trajgap.compare.audits.total_bound import excludes_total
from trajgap.problem import Limits, Problem, parse_case, quintic_spline

CASE = """
format = 1
id = "free-case"
title = "Two joints"
[source]
year = 2024
[robot]
name = "example arm"
joints = ["1", "2"]
[units]
position = "rad"
velocity = "rad/s"
acceleration = "rad/s^2"
jerk = "rad/s^3"
time = "s"
[waypoints]
where = "Table 1"
waypoint_rows = [["0.3", "-1.0"], ["0.9", "-0.55"], ["0.2", "0.35"], ["-0.45", "0.1"]]
[limits]
where = "Table 2"
velocity = [1.1, 1.7]
acceleration = [3.0, 2.2]
jerk = [20, 15]
[durations]
lower = 0.2
[interpolant]
family = "quintic-spline"
virtual = [2]
free = 1
[[readings]]
id = "free"
why = "The text says that the optimiser places one way-point."
default = true
[[readings]]
id = "virtual"
why = "Fig. 3 shows two virtual way-points."
[readings.interpolant]
family = "quintic-spline-virtual"
[[claims]]
id = "total"
quantity = "total_time"
where = "abstract"
value = "2.9"
[[claims]]
id = "four"
quantity = "durations"
where = "Table 3"
durations = ["0.98", "0.89", "0.20", "0.94"]
total = "3.01"
[[claims]]
id = "kept"
quantity = "statement"
where = "text"
checks = "within_limits"
of = ["four"]
[[claims]]
id = "peak"
quantity = "peak"
where = "Table 4"
derivative = "velocity"
values = ["1.1", "1.7"]
of = "four"
[[claims]]
id = "shortest"
quantity = "statement"
where = "text"
checks = "optimal"
of = ["four"]
"""


@pytest.fixture(scope="module")
def one(tmp_path_factory: pytest.TempPathFactory) -> CaseAudit:
    report = audit(parse_case(CASE, "free.toml"), seeds=2, certify_seconds=0)
    folder: Path = tmp_path_factory.mktemp("pages")
    write_report(report, folder)
    return report.cases[0]


def verdict(one: CaseAudit, claim: str) -> ClaimVerdict:
    return next(j.verdict for j in one.judgements if j.claim == claim)


def test_durations_alone_say_nothing_of_limits_and_peaks(one: CaseAudit) -> None:
    assert verdict(one, "kept") is verdict(one, "peak") is ClaimVerdict.NOT_CHECKABLE
    why = (
        "Not computed: the curve (C4 quintic spline, 1 virtual way-point) leaves 1 coefficient per "
        "joint free, so that durations alone define no motion."
    )
    without = {(f.claim, f.reading) for f in one.findings if f.message == why}
    assert without == {("four", "free"), ("kept", "free"), ("peak", "free")}


def test_a_total_alone_is_excluded_by_speed_alone() -> None:
    q = np.array([[0.3, -1.0], [0.9, -0.55], [0.2, 0.35], [-0.45, 0.1]])
    limits = Limits([1.1, 1.7], [3.0, 2.2], [20.0, 15.0])
    # Every duration has a lower bound, so that a search over them would start.
    problem = Problem(q, limits, quintic_spline(4, virtual=(2,)), duration_lower=0.3)
    assert excludes_total(problem, 2.0) is False
    # 0.6 rad at 1.1 rad/s, 0.3 s twice, 0.65 rad at 1.1 rad/s: 1.736 s.
    assert excludes_total(problem, 1.73) is True


def test_totals_are_set_beside_the_optimum_over_durations_and_positions(one: CaseAudit) -> None:
    found = {f.claim: f for f in one.findings if f.rule == "TG302" and f.reading == "free"}
    assert found["shortest"].verdict is ClaimVerdict.SUPPORTED
    assert found["total"].verdict is ClaimVerdict.NOT_CHECKABLE
    # 2.99625 s, which SLSQP finds too: tests/nlp/optimum/test_free_way_points.py.
    assert "the best known optimum with shared durations, 2.996246 s" in found["total"].message


def test_a_reading_with_other_segments_has_no_printed_motion(one: CaseAudit) -> None:
    steps = {w.reading: {s.name: s for s in w.steps} for w in one.waterfalls}
    assert str(steps["virtual"]["feasible after repair"].time) == (
        "the curve (C4 quintic spline with two virtual way-points) has 5 segments, but 4 "
        "durations are printed"
    )
    assert steps["virtual"]["published"].time == pytest.approx(3.01)
    found = [f for f in one.findings if f.rule == "TG109"]
    assert [(f.claim, f.reading) for f in found] == [("four", "virtual")]
