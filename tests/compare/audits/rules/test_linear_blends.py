"""TG210 on a row of linear segments with parabolic blends, beside limits and digits."""

from typing import Any

import numpy as np
import pytest
from hypothesis import given, strategies as st
from numpy.typing import NDArray
from support.findings import audited_text, finding, said_of, study_of, verdicts
from support.made_up import Numbers, claim, paper, row, sentence, total
from trajgap.compare.audits.rounding import RoundingBox
from trajgap.compare.audits.rules.linear_blends import Between, Blended, EndBlends, blended_motion
from trajgap.compare.documents import ClaimVerdict, Finding
from trajgap.problem import parse_case

SUPPORTED, REFUTED, OPEN = "supported", "refuted", "not checkable"
CURVE = {"other_curve": "linear segments with parabolic blends"}
WAY = "10.00 35.00 25.00 10.00"
"""Craig's way-points, in degrees."""
BEYOND, WITHIN = {"end_blends": "beyond"}, {"end_blends": "within"}


def made_up(
    *more: str,
    times: Numbers = "2.00 1.00 3.00",
    limit: Any = 50,
    ways: tuple[Numbers, ...] = (WAY,),
    of: tuple[str, ...] = ("row",),
    **keys: Any,
) -> str:
    """A row of blends within a limit of acceleration, and a sentence on it."""
    kept = claim("kept", "statement", checks="within_limits", of=list(of))
    limits = {"velocity": 100, "acceleration": limit}
    return paper(ways, row("row", times, **CURVE | keys), kept, *more, angle="deg", **limits)


def judged(*more: str, **keys: Any) -> Finding:
    return finding(made_up(*more, **keys), "row", "TG210")


@pytest.mark.parametrize(
    ("keys", "limit", "verdict", "said"),
    [
        ({"blends": "0.50"}, 50, SUPPORTED, "keep the limits"),
        ({"blends": "0.40"}, 50, REFUTED, "56.25 °/s²"),
        ({"blends": "0.40"}, 57, OPEN, "where the end blends lie"),
        ({"blends": "0.40"} | BEYOND, 58, SUPPORTED, "keep the limits"),
        ({"blends": "0.40"} | WITHIN, 57, REFUTED, "59.72"),
        ({"blends": "0.40"} | BEYOND, 56, OPEN, "digits"),
        ({"blends": "1.40"}, 50, REFUTED, "more time than segment 2 has"),
        ({"blend_acceleration": 50}, 50, SUPPORTED, "keep the limits"),
        ({"blend_acceleration": [60]}, 50, REFUTED, "60 °/s²"),
        ({"blend_acceleration": 12}, 50, REFUTED, "more time than segment"),
        # 1 s and 0.4 s may be 1.05 s and 0.45 s, with which the change takes 49.7 °/s².
        ({"blends": "0.4", "times": "2 1.0 3"}, 50, OPEN, ""),
        # Another number of durations builds no motion.
        ({"blends": 0.4, "times": "2.0 1.0"}, 50, OPEN, "3 straight segments"),
        # A blend of nothing is no acceleration of a joint that rests.
        ({"blends": 0.0}, 50, OPEN, "for a blend printed as 0"),
        ({"blends": 0.0, "ways": ([10, 10, 10, 10],)}, 50, SUPPORTED, ""),
        # 0.40 s may be 0.41 s: 22.5 °/s within it take 56.25 or 54.9 °/s².
        ({"blends": "0.40", "times": [2, 1, 3], "ways": ([10, 35, 25, "10.00"],)} | BEYOND, 56,
         OPEN, ""),
        ({"blends": 0.40, "times": [2, 1, 3], "ways": ([10, 35, 25, "10.00"],)} | BEYOND, 56,
         REFUTED, ""),
        # A joint that does not change its speed needs no acceleration.
        ({"blend_acceleration": 60, "ways": (WAY, [5, 5, 5, 5])}, [60, 50], SUPPORTED, ""),
        ({"blend_acceleration": 60, "ways": (WAY, [5, 5, 6, 6])}, [60, 50], REFUTED, ""),
    ],
)  # fmt: skip
def test_a_row_is_judged_under_both_conventions(
    keys: dict[str, Any], limit: Any, verdict: str, said: str
) -> None:
    found = judged(limit=limit, **keys)
    assert found.verdict == verdict
    assert said in found.message
    built = "straight segments" not in found.message
    assert ("not compared with the optimum" in found.message) == built


