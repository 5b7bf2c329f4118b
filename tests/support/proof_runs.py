"""Certification runs under a clock, a crew, answers and kinds of proof that a test chooses."""

import json
from collections.abc import Callable
from concurrent.futures import Executor, Future
from dataclasses import dataclass, replace
from fractions import Fraction
from importlib import import_module
from typing import Any

import pytest
from trajgap.nlp.proofs import certifiers, crew
from trajgap.nlp.proofs.certifier import Certifier
from trajgap.nlp.proofs.declared import FEW_SEGMENTS
from trajgap.nlp.proofs.exact import ExactProblem
from trajgap.nlp.proofs.judged import judged
from trajgap.nlp.proofs.outcome import Certified, Progress
from trajgap.nlp.proofs.session import Session
from trajgap.nlp.proofs.state import state_document
from trajgap.problem import Problem
from trajgap.verify import Subject


@dataclass
class Ticking:
    """Stands in the place of the module ``time``."""

    now: float = 0.0
    step: float = 0.0
    looks: int = 0

    def perf_counter(self) -> float:
        self.now += self.step
        self.looks += 1
        return self.now

    monotonic = perf_counter


class LastFirst(Executor):
    """Works on what was handed out last, one piece whenever a crew waits."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.held: list[tuple[Future[Any], Callable[[], Any]]] = []
        self.handed: list[Future[Any]] = []
        waited = crew.wait

        def finishing(futures: Any, timeout: float) -> Any:
            self.finish(1)
            return waited(futures, 0.0)

        monkeypatch.setattr(crew, "wait", finishing)

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        future: Future[Any] = Future()
        self.handed.append(future)
        self.held.append((future, lambda: fn(*args, **kwargs)))
        return future

    def finish(self, most: int) -> None:
        """Do as many pieces as there are, or fewer."""
        for _ in range(min(most, len(self.held))):
            future, work = self.held.pop()
            if future.set_running_or_notify_cancel():
                future.set_result(work())


Durations = tuple[Fraction, ...]


def answering(
    monkeypatch: pytest.MonkeyPatch, answer: Callable[[int, Any], Durations | bool | None]
) -> list[Any]:
    """Let the local solver answer as told; returns the list of what it was started from.

    ``answer`` gets the number of the call and its start; True lets the real solver work.
    """
    real, calls = Session.seek, []

    def seek(session: Session, initial: Any = None) -> bool:
        calls.append(initial)
        found = answer(len(calls), initial)
        if found is True:
            return real(session, initial)
        if not isinstance(found, tuple):
            return False
        session.durations = found
        return True

    monkeypatch.setattr(Session, "seek", seek)
    return calls


def unjudged(monkeypatch: pytest.MonkeyPatch) -> list[Certified]:
    """A list that receives whatever certifiers find from now on."""

    def seen(found: Certified, *rest: Any) -> Certified:
        raw.append(found)
        return judged(found, *rest)

    raw: list[Certified] = []
    monkeypatch.setattr(import_module("trajgap.nlp.proofs.certifiers"), "judged", seen)
    return raw


def stopped(problem: Problem, when: Callable[[Progress], bool], **asked: Any) -> Certified:
    """A run that is interrupted as soon as what it reports says so."""

    def report(now: Progress) -> None:
        if when(now):
            raise KeyboardInterrupt

    return certifiers.certify(problem, report=report, **asked)


def state_of(found: Certified) -> dict[str, Any]:
    """The state of a run, through JSON."""
    return dict(json.loads(json.dumps(state_document(found))))


@pytest.fixture(autouse=True)
def own_kinds(monkeypatch: pytest.MonkeyPatch) -> None:
    """Tests that import it ask no boxes of durations first."""
    plain = certifiers._able

    def able(problem: ExactProblem, subject: Subject) -> list[Certifier]:
        others = (one for one in plain(problem, subject) if one is not FEW_SEGMENTS)
        return [replace(one, first=None) for one in others]

    monkeypatch.setattr(certifiers, "_able", able)
