"""The command `study`: many runs, each stored as it ends, and what they came to."""

from __future__ import annotations

import json
import os
import shlex
import signal
import sys
import time
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import timedelta
from itertools import groupby
from math import inf
from operator import attrgetter
from pathlib import Path

import numpy as np
import typer

from ...problem import CaseError, replace_file
from .. import gaps
from ..audits import in_words
from ..blocks import ONE_BY_ONE, Block, Prose, brief_board, table
from ..documents import noted, percent
from .options import ExitCode, Options, argument, count, option
from .output import interrupted_by, progress, rendered, say


@dataclass(frozen=True, kw_only=True)
class StudyOptions(Options):
    """The study, where it runs, and what is written."""

    file: Path = argument("FILE.toml|leaderboard")
    """Study file (see docs/reference/studies.md), or leaderboard for the study behind the
    leaderboard."""
    store: Path | None = option("FILE", usual="FILE.sqlite")
    """File that keeps finished runs; these are not repeated."""
    workers: int | None = count(usual="one for each core")
    """Number of processes; the rows do not depend on it."""
    dask: str | None = option("ADDRESS")
    """Run on the Dask cluster with this scheduler instead."""
    export: list[Path] | None = option("FILE")
    """Write the rows to a new .csv or .parquet file, or to a new .ioh folder in IOHprofiler's
    format. May be given several times."""
    summary: Path | None = option("FILE.csv")
    """Write one row for each optimiser, problem, handling and budget; an earlier file is
    replaced."""
    retry: bool = option("", False)
    """Repeat failed runs."""


def study(asked: StudyOptions) -> int:
    """Run optimisers on many problems; finished runs are kept.

    Ctrl-C loses nothing that is finished; the same command continues.
    """
    file, store, dask, summary = asked.file, asked.store, asked.dask, asked.summary
    if dask is not None and asked.workers is not None:
        raise typer.BadParameter(
            "--workers cannot be combined with --dask, whose cluster has its own"
        )
    exports = asked.export or []
    shipped = file == Path(gaps.LEADERBOARD)
    path = store or file.with_suffix(".sqlite")
    if path == file:
        raise CaseError(str(path), "--store", "is the study file itself; give another")
    for one in exports:
        gaps.check_export(one)
        if exports.count(one) > 1:
            raise CaseError(str(one), "--export", "is named twice; name it once")
    if summary is not None and summary.suffix != ".csv":
        raise CaseError(str(summary), "--summary", "is not a .csv file; give one")
    plan = gaps.leaderboard_study() if shipped else gaps.load_study(file)
    again = ["trajgap", "study", str(file), *_options("--store", [] if store is None else [store])]
    cores = asked.workers or os.cpu_count() or 1
    engines = gaps.on_this_machine(cores) if dask is None else gaps.on_dask(dask)
    with gaps.Store(path) as kept:
        session = gaps.StudySession(total=len(plan), resumed=0)
        try:
            with engines as engine, progress("study", len(plan)) as step:
                begun = time.monotonic()

                def show(now: gaps.StudySession) -> None:
                    nonlocal session
                    session = now
                    step(_going(now, time.monotonic() - begun))

                step("the optima from which gaps are measured")
                # Ctrl-C ends the session with its tally, instead of the program at once.
                with interrupted_by(signal.default_int_handler):
                    session = gaps.run_study(plan, kept, engine, retry=asked.retry, progress=show)
        except KeyboardInterrupt:
            rest = [*([] if dask is None else ["--dask", dask]), *_options("--export", exports)]
            done = f"{session.resumed + session.run:,} of {session.total:,} runs are stored"
            command = shlex.join([*again, *rest])
            said = f"interrupted; {done}; `{command}` continues from there"
            print(f"\ntrajgap: {said}", file=sys.stderr)
            return ExitCode.INTERRUPTED
        for one in exports:
            gaps.export_rows(gaps.study_rows(plan, kept), one)
        if summary is not None:
            replace_file(summary, gaps.summaries_text(gaps.summed_up(plan, kept)))
        parts, never_ran = _summary(plan, kept, session, path, exports, again)
        say(rendered(parts))
    return ExitCode.AGAINST if never_ran else 0


_COLUMNS = ("optimiser", "~settings", "handling", ">budget", ">runs", ">failed", ">feasible",
            ">best gap", ">median gap")  # fmt: skip
"""What a table says of the runs of one optimiser under one settings."""
_NAMED = attrgetter("problem", "reading", "optimizer", "settings", "handling", "budget")
"""What the runs of a row of such a table have in common."""


def _options(name: str, paths: Sequence[Path]) -> list[str]:
    return [word for one in paths for word in (name, str(one))]


