"""What an audit is asked beside its cases: one record, passed on from `audit` to each study."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ...problem import TrajgapError

SEEDS = 100
"""Seeds of a replay by default: independent runs enough for a probability to a few per cent."""


def _silent(_: str) -> None:
    pass


@dataclass(frozen=True, kw_only=True)
class AuditOptions:
    """Options of an audit.

    Attributes
    ----------
    seeds : int
        Seeds of each replay, counted from 0.
    workers : int or None
        Processes for the replays, as many as pay if None; the result does not depend on it.
    problem, reading : str or None
        Keep to one problem or reading.
    progress : callable
        Called with a short text before anything that takes a while.
    certify_seconds : float or None
        For each case: time for certifying optima that no certificate proves; 0 turns it off. What
        is certified in it depends on the machine. Without it boxes are counted, and nothing depends
        on the machine. What was left out is said.
    certificates : sequence of dict
        Certificates beside the shipped ones; each is proved again before it counts.
    certificates_folder : str or None
        Where these lie, for the command that makes the audit again.
    draft : bool
        Whether to say, for each case, what its author can change before submitting.
    cache : bool or Path
        Whether proofs that the audit finds, optima and replays are kept for later ones, and those
        that were kept are used once they are proved or judged again: in the user's cache folder, or
        in the folder given.

    Raises
    ------
    TrajgapError
        If there are fewer than two seeds.
    """

    seeds: int = SEEDS
    workers: int | None = 1
    problem: str | None = None
    reading: str | None = None
    progress: Callable[[str], None] = _silent
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
