"""What the paper states, in words and digits: the claims and the source of a case."""

from __future__ import annotations

from collections.abc import Iterable

from ...problem import QUANTITIES, USUAL, Case, Printed
from ...problem.cases import (
    AnyClaim,
    Claim,
    ConditionsClaim,
    ControlVerticesClaim,
    ConvergenceClaim,
    DurationsClaim,
    ImprovementClaim,
    MaximumClaim,
    MeasureClaim,
    MotionValueClaim,
    PhasesClaim,
    TimeClaim,
    TotalTimeClaim,
    ValueClaim,
    with_unit,
)
from ..documents import StatedAnswer, StatedClaim, StatedSource, enumerated, known, noted

RowClaim = DurationsClaim | MaximumClaim
"""What prints durations, so a motion can be built from it."""


def stated_claims(case: Case) -> tuple[StatedClaim, ...]:
    """Every claim of a case: its words, place and digits."""
    return tuple(
        StatedClaim(
            claim=claim.id,
            quantity=claim.quantity,
            text=claim_text(case, claim),
            where=claim.where,
            printed=digits_of(case, claim),
            objective=known(
                other_objective(case, claim),
                "time alone" if isinstance(claim, TimeClaim) else "no printed time",
            ),
            answer=known(_answer(claim), "the authors were not asked"),
        )
        for claim in case.claims
    )


def stated_source(case: Case) -> StatedSource:
    """Where the numbers of a case were printed."""
    named = case.source.model_dump()
    typed = case.document.transcription
    unsaid = "not said in the case file"
    return StatedSource(
        **{**named, "year": known(named["year"], "not named in the case file")},
        transcribed_by=known(typed.by if typed else None, unsaid),
        checked_by=known((typed.checked_by or None) if typed else None, unsaid),
    )


def _answer(claim: AnyClaim) -> StatedAnswer | None:
    if claim.answer is None:
        return None
    answered = known(claim.answer.answered, "no answer so far")
    return StatedAnswer(sent=claim.answer.sent, answered=answered, outcome=claim.answer.outcome)


def other_objective(case: Case, claim: AnyClaim | TimeClaim) -> str | None:
    """What was minimised for a printed time; None if it was time alone, or if nothing is said."""
    if not isinstance(claim, TimeClaim):
        return None
    # A file that says another objective may say of one claim that it is "time".
    said = claim.objective or case.document.objective
    return None if said is None or said.strip().lower() == "time" else said.strip().rstrip(".")


PATH_ALONE = "the curve of the case file is a path, and its own timing is not asked for"
"""Why a problem has no optimum if `timed_along_path`."""


def timed_along_path(case: Case, problem: str) -> bool:
    """Whether every printed time of a problem is of a motion along the path of its curve."""
    timed = [c for c in case.claims if isinstance(c, TimeClaim) and c.problem in (None, problem)]
    return bool(timed) and all(isinstance(c, TotalTimeClaim) and c.along_path for c in timed)


def claim_text(case: Case, claim: AnyClaim) -> str:
    """What a claim says: its own words, or one sentence from what it prints."""
    return claim.text or sentence_of(case, claim)


def digits_of(case: Case, claim: AnyClaim) -> str:
    """The digits that a claim prints, with the paper's unit; empty if it prints none."""
    units = case.document.units
    time = f" {units.time}" if units.time else ""
    if isinstance(claim, RowClaim):
        shown = ", ".join(map(str, claim.durations)) + time
        return shown + (f"; total {claim.total}{time}" if claim.total is not None else "")
    if isinstance(claim, TotalTimeClaim):
        return f"{claim.value}{time}"
    if isinstance(claim, PhasesClaim):
        return ", ".join(map(str, (*claim.phases, *(claim.ramps or ())))) + time
    if isinstance(claim, ImprovementClaim):
        parts = [f"{claim.percent} %"] if claim.percent is not None else []
        return "; ".join(parts + ([f"{claim.seconds}{time}"] if claim.seconds is not None else []))
    if isinstance(claim, MotionValueClaim):
        return ", ".join(with_units(case, claim))
    if isinstance(claim, ConvergenceClaim):
        return f"{claim.iterations} iterations"
    if isinstance(claim, ConditionsClaim) and claim.count is not None:
        return f"{claim.count} conditions"
    return ""


def in_words(case: Case, problem: str, reading: str) -> str:
    """A problem and a reading in words, each where the case has several; else the problem."""
    only = case.title if len(case.problems) == 1 else problem
    title = next((p.title for p in case.problems if p.id == problem), "") or only
    said = [title] if len(case.problems) > 1 or len(case.readings) < 2 else []
    return "; ".join([*said, *([case.labels[reading]] if len(case.readings) > 1 else [])])


