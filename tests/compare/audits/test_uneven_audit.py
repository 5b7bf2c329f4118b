"""Audits of cases whose lower and upper limits differ: no side accuses or excuses the other."""

from itertools import product

import numpy as np
from support.findings import audited_text, verdicts
from support.made_up import paper, row, sentence
from support.uneven import WAYPOINTS, uneven_problem
from trajgap.compare.audits.case_audit import CaseAudit
from trajgap.compare.documents import ClaimVerdict, Severity
from trajgap.nlp import solve
from trajgap.problem import Problem, check

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
