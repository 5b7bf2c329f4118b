"""Rules on the printed digits alone: sums, maxima, percentages, tables that print alike."""

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
from ..explanations import SUM, TABLES
from ..study import Study

_FEWEST = 4
"""Numbers that a table needs before two tables alike are worth a word."""
_SIGNIFICANT = 4
"""Digits that a number needs before its repetition is worth a word."""


def judge_digits(study: Study) -> Iterator[Finding]:
    """Findings of TG101 to TG106."""
    yield from _sums(study)
    yield from _maxima(study)
    yield from _improvements(study)
    yield from _tables_alike(study)
    yield from _same_total(study)
    yield from _repeated_digits(study)


def meet(a: Interval, b: Interval) -> bool:
    """Whether two intervals have a number in common."""
    return a.lower <= b.upper and b.lower <= a.upper


def hull(number: Printed) -> Interval:
    """Every value whose digits, rounded or cut off, are the printed ones."""
    a, b = number.interval, number.truncated
    return Interval(min(a.lower, b.lower), max(a.upper, b.upper))


def _sum(parts: Sequence[Interval]) -> Interval:
    zero = Fraction(0)
    return Interval(sum((p.lower for p in parts), zero), sum((p.upper for p in parts), zero))


def _shown(x: Fraction | float, places: int = 6) -> str:
    return f"{float(x):.{places}g}"


def _range(interval: Interval, places: int = 6) -> str:
    return f"{_shown(interval.lower, places)} to {_shown(interval.upper, places)}"


def _compared(
    rule: str,
    claim: AnyClaim,
    printed: Printed,
    rounded: Interval,
    cut: Interval,
    what: str,
    unit: str,
    root: str,
) -> Finding:
    """A printed number against the interval that its printed ingredients allow."""
    shown, computed = f"{printed} {unit}", f"{_range(rounded)} {unit}"
    verdict, severity = ClaimVerdict.SUPPORTED, Severity.INFO
    if meet(printed.interval, rounded):
        kind = "fits"
        message = f"{what} allows {computed}; printed is {shown}."
    elif meet(printed.truncated, cut):
        severity, kind = Severity.WARNING, "fits cut off"
        message = (
            f"{what} allows {computed} with rounded digits; printed is {shown}, which fits only "
            f"if digits are cut off instead of rounded ({_range(cut)} {unit})."
        )
    else:
        verdict, severity, kind = ClaimVerdict.REFUTED, Severity.ERROR, "does not fit"
        message = f"{what} allows {computed}; printed is {shown}, rounded or cut off."
    return Finding(
        rule=rule,
        severity=severity,
        verdict=verdict,
        basis=Basis.DIGITS,
        claim=claim.id,
        printed=shown,
        computed=computed,
        message=message,
        kind=f"{kind} in {unit}",
        root="" if verdict is ClaimVerdict.SUPPORTED else root,
    )


def _unit(study: Study) -> str:
    return study.case.statement().units.time or "s"


def _sums(study: Study) -> Iterator[Finding]:
    for claim in study.claims:
        if isinstance(claim, DurationsClaim | MaximumClaim) and claim.total is not None:
            yield _compared(
                "TG101",
                claim,
                claim.total,
                _sum([d.interval for d in claim.durations]),
                _sum([d.truncated for d in claim.durations]),
                "The sum of the printed durations",
                _unit(study),
                f"{SUM} {claim.id}",
            )


def _maxima(study: Study) -> Iterator[Finding]:
    for claim in study.claims:
        if not isinstance(claim, MaximumClaim):
            continue
        rows = [study.case.printed_durations(study.case.claim(i)) for i in claim.of]
        wrong = []
        for k, printed in enumerate(claim.durations):
            column = [hull(row[k]) for row in rows if len(row) > k]
            longest = Interval(max(c.lower for c in column), max(c.upper for c in column))
            if not meet(hull(printed), longest):
                wrong.append(f"segment {k + 1}: printed {printed}, longest {_range(longest)}")
        verdict, severity = ClaimVerdict.SUPPORTED, Severity.INFO
        message = f"The printed longest durations are those of the {len(rows)} rows."
        if wrong:
            verdict, severity = ClaimVerdict.REFUTED, Severity.ERROR
            message = "The printed longest durations are not those of the rows: " + "; ".join(wrong)
        yield Finding(
            rule="TG102",
            severity=severity,
            verdict=verdict,
            basis=Basis.DIGITS,
            claim=claim.id,
            printed=", ".join(str(d) for d in claim.durations),
            message=message,
        )


def _total(claim: AnyClaim) -> Printed | None:
    if isinstance(claim, DurationsClaim | MaximumClaim):
        return claim.total
    return claim.value if isinstance(claim, TotalTimeClaim) else None


