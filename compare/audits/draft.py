"""The same judgement for an author before submission: what to change, with the numbers to print."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from decimal import Decimal

from ...problem.cases import AnyClaim, MaximumClaim, StatementClaim
from ..documents import Advice, Cause, ClaimVerdict, Edit, Judgement, Severity, Urgency
from .card_errors import plainly
from .stated import claim_text
from .study import Study
from .words import CLAIM

_FIXES = {
    "TG104": "Two of your tables are alike: put the right numbers into one of them.",
    "TG107": "Drop conditions or raise a degree until their number equals that of the "
    "coefficients.",
    "TG109": "Print one duration for each segment.",
    "TG202": "Name a curve that is continuous, or say that its velocity jumps.",
    "TG601": "Compare joint angles and positions with your model of the robot.",
}
"""How to fix what a rule finds, where no number mends it."""


def advise(
    study: Study, causes: Sequence[Cause], judgements: Sequence[Judgement], edits: Sequence[Edit]
) -> tuple[Advice, ...]:
    """What an author can change before submitting, the gravest first.

    There is one for each cause, for each claim whose answer depends on the reading, for each claim
    that changes because others do, for each that cannot be checked, and for what is left open.
    Every edit belongs to one of them at least.
    """
    left = list(edits)

    def taken(claim: str | None, *more: str | None) -> tuple[Edit, ...]:
        """The edits that claims ask for, for whoever asks first, or those of the first itself."""
        asks = {claim, *more} - {None}
        own = [one for one in left if one.trigger in asks]
        left[:] = [one for one in left if one not in own]
        return tuple(own or [one for one in edits if one.claim == claim is not None])

    found = [
        _of_cause(study, cause, taken(cause.claim, *(c.claim for c in cause.consequences)))
        for cause in causes
    ]
    said = {one.claim for one in found}
    for judgement in judgements:
        claim = study.case.claim(judgement.claim)
        if claim.id in said:
            continue
        if judgement.verdict is ClaimVerdict.DEPENDS:
            found.append(_of_readings(study, claim, judgement, taken(claim.id)))
        elif judgement.verdict is ClaimVerdict.NOT_CHECKABLE:
            says = f"Readers cannot check this: {judgement.why}"
            change = "Print what is missing, or drop the claim."
            found.append(_advice(Urgency.OPEN, claim, says, change))
    # Claims that change because others do, each with all its edits.
    for claim in study.case.claims:
        own = tuple(one for one in left if one.claim == claim.id)
        if own:
            says = "Rests on numbers that change above."
            found.append(_advice(Urgency.FOLLOWS, claim, says, _told(study, claim, own), own))
    found += _left_open(study)
    return tuple(sorted(found, key=lambda one: list(Urgency).index(one.urgency)))


def _advice(
    urgency: Urgency,
    about: AnyClaim | None,
    says: str,
    change: str,
    edits: tuple[Edit, ...] = (),
    where: str = "the whole draft",
) -> Advice:
    """Advice on a claim, or on what stands somewhere else."""
    return Advice(
        urgency=urgency,
        where=where if about is None else about.where,
        claim=None if about is None else about.id,
        says=says,
        change=change,
        edits=edits,
    )


def _of_cause(study: Study, cause: Cause, edits: tuple[Edit, ...]) -> Advice:
    claim = study.case.claim(cause.claim) if cause.claim else None
    rule = "" if cause.head is None else cause.head.rule
    mended = any(one.key != CLAIM for one in edits)
    fix = "" if mended else _FIXES.get(rule, "")
    change = " ".join(one for one in (fix, _told(study, claim, edits)) if one)
    unknown = "Compare the numbers with those of your program, and correct the text."
    against = cause.severity is Severity.ERROR
    urgency = Urgency.CONTRADICTED if against else Urgency.DOUBTFUL
    return _advice(urgency, claim, " ".join(plainly(study.case, cause)), change or unknown, edits)


# --- sentences ------------------------------------------------------------------------------------


def _told(study: Study, about: AnyClaim | None, edits: Sequence[Edit]) -> str:
    """Edits as sentences; those of another claim than is spoken of name their place."""
    groups: dict[str | None, dict[str, Edit]] = {}
    for one in edits:
        groups.setdefault(one.claim, {})[one.key] = one
    said = []
    for claim_id, keys in groups.items():
        if claim_id is None:
            (meant,) = next(iter(keys.values())).becomes
            why = next(one.why for one in study.case.readings if one.id == meant)
            said.append(f"The numbers given here assume “{why.removesuffix('.')}”.")
            continue
        claim = study.case.claim(claim_id)
        sentence = _sentence(study, claim, keys)
        elsewhere = about is not None and claim.id != about.id and claim.where != about.where
        where = f"{claim.where[:1].upper()}{claim.where[1:]}"
        said.append(f"{where}: {sentence}" if elsewhere else sentence)
    return " ".join(said)


def _sentence(study: Study, claim: AnyClaim, keys: dict[str, Edit]) -> str:
    unit = study.time_unit
    if CLAIM in keys:
        words = claim_text(study.case, claim).removesuffix(".")
        return f"Leave out “{words}”, or correct what it rests on."
    if "durations" in keys:
        edit = keys["durations"]
        total = f"(total {sum(map(Decimal, edit.becomes))} {unit})"
        shown = f"{', '.join(edit.becomes)} {unit} {total}"
        if isinstance(claim, MaximumClaim):
            return f"Print {shown}, the longest duration of each segment over the rows."
        trigger = None if edit.trigger is None else study.case.claim(edit.trigger)
        if isinstance(trigger, StatementClaim) and trigger.checks == "optimal":
            return (
                f"Print the shortest motion, rounded up: {shown} keep every limit as printed. Or "
                "say how far yours is from it instead of calling it optimal."
            )
        return f"Lengthen the durations and round up: {shown} keep every limit as printed."
    ((key, edit),) = keys.items() if len(keys) == 1 else [("", next(iter(keys.values())))]
    shown = ", ".join(edit.becomes)
    if key == "total":
        return f"Print {shown} {unit} as the total, or correct the parts."
    if key == "value" and claim.quantity == "total_time":
        return f"Print {shown} {unit}."
    if "percent" in keys:
        seconds = f" and {keys['seconds'].becomes[0]} {unit}" if "seconds" in keys else ""
        return f"Print {keys['percent'].becomes[0]} %{seconds}."
    if key == "seconds":
        return f"Print {shown} {unit}."
    pairs = zip(edit.printed, edit.becomes, strict=True)
    return f"Print {', '.join(f'{new} instead of {old}' for old, new in pairs if old != new)}."


def _of_readings(
    study: Study, claim: AnyClaim, judgement: Judgement, edits: tuple[Edit, ...]
) -> Advice:
    whys = {r.id: r.why.removesuffix(".") for r in study.case.readings}
    groups: dict[ClaimVerdict, list[str]] = {}
    for rid, word in judgement.readings.items():
        groups.setdefault(word, []).append(whys.get(rid, rid))
    parts = []
    for word, names in groups.items():
        more = f" (and {len(names) - 1} more)" if len(names) > 1 else ""
        parts.append(f"{word} if “{names[0]}”{more}")
    ways = f"{len(judgement.readings)} ways, and this is {'; '.join(parts)}"
    told = f" {_told(study, claim, edits)}" if edits else ""
    return _advice(
        Urgency.DOUBTFUL,
        claim,
        f"Your text can be read in {ways}.",
        f"State in the text which is meant: units, curve, knots and ends.{told}",
        edits,
    )


def _left_open(study: Study) -> Iterator[Advice]:
    """What the case file lists as open: assumptions, and settings of algorithms."""
    for assumption in study.case.assumptions:
        says = f"Left open: {assumption.text}"
        change = f"Say which holds. Assumed here: {assumption.choice}"
        yield _advice(Urgency.OPEN, None, says, change, where="the text")
    for block in study.case.algorithms:
        for line in block.open:
            says = f"Left open for {block.name}: {line}"
            change = "Print this choice, so others can rerun the algorithm."
            yield _advice(Urgency.OPEN, None, says, change, where=block.where or block.name)
