"""What the suite says of its instances: a row for each, and the facts of one."""

from __future__ import annotations

from collections.abc import Iterable

from ...problem import shown_bound
from ...problem.suite import BenchmarkInstance
from .tree import Cell, Grid, Terms, badge, code, table


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
    columns = (
        "instance",
        "curve",
        ">segments",
        ">joints",
        "tight in",
        ">lower, s",
        ">upper, s",
        ">width",
        "evidence",
        ">basins",
        ">feasible",
    )
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
