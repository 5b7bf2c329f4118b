"""Each attack finds a fault planted for it: trials fork, so that a child has the fault too."""

from __future__ import annotations

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
from trajgap.compare.cli import app
from trajgap.nlp.optimum import Status
from trajgap.problem import Verdict
from trajgap.problem.motions import HalfUnits
from trajgap.problem.motions.judged import slow_down

from attacks import faults
from attacks.attack import Broken
from attacks.reading import hold_together
from attacks.registry import ATTACKS
from attacks.run import Account, tried, warm
from attacks.sandbox import available

pytestmark = pytest.mark.skipif(not available(), reason="children are forked and watched on Linux")

CHECK = trajgap.problem.check
EVALUATE = trajgap.problem.evaluate
PARSE = trajgap.problem.parse_case


@pytest.fixture(autouse=True)
def _warm() -> Iterator[None]:
    warm()
    yield
    # How long a command takes with a fault planted is not how long it takes.
    faults._usual.cache_clear()


def after(function: Callable[..., Any], change: Callable[[Any], Any]) -> Callable[..., Any]:
    """The function, and what it gives changed."""
    return lambda *given, **named: change(function(*given, **named))


def all_are(verdict: Verdict) -> Callable[..., Any]:
    return after(CHECK, lambda found: replace(found, verdict=verdict, limits=verdict))


def peaks_are(change: Callable[[Any], Any]) -> Callable[..., Any]:
    return after(CHECK, lambda found: replace(found, peaks=tuple(map(change, found.peaks))))


def ratios_grow_with_time(problem: Any, h: Any) -> Any:
    factor = 1 + 1e-3 * float(np.sum(h)) + 1e-3 * abs(float(problem.waypoints[0, 0]))
    return peaks_are(lambda p: replace(p, ratio=factor * p.ratio))(problem, h)


class Read:
    """A case whose problems are others."""

    def __init__(self, case: Any, change: Callable[[Any], Any]) -> None:
        self._case, self._change, self.selections = case, change, case.selections

    def problem(self, *pair: str) -> Any:
        return self._change(self._case.problem(*pair))


def read(change: Callable[[Any], Any]) -> Callable[..., Any]:
    return after(PARSE, lambda case: Read(case, change))


def degrees_a_little_off(text: str, file: str) -> Any:
    off = 1e-4 * ('"deg"' in text)
    return read(lambda one: replace(one, waypoints=one.waypoints * (1 + off)))(text, file)


def the_finish_is_the_start(problem: Any) -> Any:
    curve = problem.curve
    if curve.piecewise is None or curve.virtual:
        return problem
    both = (curve.prescribed[0], *curve.prescribed[1:-1], curve.prescribed[0])
    return replace(problem, curve=replace(curve, prescribed=both))


def reach_of_the_way_points(problem: Any, h: Any) -> Any:
    none = np.full(problem.waypoints.shape[1], np.inf)
    free = problem.limits.with_positions(-none, none)
    low, high = problem.limits.position_lower, problem.limits.position_upper
    half = np.where(np.isfinite(high - low), (high - low) / 2, 1.0)
    way = problem.waypoints
    over = 1 + np.maximum(low - way.min(axis=0), way.max(axis=0) - high) / half
    reach = np.broadcast_to(over, (len(h), way.shape[1]))
    return replace(EVALUATE(replace(problem, limits=free), h), _reach=lambda: reach)


class NoPenalty(trajgap.heuristics.DeathPenalty):
    def __call__(self, h: Any) -> Any:
        return np.sum(h, axis=1)


def longer(answer: Any) -> Any:
    """By one per mille."""
    both = (answer.durations, answer.infimum)
    durations, infimum = (None if x is None else x * 1.001 for x in both)
    return replace(answer, durations=durations, infimum=infimum)


def fails(*_: Any, **__: Any) -> Any:
    raise AssertionError


def nothing(*_: Any) -> None:
    pass


def two_lines(message: str, code: Any, fail: Callable[..., Any] = app._fail) -> Any:
    return fail("one", code) and fail(message, code)


