"""Ids in a case file: each declared once, each reference to something declared."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from ..errors import TrajgapError
from ..printed import CHOICES, spelling_hint
from ..robots import Chain, check_equation
from .claim import (
    Claim,
    ConditionsClaim,
    ControlVerticesClaim,
    DurationsClaim,
    ImprovementClaim,
    MaximumClaim,
    MotionValueClaim,
    PeakClaim,
    PhasesClaim,
    ProfiledClaim,
    StatementClaim,
    TotalTimeClaim,
    ValueClaim,
)
from .clue import AxisClue, DataSheetClue, HalfTurnsClue, SmoothClue
from .faults import Faults
from .instances import InstancesBlock
from .schema import LISTS, CaseFile

_BLOCKS = ("units", "waypoints", "limits", "interpolant", "durations", "coupling", "robot")
"""Single blocks that an assumption may say it affects; they have no ids."""
_OF_ONE_PROBLEM = (
    DurationsClaim,
    MaximumClaim,
    TotalTimeClaim,
    PhasesClaim,
    MotionValueClaim,
    ControlVerticesClaim,
)
"""Claims whose numbers belong to one problem, which a file with several must name."""


def check_references(document: CaseFile, faults: Faults) -> None:
    """Check that ids are unique and references resolve.

    Raises
    ------
    CaseError
        If an id is declared twice.
    """
    ids = {name: _unique(faults, name, getattr(document, name)) for name in LISTS}
    faults.refuse()  # what refers to an id that is there twice cannot be judged
    defaults = [index for index, reading in enumerate(document.readings) if reading.default]
    if len(defaults) > 1:
        faults.add(f"readings[{defaults[1]}].default", "a second default reading; keep one")
    labels = [reading.label for reading in document.readings]
    for index, label in enumerate(labels):
        if label is not None and label in labels[:index]:
            faults.add(
                f"readings[{index}].label", f"{label!r} names another reading; say what differs"
            )

    def known(kind: str, field: str, name: str | None) -> None:
        if name is not None and name not in ids[kind]:
            faults.add(field, f"{name!r} is not the id of any of the {kind}; "
                f"{spelling_hint(name, ids[kind])}"
            )  # fmt: skip

    for index, reading in enumerate(document.readings):
        for position, problem_id in enumerate(reading.interpolant_of):
            known("problems", f"readings[{index}].interpolant_of[{position}]", problem_id)
    for index, table in enumerate(document.tables):
        known("algorithms", f"tables[{index}].algorithm", table.algorithm)
    for index, claim in enumerate(document.claims):
        at = f"claims[{index}]"
        known("problems", f"{at}.problem", claim.problem)
        known("algorithms", f"{at}.algorithm", claim.algorithm)
        known("tables", f"{at}.table", claim.table)
        for position, table_id in enumerate(claim.printed_tables):
            known("tables", f"{at}.printed_tables[{position}]", table_id)
        if claim.joint is not None and claim.joint not in document.robot.joints:
            joints = ", ".join(document.robot.joints)
            faults.add(
                f"{at}.joint",
                f"joint {claim.joint!r} is unknown; robot.joints lists {joints}",
            )
        for field, name in _claim_references(claim):
            known("claims", f"{at}.{field}", name)
        if (
            claim.problem is None
            and len(document.problems) > 1
            and isinstance(claim, _OF_ONE_PROBLEM)
        ):
            faults.add(
                f"{at}.problem",
                f"is missing, and there are {len(document.problems)} problems; "
                f"add one of {', '.join(ids['problems'])}",
            )
        if isinstance(claim, StatementClaim):
            known("algorithms", f"{at}.against", claim.against)
            for position, place in enumerate(claim.positions):
                known("cartesian", f"{at}.positions[{position}]", place)
            if claim.checks == "kinematics" and not document.cartesian:
                faults.add(f"{at}.checks", "kinematics needs printed positions; add [[cartesian]]")
            if claim.checks == "equations" and not document.equations:
                faults.add(f"{at}.checks", "equations needs printed ones; add [[equations]]")
    _check_kinds(document, faults)
    _check_clues(document, faults, ids["claims"])
    for index, block in enumerate(document.families):
        at = f"families[{index}]"
        known("claims", f"{at}.claim", block.claim)
        for position, reading_id in enumerate(block.readings):
            known("readings", f"{at}.readings[{position}]", reading_id)
        _check_instances(document, faults, block, at)
    everything = {name for names in ids.values() for name in names} | set(_BLOCKS)
    for index, assumption in enumerate(document.assumptions):
        for position, name in enumerate(assumption.affects):
            if name not in everything:
                faults.add(
                    f"assumptions[{index}].affects[{position}]",
                    f"{name!r} is neither an id in this file nor one of "
                    f"{', '.join(_BLOCKS)}; name what it affects",
                )


def _unique(faults: Faults, kind: str, blocks: Iterable[object]) -> list[str]:
    seen: list[str] = []
    for index, block in enumerate(blocks):
        name = str(getattr(block, "id"))  # noqa: B009
        if name in seen:
            faults.add(f"{kind}[{index}].id", f"{name!r} is already the id of "
                f"{kind}[{seen.index(name)}]; rename one"
            )  # fmt: skip
        seen.append(name)
    return seen


def _claim_references(claim: Claim) -> list[tuple[str, str]]:
    if isinstance(claim, ImprovementClaim):
        return [("slower", claim.slower), ("faster", claim.faster)]
    if isinstance(claim, MaximumClaim | StatementClaim | ConditionsClaim):
        return [(f"of[{position}]", name) for position, name in enumerate(claim.of)]
    if isinstance(claim, MotionValueClaim | TotalTimeClaim) and claim.of is not None:
        return [("of", claim.of)]
    return []


def _check_kinds(document: CaseFile, faults: Faults) -> None:
    by_id = {claim.id: claim for claim in document.claims}
    totals = (DurationsClaim, MaximumClaim, TotalTimeClaim)
    for index, claim in enumerate(document.claims):
        any_time = isinstance(claim, ImprovementClaim) or (
            isinstance(claim, StatementClaim) and claim.checks in ("optimal", "within_limits")
        )
        wanted: tuple[type, ...] = totals if any_time else totals[:2]
        for field, name in _claim_references(claim):
            if name in by_id and not isinstance(by_id[name], wanted):
                if _states_profile(claim, by_id[name]):
                    continue
                what = "a time" if any_time else "durations"
                faults.add(
                    f"claims[{index}].{field}",
                    f"{name!r} is a claim of quantity {by_id[name].quantity!r}; "
                    f"name one that states {what}",
                )


def _states_profile(claim: Claim, named: Claim) -> bool:
    """Whether a claim may speak of the profile of another one: its peaks, values and optimality."""
    speaks = isinstance(claim, PeakClaim | ValueClaim) or (
        isinstance(claim, StatementClaim) and claim.checks == "optimal"
    )
    return speaks and isinstance(named, ProfiledClaim) and named.profile is not None


def _check_clues(document: CaseFile, faults: Faults, claims: Sequence[str]) -> None:
    by_id = {claim.id: claim for claim in document.claims}
    joints = document.robot.joints
    for index, clue in enumerate(document.clues):
        at = f"clues[{index}]"
        if isinstance(clue, AxisClue | SmoothClue):
            for position, name in enumerate(clue.of):
                field = f"{at}.of[{position}]"
                if name not in by_id:
                    faults.add(
                        field, f"{name!r} is not the id of a claim; {spelling_hint(name, claims)}"
                    )
                elif not isinstance(by_id[name], DurationsClaim | MaximumClaim):
                    quantity = by_id[name].quantity
                    faults.add(
                        field,
                        f"{name!r} is a claim of quantity {quantity!r}; "
                        "name one that states durations",
                    )
        named = clue.joint if isinstance(clue, AxisClue | HalfTurnsClue) else None
        if named is not None and named not in joints:
            faults.add(
                f"{at}.joint",
                f"joint {named!r} is unknown; robot.joints lists {', '.join(joints)}",
            )
        if isinstance(clue, DataSheetClue) and len(clue.values) != len(joints):
            faults.add(
                f"{at}.values",
                f"{len(clue.values)} values for {len(joints)} joints; give one each",
            )


def _check_instances(document: CaseFile, faults: Faults, block: InstancesBlock, at: str) -> None:
    by_id = {claim.id: claim for claim in document.claims}
    claim = by_id.get(block.claim)
    if claim is not None and not isinstance(claim, ImprovementClaim):
        faults.add(
            f"{at}.claim",
            f"{claim.id!r} is a claim of quantity {claim.quantity!r}; name an improvement",
        )
    sides = (claim.slower, claim.faster) if isinstance(claim, ImprovementClaim) else ()
    for side in (by_id[name] for name in sides if name in by_id):
        if side.algorithm is None or (side.problem is None and document.problems):
            faults.add(
                f"{at}.claim",
                f"claim {side.id!r} does not name its problem and its algorithm; add both to it",
            )
    if document.robot.dh is None and document.robot.model is None:
        faults.add(f"{at}.id", "way-points are drawn from the robot's workspace; add robot.dh")


def check_kinematics(document: CaseFile, faults: Faults, chain: Chain | None) -> None:
    """Check that joints and positions of the end fit the robot and its way-points."""
    labels = document.robot.joints if chain is None else chain.labels
    for index, label in enumerate(document.robot.joints):
        if label not in labels:
            faults.add(
                f"robot.joints[{index}]",
                f"joint {label!r} is not in the robot's table; it has {', '.join(labels)}",
            )
    for index, equation in enumerate(document.equations):
        if chain is None:
            faults.add(f"equations[{index}]", "needs the robot's table; add robot.dh")
            continue
        for field, text in (("printed", equation.printed), ("mended", equation.mended)):
            if text is not None:
                try:
                    check_equation(chain, text, samples=1)
                except TrajgapError as error:
                    faults.add(f"equations[{index}].{field}", str(error))
    for index, block in enumerate(document.families):
        if block.kind == "joint" and chain is not None and not chain.revolute.all():
            faults.add(
                f"families[{index}].kind",
                '"joint" measures a step as an angle, but a joint of the robot slides; use "end"',
            )
    waypoints = document.waypoints
    printed = list(document.robot.joints)
    for index, column in enumerate(document.columns):
        if column.joint is None:
            continue
        field = f"columns[{index}]"
        if column.joint in printed:
            faults.add(f"{field}.joint", f"joint {column.joint!r} is printed twice; keep one")
        if chain is not None and column.joint not in labels:
            faults.add(
                f"{field}.joint",
                f"joint {column.joint!r} is unknown; the robot has {', '.join(labels)}",
            )
        listed = isinstance(document.units.position, tuple)
        if listed and column.unit not in CHOICES["position"]:
            faults.add(
                f"{field}.unit",
                f"is needed if units.position lists one unit per joint; use one of "
                f"{', '.join(CHOICES['position'])}",
            )
        printed.append(column.joint)
        if waypoints is not None and len(column.values) != waypoints.number:
            faults.add(
                f"{field}.values",
                f"{len(column.values)} values for {waypoints.number} way-points; give one each",
            )
    named = [entry.waypoint for entry in document.cartesian]
    for index, name in enumerate(named):
        if name is None and any(named):
            faults.add(
                f"cartesian[{index}].waypoint", "is missing, although others name theirs; add it"
            )
        known = () if waypoints is None else waypoints.labels
        if name is not None and name not in known:
            faults.add(
                f"cartesian[{index}].waypoint",
                f"{name!r} is not a label of a way-point; {spelling_hint(name, known)}",
            )
    if named and None in named and waypoints is not None and len(named) != waypoints.number:
        faults.add(
            "cartesian",
            f"{len(named)} positions for {waypoints.number} way-points; "
            "give one each, or name the way-point of each",
        )
