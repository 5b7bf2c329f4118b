"""A trial, which is all that determines a run, and the row that the run leaves behind."""

from __future__ import annotations

import hashlib
import json
import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field, fields, replace
from enum import StrEnum
from functools import lru_cache
from typing import Any

from ...heuristics import Handling
from ...problem import Array, Problem, TrajgapError, Verdict

ROW_FORMAT = 1
"""Version of keys and rows: whatever changes a run or the meaning of a field raises it."""

_APART = ("problem", "reference", "seconds")
"""Fields of a trial that are not hashed: the problem enters by its own hash, the reference is what
gaps are set against, and the time limit alters no run that ends within it."""


class RowStatus(StrEnum):
    """How a run ended."""

    FINISHED = "finished"
    """The search ended, or its budget was spent."""
    FAILED = "failed"
    """It raised an exception, evaluated nothing, ran too long, or its process ended; the message
    says which."""


@dataclass(frozen=True)
class Bracket:
    """Where the optimum lies, s."""

    upper: float
    """Total of a feasible trajectory."""
    lower: float | None = None
    """Certified lower bound; None if there is none."""

    def __post_init__(self) -> None:
        if not 0 < self.upper < float("inf"):
            raise TrajgapError(f"reference: {self.upper} s is not a positive finite time")
        if self.lower is not None and not 0 < self.lower <= self.upper:
            raise TrajgapError(f"reference: {self.lower} s is not a lower bound of {self.upper} s")

    def gap(self, time: float) -> tuple[float, float]:
        """Relative distance of a time, [(T − U)/U, (T − L)/L]; negative values are kept.

        Without a certified lower bound, both ends are relative to U.
        """
        base = self.upper if self.lower is None else self.lower
        return (time - self.upper) / self.upper, (time - base) / base


def canonical(value: object) -> str:
    """JSON text that is the same for the same content: keys in order, no blanks, no NaN."""
    try:
        return json.dumps(
            value, sort_keys=True, separators=(",", ":"), ensure_ascii=True, allow_nan=False
        )
    except (TypeError, ValueError) as error:
        raise TrajgapError(
            f"settings: {error}; use finite numbers, texts, lists and tables"
        ) from None


@dataclass(frozen=True, eq=False)
class Trial:
    """All that determines one run of one optimiser."""

    problem: Problem
    """Searched with one duration vector for all its joints, whatever its coupling."""
    name: str
    reading: str
    """Its names in rows, such as "puma560-mnam-pso-353/six-joints" and "durations-positive"."""
    optimizer: str
    """As `find_optimizer` takes it."""
    settings: str = "{}"
    """Its settings as `canonical` JSON."""
    handling: str = Handling.DEATH_PENALTY
    """What happens to vectors that break a limit; see `Handling`."""
    seed: int = 0
    budget: int = 6000  # of what counts no iterations; plans state it
    """Evaluations; the objective enforces it."""
    stream: tuple[int, ...] = ()
    """Spawn key under the seed; (j,) if joint j is searched separately, as in `run_per_joint`."""
    origin: str = ""
    """Where the optimiser comes from: a package with its version, or a hash of its source."""
    reference: Bracket | None = None
    """Reference for the gaps of the row."""
    seconds: float = float("inf")
    """A run that takes longer has failed."""
    problem_sha256: str = ""
    """Hash of the problem's own numbers, as certificates seal theirs; found if left empty."""

    def __post_init__(self) -> None:
        if self.handling not in tuple(Handling):
            raise TrajgapError(
                f"handling: {self.handling!r} is unknown; choose {', '.join(Handling)}"
            )
        if self.seed < 0 or self.budget < 1:
            raise TrajgapError("trial: give a seed of 0 or more and a budget of 1 or more")
        object.__setattr__(self, "handling", str(self.handling))
        if not self.problem_sha256:
            # Here alone, so processes that get trials ready-made start in two thirds of it.
            from ...nlp import problem_seal

            object.__setattr__(self, "problem_sha256", problem_seal(self.problem))

    @property
    def key(self) -> str:
        """SHA-256 of all that determines the run."""
        inputs = {f.name: getattr(self, f.name) for f in fields(self) if f.name not in _APART}
        text = canonical({"format": ROW_FORMAT, **inputs})
        return hashlib.sha256(text.encode()).hexdigest()


