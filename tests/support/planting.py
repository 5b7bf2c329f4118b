"""Faults planted in the peak finder and the checker, and the tests that must see them.

Each mutant is the module's own source with one place changed; the kernels run as plain Python. The
tests are asked for by name; pytest loads their files.
"""

from __future__ import annotations

import importlib
import sys
from collections.abc import Callable, Iterable
from functools import cache
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
from support.checkout import ROOT
from support.samples import DECLARATIONS
from trajgap.problem.curves import Deferred, interpolant, kernel, peak, pieces, spline, trajectory
from trajgap.problem.curves import kind as curve

checker = importlib.import_module("trajgap.problem.checker")
jumps = importlib.import_module("trajgap.problem.jumps")
uneven = importlib.import_module("trajgap.problem.uneven_peaks")
FILES = {
    "test_check": "test_check.py",
    "test_verdicts": "test_check_verdicts.py",
    "test_peak": "curves/test_peak.py",
    "test_pieces": "curves/test_pieces.py",
    "test_spline": "curves/test_spline.py",
    "test_spline_errors": "curves/test_spline_errors.py",
    "test_timed": "curves/test_timed_spline.py",
    "test_uneven": "test_uneven_limits.py",
}
COMPILED = "compiler(*(Path(__file__).with_name(name) for name in KERNELS))"


class Suite:
    """The tests that must fail, in their files."""

    test_check: ModuleType
    test_verdicts: ModuleType
    test_peak: ModuleType
    test_pieces: ModuleType
    test_spline: ModuleType
    test_spline_errors: ModuleType
    test_timed: ModuleType
    test_uneven: ModuleType


Killer = Callable[[Suite], None]


def collected(request: pytest.FixtureRequest) -> Suite:
    """Files as pytest loads them: those of this run, if they are part of it."""
    found = Suite()
    for name_, file in FILES.items():
        path = ROOT / "tests" / "problem" / file
        setattr(found, name_, pytest.Module.from_parent(request.session, path=path).obj)
    return found


def planted(module: ModuleType, old: str, new: str) -> ModuleType:
    """Run a changed copy of a module's source under another name."""
    assert module.__file__ is not None
    source = Path(module.__file__).read_text(encoding="utf-8")
    assert source.count(old) == 1, f"{old!r} occurs {source.count(old)} times"
    assert (COMPILED in source) == (module is kernel)
    source = source.replace(old, new).replace(COMPILED, "lambda function: function")
    if module is pieces:
        source = source.replace("@compiled\n", "")
    mutant = ModuleType(f"{module.__name__}_planted")
    mutant.__package__ = module.__package__
    mutant.__file__ = module.__file__
    sys.modules[mutant.__name__] = mutant
    try:
        exec(compile(source, module.__file__, "exec"), mutant.__dict__)
    finally:
        del sys.modules[mutant.__name__]
    return mutant


def use(
    monkeypatch: pytest.MonkeyPatch, suite: Suite, module: ModuleType, mutant: ModuleType
) -> None:
    """Let the suite meet the mutant in the module's place."""
    if module is kernel:
        monkeypatch.setattr(spline, "kernel", mutant)
        monkeypatch.setattr(peak, "kernel", mutant)
        # What runs interpreted at first holds the kernels themselves.
        monkeypatch.setattr(spline, "_fit_one", mutant.fit_coefficients)
        monkeypatch.setattr(spline, "_fit_many", mutant.fit_coefficients)
        monkeypatch.setattr(spline, "_peaks_of_many", Deferred(mutant.batch_peaks, 0.0))
        monkeypatch.setattr(peak, "unit_roots", mutant.roots_in_unit)
        plain = planted(pieces, "from __future__ import annotations", "")
        monkeypatch.setattr(plain, "roots_in_unit", mutant.roots_in_unit)
        monkeypatch.setattr(checker, "largest_of_each", plain.largest_of_each)
    elif module is peak:
        users = (checker, trajectory, suite.test_peak, suite.test_pieces, suite.test_timed)
        for name in ("extrema", "largest", "polynomial_extrema", "critical_points"):
            held = [user for user in users if hasattr(user, name)]
            assert held, f"nobody takes {name} from peak"
            for user in held:
                monkeypatch.setattr(user, name, getattr(mutant, name))
    elif module is pieces:
        for name, asking in (("largest_of_each", checker), ("may_jump", jumps)):
            for user in (asking, suite.test_pieces):
                monkeypatch.setattr(user, name, getattr(mutant, name))
    elif module is jumps:
        monkeypatch.setattr(checker, "jumps_of", mutant.jumps_of)
    elif module is uneven:
        monkeypatch.setattr(checker, "uneven_peaks", mutant.uneven_peaks)
    elif module is curve:
        monkeypatch.setattr(interpolant, "value_errors", mutant.value_errors)
    else:
        for test_module in (suite.test_check, suite.test_verdicts, suite.test_peak):
            for name in ("check", "evaluate", "Verdict"):
                if hasattr(test_module, name) and hasattr(mutant, name):
                    monkeypatch.setattr(test_module, name, getattr(mutant, name))


