"""TG103: a printed improvement beside the printed totals that it compares."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction

from ....problem import Interval, Printed
from ....problem.cases import AnyClaim, ImprovementClaim, MaximumClaim
from ...documents import Basis, ClaimVerdict, Finding, Severity
from ..rounding import hull, meet
from ..stated import allowed_bases, printed_total
from ..study import Study
from .printed_digits import compared, shown, span
from .printed_tables import contradicted, doubted, total_allowed
from .rule_group import ON_DIGITS, Explained, finding, rule_group

_SHARE_OF = {"slower": "the longer total", "faster": "the shorter total"}
"""What a percentage may be a share of; of the longer total, if either fits."""


@rule_group(
    TG103=Explained(
        "A printed improvement follows from the printed totals",
        "Does a printed improvement follow from the two totals that it compares? A percentage may "
        "be a share of either total, unless the text says which.",
        "Supported if some values that round to the printed totals give it, otherwise refuted; "
        "inconsistent if two places print different totals. If only the order of two totals is "
        "claimed, a longer total that is called the better one is refuted. " + ON_DIGITS,
        "From 4.00 s to 3.60 s the total falls by 9.8 to 10.2 % of the longer total, or by 11 "
        "% of the shorter one. “10 %” and “11 %” are supported; “15 %” is refuted.",
    ),
    without_waypoints=True,
)
def judge_improvements(study: Study) -> Iterator[Finding]:
    """Findings of TG103."""
    for claim in study.claims:
        if not isinstance(claim, ImprovementClaim):
            continue
        slower_claim, faster_claim = (study.case.claim(i) for i in (claim.slower, claim.faster))
        slower, faster = printed_total(slower_claim), printed_total(faster_claim)
        if slower is None or faster is None or slower.interval.lower <= 0:
            continue
        between = f"{slower} and {faster} {study.time_unit}"
        what = f"The reduction between the printed totals {between}"
        root = f"improvement {claim.id}"
        seconds = _difference(slower.interval, faster.interval)
        if claim.percent is not None:
            yield _percentage(study, claim, claim.percent, slower, faster, what, root)
        if claim.seconds is not None:
            cut = _difference(slower.truncated, faster.truncated)
            mixed = _difference(*_allowed(study, claim))
            unit = study.time_unit
            said = claim, claim.seconds, seconds, cut, what, unit, root
            yield compared("TG103", *said, mixed=mixed)
        if claim.percent is None and claim.seconds is None:
            yield _unquantified(study, claim, slower, faster, seconds)
        tables = [_table_total(study, c) for c in (slower_claim, faster_claim)]
        # One table cannot say how two totals differ.
        apart = tables[0] is not tables[1]
        totals = [printed_total(t) for t in tables if t is not None and apart]
        if claim.percent is not None and len(totals) == 2 and None not in totals:
            allowed = _allowed(study, claim)
            bases = [base for base in allowed_bases(claim) if _divides(base, allowed[1])]
            percent = hull(claim.percent)
            fits = any(meet(percent, _share(*allowed, base)) for base in bases)
            own = f"{between} give {claim.percent} %, but from" if fits else "From"
            yield from _against_tables(study, claim, claim.percent, tables, totals, own)


def _table_total(study: Study, claim: AnyClaim) -> AnyClaim | None:
    """The claim that prints a total's sum for all joints in a table; none where several might."""
    found = [
        one
        for one in study.case.claims
        if isinstance(one, MaximumClaim)
        and one.total is not None
        and (one.algorithm, one.problem) == (claim.algorithm, claim.problem)
    ]
    return claim if claim in found else found[0] if len(found) == 1 else None


def _difference(slower: Interval, faster: Interval) -> Interval:
    return Interval(slower.lower - faster.upper, slower.upper - faster.lower)


def _share(slower: Interval, faster: Interval, base: str) -> Interval:
    """The reduction in percent of the slower or the faster of two intervals."""
    if base == "slower":
        low = 100 * (1 - faster.upper / slower.lower)
        return Interval(low, 100 * (1 - faster.lower / slower.upper))
    low = 100 * (slower.lower / faster.upper - 1)
    return Interval(low, 100 * (slower.upper / faster.lower - 1))


def _divides(base: str, faster: Interval) -> bool:
    """Whether a total is more than nothing, so something may be a share of it."""
    return base == "slower" or faster.lower > 0


def _allowed(study: Study, claim: ImprovementClaim) -> tuple[Interval, Interval]:
    """Both totals, rounded or cut off, or the sum of digits that were."""
    slower, faster = (study.case.claim(one) for one in (claim.slower, claim.faster))
    return total_allowed(study, slower), total_allowed(study, faster)


