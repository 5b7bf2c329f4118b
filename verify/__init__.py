"""The sceptic's room: proves a certificate again, and imports nothing else of trajgap.

``python -m trajgap.verify FILE...`` does so from the command line. Copied out alone, the folder
does the same as ``python -I FOLDER FILE...``, with the standard library only; proofs about declared
polynomials and C4 quintic splines need numpy. Format and mathematics are in
docs/explanation/certificates.md.
"""

from .answer import check_answer as check_answer
from .any_curve import check_motion as check_motion, spans_of as spans_of
from .problem import CHORD as CHORD, StatedProblem as StatedProblem, read_problem as read_problem
from .ranges import (
    MIX as MIX,
    MIX_DIGITS as MIX_DIGITS,
    MOST_DEPTH as MOST_DEPTH,
    MOST_INTEGER as MOST_INTEGER,
    MOST_POWER as MOST_POWER,
    MOST_WEIGHT as MOST_WEIGHT,
    PLACES as PLACES,
    QUINTIC_PLACES as QUINTIC_PLACES,
    SHORTEST_TOTAL as SHORTEST_TOTAL,
    SPOTS as SPOTS,
    TANGENT_UNIT as TANGENT_UNIT,
    TICKS as TICKS,
    WINDOW_UNIT as WINDOW_UNIT,
)
from .reading import (
    Clock as Clock,
    OutOfTime as OutOfTime,
    Refused as Refused,
    number as number,
    read_document as read_document,
    shown as shown,
)
from .tree import CUT as CUT, LEAF as LEAF, OPEN as OPEN, Subject as Subject
from .verdict import (
    CERTIFICATE_FORMAT as CERTIFICATE_FORMAT,
    OLD_FORMATS as OLD_FORMATS,
    SECONDS as SECONDS,
    STATE_FORMAT as STATE_FORMAT,
    CertificateVerdict as CertificateVerdict,
    CertifiedQuestion as CertifiedQuestion,
    proof_kind as proof_kind,
    seal as seal,
    verify_certificate as verify_certificate,
)
