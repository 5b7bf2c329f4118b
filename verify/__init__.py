"""The sceptic's room: proves a certificate again, and imports nothing else of trajgap.

``python -m trajgap.verify FILE...`` does so from the command line. Copied out alone, the folder
does the same as ``python -I FOLDER FILE...``, with the standard library only; proofs about declared
polynomials and C4 quintic splines need numpy. Format and mathematics are in
docs/explanation/certificates.md.
"""

from .bounds import shown_bound
from .problem import CHORD, read_problem
from .ranges import (
    MIX_DIGITS,
    MOST_CUBIC_SEGMENTS,
    MOST_INTEGER,
    MOST_POWER,
    MOST_QUINTIC_JOINTS,
    MOST_QUINTIC_SEGMENTS,
    MOST_WEIGHT,
    PLACES,
    SHORTEST_TOTAL,
    SMALLEST,
    TICKS,
)
from .reading import Clock, OutOfTime, Refused, number, read_document, shown
from .tree import CUT, LEAF, OPEN, Subject
from .verdict import (
    CERTIFICATE_FORMAT,
    OLD_FORMATS,
    SECONDS,
    STATE_FORMAT,
    CertificateVerdict,
    CertifiedQuestion,
    proof_kind,
    seal,
    verify_certificate,
)

__all__ = [
    "CERTIFICATE_FORMAT",
    "CHORD",
    "CUT",
    "LEAF",
    "MIX_DIGITS",
    "MOST_CUBIC_SEGMENTS",
    "MOST_INTEGER",
    "MOST_POWER",
    "MOST_QUINTIC_JOINTS",
    "MOST_QUINTIC_SEGMENTS",
    "MOST_WEIGHT",
    "OLD_FORMATS",
    "OPEN",
    "PLACES",
    "SECONDS",
    "SHORTEST_TOTAL",
    "SMALLEST",
    "STATE_FORMAT",
    "TICKS",
    "CertificateVerdict",
    "CertifiedQuestion",
    "Clock",
    "OutOfTime",
    "Refused",
    "Subject",
    "number",
    "proof_kind",
    "read_document",
    "read_problem",
    "seal",
    "shown",
    "shown_bound",
    "verify_certificate",
]
