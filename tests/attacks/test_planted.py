"""Each attack finds a fault planted for it: trials fork, so that a child has the fault too."""

from __future__ import annotations

import json
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trajgap.compare.audits
import trajgap.heuristics
import trajgap.nlp
import trajgap.problem
from trajgap.compare.cli import output
from trajgap.nlp.optimum import Status
from trajgap.problem import Verdict
from trajgap.problem.motions import HalfUnits
from trajgap.problem.motions.judged import slow_down
from trajgap.verify import verify_certificate

from attacks import faults, true_proofs
from attacks.attack import Broken
from attacks.reading import hold_together
from attacks.registry import ATTACKS
from attacks.run import Account, tried, warm
from attacks.sandbox import available, call

pytestmark = pytest.mark.skipif(not available(), reason="children are forked and watched on Linux")

Patch = pytest.MonkeyPatch
CHECK = trajgap.problem.check
EVALUATE = trajgap.problem.evaluate
PARSE = trajgap.problem.parse_case
SOLVE = trajgap.nlp.solve
SLOW_DOWN = slow_down


@pytest.fixture(autouse=True)
def _warm() -> Iterator[None]:
    warm()
    yield
    # How long a command takes with a fault planted is not how long it takes.
    faults._usual.cache_clear()


def check_passes(patch: Patch) -> None:
    def check(*given: Any) -> Any:
        return replace(CHECK(*given), verdict=Verdict.PASS, limits=Verdict.PASS)

    patch.setattr(trajgap.problem, "check", check)


def check_violates(patch: Patch) -> None:
    def check(*given: Any) -> Any:
        return replace(CHECK(*given), verdict=Verdict.VIOLATED, limits=Verdict.VIOLATED)

    patch.setattr(trajgap.problem, "check", check)


def peaks_one_per_mille_low(patch: Patch) -> None:
    def check(*given: Any) -> Any:
        found = CHECK(*given)
        return replace(found, peaks=tuple(replace(p, value=0.999 * p.value) for p in found.peaks))

    patch.setattr(trajgap.problem, "check", check)


def joint_one_by_a_second(patch: Patch) -> None:
    def check(problem: Any, h: Any) -> Any:
        found = CHECK(problem, h)
        factor = 1 + 1e-3 * float(np.sum(h)) + 1e-3 * abs(float(problem.waypoints[0, 0]))
        return replace(found, peaks=tuple(replace(p, ratio=factor * p.ratio) for p in found.peaks))

    patch.setattr(trajgap.problem, "check", check)


def degrees_a_little_off(patch: Patch) -> None:
    class Read:
        def __init__(self, case: Any, off: bool) -> None:
            self.case, self.off = case, off
            self.selections = case.selections

        def problem(self, *pair: str) -> Any:
            problem = self.case.problem(*pair)
            way = problem.waypoints * (1 + 1e-4 * self.off)
            return replace(problem, waypoints=way)

    def parse(text: str, file: str) -> Any:
        return Read(PARSE(text, file), '"deg"' in text)

    patch.setattr(trajgap.problem, "parse_case", parse)


def _with_problems(patch: Patch, changed: Callable[[Any], Any]) -> None:
    """Every problem of a case file is another one."""

    class Read:
        def __init__(self, case: Any) -> None:
            self.case, self.selections = case, case.selections

        def problem(self, *pair: str) -> Any:
            return changed(self.case.problem(*pair))

    patch.setattr(trajgap.problem, "parse_case", lambda *given: Read(PARSE(*given)))


def sides_are_one_size(patch: Patch) -> None:
    _with_problems(patch, lambda problem: replace(problem, limits=problem.limits.hull))


def the_finish_is_the_start(patch: Patch) -> None:
    def changed(problem: Any) -> Any:
        curve = problem.curve
        if curve.piecewise is None or curve.virtual:
            return problem
        both = (curve.prescribed[0], *curve.prescribed[1:-1], curve.prescribed[0])
        return replace(problem, curve=replace(curve, prescribed=both))

    _with_problems(patch, changed)


def positions_at_way_points(patch: Patch) -> None:
    """The reach that searches see is that of the way-points alone."""

    def evaluate(problem: Any, h: Any) -> Any:
        free = problem.limits.with_positions(*np.full((2, 1), np.inf) * [[-1], [1]])
        found = EVALUATE(replace(problem, limits=free), h)
        low, high = problem.limits.position_lower, problem.limits.position_upper
        half = np.where(np.isfinite(high - low), (high - low) / 2, 1.0)
        way = problem.waypoints
        over = 1 + np.maximum(low - way.min(axis=0), way.max(axis=0) - high) / half
        reach = np.broadcast_to(over, (len(h), way.shape[1]))
        return replace(found, _reach=lambda: reach)

    patch.setattr(trajgap.problem, "evaluate", evaluate)


