"""Certificates on a page: each is proved again by the build, or the build fails."""

from __future__ import annotations

import hashlib
from pathlib import Path

from ...problem import TrajgapError
from ...verify import CertificateVerdict, Refused, read_document, verify_certificate
from ..blocks import Prose
from ..documents import capital, worth


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
