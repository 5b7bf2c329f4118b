"""Runs here report after every batch: what is interrupted at a report depends on no clock."""

import pytest
from trajgap.nlp.proofs import crew, session


@pytest.fixture(autouse=True)
def talkative(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(session.Session, "often", 0.0)


@pytest.fixture
def at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """Processes are started for the first pieces."""
    monkeypatch.setattr(crew.ProofCrew, "worth", 0.0)
