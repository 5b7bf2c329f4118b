"""The leaderboard: rows made by hand, whose shares and expected evaluations are counted by hand."""

import random
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from support.small_studies import small_trial
from trajgap.compare import gaps
from trajgap.compare.blocks import brief_board
from trajgap.compare.gaps.leaderboard import read_summaries, summary_of
from trajgap.compare.gaps.rows import failed
from trajgap.problem import CaseError
from trajgap.problem.suite import list_instances


def run(gap: float, at: int, verdict: str = "pass") -> gaps.Row:
    """A run of 100 evaluations with an optimum of 2 s, whose best total is known from ``at`` on."""
    trial = small_trial(reference=gaps.Bracket(2.0, 1.9), budget=100)
    total = 2.0 * (1 + gap)
    return gaps.Row.begun(
        trial,
        evaluations=100,
        reported_time=total,
        feasible_time=total,
        verdict=verdict,
        trace=((at, total),),
    )


def test_a_summary_counts_what_comes_within_each_gap() -> None:
    lost = failed(small_trial(reference=gaps.Bracket(2.0, 1.9), budget=100), "raised")
    rows = [run(0.005, 10), run(0.0005, 40), run(0.00005, 70, "fail"), lost]
    found = summary_of("mine", rows)
    within = dict(zip(gaps.LADDER, found.within, strict=True))
    assert (within[1.0], within[0.01], within[0.001], within[1e-4]) == (2, 2, 1, 0)
    # To 1 %: 10 + 40, and all of the other two; to 0.1 %: 100 + 40 + 200; never to 0.01 %.
    assert found.spent == (250, 340, 400)
    assert (found.runs, found.failed) == (4, 1)
    # Of 0.005 %, 0.05 %, 0.5 % and no answer, the middle two are 0.05 % and 0.5 %.
    assert found.median == pytest.approx(0.00275, rel=1e-3)
    assert np.isinf(found.upper_quartile)  # between 0.5 % and a run without an answer


def made(problem: str, optimizer: str, solved: int, runs: int = 10) -> gaps.Summary:
    """A summary with so many runs at the optimum, of 50 evaluations each; the others spend 100."""
    within = (solved,) * len(gaps.LADDER)
    spent = (50 * solved + 100 * (runs - solved),) * len(gaps.SOLVED)
    return gaps.Summary(
        problem, optimizer, "stretch", 100, runs, 0, 0.0, 0.1 * (solved == 0), 1.0, within, spent
    )


def test_a_board_weighs_problems_alike_and_takes_complete_optimisers_alone() -> None:
    rows = [
        made("a", "good", 10), made("b", "good", 5),
        made("a", "once", 1, runs=1), made("b", "once", 0, runs=1),
        made("a", "bad", 0), made("b", "bad", 0),
        made("a", "begun", 10),
    ]  # fmt: skip
    (board,) = gaps.boards(rows)
    assert board.problems == ("a", "b")
    assert board.missing == ("begun",)
    assert [one.optimizer for one in board.standings] == ["good", "once", "bad"]
    good, once, bad = board.standings
    assert [one.solved[0][0] for one in board.standings] == [0.75, 0.5, 0.0]
    # (50·10 + 50·5 + 100·5)/15 evaluations for each hit.
    assert good.expected[0][0] == pytest.approx(1250 / 15)
    assert once.expected[1][0] == 150.0
    assert np.isinf(bad.expected[2][0])
    # Two problems are drawn: both a, both b, or one of each.
    assert good.solved[0][1:] == (0.5, 1.0)
    (alone,) = gaps.boards([row for row in rows if row.problem == "a"])
    assert [one.optimizer for one in alone.standings[:2]] == ["good", "once"]
    assert alone.missing == ()


def test_the_reference_takes_no_place_of_an_optimiser() -> None:
    (board,) = gaps.boards([made("a", gaps.DESCENT, 10), made("a", "good", 5), made("a", "bad", 0)])
    assert [(one.optimizer, board.place(one)) for one in board.standings] == [
        (gaps.DESCENT, None),
        ("good", 1),
        ("bad", 2),
    ]
    shown = [[cell.text for cell in row[:2]] for row in brief_board(board).rows]
    assert shown == [
        ["–", f"{gaps.DESCENT} (reference, no black box)"], ["1", "good"], ["2", "bad"],
    ]  # fmt: skip


def test_summaries_are_read_as_they_were_written() -> None:
    rows = (made("a", "good", 3), replace(made("a, b", "none", 0), median=float("inf")))
    assert read_summaries(gaps.summaries_text(rows)) == rows


def test_the_study_covers_every_proven_instance_and_its_sample_is_drawn_again() -> None:
    names = [one.name.partition("/")[0] for one in gaps.leaderboard_study().problems]
    proven = [one for one in list_instances() if one.evidence == "certified"]
    assert sorted(names) == sorted(one.name for one in proven)
    classes: dict[tuple[str, str], list[str]] = {}
    for one in proven:
        size = "1 to 3" if one.segments <= 3 else "4 to 6" if one.segments <= 6 else "7 to 10"
        classes.setdefault((one.curve, size), []).append(one.name)
    rng = random.Random("leaderboard")
    drawn = {rng.choice(sorted(classes[key])) for key in sorted(classes)}
    assert set(names[: len(drawn)]) == drawn
    committed = {one.problem.partition("/")[0] for one in gaps.leaderboard_rows()}
    assert committed <= set(names)


HEAD = 'format = 1\nseeds = 2\n[[problems]]\ncase = "suite:353-3x1-a-1"\n'


def test_several_budgets_have_runs_of_their_own() -> None:
    text = f'budget = [100, 1000]\n{HEAD}[[optimizers]]\nname = "random"\nlabel = "draws"\n'
    plan = gaps.parse_study(text, "few.toml", Path())
    assert [trial.budget for trial in plan.trials()] == [100, 100, 1000, 1000]
    assert len(plan) == 4
    assert [label for label, _ in plan.groups()] == ["draws", "draws"]
    with pytest.raises(CaseError, match="named twice"):
        gaps.parse_study(text.replace("1000", "100"), "few.toml", Path())


def test_missing_packages_are_left_out_if_the_file_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "cma", None)
    text = HEAD + '[[optimizers]]\nname = "random"\n[[optimizers]]\nname = "cma"\n'
    with pytest.raises(CaseError, match="pip install cma"):
        gaps.parse_study(text, "few.toml", Path())
    plan = gaps.parse_study(f"installed_only = true\n{text}", "few.toml", Path())
    assert [trial.optimizer for trial in plan.trials()] == ["random"] * 2
    assert "cma" in plan.notes[-1]
