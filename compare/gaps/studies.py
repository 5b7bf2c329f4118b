"""A study file: problems × optimisers × settings × handlings × seeds, in one fixed order."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from decimal import Decimal
from functools import partial
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, BeforeValidator, Field

from ...heuristics import Bounds, Handling, find_optimizer, judge_of, optimizer_name, search_box
from ...problem import (
    Case,
    CaseError,
    Coupling,
    PackageError,
    Problem,
    Strict,
    TrajgapError,
    load_case,
    parse_toml,
    published_ids,
    read_text,
)
from ...problem.cases import SUITE_PREFIX, check_format, validated
from ...problem.suite import select_instances
from .benching import (
    WITHOUT_DRAWS,
    Entrant,
    bounds_note,
    budget_notes,
    first_range,
)
from .optimality_gap import bracket_of
from .rows import Bracket, Trial, canonical
from .store import Store
from .trials import DESCENT


def _several(raw: object) -> object:
    """One value stands for a list of one."""
    return raw if isinstance(raw, list | tuple) else [raw]


def _plain(raw: object) -> object:
    """Numbers as JSON knows them: the reader of TOML leaves decimals exact."""
    if isinstance(raw, Decimal):
        return float(raw)
    if isinstance(raw, dict):
        return {str(key): _plain(value) for key, value in raw.items()}
    return [_plain(value) for value in raw] if isinstance(raw, list) else raw


Ids = Annotated[tuple[str, ...], BeforeValidator(_several), Field(min_length=1)]
"""One id, or several."""
Budgets = Annotated[
    tuple[Annotated[int, Field(strict=True, ge=1, le=10**9)], ...],
    BeforeValidator(_several),
    Field(min_length=1),
]
"""One number of evaluations, or several: every run is made within each."""
Settings = Annotated[
    tuple[Annotated[dict[str, Any], BeforeValidator(_plain)], ...],
    BeforeValidator(_several),
    Field(min_length=1),
]
"""One table of settings, or several: each is run."""


class ProblemsBlock(Strict):
    """Problems of one case that are searched."""

    case: Annotated[str, Field(min_length=1)]
    """Id of a published case, instances as "suite:353-*", or path of a case file, from the folder
    of the study file."""
    problems: Ids | None = None
    """Ids of its problems; all by default."""
    readings: Ids | None = None
    """Ids of its readings; all by default."""
    coupling: Coupling | None = None
    """Instead of what the case says. Under "per-joint" each joint is a problem of its own."""


class OptimizerBlock(Strict):
    """An optimiser, under one or several settings."""

    name: Annotated[str, Field(min_length=1), AfterValidator(optimizer_name)]
    """As `trajgap bench --optimizer` takes it."""
    settings: Settings = ({},)
    """What is left out takes the optimiser's own default."""
    label: str = ""
    """Its name in summaries; by default the optimiser's, with its settings if it has some."""


class StudyFile(Strict):
    """The content of a study file."""

    format: Literal[1]
    """Version of the format."""
    problems: Annotated[tuple[ProblemsBlock, ...], Field(min_length=1)]
    """Problems to search."""
    optimizers: Annotated[tuple[OptimizerBlock, ...], Field(min_length=1)]
    """Optimisers to run on each of them."""
    handlings: Annotated[tuple[Handling, ...], BeforeValidator(_several), Field(min_length=1)] = (
        Handling.DEATH_PENALTY,
    )
    """Treatment of vectors that break a limit."""
    seeds: Annotated[int, Field(strict=True, ge=1, le=10**6)] = 30
    """Number of seeds: independent runs of each combination."""
    first_seed: Annotated[int, Field(strict=True, ge=0, le=2**62)] = 0
    """The first of them; the others follow it."""
    budget: Budgets | None = None
    """Evaluations of each run; the objective enforces it. Several are runs of their own, the first
    budget first. Without it a paper's algorithm makes its own iterations, and anything else has
    6000."""
    installed_only: bool = False
    """Whether optimisers whose package is missing are left out, instead of refused."""
    seconds: Annotated[float, Field(gt=0, le=86_400.0)] = 600.0
    """A run that takes longer has failed."""


