"""TG104 and TG105: tables with the same numbers, and one total that is printed in two places."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from fractions import Fraction
from itertools import combinations

from ....problem import Case, Interval, Printed
from ....problem.cases import (
    AnyClaim,
    DurationsClaim,
    ImprovementClaim,
    MaximumClaim,
    Table,
    TotalTimeClaim,
)
from ...documents import Basis, ClaimVerdict, Finding, Severity
from ..printed_row import PrintedRow, rows_under
from ..rounding import either, hull, meet
from ..stated import RowClaim, printed_total
from ..study import Study
from ..words import TABLES
from .printed_digits import end_blends, raised, summed
from .rule_group import Explained, rule_group

_Timed = RowClaim | TotalTimeClaim
"""Claims that state a total, or durations of which it is the sum."""


TG104 = Explained(
    "TG104",
    "Tables under different names print different digits",
    "Do two tables of different algorithms print the same numbers, digit by digit?",
    "Inconsistent, with severity error, if the paper says elsewhere that the two results "
    "differ; otherwise information. Two algorithms that both find the optimum print the same "
    "numbers; the report says so if that explains it.",
    "Table 2 (standard algorithm) and Table 3 (improved algorithm) agree in all 28 "
    "numbers, yet the abstract says that the improved one is 10 % faster.",
    basis=Basis.DIGITS,
)
TG105 = Explained(
    "TG105",
    "Two places that print the same total agree",
    "If one total is printed in two places, do the two agree?",
    "Inconsistent if no value rounds to both; the audit does not choose between them. "
    "Totals that the file distinguishes by method, curve, table or improvement are not "
    "compared.",
    "The abstract prints 3.9 s and the table 3.52 s for the same motion.",
    basis=Basis.DIGITS,
)


@rule_group(TG104, TG105, without_waypoints=True)
def judge_tables(study: Study) -> Iterator[Finding]:
    """Findings of TG104 and TG105."""
    yield from _tables_alike(study)
    yield from _same_total(study)


def _alike(case: Case) -> Iterator[tuple[Table, Table]]:
    """Tables of different algorithms whose numbers are the same, digit by digit."""
    for first, second in combinations(case.tables, 2):
        rows = [case.table_claims(t.id) for t in (first, second)]
        if first.algorithm == second.algorithm or not rows[0] or len(rows[0]) != len(rows[1]):
            continue
        printed = [[_all_digits(claim) for claim in table] for table in rows]
        # Fewer than four numbers may be alike by chance.
        if sum(len(row) for row in printed[0]) >= 4 and printed[0] == printed[1]:
            yield first, second


def doubted(study: Study, claims: Iterable[AnyClaim]) -> tuple[str, ...]:
    """Roots of the tables alike that print one of the claims."""
    tables = {claim.table for claim in claims} - {None}
    return tuple(
        f"{TABLES} {first.id} {second.id}"
        for first, second in _alike(study.case)
        if tables & {first.id, second.id}
    )


def contradicted(study: Study, claims: Iterable[AnyClaim]) -> bool:
    """Whether a table that prints one of the claims equals another that is said to differ."""
    tables = {claim.table for claim in claims} - {None}
    return any(
        tables & {first.id, second.id} and _apart(study.case, first, second)
        for first, second in _alike(study.case)
    )


def _apart(case: Case, first: Table, second: Table) -> bool:
    """Whether the paper elsewhere prints that the results of two tables differ."""
    for claim in case.claims:
        if not isinstance(claim, ImprovementClaim):
            continue
        sides = [case.claim(i) for i in (claim.slower, claim.faster)]
        if {side.algorithm for side in sides} != {first.algorithm, second.algorithm}:
            continue
        printed = [n for n in (claim.percent, claim.seconds) if n is not None]
        if any(hull(number).lower > 0 for number in printed):
            return True
        slower, faster = (printed_total(side) for side in sides)
        if slower is not None and faster is not None and not meet(hull(slower), hull(faster)):
            return True
    return False


def _at_optimum(study: Study, claims: Iterable[AnyClaim]) -> str | None:
    """A reading under which every printed total of claims is the optimum, within rounding."""
    printed = list(claims)
    rows: list[AnyClaim] = [c for c in printed if isinstance(c, DurationsClaim)]
    rows = rows or [c for c in printed if isinstance(c, MaximumClaim)]
    for reading in study.readings:
        posed = rows_under(study, rows, reading)
        if {row.claim.id for row in posed} == {c.id for c in rows} and all(map(_is_optimum, posed)):
            return reading
    return None


def _is_optimum(row: PrintedRow[AnyClaim]) -> bool:
    total = row.total
    solution = row.optimum
    if total is None or not solution.found or solution.infimum is not None:
        return False
    reached = row.reachable(solution.durations)
    spread = 0.0 if reached is None else max(reached - solution.best, 0.0)
    low, high = total.interval
    return low - spread <= solution.best <= high + spread


def _tables_alike(study: Study) -> Iterator[Finding]:
    case = study.case
    for first, second in _alike(case):
        rows = [case.table_claims(t.id) for t in (first, second)]
        count = sum(len(_all_digits(claim)) for claim in rows[0])
        apart = _apart(case, first, second)
        optimal = None if apart else _at_optimum(study, rows[0])
        besides = "; elsewhere the two results differ" if apart else ""
        explained = (
            f"Their totals are the optimum within rounding (reading {optimal}), which explains the "
            f"agreement: "
            "two algorithms that both find the optimum print the same numbers."
        )
        yield TG104.finding(
            None,
            "differ elsewhere" if apart else "optimum" if optimal else "alike",
            f"{first.where} ({first.title}) and {second.where} ({second.title}) agree in all "
            f"{count} numbers, digit by digit{besides}.",
            explained if optimal is not None else "",
            severity=Severity.ERROR if apart else Severity.INFO if optimal else Severity.WARNING,
            verdict=ClaimVerdict.NOT_CHECKABLE if optimal else ClaimVerdict.INCONSISTENT,
            basis=Basis.OPTIMUM if optimal else Basis.DIGITS,
            root=f"{TABLES} {first.id} {second.id}",
            between=tuple(
                c.id
                for c in case.claims
                if apart and {first.id, second.id} & {c.table, *c.printed_tables}
            ),
        )


def _all_digits(claim: AnyClaim) -> tuple[str, ...]:
    if isinstance(claim, RowClaim):
        total = () if claim.total is None else (claim.total.text,)
        return tuple(d.text for d in claim.durations) + total
    return ()


def _whose(study: Study, claim: AnyClaim) -> str | None:
    """The joint of a claim; None for all joints, and for the only joint."""
    return claim.joint if len(study.case.robot.joints) > 1 else None


def _named(claim: AnyClaim) -> str:
    """The claim whose total a claim states: its own id unless it repeats another's."""
    return (claim.of if isinstance(claim, TotalTimeClaim) else None) or claim.id


