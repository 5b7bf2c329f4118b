"""The command `cases`: the published cases."""

from __future__ import annotations

from ...problem import published_ids
from ..blocks import Block, table
from ..documents import CasesDocument, cases_document
from .input import read_case
from .output import AnswerOptions


def cases(to: AnswerOptions) -> int:
    """List the published cases."""
    to.answer(lambda: cases_document(map(read_case, published_ids())), _table)
    return 0


def _table(document: CasesDocument) -> list[Block]:
    rows = [
        (one.id, one.title, len(one.problems), len(one.readings), one.claims)
        for one in document.cases
    ]
    return [table(("case", "~title", ">problems", ">readings", ">claims"), rows)]