def in_words_among(case: Case, problem: str, reading: str) -> str:
    """What `in_words` says; empty if there is one problem under one reading alone."""
    several = len(case.problems) > 1 or len(case.readings) > 1
    return in_words(case, problem, reading) if several else ""


def asked_as(case: Case, problem: str, reading: str) -> str:
    """A problem and a reading in words, with the ids by which a command asks for them if it can."""
    alone = len(case.problems) == len(case.readings) == 1
    ids = "" if alone else f"problem {problem}, reading {reading}"
    return noted(in_words(case, problem, reading), ids)


def printed_total(claim: Claim) -> Printed | None:
    """The total that a claim prints, if it does."""
    if isinstance(claim, RowClaim):
        return claim.total
    return claim.value if isinstance(claim, TotalTimeClaim) else None


def own_total(claim: Claim) -> Printed | None:
    """The same; None if it is the sum of the printed digits, which says no more than they do."""
    total = printed_total(claim)
    if total is None or not isinstance(claim, RowClaim):
        return total
    return None if total.decimal == sum(one.decimal for one in claim.durations) else total


def allowed_bases(claim: ImprovementClaim) -> tuple[str, ...]:
    """What the percentage may be a share of: as stated, or both where the text leaves it open."""
    return ("slower", "faster") if claim.base is None else (claim.base,)


def called(claim: Claim) -> str:
    """What a sentence calls a claim: the place where it stands, the first where there are more."""
    return claim.where.split(";")[0].strip()


def called_under(case: Case, claim: AnyClaim, problem: str | None) -> str:
    """A claim by its place, and the problem in brackets where the claim is about several."""
    problems = {one.id: one.title or one.id for one in case.problems}
    several = len(problems) > 1 and problem != claim.problem
    return noted(called(claim), problems[str(problem)] if several else "")


def all_called(claims: Iterable[AnyClaim]) -> str:
    """Several claims, each once."""
    return "; ".join(dict.fromkeys(called(claim) for claim in claims))


def place(claim: Claim) -> str:
    """Where a claim stands, as short as it can be found: the first place that it names."""
    # A title names its field as often as it claims: what stands elsewhere too is found there.
    first = claim.where.split(";")[0].strip().removeprefix("title, ")
    for part in ("abstract", "title", "introduction", "conclusion"):
        if first.startswith(part):
            return f"the {part}"
    head = first.split(", above")[0].split(", below")[0].split(" and ")[0]
    return ", ".join(head.split(", ")[:2])


def at_place(where: str) -> str:
    """A place with its preposition: on a page, in anything else."""
    return f"{'on' if where.startswith('page') else 'in'} {where}"


_MOST = 8
"""Numbers of a row that a sentence repeats at most; of a longer one it gives the total."""
_MEASURES = {
    "mean": "mean {one}",
    "rms": "root mean square of the {one}",
    "integral": "integral of the {one}",
    "integral-square": "integral of the squared {one}",
}
"""How a measure of a derivative is called."""
DERIVATIVES = ("position", *QUANTITIES[:USUAL])
"""The position and its derivatives, by their order."""
_STATEMENTS = {
    "within_limits": "the motion keeps its limits",
    "continuous": "velocity and acceleration are continuous",
    "jumps": "the acceleration{of} jumps",
    "at_rest": "the motion is at rest at both ends",
    "optimal": "the motion is optimal",
    "kinematics": "the joint angles and the positions agree",
    "varies_most": "joint {joint} varies most",
    "varies_much": "joint {joint} varies much",
    "equations": "the kinematic equations hold for the printed robot",
    "above": "one position lies above another",
    "none": "a sentence that cannot be checked",
}
"""What a statement says, by what it checks."""


def sentence_of(case: Case, claim: AnyClaim) -> str:
    """One sentence for a claim, from what it prints.

    An example is "The largest velocity of joint 2 is 94.7 deg/s."
    """
    said = _said(case, claim)
    names = {one.id: one.name for one in case.algorithms}
    if claim.algorithm is not None:
        said = f"{names[claim.algorithm]}: {said}"
    return f"{said[:1].upper()}{said[1:]}."


