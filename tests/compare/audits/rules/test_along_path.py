"""Totals along fixed paths: closed forms, and paths that their points leave open."""

from typing import Any

import numpy as np
import pytest
from support.findings import audited_text, finding, verdicts
from support.made_up import claim, paper, sentence, slow, total
from trajgap.compare.audits.stated import timed_along_path
from trajgap.compare.documents import ALONG_PATH, Basis, ClaimVerdict, Finding, Why
from trajgap.nlp.retiming import retime
from trajgap.problem import CaseError, Limits, fit, parse_case, quintic_spline

NATURAL = {"family": "cubic-spline", "end_orders": [2]}
MOVING = {"family": "cubic-spline", "end_orders": [1], "end_derivatives": [0.2]}
STOPPING = {"family": "rest-to-rest", "degree": 5}
LINE = [[0, 1, 2, 3], [0, 0.5, 1, 1.5]]
"""A straight line: 3 rad of the first joint in 3 s / 2 + 2 s / 4 within 2 rad/s and 4 rad/s^2."""
LIMITS = {"velocity": [2, 9], "acceleration": [4, 9]}


def along(rows: Any, value: str, *parts: str, path: str = "curve", **given: Any) -> str:
    limits = given.pop("limits", LIMITS)
    keys = {"curve": NATURAL, "bounds": {"ratios": "equal"}} | given
    printed = total("t", value, path=path, other_curve="re-timed")
    return paper(rows, printed, *parts, **keys, **limits)


def ends_of(found: Finding) -> list[float]:
    return [float(one) for one in str(found.computed).removesuffix(" s").split(" to ")]


OPTIMAL = sentence("s", "optimal", "t")


@pytest.mark.parametrize(
    ("value", "verdict", "optimal", "kind"),
    [
        ("2.0", "supported", "supported", "fits"),
        ("1.98", "not checkable", "not checkable", "shorter"),
        ("1.97", "inconsistent", "inconsistent", "shorter"),
        ("1.85", "inconsistent", "inconsistent", "shorter"),
        ("2.3", "not checkable", "inconsistent", "longer"),
    ],
)
def test_a_straight_line(value: str, verdict: str, optimal: str, kind: str) -> None:
    for claim_id, wanted in (("t", verdict), ("s", optimal)):
        found = finding(along(LINE, value, OPTIMAL), claim_id, "TG305")
        assert (found.verdict, found.kind, found.basis) == (wanted, kind, Basis.ENCLOSURE)


def test_digits_of_limits_open_both_bounds() -> None:
    digits = {"velocity": ["2", "9"], "acceleration": ["4", "9"]}
    # 3 rad take 1.6 s within the loosest, 3 rad/s and 5 rad/s^2 cut off, and 2.4286 s within the
    # tightest, 1.5 rad/s and 3.5 rad/s^2.
    for value, verdict in (
        ("1.61", ClaimVerdict.SUPPORTED),
        ("2.42", ClaimVerdict.SUPPORTED),
        ("1.58", ClaimVerdict.INCONSISTENT),
        ("2.44", ClaimVerdict.NOT_CHECKABLE),
        ("2.46", ClaimVerdict.INCONSISTENT),
    ):
        found = finding(along(LINE, value, OPTIMAL, limits=digits), "s", "TG305")
        assert found.verdict is verdict, found.sentences
    low, high = ends_of(found)
    assert (low, high) == pytest.approx((1.6, 3 / 1.5 + 1.5 / 3.5), rel=2e-3)
    assert low <= 1.6 < 3 / 1.5 + 1.5 / 3.5 < high


def wave(points: int, digits: int | None = None) -> list[list[Any]]:
    x = np.linspace(0.0, 2.0, points)
    rows = [x, np.sin(2.1 * x)]
    return [[float(v) if digits is None else f"{v:.{digits}f}" for v in row] for row in rows]


EXACT = {"velocity": [1, 1.5], "acceleration": [2, 3]}


def test_digits_of_points_bend_the_path() -> None:
    plain = finding(along(wave(12), "9", limits=EXACT), "t", "TG305")
    assert plain.kind == "longer"
    assert finding(along(wave(12, 5), "9", limits=EXACT), "t", "TG305").kind == "longer"
    lower, upper = ends_of(plain)
    assert upper < 1.001 * lower
    # With two decimals the curvature is open, and a little more is no longer longer.
    much = f"{1.02 * upper:.4f}"
    assert finding(along(wave(12, 2), much, OPTIMAL, limits=EXACT), "s", "TG305").kind == "wide"
    assert finding(along(wave(12), much, OPTIMAL, limits=EXACT), "s", "TG305").kind == "longer"


def test_sampled_points_leave_open_what_two_splines_differ() -> None:
    def ends(points: int, path: str) -> list[float]:
        return ends_of(finding(along(wave(points), "9", path=path, limits=EXACT), "t", "TG305"))

    sampled = finding(along(wave(30), "9", path="sampled", limits=EXACT), "t", "TG305")
    assert sampled.basis is Basis.COMPUTED
    assert "as a spline of another degree does" in sampled.sentences[1]
    truth, coarse, fine = ends(161, "curve"), ends(41, "sampled"), ends(81, "sampled")
    for low, high in (coarse, fine):
        assert low < truth[0] < truth[1] < high
    assert fine[1] - fine[0] < coarse[1] - coarse[0]


