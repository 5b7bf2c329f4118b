"""What `show` and `audit` print of a paper on a compromise that prints a total and means alone."""

from __future__ import annotations

from pathlib import Path

import pytest
from support.command_line import IRB, Run
from trajgap.compare.audits import Study
from trajgap.problem import load_case

MEANS = "".join(
    f"""
[[claims]]
id = "mean-{name}"
quantity = "measure"
where = "Table 4"
derivative = "{name}"
measure = "mean"
value = "1.5"
"""
    for name in ("velocity", "acceleration")
)
CASE = f"""
format = 1
id = "compromise"
title = "One joint, a compromise"
objective = "time and jerk, weighted"
[source]
note = "Made up."
[robot]
name = "One joint"
joints = ["1"]
[units]
position = "rad"
velocity = "rad/s"
acceleration = "rad/s^2"
time = "s"
[waypoints]
joint_rows = [[0, 1, 0.5, 2]]
[limits]
velocity = 1
[interpolant]
family = "3-5-3"
[[claims]]
id = "total"
quantity = "total_time"
where = "abstract"
value = "18.0"
{MEANS}
"""


@pytest.fixture(autouse=True)
def case(folder: Path) -> None:
    (folder / "c.toml").write_text(CASE, encoding="utf-8")


def test_show_says_what_is_minimised(run: Run) -> None:
    _, out, _ = run("show", "c.toml")
    assert "minimised: time and jerk, weighted, not time alone" in out
    _, out, _ = run("show", "irb460-pso-353")
    assert "minimised" not in out


def test_the_summary_says_why_claims_are_not_checkable_each_reason_once(run: Run) -> None:
    _, out, _ = run("audit", "c.toml", "--certify-seconds", "0", "--out", "pages")
    assert "not checkable, 2 claims: No durations are printed of whose motion" in out
    assert out.count("No durations are printed of whose motion") == 1
    assert "18.0 s was not minimised for time alone" in out
    assert "not checkable, abstract" not in out


def test_solve_names_a_problem_by_its_id_once_and_then_by_its_words(run: Run) -> None:
    out = run("solve", IRB)[1]
    plain = " ".join(out.split())
    options = ("--problem limit-80", "--problem limit-110", "--reading waypoints-rad")
    assert all(out.count(one) == 1 for one in options)
    ids = ("limit-80", "limit-110", "waypoints-rad", "waypoints-deg")
    assert all(out.count(one) == 1 for one in ids)
    assert "could jump (Shortest time of joint 5 under 80 °/s; way-points in radians)" in plain


def test_what_an_audit_is_doing_is_said_in_words() -> None:
    said: list[str] = []
    study = Study(load_case(IRB), seeds=2, certify_seconds=0, progress=said.append)
    study.claim_rounding(study.case.claim("durations-110"), "limit-110", "waypoints-rad")
    assert said == [
        f"{IRB}: rounding of Table 4, column 110 °/s; Shortest time of joint 5 under 110 °/s; "
        "way-points in radians"
    ]
