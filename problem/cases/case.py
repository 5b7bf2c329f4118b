"""Case files: what a paper prints, loaded, and turned into problems reading by reading."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Generic, TypeVar

import numpy as np

from ..arrays import Array
from ..errors import CaseError
from ..printed import CHOICES, Printed, UnitOrEach, spelling_hint
from ..problem import Coupling, Problem
from ..robots import Chain, Convention, DhTable
from .claim import AnyClaim, Claim, DurationsClaim, MaximumClaim
from .data_files import robot_file, robot_ids
from .digits import RoundingBox
from .labels import reading_labels
from .overlay import on_line, overlaid
from .schema import CaseFile, ProblemBlock, Reading, Waypoints
from .statement import Statement

_ONLY_PROBLEM = ProblemBlock(id="main")
"""Stands for the one problem of a file that lists none; its id is what `--problem` then takes."""
_ONLY_READING = Reading(id="as-printed", why="the numbers and units as printed", default=True)
"""Stands for the one reading of a file that lists none."""

B = TypeVar("B", AnyClaim, ProblemBlock, Reading)
T = TypeVar("T")


class _Block(Generic[T]):
    """A block of a case file, as an attribute of the case that was read from it."""

    def __init__(self, read: Callable[[CaseFile], T]) -> None:
        self._read = read

    def __get__(self, case: Case, kind: type[Case] | None = None) -> T:
        return self._read(case.document)


@dataclass(frozen=True)
class Case:
    """A loaded and checked case file."""

    document: CaseFile
    file: str
    """Name of the file, for messages."""
    sha256: str | None = None
    """Hash of the file; None if the case was not read from a file."""

    id = _Block(lambda file: file.id)
    """Permanent id of the case."""
    title = _Block(lambda file: file.title)
    """Title of the case."""
    source = _Block(lambda file: file.source)
    """Where the numbers were printed."""
    robot = _Block(lambda file: file.robot)
    """The robot and its joint labels."""
    claims = _Block(lambda file: file.claims)
    """What the paper claims."""
    clues = _Block(lambda file: file.clues)
    """Evidence for or against readings, apart from the claims."""
    tables = _Block(lambda file: file.tables)
    """The tables that group the claims."""
    algorithms = _Block(lambda file: file.algorithms)
    """The paper's algorithms and their settings."""
    instances = _Block(lambda file: file.families)
    """Blocks of instances on which relative claims are examined."""
    assumptions = _Block(lambda file: file.assumptions)
    """What the paper leaves open, and what was chosen."""
    columns = _Block(lambda file: file.columns)
    """Printed numbers that are neither problem data nor claims."""
    cartesian = _Block(lambda file: file.cartesian)
    """Printed positions of the robot's end."""
    not_checkable = _Block(lambda file: file.not_checkable)
    """What cannot be checked from the extracted text."""

    @property
    def problems(self) -> tuple[ProblemBlock, ...]:
        """The problems stated; one called "main" if the file names none."""
        return self.document.problems or (_ONLY_PROBLEM,)

    @property
    def readings(self) -> tuple[Reading, ...]:
        """The admissible readings; one called "as-printed" if the file names none."""
        return self.document.readings or (_ONLY_READING,)

    @cached_property
    def labels(self) -> dict[str, str]:
        """What each reading means in words, by its id."""
        return reading_labels(self.document, self.readings)

    @property
    def default_reading(self) -> Reading:
        """The reading marked as default, else the first."""
        return next((r for r in self.readings if r.default), self.readings[0])

    @property
    def complete(self) -> bool:
        """Whether every problem has way-points under every reading, so it can be solved."""
        return all(self.statement(*pair).complete for pair in self.selections())

    @cached_property
    def dh(self) -> DhTable | None:
        """The robot's Denavit-Hartenberg table: printed in the paper, or the shipped model's.

        Raises
        ------
        CaseError
            If the model is unknown.
        """
        model = self.robot.model
        if model is None:
            return self.robot.dh
        if model not in robot_ids():
            raise CaseError(
                self.file,
                "robot.model",
                f"no robot {model!r} is shipped; {spelling_hint(model, robot_ids())}",
            )
        return robot_file(model).dh

    def chain(
        self, convention: Convention | None = None, flipped: tuple[int, ...] = ()
    ) -> Chain | None:
        """The robot's chain, or None if the case has no table.

        Parameters
        ----------
        convention : Convention, optional
            Instead of the one stated.
        flipped : tuple of int
            Rows whose twist is taken with the other sign.

        Raises
        ------
        CaseError
            If the model is unknown, or the table has not one row per joint.
        """
        if self.dh is None:
            return None
        labels = self.robot.joints if self.robot.model is None else ()
        if self.dh.joints is None and labels and len(self.dh.d) != len(labels):
            raise CaseError(
                self.file,
                "robot.dh.d",
                f"has {len(self.dh.d)} entries for {len(labels)} joints; "
                "give one each, or name the table's joints",
            )
        return self.dh.chain(self.robot.name, labels, convention, flipped)

    def claim(self, claim_id: str) -> AnyClaim:
        """Look a claim up by its id."""
        return self._found("claim", self.claims, claim_id)

    def table_claims(self, table_id: str) -> tuple[AnyClaim, ...]:
        """Claims that a table prints, in the order of the file."""
        return tuple(claim for claim in self.claims if claim.table == table_id)

    def selections(
        self, problem: str | None = None, reading: str | None = None
    ) -> list[tuple[str, str]]:
        """Pairs of problem id and reading id.

        Parameters
        ----------
        problem, reading : str, optional
            Keep only these; all by default.

        Returns
        -------
        list of (str, str)
            Problems in the order of the file; within each, the default reading first.

        Raises
        ------
        CaseError
            If the problem or reading is unknown.
        """
        ordered = sorted(self.readings, key=lambda one: one.id != self.default_reading.id)
        problems = self.problems if problem is None else (self._problem(problem),)
        readings = ordered if reading is None else [self._reading(reading)]
        return [(p.id, r.id) for p in problems for r in readings]

    def problem(
        self,
        problem_id: str | None = None,
        reading_id: str | None = None,
        coupling: Coupling | str | None = None,
    ) -> Problem:
        """Problem in radians and seconds.

        Parameters
        ----------
        problem_id : str, optional
            Which of the paper's problems; the first by default.
        reading_id : str, optional
            Under which reading; the default one if not given.
        coupling : Coupling or str, optional
            "shared" or "per-joint" instead of what the file says.

        Raises
        ------
        CaseError
            If an id or the coupling is unknown, the numbers don't fit together, or the paper
            prints no way-points.
        """
        statement = self.statement(problem_id, reading_id)
        problem = statement.problem()
        if coupling is not None and coupling not in tuple(Coupling):
            known = ", ".join(Coupling)
            raise CaseError(self.file, "coupling", f"unknown coupling {coupling!r}; use {known}")
        return problem if coupling is None else replace(problem, coupling=Coupling(coupling))

    def waypoint_box(
        self, problem_id: str | None = None, reading_id: str | None = None
    ) -> tuple[Array, Array]:
        """Bounds on the way-points that round to the printed digits.

        Parameters
        ----------
        problem_id, reading_id : str, optional
            As in `problem`.

        Returns
        -------
        lower, upper : ndarray, shape (way-points, joints)
            Joint angles in rad, rounded outwards.
        """
        points = self.statement(problem_id, reading_id).points()
        ends = np.array([[(angle.lower, angle.upper) for angle in row] for row in points])
        return ends[..., 0], ends[..., 1]

    def printed_durations(self, claim: Claim) -> tuple[Printed, ...]:
        """Segment durations of a claim as printed; empty if it states none."""
        return claim.durations if isinstance(claim, DurationsClaim | MaximumClaim) else ()

    def claim_durations(self, claim: Claim, reading_id: str | None = None) -> RoundingBox:
        """Segment durations of a claim in seconds.

        Parameters
        ----------
        reading_id : str, optional
            Under which reading; the default one if not given.

        Raises
        ------
        CaseError
            If the claim states no durations.
        """
        printed = self.printed_durations(claim)
        if not printed:
            raise CaseError(
                self.file, f"claim {claim.id!r}", "states no durations; choose one that does"
            )
        statement = self.statement(claim.problem, reading_id)
        return RoundingBox.of(statement.si(number, "time") for number in printed)

    def statement(self, problem_id: str | None = None, reading_id: str | None = None) -> Statement:
        """One problem under one reading, still in printed digits."""
        problem = self.problems[0] if problem_id is None else self._problem(problem_id)
        reading = self.default_reading if reading_id is None else self._reading(reading_id)
        return overlaid(self.document, self.file, problem, reading, self._drawn)

    def _drawn(self, waypoints: Waypoints, unit: UnitOrEach, selected: str) -> Waypoints:
        """Rows of way-points that lie on a line, computed once for each unit."""
        known = self._lines.get((waypoints, unit))
        if known is None:
            chain = self.chain()
            if chain is None or chain.labels != self.robot.joints:
                why = "needs the robot's table with all its joints in robot.joints; add them"
                raise CaseError(self.file, "waypoints.line", why + selected)
            if unit is None:
                choices = ", ".join(CHOICES["position"])
                raise CaseError(self.file, "units.position", f"is missing; add one of {choices}")
            known = on_line(waypoints, unit, chain, self.file, selected)
            self._lines[waypoints, unit] = known
        return known

    @cached_property
    def _lines(self) -> dict[tuple[Waypoints, UnitOrEach], Waypoints]:
        return {}

    def _problem(self, problem_id: str) -> ProblemBlock:
        return self._found("problem", self.problems, problem_id)

    def _reading(self, reading_id: str) -> Reading:
        return self._found("reading", self.readings, reading_id)

    def _found(self, kind: str, blocks: Sequence[B], name: str) -> B:
        by_id = {block.id: block for block in blocks}
        if name not in by_id:
            raise CaseError(self.file, kind, f"no {kind} {name!r}; {spelling_hint(name, by_id)}")
        return by_id[name]
