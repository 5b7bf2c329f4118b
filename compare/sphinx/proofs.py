"""Certificates and instances of the suite: each proof is verified by the build, or it fails."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from pathlib import Path

from ...problem import TrajgapError
from ...problem.suite import BenchmarkInstance, list_instances, select_curve
from ...verify import CertificateVerdict, Refused, read_document, verify_certificate
from ..blocks import Prose
from ..documents import capital, worth

PROVED_WITHIN = 0.25
"""s: a certificate whose proof took at most so long, as the suite's table says, is proved again by
each build; the others, less than a sixth, take half a minute together."""


def instances_of(curve: str | None) -> Sequence[BenchmarkInstance]:
    """Instances of a curve by its whole name, or by a word as `trajgap suite --curve` takes it."""
    every = list_instances()
    if curve is None:
        return every
    chosen = [one for one in every if one.curve == curve] or select_curve(curve)
    if not chosen:
        known = ", ".join(sorted({one.curve for one in every}))
        raise TrajgapError(f":curve: no curve is called {curve!r}; known: {known}")
    return chosen


def proved_again(path: Path, sha256: str | None = None) -> CertificateVerdict:
    """What a certificate proves.

    `sha256`: of the file that a result or a table was made from.
    """
    try:
        if sha256 is not None and hashlib.sha256(path.read_bytes()).hexdigest() != sha256:
            raise TrajgapError(
                f"{path}: is not the certificate with SHA-256 {sha256}; recreate the result"
            )
        verdict = verify_certificate(read_document(path))
    except (Refused, OSError) as error:
        raise TrajgapError(f"{path}: {error}") from None
    if not verdict.proves:
        raise TrajgapError(f"{path}: its claim is not proved: {verdict.reason}")
    return verdict


def proof_said(path: Path, sha256: str | None = None, name: str = "") -> Prose:
    """What a certificate proves, in a paragraph; parameters as there, and its name if not empty."""
    verdict = proved_again(path, sha256)
    shown = f" ({name})" if name else ""
    said = f"{capital(verdict.reason)}. Verified when this page was built{shown}."
    return Prose(said, word=worth(verdict))
