"""The sceptic's room: proves a certificate again, and imports nothing else of trajgap.

``python -m trajgap.verify FILE...`` does so from the command line. Copied out alone, the folder
does the same as ``python -I FOLDER FILE...``, with the standard library only; proofs about declared
polynomials and C4 quintic splines need numpy. Format and mathematics are in
docs/explanation/certificates.md.
"""

from .answer import check_answer
from .any_curve import check_motion, spans_of
from .floors import least_durations
from .problem import CHORD, StatedProblem, read_problem
from .ranges import (
    MIX,
    MIX_DIGITS,
    MOST_DEPTH,
    MOST_INTEGER,
    MOST_POWER,
    MOST_WEIGHT,
    PLACES,
    QUINTIC_PLACES,
    SHORTEST_TOTAL,
    SPOTS,
    TANGENT_UNIT,
    TICKS,
    WINDOW_UNIT,
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
    "MIX",
    "MIX_DIGITS",
    "MOST_DEPTH",
    "MOST_INTEGER",
    "MOST_POWER",
    "MOST_WEIGHT",
    "OLD_FORMATS",
    "OPEN",
    "PLACES",
    "QUINTIC_PLACES",
    "SECONDS",
    "SHORTEST_TOTAL",
    "SPOTS",
    "STATE_FORMAT",
    "TANGENT_UNIT",
    "TICKS",
    "WINDOW_UNIT",
    "CertificateVerdict",
    "CertifiedQuestion",
    "Clock",
    "OutOfTime",
    "Refused",
    "StatedProblem",
    "Subject",
    "check_answer",
    "check_motion",
    "least_durations",
    "number",
    "proof_kind",
    "read_document",
    "read_problem",
    "seal",
    "shown",
    "spans_of",
    "verify_certificate",
]
