"""Audits of cases whose lower and upper limits differ: no side accuses or excuses the other."""

from __future__ import annotations

import numpy as np
import pytest
from support.uneven import WAYPOINTS, mirrored, uneven_problem
from trajgap.compare import audit
from trajgap.compare.audits.rounding import RoundingBox, judge_rounding
from trajgap.compare.documents import ClaimVerdict, Rounding, Severity
from trajgap.nlp import solve
from trajgap.problem import Problem, check, evaluate, parse_case

CASE = """
format = 1
id = "uneven"
title = "Uneven"
coupling = "shared"
source = {{ year = 2020 }}
robot = {{ name = "arm", joints = ["a", "b"] }}
units = {{ position = "rad", velocity = "rad/s", acceleration = "rad/s^2", time = "s" }}
interpolant = {{ family = "3-5-3" }}

[waypoints]
waypoint_rows = [[0.1, -0.4], [0.7, 0.3], [1.2, -0.5], [0.9, 0.2]]

[limits]
acceleration = [{first}, {second}]

[[claims]]
id = "d"
quantity = "durations"
where = "Table 1"
durations = [{durations}]

[[claims]]
id = "s"
quantity = "statement"
where = "Section 1"
text = "The motion keeps its limits."
checks = "within_limits"
of = ["d"]
"""


@pytest.mark.parametrize("curve", ["3-5-3", "cubic", "stretched"])
@pytest.mark.parametrize("share", [0.9, 0.999, 1.0005, 1.05])
def test_what_breaks_breaks_all_over_the_box(curve: str, share: float) -> None:
    problem = uneven_problem(curve)
    generator = np.random.default_rng(7)
    h = np.array([0.8, 1.2, 0.9])
    h *= share * evaluate(problem, h[None]).stretch[0]
    box = RoundingBox(h, h - 5e-4, h + 5e-4)
    found = judge_rounding(problem, box)
    drawn = generator.uniform(box.lower, box.upper, (400, 3))
    sampled = evaluate(problem, drawn).ratios.max(axis=(1, 2))
    if found.verdict is Rounding.BREAKS:
        assert sampled.min() > 1.0
    if share < 0.99:
        assert found.verdict is Rounding.BREAKS
    if share > 1.01:
        # A stretched curve jumps between its segments, so that nothing is said to keep limits.
        jumping = curve == "stretched"
        assert found.verdict is (Rounding.UNDECIDED if jumping else Rounding.KEEPS)
    if found.lower_bound_of_worst is not None:
        assert found.lower_bound_of_worst <= sampled.min() * (1 + 1e-12)
    back = judge_rounding(mirrored(problem), box)
    assert (back.verdict, back.worst_at_print) == (found.verdict, found.worst_at_print)


def judged(first: str, second: str, durations: str) -> tuple[dict[str, ClaimVerdict], int]:
    text = CASE.format(first=first, second=second, durations=durations)
    one = audit(parse_case(text, "uneven.toml"), seeds=2).cases[0]
    errors = sum(f.severity is Severity.ERROR for f in one.findings)
    return {j.claim: j.verdict for j in one.judgements}, errors


def test_claims_are_judged_by_the_side_that_counts() -> None:
    """Peaks by each side at fixed durations; limits a little above and below each of them."""
    curve = uneven_problem("3-5-3").curve
    free = Problem(WAYPOINTS, uneven_problem("3-5-3").limits, curve)
    h = np.array([1.1, 1.9, 1.4])
    wanted = np.ones((2, 2, 3), dtype=bool)
    below, above = curve.batch_sides(free.waypoints, h[None], wanted)[:, 0, :, 1]
    assert not np.isclose(below, above, rtol=0.05).any()
    loose = [f"[{-1.01 * b:.9f}, {1.01 * a:.9f}]" for b, a in zip(below, above, strict=True)]
    printed = ", ".join(map(str, h))
    verdicts, errors = judged(*loose, printed)
    assert errors == 0
    assert set(verdicts.values()) == {ClaimVerdict.SUPPORTED}
    for joint in (0, 1):
        for side in (0, 1):
            tight = [[1.01 * below[j], 1.01 * above[j]] for j in (0, 1)]
            tight[joint][side] *= 0.97
            pairs = [f"[{-low:.9f}, {high:.9f}]" for low, high in tight]
            verdicts, errors = judged(*pairs, printed)
            assert errors > 0
            assert set(verdicts.values()) == {ClaimVerdict.REFUTED}


def test_the_optimum_of_an_audit_is_that_of_both_sides() -> None:
    text = CASE.format(first="[-3, 5]", second="[-6, 2.5]", durations="1.1, 1.9, 1.4")
    case = parse_case(text, "uneven.toml")
    one = audit(case, seeds=2).cases[0]
    problem = case.problem("main", "as-printed")
    total = solve(problem).total_time
    assert total > solve(problem.hull).total_time * (1 + 1e-3)
    assert f"{total:.4f}" in str(one.card)
    assert check(problem, [1.1, 1.9, 1.4]).stretch > 1.0
