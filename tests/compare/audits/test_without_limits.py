"""Without limits every motion can be shortened: no document shows 0 s as an optimum."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from support.one_joint import one_joint
from trajgap.compare.cli import main
from trajgap.compare.gaps import reference_of
from trajgap.nlp import Solution, Status, solve
from trajgap.problem import Limits, Problem, rest_to_rest

SAID = "without limits there is no shortest motion (not checkable)"


def test_terminal_pages_and_json_say_that_there_is_no_shortest_motion(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "free.toml"
    path.write_text(one_joint("0.3, 1.7", "inf", "2.5", "optimal"), encoding="utf-8")
    assert main(["audit", str(path), "--out", str(tmp_path / "out")]) == 0
    shown = capsys.readouterr().out
    assert f"No optimum: {SAID}." in shown
    assert "0.000000" not in shown
    page = (tmp_path / "out" / "fair.md").read_text("utf-8")
    assert f"No optimum: {SAID}." in page
    assert "0.000000 s" not in page
    assert "+0.0 %" not in page.replace("\N{NO-BREAK SPACE}", " ")
    document = json.loads((tmp_path / "out" / "fair.json").read_text("utf-8"))
    steps = document["cases"][0]["waterfalls"][0]["steps"]
    optimum = next(step for step in steps if step["name"].startswith("optimum of the same curve"))
    assert optimum["time"] is None
    assert optimum["time_why"] == SAID
    assert main(["solve", str(path)]) == 0
    shown = capsys.readouterr().out
    assert SAID in shown
    assert "0.000000" not in shown


def test_an_infimum_above_zero_keeps_its_number() -> None:
    """A segment in which nothing moves goes to 0 s; the other one is limited."""
    q = [[0.2], [1.2], [1.2]]
    limited = solve(Problem(q, Limits(velocity=2.0), rest_to_rest(2, 5)))
    assert limited.status is Status.NOT_ATTAINED
    assert limited.boundless is None
    assert limited.infimum == pytest.approx(15 / 16, rel=1e-9)


def test_limits_that_hold_nothing_back_are_not_called_missing() -> None:
    """The total of a motion found is 0.01 s, what it approaches is 0, and a limit is stated."""
    limits = Limits(velocity=float("inf"), acceleration=2.0)
    problem = Problem([[0.0], [1.0]], limits, rest_to_rest(1, 5))
    found = Solution(problem, Status.NOT_ATTAINED, durations=problem.duration_lower + 0.01)
    assert found.boundless is None
    none = Solution(
        problem, Status.NOT_ATTAINED, durations=problem.duration_lower + 0.01, infimum=0.0
    )
    assert none.boundless is not None
    assert "without limits" not in none.boundless


def test_no_total_is_set_beside_an_infimum_that_rounding_keeps_from_zero() -> None:
    problem = Problem([[0.0], [1.0]], Limits(velocity=float("inf")), rest_to_rest(1, 5))
    found = Solution(
        problem, Status.NOT_ATTAINED, durations=problem.duration_lower + 0.01, infimum=3.3e-14
    )
    assert found.best == 0.0
    assert reference_of(found) is None
