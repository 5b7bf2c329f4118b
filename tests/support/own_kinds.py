"""Splines of few segments proved by the kinds of their own, which longer ones have."""

from __future__ import annotations

import pytest
from trajgap.nlp.proofs import certifiers
from trajgap.nlp.proofs.certifier import Certifier
from trajgap.nlp.proofs.declared import FEW_SEGMENTS
from trajgap.nlp.proofs.exact import ExactProblem
from trajgap.verify import Subject


@pytest.fixture(autouse=True)
def own_kinds(monkeypatch: pytest.MonkeyPatch) -> None:
    """Tests that import it ask no boxes of durations first."""
    plain = certifiers._able

    def able(problem: ExactProblem, subject: Subject) -> list[Certifier]:
        return [one for one in plain(problem, subject) if one is not FEW_SEGMENTS]

    monkeypatch.setattr(certifiers, "_able", able)
