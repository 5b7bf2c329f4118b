"""A fault planted in the peak finder or the checker must fail a named test of this suite.

Each mutant is the module's own source with one place changed; the kernels run as plain Python. The
unchanged sources pass the same tests the same way. The tests are asked for by name; pytest
loads their files.
"""

from __future__ import annotations

import importlib
import sys
from collections.abc import Callable
from functools import cache
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
from support.samples import DECLARATIONS
from trajgap.problem import evaluation
from trajgap.problem.curves import interpolant, kernel, peak, spline
from trajgap.problem.curves import kind as curve

checker = importlib.import_module("trajgap.problem.checker")
FILES = {
    "test_check": "test_check.py",
    "test_peak": "curves/test_peak.py",
    "test_spline": "curves/test_spline.py",
}
COMPILED = "compiler(*(Path(__file__).with_name(name) for name in KERNELS))"


class Suite:
    """The tests that must fail, in their files."""

    test_check: ModuleType
    test_peak: ModuleType
    test_spline: ModuleType


Killer = Callable[[Suite], None]


@pytest.fixture(scope="module")
def suite(request: pytest.FixtureRequest) -> Suite:
    """Files as pytest loads them: those of this run, if they are part of it."""
    found = Suite()
    for name_, file in FILES.items():
        path = Path(__file__).parent / file
        setattr(found, name_, pytest.Module.from_parent(request.session, path=path).obj)
    return found


def planted(module: ModuleType, old: str, new: str) -> ModuleType:
    """Run a changed copy of a module's source under another name."""
    assert module.__file__ is not None
    source = Path(module.__file__).read_text(encoding="utf-8")
    assert source.count(old) == 1, f"{old!r} occurs {source.count(old)} times"
    assert (COMPILED in source) == (module is kernel)
    source = source.replace(old, new).replace(COMPILED, "lambda function: function")
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
    elif module is peak:
        monkeypatch.setattr(checker, "extrema", mutant.extrema)
        monkeypatch.setattr(suite.test_peak, "extrema", mutant.extrema)
        monkeypatch.setattr(suite.test_peak, "critical_points", mutant.critical_points)
    elif module is curve:
        monkeypatch.setattr(interpolant, "value_errors", mutant.value_errors)
    else:
        for test_module in (suite.test_check, suite.test_peak):
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


@cache
def named(file: str, test: str) -> Killer:
    """One test that needs no arguments."""

    def call(suite: Suite) -> None:
        getattr(getattr(suite, file), test)()

    call.__name__ = test
    return call


