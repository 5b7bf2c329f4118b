"""The registry of proofs: each entry is there, and speaks about one subject."""

from __future__ import annotations

from trajgap.nlp.proofs.certifier import Certifier
from trajgap.nlp.proofs.certifiers import CERTIFIERS, certifiers
from trajgap.verify import Subject


def test_every_entry_is_a_certifier() -> None:
    declared, every = certifiers(Subject.DECLARED), certifiers(Subject.ANY)
    assert all(isinstance(one, Certifier) for one in (*declared, *every))
    assert len({id(one) for one in (*declared, *every)}) == len(CERTIFIERS)
    assert len(every) == 1
    assert [one.instant for one in declared].index(True) == 0
