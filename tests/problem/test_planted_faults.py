"""A fault planted in the peak finder or the checker must fail a named test of this suite.

The unchanged sources pass the same tests the same way. Kernels have a file of their own.
"""

from __future__ import annotations

import importlib
from types import ModuleType

import pytest
from support.planting import (
    Killer,
    Suite,
    agreement,
    chebyshev,
    collected,
    digits,
    fails,
    jumps,
    name,
    named,
    passes,
    places,
    stated_errors,
    together,
    uneven,
    waves,
)
from trajgap.problem import evaluation
from trajgap.problem.curves import kind as curve
from trajgap.problem.curves import peak, pieces

checker = importlib.import_module("trajgap.problem.checker")
wrong_side = named("test_uneven", "test_the_wrong_side_is_a_violation")
side_of_zero = named("test_uneven", "test_a_side_of_zero_forbids_that_side_alone")

PEAK: list[tuple[str, str, Killer]] = [
    ("    if degree < 2:", "    if degree < 3:", chebyshev),
    ("a[1:] * np.arange(1, degree + 1)", "a[1:] * np.arange(degree)", chebyshev),
    # polynomials
    ("for s in (0.0, *inner, 1.0)", "for s in (0.0, 1.0)", digits),
    ("for s in (0.0, *inner, 1.0)", "for s in (0.0, *inner)", digits),
    ("for s in (0.0, *inner, 1.0)", "for s in (*inner, 1.0)", digits),
    ("if len(coefficients) > 2 else", "if len(coefficients) > 3 else", digits),
    ("value = c + value * s", "value = c + value", digits),
    # other curves
    (
        "trajectory.turning(k, joint, order), [1.0]])\n        times",
        "[1.0]])\n        times",
        places,
    ),
    (", [1.0]])\n        times", "])\n        times", places),
    (
        "([[0.0], trajectory.turning(k, joint, order), [1.0]])\n        times",
        "([trajectory.turning(k, joint, order), [1.0]])\n        times",
        places,
    ),
    # the largest
    (
        "trajectory.turning(k, joint, order), [1.0]])\n        values",
        "[1.0]])\n        values",
        together,
    ),
    (", [1.0]])\n        values", "])\n        values", together),
    (
        "([[0.0], trajectory.turning(k, joint, order), [1.0]])\n        values",
        "([trajectory.turning(k, joint, order), [1.0]])\n        values",
        together,
    ),
    ("np.abs(values).argmax()", "values.argmax()", together),
    ("here = abs(float(values[i]))", "here = float(values[i])", together),
    ("if size == size and not here <= size:", "if k == 0:", together),
    (
        "bound = max(float(errors[piece]), reach - size)",
        "bound = 0.0",
        together,
    ),
    (
        "bound = max(float(errors[piece]), reach - size)",
        "bound = float(errors[piece])",
        named("test_peak", "test_another_piece_that_may_be_larger_blurs_the_peak"),
    ),
]

PIECES: list[tuple[str, str, Killer]] = [
    ("a[i] = a[i + 1] * (i + 1)", "a[i] = a[i + 1] * i", agreement),
    ("a[i] /= power", "a[i] /= 1.0", agreement),
    ("turn[i] = a[i + 1] * (i + 1)", "turn[i] = a[i + 1]", agreement),
    ("places[0], places[found + 1] = 0.0, 1.0", "places[0], places[found + 1] = 0.0, 0.9", waves),
    ("value = a[i] + value * places[m]", "value = a[i] + value", agreement),
    ("if top == top and not abs(room[3, m]) <= top:", "if room[3, m] > top:", waves),
    ("if size == size and not here <= size:", "if k == 0:", agreement),
    ("total = here + error[k, order, joint]", "total = here", together),
    (
        "bound = max(float(error[k, order, joint]), float(reach[joint, column]) - abs(value))",
        "bound = 0.0",
        named("test_verdicts", "test_rounding_that_hides_the_limit_is_undecided"),
    ),
    (
        "bound = max(float(error[k, order, joint]), float(reach[joint, column]) - abs(value))",
        "bound = float(error[k, order, joint])",
        together,
    ),
    (
        "return not (np.abs(starts[1:]",
        "return False and not (np.abs(starts[1:]",
        named("test_pieces", "test_a_jump_is_never_overlooked"),
    ),
]