def honest(seed: int) -> str:
    """A paper that rounds TOPPRA's time along its path, and calls it optimal."""
    rng = np.random.default_rng(seed)
    joints, points = int(rng.integers(2, 4)), 400
    sizes, bends, shifts = (rng.uniform(*ends, (3, joints)) for ends in ((-1, 1), (1, 5), (0, 6)))

    def path(count: int) -> np.ndarray:
        u = np.linspace(0.0, 1.0, count)[:, None]
        return sum(sizes[k] / (k + 1) * np.sin(bends[k] * u + shifts[k]) for k in range(3))

    caps = rng.uniform(0.3, 3.0, joints), rng.uniform(0.5, 8.0, joints)
    dense = fit(quintic_spline(points, ((3, 0.0), (4, 0.0))), path(points + 1), np.ones(points))
    found = retime(dense, Limits(*caps), end_speeds=(0.0, 0.0), gridpoints=(12, 25, 50))
    assert found.applicable
    places, own, few = rng.integers(4, 9), rng.integers(2, 5), rng.integers(2, 4)
    rows = [[f"{v:.{places}f}" for v in row] for row in path(int(rng.integers(30, 90))).T]
    digits = [[f"{v:.{few}f}" for v in row] for row in caps]
    spline = {"family": "quintic-spline", "end_orders": [3, 4]} if seed % 2 else NATURAL
    limits = dict(zip(("velocity", "acceleration"), digits, strict=True))
    total = f"{found.extrapolated:.{own}f}"
    return along(rows, total, OPTIMAL, path="sampled", curve=spline, limits=limits)


@pytest.mark.parametrize("seed", [3, *slow(range(20, 30))])
def test_an_honest_total_along_a_sampled_path_is_not_accused(seed: int) -> None:
    assert finding(honest(seed), "s", "TG305").verdict is not ClaimVerdict.INCONSISTENT


@pytest.mark.parametrize(
    ("text", "why"),
    [
        (along(wave(12), "9", path="sampled", limits=EXACT), "fewer than 20 points sample"),
        (along(LINE, "9", bounds={"ratios": ["1.0", "1.0", "1.1"]}), "do not settle the path"),
        (along(LINE, "9", curve=MOVING), "do not settle the path"),
        (along(wave(12), "9", curve=STOPPING, limits=EXACT), "all joints stand still"),
        (along(LINE, "9", limits={"velocity": [2, 9]}), "no acceleration is limited"),
    ],
)
def test_what_is_not_computed_accuses_nobody(text: str, why: str) -> None:
    found = finding(text, "t", "TG305")
    assert found.verdict is ClaimVerdict.NOT_CHECKABLE
    assert why in found.sentences[0]


def test_limited_jerk_leaves_what_no_motion_undercuts() -> None:
    jerky = LIMITS | {"jerk": [50, 50]}
    assert finding(along(LINE, "1.85", limits=jerky), "t", "TG305").kind == "shorter"
    found = finding(along(LINE, "2.3", OPTIMAL, limits=jerky), "s", "TG305")
    assert (found.kind, found.verdict) == ("wide", ClaimVerdict.NOT_CHECKABLE)


def test_the_curve_of_a_path_has_no_optimum_of_its_own() -> None:
    one = audited_text(along(LINE, "2.0"))
    assert verdicts(one) == {"t": ClaimVerdict.SUPPORTED}
    (found,) = one.document.waterfalls
    assert [step.name for step in found.steps] == ["published", ALONG_PATH]
    low, high = found.steps[1].ends
    assert low <= 2.0 <= high
    (pair,) = one.study.pairs
    assert not one.study.optimum(pair).found
    assert "its own timing is not asked for" in str(one.study.optimum(pair).why)


def test_a_time_of_the_curve_itself_keeps_its_optimum() -> None:
    for part, alone in ((OPTIMAL, True), (total("own", "3.0"), False)):
        case = parse_case(along(LINE, "2.0", part), "made-up.toml")
        assert timed_along_path(case, case.problems[0].id) is alone


def test_a_path_that_is_not_computed_is_said_in_its_step() -> None:
    one = audited_text(along(LINE, "9", limits={"velocity": [2, 9]}))
    (found,) = one.document.waterfalls
    assert isinstance(found.steps[-1].time, Why)


PHASES = claim("p", "phases", phases=["1", "0", "1"], path="curve", other_curve="o")


@pytest.mark.parametrize(
    ("part", "ratios", "message"),
    [
        (total("t", "2", path="curve"), "equal", '"curve" requires other_curve, and excludes prof'),
        (
            total("t", "2", path="sampled", other_curve="o"),
            None,
            'path: "sampled" needs durations.ratios, at which the curve has one path; add it',
        ),
        (PHASES, "equal", "profile: is missing"),
    ],
)
def test_a_path_goes_with_fixed_ratios_and_another_curve(
    part: str, ratios: str | None, message: str
) -> None:
    bounds = {"ratios": ratios} if ratios else None
    with pytest.raises(CaseError, match=message):
        parse_case(paper(LINE, part, curve=NATURAL, bounds=bounds, **LIMITS), "made-up.toml")
