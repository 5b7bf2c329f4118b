"""The second line of a card: how far the printed totals are from the optimum."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from ...nlp import Evidence, Solution, Status
from ...problem import Coupling, shown_bound
from ...problem.cases import AnyClaim, MaximumClaim, ProfiledClaim, TimeClaim
from ..documents import (
    CaveatKind,
    ClaimVerdict,
    Judgement,
    Keeping,
    Waterfall,
    Why,
    at_least_percent,
    capital,
    count_words,
    quoted,
    ranged,
)
from .digit_ranges import all_exact, at_ratios, off_ratios, optimum_range, planned_apart
from .named_profiles import profile_called
from .own_result import bare_totals, contradicts_its_parts, other_totals, own_result
from .path_times import along_paths
from .printed_row import PrintedRow
from .profile_motions import above_shortest
from .rounding import meet, rounds_to
from .stated import RowClaim, other_objective, printed_total
from .study import Pair, Study, Total
from .waterfall import stands_in
from .words import FEW, NO_WAYPOINTS, percent, seconds

_MANY_TIMES = 10.0
"""Distance beyond which a multiple says more than a percentage."""
UNLIMITED = "no limits are stated"
"""Why a problem has no optimum, where nothing is limited."""
DOUBTED = "printed way-points that other printed numbers contradict"
"""What a total rests on, where way-points are in doubt."""
_LONG = 9
"""Words of a label or an objective that a sentence has room for: a line on a page."""
_PLURALS = {"proven optimum": "proven optima", "best known total": "best known totals"}
"""What an optimum is called, and several of them."""
_REMARKS = {
    Keeping.BREAKS: "breaks a limit",
    Keeping.DISCONTINUOUS: "jumps in velocity",
    Keeping.UNDECIDED: "may break a limit",
}
"""What is said beside a total whose durations are not shown to keep the limits."""


def optimum_line(
    study: Study, waterfalls: Sequence[Waterfall], words: Mapping[str, Judgement], before: bool
) -> str | Why:
    """How far the printed totals are from the optimum under the default reading.

    Parameters
    ----------
    before : bool
        Whether the line before has said that way-points are in doubt.
    """
    if not study.has_problems:
        return _beside_profiles(study, words) or (
            f"Neither limits nor an optimum can be checked: {NO_WAYPOINTS}."
        )
    main = [w for w in waterfalls if w.reading == study.main_reading]
    beside = [found for w in main for found in _beside(study, w)]
    if not beside or stands_in(study):
        return _without_totals(study, words)
    if all(isinstance(part, _Unknown) and part.why == UNLIMITED for part in beside):
        return f"{capital(UNLIMITED)}, so there is no shortest time to compare with."
    where = [f"under {_default(study)}"] if len(study.readings) > 1 else []
    doubted = any(w.claim in words and on_doubted_points(words[w.claim]) for w in main if w.claim)
    if doubted and not before:
        where.insert(0, f"with {DOUBTED}")
    sentence = ", ".join([*where, _side_by_side(beside)])
    return f"{sentence[:1].upper()}{sentence[1:]}."


def _default(study: Study) -> str:
    """The default reading by its label, unless that is long."""
    label = quoted(study.main_reading, study.case.labels)
    return label if count_words(label) <= _LONG else "the default reading"


def on_doubted_points(judgement: Judgement) -> bool:
    """Whether a claim was judged by motions through way-points in doubt."""
    return any(c.kind in (CaveatKind.POINTS, CaveatKind.SOME_POINTS) for c in judgement.caveats)


def _side_by_side(parts: Sequence[_Part]) -> str:
    """Printed totals beside their optima: what differs first, then how many agree."""
    aims = [part for part in parts if isinstance(part, _OtherAim)]
    alike = {(aim.called, aim.certified, aim.ratios) for aim in aims}
    if len(parts) == len(aims) == FEW and len(alike) == 1:
        first, second = aims
        shown, spans = first.shown + second.shown, first.spans + second.spans
        return str(replace(first, shown=shown, spans=spans))
    agreeing = [part for part in parts if isinstance(part, _Agrees)]
    unknown = [part for part in parts if isinstance(part, _Unknown)]
    others = [part for part in parts if part not in agreeing and part not in unknown]
    differing = list({str(part): part for part in others}.values())
    *most, last = differing[:FEW] or [""]
    # What may explain several distances is said once, of the last of them.
    said = [str(replace(one, may=False) if isinstance(one, _AtPrint) else one) for one in most]
    said += [str(last)] if differing else []
    if len(differing) > FEW:
        said.append(f"{len(differing) - FEW} more below")
    said += [_agreement(agreeing, bool(others), len(parts))] if agreeing else []
    for why in dict.fromkeys(part.why for part in unknown):
        said.append(f"elsewhere, {why}" if len(unknown) < len(parts) else why)
    return "; ".join(said)


def _agreement(agreeing: Sequence[_Agrees], others: bool, parts: int) -> str:
    """One total that agrees in full; of several how many do."""
    if len(agreeing) == 1:
        return str(agreeing[0])
    which = f"{len(agreeing)} {'more ' if others else ''}printed totals"
    if len(agreeing) == parts:
        which = "both printed totals" if parts == FEW else f"all {which}"
    names = {_PLURALS[part.name] for part in agreeing}
    return f"{which} agree with their {names.pop() if len(names) == 1 else 'optima'}"


def _without_totals(study: Study, words: Mapping[str, Judgement]) -> str | Why:
    """What is said of printed times where none is on the curve whose optimum is known.

    The case file's curve may only stand in for one that it cannot name, and its optimum is none of
    the paper's.
    """
    timed = [c for c in study.case.claims if isinstance(c, TimeClaim) and c.id in words]
    if profiled := _beside_profiles(study, words):
        return profiled
    if along := along_paths(study, timed):
        return along
    curves = ", ".join(dict.fromkeys(c.other_curve for c in timed if c.other_curve is not None))
    if curves:
        return f"The printed times belong to another curve ({curves}), so no optimum applies."
    if not timed:
        return Why("no time is claimed")
    return "No printed total can be compared with an optimum."


def _above_shortest(study: Study, claims: Sequence[ProfiledClaim]) -> str:
    """How far totals of an algorithm that is not always the shortest are above that one."""
    main = [pair for pair in study.pairs if pair.reading == study.main_reading]
    rows = [PrintedRow(study, c, p) for c in claims for p in main if c.problem in (None, p.problem)]
    above = {row.problem: above_shortest(row) for row in rows}
    # From a hundredth of a percent on, as the claims do.
    longer = [percent(more, ".2g") for more in above.values() if more > 1e-4]
    named = {c.id for c in claims}
    optimal = any(named.intersection(c.of) for c in study.statements("optimal"))
    note = "" if optimal else ", which the text does not call the shortest"
    if len(longer) > 1:
        far = " and ".join(longer)
        return f" The algorithm's totals{note}{',' if note else ''} are {far} above the shortest."
    one = f" One total of the algorithm{note}{',' if note else ''} is"
    return f"{one} {longer[0]} above the shortest." if longer else ""


def _beside_profiles(study: Study, words: Mapping[str, Judgement]) -> str:
    """How many printed times agree with their profiles; empty if no profile is named."""
    timed = [
        c
        for c in study.case.claims
        if isinstance(c, TimeClaim) and isinstance(c, ProfiledClaim)
        if c.profile is not None and c.id in words
    ]
    if not timed:
        return ""
    profiles = [*dict.fromkeys(str(c.profile) for c in timed)]
    # Without way-points, times are judged along one way, which is not printed.
    way = "" if study.has_problems else " over one distance, which is not printed"
    agreeing = _agreeing([words[c.id].verdict for c in timed], profiles, way)
    return agreeing + (_above_shortest(study, timed) if study.has_problems else "")


def _agreeing(verdicts: Sequence[ClaimVerdict], profiles: Sequence[str], way: str = "") -> str:
    """How many times agree with their profiles; what is open accuses none."""
    agree = verdicts.count(ClaimVerdict.SUPPORTED)
    differ = verdicts.count(ClaimVerdict.INCONSISTENT) + verdicts.count(ClaimVerdict.REFUTED)
    if len(verdicts) == 1:
        own = profile_called(profiles)
        if not agree and not differ:
            return f"It is open whether the printed time is that of the {own}{way}."
        return f"The printed time is {'' if agree else 'not '}that of the {own}{way}."
    which = f"{agree} of {len(verdicts)}"
    if agree == len(verdicts):
        which = "Both" if agree == FEW else f"All {agree}"
    left = len(verdicts) - agree - differ
    note = f"; {left} {'is' if left == 1 else 'are'} open" if left else ""
    if agree == 1:
        return f"{which} printed times is that of the {profile_called(profiles)}{way}{note}."
    return (
        f"{which} printed times are those of the {profile_called(profiles, 'profiles')}{way}{note}."
    )


@dataclass(frozen=True)
class _Unknown:
    """A problem that has no optimum to compare with."""

    why: str


@dataclass(frozen=True)
class _Above:
    """A printed total that is longer than its optimum."""

    shown: str
    remark: str
    least: str
    """“At least ” where some roundings make the distance larger."""
    far: str
    over: str
    """The optimum that it is above."""

    def __str__(self) -> str:
        return f"{_remarked(self.shown, self.remark)} is {self.least}{self.far} above {self.over}"


@dataclass(frozen=True)
class _Agrees:
    """A printed total within whose rounding the optimum lies."""

    said: str
    name: str
    best: str

    def __str__(self) -> str:
        return f"{self.said} agrees with the {self.best}"


@dataclass(frozen=True)
class _AtPrint:
    """A distance that rounding of way-points and limits may change, or explain altogether."""

    said: str
    may: bool

    def __str__(self) -> str:
        return f"at the printed digits, {self.said}{', which rounding may explain' * self.may}"


@dataclass(frozen=True)
class _OtherAim:
    """Printed totals that were not minimised for time alone, and the shortest times there."""

    shown: tuple[str, ...]
    called: str
    certified: bool
    ratios: str
    spans: tuple[str, ...]

    def __str__(self) -> str:
        many = len(self.shown) > 1
        what = f"{' and '.join(self.shown)} {'were' if many else 'was'} not minimised"
        known = "" if self.certified else "known "
        motion = "motions on the same curves" if many else "motion on the same curve"
        takes = f"{'take' if many else 'takes'} {' and '.join(self.spans)}"
        return (
            f"{what} for time alone{self.called}, so {'they' if many else 'it'} need not be the "
            f"shortest; the shortest {known}{motion}{self.ratios} {takes}"
        )


_Part = _OtherAim | str | _Above | _AtPrint | _Agrees | _Unknown
"""What is said of one problem; plain words where a total differs otherwise."""


def _remarked(shown: str, remark: str) -> str:
    """A printed total, with what its durations do to the limits, as the subject of a sentence."""
    return f"{shown}, which {remark}," if remark else shown


def _beside(study: Study, waterfall: Waterfall) -> list[_Part]:
    """A printed total beside its optimum, and others that are printed of it; none where none is."""
    pair = Pair(waterfall.problem, waterfall.reading)
    solution = study.optimum(pair)
    if why := _unknown(solution):
        return [_Unknown(why if study.limited(pair) else UNLIMITED)]
    claim: AnyClaim | None = own_result(study.case, bare_totals(study.case, waterfall.problem))
    if waterfall.claim is not None:
        claim = study.case.claim(waterfall.claim)
    if not isinstance(claim, TimeClaim):
        return []
    others = other_totals(PrintedRow(study, claim, pair))
    found = [_one_beside(PrintedRow(study, one, pair), solution) for one in (claim, *others)]
    return [part for part in found if part is not None]


def _one_beside(row: PrintedRow[TimeClaim], solution: Solution) -> _Part | None:
    study, best = row.study, solution.best
    certified = solution.evidence is Evidence.CERTIFIED
    name = "proven optimum" if certified else "best known total"
    span = _span(solution)
    # Where the paper plans each joint separately, that has another optimum.
    together = " of all joints together" if planned_apart(study.problem(row.pair)) else ""
    shown_best = f"{span}{together}{at_ratios(solution.problem)}"
    optimum = f"{name} of {shown_best}"
    total, printed = row.total, printed_total(row.claim)
    if total is None:
        return None
    shown, (low, high) = study.total_digits(row.claim), total.interval
    if off_ratios(row) is not None:
        return f"{shown} belongs to durations in ratios other than those that the reading fixes"
    own = None if printed is None else row.time(printed)
    seconds = float(row.durations.value.sum()) if own is None else own.value
    share = seconds / best - 1
    minimised = other_objective(study.case, row.claim)
    if minimised is not None and share > 0:
        # A longer objective is left to the claims.
        called = f" ({minimised})" if count_words(minimised) <= _LONG else ""
        ratios, proven = at_ratios(solution.problem), " (proven)" if certified else ""
        return _OtherAim((shown,), called, certified, ratios, (span + proven,))
    remark = _kept_there(row)
    said = _remarked(shown, remark)
    joints = _joint_by_joint(row, total, seconds, said)
    if joints is not None:
        return joints
    floor = solution.lower_bound
    if floor is not None and " to " in span and low <= best and floor <= high:
        return f"{said} lies in the proven interval of the optimum, {shown_best}"
    if rounds_to((low, high), best) or (own is not None and own.lower <= best <= own.upper):
        return _Agrees(said, name, optimum)
    if own is not None and own.cut_off().lower <= best <= own.cut_off().upper:
        return f"{said} agrees with the {optimum} if digits were cut off"
    if loose := row.statement.declaration.loose:
        return f"{said} is not compared: {loose[0].lower()}{loose[1:]} are rounded numbers"
    ends = optimum_range(row)
    if share > 0:
        if ends.upper is None or not low > ends.upper:
            far = f"{said} is {_far(share, 'above')} the {optimum}"
            return _AtPrint(far, ends.upper is not None)
        most = None if ends.lower is None else high / ends.lower - 1
        bound, far = _bounded(low / ends.upper - 1, share, most)
        if share >= _MANY_TIMES:
            return f"{said} is {bound}{far} the {optimum}"
        return _Above(shown, remark, bound, far, f"the {optimum}")
    if ends.lower is not None and high < ends.lower:
        least = None if ends.upper is None else 1 - low / ends.upper
        bound, far = _bounded(1 - high / ends.lower, -share, least)
        return f"{said} is {bound}{far} below the {optimum}"
    # To first order the digits shorten the optimum by no more than they are proved to lengthen it.
    reach = 0.0 if ends.upper is None else ends.upper / best - 1
    may = high >= best * (1 - reach) and reach > 0
    return _AtPrint(f"{said} is {_far(-share, 'below')} the {optimum}", may)


def _size(share: float) -> str:
    """How far a time is from another: as a percentage, or how many times it is."""
    return f"{1 + share:.1f} times" if share >= _MANY_TIMES else f"{_percent(share)} %"


def _far(share: float, side: str) -> str:
    """A distance at the printed digits."""
    return _size(share) if share >= _MANY_TIMES else f"{_size(share)} {side}"


def _bounded(least: float, share: float, most: float | None) -> tuple[str, str]:
    """A distance that holds however the digits were rounded, after “at least ” if need be.

    Where all roundings print alike it is that number, else the least of them.
    """
    if most is not None and _size(least) == _size(share) == _size(most):
        return "", _size(share)
    if share >= _MANY_TIMES:
        return "at least ", f"{shown_bound(1 + least, 'lower', places=1)} times"
    return "at least ", at_least_percent(least)


def _span(solution: Solution) -> str:
    """An optimum, or the interval that is proved to hold it where its ends print differently."""
    low = solution.best if solution.lower_bound is None else solution.lower_bound
    if f"{low:.4f}" == f"{solution.best:.4f}":
        return seconds(low, ".4f")
    ends = shown_bound(low, "lower", places=4), shown_bound(solution.best, "upper", places=4)
    return f"{' to '.join(ends)} s"


def _kept_there(row: PrintedRow[TimeClaim]) -> str:
    """What the durations behind a total do to the limits, unless they are shown to keep them.

    A distance from the optimum is one of a motion only where that motion keeps its limits.
    """
    if not isinstance(row.claim, RowClaim) or row.unmoved is not None:
        return ""
    # A total that is not the sum of the durations beside it is of others.
    return "" if contradicts_its_parts(row) else _REMARKS.get(row.keeping, "")


def _joint_by_joint(
    row: PrintedRow[TimeClaim], total: Total, seconds: float, said: str
) -> str | None:
    """A total beside what the joints' own optima give, where each is planned by itself."""
    claim = row.claim
    if not planned_apart(row.study.problem(row.pair)) or claim.joint is not None:
        return None
    if claim.coupling is Coupling.SHARED and not isinstance(claim, MaximumClaim):
        return None  # the longest durations of joints that are each planned alone are shared too
    answer = row.study.per_joint(row.pair)
    if not answer.ranges or answer.check is None:
        return None
    wide = answer.ranges[0]
    proven = answer.joint_evidence is Evidence.CERTIFIED
    # The joints' optima may be proven; the range that they leave is the widest that is found.
    at = "" if all_exact(row) else " at the printed digits"
    span = f"{ranged(wide.lowest, wide.highest, '.4f')} s"
    own = f"optimising each joint separately gives {span}{at}{'' if proven else ' (best known)'}; "
    low, high = total.interval
    if meet((low, high), (wide.lowest, wide.highest)):
        return f"{own}{said} agrees with that"
    longer = seconds > wide.highest
    shares = sorted(abs(seconds / one - 1) for one in (wide.highest, wide.lowest))
    shown = " to ".join(dict.fromkeys(map(_percent, shares)))
    return f"{own}{said} is {shown} % {'above' if longer else 'below'} that"


def _percent(share: float) -> str:
    percent = 100 * share
    return f"{percent:.1f}" if percent >= 1 else f"{percent:.2g}"


def _unknown(solution: Solution) -> str:
    """Why there is no optimum to compare with; empty if there is one."""
    if solution.infimum is not None or solution.status is Status.NOT_ATTAINED:
        return "no shortest motion was found: the total falls as a duration goes to 0"
    if solution.status is Status.INFEASIBLE:
        where = "through the printed way-points" + at_ratios(solution.problem)
        return f"no motion {where} keeps the limits (proven)"
    if solution.problem.unscaled is not None:
        return "the shortest total at these ratios cannot be checked: the curve has no formula"
    if not solution.found:
        return "the optimum cannot be computed: the solver found no motion within the limits"
    if solution.evidence not in (Evidence.CERTIFIED, Evidence.BEST_KNOWN):
        return "the optimum cannot be computed: the solver did not converge"
    return ""
