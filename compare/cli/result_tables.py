"""Tables of what `check` and `solve` answer for each problem and reading."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, Protocol, TypeVar

from rich.console import RenderableType
from rich.text import Text

from ...problem import Case
from ..audits import posed_as
from ..documents import ActiveLimit, Why, WorstPeak
from .table import Columns, line


class Result(Protocol):
    """One problem under one reading, and under per-joint coupling its joints."""

    @property
    def problem(self) -> str: ...  # noqa: D102
    @property
    def reading(self) -> str: ...  # noqa: D102
    @property
    def joints(self) -> Sequence[Any] | None: ...  # noqa: D102


R = TypeVar("R", bound=Result)
Cells = Callable[[Any], tuple[object, ...]]
"""What a row says of a result, or of one of its joints."""


def by_result(
    results: Sequence[Result], columns: Sequence[str], cells: Cells, whole: str, case: Case
) -> list[RenderableType]:
    """One table of all results, or one for each where the joints stand by themselves."""
    if not any(result.joints for result in results):
        rows = [(r.problem, r.reading, *cells(r)) for r in results]
        return [Columns(("problem", "reading", *columns), rows)]
    parts: list[RenderableType] = []
    for result in results:
        joints = [(one.joint, *cells(one)) for one in result.joints or ()]
        where = f"problem {result.problem}, reading {result.reading}"
        parts.append(line(f"{posed_as(case, result.problem, result.reading)} ({where})"))
        parts.append(Columns(("joint", *columns), [*joints, (whole, *cells(result))]))
    return parts


def reasons(
    results: Iterable[R], told: Callable[[R], Mapping[str, str | None]], case: Case
) -> list[Text]:
    """Why a number is missing, for each result without joints of its own."""
    return [
        line(f"{name}: {why} ({posed_as(case, result.problem, result.reading)})", "dim")
        for result in results
        if not result.joints
        for name, why in told(result).items()
        if why
    ]


def seconds(value: float | Why) -> str:
    """A time, or none."""
    return "none" if isinstance(value, Why) or not math.isfinite(value) else f"{value:.6f}"


def place(at: ActiveLimit | WorstPeak) -> str:
    """Where on a trajectory, and of what."""
    where = f"segment {at.segment + 1}" if at.joint is None else f"joint {at.joint}"
    when = "" if isinstance(at.time, Why) else f" at {at.time:.4f} s"
    return f"{where} {at.quantity}{when}"
