"""Open solutions, tests of libraries and papers: what is printed rightly is supported."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest
from numpy.polynomial import Polynomial
from support.checkout import ROOT
from support.findings import verdicts
from support.studies import audited
from trajgap.compare import CaseAudit, ClaimVerdict, audit
from trajgap.compare.documents import Scope, Severity, json_text
from trajgap.compare.sphinx import paper_row
from trajgap.problem import load_case

EXAMPLES = ROOT / "docs" / "examples"

OPEN: dict[str, set[str]] = {
    "robotics1-2017-07-11": {"unit-3", "unit-5", "unit-7", "fastest-under-acceleration"},
    "robotics1-2021-01-12": {"cosine"},
    "robotics1-2022-09-09": {"from-speed"},
    "toppra-cubic-path": {"squared-velocities"},
}
"""Claims that nothing can be computed for; why is said in each file."""
RIGHT = """
kdl-velocity-profiles ruckig-tests robotics1-2012-01-11 robotics1-2014-02-06 robotics1-2016-04-01
robotics1-2017-09-21 robotics1-2018-01-11 robotics1-2018-02-05 robotics1-2018-06-11
robotics1-2020-06-05 robotics1-2022-02-03 robotics1-2024-09-19
two-joint-arm-c4-quintic two-joint-arm-natural-cubic
"""

# Printed values that are not those of the printed motion; what they are is computed below, by hand.
WRONG = {
    "robotics1-2017-07-11": ("largest-acceleration-7", 3.36),
    "robotics1-2020-06-05": ("peak-velocity-1", 0.9870),
}


def by_hand(name: str) -> float:
    """What a wrongly printed value should be, from the polynomials that the solution prints."""
    if name == "robotics1-2017-07-11":
        septic = Polynomial([0, 0, 0, 0, 35, -84, 70, -20])
        times = septic.deriv(3).roots().real
        return float(np.abs(septic.deriv(2)(times)).max())
    quintic = Polynomial([0, 0, 0, 10, -15, 6])
    return float(quintic.deriv()(0.5)) * math.pi / 2 / 3.0115


def examined(name: str) -> CaseAudit:
    return audit(EXAMPLES / f"{name}.toml", certify_seconds=0).cases[0]


@pytest.mark.parametrize("name", [*OPEN, *RIGHT.split()])
def test_what_is_printed_rightly_is_supported(name: str) -> None:
    one = examined(name)
    wanted = dict.fromkeys((claim.id for claim in one.case.claims), ClaimVerdict.SUPPORTED)
    wanted |= dict.fromkeys(OPEN.get(name, ()), ClaimVerdict.NOT_CHECKABLE)
    wanted |= dict.fromkeys(WRONG.get(name, ())[:1], ClaimVerdict.INCONSISTENT)
    assert verdicts(one) == wanted
    assert one.errors == 0


@pytest.mark.parametrize("name", WRONG)
def test_a_largest_value_that_is_another_is_shown_with_both(name: str) -> None:
    claim, printed = WRONG[name]
    truth = by_hand(name)
    assert abs(truth - printed) > 0.005
    (said,) = [f for f in examined(name).findings if f.severity == Severity.WARNING]
    assert (said.rule, said.claim) == ("TG203", claim)
    assert f"printed is {load_case(EXAMPLES / f'{name}.toml').claim(claim).value}" in said.message
    computed = float(said.message.split(" is ")[1].split()[0])
    assert computed == pytest.approx(truth, rel=1e-4)


def test_what_a_table_of_papers_lists() -> None:
    """A total that rounds to below its optimum without a minus sign; 3.528/3.4128 and 3.528/3.3324
    of joints planned alone, since the optimum of all together is another question's."""
    below = examined("robotics1-2016-04-01").document
    alone = audited("puma560-mnam-pso-353").document
    for document, shown in (
        (below, ("3.6926", "3.6926", "the optimum", "certified")),
        (alone, ("3.528", "3.3324 to 3.4128", "3.4 to 5.9 %", "best known")),
    ):
        assert paper_row("", json.loads(json_text(document))).cells[:4] == shown
    polishing = json.loads((ROOT / "docs/results/irb1600-ga-cubic-bspline.json").read_text("utf-8"))
    above = paper_row("", polishing["cases"][0]).cells[2]
    assert above == "at least 68.5 %, but breaks a limit"


@pytest.mark.parametrize("name", ["fang2020-task1", "fang2020-task2"])
def test_the_clean_septic_totals_of_fang_2020_come_out_supported(name: str) -> None:
    one = audit(EXAMPLES / f"{name}.toml", seeds=2).cases[0]
    assert {f.severity for f in one.findings} == {Severity.INFO}
    assert len(one.judgements) == 4
    assert {j.verdict for j in one.judgements} == {ClaimVerdict.SUPPORTED}
    assert {j.scope for j in one.judgements} == {Scope.ALL}
