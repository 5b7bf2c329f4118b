"""What the terminal says of proofs that earlier runs kept."""

from __future__ import annotations


def kept_proofs(count: int) -> str:
    """One line for the end of an answer.

    It is about this run, like its seconds: no document says it, so that documents are the same
    with and without what was kept.
    """
    proofs = "1 kept proof was" if count == 1 else f"{count} kept proofs were"
    return f"{proofs} proved again instead of searched; --no-cache searches anew\n"
