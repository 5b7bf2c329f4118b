"""TG203 where one number speaks of all joints: some papers print the norm over the joints."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from support.findings import finding, study_of
from support.made_up import Numbers, paper, peak, row
from trajgap.compare.audits.rules.norms import _top, largest_norm
from trajgap.compare.documents import ClaimVerdict, Confidence
from trajgap.problem import fit, rest_to_rest

QUINTIC = {"family": "quintic-spline"}
NATURAL = {"family": "cubic-spline", "end_orders": [2]}
ONES = [1] * 7


def arm(curve: dict[str, Any], top: str, times: Numbers = ONES) -> str:
    """Way-points and metrics of github.com/pvc192000/robot-trajectory-interpolation."""
    units = {"velocity": "rad/s", "acceleration": "rad/s^2"}
    rows = [[0, 30, 30, 30, 75, 110, 110, 50], [0, -60, -90, -60, -90, -60, -90, 0]]
    return paper(rows, row("d", times), top, curve=curve, angle="deg", units=units)


def speed(value: str, **keys: str) -> str:
    return peak("p", "d", "velocity", value, **keys)


@pytest.mark.parametrize(
    ("curve", "printed", "verdict"),
    [
        (QUINTIC, speed("2.958025"), "supported"),
        (QUINTIC, peak("p", "d", "acceleration", "6.810174"), "supported"),
        (NATURAL, speed("2.580258"), "supported"),
        # What is no norm is still a finding.
        (QUINTIC, speed("2.99"), "inconsistent"),
        (QUINTIC, speed("2.70"), "inconsistent"),
        (QUINTIC, speed("2.958025", joint="1"), "inconsistent"),
    ],
)
def test_a_printed_norm_accuses_nobody(curve: dict[str, Any], printed: str, verdict: str) -> None:
    """The repository prints norms over the joints; the largest joint alone has 6 to 20 % less."""
    found = finding(arm(curve, printed), "p", "TG203")
    assert found.verdict == verdict
    assert ("the largest norm over the joints" in found.message) or verdict == "inconsistent"


def test_the_room_that_coarse_digits_leave_is_said() -> None:
    """A duration printed as 1 may be 0.5 to 1.5 s: nearly any peak fits."""
    coarse = finding(arm(QUINTIC, speed("2.958025"), "1 " * 7), "p", "TG203")
    assert "digits, which leaves 50 % either way." in coarse.message
    sharp = finding(arm(QUINTIC, speed("2.4664")), "p", "TG203")
    assert sharp.message.endswith("digits.")


def test_the_norm_moves_with_the_durations_as_first_order_says() -> None:
    study = study_of(arm(QUINTIC, speed("2.9"), "1.000 " * 7))
    claim = study.case.claim("d")
    found = largest_norm(study, claim, "main", "as-printed", 1)
    problem = study.problem("main", "as-printed")

    def top(durations: np.ndarray) -> float:
        times = np.linspace(0.0, durations.sum(), 200_001)
        trajectory = fit(problem.curve, problem.waypoints, durations)
        return float(np.linalg.norm(trajectory(times, 1), axis=1).max())

    exact = top(np.ones(7))
    assert found.largest == pytest.approx(exact, rel=1e-8)
    moved = [top(np.ones(7) + 0.0005 * np.eye(7)[k]) - exact for k in range(7)]
    assert found.reach == pytest.approx(np.abs(moved).sum(), rel=0.01)


def test_the_largest_norm_is_that_of_a_dense_grid_and_never_below_it() -> None:
    waypoints = np.array([[0.0, 0.0], [1.0, -0.3], [0.2, 0.9]])
    trajectory = fit(rest_to_rest(2, 5), waypoints, np.array([0.8, 1.1]))
    for order in (1, 2, 3):
        top = max(_top(trajectory, k, order)[0] for k in range(2))
        times = np.linspace(0.0, 1.9, 200_001)
        dense = np.linalg.norm(trajectory(times, order), axis=1).max()
        assert dense <= top * (1 + 1e-12)
        assert top == pytest.approx(dense, rel=1e-4 if order == 3 else 1e-8)


def test_a_sampled_norm_is_not_called_equal() -> None:
    """Metrics of the natural cubic are sampled: 4.2253 beside a largest norm of 4.2398."""
    text = arm(NATURAL, peak("p", "d", "acceleration", "4.225276"))
    found = finding(text, "p", "TG203")
    assert found.verdict is ClaimVerdict.SUPPORTED
    assert "slightly below the largest norm over the joints, 4.23976" in found.message
    assert found.confidence is Confidence.COMPUTED


@pytest.mark.parametrize(
    ("value", "verdict", "said", "known"),
    [
        ("3.36", "inconsistent", "a factor √5 may have been lost in print", Confidence.COMPUTED),
        ("7.5312", "inconsistent", "off by more than", Confidence.COMPUTED),
        ("7.51", "supported", "", Confidence.PROVEN),
    ],
)
def test_what_a_slip_explains_is_named(
    value: str, verdict: str, said: str, known: Confidence
) -> None:
    """Degree 7 has its largest acceleration 84√5/25 of the way by the squared time, 7.5132."""
    parts = row("d", "1.00000"), peak("p", "d", "acceleration", value)
    text = paper([[0, 1]], *parts, curve={"family": "rest-to-rest", "degree": 7}, velocity=9)
    found = finding(text, "p", "TG203")
    assert (found.verdict, found.confidence) == (verdict, known)
    assert said in found.message