def test_a_row_of_which_nothing_is_said_is_refuted_by_no_limit() -> None:
    one = audited_text(made_up(blends="0.40", of=()))
    (found,) = [f for f in one.findings if f.rule == "TG210"]
    assert found.verdict == OPEN
    assert "The text does not claim" in found.message
    assert one.card.limits.endswith(", but the text does not claim that they keep it.")
    assert one.errors == 0


def test_a_total_may_count_half_the_end_blends() -> None:
    for value, fits in (("6.00", True), ("6.40", True), ("6.80", False)):
        text = made_up(blends="0.40", total=value)
        assert (finding(text, "row", "TG101").verdict == SUPPORTED) == fits
    open_ = study_of(made_up(blend_acceleration=50, total="6.40"))
    assert not said_of(open_, "row", "TG101")


@pytest.mark.parametrize("value", ["6.00", "6.40"])
def test_a_total_elsewhere_may_count_half_the_end_blends_too(value: str) -> None:
    """The row prints 6.00 s; the abstract the time that the arm moves, 6.40 s."""
    for keys in ({"blends": "0.40"}, {"blend_acceleration": 50}):
        text = made_up(total("abstract", value, of="row", **CURVE), total="6.00", **keys)
        found = said_of(study_of(text), "abstract", "TG105")
        assert all(one.verdict is not ClaimVerdict.INCONSISTENT for one in found)
    wrong = made_up(total("abstract", "6.90", of="row", **CURVE), total="6.00", blends="0.40")
    assert finding(wrong, "abstract", "TG105").verdict is ClaimVerdict.INCONSISTENT


def test_a_maximum_may_be_of_blended_rows() -> None:
    times = {"of": ["row"], "durations": ["2.00", "1.00", "3.00"]}
    parse_case(made_up(claim("longest", "maximum", **times, **CURVE), blends=0.4), "made-up.toml")


def test_the_card_speaks_of_the_row_and_of_nothing_else() -> None:
    """No explanation by the case's own curve, and no word that the limits are undecided."""
    one = audited_text(made_up(blends="0.40"))
    card = one.card
    assert card.limits.startswith("The printed durations break a limit")
    assert card.optimum.endswith("so no optimum applies.")
    assert not card.errors
    assert "perhaps for" not in str(card.explanation)
    # One cause, and the sentence that the limits are kept as its consequence.
    (cause,) = one.causes
    assert cause.claim == "row"
    assert [each.claim for each in cause.consequences] == ["kept"]
    kept = audited_text(made_up(blends="0.50")).card
    assert kept.limits == "The printed durations keep the limits."
    said = audited_text(made_up()).card.limits
    assert said.endswith("belong to another curve (linear segments with parabolic blends).")


@pytest.mark.parametrize(
    ("keys", "limit", "verdict"),
    [
        ({"blends": "0.40"}, 50, REFUTED),
        ({"blends": "0.40"}, 57, OPEN),
        ({"blends": "0.50"}, 50, SUPPORTED),
        ({}, 50, OPEN),
    ],
)
def test_a_sentence_on_several_rows_speaks_of_this_one_too(
    keys: dict[str, Any], limit: float, verdict: str
) -> None:
    """The own row is slow enough; what is said of all rows hangs on the blended one."""
    checks = {"all": "within_limits", "rest": "at_rest", "smooth": "continuous"}
    said = (sentence(name, check, "own", "row") for name, check in checks.items())
    text = made_up(row("own", "9.00 9.00 9.00"), *said, limit=limit, **keys)
    found = verdicts(audited_text(text))
    assert found["all"] == verdict
    assert found["rest"] == found["smooth"] == OPEN


Array = NDArray[np.float64]


def exact(*numbers: float) -> RoundingBox:
    return RoundingBox.exact(np.array(numbers, dtype=np.float64))


def column(*angles: float) -> RoundingBox:
    return RoundingBox.exact(np.array(angles, dtype=np.float64)[:, None])


