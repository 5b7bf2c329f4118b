"""The exceptions of trajgap: one root, and one for case files with its evidence attached."""

from __future__ import annotations

from collections.abc import Sequence

from .characters import visible


class TrajgapError(ValueError):
    """Root of every exception that trajgap raises on purpose."""


class RatiosError(TrajgapError):
    """Ratios of durations that are impossible.

    Parameters
    ----------
    why : str
        What is wrong, and how to fix it.
    """

    def __init__(self, why: str) -> None:
        super().__init__(f"ratios: {why}")
        self.why = why


class ProcessError(TrajgapError):
    """A worker process ended or cannot be started; this says nothing about a problem."""


class CurveError(TrajgapError):
    """Durations that define no curve: time would run backwards, or no spline passes.

    Parameters
    ----------
    segment : int
        Segment in which it shows, from 0.
    value : float
        The number that must be positive, at its worst place.
    """

    def __init__(self, reason: str, segment: int, value: float) -> None:
        super().__init__(reason, segment, value)
        self.reason = reason
        self.segment = segment
        self.value = value

    def __str__(self) -> str:
        return self.reason


class SingularError(CurveError):
    """Durations at which rounding errors hide the curve: its linear system is singular in float64.

    Nothing is known of such a curve, neither that it keeps a limit nor that it breaks one.

    Parameters
    ----------
    segment : int
        The shortest segment, from 0.
    """

    def __init__(self, reason: str, segment: int) -> None:
        super().__init__(reason, segment, 0.0)


class PackageError(TrajgapError):
    """An optional package is not installed; the message says how to install it."""


class CaseError(TrajgapError):
    """A case file, or a table meant to become one, cannot be used.

    Parameters
    ----------
    file : str
        The file or case id as it was given.
    field : str
        Path of the field inside it, such as ``waypoints.joint_rows[2]``; empty if the file as a
        whole is at fault.
    reason : str
        What is wrong and, after a semicolon, how to fix it.
    others : sequence of (str, str)
        Field and reason of every further fault, so one message reports all of them.

    Notes
    -----
    The message is always one line, ``FILE: field: what is wrong; how to fix it``; further faults
    follow after ``; also``.
    """

    def __init__(
        self, file: str, field: str, reason: str, others: Sequence[tuple[str, str]] = ()
    ) -> None:
        super().__init__(file, field, reason, tuple(others))
        self.file = file
        self.field = field
        self.reason = reason
        self.others = tuple(others)

    @property
    def faults(self) -> tuple[tuple[str, str], ...]:
        """Field and reason of every fault, the one to fix first in front."""
        return ((self.field, self.reason), *self.others)

    def __str__(self) -> str:
        # More than eight would hide the ones to begin with.
        shown = [": ".join(part for part in one if part) for one in self.faults[:8]]
        more = len(self.faults) - len(shown)
        said = "; also ".join(shown) + (f" (and {more} more)" if more else "")
        line = " ".join(": ".join(part for part in (self.file, said) if part).split())
        # File names and values come from outside; nothing of them may steer a terminal.
        return visible(line)