def nothing_is_penalised(patch: Patch) -> None:
    class Penalty(trajgap.heuristics.DeathPenalty):
        def __call__(self, h: Any) -> Any:
            return np.sum(h, axis=1)

    patch.setattr(trajgap.heuristics, "DeathPenalty", Penalty)


def everything_breaks(patch: Patch) -> None:
    judge = trajgap.compare.audits.judge_rounding

    def judged(*given: Any) -> Any:
        return replace(judge(*given), verdict="breaks")

    patch.setattr(trajgap.compare.audits, "judge_rounding", judged)


def one_per_mille_long(patch: Patch) -> None:
    def solve(problem: Any, **options: Any) -> Any:
        answer = SOLVE(problem, **options)
        longer = None if answer.durations is None else answer.durations * 1.001
        infimum = None if answer.infimum is None else answer.infimum * 1.001
        return replace(answer, durations=longer, infimum=infimum)

    patch.setattr(trajgap.nlp, "solve", solve)


def all_infeasible(patch: Patch) -> None:
    def solve(problem: Any, **options: Any) -> Any:
        return replace(SOLVE(problem, **options), status=Status.INFEASIBLE, durations=None)

    patch.setattr(trajgap.nlp, "solve", solve)


def a_fault(patch: Patch) -> None:
    def fail(*_: Any, **__: Any) -> int:
        raise ZeroDivisionError

    names = ("showing.show_case", "checking.check_durations", "solving.solve_case")
    for name in (*names, "auditing.audit_cases"):
        patch.setattr(f"trajgap.compare.cli.{name}", fail)


def two_lines(patch: Patch) -> None:
    from trajgap.compare.cli import app

    fail = app._fail
    patch.setattr(app, "_fail", lambda message, code: fail("one", code) and fail(message, code))


