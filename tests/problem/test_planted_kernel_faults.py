"""A fault planted in the kernels must fail a named test of this suite; none, none of them."""

from __future__ import annotations

import pytest
from support.planting import (
    Killer,
    Suite,
    agreement,
    chebyshev,
    collected,
    fails,
    name,
    named,
    passes,
    polynomials,
    rational,
    waves,
)
from trajgap.problem.curves import kernel

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
    ("SETTLED = 1e-6", "SETTLED = 1e-2", waves),
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
    ("rate *= 1.0 / h[k, v]", "rate *= 1.0", agreement),
    (
        "if top == top else np.inf",
        "if top == top else 0.0",
        named("test_check", "test_evaluate_overflow_is_infinite"),
    ),
    ("top = peak[j * vectors + v] * rate", "top = peak[v] * rate", agreement),
    (
        "valid and 0.0 < durations[k] < np.inf",
        "valid and durations[k] < np.inf",
        named("test_check", "test_evaluate_bad_durations_are_infinite_and_nothing_else"),
    ),
    (
        "take_durations(durations[first + v], h, v)",
        "take_durations(durations[first], h, v)",
        agreement,
    ),
    (
        "if wanted[j, r - 1] and",
        "if",
        named("test_spline_errors", "test_unwanted_peaks_are_zero"),
    ),
]


@pytest.fixture(scope="module")
def suite(request: pytest.FixtureRequest) -> Suite:
    """The tests that must fail."""
    return collected(request)


@pytest.mark.parametrize(("old", "new", "killer"), KERNEL, ids=name)
def test_a_planted_fault_fails(
    monkeypatch: pytest.MonkeyPatch, suite: Suite, old: str, new: str, killer: Killer
) -> None:
    fails(monkeypatch, suite, kernel, old, new, killer)


def test_without_a_fault_the_same_tests_pass(monkeypatch: pytest.MonkeyPatch, suite: Suite) -> None:
    passes(monkeypatch, suite, kernel, {id(k): k for _, _, k in KERNEL}.values())
