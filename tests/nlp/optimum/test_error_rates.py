"""The published rates of the solver's errors: added up from blocks, limits by scipy."""

from __future__ import annotations

import sys
from collections import Counter
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest
from scipy.stats import binomtest
from support.benchmarks import loaded

PRINTED = """6324: improvable, optimal, C2 cubic spline, gain 0.000935
6950: wrong none found, none found, rest-to-rest polynomials of degree 5, gain 1
6955: answer does not pass, feasible, C2 cubic spline, gain nan
1000 problems, seeds 6000 to 6999
solve 441 s, brute force 710 s
| status | optimal | 900 | 90.0000% |
| status | none found | 55 | 5.5000% |
| status | not_attained | 38 | 3.8000% |
| status | feasible | 7 | 0.7000% |
| fault | improvable | 1 | 0.1000% |
| fault | wrong none found | 1 | 0.1000% |
| fault | answer does not pass | 1 | 0.1000% |
"""


@pytest.fixture
def rates() -> ModuleType:
    return loaded("error_rates")


def test_the_page_shows_the_rows(rates: ModuleType) -> None:
    rows = rates.read_rows(rates.CSV.read_text("utf-8"))
    assert rates.csv_text(rows) == rates.CSV.read_text("utf-8")
    assert rates.merged(rows, []) == rows
    for first in {row.first_seed for row in rows}:
        block = [row for row in rows if row.first_seed == first]
        assert sum(row.answers for row in block) == block[0].problems
    for row in rows:
        seeds = [int(seed) for seed in row.failing_seeds.split()]
        assert len(seeds) == row.improvable + row.not_passing + row.wrong
        assert all(row.first_seed <= seed < row.first_seed + row.problems for seed in seeds)
    page = rates.PAGE.read_text("utf-8")
    assert rates.page_with(page, rates.tables(rows)) == page


def test_what_was_printed_becomes_rows(rates: ModuleType) -> None:
    rows = {row.status: row for row in rates.rows_printed("abc", PRINTED)}
    assert list(rows) == ["optimal", "feasible", "none found", "not_attained"]
    assert {row.problems for row in rows.values()} == {1000}
    assert {(row.code, row.first_seed) for row in rows.values()} == {("abc", 6000)}

    def cells(word: str) -> tuple[Any, ...]:
        row = rows[word]
        return row.answers, row.improvable, row.not_passing, row.wrong, row.failing_seeds

    assert cells("optimal") == (900, 1, 0, 0, "6324")
    assert cells("feasible") == (7, 0, 1, 0, "6955")
    assert cells("none found") == (55, 0, 0, 1, "6950")
    assert cells("not_attained") == (38, 0, 0, 0, "")
    assert rates.read_rows(rates.csv_text(list(rows.values()))) == list(rows.values())


def test_a_run_without_an_end_and_one_that_hides_its_seeds(rates: ModuleType) -> None:
    assert rates.rows_printed("abc", PRINTED.split("1000 problems")[0]) == []
    hidden = "\n".join(PRINTED.splitlines()[1:])
    with pytest.raises(ValueError, match="seeds 6000 to 6999: counts do not add up"):
        rates.rows_printed("abc", hidden)


def test_blocks_add_up_and_are_replaced(rates: ModuleType) -> None:
    first = rates.rows_of("a", 0, Counter(optimal=98, failed=2), [(5, "wrong failed", "failed")])
    second = rates.rows_of("b", 100, Counter(optimal=50), [(120, "improvable", "optimal")])
    rows = rates.merged(second, first)
    assert [(row.code, row.status) for row in rows] == [
        ("a", "optimal"),
        ("a", "failed"),
        ("b", "optimal"),
    ]
    shown = rates.tables(rows)
    assert "| `a` | 100 | 0 to 99 |" in shown
    assert "| `b` | 50 | 100 to 149 |" in shown
    assert "| `optimal` | 148 | 1 | 0 | 0 | 0.676% |" in shown
    assert "| `failed` | 2 | 0 | 0 | 1 | 50.000% |" in shown
    assert "| all | 150 | 1 | 0 | 1 | 1.333% |" in shown
    assert "5 (`failed`), 120 (`optimal`)" in shown
    again = rates.rows_of("c", 100, Counter(optimal=50), [])
    replaced = rates.merged(rows, again)
    assert [row.code for row in replaced] == ["a", "a", "c"]
    assert "Seeds in error: 5 (`failed`)." in rates.tables(replaced)
    with pytest.raises(ValueError, match="from seed 0 and from seed 99 overlap"):
        rates.merged(rows[:2], rates.rows_of("c", 99, Counter(optimal=50), []))


@pytest.mark.parametrize(("errors", "tried"), [(0, 7), (0, 10000), (2, 3625), (9, 10), (7, 7)])
def test_limits_are_those_of_clopper_and_pearson(
    rates: ModuleType, errors: int, tried: int
) -> None:
    exact = binomtest(errors, tried, alternative="less").proportion_ci(0.95, method="exact")
    assert rates.upper_limit(errors, tried) == pytest.approx(exact.high, rel=1e-9)


def test_a_run_enters_its_counts(
    rates: ModuleType,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    errors = loaded("solver_errors")
    to = tmp_path / "rates.csv"
    monkeypatch.setattr(errors, "brute_force", lambda *_: errors.Brute(1e-9, None))
    given = ["solver_errors.py", "--count", "2", "--seed", "3", "--verbose", "--write", str(to)]
    monkeypatch.setattr(sys, "argv", given)
    assert errors.main() == 0
    rows = rates.read_rows(to.read_text("utf-8"))
    assert sum(row.answers for row in rows) == 2
    assert {(row.first_seed, row.problems) for row in rows} == {(3, 2)}
    assert sum(row.improvable for row in rows) == sum(
        row.answers for row in rows if row.status in ("optimal", "feasible", "not_attained")
    )
    # What the run printed says the same.
    assert rates.rows_printed(rows[0].code, capsys.readouterr().out) == rows


def test_outputs_are_added_from_the_command_line(
    rates: ModuleType,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    (tmp_path / "one").write_text(PRINTED)
    (tmp_path / "two").write_text("7844: wrong failed, failed, a curve, gain 1\n")
    page = tmp_path / "page.md"
    page.write_text(f"Before\n{rates.BEGIN}\nold\n{rates.END}\nAfter\n")
    monkeypatch.setattr(rates, "CSV", tmp_path / "rates.csv")
    monkeypatch.setattr(rates, "PAGE", page)
    command = ["x", str(rates.CSV), "--code", "abc", "--add"]
    monkeypatch.setattr(sys, "argv", [*command, str(tmp_path / "one"), str(tmp_path / "two")])
    assert rates.main() == 1
    assert "two: not finished, left out" in capsys.readouterr().err
    assert {row.code for row in rates.read_rows(rates.CSV.read_text("utf-8"))} == {"abc"}
    text = page.read_text()
    assert text.startswith(f"Before\n{rates.BEGIN}\n| version")
    assert text.endswith(f"{rates.END}\nAfter\n")
    assert "old" not in text
    assert "| `abc` | 1,000 | 6000 to 6999 |" in text