KERNEL: list[tuple[str, str, Killer]] = [
    # roots of one polynomial
    ("if (value > 0.0) == (value_low > 0.0):", "if value > 0.0:", chebyshev),
    ("if not low < step < high:", "if False:", polynomials),
    ("(i + 1) * work[d, i + 1]", "i * work[d, i + 1]", chebyshev),
    ("for k in range(count + 1):", "for k in range(count):", chebyshev),
    ("high = roots[k] if k < count else 1.0", "high = roots[k] if k < count else 0.9", chebyshev),
    ("if low > 0.0:", "if False:", polynomials),
    (
        "elif value_high != 0.0 and (value_low > 0.0)",
        "elif (value_low > 0.0)",
        named("test_peak", "test_no_turning_point_outside_or_without_sign_change"),
    ),
    (
        "(value_low > 0.0) != (value_high > 0.0):",
        "True:",
        named("test_peak", "test_no_turning_point_outside_or_without_sign_change"),
    ),
    ("        count = found\n", "        count = min(found, 3)\n", chebyshev),
    # the spline systems
    ("power[v] *= h[k, v]", "power[v] *= 1.0", rational),
    ("power[v] / perm[r, r]", "power[v]", chebyshev),
    ("weight[v] *= min(1.0, h[b, v] / h[k, v])", "weight[v] *= 1.0", rational),
    ("power[v] *= min(1.0, h[k, v] / h[b, v])", "power[v] *= 1.0", rational),
    ("power, -perm[r, r], joints", "power, perm[r, r], joints", rational),
    ("> abs(system[c, lower, v])", "< abs(system[c, lower, v])", rational),
    ("right[c, j * vectors + v] = other if swap[v] else one", "pass", rational),
    ("system[i, m - i + lower, v] = one if swap[v] else other", "pass", rational),
    ("last = min(c + lower, unknowns - 1)", "last = min(c + 1, unknowns - 1)", rational),
    ("+ upper, unknowns - 1) + 1):", "+ upper, unknowns - 1)):", rational),
    # lanes
    ("value[x] * s[x] + factor * a[i, x]", "value[x] * s[x] + a[i, x]", waves),
    ("f0, f1, f2 = perm[order, order], 0.5 *", "f0, f1, f2 = perm[order, order], 1.0 *", waves),
    ("other = other if 0.0 < other < 1.0", "other = other if 0.0 < other < 0.5", waves),
    ("one = one if 0.0 < one < 1.0", "one = one if 0.5 < one < 1.0", polynomials),
    ("cuts[0, x] = one if one < other else other", "cuts[0, x] = one", waves),
    ("z = -(b + (root if b >= 0.0 else -root))", "z = -(b + root)", polynomials),
    ("for piece in range(count + 1):", "for piece in range(count):", waves),
    ("if piece < count else 1.0\n        _lane", "if piece < count else 0.9\n        _lane", waves),
    ("crosses = ((f < 0.0) != (g < 0.0))", "crosses = ((f < 0.0) == (g < 0.0))", waves),
    ("moved[x] = 1.0 if crosses else 0.0", "moved[x] = 0.0", waves),
    ("if crosses else low[x]", "if crosses else 0.0", waves),
    ("_SETTLED = 1e-6", "_SETTLED = 1e-2", waves),
    ("before = (value[x] < 0.0) == (start[x] < 0.0)", "before = value[x] < 0.0", waves),
    ("start[x] = end[x]", "pass", waves),
    ("low[x] = cuts[piece, x]", "pass", waves),
    ("turn if 0.0 < turn < 1.0 else 0.0", "0.0", waves),
    ("-0.5 * a[1, x] / a[2, x]", "-a[1, x] / a[2, x]", waves),
    ("if abs(a[0, x]) >= abs(end) else abs(end)", "if True else abs(end)", waves),
    ("for order in range(degree - 3, 0, -1):", "for order in range(degree - 3, 1, -1):", waves),
    ("for piece in range(degree - 1):", "for piece in range(degree - 2):", waves),
    ("abs(value[x]) if abs(value[x]) > peak[x]", "value[x] if value[x] > peak[x]", waves),
    # batches
    ("rate = (1.0 / h[k, v]) ** r", "rate = 1.0 / h[k, v]", agreement),
    (
        "if top == top else np.inf",
        "if top == top else 0.0",
        named("test_check", "test_evaluate_overflow_is_infinite"),
    ),
    ("top = peak[j * vectors + v] * rate", "top = peak[v] * rate", agreement),
    (
        "valid and 0.0 < durations[first + v, k] < np.inf",
        "valid and durations[first + v, k] < np.inf",
        named("test_check", "test_evaluate_bad_durations_are_infinite_and_nothing_else"),
    ),
    (
        "h[k, v] = durations[first + v, k] if valid else 1.0",
        "h[k, v] = durations[first, k] if valid else 1.0",
        agreement,
    ),
    (
        "if wanted[j, r - 1] and",
        "if",
        named("test_spline", "test_unwanted_peaks_are_zero"),
    ),
]

PEAK: list[tuple[str, str, Killer]] = [
    ("trajectory.turning(k, joint, order), [1.0]", "[1.0]", waves),
    ("(k, joint, order), [1.0]])", "(k, joint, order)])", waves),
    ("([[0.0], trajectory.turning", "([trajectory.turning", waves),
    ("    if degree < 2:", "    if degree < 3:", chebyshev),
    ("a[1:] * np.arange(1, degree + 1)", "a[1:] * np.arange(degree)", chebyshev),
]

