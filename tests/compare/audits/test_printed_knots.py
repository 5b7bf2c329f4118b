"""Audits of a curve whose knots are printed: nothing is held against what their digits may hide."""

from __future__ import annotations

import pytest
from trajgap.compare import ClaimVerdict, audit
from trajgap.compare.audits import CaseAudit
from trajgap.compare.pages.readings import _determined
from trajgap.problem import parse_case

CASE = """
format = 1
id = "knots"
title = "Printed knots"
[source]
title = "none"
[robot]
name = "arm"
joints = ["a", "b"]
[units]
position = "rad"
velocity = "rad/s"
acceleration = "rad/s^2"
time = "s"
[waypoints]
waypoint_rows = [[0.3, -1.0], [0.9, -0.55], [0.2, 0.35], [-0.45, 0.1]]
[limits]
velocity = [1.1, 1.7]
acceleration = [3.0, 2.2]
[interpolant]
family = "clamped-b-spline"
degree = 4
{curve}
[[claims]]
id = "d"
quantity = "durations"
where = "Table 3"
durations = [{durations}]
[[claims]]
id = "kept"
quantity = "statement"
where = "text"
checks = "within_limits"
of = ["d"]
[[claims]]
id = "smooth"
quantity = "statement"
where = "text"
checks = "continuous"
of = ["d"]
[[claims]]
id = "peak"
quantity = "peak"
where = "Table 4"
derivative = "velocity"
values = ["0.99", "1.62"]
of = "d"
[[claims]]
id = "mean"
quantity = "measure"
where = "Table 5"
derivative = "velocity"
measure = "mean"
values = ["9.4", "9.3"]
of = "d"
[[claims]]
id = "shortest"
quantity = "statement"
where = "text"
checks = "optimal"
of = ["d"]
"""
KNOTS = 'knots = "given"\nknot_vector = [0, 0, 0, 0, 0, {inner}, 10, 10, 10, 10, 10]\n'
TIMED = f'{KNOTS}parameters = "times"'
STRETCHED = f'{KNOTS}parameters = "given"\ntime = "stretched"\nparameter_values = [0, 3, 6.5, 10]'
INNER = {"exact": "2.5, 5, 8", "printed": '"2.5", 5, "8"'}


def audited(curve: str, inner: str, durations: str) -> CaseAudit:
    block = curve.format(inner=INNER[inner])
    case = parse_case(CASE.format(curve=block, durations=durations), "knots.toml")
    return audit(case, seeds=2, certify_seconds=0).cases[0]


def verdicts(one: CaseAudit) -> dict[str, ClaimVerdict]:
    return {j.claim: j.verdict for j in one.judgements}


@pytest.fixture(scope="module")
def slow() -> dict[str, CaseAudit]:
    """Durations that keep the limits, far from the shortest ones."""
    return {inner: audited(TIMED, inner, '"3.0", "3.2", "3.5"') for inner in INNER}


def test_exact_knots_are_held_against_what_is_said(slow: dict[str, CaseAudit]) -> None:
    found = verdicts(slow["exact"])
    assert found["kept"] is found["smooth"] is ClaimVerdict.SUPPORTED
    assert found["peak"] is found["mean"] is ClaimVerdict.INCONSISTENT
    assert found["shortest"] is ClaimVerdict.REFUTED


def test_rounded_knots_are_not(slow: dict[str, CaseAudit]) -> None:
    found = verdicts(slow["printed"])
    assert found["kept"] is found["smooth"] is ClaimVerdict.SUPPORTED, "at some value it does"
    assert found["peak"] is found["mean"] is ClaimVerdict.NOT_CHECKABLE
    assert found["shortest"] is ClaimVerdict.NOT_CHECKABLE
    note = " Knots are rounded numbers, which may explain it."
    assert sum(f.message.endswith(note) for f in slow["printed"].findings) == 2


def test_a_broken_limit_is_not_refuted_for_rounded_knots() -> None:
    hasty = {inner: audited(TIMED, inner, '"0.20", "0.20", "0.20"') for inner in INNER}
    assert verdicts(hasty["exact"])["kept"] is ClaimVerdict.REFUTED
    assert verdicts(hasty["printed"])["kept"] is ClaimVerdict.NOT_CHECKABLE
    (found,) = (f for f in hasty["printed"].findings if f.rule == "TG201" and f.claim == "d")
    assert found.message.endswith(
        " Knots are printed numbers, and no proof covers all that rounds to them."
    )


def test_no_table_of_rules_stands_beside_a_printed_vector() -> None:
    curves = {"printed": TIMED.format(inner=INNER["exact"])}
    curves["by a rule"] = 'knots = "averaged-continued"\nparameters = "times"'
    shown = {
        name: _determined(parse_case(CASE.format(curve=block, durations="1, 1, 1"), "knots.toml"))
        for name, block in curves.items()
    }
    assert shown["printed"] == []
    assert len(shown["by a rule"]) == 1


def test_stretched_segments_jump_unless_rounding_hides_their_proportions() -> None:
    # 3 : 3.5 : 3.5 are the proportions of the parameters; 0.86 : 1.00 : 1.00 round to them.
    near = audited(STRETCHED, "exact", '"0.86", "1.00", "1.00"')
    assert verdicts(near)["smooth"] is ClaimVerdict.NOT_CHECKABLE
    (said,) = (f for f in near.findings if f.claim == "smooth")
    assert "may have the proportions of the parameters" in said.message
    far = audited(STRETCHED, "exact", '"0.96", "1.00", "1.00"')
    assert verdicts(far)["smooth"] is ClaimVerdict.INCONSISTENT
