"""Printed numbers of others that agree with their own motions: nothing is said against them."""

from __future__ import annotations

import json

import pytest
from support.checkout import ROOT
from trajgap.compare import ClaimVerdict, audit
from trajgap.problem import Case, load_case

# Typed a second time from the tables, not copied from the case files.
METRICS = {
    "two-joint-arm-natural-cubic": "2.580258 4.225276 5.190798 6.663679",
    "two-joint-arm-c4-quintic": "2.958025 6.810174 10.985506 7.630562",
}
MEANS = {
    "velocity": "16.1 20.57 26.61 15.38 14.4 19.4",
    "acceleration": "17.15 18.15 28.23 5.53 12.03 20.76",
    "jerk": "29.24 26.45 46.85 5.48 16.48 35.9",
}
POINTS = [[0, 0], [30, -60], [30, -90], [30, -60], [75, -90], [110, -60], [110, -90], [50, 0]]


def example(name: str) -> Case:
    return load_case(ROOT / "docs" / "examples" / f"{name}.toml")


@pytest.mark.parametrize("name", METRICS)
def test_metrics_of_a_program_that_samples_its_motion_are_supported(name: str) -> None:
    case = example(name)
    rows = case.document.model_dump(mode="json")["waypoints"]["waypoint_rows"]
    assert rows == POINTS
    printed = [str(c.value) for c in case.claims if hasattr(c, "derivative")]
    assert printed == METRICS[name].split()
    one = audit(case, certify_seconds=0).cases[0]
    assert one.errors == 0
    assert {j.verdict for j in one.judgements} == {ClaimVerdict.SUPPORTED}


def test_means_without_durations_are_not_checkable() -> None:
    case = example("gasparetto-zanotto2008")
    for order, digits in MEANS.items():
        printed = json.dumps(digits.split())
        assert json.dumps([str(x) for x in case.claim(f"mean-{order}").values]) == printed
