"""TG103 beside an enumeration of all that prints alike, for totals of one and two decimals."""

from __future__ import annotations

from fractions import Fraction
from itertools import product

import pytest
from support.findings import said_of, study_of
from support.one_joint import one_joint
from trajgap.compare.audits.rules.improvements import judge_improvements
from trajgap.compare.documents import ClaimVerdict, Finding, Severity

TAIL = """
[[claims]]
id = "slow"
quantity = "total_time"
where = "abstract"
value = "{slow}"
[[claims]]
id = "fast"
quantity = "total_time"
where = "abstract"
value = "{fast}"
[[claims]]
id = "gain"
quantity = "improvement"
where = "abstract"
slower = "slow"
faster = "fast"
{stated}
"""


def alike(text: str) -> list[Fraction]:
    """The ends and the middle of what rounds to the digits; ties round either way."""
    half = Fraction(1, 2 * 10 ** len(text.partition(".")[2]))
    return [Fraction(text) - half, Fraction(text), Fraction(text) + half]


SHARES = {"slower": lambda a, b: 100 * (a - b) / a, "faster": lambda a, b: 100 * (a - b) / b}
PAIRS = [("1.2", "0.8"), ("3.1", "2.9"), ("0.9", "0.8"), ("2.25", "2.10"), ("1.05", "0.95")]


def judged(slow: str, fast: str, stated: str) -> tuple[ClaimVerdict, Severity]:
    found = finding(slow, fast, stated)
    return found.verdict, found.severity


def finding(slow: str, fast: str, stated: str) -> Finding:
    tail = TAIL.format(slow=slow, fast=fast, stated=stated)
    study = study_of(one_joint("0, 1", "9", "0.99", "optimal", tail))
    (found,) = said_of(study, judge_improvements, "gain", "TG103")
    return found


def fits(printed: str, true: list[Fraction]) -> bool:
    """Whether some value between the enumerated ones rounds to the digits: a difference and a
    share are monotone in each total, so that the enumerated ends are the ends."""
    least, _, most = alike(printed)
    return min(true) <= most and least <= max(true)


def near(true: list[Fraction], places: int) -> list[str]:
    """Numbers to print: inside, at both ends, and the first beyond each end."""
    unit = Fraction(1, 10**places)
    low, high = int(min(true) // unit) - 1, int(max(true) // unit) + 2
    chosen = {low, low + 1, low + 2, (low + high) // 2, high - 1, high, high + 1}
    return [f"{float(k * unit):.{places}f}" for k in sorted(chosen) if k >= 0]


@pytest.mark.parametrize(("slow", "fast"), PAIRS)
@pytest.mark.parametrize("places", [0, 1])
@pytest.mark.parametrize("base", SHARES)
def test_a_percentage_is_supported_where_some_rounding_gives_it(
    slow: str, fast: str, places: int, base: str
) -> None:
    true = [SHARES[base](a, b) for a, b in product(alike(slow), alike(fast))]
    seen = set()
    for printed in near(true, places):
        verdict, severity = judged(slow, fast, f'percent = "{printed}"\nbase = "{base}"')
        assert (severity is Severity.INFO) == fits(printed, true), printed
        if fits(printed, true):
            assert verdict is ClaimVerdict.SUPPORTED
        seen.add(severity)
    assert len(seen) > 1


@pytest.mark.parametrize(("slow", "fast"), PAIRS)
@pytest.mark.parametrize("places", [0, 1, 2])
def test_a_difference_is_supported_where_some_rounding_gives_it(
    slow: str, fast: str, places: int
) -> None:
    true = [a - b for a, b in product(alike(slow), alike(fast))]
    for printed in near(true, places):
        verdict, severity = judged(slow, fast, f'seconds = "{printed}"')
        assert (severity is Severity.INFO) == fits(printed, true), printed
        if fits(printed, true):
            assert verdict is ClaimVerdict.SUPPORTED


@pytest.mark.parametrize(
    ("base", "percent", "other"),
    [("slower", "50.0", "the shorter total"), ("faster", "33.3", "the longer total")],
)
def test_a_percentage_of_the_other_total_is_said_to_fit_that_one(
    base: str, percent: str, other: str
) -> None:
    """3 s against 2 s: a third of 3 s, half of 2 s."""
    found = finding("3.000", "2.000", f'percent = "{percent}"\nbase = "{base}"')
    assert found.verdict is ClaimVerdict.REFUTED
    assert found.message.endswith(f"As a share of {other} it would be {percent} %.")
    far = finding("3.000", "2.000", f'percent = "41.0"\nbase = "{base}"')
    assert "As a share of" not in far.message


def test_intervals_that_touch_meet() -> None:
    """1.2 − 0.8 is at most 0.5, the least that rounds to 1."""
    assert judged("1.2", "0.8", 'seconds = "1"') == (ClaimVerdict.SUPPORTED, Severity.INFO)
    true = [a - b for a, b in product(alike("1.2"), alike("0.8"))]
    assert max(true) == min(alike("1")) == Fraction(1, 2)
