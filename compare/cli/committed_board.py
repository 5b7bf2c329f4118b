"""`bench --against leaderboard`: where optimisers stand among the committed results."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from ...problem import CaseError
from ...problem.cases import SUITE_PREFIX
from ...problem.suite import select_instances
from ..blocks import Prose, brief_board
from ..gaps import (
    LEADERBOARD,
    SOLVED,
    Board,
    Ranked,
    Store,
    StudyPlan,
    StudySession,
    boards,
    leaderboard_rows,
    on_this_machine,
    parse_study,
    run_study,
    summed_up,
)
from .output import NEVER_RAN, progress, rendered, say

BUDGET, SEEDS = 1000, 15
"""Evaluations and seeds of a run against the leaderboard: those of its first table."""
_MIDDLE = SOLVED.index(1e-3)
"""Place of the target by which the leaderboard is sorted: 0.1 %."""


def stand_against(
    word: str,
    source: str | None,
    names: Sequence[str],
    settings: Mapping[str, Mapping[str, Any]],
    seeds: int,
    budget: int,
    handling: str,
    seconds: float,
    workers: int,
    store: Path | None,
) -> int:
    """Run optimisers on the instances of the leaderboard, and print where they stand.

    `word`: what the results are set against: "leaderboard". `source`: instances of the suite; all
    of the committed board by default. `names`: optimisers. `settings`: by optimiser. `seconds`:
    limit of each run. `store`: where runs are kept.
    """
    if word != LEADERBOARD:
        raise CaseError("--against", "", f"{word!r} is unknown; use {LEADERBOARD}")
    board = _board(budget, handling)
    instances = _instances(board, source)
    labels = _labels(names, board)
    plan = _plan(labels, settings, seeds, budget, handling, seconds, instances)
    with ExitStack() as stack:
        path = store or Path(stack.enter_context(TemporaryDirectory()), "runs.sqlite")
        kept = stack.enter_context(Store(path))
        engine = stack.enter_context(on_this_machine(workers))
        step = stack.enter_context(progress("runs", len(plan)))

        def show(now: StudySession) -> None:
            step(f"{now.resumed + now.run:,} of {now.total:,} runs")

        run_study(plan, kept, engine, progress=show)
        own = list(summed_up(plan, kept))
    theirs = [
        row
        for row in leaderboard_rows()
        if (row.budget, row.handling) == (budget, handling)
        and row.problem.partition("/")[0] in instances
    ]
    (found,) = boards([*theirs, *own])
    standing = [one for one in found.standings if one.optimizer in labels]
    many = f"{len(found.problems)} instance{'s' * (len(found.problems) > 1)}"
    say(rendered([
        *(Prose(_said(one, found), "heading") for one in standing),
        Prose(""),
        brief_board(found, labels),
        Prose(
            f"{handling}, {budget:,} evaluations, {many}. Rows with * were run now; the others "
            "are the committed rows of the leaderboard."
        ),
    ]))  # fmt: skip
    return NEVER_RAN if any(one.failed == one.runs for one in standing) else 0


def _board(budget: int, handling: str) -> Board:
    known = boards(leaderboard_rows())
    budgets = sorted({one.budget for one in known})
    handlings = sorted({one.handling for one in known})
    if budget not in budgets:
        said = ", ".join(map(str, budgets))
        raise CaseError("--budget", "", f"the leaderboard has {said} evaluations, not {budget}")
    if handling not in handlings:
        said = " and ".join(handlings)
        raise CaseError("--handling", "", f"the leaderboard has {said}, not {handling!r}")
    return next(one for one in known if (one.budget, one.handling) == (budget, handling))


def _instances(board: Board, source: str | None) -> tuple[str, ...]:
    """Names of instances of the board, those that are asked for."""
    names = [problem.partition("/")[0] for problem in board.problems]
    if source is None:
        return tuple(names)
    asked = {one.name for one in select_instances(source)}
    chosen = tuple(name for name in names if name in asked)
    if not chosen:
        some = ", ".join(SUITE_PREFIX + name for name in names[:3])
        raise CaseError(source, "", f"not an instance of the leaderboard; it has {some}, ...")
    return chosen


def _labels(names: Sequence[str], board: Board) -> dict[str, str]:
    """Optimisers by the labels of their rows, none of which is a committed one."""
    taken = {one.optimizer for one in board.standings} | set(board.missing)
    return {f"{name} (now)" if name in taken else name: name for name in names}


def _plan(
    labels: Mapping[str, str],
    settings: Mapping[str, Mapping[str, Any]],
    seeds: int,
    budget: int,
    handling: str,
    seconds: float,
    instances: Sequence[str],
) -> StudyPlan:
    """The study of these optimisers on these instances, as a study file states it."""
    blocks = [
        f"{{ name = {json.dumps(name)}, label = {json.dumps(label)}, settings = "
        f"{{ {', '.join(f'{json.dumps(k)} = {json.dumps(v)}' for k, v in own.items())} }} }}"
        for label, name in labels.items()
        for own in [settings.get(name, {})]
    ]
    text = (
        f"format = 1\nbudget = {budget}\nseeds = {seeds}\nseconds = {seconds}\n"
        f"handlings = {json.dumps(handling)}\noptimizers = [{', '.join(blocks)}]\n"
        f"[[problems]]\ncase = {json.dumps(SUITE_PREFIX + ','.join(instances))}\n"
    )
    return parse_study(text, "--optimizer", Path())


def _said(one: Ranked, board: Board) -> str:
    """Where an optimiser stands, in a sentence."""
    share = 100 * one.solved[_MIDDLE][0]
    return (
        f"{one.optimizer}: place {board.place(one)} of {len(board.searches)}; {share:.0f} % of "
        f"{one.runs} runs come within 0.1 % of the optimum."
    )
