"""What runs say of optimisers, and what the suite says of its instances."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence

import numpy as np

from ...problem import shown_bound
from ...problem.suite import BenchmarkInstance
from ..documents import (
    BENCH_COLUMNS,
    SHOWN_GAPS,
    BenchResult,
    OverallStanding,
    Reference,
    bench_cells,
    gap_cell,
    percent,
    value_or_none,
)
from ..gaps import Board, Ranked
from .tree import Block, Cell, Grid, Prose, Terms, badge, code, table

ONE_BY_ONE = 6
"""Problems up to which each has its own tables; of more there is one table, and files have all."""


def overall_blocks(standings: Sequence[OverallStanding]) -> tuple[Block, ...]:
    """Which optimiser comes within 1 % most often, and a row for each."""
    rows, within = [], []
    for one in standings:
        shown = [t for t in one.targets if t.gap in SHOWN_GAPS]
        gaps = gap_cell(one.median), gap_cell(one.worst)
        shares = [f"{100 * target.rate:.0f} %" for target in shown]
        solved = [f"{target.solved} of {one.problems}" for target in shown]
        rows.append((one.optimizer, *gaps, one.first, *shares, *solved))
        within.append((one.optimizer, shares[0]))
    (first, share), *others = within
    said = (
        f"Within 1 % of the optimum most often: {first}, in {share} of its runs over "
        f"{standings[0].problems} problems"
    )
    said += "; next {} with {}".format(*others[0]) if others else ""
    columns = ("optimizer", ">median of median gaps", ">worst", ">first on", ">runs ≤ 1 %",
               ">runs ≤ 0.01 %", ">solved to 1 %", ">solved to 0.01 %")  # fmt: skip
    return Prose(f"{said}.", "lead"), table(columns, rows)


def bench_blocks(result: BenchResult) -> tuple[Block, ...]:
    """Which optimiser is closest, what is known of the optimum, a row for each, and notes."""
    return (
        Prose(result.verdict, "lead"),
        Prose(_optimum_said(result.optimum)),
        table(BENCH_COLUMNS, map(bench_cells, result.standings)),
        *(Prose(message, "warning") for message in result.messages),
        *(Prose(note, "note") for note in result.notes),
    )


def _optimum_said(optimum: Reference) -> str:
    """What is known of the optimum, in a sentence."""
    lower = value_or_none(optimum.lower)
    if lower is None:
        return f"Optimum: {optimum.upper:.6f} s, {optimum.evidence}; true gaps may be larger."
    width = percent(optimum.width or 0.0)
    far = width.replace("<", "less than") if width.startswith("<") else f"up to {width}"
    return (
        f"Optimum: {shown_bound(lower, 'lower', places=7)} to "
        f"{shown_bound(optimum.upper, 'upper', places=7)} s, {optimum.evidence}; it may lie {far} "
        "below the value from which gaps are measured."
    )


_BOARD = (">place", "optimiser", ">runs within 1 %", ">within 0.1 %", ">within 0.01 %",
            ">median gap", ">evaluations to 1 %", ">to 0.1 %", ">to 0.01 %", ">failed")  # fmt: skip
"""What a row of a board says."""


def board_table(board: Board) -> Grid:
    """A row for each optimiser, with the intervals of shares and evaluations."""
    return table(_BOARD, [_board_cells(board, one) for one in board.standings], "", "sortable")


def brief_board(board: Board, marked: Collection[str] = ()) -> Grid:
    """The same without intervals and without what does not fit a terminal; some have a star."""
    rows = [
        [
            f"* {said}" if said in marked else said.partition("\n")[0]
            for said in _board_cells(board, one)
        ]
        for one in board.standings
    ]
    return table(_BOARD, rows).without(6, 7, 8, 9)


def _board_cells(board: Board, one: Ranked) -> tuple[str, ...]:
    place, spent = board.place(one), []
    for ends in one.expected:  # with their interval, of which an end without bound is ∞
        value, low, high = ("∞" if np.isinf(end) else f"{end:.0f}" for end in ends)
        spent.append(f"{value}\n({low} to {high})" if place and value != "∞" else "–")
    return (
        str(place or "–"),
        one.optimizer if place else f"{one.optimizer} (reference, no black box)",
        *(share_cell(*ends) for ends in one.solved),
        percent(one.median) if np.isfinite(one.median) else "no answer",
        *spent,
        str(one.failed),
    )


def share_cell(share: float, low: float, high: float) -> str:
    """A share in percent above its interval."""
    return f"{100 * share:.0f} %\n({100 * low:.0f} to {100 * high:.0f})"


def suite_table(
    instances: Iterable[BenchmarkInstance],
    place: str = "",
    digits: int | None = None,
    brief: bool = False,
) -> Grid:
    """A row for each instance.

    `place`: what the name of an instance points to, with {} for the name. `digits`: of bounds,
    rounded outwards; all of them by default. `brief`: whether limits are their first letters, and
    how hard an instance is has no room.
    """
    rows = []
    for one in instances:
        bounds = ("lower", one.lower), ("upper", one.upper)
        hard = one.hardness
        rows.append(
            (
                Cell(one.name, target=place.format(one.name)),
                one.curve,
                one.segments,
                one.joints,
                ", ".join(limit[0] if brief else limit for limit in one.tight),
                *(shown_bound(end, at, digits=digits) if digits else repr(end)
                  for at, end in bounds),
                f"{one.width:.1e}",
                badge(str(one.evidence)),
                hard and hard.basins,
                hard and f"{hard.feasible_share:.2%}",
            )
        )  # fmt: skip
    columns = ("instance", "curve", ">segments", ">joints", "tight in", ">lower, s", ">upper, s",
               ">width", "evidence", ">basins", ">feasible")  # fmt: skip
    found = table(columns, rows, "", "sortable")
    return found.without(*(9, 10)) if brief else found


def instance_terms(one: BenchmarkInstance) -> Terms:
    """What is known of an instance, and how hard it is."""
    found: list[tuple[str, str | Cell]] = [
        ("curve", f"{one.curve}, {one.segments} segments, {one.joints} joints"),
        ("optimum, s", f"between {one.lower!r} and {one.upper!r}"),
        ("relative width", f"{one.width:.1e}, {one.evidence}"),
        ("lower bound over", one.lower_subject),
        ("best known total", "proved feasible" if one.upper_proved else
         "feasible by trajgap's check"),
        ("best known durations, s", ", ".join(f"{h:.9g}" for h in one.durations)),
        ("tight in", ", ".join(one.tight)),
        ("made by", code(one.command)),
    ]  # fmt: skip
    hard = one.hardness
    if hard is not None:
        runs = f"of {hard.baseline_runs} runs of {hard.baseline_budget} evaluations"
        found += [
            ("basins", f"{hard.basins} found by {hard.starts} random starts; "
             f"{hard.best_basin_share:.0%} of them reach the best"),
            ("feasible share", f"{hard.feasible_share:.2%} of {hard.drawn} durations drawn "
             "uniformly within their bounds"),
            *((f"success of {name}", f"{rate:.0%} {runs} end within 1 %")
              for name, rate in hard.baselines.items()),
        ]  # fmt: skip
    return Terms(tuple(found))
