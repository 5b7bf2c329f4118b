"""Options of an audit: one record, passed from `audit` to each study."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ...problem import TrajgapError

SEEDS = 100
"""Seeds of a replay by default: independent runs enough for a probability to a few per cent."""


@dataclass(frozen=True, kw_only=True)
class AuditOptions:
    """Options of an audit; the fields are the parameters of `audit`.

    Raises
    ------
    TrajgapError
        If there are fewer than two seeds.
    """

    seeds: int = SEEDS
    workers: int | None = 1
    problem: str | None = None
    reading: str | None = None
    progress: Callable[[str], None] | None = None
    certify_seconds: float | None = None
    certificates: Sequence[dict[str, Any]] = ()
    certificates_folder: str | None = None
    draft: bool = False
    cache: bool | Path = False

    def __post_init__(self) -> None:
        if self.seeds < 2:
            raise TrajgapError(
                f"seeds: {self.seeds} show no spread; give 2 or more, 30 is customary"
            )


USUAL = AuditOptions()
"""The options of an audit that names none."""