def files_by_and_by(patch: Patch) -> None:
    @contextmanager
    def new_file(path: Path) -> Iterator[Callable[[str], None]]:
        def write(text: str) -> None:
            for half in (text[: len(text) // 2], text):
                path.write_text(half)
                time.sleep(0.3)

        yield write

    patch.setattr(output, "new_file", new_file)


def drafts_stay(patch: Patch) -> None:
    patch.setattr("trajgap.problem.files._remove", lambda path: None)


def writing_raises(patch: Patch) -> None:
    @contextmanager
    def writing(name: str, field: str) -> Iterator[None]:
        try:
            yield
        except OSError as error:
            raise RuntimeError from error

    patch.setattr(output, "_writing", writing)


def trees_are_not_walked(patch: Patch) -> None:
    patch.setattr("trajgap.verify.verdict.walk", lambda *_: None)


def leaves_are_not_proved(patch: Patch) -> None:
    patch.setattr("trajgap.verify.declared.need", lambda *_: None)
    patch.setattr("trajgap.verify.closed_form.need", lambda *_: None)
    patch.setattr("trajgap.verify.any_curve.need", lambda *_: None)


def answers_are_not_looked_at(patch: Patch) -> None:
    patch.setattr("trajgap.verify.verdict.check_answer", lambda *_: None)


def the_verifier_raises(patch: Patch) -> None:
    def fail(*_: Any) -> None:
        raise AssertionError

    patch.setattr("trajgap.verify.verdict.walk", fail)


def the_clock_stands(patch: Patch) -> None:
    def slowly(*_: Any) -> None:
        end = time.process_time() + 4
        while time.process_time() < end:
            pass

    patch.setattr("trajgap.verify.verdict.walk", slowly)


def digits_say_nothing(patch: Patch) -> None:
    for reader in ("tables", "ros"):
        patch.setattr(f"trajgap.problem.motions.{reader}.rounding_of", lambda *_: HalfUnits())


def jumps_are_rounding(patch: Patch) -> None:
    patch.setattr("trajgap.problem.motions.judged._JUMP", 1e3)


def repairs_fall_short(patch: Patch) -> None:
    def slow_down(*given: Any) -> tuple[float, str | None]:
        stretch, why = SLOW_DOWN(*given)
        return max(1.0, 0.9999 * stretch), why

    patch.setattr("trajgap.problem.motions.judged.slow_down", slow_down)


PLANTED: list[tuple[str, Callable[[Patch], None], int]] = [
    ("verdicts", check_passes, 20),
    ("verdicts", check_violates, 20),
    ("peaks", peaks_one_per_mille_low, 10),
    ("peaks", the_finish_is_the_start, 80),
    ("peaks", positions_at_way_points, 10),
    ("peaks", nothing_is_penalised, 10),
    ("verdicts on motions", digits_say_nothing, 200),
    ("verdicts on motions", jumps_are_rounding, 120),
    ("verdicts on motions", repairs_fall_short, 30),
    ("readings", sides_are_one_size, 20),
    ("readings", the_finish_is_the_start, 80),
    ("identities", joint_one_by_a_second, 20),
    ("units", degrees_a_little_off, 20),
    ("readings", degrees_a_little_off, 20),
    ("rounding boxes", everything_breaks, 20),
    ("optima", one_per_mille_long, 6),
    ("optima", all_infeasible, 6),
    ("tight duration bounds", all_infeasible, 6),
    ("damaged case files", a_fault, 40),
    ("damaged case files", two_lines, 10),
    ("bytes that are no case file", two_lines, 10),
    ("valid case files", a_fault, 2),
    ("certificates", trees_are_not_walked, 120),
    ("certificates", leaves_are_not_proved, 120),
    ("certificates", answers_are_not_looked_at, 400),
    ("certificates", the_verifier_raises, 20),
    ("certificates", the_clock_stands, 40),
    ("forged proofs", trees_are_not_walked, 20),
    ("states", trees_are_not_walked, 300),
    ("killed", files_by_and_by, 12),
    ("interrupted", drafts_stay, 8),
    ("full disk", writing_raises, 6),
    ("no rights", writing_raises, 6),
]
"""Attack, fault, and the trials within which it must be found.

How long a search may take decides which proofs there are to be altered, so that the trial that
finds a fault is not the same everywhere: it is one in 10 to one in 40 for those of proofs, and the
bound is about ten times as many.
"""


@contextmanager
def planted(plant: Callable[[Patch], None], patch: Patch) -> Iterator[None]:
    """A fault in everything but what makes true proofs: they are kept, and others alter them too.

    A verifier that refuses or raises has no proof made; one trial after another would be undecided.
    """
    own, certified = Patch(), true_proofs._certified

    def soundly(*given: Any) -> list[dict[str, Any]]:
        own.undo()
        try:
            return certified(*given)
        finally:
            plant(own)

    patch.setattr(true_proofs, "_certified", soundly)
    plant(own)
    try:
        yield
    finally:
        own.undo()


QUICK = 7
"""Trials from which a planted fault is one of the slow tests."""


@pytest.mark.parametrize(
    ("name", "plant", "trials"),
    [
        pytest.param(
            *one,
            id=f"{one[0]}: {one[1].__name__}",
            marks=[pytest.mark.slow] if one[2] >= QUICK else [],
        )
        for one in PLANTED
    ],
)
def test_a_planted_fault_is_found(
    name: str, plant: Callable[[Patch], None], trials: int, monkeypatch: Patch
) -> None:
    account = Account(next(a for a in ATTACKS if a.name == name))
    monkeypatch.setattr(faults, "WORKS", {k: w for k, w in faults.WORKS.items() if w.quick})
    if trials < QUICK:
        monkeypatch.setattr(true_proofs, "MAKE_SECONDS", 1.0)
        monkeypatch.setattr(true_proofs, "_EACH", 1)
    faults._usual.cache_clear()
    with planted(plant, monkeypatch):
        for number in range(trials):
            tried(account, 11, number)
            if account.broken:
                return
    raise AssertionError(f"{trials} trials hold: {account.words}, {account.undecided} undecided")


def test_a_planted_fault_spoils_no_proof_that_is_altered(monkeypatch: Patch) -> None:
    """In whatever order faults are planted: proofs are made once, and kept for all of them."""
    fresh = true_proofs._pool.__wrapped__
    with planted(the_verifier_raises, monkeypatch):
        made = fresh("rest-to-rest", 0, 1.0)
        assert not _verifies(made[0])
    assert _verifies(made[0])


def _verifies(text: str) -> bool:
    document = json.loads(text)
    return call(lambda: verify_certificate(document).proves).value is True


@pytest.mark.parametrize(
    ("page", "why"),
    [
        ('<p id="a"></p><p id="a"></p>', "stand twice"),
        ('<a href="#b"></a>', "which is not there"),
        ("\u202e", "control characters"),
    ],
)
def test_a_faulty_page_is_found(tmp_path: Path, page: str, why: str) -> None:
    (tmp_path / "audit.json").write_text('{"cases": [{"case": "c"}]}')
    (tmp_path / "c.md").write_text("plain")
    (tmp_path / "c.html").write_text(page, encoding="utf-8")
    with pytest.raises(Broken, match=why):
        hold_together(tmp_path)
