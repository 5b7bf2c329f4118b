"""Errors of an audit as one plain sentence each, built from the claims' own words and places."""

from __future__ import annotations

from collections.abc import Collection, Sequence

from ...problem import Case, shown_bound
from ...problem.cases import (
    AnyClaim,
    ImprovementClaim,
    PeakClaim,
    ProfiledClaim,
    StatementClaim,
    TotalTimeClaim,
)
from ..documents import (
    Cause,
    ClaimVerdict,
    Finding,
    Gap,
    Severity,
    among,
    at_least_percent,
    capital,
    quoted,
)
from .named_profiles import profile_called
from .stated import RowClaim, at_place, place
from .words import NO_PROFILE, TABLES


def plainly(
    case: Case,
    cause: Cause,
    far: Collection[str] = (),
    *,
    also: Sequence[Cause] = (),
    brief: bool = False,
) -> tuple[str, ...]:
    """A cause as one plain sentence, or in the words of its finding.

    Parameters
    ----------
    far : collection of str
        Readings that are implausible.
    also : sequence of Cause
        Others that say the same of other claims: one sentence names all their places.
    brief : bool
        Whether a warning is as short as an error: where it speaks against the claim.

    Returns
    -------
    tuple of str
        By claims' texts and places, never by ids. What holds under some readings alone says so.
    """
    (first, *others), named = _plain(case, cause, far, also, brief)
    count, every = len(cause.readings), len(case.readings)
    if named or not 0 < count < every:
        return first, *others
    which = among(cause.readings, every, far)
    if count == 1:
        mark = "the implausible " if cause.readings[0] in far else ""
        which = f"{mark}{quoted(cause.readings[0], case.labels)}"
    return f"Under {which}: {first}", *others


def _plain(
    case: Case, cause: Cause, far: Collection[str], also: Sequence[Cause], brief: bool
) -> tuple[tuple[str, ...], bool]:
    """The sentences, and whether they name the readings."""
    head, claim = cause.head, case.claim(cause.claim) if cause.claim else None
    if head is not None and head.root.startswith(f"{TABLES} "):
        return (_tables_alike(case, cause, head.root.split(" ")[1:]),), False
    own = (cause.says,) if head is None else head.sentences
    if claim is None or head is None:
        return own[:1], False
    if cause.severity is not Severity.ERROR and cause.rule != "TG201" and not brief:
        # A warning proves nothing: it keeps its own words.
        return own, False
    if cause.rule == "TG302":
        said, named = _not_optimal(case, head, cause, far)
        return (f"Called optimal in {_places(claim, also, case)}, but {said}.",), named
    where = _places(claim, also, case)
    there = f"{at_place(where)}, the printed"
    percent = isinstance(claim, ImprovementClaim) and claim.percent is not None
    claimed = "the reduction" if percent else "the saving"
    others = [place(case.claim(one)) for one in head.between if one != head.claim]
    other = others[0] if others else "another place"
    printed, computed = head.printed or "", head.computed or ""
    sentence = {
        "TG101": f"{at_place(where)}, the durations add up to {computed}, but the printed total is "
        f"{printed}",
        "TG102": f"The longest durations {at_place(where)} do not follow from its rows",
        "TG103": f"From the printed totals {claimed} would be {computed}, not {printed}",
        "TG105": f"{place(claim)} prints {printed} for a total that {other} gives as {computed}",
        "TG107": f"The curve of {where} has {computed}{f', not {printed}' if printed else ''}",
        "TG109": f"{where} prints {printed}, but the curve has {computed}",
        "TG201": f"The total {at_place(where)} is shorter than any motion within the limits"
        if isinstance(claim, TotalTimeClaim)
        else f"The durations {at_place(where)} break a limit"
        + (", unless digits were cut off" if head.verdict is ClaimVerdict.SUPPORTED else ""),
        "TG202": f"The motion of {where} is not continuous",
        "TG203": f"{there} peak is {printed}, but the printed durations give {computed}"
        if isinstance(claim, PeakClaim) and len(claim.printed) == 1
        else f"Printed peaks do not follow from the printed durations ({where})",
        "TG208": f"A printed mean or integral does not follow from the printed durations ({where})",
        "TG209": f"A printed peak exceeds its printed limit, although {where} says that the limit "
        "is kept",
        "TG210": f"The durations {at_place(where)} break a limit",
        "TG211": f"A printed value does not follow from the printed durations ({where})",
        "TG205": f"Control vertices {at_place(where)} do not follow from the way-points",
        "TG301": "The two printed times do not scale with their velocity limits, as shortest "
        "times do",
        "TG304": f"{there} total is {printed}, but the {profile_called([str(claim.profile)])} "
        f"takes {computed}"
        if isinstance(claim, TotalTimeClaim)
        else f"A printed number does not follow from its profile ({where})",
        "TG305": f"{at_place(where)}, {printed} is called the shortest along a path whose shortest "
        f"time is {computed}",
        "TG601": "Printed joint angles and positions do not fit the printed robot",
    }.get(cause.rule)
    if head.kind == NO_PROFILE:
        plateau = f" of {claim.plateau}" if isinstance(claim, ProfiledClaim) else ""
        said = (
            f"{capital(at_place(where))}, no profile was found with the printed plateau{plateau}."
        )
        return (said, *own[1:]), False
    if cause.rule == "TG103" and not computed:
        sentence = f"Of {printed}, {where} calls the longer total the better one"
    return (own[:1] if sentence is None else (f"{capital(sentence)}.",)), False