def _table_total(study: Study, algorithm: str | None, problem: str | None) -> AnyClaim | None:
    """The claim that prints an algorithm's total for all joints in a table."""
    for claim in study.claims:
        same = claim.algorithm == algorithm and claim.problem == problem
        if isinstance(claim, MaximumClaim) and same and claim.total is not None:
            return claim
    return None


def _reduction(slower: Interval, faster: Interval) -> tuple[Interval, Interval]:
    """Difference, and percentage of the slower, that two intervals allow."""
    seconds = Interval(slower.lower - faster.upper, slower.upper - faster.lower)
    low = 100 * (1 - faster.upper / slower.lower)
    return seconds, Interval(low, 100 * (1 - faster.lower / slower.upper))


def _improvements(study: Study) -> Iterator[Finding]:
    for claim in study.claims:
        if not isinstance(claim, ImprovementClaim):
            continue
        slower_claim, faster_claim = (study.case.claim(i) for i in (claim.slower, claim.faster))
        slower, faster = _total(slower_claim), _total(faster_claim)
        if slower is None or faster is None or slower.interval.lower <= 0:
            continue
        between = f"{slower} and {faster} {_unit(study)}"
        seconds, percent = _reduction(slower.interval, faster.interval)
        cut_seconds, cut_percent = _reduction(slower.truncated, faster.truncated)
        for number, rounded, cut, unit in (
            (claim.percent, percent, cut_percent, "%"),
            (claim.seconds, seconds, cut_seconds, _unit(study)),
        ):
            if number is not None:
                what = f"The reduction between the printed totals {between}"
                root = f"improvement {claim.id}"
                yield _compared("TG103", claim, number, rounded, cut, what, unit, root)
        if claim.percent is None and claim.seconds is None:
            yield _unquantified(study, claim, slower, faster, seconds)
        tables = [_table_total(study, c.algorithm, c.problem) for c in (slower_claim, faster_claim)]
        totals = [_total(t) for t in tables if t is not None]
        if claim.percent is not None and len(totals) == 2 and None not in totals:
            yield from _against_tables(study, claim, claim.percent, tables, totals)


def _unquantified(
    study: Study, claim: ImprovementClaim, slower: Printed, faster: Printed, seconds: Interval
) -> Finding:
    unit = _unit(study)
    between = f"{slower} and {faster} {unit}"
    if slower.text == faster.text:
        message = (
            f"The printed totals of the two algorithms are alike, {faster} {unit}: an improvement, "
            f"if any, is below {_shown(seconds.upper)} {unit}."
        )
        verdict, severity = ClaimVerdict.INCONSISTENT, Severity.WARNING
    elif seconds.lower > 0 and not study.posed:
        message = (
            f"The printed totals are {between}, in the order that is claimed; neither can be "
            "computed from the text."
        )
        verdict, severity = ClaimVerdict.NOT_CHECKABLE, Severity.INFO
    elif seconds.lower > 0:
        message = f"The printed totals are {between}."
        verdict, severity = ClaimVerdict.SUPPORTED, Severity.INFO
    elif hull(slower).upper < hull(faster).lower:
        message = f"The printed totals are {between}: the one called better is the longer."
        verdict, severity = ClaimVerdict.REFUTED, Severity.ERROR
    else:
        message = f"The printed totals {between} do not differ by more than their rounding."
        verdict, severity = ClaimVerdict.NOT_CHECKABLE, Severity.INFO
    return Finding(
        rule="TG103",
        severity=severity,
        verdict=verdict,
        basis=Basis.DIGITS,
        claim=claim.id,
        printed=between,
        message=message,
        follows=_doubted(study, [study.case.claim(i) for i in (claim.slower, claim.faster)]),
    )


def _against_tables(
    study: Study,
    claim: ImprovementClaim,
    percent: Printed,
    tables: Sequence[AnyClaim | None],
    totals: Sequence[Printed | None],
) -> Iterator[Finding]:
    slower, faster = totals
    assert slower is not None
    assert faster is not None
    _, allowed = _reduction(hull(slower), hull(faster))
    if meet(hull(percent), allowed):
        return
    where = " and ".join(t.where for t in tables if t is not None)
    yield Finding(
        rule="TG103",
        severity=Severity.ERROR,
        verdict=ClaimVerdict.INCONSISTENT,
        basis=Basis.DIGITS,
        claim=claim.id,
        printed=f"{percent} %",
        computed=f"{_range(allowed, 3)} %",
        message=f"From the totals printed in the tables ({where}: {slower} and {faster}) the "
        f"reduction is {_range(allowed, 3)} %, not {percent} %.",
        follows=_doubted(study, [t for t in tables if t is not None]),
        between=(claim.id, *(t.id for t in tables if t is not None)),
    )


