"""What the audit knows of rules before any of them is written."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

from ...documents import Finding
from ..study import Study


@dataclass(frozen=True)
class RuleGroup:
    """Rules that one function judges.

    Attributes
    ----------
    judge : callable
        From a study to the findings.
    rules : dict
        What each rule looks at, by its permanent id; an id is never reused.
    without_waypoints : bool
        Whether it says something while the way-points are missing.
    """

    judge: Callable[[Study], Iterator[Finding]]
    rules: dict[str, str]
    without_waypoints: bool = False
