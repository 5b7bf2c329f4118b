"""Pieces of a proof: the same results wherever they are worked on, and whatever becomes of it."""

import os
import signal
import subprocess
import sys
from concurrent.futures import Executor
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from support.proof_problems import QUINTIC
from support.proof_runs import LastFirst
from trajgap.nlp.proofs import certifiers, crew
from trajgap.nlp.proofs.certifiers import certify
from trajgap.nlp.proofs.crew import ProofCrew
from trajgap.nlp.proofs.cubic import CUBIC
from trajgap.nlp.proofs.document import certificate
from trajgap.nlp.proofs.outcome import Certified, Outcome
from trajgap.problem import Limits, Problem, cubic_spline
from trajgap.verify import Subject, verify_certificate

JERK = Limits(jerk=[5.0, 7.0])
ROUGH = Problem([[-1.0, 0.3], [0.4, -0.7], [1.1, 0.9], [-0.2, 0.1]], JERK, cubic_spline(3))
"""Jerk limits alone take boxes enough for several to be under way."""


RNG = np.random.default_rng(2)
WALK = RNG.uniform(-1.0, 1.0, (6, 3))
FAST = Problem(WALK, Limits(RNG.uniform(1, 2, 3), RNG.uniform(1, 2, 3)), cubic_spline(5))
"""Several ways of braking have to be told apart."""


def shifted(common: int, number: int) -> int:
    return common + number


def ending(common: int, number: int) -> int:
    """A process that the system ends at one number; this one is not ended."""
    if number == 3 and os.getpid() != common:
        os.kill(os.getpid(), signal.SIGKILL)
    return number


def talking(common: str, number: int) -> int:
    print(common, number, flush=True)
    return number


def refusing(common: str, number: int) -> int:
    raise ValueError(f"{common} {number}")


@pytest.mark.usefixtures("at_once")
def test_results_come_in_the_order_of_the_pieces() -> None:
    items = [(n,) for n in (5, 1, 4, 2, 3, 9, 8, 7)]
    for workers in (1, 3):
        with ProofCrew(workers) as some:
            assert list(some.spread(shifted, 10, items)) == [10 + n for (n,) in items]
            assert some.processes == (workers if workers > 1 else 0)


@pytest.mark.usefixtures("at_once")
@pytest.mark.skipif(sys.platform == "win32", reason="processes are ended by signals")
def test_what_a_dead_process_had_is_done_here() -> None:
    with ProofCrew(2) as some:
        found = list(some.spread(ending, os.getpid(), [(n,) for n in range(8)]))
    assert found == list(range(8))


@pytest.mark.usefixtures("at_once")
def test_what_a_process_prints_does_not_stand_between_answers() -> None:
    with ProofCrew(2) as some:
        assert list(some.spread(talking, "said", [(n,) for n in range(6)])) == list(range(6))


@pytest.mark.usefixtures("at_once")
@pytest.mark.parametrize("workers", [1, 2])
def test_what_a_piece_raises_comes_out(workers: int) -> None:
    with ProofCrew(workers) as some, pytest.raises(ValueError, match="twice 0"):
        list(some.spread(refusing, "twice", [(n,) for n in range(4)]))


def test_no_process_is_started_below_a_second(monkeypatch: pytest.MonkeyPatch) -> None:
    crews: list[ProofCrew] = []

    class Seen(ProofCrew):
        def __init__(self, workers: int, executor: Executor | None) -> None:
            super().__init__(workers, executor)
            crews.append(self)

    monkeypatch.setattr(certifiers, "ProofCrew", Seen)
    monkeypatch.setattr(crew.ProofCrew, "worth", np.inf)
    assert certify(ROUGH, certifier=CUBIC, gap=0.1, workers=2).outcome is Outcome.CERTIFIED
    assert [one.processes for one in crews] == [0]
    monkeypatch.setattr(crew.ProofCrew, "worth", 0.0)
    assert certify(ROUGH, certifier=CUBIC, gap=0.1, workers=2).outcome is Outcome.CERTIFIED
    assert [one.processes for one in crews] == [0, 2]


def proof(found: Certified) -> Any:
    assert found.outcome is Outcome.CERTIFIED
    return certificate(found)["proof"], found.lower, found.upper


@pytest.mark.usefixtures("at_once")
def test_a_cubic_proof_does_not_depend_on_who_worked_on_it(monkeypatch: pytest.MonkeyPatch) -> None:
    alone = proof(certify(ROUGH, certifier=CUBIC, gap=0.01))
    assert sum(node[0] == "/" for node in alone[0]["tree"]) > 4, "too few boxes for several"
    assert proof(certify(ROUGH, certifier=CUBIC, gap=0.01, workers=2)) == alone
    late = LastFirst(monkeypatch)
    assert proof(certify(ROUGH, certifier=CUBIC, gap=0.01, workers=4, executor=late)) == alone


@pytest.mark.usefixtures("at_once")
def test_at_the_time_limit_what_others_proved_is_kept() -> None:
    """The boxes that are under way end with the time, and nothing of them is lost."""
    alone = replace(CUBIC, first=None)
    part = certify(ROUGH, certifier=alone, gap=1e-6, seconds=1.0, workers=2)
    assert part.outcome is Outcome.INTERVAL
    assert verify_certificate(certificate(part)).proves
    whole = certify(ROUGH, certifier=CUBIC, gap=0.1, workers=2, resume=part)
    assert whole.outcome is Outcome.CERTIFIED


@pytest.mark.usefixtures("at_once")
@pytest.mark.parametrize(
    ("problem", "subject", "gap"), [(FAST, Subject.ANY, 1e-6), (QUINTIC, Subject.DECLARED, 0.05)]
)
def test_no_other_proof_does(problem: Problem, subject: Subject, gap: float) -> None:
    alone = certify(problem, subject=subject, gap=gap)
    assert alone.nodes > 10, "too few boxes for several"
    shared = certify(problem, subject=subject, gap=gap, workers=3)
    assert proof(shared) == proof(alone)
    assert (shared.nodes, shared.durations) == (alone.nodes, alone.durations)


def test_a_process_that_searches_boxes_imports_no_solver():
    program = (
        "import sys, trajgap.nlp.proofs.quintic.curves, trajgap.nlp.proofs.declared.search;"
        "print({'scipy', 'casadi', 'pydantic'} & set(sys.modules))"
    )
    ran = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert (ran.stdout, ran.returncode) == ("set()\n", 0)