def test_the_example_of_craig() -> None:
    """Introduction to Robotics, example 7.3: 10, 35, 25, 10° in 2, 1, 3 s with 50 °/s².

    The book rounds the first blend to 0.27 s and the speed to 13.50; its straight parts take
    1.50 and 2.849 s.
    """
    way, times = column(10, 35, 25, 10), exact(2, 1, 3)
    found = blended_motion(way, times, EndBlends.WITHIN, accelerations=exact(50))
    speeds = found.velocity.low[:, 0]
    assert speeds == pytest.approx([13.40, -10.0, -5.09], abs=0.005)
    assert speeds[0] / 50 == pytest.approx(0.27, abs=0.005)
    assert (speeds[0] - speeds[1]) / 50 == pytest.approx(0.47, abs=0.005)
    assert found.room.low[[0, 2], 0] == pytest.approx([1.50, 2.849], abs=0.005)


def moved(points: Array, durations: Array, blends: Array, ends: EndBlends) -> Array:
    """Where the motion ends that speeds up and down as its description says, from the start."""
    found = blended_motion(column(*points), exact(*durations), ends, times=exact(*blends))
    speeds = np.concatenate([[0.0], found.velocity.low[:, 0], [0.0]])
    at = points[0]
    for k, tau in enumerate(blends):
        at += 0.5 * (speeds[k] + speeds[k + 1]) * tau
        if k < len(durations):
            at += speeds[k + 1] * found.room.low[k, 0]
    assert found.acceleration.low[:, 0] * blends == pytest.approx(np.abs(np.diff(speeds)))
    return np.array([at])


@given(st.lists(st.floats(-3, 3), min_size=2, max_size=5), st.data(), st.sampled_from(EndBlends))
def test_such_a_motion_ends_at_the_last_way_point(
    points: list[float], data: st.DataObject, ends: EndBlends
) -> None:
    n = len(points) - 1
    h = np.array(data.draw(st.lists(st.floats(1.0, 3.0), min_size=n, max_size=n)))
    tau = np.array(data.draw(st.lists(st.floats(0.05, 0.45), min_size=n + 1, max_size=n + 1)))
    assert moved(np.array(points), h, tau, ends) == pytest.approx([points[-1]], abs=1e-12)


@given(st.data(), st.sampled_from(EndBlends))
def test_bounds_hold_for_everything_in_the_boxes(data: st.DataObject, ends: EndBlends) -> None:
    n = data.draw(st.integers(1, 3))
    value = st.floats(-2, 2)
    q = np.array(data.draw(st.lists(value, min_size=n + 1, max_size=n + 1)))[:, None]
    h = np.array(data.draw(st.lists(st.floats(0.3, 3.0), min_size=n, max_size=n)))
    a = np.array(data.draw(st.lists(st.floats(0.5, 30.0), min_size=1, max_size=1)))
    seed = np.random.default_rng(data.draw(st.integers(0, 2**32)))

    def box(x: Array) -> RoundingBox:
        return RoundingBox(x, x - 0.01, x + 0.01)

    wide = blended_motion(box(q), box(h), ends, accelerations=box(a))
    timed = blended_motion(box(q), box(h), ends, times=box(np.full(n + 1, 0.1)))
    for _ in range(20):
        inner = [RoundingBox.exact(x + seed.uniform(-0.01, 0.01, x.shape)) for x in (q, h, a)]
        tau = RoundingBox.exact(0.1 + seed.uniform(-0.01, 0.01, n + 1))
        held(blended_motion(*inner[:2], ends, accelerations=inner[2]), wide)
        held(blended_motion(*inner[:2], ends, times=tau), timed)


def held(one: Blended, wide: Blended) -> None:
    for name in ("velocity", "acceleration", "room"):
        inner: Between = getattr(one, name)
        outer: Between = getattr(wide, name)
        known = inner.low == inner.high  # no bounds are known where a blend leaves no time
        slack = 1e-9 * (1.0 + np.abs(inner.low))
        assert (~known | (outer.low <= inner.low + slack)).all()
        assert (~known | (outer.high >= inner.high - slack)).all()


def test_too_long_a_way_has_no_speed_that_is_high_enough() -> None:
    short = blended_motion(column(0, 1), exact(1.9), EndBlends.WITHIN, accelerations=exact(1.0))
    assert short.room.high[0, 0] < 0
    just = blended_motion(column(0, 1), exact(2.0), EndBlends.WITHIN, accelerations=exact(1.0))
    assert just.velocity.low[0, 0] == pytest.approx(1.0)
    assert just.room.low[0, 0] == pytest.approx(0.0, abs=1e-12)
    still = blended_motion(column(0, 0), exact(2.0), EndBlends.WITHIN, accelerations=exact(0.0))
    assert (still.velocity.low[0, 0], still.velocity.high[0, 0]) == (0.0, 0.0)