CHECKER: list[tuple[str, str, Killer]] = [
    (
        "0.0 if abs(value) <= error else np.inf",
        "0.0",
        named("test_verdicts", "test_joint_that_must_not_move"),
    ),
    ("return abs(value) / limit", "return value / limit", waves),
    (
        "((low, -1.0, ends[0]), (high, 1.0, ends[1]))",
        "((low, 1.0, ends[0]), (high, -1.0, ends[1]))",
        named("test_verdicts", "test_position_limits"),
    ),
    (
        "half = half_range(low, high, limit)",
        "half = 2 * half_range(low, high, limit)",
        named("test_verdicts", "test_position_limits"),
    ),
    (
        "return peak.error / scale if scale else 0.0",
        "return peak.error",
        named("test_verdicts", "test_position_within_one_ulp_of_its_limit_is_undecided"),
    ),
    (
        "float(low / d), 0.0",
        "float(d / low), 0.0",
        named("test_verdicts", "test_duration_bounds"),
    ),
    (
        "float(d / high), 0.0",
        "float(high / d), 0.0",
        named("test_verdicts", "test_duration_bounds"),
    ),
    (
        "if not np.isfinite(factor):",
        "if False:",
        named("test_verdicts", "test_joint_that_must_not_move"),
    ),
    (
        "if factor != 1.0 and not problem",
        "if not problem",
        named("test_verdicts", "test_prescribed_velocity_has_no_repair"),
    ),
    (
        "if factor != 1.0 and not problem.curve.homogeneous:",
        "if False:",
        named("test_verdicts", "test_prescribed_velocity_has_no_repair"),
    ),
    (
        'if any(p.quantity == "position" and',
        "if any(False and",
        named("test_verdicts", "test_position_limits"),
    ),
    (
        "if (stretched * slack < problem.duration_lower).any():",
        "if False:",
        named("test_verdicts", "test_duration_bounds"),
    ),
    (
        "if (stretched > problem.duration_upper * slack).any():",
        "if False:",
        named("test_verdicts", "test_duration_bounds"),
    ),
    ("if factor == 0.0:", "if False:", named("test_verdicts", "test_nothing_moves")),
    (
        "if p.ratio - slack > 1 + tolerance:",
        "if p.ratio + slack > 1 + tolerance:",
        named("test_verdicts", "test_rounding_that_hides_the_limit_is_undecided"),
    ),
    (
        "if not p.ratio + slack <= 1 + tolerance:",
        "if not p.ratio - slack <= 1 + tolerance:",
        named("test_verdicts", "test_rounding_that_hides_the_limit_is_undecided"),
    ),
    (
        "            break\n",
        "            pass\n",
        named("test_verdicts", "test_tolerance_decides"),
    ),
    (
        "if jump.order < 2 or",
        "if jump.order < 1 or",
        named("test_verdicts", "test_velocity_jump_is_discontinuous"),
    ),
    (
        "if serious and verdict is not Verdict.VIOLATED:",
        "if serious:",
        named("test_verdicts", "test_velocity_jump_is_discontinuous"),
    ),
    (
        "    if serious:\n",
        "    if False:\n",
        named("test_verdicts", "test_velocity_jump_is_discontinuous"),
    ),
    (
        "{q: 1.0 / r for",
        "{q: 1.0 for",
        named("test_check", "test_rest_to_rest_cubic_has_its_textbook_peaks"),
    ),
    (
        "h, max(1.0, stretch), peaks",
        "h, stretch, peaks",
        named("test_verdicts", "test_duration_bounds"),
    ),
    (
        'p.quantity != "duration" or p.ratio > 1 + tolerance',
        "True",
        named("test_verdicts", "test_duration_bounds"),
    ),
]

EVALUATION: list[tuple[str, str, Killer]] = [
    (
        "np.where(wanted, limits, 1.0)",
        "limits",
        named("test_check", "test_evaluate_bad_durations_are_infinite_and_nothing_else"),
    ),
    (
        "ratios[np.isnan(ratios)] = 0.0",
        "ratios[np.isnan(ratios)] = np.inf",
        named("test_verdicts", "test_joint_that_must_not_move"),
    ),
    ("np.sqrt(top[:, 1])", "top[:, 1]", agreement),
    ("np.cbrt(top[:, 2])", "np.sqrt(top[:, 2])", agreement),
    ("for j in range(1, ratios.shape[1]):", "for j in range(1, ratios.shape[1] - 1):", agreement),
]

JUMPS: list[tuple[str, str, Killer]] = [
    (
        "for b in range(1, len(trajectory.durations)):",
        "for b in range(1, len(trajectory.durations) - 1):",
        named("test_verdicts", "test_velocity_jump_is_discontinuous"),
    ),
    (
        "if abs(size) > bound:",
        "if size > bound:",
        named("test_verdicts", "test_velocity_jump_is_discontinuous"),
    ),
    (
        "for order in range(3):\n                left",
        "for order in range(2):\n                left",
        named("test_verdicts", "test_acceleration_jump_counts_where_jerk_is_limited"),
    ),
]

UNEVEN: list[tuple[str, str, Killer]] = [
    ("((0, -1.0), (1, 1.0))", "((1, -1.0), (0, 1.0))", wrong_side),
    ("((0, -1.0), (1, 1.0))", "((1, 1.0),)", wrong_side),
    ("here = sign * point.value", "here = point.value", wrong_side),
    ("float(np.maximum(0.0, top)) / size", "abs(top) / size", side_of_zero),
    ("0.0 if top <= bound else np.inf", "0.0", side_of_zero),
]

CURVE: list[tuple[str, str, Killer]] = [
    ("coefficient_error + size)", "0 * size)", stated_errors),
]

ALL = [
    (module, old, new, killer)
    for module, faults in (
        (peak, PEAK),
        (pieces, PIECES),
        (checker, CHECKER),
        (jumps, JUMPS),
        (uneven, UNEVEN),
        (evaluation, EVALUATION),
        (curve, CURVE),
    )
    for old, new, killer in faults
]


@pytest.fixture(scope="module")
def suite(request: pytest.FixtureRequest) -> Suite:
    """The tests that must fail."""
    return collected(request)


@pytest.mark.parametrize(("module", "old", "new", "killer"), ALL, ids=name)
def test_a_planted_fault_fails(
    monkeypatch: pytest.MonkeyPatch,
    suite: Suite,
    module: ModuleType,
    old: str,
    new: str,
    killer: Killer,
) -> None:
    fails(monkeypatch, suite, module, old, new, killer)


@pytest.mark.parametrize(
    "module", [peak, pieces, checker, jumps, uneven, evaluation, curve], ids=name
)
def test_without_a_fault_the_same_tests_pass(
    monkeypatch: pytest.MonkeyPatch, suite: Suite, module: ModuleType
) -> None:
    killers = {id(k): k for m, _, _, k in ALL if m is module}
    passes(monkeypatch, suite, module, killers.values())
