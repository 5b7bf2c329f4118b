"""Each attack finds a fault planted for it: trials fork, so a child has the fault too."""

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
import trajgap.compare.audits
import trajgap.heuristics
import trajgap.nlp
import trajgap.problem
from trajgap.compare.cli import app
from trajgap.nlp.optimum import Status
from trajgap.problem import Verdict

from attacks import faults
from attacks.attack import Broken
from attacks.reading import hold_together
from attacks.run import ATTACKS, Account, tried, warm
from attacks.sandbox import available

pytestmark = pytest.mark.skipif(not available(), reason="children are forked and watched on Linux")

CHECK = trajgap.problem.check
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


class Read:
    """A case whose problems are others."""

    def __init__(self, case: Any, change: Callable[[Any], Any]) -> None:
        self._case, self._change, self.selections = case, change, case.selections

    def problem(self, *pair: str) -> Any:
        return self._change(self._case.problem(*pair))


def read(change: Callable[[Any], Any]) -> Callable[..., Any]:
    return after(PARSE, lambda case: Read(case, change))


def longer(answer: Any) -> Any:
    """By one per mille."""
    both = (answer.durations, answer.infimum)
    durations, infimum = (None if x is None else x * 1.001 for x in both)
    return replace(answer, vector=durations, infimum=infimum)


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


SOLVE = trajgap.nlp.solve
CLI, VERIFY, MOTIONS = "trajgap.compare.cli.", "trajgap.verify.", "trajgap.problem.motions."
PLANTED: dict[tuple[str, str, int], dict[str, Any]] = {
    ("verdicts", "check passes", 20): {"trajgap.problem.check": all_are(Verdict.PASS)},
    ("verdicts", "check violates", 20): {"trajgap.problem.check": all_are(Verdict.VIOLATED)},
    ("peaks", "peaks one per mille low", 10): {
        "trajgap.problem.check": peaks_are(lambda p: replace(p, value=0.999 * p.value))
    },
    ("verdicts on motions", "digits say nothing", 200): {
        f"{MOTIONS}{reader}.half_units": lambda values, _: 0.0 * values[0]
        for reader in ("tables", "ros")
    },
    ("readings", "sides are one size", 20): {
        "trajgap.problem.parse_case": read(lambda one: replace(one, limits=one.limits.hull))
    },
    ("rounding boxes", "everything breaks", 20): {
        "trajgap.compare.audits.judge_rounding": after(
            trajgap.compare.audits.judge_rounding, lambda found: replace(found, verdict="breaks")
        )
    },
    ("optima", "one per mille long", 6): {"trajgap.nlp.solve": after(SOLVE, longer)},
    ("nasty problems", "all infeasible", 6): {
        "trajgap.nlp.solve": after(
            SOLVE, lambda one: replace(one, status=Status.INFEASIBLE, vector=None)
        )
    },
    ("valid case files", "a fault", 2): {
        CLI + name: fails
        for name in (
            "show_command.show_document",
            "check_command._check_durations",
            "solve_command._solve_case",
            "audit_command.read_cases",
        )
    },
    ("damaged case files", "two lines", 10): {f"{CLI}app._fail": two_lines},
    ("killed", "files by and by", 12): {f"{CLI}output.new_file": files_by_and_by},
    ("interrupted", "drafts stay", 8): {"trajgap.problem.files.atomic._remove": nothing},
    ("full disk", "writing raises", 6): {f"{CLI}output._writing": writing_raises},
    ("no rights", "writing raises", 6): {f"{CLI}output._writing": writing_raises},
    ("certificates", "leaves are not proved", 120): {
        f"{VERIFY}declared.need": nothing,
        f"{VERIFY}closed_form.need": nothing,
        f"{VERIFY}any_curve.need": nothing,
    },
    ("certificates", "answers are not looked at", 120): {f"{VERIFY}verdict.check_answer": nothing},
    ("certificates", "the verifier raises", 20): {f"{VERIFY}verdict.walk": fails},
}
"""Of an attack, a fault and the trials within which it must be found: what is put in its place."""
QUICK = 7
"""Trials from which a planted fault is one of the slow tests."""


@pytest.mark.parametrize(
    "one",
    [
        pytest.param(
            one, id=f"{one[0]}: {one[1]}", marks=[pytest.mark.slow] if one[2] >= QUICK else []
        )
        for one in PLANTED
    ],
)
def test_a_fault_is_found(one: tuple[str, str, int], monkeypatch: pytest.MonkeyPatch) -> None:
    name, _, trials = one
    account = Account(next(a for a in ATTACKS if a.name == name))
    monkeypatch.setattr(faults, "WORKS", {k: w for k, w in faults.WORKS.items() if w.quick})
    faults._usual.cache_clear()
    for place, other in PLANTED[one].items():
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
    (tmp_path / "c.html").write_text(page, "utf-8")
    with pytest.raises(Broken, match=why):
        hold_together(tmp_path)
