"""One session of a study: what is left is run, and each row is stored as it comes."""

from __future__ import annotations

import platform
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from importlib.metadata import PackageNotFoundError, version

from .engines import Engine, outcomes
from .rows import Row, RowStatus, Trial
from .store import Store
from .studies import StudyPlan


@dataclass(frozen=True)
class StudySession:
    """Progress of a session."""

    total: int
    """Trials of the study."""
    resumed: int
    """Trials in the store before the session began."""
    run: int = 0
    """Of them run since then."""
    failed: int = 0
    """Runs of this session that failed."""
    seconds: float = 0.0
    """Total time of the runs of this session."""

    @property
    def left(self) -> int:
        """Trials that are not in the store yet."""
        return self.total - self.resumed - self.run


def unfinished(study: StudyPlan, store: Store, retry: bool = False) -> Iterator[Trial]:
    """Trials without a row in the store; with `retry`, also those with a failed row."""
    for trial in study.trials(store):
        status = store.status(trial.key)
        if status is None or (retry and status is RowStatus.FAILED):
            yield trial


def run_study(
    study: StudyPlan,
    store: Store,
    engine: Engine,
    *,
    retry: bool = False,
    progress: Callable[[StudySession], None] = lambda _: None,
) -> StudySession:
    """Run the trials that are not in the store yet; with `retry`, also those that failed.

    However the session ends, every returned row is in the store, and the next session continues.
    `progress`: called before the first run and after each.
    """
    store.note("software", _software())
    left = sum(1 for _ in unfinished(study, store, retry))
    session = StudySession(total=len(study), resumed=len(study) - left)
    progress(session)
    for outcome in outcomes(unfinished(study, store, retry), engine, store):
        session = replace(
            session,
            run=session.run + 1,
            failed=session.failed + (outcome.row.status is RowStatus.FAILED),
            seconds=session.seconds + outcome.seconds,
        )
        progress(session)
    return session


def study_rows(study: StudyPlan, store: Store) -> Iterator[Row]:
    """Rows of a study that are in the store, one by one, in the order of its trials."""
    for trial in study.trials(store):
        row = store.row(trial.key)
        if row is not None:
            yield row


def _software() -> str:
    """Versions that are kept with the rows: they can change the last digit of a run."""
    found = [f"Python {platform.python_version()}", platform.platform()]
    for name in ("trajgap", "numpy", "scipy", "casadi", "numba"):
        try:
            found.append(f"{name} {version(name)}")
        except PackageNotFoundError:
            continue
    return ", ".join(found)
