"""The command `bench`: optimisers against the optimum, or among the committed results."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from dataclasses import MISSING, dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import typer

from ...heuristics import KINDS, optimizer_name
from ...nlp import Solution
from ...problem import Case, CaseError, Coupling, TrajgapError
from ...problem.cases import SUITE_PREFIX
from ...problem.suite import instance_of, select_instances
from .. import gaps, pages
from ..audits import asked_as
from ..blocks import ONE_BY_ONE, Block, Prose, bench_blocks, brief_board, overall_blocks
from ..documents import SHOWN_GAPS, BenchDocument, BenchResult, Reference, noted
from .input import Selected, naming, read_case, select
from .options import ExitCode, Options, argument, count, option
from .output import emit, progress, rendered, say


@dataclass(frozen=True, kw_only=True)
class BenchOptions(Options):
    """The problem and the optimisers."""

    case: str | None = argument(
        "CASE|FILE|SUITE", None, usual="with --against: all instances of the leaderboard"
    )
    """Id of a published case, a case file, suite:NAME, several as suite:A,B or suite:353-*, or
    suite for all."""
    optimizer: list[str] = option("A,B,...", MISSING)
    """The papers' pso, mnam-pso, ga, woa..., or scipy:differential_evolution, mealpy:OriginalWOA,
    pymoo:DE, pygmo:sade, cma, or your own module:function."""
    settings: list[str] | None = option("NAME=JSON", None, "--set")
    """Settings of an optimiser: pso='{"particles": 20}'. Else the paper's."""
    problem: str | None = option("ID")
    """Only this problem of the case."""
    reading: str | None = option("ID")
    """Use this reading instead of the default one."""


@dataclass(frozen=True, kw_only=True)
class RunOptions(Options):
    """How each optimiser is run."""

    seeds: int | None = count(usual="30; 15 with --against")
    """Number of runs of each optimiser."""
    budget: int | None = option(
        "", min=1, max=10**7,
        usual="6000; a paper's algorithm makes its own iterations; 1000 with --against",
    )  # fmt: skip
    """Number of evaluations of each run."""
    handling: str = option("death-penalty|stretch|rescale", "death-penalty")
    """Treatment of durations that break a limit."""
    baselines: bool = option("", True, "--baselines/--no-baselines")
    """Random search, equal durations, local searches, CMA-ES with repair."""
    seconds: float = option("SECONDS", gaps.SECONDS, "--time", min=0.001)
    """Time limit of each run."""
    workers: int = count(1)
    """Number of processes; the rows do not depend on it."""
    store: Path | None = option("FILE")
    """File that keeps finished runs; these are not repeated."""


@dataclass(frozen=True, kw_only=True)
class ReportOptions(Options):
    """How the result is shown."""

    as_json: bool = option("", False, "--json")
    """Print JSON; write a page only with --out."""
    out: Path | None = option("FOLDER", usual="trajgap-bench")
    """Folder for the page: new, empty, or that of an earlier bench, which is replaced."""
    against: str | None = option("leaderboard")
    """Show where the optimisers rank among committed results."""