def _going(now: gaps.StudySession, seconds: float) -> str:
    done = now.resumed + now.run
    words = f"{done:,} of {now.total:,} runs"
    if now.run and seconds:
        rate = now.run / seconds
        left = timedelta(seconds=round(now.left / rate))
        words += f", {rate:.3g} a second, {left} left"
    return words + (f", {now.failed:,} failed" if now.failed else "")


def _summary(
    plan: gaps.StudyPlan,
    kept: gaps.Store,
    session: gaps.StudySession,
    path: Path,
    exports: Sequence[Path],
    again: Sequence[str],
) -> tuple[list[Block], bool]:
    """What the runs came to, and whether all of some optimiser on some problem failed."""
    found: dict[tuple[str, str], list[tuple[object, ...]]] = {}
    messages, never_ran = Counter[str](), False
    for (problem, reading, *named), group in groupby(gaps.study_rows(plan, kept), _NAMED):
        runs = list(group)
        bad = [row.message for row in runs if row.status is gaps.RowStatus.FAILED]
        messages.update(bad)
        never_ran |= len(bad) == len(runs)
        passed = sum(row.feasible for row in runs)
        optimizer, settings, handling, budget = named
        # Words that a narrow column can break between.
        own = [f"{name} {json.dumps(value)}" for name, value in json.loads(settings).items()]
        said = optimizer, ", ".join(own) or "its own", handling, f"{budget:,}"
        # Least and median gap; a run without a feasible time counts as infinite.
        ends = [inf if row.feasible_gap is None else row.feasible_gap[0] for row in runs]
        best_and_median = [percent(gap) for gap in gaps.quantiles(np.array(ends), [0.0, 0.5])]
        if all(row.reference_upper is None for row in runs):
            best_and_median = ["no optimum", ""]
        cells = (*said, len(runs), len(bad), passed, *best_and_median)
        found.setdefault((problem, reading), []).append(cells)
    parts: list[Block] = [
        Prose(
            f"{path}: {session.run:,} runs were done now, {session.resumed:,} were already stored",
            "heading",
        ),
        *(_boards(plan, kept) if plan.file == gaps.LEADERBOARD else _tables(plan, found)),
        Prose("A gap is that of the feasible time, (T − U)/U against the best known total U."),
    ]
    # Five are printed; the store and the exports have all.
    for message, times in messages.most_common(5):
        parts.append(Prose(f"failed, {times:,} times: {message}", "warning"))
    if len(messages) > 5:
        parts.append(Prose(f"and {len(messages) - 5:,} other messages (see the exports)"))
    if session.run:
        parts.append(Prose(f"{session.seconds / session.run:.3g} s a run", "note"))
    parts += [Prose(f"written: {one}") for one in exports]
    if messages:
        parts.append(Prose(f"to repeat the failed runs: {shlex.join([*again, '--retry'])}"))
    if not exports:
        name = f"{Path(plan.file).stem}.csv"
        parts.append(Prose(f"next: {shlex.join([*again, '--export', name])}"))
    return parts, never_ran


def _tables(
    plan: gaps.StudyPlan, found: Mapping[tuple[str, str], Sequence[Sequence[object]]]
) -> list[Block]:
    """What the runs on each problem came to, with what was chosen for it."""
    if len(plan.problems) > ONE_BY_ONE:
        rows = [(*ids, *cells) for ids, each in found.items() for cells in each]
        own = [f"{_words(one)}: {note}" for one in plan.problems for note in one.notes]
        notes = dict.fromkeys([*plan.notes, *own])
        return [table(("problem", "reading", *_COLUMNS), rows), *map(Prose, notes)]
    parts: list[Block] = []
    for one in plan.problems:
        ids = (one.name, one.reading)
        parts.append(Prose(noted(_words(one), ", ".join(ids))))
        parts.append(table(_COLUMNS, found.get(ids, ())))
        parts += [Prose(note, "note") for note in (*plan.notes, *one.notes)] + [Prose("")]
    return parts


def _boards(plan: gaps.StudyPlan, kept: gaps.Store) -> list[Block]:
    """Where each optimiser stands over all problems: their own lines would be thousands."""
    parts: list[Block] = []
    for board in gaps.boards(gaps.summed_up(plan, kept)):
        head = f"{board.handling}, {board.budget:,} evaluations, {len(board.problems)} instances"
        parts.append(Prose(head, "heading"))
        parts.append(brief_board(board))
        if board.missing:
            parts.append(Prose(f"not complete: {', '.join(board.missing)}"))
        parts.append(Prose(""))
    return [*parts, *(Prose(note, "note") for note in plan.notes)]


def _words(one: gaps.StudyProblem) -> str:
    """What a problem of a study is called."""
    joint = "" if one.joint is None else f"joint {one.joint} alone; "
    return f"{joint}{in_words(one.case, one.problem_id, one.reading)}"