def _percentage(
    study: Study,
    claim: ImprovementClaim,
    percent: Printed,
    slower: Printed,
    faster: Printed,
    what: str,
    root: str,
) -> Finding:
    """The percentage under each base that is admissible; the first that fits is taken."""
    # A total may be the sum of digits cut off, and the percentage that of the whole numbers.
    wide = _allowed(study, claim)
    bases = [base for base in allowed_bases(claim) if _divides(base, wide[1])]
    tried = []
    for base in bases or ["slower"]:
        share = f"{what}, as a share of {_SHARE_OF[base]},"
        rounded = _share(slower.interval, faster.interval, base)
        cut = _share(slower.truncated, faster.truncated, base)
        mixed = _share(*wide, base)
        found = compared("TG103", claim, percent, rounded, cut, share, "%", root, mixed=mixed)
        tried.append(found.model_copy(update={"computed": f"{_as_printed(rounded, percent)} %"}))
    weights = list(Severity)
    best = max(range(len(tried)), key=lambda k: weights.index(tried[k].severity))
    found = tried[best]
    if len(tried) < 2 or (best == 0 and found.severity is Severity.INFO):
        return found if found.severity is not Severity.ERROR else _of_the_other(found, claim, wide)
    other = 1 - best
    rest = [f"As a share of {_SHARE_OF[bases[other]]} it would be {tried[other].computed}."]
    if found.verdict is not ClaimVerdict.REFUTED:
        rest.append("The text leaves open which is meant.")
    return found.adding(*rest)


def _of_the_other(
    found: Finding, claim: ImprovementClaim, totals: tuple[Interval, Interval]
) -> Finding:
    """A finding on a percentage, with the base that the file does not state where that one fits."""
    for base, words in _SHARE_OF.items():
        if base in allowed_bases(claim) or not _divides(base, totals[1]):
            continue
        if claim.percent is not None and meet(hull(claim.percent), _share(*totals, base)):
            return found.adding(f"As a share of {words} it would be {claim.percent} %.")
    return found


def _as_printed(share: Interval, percent: Printed) -> str:
    """A share with the decimals of a printed one: one number where both ends round to it."""
    step = Fraction(10) ** -max(percent.places, 0)
    ends = dict.fromkeys(
        f"{float(round(end / step) * step):.{max(percent.places, 0)}f}" for end in share
    )
    return " to ".join(ends)


def _unquantified(
    study: Study, claim: ImprovementClaim, slower: Printed, faster: Printed, seconds: Interval
) -> Finding:
    unit = study.time_unit
    between = f"{slower} and {faster} {unit}"
    sides = [study.case.claim(i) for i in (claim.slower, claim.faster)]
    verdict, kind, more = ClaimVerdict.NOT_CHECKABLE, "as claimed", ""
    message = f"The printed totals are {between}"
    if slower.text == faster.text:
        kind = "same total"
        message = (
            f"Both tables print the same total, {faster} {unit}: an improvement, if there is one, "
            f"is below {shown(seconds.upper)} {unit}"
        )
        # An improvement below the last digit is one. Only tables alike that are said to differ
        # speak against it.
        if contradicted(study, sides):
            verdict = ClaimVerdict.INCONSISTENT
            more = (
                "Their tables agree in every number, but elsewhere the paper prints different "
                "results."
            )
    elif seconds.lower > 0 and not study.has_problems:
        message += ", in the claimed order; neither can be computed from the text"
    elif seconds.lower > 0:
        verdict = ClaimVerdict.SUPPORTED
    elif hull(slower).upper < hull(faster).lower:
        verdict, kind = ClaimVerdict.REFUTED, "longer"
        message += ": the one called better is the longer"
    else:
        kind = "within rounding"
        message = f"The printed totals {between} do not differ by more than their rounding"
    return finding(
        "TG103",
        claim,
        kind,
        f"{message}.",
        more,
        verdict=verdict,
        basis=Basis.DIGITS,
        printed=between,
        follows=doubted(study, sides),
    )


def _against_tables(
    study: Study,
    claim: ImprovementClaim,
    percent: Printed,
    tables: Sequence[AnyClaim | None],
    totals: Sequence[Printed | None],
    own: str,
) -> Iterator[Finding]:
    slower, faster = totals
    assert slower is not None
    assert faster is not None
    longer, shorter = (total_allowed(study, t) for t in tables if t is not None)
    positive = min(longer.lower, shorter.lower) > 0
    found = [_share(longer, shorter, base) for base in allowed_bases(claim) if positive]
    if not found or any(meet(hull(percent), allowed) for allowed in found):
        return
    allowed = found[0]
    where = " and ".join(t.where for t in tables if t is not None)
    yield finding(
        "TG103",
        claim,
        "of the tables",
        f"{own} the totals printed in the tables ({where}: {slower} and {faster}) the "
        f"reduction is {span(allowed, 3)} %, however digits were rounded or cut off, not "
        f"{percent} %.",
        severity=Severity.ERROR,
        verdict=ClaimVerdict.INCONSISTENT,
        basis=Basis.DIGITS,
        printed=f"{percent} %",
        computed=f"{span(allowed, 3)} %",
        follows=doubted(study, [t for t in tables if t is not None]),
        between=(claim.id, *(t.id for t in tables if t is not None)),
    )