@dataclass(frozen=True)
class Row:
    """The record of one run; nothing is clipped, and no clock time is recorded."""

    key: str
    """Of the trial, as all up to `budget` are."""
    problem: str
    """Its name."""
    reading: str
    problem_sha256: str
    optimizer: str
    settings: str
    origin: str
    handling: str
    seed: int
    stream: tuple[int, ...]
    budget: int
    segments: int
    """Number of durations."""
    status: RowStatus = RowStatus.FINISHED
    message: str = ""
    """Why it failed; empty otherwise."""
    evaluations: int = 0
    """Duration vectors judged, at most the budget."""
    durations: tuple[float, ...] | None = None
    """Durations of the best position, s; None if no feasible vector was evaluated."""
    reported_time: float | None = None
    """Its total by the objective, s."""
    verdict: str | None = None
    """Of `trajgap.problem.check` on the durations."""
    worst_ratio: float | None = None
    """Largest ratio of a value to its limit; None if nothing is limited."""
    feasible_time: float | None = None
    """T·max(1, c*) as `check` finds it, s."""
    feasible_why: str = ""
    """Why there is no such time; empty otherwise."""
    reference_upper: float | None = None
    reference_lower: float | None = None
    """Reference for the gaps, s."""
    reported_gap: tuple[float, float] | None = None
    feasible_gap: tuple[float, float] | None = None
    """Of either time, [(T − U)/U, (T − L)/L]. That of the reported time is an optimality gap only
    if the verdict is "pass", else a difference of reported time."""
    trace: tuple[tuple[int, float], ...] = field(default=())
    """Number of evaluations and the best total by the objective after them, s, at log-spaced
    numbers and only if it changed: the last entry at or before an evaluation holds there, and
    before the first entry nothing feasible was known."""

    @classmethod
    def begun(cls, trial: Trial, **known: Any) -> Row:
        """The row of a trial, with further fields of its run if they are known."""
        alike = ("key", "reading", "problem_sha256", "optimizer", "settings", "origin", "handling")
        same = {name: getattr(trial, name) for name in (*alike, "seed", "stream", "budget")}
        row = cls(problem=trial.name, segments=trial.problem.segments, **same, **known)
        return against(row, trial.reference)

    @property
    def feasible(self) -> bool:
        """Whether `check` passed the durations."""
        return self.verdict == Verdict.PASS

    @property
    def spent(self) -> int:
        """Evaluations of the run; a failed one counts its budget, so that failing is not cheap."""
        return self.budget if self.status is RowStatus.FAILED else self.evaluations

    def text(self) -> str:
        """The row as one line of canonical JSON: the same bytes for the same run."""
        return canonical(asdict(self))

    @classmethod
    def read(cls, text: str) -> Row:
        """The row of its `text`."""
        try:
            found: dict[str, Any] = json.loads(text)
            found["status"] = RowStatus(found["status"])
            found["stream"] = tuple(found["stream"])
            found["trace"] = tuple((int(at), float(total)) for at, total in found["trace"])
            for name in ("durations", "reported_gap", "feasible_gap"):
                found[name] = None if found[name] is None else tuple(found[name])
            return cls(**found)
        except (ValueError, TypeError, KeyError) as error:
            raise TrajgapError(
                f"row: cannot be read ({error}); the file may have been altered"
            ) from None


@lru_cache(maxsize=64)
def checkpoints(evaluations: int, per_decade: int = 32) -> tuple[int, ...]:
    """Log-spaced numbers of evaluations from 1 to the last, which is always among them.

    By default 7 % apart, which is finer than two seeds differ.
    """
    if evaluations < 1:
        return ()
    steps = math.floor(math.log10(evaluations) * per_decade)
    spaced = {round(10 ** (k / per_decade)) for k in range(steps + 1)}
    return tuple(sorted({min(point, evaluations) for point in spaced} | {evaluations}))


def trace_of(totals: Array) -> tuple[tuple[int, float], ...]:
    """Best totals at `checkpoints`, finite ones only, where they changed.

    `totals`: shape (evaluations,), the best total after each, s; inf while nothing feasible is
    known.
    """
    found: list[tuple[int, float]] = []
    best = math.inf
    for point in checkpoints(totals.size):
        total = float(totals[point - 1])
        if total < best:
            found.append((point, total))
            best = total
    return tuple(found)


def failed(trial: Trial, message: str) -> Row:
    """The row of a trial whose run failed."""
    return Row.begun(trial, status=RowStatus.FAILED, message=message)


def against(row: Row, reference: Bracket | None) -> Row:
    """The same row with gaps relative to another reference, or without gaps."""

    def gap(time: float | None) -> tuple[float, float] | None:
        return None if reference is None or time is None else reference.gap(time)

    return replace(
        row,
        reference_upper=None if reference is None else reference.upper,
        reference_lower=None if reference is None else reference.lower,
        reported_gap=gap(row.reported_time),
        feasible_gap=gap(row.feasible_time),
    )


def settings_of(row: Row | Trial) -> Mapping[str, Any]:
    """Settings as a table again."""
    found: Mapping[str, Any] = json.loads(row.settings)
    return found