@dataclass(frozen=True, eq=False)
class StudyProblem:
    """One problem of a study."""

    name: str
    reading: str
    """As rows state them."""
    case: Case
    """Where it is stated."""
    problem_id: str
    """Its id there."""
    joint: str | None
    """The joint that is searched separately; None for all joints together."""
    problem: Problem
    """As stated."""
    box: Bounds
    """Box in which durations are searched."""
    stream: tuple[int, ...]
    """Part of the spawn key of its random numbers: (j,) for joint j of several."""
    solve: Callable[[], Bracket | None]
    """Returns the interval of the optimum of the problem as stated."""
    notes: tuple[str, ...]
    """Choices that were made so that optimisers can search it."""


@dataclass(frozen=True, eq=False)
class StudyPlan:
    """The runs that a study file specifies."""

    file: str
    document: StudyFile
    problems: tuple[StudyProblem, ...]
    missing: tuple[str, ...] = ()
    """Why optimisers were left out."""

    def __len__(self) -> int:
        """Number of its trials."""
        asked = self.document
        runs = sum(len(one.settings) * _seeds(one.name, asked) for one in asked.optimizers)
        return len(self.problems) * len(asked.handlings) * len(asked.budget or [None]) * runs

    def trials(self, store: Store | None = None) -> Iterator[Trial]:
        """Every trial, one by one, in an order that the file alone determines.

        `store`: provides and stores the optima from which gaps are measured; without it, rows have
        no gaps.
        """
        for _, trials in self.groups(store):
            yield from trials

    def groups(self, store: Store | None = None) -> Iterator[tuple[str, tuple[Trial, ...]]]:
        """Groups of trials that differ only in their seeds, with the label of their optimiser."""
        asked = self.document
        for budget in asked.budget or (None,):
            for entry in self.problems:
                first = Trial(
                    entry.problem, entry.name, entry.reading, "",
                    stream=entry.stream, seconds=asked.seconds,
                )  # fmt: skip
                if store is not None:
                    reference = store.optimum(first.problem_sha256, entry.solve)
                    first = replace(first, reference=reference)
                for one in self._entrants():
                    drawn = first_range(one.optimizer, one.settings, entry.box)
                    entrant = replace(one, settings={**one.settings, **drawn})
                    seeds = range(asked.first_seed, asked.first_seed + asked.seeds)
                    yield one.label, entrant.trials(first, budget, seeds)

    @property
    def notes(self) -> tuple[str, ...]:
        """Notes on budgets that the file does not state, and on what was left out."""
        budget = None if self.document.budget is None else self.document.budget[0]
        entrants = [replace(one, label=one.optimizer) for one in self._entrants()]
        return (*dict.fromkeys(budget_notes(entrants, budget)), *self.missing)

    def _entrants(self) -> Iterator[Entrant]:
        for optimizer in self.document.optimizers:
            for settings in optimizer.settings:
                for handling in self.document.handlings:
                    label = _label(optimizer, settings)
                    yield Entrant(optimizer.name, settings, str(handling), label)


def _label(optimizer: OptimizerBlock, settings: dict[str, Any]) -> str:
    return optimizer.label or f"{optimizer.name} {canonical(settings) if settings else ''}".rstrip()


def _seeds(name: str, asked: StudyFile) -> int:
    """Runs of each combination: one of an optimiser that draws no random numbers."""
    return 1 if name in WITHOUT_DRAWS else asked.seeds


def load_study(path: Path) -> StudyPlan:
    """Read a study file, and everything that it names."""
    return parse_study(read_text(path), str(path), path.parent)


def parse_study(text: str, file: str, folder: Path) -> StudyPlan:
    """Read the TOML of a study file.

    `file`: name for messages. `folder`: to which its paths are relative.
    """
    return study_of(parse_toml(text, file), file, folder)


def study_of(raw: dict[str, Any], file: str, folder: Path) -> StudyPlan:
    """The study that a table with the keys of a study file states."""
    check_format(raw, file)
    document, missing = _check_optimizers(validated(StudyFile, raw, file), file)
    problems = tuple(
        entry
        for at, block in enumerate(document.problems)
        for entry in _entries(block, document.handlings, file, f"problems[{at}]", folder)
    )
    _check_repeats(problems, document, file)
    return StudyPlan(file, document, problems, missing)