def _places(claim: AnyClaim, also: Sequence[Cause], case: Case) -> str:
    """Where a claim and those of other causes stand."""
    claims = [claim, *(case.claim(one.claim) for one in also if one.claim)]
    return " and ".join(dict.fromkeys(map(place, claims)))


def _not_optimal(case: Case, head: Finding, cause: Cause, far: Collection[str]) -> tuple[str, bool]:
    """Why a time is not the shortest, and how much longer it is under every reading, if it is.

    Beside it whether it says under which readings.
    """
    if head.kind == "breaks":
        return "the motion breaks a limit", False
    readings, every = cause.readings, len(case.readings)
    if not isinstance(head.gap, Gap):
        if cause.elsewhere:
            return f"under every reading a faster motion exists or {cause.elsewhere}", True
        where = f"under {among(readings, every, far)} " if 0 < len(readings) < every else ""
        return f"{where}a faster motion on the same curve keeps the limits", bool(where)
    # Rounded down, for it is a bound: way-points that round to the digits allow other optima.
    share = f"{at_least_percent(head.gap.lowest)} longer than"
    if head.gap.many_times:
        share = f"{shown_bound(1 + head.gap.lowest, 'lower', places=1)} times as long as"
    return f"{_whose(case, head)}at least {share} a motion within the limits", False


def _whose(case: Case, head: Finding) -> str:
    """Whose total lies farthest from a motion that is shorter, where several are called optimal."""
    statement = case.claim(head.claim) if head.claim else None
    if not head.farthest or not isinstance(statement, StatementClaim) or len(statement.of) < 2:
        return ""
    claim = case.claim(head.farthest)
    if claim.joint is not None and len(case.robot.joints) > 1:
        return f"joint {claim.joint} alone takes "
    return f"{place(claim)} is "


def _tables_alike(case: Case, cause: Cause, tables: Sequence[str]) -> str:
    names = {t.id: t.where for t in case.tables}
    places = [names.get(one, one) for one in tables]
    heads = [p.partition(" ") for p in places]
    shown = " and ".join(places)
    if len({h for h, _, _ in heads}) == 1 and all(tail for _, _, tail in heads):
        shown = f"{heads[0][0]}s {' and '.join(tail for _, _, tail in heads)}"
    numbers = sum(
        len(c.durations) + (c.total is not None)
        for c in case.table_claims(tables[0])
        if isinstance(c, RowClaim)
    )
    said = f"{shown} print the same {numbers} numbers"
    hit = [case.claim(one.claim) for one in cause.consequences if one.claim]
    counted = [c for c in hit if isinstance(c, ImprovementClaim) and c.percent is not None]
    if counted:
        return f"{said}, so the claimed {counted[0].percent} % cannot follow from them."
    return f"{said}, though they are said to differ."
