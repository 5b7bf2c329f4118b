"""One instance of the suite: what is known of its optimum, and of how hard it is to reach."""

from __future__ import annotations

from collections.abc import Mapping
from enum import StrEnum
from importlib.resources import files
from importlib.resources.abc import Traversable
from typing import Annotated, Literal

from pydantic import Field

from ..cases import SUITE_PREFIX, Case, load_case
from ..printed import Strict
from ..problem import Problem

Seconds = Annotated[float, Field(ge=0)]
"""A time, s."""
Share = Annotated[float, Field(ge=0, le=1)]
"""A share of all, from 0 to 1."""
Count = Annotated[int, Field(ge=0)]
"""How many."""
Hash = Annotated[str, Field(pattern="^[0-9a-f]{64}$")]
"""A SHA-256."""


class BoundEvidence(StrEnum):
    """Evidence for the bounds of an instance."""

    CERTIFIED = "certified"
    """Both bounds are proved by `trajgap.verify`, and at most 1 % apart."""
    BEST_KNOWN = "best known"
    """The lower bound is proved; the upper one is proved too far from it, or checked only."""


class Hardness(Strict):
    """How hard an instance is to solve."""

    starts: Count
    """Descents from random starts, log-uniform within the bounds of the durations."""
    basins: Count
    """Different totals that they ended in, more than 0.01 % apart."""
    best_basin_share: Share
    """Share of the descents that ended within 0.1 % of the best known total."""
    drawn: Count
    """Durations drawn uniformly within their bounds."""
    feasible_share: Share
    """Share of them that keep the limits."""
    baselines: Mapping[str, Share] = {}
    """Share of runs that end within 1 % of the best known total, by the baseline's name."""
    baseline_runs: Count = 0
    """Runs of each baseline; one of those that draw no random numbers."""
    baseline_budget: Count = 0
    """Number of evaluations of each run."""


class BenchmarkInstance(Strict):
    """A row of the suite's table.

    Times are in s. ``lower`` is rounded down and ``upper`` up, at twelve digits.
    """

    name: str
    """Permanent, within a major version of the suite."""
    curve: str
    """Kind of curve in words."""
    source: str = ""
    """Where way-points and limits come from."""
    joints: Count
    segments: Count
    """Between way-points; virtual way-points are not counted."""
    tight: tuple[Literal["velocity", "acceleration", "jerk"], ...]
    """Limits that the best known answer reaches."""
    lower: Seconds
    """No feasible total is below it."""
    upper: Seconds
    """Total of the best known answer."""
    width: float
    """(upper − lower)/upper"""
    evidence: BoundEvidence
    lower_subject: Literal["the declared curve", "any curve"]
    """Over which curves the lower bound is proved."""
    upper_proved: bool
    """Whether the certificate proves the answer feasible; otherwise `check` passes it."""
    durations: tuple[float, ...]
    """Durations of the best known answer."""
    case_sha256: Hash
    """Hash of the case file."""
    problem_hash: Hash | None
    """Hash of the problem as the certificate states it."""
    certificate: str | None
    """Name of its file; None if it is too large to ship, or if there is none."""
    certificate_sha256: Hash | None
    certificate_bytes: Count | None
    gap_asked: float
    """Relative width that `command` asks for."""
    boxes: Count
    """Boxes that the search for the proof visited."""
    seconds: Seconds
    """Processor time of that search, on one core of a shared machine."""
    verify_seconds: Seconds | None
    """Processor time for verifying the certificate."""
    hardness: Hardness | None
    """None until it is measured."""

    @property
    def id(self) -> str:
        """What commands and `load_case` take: ``suite:NAME``."""
        return f"{SUITE_PREFIX}{self.name}"

    @property
    def command(self) -> str:
        """Command that creates the certificate."""
        over = "" if self.lower_subject == "the declared curve" else " --any-curve"
        seconds = max(60, round(10 * self.seconds, -1))
        return (
            f"trajgap solve {self.id} --certify{over} --gap {self.gap_asked:g} --time {seconds:g}"
        )

    def case(self) -> Case:
        """The case file, loaded."""
        return load_case(self.id)

    def problem(self) -> Problem:
        """The problem, in rad and s."""
        return self.case().problem()

    def certificate_file(self) -> Traversable | None:
        """The certificate, as package data; None if none is shipped."""
        if self.certificate is None:
            return None
        return files(__package__ or "").joinpath("certificates", self.certificate)