@contextmanager
def files_by_and_by(path: Path) -> Iterator[Callable[[str], None]]:
    def write(text: str) -> None:
        for half in (text[: len(text) // 2], text):
            path.write_text(half)
            time.sleep(0.3)

    yield write


@contextmanager
def writing_raises(name: str, field: str) -> Iterator[None]:
    try:
        yield
    except OSError as error:
        raise RuntimeError from error


def four_seconds(*_: Any) -> None:
    end = time.process_time() + 4
    while time.process_time() < end:
        pass


def short_of(*given: Any) -> tuple[float, str | None]:
    stretch, why = slow_down(*given)
    return max(1.0, 0.9999 * stretch), why


SOLVE = trajgap.nlp.solve
CLI, VERIFY, MOTIONS = "trajgap.compare.cli.", "trajgap.verify.", "trajgap.problem.motions."
FAULTS: dict[str, dict[str, Any]] = {
    "check passes": {"trajgap.problem.check": all_are(Verdict.PASS)},
    "check violates": {"trajgap.problem.check": all_are(Verdict.VIOLATED)},
    "peaks one per mille low": {
        "trajgap.problem.check": peaks_are(lambda p: replace(p, value=0.999 * p.value))
    },
    "ratios grow with time": {"trajgap.problem.check": ratios_grow_with_time},
    "positions at way-points": {"trajgap.problem.evaluate": reach_of_the_way_points},
    "nothing is penalised": {"trajgap.heuristics.DeathPenalty": NoPenalty},
    "digits say nothing": {
        f"{MOTIONS}{reader}.rounding_of": lambda *_: HalfUnits() for reader in ("tables", "ros")
    },
    "jumps are rounding": {f"{MOTIONS}judged._JUMP": 1e3},
    "repairs fall short": {f"{MOTIONS}judged.slow_down": short_of},
    "sides are one size": {
        "trajgap.problem.parse_case": read(lambda one: replace(one, limits=one.limits.hull))
    },
    "the finish is the start": {"trajgap.problem.parse_case": read(the_finish_is_the_start)},
    "degrees a little off": {"trajgap.problem.parse_case": degrees_a_little_off},
    "everything breaks": {
        "trajgap.compare.audits.judge_rounding": after(
            trajgap.compare.audits.judge_rounding, lambda found: replace(found, verdict="breaks")
        )
    },
    "one per mille long": {"trajgap.nlp.solve": after(SOLVE, longer)},
    "all infeasible": {
        "trajgap.nlp.solve": after(
            SOLVE, lambda one: replace(one, status=Status.INFEASIBLE, durations=None)
        )
    },
    "a fault": {
        CLI + name: fails
        for name in (
            "showing.show_case",
            "checking.check_durations",
            "solving.solve_case",
            "auditing.audit_cases",
        )
    },
    "two lines": {f"{CLI}app._fail": two_lines},
    "files by and by": {f"{CLI}output.new_file": files_by_and_by},
    "drafts stay": {"trajgap.problem.files._remove": nothing},
    "writing raises": {f"{CLI}output._writing": writing_raises},
    "trees are not walked": {f"{VERIFY}verdict.walk": nothing},
    "leaves are not proved": {
        f"{VERIFY}declared.need": nothing,
        f"{VERIFY}closed_form.need": nothing,
        f"{VERIFY}any_curve.need": nothing,
    },
    "answers are not looked at": {f"{VERIFY}verdict.check_answer": nothing},
    "the verifier raises": {f"{VERIFY}verdict.walk": fails},
    "the clock stands": {f"{VERIFY}verdict.walk": four_seconds},
}
"""What stands in the place of what is attacked."""
PLANTED: list[tuple[str, str, int]] = [
    ("verdicts", "check passes", 20),
    ("verdicts", "check violates", 20),
    ("peaks", "peaks one per mille low", 10),
    ("peaks", "ratios grow with time", 10),
    ("peaks", "positions at way-points", 10),
    ("peaks", "nothing is penalised", 10),
    ("verdicts on motions", "digits say nothing", 200),
    ("verdicts on motions", "jumps are rounding", 120),
    ("verdicts on motions", "repairs fall short", 30),
    ("readings", "sides are one size", 20),
    ("readings", "the finish is the start", 80),
    ("readings", "degrees a little off", 20),
    ("rounding boxes", "everything breaks", 20),
    ("nasty problems", "one per mille long", 12),
    ("nasty problems", "all infeasible", 6),
    ("optima", "one per mille long", 6),
    ("damaged case files", "a fault", 40),
    ("damaged case files", "two lines", 10),
    ("bytes that are no case file", "two lines", 10),
    ("valid case files", "a fault", 2),
    ("certificates", "trees are not walked", 40),
    ("certificates", "leaves are not proved", 120),
    ("certificates", "answers are not looked at", 120),
    ("certificates", "the verifier raises", 20),
    ("certificates", "the clock stands", 40),
    ("killed", "files by and by", 12),
    ("interrupted", "drafts stay", 8),
    ("full disk", "writing raises", 6),
    ("no rights", "writing raises", 6),
]
"""Attack, fault, and the trials within which it must be found."""
QUICK = 7
"""Trials from which a planted fault is one of the slow tests."""


@pytest.mark.parametrize(
    ("name", "fault", "trials"),
    [
        pytest.param(
            *one, id=f"{one[0]}: {one[1]}", marks=[pytest.mark.slow] if one[2] >= QUICK else []
        )
        for one in PLANTED
    ],
)
def test_a_planted_fault_is_found(
    name: str, fault: str, trials: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    account = Account(next(a for a in ATTACKS if a.name == name))
    monkeypatch.setattr(faults, "WORKS", {k: w for k, w in faults.WORKS.items() if w.quick})
    faults._usual.cache_clear()
    for place, other in FAULTS[fault].items():
        monkeypatch.setattr(place, other)
    for number in range(trials):
        tried(account, 11, number)
        if account.broken:
            assert "the attack itself failed" not in account.broken[0].why
            return
    raise AssertionError(f"{trials} trials hold: {account.words}, {account.undecided} undecided")


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