def _said(case: Case, claim: AnyClaim) -> str:
    time = case.document.units.time or "s"
    whose = f" of joint {claim.joint}" if claim.joint is not None else ""
    match claim:
        case DurationsClaim() | MaximumClaim() | TotalTimeClaim():
            before = "before optimisation, " if claim.state == "before" else ""
            curve = f" ({claim.other_curve})" if claim.other_curve else ""
            return f"{before}{_timed(claim, time, whose)}{curve}"
        case PhasesClaim():
            lengths = ", ".join(map(str, claim.phases))
            return f"the phases{whose} take {lengths} {time} ({claim.other_curve})"
        case ImprovementClaim(percent=percent) if percent is not None:
            return f"the motion is {percent} % shorter"
        case ImprovementClaim(seconds=saved):
            return f"the motion is {'' if saved is None else f'{saved} {time} '}shorter"
        case MotionValueClaim():
            return _measured(case, claim, whose)
        case ConvergenceClaim():
            return f"the search converges within {claim.iterations} iterations"
        case ConditionsClaim():
            names = enumerated(
                DERIVATIVES[k] if k < len(DERIVATIVES) else f"derivative {k}" for k in claim.orders
            )
            at = "both ends" if claim.rest_at == "ends" else "all way-points"
            verb = "is" if len(claim.orders) == 1 else "are"
            count = f": {claim.count} conditions" if claim.count is not None else ""
            return f"{names} {verb} 0 at {at}{count}"
        case ControlVerticesClaim():
            return "the control vertices of the B-spline"
    return _STATEMENTS[claim.checks].format(of=whose, joint=claim.joint)


def _timed(claim: RowClaim | TotalTimeClaim, unit: str, whose: str) -> str:
    if isinstance(claim, TotalTimeClaim):
        return f"the motion{whose} takes {claim.value} {unit}"
    count = len(claim.durations)
    # The total of one segment is its duration.
    total = "" if claim.total is None or count == 1 else f"{claim.total} {unit} in total"
    if count > _MOST:
        plain = f"the {count} segments{whose} take {total}"
        return plain if total else f"the durations of {count} segments{whose}"
    digits = f"{enumerated(claim.durations)} {unit}{', ' if total else ''}{total}"
    several = "s" if count > 1 else ""
    if isinstance(claim, MaximumClaim):
        verb = "are" if several else "is"
        return f"the longest duration{several} of the segment{several}{whose} {verb} {digits}"
    return f"the segment{several}{whose} take{'' if several else 's'} {digits}"


def _measured(case: Case, claim: MotionValueClaim, whose: str) -> str:
    """A largest value, a mean or an integral of a derivative."""
    called = "largest {one}"
    if isinstance(claim, MeasureClaim):
        called = _MEASURES[claim.measure]
    if isinstance(claim, ValueClaim):
        called = f"{claim.place} {{one}}" if claim.place in ("largest", "smallest") else "{one}"
    each = claim.values is not None
    plain = called.startswith(("largest", "smallest", "mean", "{one}"))
    plural = "velocities" if claim.derivative == "velocity" else f"{claim.derivative}s"
    name = called.format(one=plural if each and plain else claim.derivative)
    if each:
        whose = " of the joints"
        name = name.replace("integral", "integrals").replace("mean square", "mean squares")
    if len(claim.printed) > _MOST:
        return f"the {name}{whose}"
    if isinstance(claim, ValueClaim):
        whose += place_of_value(case, claim)
    verb = "are" if each else "is"
    return f"the {name}{whose} {verb} {enumerated(with_units(case, claim))}"


def place_of_value(case: Case, claim: ValueClaim) -> str:
    """Where a value is taken, as a sentence says it; empty for the largest and the smallest."""
    if claim.time is not None:
        return f" at {claim.time} {case.document.units.time or 's'}"
    if claim.place in ("largest", "smallest"):
        return ""
    if claim.place in ("start", "finish"):
        return f" at the {claim.place}"
    labelled = case.statement(claim.problem).waypoints.labels
    return f" at {claim.place}" if labelled else f" at way-point {claim.place}"


def with_units(case: Case, claim: MotionValueClaim) -> list[str]:
    """The numbers of a claim of a derivative with their unit, which no integral has in a file."""
    numbers = list(map(str, claim.printed))
    if isinstance(claim, MeasureClaim) and claim.measure.startswith("integral"):
        return numbers
    units = getattr(case.document.units, claim.derivative)
    if claim.values is None and isinstance(units, tuple):
        # The joint's own, or the one that all joints of the claim's problem have.
        joint = None if claim.joint is None else case.robot.joints.index(claim.joint)
        units = case.statement(claim.problem).unit(claim.derivative, joint)
    return with_unit(numbers, units)