def bench(question: BenchOptions, run: RunOptions, shown: ReportOptions) -> int:
    """Show how far optimisers end from the optimum of a case or suite."""
    case, problem, reading = question.case, question.problem, question.reading
    as_json, out, against = shown.as_json, shown.out, shown.against
    named = (name for text in question.optimizer for name in text.split(","))
    chosen = [optimizer_name(name) for name in named if name]
    set_here = _settings(question.settings or [])
    if against is not None:
        unused = {"--json": as_json, "--out": out, "--problem": problem, "--reading": reading}
        for name, value in unused.items():
            if value:
                raise typer.BadParameter(f"{name} cannot be combined with --against")
        if against != gaps.LEADERBOARD:
            raise CaseError("--against", "", f"{against!r} is unknown; use {gaps.LEADERBOARD}")
        return _stand_among(case, chosen, set_here, run)
    if case is None:
        raise typer.BadParameter("name a CASE, FILE or SUITE, or --against leaderboard")
    # One case, or the instances of the suite that are named.
    several = case == SUITE_PREFIX.rstrip(":") or (
        case.startswith(SUITE_PREFIX) and any(sign in case for sign in ",*?[")
    )
    cases = [one.case() for one in select_instances(case)] if several else [read_case(case)]
    folder = out if out is not None or as_json else Path("trajgap-bench")
    if folder is not None:
        pages.check_bench_folder(folder)
    asked = []
    for stated in cases:
        own = _own(stated, chosen, iterations=run.budget is None)
        settled = own | {
            name: {**own.get(name, {}), **changed} for name, changed in set_here.items()
        }
        with naming(stated.file):
            for one in select(stated, problem, reading or stated.default_reading.id, "shared"):
                plan = gaps.plan_bench(
                    one.problem,
                    chosen,
                    seeds=run.seeds or gaps.SEEDS,
                    budget=run.budget,
                    handling=run.handling,
                    settings=settled,
                    baselines=run.baselines,
                    name=stated.id if len(cases) > 1 else f"{stated.id}/{one.problem_id}",
                    reading="" if len(cases) > 1 else one.reading_id,
                    seconds=run.seconds,
                )
                own_coupling = stated.problem(one.problem_id, one.reading_id).coupling
                if own_coupling is not Coupling.SHARED and len(one.problem.joints) > 1:
                    note = (
                        "The case searches each joint separately; here all joints share their "
                        "durations. The audit compares the paper's total with another optimum, "
                        "which follows from the joints' own optima."
                    )
                    plan = replace(plan, notes=(note, *plan.notes))
                asked.append(_Asked(stated, one, plan))
    results = _run(asked, run)
    if folder is not None:
        pages.write_bench(results, folder)
    emit(pages.bench_document(results), _tables, as_json)
    if folder is not None and not as_json:
        say(f"page: {folder / 'index.html'}\n")
    every = [one for result, _ in results for one in result.standings]
    return ExitCode.AGAINST if any(one.failed == one.runs for one in every) else 0


def _settings(texts: Sequence[str]) -> dict[str, dict[str, Any]]:
    """Settings given as ``NAME={"key": value}``."""
    found = {}
    for text in texts:
        name, equals, value = text.partition("=")
        try:
            values = json.loads(value) if equals else None
        except ValueError:
            values = None
        if not isinstance(values, dict):
            raise CaseError(
                "--set", "", f'{text!r} is not NAME={{"setting": value}}; give JSON after the ='
            )
        found[optimizer_name(name)] = values
    return found


def _own(case: Case, chosen: Sequence[str], iterations: bool) -> dict[str, dict[str, Any]]:
    """Settings of the paper's own algorithms; a budget takes the place of its iterations."""
    found: dict[str, dict[str, Any]] = {}
    for block in case.algorithms:
        if block.kind in chosen and block.kind in KINDS:
            values = dict(block.parameters)
            if not iterations:
                values.pop("iterations", None)
            # An infinite penalty is every algorithm's default, and JSON knows no infinity.
            found[block.kind] = {
                k: v for k, v in values.items() if not (isinstance(v, float) and math.isinf(v))
            }
    return found


@dataclass(frozen=True, eq=False)
class _Asked:
    """One problem with its runs, before they are made."""

    case: Case
    selected: Selected
    plan: gaps.BenchPlan

    @property
    def words(self) -> str:
        """What a reader calls case, problem and reading, with the ids that a command takes."""
        case = self.case
        name = case.id if instance_of(case) is None else f"{SUITE_PREFIX}{case.id}"
        head = noted(case.title, "" if name == case.title else name)
        if len(case.problems) == len(case.readings) == 1:
            return head
        return f"{head}; {asked_as(case, self.selected.problem_id, self.selected.reading_id)}"


def _run(asked: Sequence[_Asked], run: RunOptions) -> list[tuple[BenchResult, gaps.Runs]]:
    results = []
    with progress("solve", len(asked)) as solving:
        optima = []
        for one in asked:
            solving(f"the optimum: {one.words}")
            with naming(one.case.file):
                optima.append(_optimum(one.case, one.selected))
    with ExitStack() as stack:
        store = None if run.store is None else stack.enter_context(gaps.Store(run.store))
        engine = stack.enter_context(gaps.on_this_machine(run.workers))
        total = sum(len(one.plan.trials) for one in asked)
        step = stack.enter_context(progress("first runs", total, rate=True))
        for one, optimum in zip(asked, optima, strict=True):
            with naming(one.case.file):
                runs = gaps.run_bench(one.plan, engine, lambda row: step.done(row.optimizer), store)
                result = gaps.measure_gaps(runs, optimum).model_copy(update={"words": one.words})
                results.append((result, runs))
    return results


