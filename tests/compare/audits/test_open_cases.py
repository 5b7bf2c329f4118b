"""Open solutions and tests of libraries: what is right is supported, and what is not is said."""

from __future__ import annotations

import json
import math

import numpy as np
import pytest
from numpy.polynomial import Polynomial
from support.checkout import ROOT
from support.studies import audited
from trajgap.compare import CaseAudit, ClaimVerdict, audit
from trajgap.compare.documents import Severity, json_text
from trajgap.compare.sphinx import distance_of
from trajgap.problem import load_case

EXAMPLES = ROOT / "docs" / "examples"

# Claims that nothing can be computed for, and why is said in each file.
OPEN = {
    "kdl-velocity-profiles": set(),
    "robotics1-2012-01-11": set(),
    "robotics1-2014-02-06": set(),
    "robotics1-2016-04-01": set(),
    "robotics1-2017-07-11": {"unit-3", "unit-5", "unit-7", "fastest-under-acceleration"},
    "robotics1-2017-09-21": set(),
    "robotics1-2018-01-11": set(),
    "robotics1-2018-02-05": set(),
    "robotics1-2018-06-11": set(),
    "robotics1-2020-06-05": set(),
    "robotics1-2021-01-12": {"cosine"},
    "robotics1-2022-02-03": set(),
    "robotics1-2022-09-09": {"from-speed"},
    "robotics1-2024-09-19": set(),
    "ruckig-tests": set(),
    "toppra-cubic-path": {"squared-velocities"},
}

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


@pytest.mark.parametrize("name", OPEN)
def test_what_is_printed_rightly_is_supported(name: str) -> None:
    one = examined(name)
    found = {judgement.claim: judgement.verdict for judgement in one.judgements}
    wrong = {WRONG[name][0]} if name in WRONG else set()
    assert set(found) == {claim.id for claim in load_case(EXAMPLES / f"{name}.toml").claims}
    assert {claim for claim, v in found.items() if v == ClaimVerdict.NOT_CHECKABLE} == OPEN[name]
    assert {claim for claim, v in found.items() if v == ClaimVerdict.INCONSISTENT} == wrong
    assert set(found.values()) <= {
        ClaimVerdict.SUPPORTED, ClaimVerdict.NOT_CHECKABLE, ClaimVerdict.INCONSISTENT
    }  # fmt: skip
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


def test_a_total_rounded_to_below_its_optimum_is_shown_without_a_minus_sign() -> None:
    shown = distance_of(json.loads(json_text(examined("robotics1-2016-04-01").document)))
    assert shown == ("3.6926", "3.6926", "0.0%", "certified")


def test_a_total_of_joints_planned_alone_is_listed_beside_their_own_optima() -> None:
    """3.528/3.4128 and 3.528/3.3324; the optimum of all joints together is another question's."""
    shown = distance_of(json.loads(json_text(audited("puma560-mnam-pso-353").document)))
    assert shown == ("3.528", "3.3324 to 3.4128", "3.4% to 5.9%", "best known")


def test_a_listed_distance_says_that_its_durations_break_a_limit() -> None:
    polishing = json.loads((ROOT / "docs/results/irb1600-ga-cubic-bspline.json").read_text("utf-8"))
    assert distance_of(polishing["cases"][0])[2] == "68.6%, but breaks a limit"
