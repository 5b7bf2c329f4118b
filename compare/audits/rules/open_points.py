"""TG501: what the case file lists as not checkable from the text."""

from __future__ import annotations

from collections.abc import Iterator

from ....problem.cases import ImprovementClaim, StatementClaim
from ...documents import Basis, Finding
from ..study import Study
from .one_way import judge_one_way
from .rule_group import Explained, rule_group

TG501 = Explained(
    "TG501",
    "Not checkable from the text",
    "What information does the text lack that a claim needs?",
    "Not checkable, with the reason.",
    "Way-points are shown in a figure only.",
    basis=Basis.TEXT,
)


@rule_group(TG501, without_waypoints=True)
def list_open_points(study: Study) -> Iterator[Finding]:
    """One finding per statement and per damaged passage, never more than "not checkable"."""
    for claim in study.claims:
        if isinstance(claim, StatementClaim) and claim.not_checkable:
            why = claim.not_checkable.removesuffix(".")
            yield TG501.finding(claim, "claim", f"{why}.")
    if not study.has_problems:
        yield from _without_waypoints(study)
    for item in study.case.not_checkable:
        yield TG501.finding(None, "passage", f"{item.where}: {item.what}", item.why)


def _without_waypoints(study: Study) -> Iterator[Finding]:
    """What cannot be said of claims while the way-points are missing."""
    by_one_way = {found.claim for found in judge_one_way(study)}
    for claim in study.claims:
        said = isinstance(claim, StatementClaim) and bool(claim.not_checkable)
        said = said or claim.id in by_one_way
        if said or isinstance(claim, ImprovementClaim):
            continue
        why = (study.case.statement(claim.problem).waypoints.not_printed or "").removesuffix(".")
        sentence = f"Without the way-points, nothing can be computed: {why}."
        yield TG501.finding(claim, "way-points", sentence)
