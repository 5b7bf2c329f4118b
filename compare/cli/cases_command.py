"""The command `cases`: the published cases."""

from __future__ import annotations

from ...problem import published_ids
from ..blocks import Block, table
from ..documents import CasesDocument, cases_document, json_text
from .input import read_case
from .options import AsJson, Out
from .output import emit, new_output


def cases(as_json: AsJson = False, out: Out = None) -> int:
    """List the published cases."""
    with new_output(out) as write:
        document = cases_document(read_case(name) for name in published_ids())
        write(json_text(document))
    emit(document, _table, as_json)
    return 0


def _table(document: CasesDocument) -> list[Block]:
    rows = [
        (one.id, one.title, len(one.problems), len(one.readings), one.claims)
        for one in document.cases
    ]
    return [table(("case", "~title", ">problems", ">readings", ">claims"), rows)]
