"""What speaks for and against readings, on one joint that moves from rest to rest."""

from typing import Any

import numpy as np
import pytest
from support.findings import study_of
from support.made_up import Numbers, entry, paper, readings, row, sentence
from trajgap.compare.audits import Pair, PrintedRow
from trajgap.compare.audits.rules.clues import held_otherwise, reading_clues
from trajgap.compare.audits.study import Study
from trajgap.compare.documents import HeldOtherwise, ReadingClue, Speaks

FOR, AGAINST = Speaks.FOR, Speaks.AGAINST
UNITS = readings(
    rad={"default": True, "default_why": "The figure shows it."},
    deg={"units": {"position": "deg", "velocity": "deg/s"}},
)
MOVED = row("d", "1.00") + sentence("s", "optimal", "d")


def clue(kind: str, **keys: Any) -> str:
    return entry("clues", **{"id": "c", "where": "Figure 3", "text": "t", "kind": kind} | keys)


def axis(ticks: Numbers, **keys: Any) -> str:
    asked = {"quantity": "acceleration", "unit": "rad/s^2", "of": ["d"], "ticks": list(ticks)}
    return clue("axis", **asked | keys)


def sheet(*values: float) -> str:
    return clue("data-sheet", quantity="velocity", unit="deg/s", values=list(values))


def turns(**keys: str) -> str:
    return clue(**{"kind": "half-turns", "joint": "1"} | keys)


def clues(tail: str, points: str = "0.00 1.30", limit: Any = 3.1) -> dict[str, ReadingClue]:
    """The one clue of a case, by reading; 1.3 rad in 1 s, from rest to rest."""
    study = study_of(paper([points], MOVED, UNITS, tail, velocity=limit))
    return {one.reading: one for one in reading_clues(study)}


# A quintic from rest to rest over d in h accelerates to 10 d/(√3 h²): 7.506 for d = 1.3, h = 1.
@pytest.mark.parametrize(
    ("ticks", "rad", "deg"),
    [
        ((0, "5", "10"), FOR, AGAINST),
        (("-5", "5"), AGAINST, AGAINST),  # one label, no step beyond it
        ((0, "5"), FOR, AGAINST),  # the axis may go on to 10
        ((0, "100"), AGAINST, AGAINST),
        ((0, "0.1"), AGAINST, FOR),  # 0.131 rad/s² in degrees
    ],
)
def test_a_curve_fills_its_axis_or_does_not(ticks: Numbers, rad: Speaks, deg: Speaks) -> None:
    found = clues(axis(ticks))
    assert (found["rad"].speaks, found["deg"].speaks) == (rad, deg)
    assert "7.51 rad/s²" in found["rad"].computed
    assert "0.131 rad/s²" in found["deg"].computed


@pytest.mark.parametrize(
    ("limit", "rad", "deg"),
    [
        (120, AGAINST, FOR),
        (90, AGAINST, FOR),
        (130, AGAINST, AGAINST),
        (11, AGAINST, AGAINST),  # a tenth of it is 12
        ("2.1", FOR, AGAINST),  # 2.0944 rounds to it
    ],
)
def test_printed_limits_stand_beside_a_data_sheet(limit: Any, rad: Speaks, deg: Speaks) -> None:
    found = clues(sheet(120), limit=limit)
    assert (found["rad"].speaks, found["deg"].speaks) == (rad, deg)
    if limit == 120:
        assert found["deg"].computed == "velocity limits equal those of the data sheet"
        assert "57.3 times" in found["rad"].computed


@pytest.mark.parametrize(
    ("points", "rad"),
    [("0.000 3.142 -6.283", FOR), ("0.000 3.142 1.300", AGAINST), ("0.000 3.143 1.300", AGAINST)],
)
def test_angles_are_multiples_of_pi_within_their_rounding(points: str, rad: Speaks) -> None:
    found = clues(turns(), points=points)
    assert (found["rad"].speaks, found["deg"].speaks) == (rad, AGAINST)


B_SPLINE = {"family": "uniform-cubic-b-spline"}
STRETCHED, TIMED = B_SPLINE | {"time": "stretched"}, B_SPLINE | {"time": "timed"}


@pytest.fixture(scope="module")
def spline() -> Study:
    return study_of(
        paper(
            ["0.10 0.90 -0.40 0.30"],
            readings(stretched={}, timed={"interpolant": TIMED}),
            row("d", "0.80 1.10 0.90"),
            clue("smooth", quantity="velocity", of=["d"]),
            curve=STRETCHED,
            velocity=1.7,
            acceleration=9,
        )
    )


def held(study: Study, reading: str = "as-printed") -> HeldOtherwise:
    found = held_otherwise(PrintedRow(study, study.case.claim("d"), Pair("main", reading)))
    assert isinstance(found, HeldOtherwise)
    return found


def test_a_velocity_that_jumps_speaks_against_equal_slopes(spline: Study) -> None:
    stretched, timed = reading_clues(spline)
    assert (stretched.speaks, timed.speaks) == (AGAINST, FOR)
    assert stretched.computed.startswith("velocity jumps 2 times, by up to ")


def test_limits_held_at_samples_or_on_control_vertices(spline: Study) -> None:
    found = held(spline, "stretched")
    # A second route: V by solving (2) and (3), then differences over the durations.
    q, h = np.array([0.1, 0.9, -0.4, 0.3]), np.array([0.8, 1.1, 0.9])
    system = np.diag([5.0, 4, 4, 5]) + np.diag([1.0] * 3, 1) + np.diag([1.0] * 3, -1)
    v = np.linalg.solve(system / 6, q)
    v = np.array([v[0], *v, v[-1]])
    worst = 0.0
    for k in range(3):
        local = v[k : k + 4]
        worst = max(worst, abs(np.diff(local)).max() / h[k] / 1.7)
        worst = max(worst, abs(np.diff(local, 2)).max() / h[k] ** 2 / 9)
    assert found.vertices == pytest.approx(worst, rel=1e-12)
    assert found.sampled <= found.everywhere * (1 + 1e-12)
    assert found.everywhere <= worst * (1 + 1e-12)
    assert 0.97 * found.everywhere < found.sampled < found.everywhere
    assert "no control vertices" in str(held(spline, "timed").vertices)


@pytest.mark.parametrize(
    ("limits", "low"),
    [
        # scipy's clamped cubic through 0, 1.2 and 1.1 rad in 1 and 1.5 s rises to 1.40776 rad, and
        # to 1.40772 rad at ten steps a segment; its speed to 1.60627 and 1.60320 rad/s.
        ({"velocity": 3, "position_upper": 1.25, "position_lower": -0.05}, 1.0 + 0.15772 / 0.65),
        ({"velocity": 3, "position_upper": 1.4}, 1.0 + 0.00772 / 1.4),
        ({"velocity": 1.605, "position_upper": 1.5}, 1.60320 / 1.605),
    ],
)
def test_every_limit_is_held_at_the_samples(limits: dict[str, float], low: float) -> None:
    curve = {"family": "cubic-spline"}
    study = study_of(paper([[0, 1.2, 1.1]], row("d", "1.0 1.5"), curve=curve, **limits))
    assert held(study).sampled == pytest.approx(low, abs=1e-4)