def chebyshev(suite: Suite) -> None:
    for degree in (2, 3, 5, 8):
        suite.test_peak.test_chebyshev_reaches_one_at_every_extremum(degree)


def waves(suite: Suite) -> None:
    for degree in range(1, 9):
        suite.test_peak.test_random_waves(degree)


def polynomials(suite: Suite) -> None:
    rng = np.random.default_rng(2)
    clusters = [[0.2] * 3 + [0.8] * 3, [0.54] * 3 + [0.648] * 3 + [0.576], [0.1, 0.4]]
    clusters += [[0.03] * 3 + [0.57] * 3 + [0.75], [0.29] * 3 + [0.814] * 3 + [0.09]]
    for degree in (2, 3, 4, 5, 6, 7):
        clusters += [list(rng.uniform(0, 1, degree)), [0.5] * degree]
    for roots in clusters:
        for shift in (0.0, -0.01):
            suite.test_peak.test_clustered_and_multiple_turning_points.hypothesis.inner_test(
                roots, 1, shift
            )
    for coefficients in ([0.0, 1.0, -1.0, 1e-18], [0.0, 1.0, -1.0, 0.0, 0.0]):
        suite.test_peak.test_any_polynomial.hypothesis.inner_test(coefficients)


def rational(suite: Suite) -> None:
    for name in ("3-5-3", "uneven", "4-1-4", "cubic, virtual", "quintic"):
        suite.test_spline.test_coefficients_against_rational_arithmetic(name, 1.5)


def agreement(suite: Suite) -> None:
    for name in ("3-5-3", "quintic", "uneven", "rest 7"):
        for seed in range(5):
            suite.test_check.test_evaluate_agrees_with_check.hypothesis.inner_test(name, seed, 0.8)


def stated_errors(suite: Suite) -> None:
    for name in DECLARATIONS:
        suite.test_check.test_values_lie_within_the_stated_error(name)


def digits(suite: Suite) -> None:
    for name in ("3-5-3", "cubic, virtual"):
        suite.test_peak.test_extrema_against_fifty_digits(name)


def together(suite: Suite) -> None:
    for name in suite.test_pieces.NAMES:
        with pytest.MonkeyPatch.context() as patch:
            suite.test_pieces.test_one_call_finds_what_one_search_after_another_finds(
                name, 0.0, patch
            )


def places(suite: Suite) -> None:
    suite.test_timed.test_extrema_hold_both_ends_and_every_turn_of_each_piece()


@cache
def named(file: str, test: str) -> Killer:
    """One test that needs no arguments."""

    def call(suite: Suite) -> None:
        getattr(getattr(suite, file), test)()

    call.__name__ = test
    return call


def name(value: object) -> str | None:
    if isinstance(value, ModuleType):
        return value.__name__.rsplit(".", 1)[-1]
    return getattr(value, "__name__", None) or (value if isinstance(value, str) else None)


def fails(
    monkeypatch: pytest.MonkeyPatch,
    suite: Suite,
    module: ModuleType,
    old: str,
    new: str,
    killer: Killer,
) -> None:
    """Require that the killer fails with the change of a module's source."""
    use(monkeypatch, suite, module, planted(module, old, new))
    with (
        np.errstate(all="ignore"),
        pytest.raises((AssertionError, ArithmeticError, LookupError, TypeError, ValueError)),
    ):
        killer(suite)


def passes(
    monkeypatch: pytest.MonkeyPatch, suite: Suite, module: ModuleType, killers: Iterable[Killer]
) -> None:
    """Require that the killers pass with the unchanged source, loaded the same way."""
    use(monkeypatch, suite, module, planted(module, "from __future__ import annotations", ""))
    with np.errstate(all="ignore"):
        for killer in killers:
            killer(suite)