def _kept_apart(study: Study, claim: TotalTimeClaim, other: _Timed) -> bool:
    """Whether the file itself says that two totals are of two motions.

    They are of different problems, joints, curves, states, objectives, methods or tables, or an
    improvement leads from one to the other. What repeats another claim's total has that claim's
    curve, state and objective where it names none.
    """
    case = study.case
    only, keys = case.problems[0].id, ("other_curve", "state", "objective")
    pairs = [
        (claim.problem or only, other.problem or only),
        (_whose(study, claim), _whose(study, other)),
        *((getattr(claim, key), getattr(other, key)) for key in keys),
    ]
    repeats = claim.of == other.id
    if any(a != b and not (repeats and a is None) for a, b in pairs):
        return True
    both = [(claim.algorithm, other.algorithm), (claim.coupling, other.coupling)]
    if not repeats and other.table not in claim.printed_tables:
        both.append((claim.table, other.table))
    if any(None not in pair and pair[0] != pair[1] for pair in both):
        return True
    ends = {_named(claim), _named(other)}
    return len(ends) > 1 and any(
        {_named(case.claim(c.slower)), _named(case.claim(c.faster))} == ends
        for c in case.claims
        if isinstance(c, ImprovementClaim)
    )


def printed_alike(
    study: Study, claim: TotalTimeClaim
) -> tuple[Sequence[AnyClaim], Severity | None]:
    """Claims that print the same total, and what it weighs if they differ.

    An error where the file says that they are one total, a warning where nothing else is printed
    that it could be; None if the text leaves open whether they are one.
    """
    alike: list[AnyClaim] = [
        c
        for c in study.case.claims
        if isinstance(c, _Timed) and c.id != claim.id and not _kept_apart(study, claim, c)
    ]
    if claim.of is not None:
        return [c for c in alike if c.id == claim.of], Severity.ERROR
    said = [c for c in alike if c.table is not None and c.table in claim.printed_tables]
    named = [c for c in alike if claim.algorithm is not None and c.algorithm == claim.algorithm]
    for meant, weight in ((said, Severity.ERROR), (named, Severity.WARNING)):
        for kind in (MaximumClaim, DurationsClaim, TotalTimeClaim):
            found = [c for c in meant if isinstance(c, kind)]
            if found:
                return found, weight
    # Where no method tells, one set of durations is meant if there is only one; a total of a
    # named method is another one than that of durations that name none, and may be the other
    # way round.
    tables = [c for c in alike if not isinstance(c, TotalTimeClaim)]
    if len(tables) != 1 or claim.algorithm is not None:
        return [], None
    return tables, Severity.WARNING if tables[0].algorithm is None else None


