"""The exceptions of trajgap: one root, and one for case files with its evidence attached."""

from __future__ import annotations

from .characters import visible


class TrajgapError(ValueError):
    """Root of every exception that trajgap raises on purpose."""


class ProcessError(TrajgapError):
    """Processes that compute ended or cannot be started; it says nothing about a problem."""


class CurveError(TrajgapError):
    """Durations that define no curve: time would run backwards, or no spline passes.

    Parameters
    ----------
    reason : str
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
        What is wrong, and after a semicolon how to fix it.

    Notes
    -----
    The message is always one line, ``FILE: field: what is wrong; how to fix it``.
    """

    def __init__(self, file: str, field: str, reason: str) -> None:
        super().__init__(file, field, reason)
        self.file = file
        self.field = field
        self.reason = reason

    def __str__(self) -> str:
        parts = (part for part in (self.file, self.field, self.reason) if part)
        line = " ".join(": ".join(parts).split())
        # File names and values come from outside; nothing of them may steer a terminal.
        return visible(line)
