"""Audits of cases whose lower and upper limits differ: no side accuses or excuses the other."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest
from support.findings import audited_text, verdicts
from support.made_up import paper, row, sentence
from support.uneven import WAYPOINTS, mirrored, uneven_problem
from trajgap.compare.audits.case_audit import CaseAudit
from trajgap.compare.audits.rounding import RoundingBox, judge_rounding
from trajgap.compare.documents import ClaimVerdict, Rounding, Severity
from trajgap.nlp import solve
from trajgap.problem import Problem, check, evaluate


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


TIMES = [1.1, 1.9, 1.4]


def audited(accelerations: list[list[float]]) -> CaseAudit:
    """Two joints that are said to keep limits whose sides differ."""
    parts = row("d", TIMES), sentence("s", "within_limits", "d")
    curve = {"family": "3-5-3"}
    return audited_text(
        paper(WAYPOINTS.T.tolist(), *parts, curve=curve, acceleration=accelerations)
    )


def test_claims_are_judged_by_the_side_that_counts() -> None:
    """Peaks by each side at fixed durations; limits a little above and below each of them."""
    curve = uneven_problem("3-5-3").curve
    free = Problem(WAYPOINTS, uneven_problem("3-5-3").limits, curve)
    h = np.array(TIMES)
    wanted = np.ones((2, 2, 3), dtype=bool)
    below, above = curve.batch_sides(free.waypoints, h[None], wanted)[:, 0, :, 1]
    assert not np.isclose(below, above, rtol=0.05).any()
    sides = 1.01 * np.stack([-below, above], axis=1)
    kept = audited(sides.tolist())
    assert not any(f.severity is Severity.ERROR for f in kept.findings)
    assert set(verdicts(kept).values()) == {ClaimVerdict.SUPPORTED}
    for place in product((0, 1), repeat=2):
        tight = sides.copy()
        tight[place] *= 0.97
        broken = audited(tight.tolist())
        assert any(f.severity is Severity.ERROR for f in broken.findings)
        assert set(verdicts(broken).values()) == {ClaimVerdict.REFUTED}


def test_the_optimum_of_an_audit_is_that_of_both_sides() -> None:
    one = audited([[-3, 5], [-6, 2.5]])
    problem = one.case.problem("main", "as-printed")
    total = solve(problem).total_time
    assert total > solve(problem.hull).total_time * (1 + 1e-3)
    assert f"{total:.4f}" in str(one.card)
    assert check(problem, TIMES).stretch > 1.0
