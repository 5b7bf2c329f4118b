"""The sceptic's room: proves a certificate again, and imports nothing else of trajgap.

``python -m trajgap.verify FILE...`` does so from the command line. Copied out alone, the folder
does the same as ``python -I FOLDER FILE...``, with the standard library only; proofs about declared
polynomials and C4 quintic splines need numpy. Format and mathematics are in
docs/explanation/certificates.md.
"""

from .answer import check_answer as check_answer
from .any_curve import check_motion as check_motion
from .any_curve import spans_of as spans_of
from .problem import CHORD as CHORD
from .problem import StatedProblem as StatedProblem
from .problem import read_problem as read_problem
from .ranges import MIX as MIX
from .ranges import MIX_DIGITS as MIX_DIGITS
from .ranges import MOST_DEPTH as MOST_DEPTH
from .ranges import MOST_INTEGER as MOST_INTEGER
from .ranges import MOST_POWER as MOST_POWER
from .ranges import MOST_WEIGHT as MOST_WEIGHT
from .ranges import PLACES as PLACES
from .ranges import QUINTIC_PLACES as QUINTIC_PLACES
from .ranges import SHORTEST_TOTAL as SHORTEST_TOTAL
from .ranges import SPOTS as SPOTS
from .ranges import TANGENT_UNIT as TANGENT_UNIT
from .ranges import TICKS as TICKS
from .ranges import WINDOW_UNIT as WINDOW_UNIT
from .reading import Clock as Clock
from .reading import OutOfTime as OutOfTime
from .reading import Refused as Refused
from .reading import number as number
from .reading import read_document as read_document
from .reading import shown as shown
from .tree import CUT as CUT
from .tree import LEAF as LEAF
from .tree import OPEN as OPEN
from .tree import Subject as Subject
from .verdict import CERTIFICATE_FORMAT as CERTIFICATE_FORMAT
from .verdict import OLD_FORMATS as OLD_FORMATS
from .verdict import SECONDS as SECONDS
from .verdict import STATE_FORMAT as STATE_FORMAT
from .verdict import CertificateVerdict as CertificateVerdict
from .verdict import CertifiedQuestion as CertifiedQuestion
from .verdict import proof_kind as proof_kind
from .verdict import seal as seal
from .verdict import verify_certificate as verify_certificate