def total_allowed(study: Study, claim: AnyClaim) -> Interval:
    """What the digits of a total allow, rounded or cut off, in the unit of time of the file.

    A printed total may be the sum of printed digits, so what its parts allow is allowed too.
    """
    printed = printed_total(claim)
    parts = study.case.printed_durations(claim)
    whole = summed((hull(p), Fraction(1)) for p in parts)
    halves = summed((hull(p), Fraction(1, 2)) for p in end_blends(study, claim) or ())
    whole = Interval(whole.lower, whole.upper + halves.upper)
    if printed is None:
        return whole
    own = hull(printed)
    return either(own, whole) if parts and meet(own, whole) else own


def _total_shown(study: Study, claim: AnyClaim) -> str:
    """A total as printed or as the sum of its parts."""
    note = "" if printed_total(claim) is not None else " (sum of its durations)"
    return f"{study.total_digits(claim)}{note}"


def _agrees(study: Study, value: Printed, other: AnyClaim) -> bool:
    """Whether a total is that of another claim: rounded or cut off, or the coarser rounded up."""
    allowed, printed = total_allowed(study, other), printed_total(other)
    parts = study.case.printed_durations(other) if printed is None else (printed,)
    up = summed((raised(p), Fraction(1)) for p in parts)
    unit = max(p.unit for p in parts)
    return (
        meet(hull(value), allowed)
        or (value.unit > unit and meet(raised(value), allowed))
        or (value.unit < unit and meet(hull(value), up))
    )


def _same_total(study: Study) -> Iterator[Finding]:
    for claim in study.claims:
        if not isinstance(claim, TotalTimeClaim):
            continue
        found, weight = printed_alike(study, claim)
        agreeing = [c for c in found if _agrees(study, claim.value, c)]
        # A total may count end blends by half, and how long they take is not always printed.
        others = agreeing or [c for c in found if end_blends(study, c) is not None]
        if not others:
            if claim.algorithm is not None and not found:
                yield TG105.finding(
                    claim,
                    "printed once",
                    "This total of a named method is printed only once, so nothing printed can "
                    "contradict it.",
                    printed=str(claim.value),
                )
            continue
        other = others[0]
        shown = _total_shown(study, other)
        printed = f"{claim.value} {study.time_unit}"
        whose = "" if claim.algorithm is None else f" ({study.called(claim.algorithm)})"
        message = f"{claim.where} prints {printed} and {other.where} prints {shown} for the same "
        message += f"total{whose}."
        verdict, severity, kind = ClaimVerdict.SUPPORTED, Severity.INFO, "same total"
        # Two totals by themselves may be a mean and a best: nothing says that they are one.
        alone = isinstance(other, TotalTimeClaim) or weight is None
        if not agreeing and (len(others) > 1 or alone):
            verdict, kind = ClaimVerdict.NOT_CHECKABLE, "none of them"
            places = "; ".join(f"{c.where}: {_total_shown(study, c)}" for c in others)
            message = (
                f"{claim.where} prints {printed}, which differs from all totals printed elsewhere "
                f"({places}); the text does not say that it is one of them."
            )
        elif not agreeing and weight is not None:
            verdict, severity = ClaimVerdict.INCONSISTENT, weight
        clash = verdict is ClaimVerdict.INCONSISTENT
        yield TG105.finding(
            claim,
            kind,
            message,
            severity=severity,
            verdict=verdict,
            printed=printed,
            computed=shown,
            follows=doubted(study, [other]) if clash else (),
            between=(claim.id, other.id) if clash else (),
        )
