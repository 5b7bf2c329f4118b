"""The sceptic's room: proves a certificate again, and imports nothing else of trajgap.

``python -m trajgap.verify FILE...`` does so from the command line. Copied out alone, the folder
does the same as ``python -I FOLDER FILE...``, with the standard library only; proofs about C4
quintic splines need numpy. Format and mathematics are in docs/certificates.md.
"""

from .certificate import (
    CERTIFICATE_FORMAT,
    SECONDS,
    STATE_FORMAT,
    CertificateVerdict,
    CertifiedQuestion,
    seal,
    verify_certificate,
)
from .reading import Refused, number, shown
from .tree import CUT, LEAF, OPEN, Subject

__all__ = [
    "CERTIFICATE_FORMAT",
    "CUT",
    "LEAF",
    "OPEN",
    "SECONDS",
    "STATE_FORMAT",
    "CertificateVerdict",
    "CertifiedQuestion",
    "Refused",
    "Subject",
    "number",
    "seal",
    "shown",
    "verify_certificate",
]
