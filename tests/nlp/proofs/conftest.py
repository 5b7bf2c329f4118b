"""Runs here report after every batch: what is interrupted at a report depends on no clock."""

import pytest
from trajgap.nlp.proofs import session


@pytest.fixture(autouse=True)
def talkative(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(session.Session, "often", 0.0)
