"""Rules on the printed digits alone: sums, maxima, columns that repeat, rows of another length."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from fractions import Fraction

from ....problem import Interval, Printed
from ....problem.cases import AnyClaim, DurationsClaim, MaximumClaim
from ...documents import Basis, ClaimVerdict, Finding, Severity, ranged
from ..rounding import Agreement, agreement, either, hull, meet
from ..stated import RowClaim
from ..study import Study
from ..words import SUM
from .rule_group import ON_DIGITS, Explained, rule_group

TG101 = Explained(
    "TG101",
    "A printed total is the sum of its printed parts",
    "Do the printed durations of the segments add up to the printed total? Every printed "
    "number is taken as rounded to its digits.",
    "Supported if some values that round to the digits add up to the total; refuted, with "
    "severity error, if none do. " + ON_DIGITS,
    "The durations 1.20, 0.85 and 1.10 s add up to between 3.135 and 3.165 s. A printed "
    "total of 3.15 s is supported, 3.51 s is refuted, and the report says that two "
    "exchanged digits would explain it.",
    basis=Basis.DIGITS,
)
TG102 = Explained(
    "TG102",
    "Printed longest durations are the longest of the printed rows",
    "If the joints share the longest duration of each segment, are these printed durations "
    "the longest in the rows of the joints?",
    "Supported if they are; otherwise refuted, naming each segment that differs.",
    "Joint 1 prints 0.90 and 1.30 s, joint 2 prints 1.10 and 1.20 s. The longest are 1.10 "
    "and 1.30 s; 1.10 and 1.20 s would be refuted.",
    basis=Basis.DIGITS,
)
TG106 = Explained(
    "TG106",
    "Unrelated columns do not repeat each other's digits",
    "Do way-points repeat the digits of an unrelated column, such as lengths of links?",
    "A warning: the digits alone do not show which column, if either, is wrong. No claim is "
    "judged by it.",
    "Three of four angles of joint 2 print the digits of the link offsets: 0.4318, 0.1501, 0.4331.",
    basis=Basis.DIGITS,
    decides=False,
)
TG109 = Explained(
    "TG109",
    "As many durations are printed as there are segments",
    "Are as many durations printed as the curve has segments?",
    "A warning if not: no motion can be built from them. A slip in the case file has the same "
    "effect, so rule that out first.",
    "Five way-points make four segments, and the table prints three durations.",
    basis=Basis.COUNT,
)


@rule_group(TG101, TG102, TG106, TG109, without_waypoints=True)
def judge_digits(study: Study) -> Iterator[Finding]:
    """Findings of TG101, TG102, TG106 and TG109."""
    yield from _sums(study)
    yield from _maxima(study)
    yield from _lengths(study)
    yield from _repeated_digits(study)


def raised(number: Printed) -> Interval:
    """Every value that gives the printed digits if what is left over is rounded up, not off.

    Times are often printed so, for a longer motion keeps the limits too.
    """
    return Interval(number.fraction - number.unit, number.fraction)


def summed(parts: Iterable[tuple[Interval, Fraction]]) -> Interval:
    """The sum of shares of intervals."""
    lower = upper = Fraction(0)
    for part, share in parts:
        lower, upper = lower + part.lower * share, upper + part.upper * share
    return Interval(lower, upper)


def shown(x: Fraction | float, places: int = 6) -> str:
    """A number with this many significant digits."""
    return f"{float(x):.{places}g}"


def span(interval: Interval, places: int = 6) -> str:
    """Both ends of an interval, to this many digits; one number if they print alike."""
    return ranged(float(interval.lower), float(interval.upper), f".{places}g")


_KINDS = {
    Agreement.ROUNDING: "fits",
    Agreement.CUT_OFF: "fits cut off",
    Agreement.MIXED: "fits mixed",
    Agreement.RAISED: "fits rounded up",
    Agreement.RAISED_PARTS: "fits raised parts",
    Agreement.OFF: "does not fit",
}
"""Kinds of findings on digits."""


def compared(
    rule: Explained,
    claim: AnyClaim,
    printed: Printed,
    rounded: Interval,
    cut: Interval,
    what: str,
    unit: str,
    root: str,
    plain: str = "",
    mixed: Interval | None = None,
    coarser: bool = False,
    raised_parts: Interval | None = None,
) -> Finding:
    """A printed number against the interval that its printed ingredients allow.

    ``plain`` is what the digits as printed give, shown where the printed number is another;
    ``mixed`` is what the ingredients allow, each rounded or cut off, if that is more than both;
    ``coarser`` says that the number has fewer digits than they, and may have been rounded up;
    ``raised_parts`` is what they allow if each of them was rounded up, where that is usual.
    """
    digits, computed = f"{printed} {unit}", f"{span(rounded)} {unit}"
    whole = either(either(rounded, cut), mixed or rounded)
    up = raised(printed)
    # A longer time keeps the limits too; nothing is gained by a larger percentage.
    own = (printed.interval,) if unit == "%" else (printed.interval, up)
    kind = agreement(
        (Agreement.ROUNDING, printed.interval, rounded),
        (Agreement.CUT_OFF, printed.truncated, cut),
        (Agreement.MIXED, hull(printed), whole),
        *([(Agreement.RAISED, up, whole)] if coarser else []),
        *((Agreement.RAISED_PARTS, one, raised_parts) for one in own if raised_parts),
    )
    verdict, severity = ClaimVerdict.SUPPORTED, Severity.WARNING
    if kind is Agreement.OFF:
        verdict, severity = ClaimVerdict.REFUTED, Severity.ERROR
        message = (
            f"{what} allows {computed}, but the printed value is {digits}, however it was rounded."
        )
    elif kind is not Agreement.ROUNDING:
        if_only, allowed = {
            Agreement.CUT_OFF: ("digits are cut off instead of rounded", cut),
            Agreement.MIXED: ("some digits are rounded and others cut off", whole),
            Agreement.RAISED: ("it was rounded up", whole),
            Agreement.RAISED_PARTS: ("parts were rounded up", raised_parts or whole),
        }[kind]
        message = (
            f"{what} allows {computed} with rounded digits; the printed {digits} fits only if "
            f"{if_only} ({span(allowed)} {unit})."
        )
    else:
        severity = Severity.INFO
        message = f"{what} allows {computed}; the printed value is {digits}."
        if plain and plain != printed.text:
            message = (
                f"{what} is {plain} {unit} digit by digit, and {computed} for all values that "
                f"round to the digits; rounding explains the printed {digits}."
            )
    return rule.finding(
        claim,
        f"{_KINDS[kind]} in {unit}",
        message,
        severity=severity,
        verdict=verdict,
        printed=digits,
        computed=computed,
        root="" if verdict is ClaimVerdict.SUPPORTED else root,
    )


def _sums(study: Study) -> Iterator[Finding]:
    for claim in study.claims:
        if not isinstance(claim, RowClaim) or claim.total is None:
            continue
        found = _sum_beside(study, claim, claim.total, (), "The sum of the printed durations")
        if found.verdict is ClaimVerdict.REFUTED:
            # Blends at the ends may reach half beyond the durations, and be counted or not.
            ends = end_blends(study, claim)
            if ends is None:
                continue
            if ends:
                what = "The sum of the printed durations and of half the first and the last blend"
                wider = _sum_beside(study, claim, claim.total, ends, what)
                found = found if wider.verdict is ClaimVerdict.REFUTED else wider
        yield found


def end_blends(study: Study, claim: AnyClaim) -> tuple[Printed, ...] | None:
    """The first and the last blend of a row, which its total may count by half.

    Empty if there are none; None if they are not printed as durations, or where a claim takes
    the longest of several rows with blends.
    """
    if isinstance(claim, MaximumClaim):
        rows = [study.case.claim(one) for one in claim.of]
        return None if any(end_blends(study, row) != () for row in rows) else ()
    if not isinstance(claim, DurationsClaim):
        return ()
    if claim.blends is not None:
        each = claim.blends if isinstance(claim.blends, tuple) else (claim.blends,)
        return each[0], each[-1]
    return () if claim.blend_acceleration is None else None


def _sum_beside(
    study: Study, claim: RowClaim, total: Printed, halves: Sequence[Printed], what: str
) -> Finding:
    """A printed total beside the sum of its durations and of half of some further ones."""
    parts = [(d, Fraction(1)) for d in claim.durations] + [(d, Fraction(1, 2)) for d in halves]
    plain = sum((d.fraction * share for d, share in parts), Fraction(0))
    return compared(
        TG101,
        claim,
        total,
        summed((d.interval, share) for d, share in parts),
        summed((d.truncated, share) for d, share in parts),
        what,
        study.time_unit,
        f"{SUM} {claim.id}",
        shown(plain) if halves else str(sum(d.decimal for d in claim.durations)),
        coarser=total.unit > max(d.unit for d, _ in parts),
        raised_parts=summed((raised(d), share) for d, share in parts),
    )


def _lengths(study: Study) -> Iterator[Finding]:
    """Rows of another length than the motion has segments; a slip in the case file looks alike."""
    for claim in study.claims:
        if not isinstance(claim, RowClaim) or claim.other_curve is not None:
            continue
        for rid in study.readings:
            segments = study.case.statement(claim.problem, rid).curve().segments
            if len(claim.durations) == segments:
                continue
            count = _many(len(claim.durations), "duration")
            yield TG109.finding(
                claim,
                "other length",
                f"{claim.where} prints {count}, but the curve through the way-points has "
                f"{_many(segments, 'segment')}, so no motion can be built from them.",
                "If the paper prints another number, correct the case file.",
                verdict=ClaimVerdict.INCONSISTENT,
                reading=rid,
                printed=count,
                computed=_many(segments, "segment"),
            )


def _many(count: int, word: str) -> str:
    return f"{count} {word}{'s' * (count != 1)}"


def _maxima(study: Study) -> Iterator[Finding]:
    for claim in study.claims:
        if not isinstance(claim, MaximumClaim):
            continue
        rows = [study.case.printed_durations(study.case.claim(i)) for i in claim.of]
        wrong = []
        for k, printed in enumerate(claim.durations):
            cells = [row[k] for row in rows if len(row) > k]
            column = [hull(one) for one in cells]
            longest = Interval(max(c.lower for c in column), max(c.upper for c in column))
            coarser = printed.unit > max(one.unit for one in cells)
            if not (meet(hull(printed), longest) or (coarser and meet(raised(printed), longest))):
                wrong.append(f"segment {k + 1}: printed {printed}, longest {span(longest)}")
        message = f"The printed longest durations follow from the {len(rows)} rows."
        if wrong:
            listed = "; ".join(wrong)
            message = f"The printed longest durations do not follow from the rows: {listed}"
        yield TG102.finding(
            claim,
            "others" if wrong else "longest",
            message,
            verdict=ClaimVerdict.REFUTED if wrong else ClaimVerdict.SUPPORTED,
            printed=", ".join(str(d) for d in claim.durations),
        )


def _repeated_digits(study: Study) -> Iterator[Finding]:
    """Way-point digits that stand in another printed column too."""
    case = study.case
    statement = case.statement()
    for j, label in zip(statement.joints, statement.labels, strict=False):
        entries = [row[j] for row in statement.waypoints.points]
        for where, values in _column_groups([*case.columns, *case.cartesian]):
            others = {v.text.lstrip("+-") for v in values}
            same = [w for w in entries if w.text.lstrip("+-") in others]
            # Fewer than four digits repeat by chance.
            repeated = [
                w.text for w in same if len(w.text.lstrip("+-").replace(".", "").lstrip("0")) >= 4
            ]
            if len(repeated) >= 2:
                yield TG106.finding(
                    None,
                    "repeated digits",
                    f"{len(repeated)} of the {len(entries)} way-points of joint {label} "
                    f"({statement.waypoints.where}: {', '.join(repeated)}) repeat digits of "
                    f"{where}, which states another quantity.",
                    "The digits alone do not show whether one of the columns is wrong.",
                    severity=Severity.WARNING,
                    doubts=(label,),
                    printed=", ".join(repeated),
                )


def _column_groups(columns: Sequence[object]) -> list[tuple[str, list[Printed]]]:
    """Columns of one table together, because a table's rows are given one by one."""
    groups: dict[str, list[Printed]] = {}
    for column in columns:
        where = str(getattr(column, "where", "")).split(",")[0]
        groups.setdefault(where, []).extend(getattr(column, "values", ()))
    return list(groups.items())