def _optimum(case: Case, one: Selected) -> Solution | Reference:
    """What is known of the optimum, which is certified where a certificate is shipped."""
    ids = (one.problem_id, one.reading_id)
    found = gaps.known_optimum(case, one.problem, case.statement(*ids))
    if isinstance(found, Solution) and not 0 < found.best < math.inf:
        raise TrajgapError(
            f"{case.file}: {asked_as(case, *ids)}: no positive optimum from which gaps could be "
            f"measured ({found.why or found.status})"
        )
    return found


def _tables(document: BenchDocument) -> list[Block]:
    note = (
        "Evaluations to a gap: the number that restarts need on average until one run reaches it; "
        "it may exceed the budget of one run."
    )
    parts: list[Block] = []
    if document.overall:
        parts += overall_blocks(document.overall)
    for result in document.results if len(document.results) <= ONE_BY_ONE else ():
        parts += [Prose(result.title, "heading"), *bench_blocks(result)]
        beyond = any(
            isinstance(target.evaluations, float) and target.evaluations > result.budget
            for one in result.standings
            for target in one.targets
            if target.gap in SHOWN_GAPS
        )
        parts += [Prose(note, "note"), Prose("")] if beyond else [Prose("")]
    return parts


_MIDDLE = gaps.SOLVED.index(1e-3)
"""Place of the target by which the leaderboard is sorted: 0.1 %."""


def _stand_among(
    source: str | None,
    names: Sequence[str],
    settings: Mapping[str, Mapping[str, Any]],
    run: RunOptions,
) -> int:
    """Run optimisers on instances of the leaderboard, all by default, and print where they stand.

    Evaluations and seeds are by default those of the leaderboard's first table.
    """
    budget, handling = run.budget or 1000, run.handling
    board = _board(budget, handling)
    instances = _instances(board, source)
    # None of the labels is one of the committed rows.
    taken = {one.optimizer for one in board.standings} | set(board.missing)
    labels = {f"{name} (now)" if name in taken else name: name for name in names}
    stated = {
        "format": 1,
        "budget": budget,
        "seeds": run.seeds or 15,
        "seconds": run.seconds,
        "handlings": handling,
        "optimizers": [
            {"name": name, "label": label, "settings": dict(settings.get(name, {}))}
            for label, name in labels.items()
        ],
        "problems": [{"case": SUITE_PREFIX + ",".join(instances)}],
    }
    plan = gaps.study_of(stated, "--optimizer", Path())
    with ExitStack() as stack:
        path = run.store or Path(stack.enter_context(TemporaryDirectory()), "runs.sqlite")
        kept = stack.enter_context(gaps.Store(path))
        engine = stack.enter_context(gaps.on_this_machine(run.workers))
        step = stack.enter_context(progress("runs", len(plan)))

        def show(now: gaps.StudySession) -> None:
            step(f"{now.resumed + now.run:,} of {now.total:,} runs")

        gaps.run_study(plan, kept, engine, progress=show)
        own = list(gaps.summed_up(plan, kept))
    theirs = [
        row
        for row in gaps.leaderboard_rows()
        if (row.budget, row.handling) == (budget, handling)
        and row.problem.partition("/")[0] in instances
    ]
    (found,) = gaps.boards([*theirs, *own])
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
    return ExitCode.AGAINST if any(one.failed == one.runs for one in standing) else 0


def _board(budget: int, handling: str) -> gaps.Board:
    known = gaps.boards(gaps.leaderboard_rows())
    budgets = sorted({one.budget for one in known})
    handlings = sorted({one.handling for one in known})
    if budget not in budgets:
        said = ", ".join(map(str, budgets))
        raise CaseError("--budget", "", f"the leaderboard has {said} evaluations, not {budget}")
    if handling not in handlings:
        said = " and ".join(handlings)
        raise CaseError("--handling", "", f"the leaderboard has {said}, not {handling!r}")
    return next(one for one in known if (one.budget, one.handling) == (budget, handling))


def _instances(board: gaps.Board, source: str | None) -> tuple[str, ...]:
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


def _said(one: gaps.Ranked, board: gaps.Board) -> str:
    """Where an optimiser stands, in a sentence."""
    share = 100 * one.solved[_MIDDLE][0]
    return (
        f"{one.optimizer}: place {board.place(one)} of {len(board.searches)}; {share:.0f} % of "
        f"{one.runs} runs come within 0.1 % of the optimum."
    )
