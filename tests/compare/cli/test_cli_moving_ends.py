"""`solve --certify` where joints start or finish in motion: what is proved, and what is said."""

from __future__ import annotations

from pathlib import Path

from support.command_line import Run, strict

MOVING = """
format = 1
id = "moving"
title = "Moving"
source = { year = 2020 }
robot = { name = "arm", joints = ["a", "b"] }
units = { position = "rad", velocity = "rad/s", acceleration = "rad/s^2", time = "s" }
waypoints = { joint_rows = [["0", "1", "0.4"], ["0.2", "-0.3", "0.5"]] }
limits = { velocity = [2, 1.5], acceleration = [5, 4] }
interpolant = { family = "cubic-spline", end_derivatives = [[0.5, -0.2]], finish_derivatives = [0] }
"""
"""A joint that starts forwards and one that starts backwards."""


def test_ends_in_motion_have_a_bound_over_any_curve_and_no_other_proof(run: Run) -> None:
    Path("moving.toml").write_text(MOVING, encoding="utf-8")
    code, out, err = run("solve", "moving.toml", "--certify")
    assert (code, err) == (3, "")
    assert "no proof covers such a curve yet; what --any-curve proves" in " ".join(out.split())
    assert not Path("trajgap-certificates").exists()
    code, _, err = run("solve", "moving.toml", "--certify", "--any-curve", "--out", "c.json")
    assert (code, err) == (0, "")
    (found,) = strict(Path("c.json").read_text())["intervals"]
    run("solve", "moving.toml", "--out", "s.json")
    (solved,) = strict(Path("s.json").read_text())["results"]
    assert 0 < found["lower"] < solved["total_time"]
    code, out, err = run("verify", found["certificate"], "--case", "moving.toml")
    assert (code, err) == (0, "")
    assert "proves" in out
