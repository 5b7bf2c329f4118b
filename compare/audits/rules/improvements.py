"""TG103: a printed improvement beside the printed totals that it compares."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction

from ....problem import Interval, Printed
from ....problem.cases import AnyClaim, ImprovementClaim, MaximumClaim
from ...documents import Basis, ClaimVerdict, Finding, Severity
from ..rounding import hull, meet
from ..stated import allowed_bases, printed_total
from ..study import Study
from .printed_digits import compared, raised, shown, span
from .printed_tables import contradicted, doubted, total_allowed
from .rule_group import ON_DIGITS, Explained, rule_group

_SHARE_OF = {"slower": "the longer total", "faster": "the shorter total"}
"""What a percentage may be a share of; of the longer total, if either fits."""


TG103 = Explained(
    "TG103",
    "A printed improvement follows from the printed totals",
    "Does a printed improvement follow from the two totals that it compares? A percentage may "
    "be a share of either total, unless the text says which.",
    "Supported if some values that round to the printed totals give it, otherwise refuted; "
    "inconsistent if two places print different totals. If only the order of two totals is "
    "claimed, a longer total that is called the better one is refuted. " + ON_DIGITS,
    "From 4.00 s to 3.60 s the total falls by 9.8 to 10.2 % of the longer total, or by 11 "
    "% of the shorter one. “10 %” and “11 %” are supported; “15 %” is refuted.",
    basis=Basis.DIGITS,
)


@rule_group(TG103, without_waypoints=True)
def judge_improvements(study: Study) -> Iterator[Finding]:
    """Findings of TG103."""
    for claim in study.claims:
        if not isinstance(claim, ImprovementClaim):
            continue
        sides = [study.case.claim(one) for one in (claim.slower, claim.faster)]
        slower, faster = map(printed_total, sides)
        if slower is None or faster is None or slower.interval.lower <= 0:
            continue
        longer, shorter = (total_allowed(study, side) for side in sides)
        one = _Improved(study, claim, sides, slower, faster, (longer, shorter))
        if claim.percent is not None:
            yield _percentage(one, claim.percent)
        if claim.seconds is not None:
            cut = _difference(slower.truncated, faster.truncated)
            said = claim, claim.seconds, one.seconds, cut, one.what, study.time_unit, one.root
            yield compared(TG103, *said, mixed=_difference(longer, shorter))
        if claim.percent is None and claim.seconds is None:
            yield _unquantified(one)
        if claim.percent is not None:
            yield from _against_tables(one, claim.percent)


@dataclass(frozen=True)
class _Improved:
    """A printed improvement, and the two totals that it compares."""

    study: Study
    claim: ImprovementClaim
    sides: Sequence[AnyClaim]
    slower: Printed
    faster: Printed
    wide: tuple[Interval, Interval]
    """Both totals, rounded or cut off, or the sum of digits that were."""

    @property
    def between(self) -> str:
        return f"{self.slower} and {self.faster} {self.study.time_unit}"

    @property
    def what(self) -> str:
        return f"The reduction between the printed totals {self.between}"

    @property
    def root(self) -> str:
        return f"improvement {self.claim.id}"

    @property
    def seconds(self) -> Interval:
        return _difference(self.slower.interval, self.faster.interval)

    def share_fits(self, percent: Printed, base: str) -> bool:
        """Whether the totals give a percentage of one of them, which is more than nothing."""
        divides = base == "slower" or self.wide[1].lower > 0
        return divides and meet(hull(percent), _share(*self.wide, base))

    @property
    def bases(self) -> list[str]:
        """What the percentage may be a share of."""
        positive = self.wide[1].lower > 0
        return [base for base in allowed_bases(self.claim) if base == "slower" or positive]


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


def _percentage(one: _Improved, percent: Printed) -> Finding:
    """The percentage under each base that is admissible; the first that fits is taken."""
    tried, slower, faster = [], one.slower, one.faster
    bases = one.bases
    if not bases:
        return TG103.finding(
            one.claim,
            "share of nothing",
            f"A share of {one.faster} {one.study.time_unit}, which may be 0, cannot be computed.",
        )
    for base in bases:
        share = f"{one.what}, as a share of {_SHARE_OF[base]},"
        rounded = _share(slower.interval, faster.interval, base)
        cut = _share(slower.truncated, faster.truncated, base)
        longer, shorter = raised(slower), raised(faster)
        up = _share(longer, shorter, base) if longer.lower > 0 < shorter.lower else None
        said = one.claim, percent, rounded, cut, share, "%", one.root
        # A total may be the sum of digits cut off, and the percentage that of the whole numbers.
        found = compared(TG103, *said, mixed=_share(*one.wide, base), raised_parts=up)
        tried.append(found.model_copy(update={"computed": f"{_as_printed(rounded, percent)} %"}))
    weights = list(Severity)
    best = max(range(len(tried)), key=lambda k: weights.index(tried[k].severity))
    found = tried[best]
    if len(tried) < 2 or (best == 0 and found.severity is Severity.INFO):
        # The base that the file does not state may be the one that fits.
        others = [base for base in _SHARE_OF if base not in allowed_bases(one.claim)]
        fitting = [base for base in others if one.share_fits(percent, base)]
        if found.severity is not Severity.ERROR or not fitting:
            return found
        return found.adding(f"As a share of {_SHARE_OF[fitting[0]]} it would be {percent} %.")
    other = 1 - best
    rest = [f"As a share of {_SHARE_OF[bases[other]]} it would be {tried[other].computed}."]
    if found.verdict is not ClaimVerdict.REFUTED:
        rest.append("The text leaves open which is meant.")
    return found.adding(*rest)


def _as_printed(share: Interval, percent: Printed) -> str:
    """A share with the decimals of a printed one: one number where both ends round to it."""
    step = Fraction(10) ** -max(percent.places, 0)
    ends = dict.fromkeys(
        f"{float(round(end / step) * step):.{max(percent.places, 0)}f}" for end in share
    )
    return " to ".join(ends)


def _unquantified(one: _Improved) -> Finding:
    study, slower, faster, seconds = one.study, one.slower, one.faster, one.seconds
    unit = study.time_unit
    verdict, kind, more = ClaimVerdict.NOT_CHECKABLE, "as claimed", ""
    message = f"The printed totals are {one.between}"
    if slower.text == faster.text:
        kind = "same total"
        message = (
            f"Both tables print the same total, {faster} {unit}: an improvement, if there is one, "
            f"is below {shown(seconds.upper)} {unit}"
        )
        # An improvement below the last digit is one. Only tables alike that are said to differ
        # speak against it.
        if contradicted(study, one.sides):
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
        message = f"The printed totals {one.between} do not differ by more than their rounding"
    return TG103.finding(
        one.claim,
        kind,
        f"{message}.",
        more,
        verdict=verdict,
        printed=one.between,
        follows=doubted(study, one.sides),
    )


def _against_tables(one: _Improved, percent: Printed) -> Iterator[Finding]:
    study, claim = one.study, one.claim
    found_in = [_table_total(study, side) for side in one.sides]
    tables = [table for table in found_in if table is not None]
    # One table cannot say how two totals differ.
    if len(tables) < 2 or tables[0] is tables[1]:
        return
    fits = any(one.share_fits(percent, base) for base in allowed_bases(claim))
    own = f"{one.between} give {percent} %, but from" if fits else "From"
    longer, shorter = (total_allowed(study, table) for table in tables)
    positive = min(longer.lower, shorter.lower) > 0
    found = [_share(longer, shorter, base) for base in allowed_bases(claim) if positive]
    if not found or any(meet(hull(percent), allowed) for allowed in found):
        return
    allowed = found[0]
    where = " and ".join(table.where for table in tables)
    slower, faster = map(printed_total, tables)
    yield TG103.finding(
        claim,
        "of the tables",
        f"{own} the totals printed in the tables ({where}: {slower} and {faster}) the "
        f"reduction is {span(allowed, 3)} %, however digits were rounded or cut off, not "
        f"{percent} %.",
        severity=Severity.ERROR,
        verdict=ClaimVerdict.INCONSISTENT,
        printed=f"{percent} %",
        computed=f"{span(allowed, 3)} %",
        follows=doubted(study, tables),
        between=(claim.id, *(table.id for table in tables)),
    )
