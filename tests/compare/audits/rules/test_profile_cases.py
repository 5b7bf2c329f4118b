"""Cases of profiles between states, and the verdict on each beside what was computed elsewhere.

Totals were recomputed by ruckig 0.19.4 or by hand, apart from this project; the files name sources.
"""

from __future__ import annotations

from functools import cache

import pytest
from support.checkout import ROOT
from support.findings import verdicts
from trajgap.compare import CaseAudit, ClaimVerdict, audit
from trajgap.compare.documents import Severity

NOT_SUPPORTED: dict[str, dict[str, str]] = {
    "ban2024-dual-s-welding": {
        "not checkable": "total-a total-b total-c a-shorter-than-b a-shorter-than-c"
    },
    "biagiotti2008-double-s": {},
    "he2022-closed-form-paths": {
        "not checkable": "strictly-optimal "
        + " ".join(f"{p}-case-{n}" for p in ("sinusoid", "squircle", "nurbs") for n in (1, 2, 3))
    },
    "long-term-planner-switch-times": {},
    "pilz-atrap-profile": {},
    "pilz-ptp-scaled": {},
    "riboli2023-iptp-16-tasks": {"not checkable": "plateau-15"},
    "robotics1-2017-04-11": {},
    "ruckig-issue-128": {"inconsistent": "reported"},
    "ruckig-issue-204": {},
    "wang2025-mim-wafer-stage": {"not checkable": "above-optimum"},
    "zhao2022-sine-jerk-otg": {},
}
"""Claims of each case by their verdict where it is another one than supported."""
SAID = {
    ("biagiotti2008-double-s", "ex-3.11-phases"): "takes 1.78045 s; the algorithm's is 8.87 %",
    ("biagiotti2008-double-s", "ex-3.12-phases"): "takes 1.75422 s; the algorithm's is 52.01 %",
    ("biagiotti2008-double-s", "ex-3.9-phases"): "takes 2.71 s too",
    ("pilz-atrap-profile", "reversal-total"): "takes 3.73205 s",
    ("pilz-ptp-scaled", "total"): "takes 4.5 s",
    ("robotics1-2017-04-11", "phases"): "phases of 0.225, 0.99583, 0.675 s",
    ("ruckig-issue-128", "reached"): "brakes into them at once",
    ("ruckig-issue-128", "reported"): "takes 0.167347 s; printed is 0.230593 s, which is 37.79 %",
    ("ruckig-issue-204", "first-total"): "it jumps from 0.28564",
    ("ruckig-issue-204", "second-total"): "it jumps from 0.28564",
    ("wang2025-mim-wafer-stage", "total"): "takes 0.210003 s",
    ("zhao2022-sine-jerk-otg", "total"): "takes 2.61718 s",
}
"""What the report says of a claim."""


@cache
def examined(name: str) -> CaseAudit:
    return audit(ROOT / "docs" / "examples" / f"{name}.toml", certify_seconds=0, seeds=2).cases[0]


@pytest.mark.parametrize("name", NOT_SUPPORTED)
def test_each_claim_has_the_verdict_that_the_recomputation_supports(name: str) -> None:
    one = examined(name)
    wanted = dict.fromkeys((claim.id for claim in one.case.claims), ClaimVerdict.SUPPORTED)
    for word, claims in NOT_SUPPORTED[name].items():
        wanted |= dict.fromkeys(claims.split(), ClaimVerdict(word))
    assert verdicts(one) == wanted
    assert one.errors == 0
    warned = {f.claim for f in one.findings if f.severity is not Severity.INFO}
    assert warned == set(NOT_SUPPORTED[name].get("inconsistent", "").split())


@pytest.mark.parametrize(("name", "claim"), SAID)
def test_what_is_said_of_a_profile(name: str, claim: str) -> None:
    (found,) = (f for f in examined(name).findings if f.claim == claim and f.rule == "TG304")
    assert SAID[name, claim] in found.message


def test_a_card_is_about_profiles_where_the_curve_only_stands_in() -> None:
    """No motion within the limits starts above them, and no claim is about one that does."""
    optimum = examined("ruckig-issue-128").document.card.optimum
    assert optimum == "1 of 2 printed times agree with their shortest s-curve profiles."
