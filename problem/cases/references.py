"""Ids in a case file: each declared once, each reference to something declared."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from ..errors import TrajgapError
from ..printed import CHOICES, spelling_hint
from ..robots import Chain, check_equation
from .claim import (
    AnyClaim,
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
from .clue import AnyClue, AxisClue, DataSheetClue, HalfTurnsClue
from .faults import Faults
from .instances import InstancesBlock
from .schema import LISTS, CaseFile

_BLOCKS = ("units", "waypoints", "limits", "interpolant", "durations", "coupling", "robot")
"""Single blocks that an assumption may say it affects; they have no ids."""
_REFERS = {
    "problem": "problems",
    "interpolant_of": "problems",
    "algorithm": "algorithms",
    "against": "algorithms",
    "table": "tables",
    "printed_tables": "tables",
    "slower": "claims",
    "faster": "claims",
    "of": "claims",
    "claim": "claims",
    "readings": "readings",
    "positions": "cartesian",
}
"""Keys of blocks whose values are ids, and the list that declares them."""
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
    for name in ("readings", "tables", "claims", "clues", "families"):
        for index, block in enumerate(getattr(document, name)):
            for kind, field, referred in _references(block):
                if referred not in ids[kind]:
                    hint = spelling_hint(referred, ids[kind])
                    faults.add(
                        f"{name}[{index}].{field}",
                        f"{referred!r} is not the id of any of the {kind}; {hint}",
                    )
    for index, claim in enumerate(document.claims):
        _check_claim(document, faults, claim, f"claims[{index}]")
    for index, clue in enumerate(document.clues):
        _check_clue(document, faults, clue, f"clues[{index}]")
    for index, block in enumerate(document.families):
        _check_instances(document, faults, block, f"families[{index}]")
    everything = {name for names in ids.values() for name in names} | set(_BLOCKS)
    for index, assumption in enumerate(document.assumptions):
        for position, name in enumerate(assumption.affects):
            if name not in everything:
                faults.add(
                    f"assumptions[{index}].affects[{position}]",
                    f"{name!r} is neither an id in this file nor one of "
                    f"{', '.join(_BLOCKS)}; name what it affects",
                )


def _references(block: object, kinds: Iterable[str] = LISTS) -> Iterator[tuple[str, str, str]]:
    """List, field and id of everything that a block refers to."""
    for field, kind in _REFERS.items():
        value = getattr(block, field, None) if kind in kinds else None
        if isinstance(value, tuple):
            yield from ((kind, f"{field}[{k}]", name) for k, name in enumerate(value))
        elif value is not None:
            yield kind, field, value


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


def _check_joint(document: CaseFile, faults: Faults, joint: str | None, at: str) -> None:
    if joint is not None and joint not in document.robot.joints:
        joints = ", ".join(document.robot.joints)
        faults.add(f"{at}.joint", f"joint {joint!r} is unknown; robot.joints lists {joints}")


def _check_claim(document: CaseFile, faults: Faults, claim: AnyClaim, at: str) -> None:
    _check_joint(document, faults, claim.joint, at)
    several = len(document.problems) > 1
    if claim.problem is None and several and isinstance(claim, _OF_ONE_PROBLEM):
        faults.add(
            f"{at}.problem",
            f"is missing, and there are {len(document.problems)} problems; "
            f"add one of {', '.join(problem.id for problem in document.problems)}",
        )
    if isinstance(claim, StatementClaim):
        if claim.checks == "kinematics" and not document.cartesian:
            faults.add(f"{at}.checks", "kinematics needs printed positions; add [[cartesian]]")
        if claim.checks == "equations" and not document.equations:
            faults.add(f"{at}.checks", "equations needs printed ones; add [[equations]]")
    totals = (DurationsClaim, MaximumClaim, TotalTimeClaim)
    any_time = isinstance(claim, ImprovementClaim) or (
        isinstance(claim, StatementClaim) and claim.checks in ("optimal", "within_limits")
    )
    wanted: tuple[type, ...] = totals if any_time else totals[:2]
    _check_kinds(document, faults, claim, at, wanted, "a time" if any_time else "durations")


def _check_kinds(
    document: CaseFile,
    faults: Faults,
    block: AnyClaim | AnyClue,
    at: str,
    wanted: tuple[type, ...],
    what: str,
) -> None:
    """Check that the claims that a block refers to are of some kinds."""
    by_id = {claim.id: claim for claim in document.claims}
    for _, field, name in _references(block, ("claims",)):
        named = by_id.get(name)
        if named is not None and not isinstance(named, wanted):
            if _states_profile(block, named):
                continue
            faults.add(
                f"{at}.{field}",
                f"{name!r} is a claim of quantity {named.quantity!r}; name one that states {what}",
            )


def _states_profile(block: AnyClaim | AnyClue, named: AnyClaim) -> bool:
    """Whether a claim may speak of the profile of another one: its peaks, values and optimality."""
    speaks = isinstance(block, PeakClaim | ValueClaim) or (
        isinstance(block, StatementClaim) and block.checks == "optimal"
    )
    return speaks and isinstance(named, ProfiledClaim) and named.profile is not None


def _check_clue(document: CaseFile, faults: Faults, clue: AnyClue, at: str) -> None:
    _check_kinds(document, faults, clue, at, (DurationsClaim, MaximumClaim), "durations")
    if isinstance(clue, AxisClue | HalfTurnsClue):
        _check_joint(document, faults, clue.joint, at)
    joints = len(document.robot.joints)
    if isinstance(clue, DataSheetClue) and len(clue.values) != joints:
        faults.add(f"{at}.values", f"{len(clue.values)} values for {joints} joints; give one each")


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
