"""A forged document for every check of the verifier: that check refuses it, and none before it."""

from pathlib import Path

import pytest
from support.forgeries import of_documents, of_files
from support.forgeries.forgery import Forgery, checks, judged, listed, recorded

FORGERIES = [*of_files.FORGERIES, *of_documents.FORGERIES, *listed()]


def test_every_check_of_the_verifier_has_a_forgery() -> None:
    assert len(checks()) > 140
    assert {forgery.check for forgery in FORGERIES} == set(checks().values())


@pytest.mark.parametrize("forgery", FORGERIES, ids=lambda forgery: forgery.check[:70])
def test_each_forgery(forgery: Forgery, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with recorded(monkeypatch) as fired:
        verdict = judged(forgery, tmp_path, monkeypatch)
    assert not verdict.proves
    assert not verdict.out_of_time
    assert verdict.lower is None
    # A leaf passes on what refuses it, and so does a part of a tree.
    passes_on = forgery.check.startswith(("tree._below: leaf", "tree.walk: why"))
    assert fired, verdict
    assert fired[-1 if passes_on else 0] == forgery.check, verdict