def _alike(case: Case) -> Iterator[tuple[Table, Table]]:
    """Tables of different algorithms whose numbers are the same, digit by digit."""
    for first, second in combinations(case.tables, 2):
        rows = [case.table_claims(t.id) for t in (first, second)]
        if first.algorithm == second.algorithm or not rows[0] or len(rows[0]) != len(rows[1]):
            continue
        printed = [[_all_digits(claim) for claim in table] for table in rows]
        if sum(len(row) for row in printed[0]) >= _FEWEST and printed[0] == printed[1]:
            yield first, second


def _doubted(study: Study, claims: Iterable[AnyClaim]) -> tuple[str, ...]:
    """Roots of the tables alike that print one of the claims."""
    tables = {claim.table for claim in claims} - {None}
    return tuple(
        f"{TABLES} {first.id} {second.id}"
        for first, second in _alike(study.case)
        if tables & {first.id, second.id}
    )


def _tables_alike(study: Study) -> Iterator[Finding]:
    case = study.case
    for first, second in _alike(case):
        rows = [case.table_claims(t.id) for t in (first, second)]
        count = sum(len(_all_digits(claim)) for claim in rows[0])
        apart = any(
            {case.claim(c.slower).algorithm, case.claim(c.faster).algorithm}
            == {first.algorithm, second.algorithm}
            for c in case.claims
            if isinstance(c, ImprovementClaim)
        )
        message = (
            f"{first.where} ({first.title}) and {second.where} ({second.title}) agree in all "
            f"{count} numbers, digit by digit"
        )
        message += "; elsewhere the two results differ." if apart else "."
        yield Finding(
            rule="TG104",
            severity=Severity.ERROR if apart else Severity.WARNING,
            verdict=ClaimVerdict.INCONSISTENT,
            basis=Basis.DIGITS,
            message=message,
            root=f"{TABLES} {first.id} {second.id}",
            between=tuple(
                c.id
                for c in case.claims
                if apart and {first.id, second.id} & {c.table, *c.printed_tables}
            ),
        )


def _all_digits(claim: AnyClaim) -> tuple[str, ...]:
    if isinstance(claim, DurationsClaim | MaximumClaim):
        total = () if claim.total is None else (claim.total.text,)
        return tuple(d.text for d in claim.durations) + total
    return ()


def _same_total(study: Study) -> Iterator[Finding]:
    for claim in study.claims:
        if not isinstance(claim, TotalTimeClaim) or claim.algorithm is None:
            continue
        table = _table_total(study, claim.algorithm, claim.problem)
        total = None if table is None else _total(table)
        if table is None or total is None:
            continue
        agree = meet(hull(claim.value), hull(total))
        unit = _unit(study)
        yield Finding(
            rule="TG105",
            severity=Severity.INFO if agree else Severity.ERROR,
            verdict=ClaimVerdict.SUPPORTED if agree else ClaimVerdict.INCONSISTENT,
            basis=Basis.DIGITS,
            claim=claim.id,
            printed=f"{claim.value} {unit}",
            computed=f"{total} {unit}",
            message=f"{claim.where} prints {claim.value} {unit} and {table.where} prints {total} "
            f"{unit} for the same total ({claim.algorithm}).",
            follows=() if agree else _doubted(study, [table]),
            between=() if agree else (claim.id, table.id),
        )


def _significant(number: Printed) -> str:
    return number.text.lstrip("+-").replace(".", "").lstrip("0")


def _repeated_digits(study: Study) -> Iterator[Finding]:
    """Way-point digits that stand in another printed column too."""
    case = study.case
    posing = case.statement()
    for j, label in zip(posing.joints, posing.labels, strict=False):
        entries = [row[j] for row in posing.waypoints.points]
        for group in _column_groups([*case.columns, *case.cartesian]):
            where, values = group
            repeated = [
                w.text
                for w in entries
                if len(_significant(w)) >= _SIGNIFICANT
                and any(v.text.lstrip("+-") == w.text.lstrip("+-") for v in values)
            ]
            if len(repeated) >= 2:
                yield Finding(
                    rule="TG106",
                    severity=Severity.WARNING,
                    basis=Basis.DIGITS,
                    decides=False,
                    printed=", ".join(repeated),
                    message=f"{len(repeated)} of the {len(entries)} way-points of joint {label} "
                    f"({posing.waypoints.where}: {', '.join(repeated)}) repeat digits of {where}, "
                    "a quantity of another kind. The digits alone do not say which column, "
                    "if any, is meant otherwise.",
                )


def _column_groups(columns: Sequence[object]) -> list[tuple[str, list[Printed]]]:
    """Columns of one table together, since a table's rows are given one by one."""
    groups: dict[str, list[Printed]] = {}
    for column in columns:
        where = str(getattr(column, "where", "")).split(",")[0]
        groups.setdefault(where, []).extend(getattr(column, "values", ()))
    return list(groups.items())
