"""Ids in a case file: each declared once, each reference to something declared."""

from __future__ import annotations

from collections.abc import Callable, Iterable

from ..errors import CaseError
from ..fields import nearest
from ..robots import Chain
from .claim import (
    AnyClaim,
    Claim,
    ConditionsClaim,
    ControlVerticesClaim,
    DurationsClaim,
    ImprovementClaim,
    MaximumClaim,
    PeakClaim,
    StatementClaim,
    TotalTimeClaim,
)
from .instances import InstancesBlock
from .schema import LISTS, CaseFile
from .statement import Statement

_BLOCKS = ("units", "waypoints", "limits", "interpolant", "durations", "coupling", "robot")
"""Single blocks that an assumption may say it affects; they have no ids."""
_OF_ONE_PROBLEM = (DurationsClaim, MaximumClaim, TotalTimeClaim, PeakClaim, ControlVerticesClaim)
"""Claims whose numbers belong to one problem, which a file with several must name."""


def check_references(document: CaseFile, file: str) -> None:
    """Check that ids are unique and references resolve.

    Parameters
    ----------
    document : CaseFile
    file : str
        Name for error messages.

    Raises
    ------
    CaseError
        If an id is declared twice, or something refers to an undeclared one.
    """
    ids = {name: _unique(file, name, getattr(document, name)) for name in LISTS}
    defaults = [index for index, reading in enumerate(document.readings) if reading.default]
    if len(defaults) > 1:
        raise CaseError(
            file, f"readings[{defaults[1]}].default", "a second default reading; keep one"
        )

    def known(kind: str, field: str, name: str | None) -> None:
        if name is not None and name not in ids[kind]:
            raise CaseError(
                file, field, f"{name!r} is not the id of any of the {kind}; "
                f"{nearest(name, ids[kind])}"
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
            raise CaseError(
                file,
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
            raise CaseError(
                file,
                f"{at}.problem",
                f"is missing, and there are {len(document.problems)} problems; "
                f"add one of {', '.join(ids['problems'])}",
            )
    _check_kinds(document, file)
    for index, block in enumerate(document.families):
        at = f"families[{index}]"
        known("claims", f"{at}.claim", block.claim)
        for position, reading_id in enumerate(block.readings):
            known("readings", f"{at}.readings[{position}]", reading_id)
        _check_instances(document, file, block, at)
    everything = {name for names in ids.values() for name in names} | set(_BLOCKS)
    for index, assumption in enumerate(document.assumptions):
        for position, name in enumerate(assumption.affects):
            if name not in everything:
                raise CaseError(
                    file,
                    f"assumptions[{index}].affects[{position}]",
                    f"{name!r} is neither an id in this file nor one of "
                    f"{', '.join(_BLOCKS)}; name what it affects",
                )


def _unique(file: str, kind: str, blocks: Iterable[object]) -> list[str]:
    seen: list[str] = []
    for index, block in enumerate(blocks):
        name = str(getattr(block, "id"))  # noqa: B009
        if name in seen:
            raise CaseError(
                file, f"{kind}[{index}].id", f"{name!r} is already the id of "
                f"{kind}[{seen.index(name)}]; rename one"
            )  # fmt: skip
        seen.append(name)
    return seen


def _claim_references(claim: Claim) -> list[tuple[str, str]]:
    if isinstance(claim, ImprovementClaim):
        return [("slower", claim.slower), ("faster", claim.faster)]
    if isinstance(claim, MaximumClaim | StatementClaim | ConditionsClaim):
        return [(f"of[{position}]", name) for position, name in enumerate(claim.of)]
    if isinstance(claim, PeakClaim | TotalTimeClaim) and claim.of is not None:
        return [("of", claim.of)]
    return []


def _check_kinds(document: CaseFile, file: str) -> None:
    by_id = {claim.id: claim for claim in document.claims}
    totals = (DurationsClaim, MaximumClaim, TotalTimeClaim)
    for index, claim in enumerate(document.claims):
        any_time = isinstance(claim, ImprovementClaim) or (
            isinstance(claim, StatementClaim) and claim.checks in ("optimal", "within_limits")
        )
        wanted = totals if any_time else totals[:2]
        for field, name in _claim_references(claim):
            if not isinstance(by_id[name], wanted):
                what = "a time" if any_time else "durations"
                raise CaseError(
                    file,
                    f"claims[{index}].{field}",
                    f"{name!r} is a claim of quantity {by_id[name].quantity!r}; "
                    f"name one that states {what}",
                )


def _check_instances(document: CaseFile, file: str, block: InstancesBlock, at: str) -> None:
    by_id = {claim.id: claim for claim in document.claims}
    claim = by_id[block.claim]
    if not isinstance(claim, ImprovementClaim):
        raise CaseError(
            file,
            f"{at}.claim",
            f"{claim.id!r} is a claim of quantity {claim.quantity!r}; name an improvement",
        )
    for side in (by_id[claim.slower], by_id[claim.faster]):
        if side.algorithm is None or (side.problem is None and document.problems):
            raise CaseError(
                file,
                f"{at}.claim",
                f"claim {side.id!r} does not name its problem and its algorithm; add both there",
            )
    if document.robot.dh is None and document.robot.model is None:
        raise CaseError(
            file, f"{at}.id", "way-points are drawn from the robot's workspace; add robot.dh"
        )


def check_claims(
    document: CaseFile, file: str, statement_of: Callable[[AnyClaim], Statement]
) -> None:
    """Check that each claim fits the problem that it speaks about.

    Parameters
    ----------
    document : CaseFile
    file : str
        Name for error messages.
    statement_of : callable
        The problem of a claim under the default reading.

    Raises
    ------
    CaseError
        If a claim names a joint that takes no part, leaves open which motion a peak belongs to,
        or gives a number outside the magnitudes that are computed with.
    """
    for index, claim in enumerate(document.claims):
        statement = statement_of(claim)
        if claim.joint is not None:
            labels = [statement.labels[j] for j in statement.joints]
            if claim.joint not in labels:
                raise statement.fail(
                    f"claims[{index}].joint",
                    f"joint {claim.joint!r} takes no part; the problem has {', '.join(labels)}",
                )
        if isinstance(claim, DurationsClaim | MaximumClaim):
            for segment, duration in enumerate(claim.durations):
                field = f"claims[{index}].durations[{segment}]"
                if duration.fraction == 0:
                    raise statement.fail(field, "is 0; a duration is positive, give its digits")
                statement.si(duration, "time", field)
            if claim.total is not None:
                statement.si(claim.total, "time", f"claims[{index}].total")
        if isinstance(claim, TotalTimeClaim):
            statement.si(claim.value, "time", f"claims[{index}].value")
        if isinstance(claim, PeakClaim):
            _check_peak(document, claim, statement, f"claims[{index}]")
        if isinstance(claim, ControlVerticesClaim):
            _check_vertices(claim, statement, f"claims[{index}].joint_rows")


def motions_of_peak(claims: Iterable[AnyClaim], peak: PeakClaim) -> list[AnyClaim]:
    """The claims of durations whose motion a peak may describe: the one named, or all that fit.

    Parameters
    ----------
    claims : iterable of AnyClaim
        Of the file.
    peak : PeakClaim

    Returns
    -------
    list of AnyClaim
    """
    motions = [c for c in claims if isinstance(c, DurationsClaim | MaximumClaim)]
    if peak.of is not None:
        return [c for c in motions if c.id == peak.of]
    return [
        c
        for c in motions
        if (peak.algorithm is None or c.algorithm == peak.algorithm)
        and c.problem == peak.problem
        and c.joint in (None, peak.joint)
        and c.other_curve is None
    ]


def _check_peak(document: CaseFile, claim: PeakClaim, statement: Statement, at: str) -> None:
    for position, number in enumerate(claim.printed):
        field = f"{at}.value" if claim.values is None else f"{at}.values[{position}]"
        statement.si(number, claim.derivative, field)
    joints = len(statement.labels)
    if claim.values is not None and len(claim.values) != joints:
        raise statement.fail(
            f"{at}.values", f"{len(claim.values)} values for {joints} joints; give one each"
        )
    meant = motions_of_peak(document.claims, claim)
    for motion in meant:
        if motion.problem != claim.problem:
            raise statement.fail(
                f"{at}.of", f"{motion.id!r} is about another problem; name a motion of this one"
            )
    if len(meant) > 1:
        names = ", ".join(repr(c.id) for c in meant[:-1])
        raise statement.fail(
            f"{at}.of",
            f"is missing, and the peak may be that of {names} or {meant[-1].id!r}; "
            f'name the motion, such as of = "{meant[0].id}"',
        )


def _check_vertices(claim: ControlVerticesClaim, statement: Statement, field: str) -> None:
    joints, count = len(statement.labels), statement.waypoints.number
    if len(claim.joint_rows) != joints:
        raise statement.fail(
            field, f"gives {len(claim.joint_rows)} joints, but robot.joints lists {joints}"
        )
    for position, row in enumerate(claim.joint_rows):
        if len(row) != count + 2:
            raise statement.fail(
                f"{field}[{position}]",
                f"{len(row)} control vertices for {count} way-points; give {count + 2}",
            )


def check_kinematics(document: CaseFile, file: str, chain: Chain | None) -> None:
    """Check that joints and positions of the end fit the robot and its way-points.

    Parameters
    ----------
    document : CaseFile
    file : str
        Name for error messages.
    chain : Chain or None
        The robot's chain, if it has one.

    Raises
    ------
    CaseError
        If a joint is unknown or printed twice, or a position belongs to no way-point.
    """
    labels = document.robot.joints if chain is None else chain.labels
    for index, label in enumerate(document.robot.joints):
        if label not in labels:
            raise CaseError(
                file,
                f"robot.joints[{index}]",
                f"joint {label!r} is not in the robot's table; it has {', '.join(labels)}",
            )
    waypoints = document.waypoints
    printed = list(document.robot.joints)
    for index, column in enumerate(document.columns):
        if column.joint is None:
            continue
        field = f"columns[{index}]"
        if column.joint in printed:
            raise CaseError(
                file, f"{field}.joint", f"joint {column.joint!r} is printed twice; keep one"
            )
        if chain is not None and column.joint not in labels:
            raise CaseError(
                file,
                f"{field}.joint",
                f"joint {column.joint!r} is unknown; the robot has {', '.join(labels)}",
            )
        printed.append(column.joint)
        if waypoints is not None and len(column.values) != waypoints.number:
            raise CaseError(
                file,
                f"{field}.values",
                f"{len(column.values)} values for {waypoints.number} way-points; give one each",
            )
    named = [entry.waypoint for entry in document.cartesian]
    for index, name in enumerate(named):
        if name is None and any(named):
            raise CaseError(
                file, f"cartesian[{index}].waypoint", "is missing, others name theirs; add it"
            )
        known = () if waypoints is None else waypoints.labels
        if name is not None and name not in known:
            raise CaseError(
                file,
                f"cartesian[{index}].waypoint",
                f"{name!r} is no label of a way-point; {nearest(name, known)}",
            )
    if named and None in named and waypoints is not None and len(named) != waypoints.number:
        raise CaseError(
            file,
            "cartesian",
            f"{len(named)} positions for {waypoints.number} way-points; "
            "give one each, or name the way-point of each",
        )
