"""A tree judged in parts: the same verdict as in one walk."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Iterator
from typing import Any

import pytest
from support.certificate_kinds import text
from support.cubic_problems import base
from trajgap.nlp.proofs.document import certificate
from trajgap.verify import tree, verify_certificate


def in_parts(work: Callable[..., Any], common: Any, items: Iterable[Any]) -> Iterator[Any]:
    """Each part is judged after the next one was reached."""
    before = None
    for item in items:
        if before is not None:
            yield work(common, *before)
        before = item
    if before is not None:
        yield work(common, *before)


KINDS_IN_PARTS = ("cubic", "quintic-spline")


def small(kind: str) -> dict[str, Any]:
    """A small certificate, to be altered."""
    found: dict[str, Any] = json.loads(
        json.dumps(certificate(base())) if kind == "cubic" else text(kind)
    )
    return found


@pytest.mark.parametrize("kind", KINDS_IN_PARTS)
def test_parts_prove_what_one_walk_proves(kind: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(tree, "_LEAST", 1)
    document = small(kind)
    parts: list[int] = []

    def counted(work: Any, common: Any, items: Any) -> Iterator[Any]:
        for found in in_parts(work, common, items):
            parts.append(1)
            yield found

    found = verify_certificate(document, spread=counted)
    assert found == verify_certificate(document)
    assert found.proves
    assert len(parts) > 1


@pytest.mark.parametrize("kind", KINDS_IN_PARTS)
def test_whatever_is_wrong_with_a_tree_is_refused_in_parts_too(
    kind: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(tree, "_LEAST", 1)
    document = small(kind)
    nodes = document["proof"]["tree"]
    leaves = [n for n, node in enumerate(nodes) if type(node) is list and node[0] == "."]
    wrong = [[*nodes[:n], ["?"], *nodes[n + 1 :]] for n in leaves]
    wrong += [[*nodes[:n], *nodes[n + 1 :]] for n in range(len(nodes))]
    wrong += [[*nodes, ["."]], [*nodes[:-1], []], [*nodes[:-1], 7.0], [["."]], [{}]]
    for altered in wrong:
        document["proof"]["tree"] = altered
        alone = verify_certificate(document)
        assert verify_certificate(document, spread=in_parts).proves == alone.proves
    document["proof"]["tree"] = wrong[0]
    assert "leaves a part open" in verify_certificate(document, spread=in_parts).reason


def test_parts_end_with_the_time() -> None:
    document = small("cubic")
    late = verify_certificate(document, seconds=0.0, spread=in_parts)
    assert late.out_of_time


def test_leaves_of_a_part_wait_for_no_other_part(monkeypatch: pytest.MonkeyPatch) -> None:
    """Parts may be judged at the same time with one copy of what they have in common."""
    monkeypatch.setattr(tree, "_LEAST", 1)
    judged: list[int] = []

    def guarded(work: Any, common: Any, items: Any) -> Iterator[Any]:
        waiting = common._waiting
        for item in items:
            before = list(waiting)
            yield work(common, *item)
            assert common._waiting is waiting
            assert waiting == before
            judged.append(len(item[1]))

    assert verify_certificate(small("quintic-spline"), spread=guarded).proves
    assert sum(judged) > 2
