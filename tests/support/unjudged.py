"""What a certifier found before `trajgap.verify` judged it: attacks on certifiers look at that."""

from __future__ import annotations

from importlib import import_module
from typing import Any

import pytest
from trajgap.nlp.proofs.judged import judged
from trajgap.nlp.proofs.outcome import Certified


def unjudged(monkeypatch: pytest.MonkeyPatch) -> list[Certified]:
    """A list that receives whatever certifiers find from now on."""

    def seen(found: Certified, *rest: Any) -> Certified:
        raw.append(found)
        return judged(found, *rest)

    raw: list[Certified] = []
    monkeypatch.setattr(import_module("trajgap.nlp.proofs.certifiers"), "judged", seen)
    return raw