def _check_repeats(problems: tuple[StudyProblem, ...], document: StudyFile, file: str) -> None:
    """Refuse what would be run twice under the same key."""
    asked = [
        ("problems", [f"{one.name}, {one.reading}" for one in problems]),
        (
            "optimizers",
            [f"{b.name} {canonical(s)}" for b in document.optimizers for s in b.settings],
        ),
        ("handlings", [str(handling) for handling in document.handlings]),
        ("budget", [str(budget) for budget in document.budget or ()]),
        ("optimizers", [_label(b, s) for b in document.optimizers for s in b.settings]),
    ]
    for field, names in asked:
        for name, count in Counter(names).items():
            if count > 1:
                raise CaseError(file, field, f"{name} is named twice; name it once")


def _check_optimizers(document: StudyFile, file: str) -> tuple[StudyFile, tuple[str, ...]]:
    """The study without optimisers whose package may be missing and is, and what is missing."""
    found, missing = [], []
    for at, block in enumerate(document.optimizers):
        try:
            _check_optimizer(block, document, file, at)
        except PackageError as error:
            if not document.installed_only:
                raise CaseError(file, f"optimizers[{at}]", str(error)) from None
            missing.append(f"Left out: {error}.")
        else:
            found.append(block)
    return document.model_copy(update={"optimizers": tuple(found)}), tuple(missing)


def _check_optimizer(block: OptimizerBlock, document: StudyFile, file: str, at: int) -> None:
    largest = max(document.budget or (0,)) or None
    for place, settings in enumerate(block.settings):
        field = f"optimizers[{at}]"
        if settings:
            field += f".settings[{place}]" if len(block.settings) > 1 else ".settings"
        try:
            canonical(settings)
            if block.name != DESCENT:
                find_optimizer(block.name, largest, **settings)
        except PackageError:
            raise
        except TrajgapError as error:
            raise CaseError(file, field, str(error)) from None
        except TypeError as error:
            raise CaseError(file, field, f"{error}; see the optimiser's manual") from None


def _entries(
    block: ProblemsBlock, handlings: tuple[Handling, ...], file: str, field: str, folder: Path
) -> Iterator[StudyProblem]:
    """Problems that a block names, joint by joint where each is searched by itself."""
    try:
        if block.case.startswith(SUITE_PREFIX) or block.case == SUITE_PREFIX.rstrip(":"):
            cases = [one.case() for one in select_instances(block.case)]
        else:
            known = block.case in published_ids()
            cases = [load_case(block.case if known else str(folder / block.case))]
        posed = [
            (case, *pair, case.problem(*pair, block.coupling))
            for case in cases
            for pair in _pairs(case, block)
        ]
    except TrajgapError as error:
        raise CaseError(file, f"{field}.case", str(error)) from None
    for case, pid, rid, problem in posed:
        apart = problem.coupling is Coupling.PER_JOINT and len(problem.joints) > 1
        for joint in range(len(problem.joints)) if apart else (None,):
            one = problem if joint is None else problem.joint(joint)
            label = "" if joint is None else f", joint {problem.joints[joint]}"
            try:
                box = search_box(one)
                for handling in handlings:
                    judge_of(one, float("inf"), handling)  # refused before anything is run
            except TrajgapError as error:
                raise CaseError(file, field, f"{pid}, {rid}{label}: {error}") from None
            yield StudyProblem(
                name=f"{case.id}/{pid}{label}",
                reading=rid,
                case=case,
                problem_id=pid,
                joint=None if joint is None else problem.joints[joint],
                problem=one,
                box=box,
                stream=() if joint is None else (joint,),
                solve=partial(bracket_of, case, one, case.statement(pid, rid), joint),
                notes=bounds_note(one),
            )


def _pairs(case: Case, block: ProblemsBlock) -> list[tuple[str, str]]:
    """Problems and readings that are asked for and stated in full, each once."""
    found = {
        pair: None
        for pid in block.problems or (None,)
        for rid in block.readings or (None,)
        for pair in case.selections(pid, rid)
    }
    stated = [pair for pair in found if case.statement(*pair).complete]
    if not stated:
        raise CaseError(case.file, "", "states no complete problem; choose another case")
    return stated
