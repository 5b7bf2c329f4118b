"""Run one trial: whatever its optimiser does wrong becomes a row with its message."""

from __future__ import annotations

import importlib.metadata
import importlib.util
import json
import math
import os
import random
import time
import warnings
from collections.abc import Iterator
from contextlib import contextmanager, nullcontext
from dataclasses import dataclass, replace
from functools import lru_cache
from hashlib import sha256
from pathlib import Path
from typing import Any

import numpy as np

from ...heuristics import KINDS, Algorithm, BudgetedRun, Search, find_optimizer, run_within
from ...problem import Problem, TrajgapError, check, visible
from .rows import Row, Trial, failed, settings_of, trace_of

DESCENT = "descent"
"""What a study calls this package's own solver: it is not an optimiser that a paper could use,
since it knows the derivatives of the limits, and stands beside them as a reference."""

_PROBLEMS: dict[str, Problem] = {}
"""Those that a process remembers, by their hashes: what is compiled for a curve belongs to it."""


@dataclass(frozen=True)
class TrialOutcome:
    """A row, and the measured time, which differs from run to run."""

    row: Row
    seconds: float
    """That the run took."""


@lru_cache(maxsize=256)
def origin_of(optimizer: str) -> str:
    """Where an optimiser comes from: a package with its version, or a hash of its source.

    Such as "mealpy 3.0.1", "sha256:…" of the module's file for "module:function", else "trajgap
    0.1.0". `optimizer`: as `find_optimizer` takes it.
    """
    prefix, _, rest = optimizer.partition(":")
    try:
        # Distributions that a prefix names: their version can change what a run finds.
        if prefix in ("scipy", "mealpy", "pymoo", "pygmo", "cma"):
            return f"{prefix} {importlib.metadata.version(prefix)}"
        found = importlib.util.find_spec(prefix) if rest else None
        if found is not None and found.origin is not None:
            return f"sha256:{sha256(Path(found.origin).read_bytes()).hexdigest()}"
        return f"trajgap {importlib.metadata.version('trajgap')}"
    except (ImportError, ValueError, OSError):
        return ""


@contextmanager
def _alone(trial: Trial) -> Iterator[None]:
    """Let a run depend on nothing that its process happens to have set, and put all of it back."""
    with warnings.catch_warnings(), np.errstate():
        warnings.simplefilter("ignore")
        # Those of the papers draw from the generator that they are given, and no other.
        with nullcontext() if trial.optimizer in KINDS else _seeded(trial):
            yield


@contextmanager
def _seeded(trial: Trial) -> Iterator[None]:
    """Seed the global generators, for optimisers that draw from them, and put them back."""
    state, legacy = random.getstate(), np.random.get_state()  # noqa: NPY002
    words = np.random.SeedSequence(trial.seed, spawn_key=(*trial.stream, 1)).generate_state(4)
    random.seed(words.tobytes())
    np.random.seed(words)  # noqa: NPY002
    try:
        yield
    finally:
        random.setstate(state)
        np.random.set_state(legacy)  # noqa: NPY002


@lru_cache(maxsize=64)
def _paper_algorithm(name: str, settings: str, budget: int) -> Algorithm[Any]:
    """An algorithm of the papers, a frozen record, once for all its seeds."""
    found = find_optimizer(name, budget, **json.loads(settings))
    assert not isinstance(found, Search)
    return found


def _optimizer(trial: Trial) -> Algorithm[Any] | Search:
    if trial.optimizer in KINDS:
        return _paper_algorithm(trial.optimizer, trial.settings, trial.budget)
    return find_optimizer(trial.optimizer, trial.budget, **settings_of(trial))


def run_trial(trial: Trial) -> Row:
    """Run a trial in this process.

    The row has failed, with a message, if the optimiser is not found, raises an exception,
    evaluates nothing, breaks a rule or takes too long. Only the engines detect one that hangs in
    compiled code or ends the process.
    """
    if trial.optimizer == DESCENT:
        return _descended(trial)
    own = os.getpid()
    try:
        with _alone(trial):
            found = run_within(
                _optimizer(trial),
                trial.problem,
                trial.seed,
                trial.budget,
                trial.handling,
                trial.seconds if math.isfinite(trial.seconds) else None,
                trial.stream,
            )
    except KeyboardInterrupt:
        if os.getpid() == own:
            raise
    except TrajgapError as error:
        row = failed(trial, shortened(str(error)))
    except BaseException as error:  # an optimiser may even ask the interpreter to exit
        row = failed(trial, shortened(f"{type(error).__name__}: {_said(error)}"))
    else:
        row = _row(trial, found)
    if os.getpid() != own:
        os._exit(0)  # an optimiser forked, and this is not the process that was asked
    return row


def measured_trial(trial: Trial) -> TrialOutcome:
    """Run a trial in a process that is there for trials, so that what it prints goes nowhere."""
    nothing = os.open(os.devnull, os.O_WRONLY)
    for stream in (1, 2):
        os.dup2(nothing, stream)
    os.close(nothing)
    if len(_PROBLEMS) >= 64:
        _PROBLEMS.clear()
    known = replace(trial, problem=_PROBLEMS.setdefault(trial.problem_sha256, trial.problem))
    begun = time.monotonic()
    row = run_trial(known)
    return TrialOutcome(row, time.monotonic() - begun)


def _said(error: BaseException) -> str:
    """Text of an error; an optimiser's own may fail at that too."""
    try:
        return str(error)
    except Exception:
        return ""


def shortened(message: str) -> str:
    """A message in one line of bounded length, of characters that can be seen and written."""
    text = visible(" ".join(message.split()).removesuffix(":"))
    # Optimisers may print whole arrays into theirs.
    return text if len(text) <= 300 else text[:299] + "…"


def _descended(trial: Trial) -> Row:
    """The answer of this package's solver, whose steps stand for evaluations."""
    from ...nlp import solve  # processes that run no descent start in two thirds of the time

    found = solve(trial.problem, prove=0.0)
    if not math.isfinite(found.total_time):
        return failed(trial, shortened(found.why or str(found.status)))
    steps = max(1, found.iterations)
    run = BudgetedRun(found.durations, found.total_time, np.full(steps, found.total_time))
    return _row(trial, run)


def _row(trial: Trial, found: BudgetedRun) -> Row:
    known: dict[str, Any] = {
        "evaluations": found.evaluations,
        "trace": trace_of(found.totals),
    }
    if not math.isfinite(found.reported_time):
        return Row.begun(trial, **known, feasible_why="no feasible vector was evaluated")
    judged = check(trial.problem, found.durations)
    worst = judged.worst
    return Row.begun(
        trial,
        **known,
        durations=tuple(found.durations.tolist()),
        reported_time=found.reported_time,
        verdict=str(judged.verdict),
        worst_ratio=None if worst is None or math.isinf(worst.ratio) else worst.ratio,
        feasible_time=judged.feasible_time,
        feasible_why=judged.feasible_why or "",
    )