CHECKER: list[tuple[str, str, Killer]] = [
    (
        "0.0 if abs(value) <= error else np.inf",
        "0.0",
        named("test_check", "test_joint_that_must_not_move"),
    ),
    ("return abs(value) / limit", "return value / limit", waves),
    ("[abs(e.value) for e in points]", "[e.value for e in points]", waves),
    (
        "bound = max(float(bounds[i]), float((sizes + bounds).max() - sizes[i]))",
        "bound = 0.0",
        named("test_check", "test_rounding_that_hides_the_limit_is_undecided"),
    ),
    (
        "((low, -1.0), (high, 1.0))",
        "((low, 1.0), (high, 1.0))",
        named("test_check", "test_position_limits"),
    ),
    ("float((high - low) / 2)", "float(high - low)", named("test_check", "test_position_limits")),
    (
        "return peak.error / scale if scale else 0.0",
        "return peak.error",
        named("test_check", "test_position_within_one_ulp_of_its_limit_is_undecided"),
    ),
    ("float(low / d), 0.0", "float(d / low), 0.0", named("test_check", "test_duration_bounds")),
    ("float(d / high), 0.0", "float(high / d), 0.0", named("test_check", "test_duration_bounds")),
    (
        "for b in range(1, len(trajectory.durations)):",
        "for b in range(1, len(trajectory.durations) - 1):",
        named("test_check", "test_velocity_jump_is_discontinuous"),
    ),
    (
        "if abs(size) > bound:",
        "if size > bound:",
        named("test_check", "test_velocity_jump_is_discontinuous"),
    ),
    (
        "for order in range(3):\n                left",
        "for order in range(2):\n                left",
        named("test_check", "test_acceleration_jump_counts_where_jerk_is_limited"),
    ),
    (
        "if not np.isfinite(factor):",
        "if False:",
        named("test_check", "test_joint_that_must_not_move"),
    ),
    (
        "if factor != 1.0 and not problem",
        "if not problem",
        named("test_check", "test_prescribed_velocity_has_no_repair"),
    ),
    (
        "if factor != 1.0 and not problem.curve.homogeneous:",
        "if False:",
        named("test_check", "test_prescribed_velocity_has_no_repair"),
    ),
    (
        'if any(p.quantity == "position" and',
        "if any(False and",
        named("test_check", "test_position_limits"),
    ),
    (
        "if (stretched * slack < problem.duration_lower).any():",
        "if False:",
        named("test_check", "test_duration_bounds"),
    ),
    (
        "if (stretched > problem.duration_upper * slack).any():",
        "if False:",
        named("test_check", "test_duration_bounds"),
    ),
    ("if factor == 0.0:", "if False:", named("test_check", "test_nothing_moves")),
    (
        "if p.ratio - slack > 1 + tolerance:",
        "if p.ratio + slack > 1 + tolerance:",
        named("test_check", "test_rounding_that_hides_the_limit_is_undecided"),
    ),
    (
        "if not p.ratio + slack <= 1 + tolerance:",
        "if not p.ratio - slack <= 1 + tolerance:",
        named("test_check", "test_rounding_that_hides_the_limit_is_undecided"),
    ),
    ("            break\n", "            pass\n", named("test_check", "test_tolerance_decides")),
    (
        "if jump.order < 2 or",
        "if jump.order < 1 or",
        named("test_check", "test_velocity_jump_is_discontinuous"),
    ),
    (
        "if serious and verdict is not Verdict.VIOLATED:",
        "if serious:",
        named("test_check", "test_velocity_jump_is_discontinuous"),
    ),
    (
        "    if serious:\n",
        "    if False:\n",
        named("test_check", "test_velocity_jump_is_discontinuous"),
    ),
    (
        "{q: 1.0 / r for",
        "{q: 1.0 for",
        named("test_check", "test_rest_to_rest_cubic_has_its_textbook_peaks"),
    ),
    (
        "h, max(1.0, stretch), peaks",
        "h, stretch, peaks",
        named("test_check", "test_duration_bounds"),
    ),
    (
        'p.quantity != "duration" or p.ratio > 1 + tolerance',
        "True",
        named("test_check", "test_duration_bounds"),
    ),
]

EVALUATION: list[tuple[str, str, Killer]] = [
    (
        "np.where(peaks[undefined] > 0, np.inf, 0.0)",
        "0.0",
        named("test_check", "test_evaluate_bad_durations_are_infinite_and_nothing_else"),
    ),
    (
        "np.where(peaks[undefined] > 0, np.inf, 0.0)",
        "np.inf",
        named("test_check", "test_joint_that_must_not_move"),
    ),
    ("np.sqrt(top[:, 1])", "top[:, 1]", agreement),
    ("np.cbrt(top[:, 2])", "np.sqrt(top[:, 2])", agreement),
    ("for j in range(1, ratios.shape[1]):", "for j in range(1, ratios.shape[1] - 1):", agreement),
]

CURVE: list[tuple[str, str, Killer]] = [
    ("coefficient_error + size)", "0 * size)", stated_errors),
]

ALL = [
    (module, old, new, killer)
    for module, faults in (
        (kernel, KERNEL),
        (peak, PEAK),
        (checker, CHECKER),
        (evaluation, EVALUATION),
        (curve, CURVE),
    )
    for old, new, killer in faults
]


def name(value: object) -> str | None:
    if isinstance(value, ModuleType):
        return value.__name__.rsplit(".", 1)[-1]
    return getattr(value, "__name__", None) or (value if isinstance(value, str) else None)


@pytest.mark.parametrize(("module", "old", "new", "killer"), ALL, ids=name)
def test_a_planted_fault_fails(
    monkeypatch: pytest.MonkeyPatch,
    suite: Suite,
    module: ModuleType,
    old: str,
    new: str,
    killer: Killer,
) -> None:
    use(monkeypatch, suite, module, planted(module, old, new))
    with (
        np.errstate(all="ignore"),
        pytest.raises((AssertionError, ArithmeticError, LookupError, TypeError, ValueError)),
    ):
        killer(suite)


@pytest.mark.parametrize("module", [kernel, peak, checker, evaluation], ids=name)
def test_without_a_fault_the_same_tests_pass(
    monkeypatch: pytest.MonkeyPatch, suite: Suite, module: ModuleType
) -> None:
    use(monkeypatch, suite, module, planted(module, "from __future__ import annotations", ""))
    with np.errstate(all="ignore"):
        for killer in {id(k): k for m, _, _, k in ALL if m is module}.values():
            killer(suite)
