from .between import check_samples
from .digits import HalfUnits
from .divided import neighbours
from .floor import Floor, shortest
from .foreign_objects import as_motion
from .interpolation import interpolated
from .joint_limits import BRAKING, ORDERS, JointLimits, check_range, unstated_words
from .judged import MOTION_TOLERANCE, MotionCheck, MotionJump, MotionPeak, check_motion
from .motion import MOST_VALUES, Motion, numbered
from .plain_data import read_yaml
from .reading import UNITS, ForeignFile, factors_of, read_motion
from .samples import Interpolation, Samples
from .written import Evaluated, MotionForm, csv_text, motion_text, read_back, sampled

__all__ = [
    "BRAKING",
    "MOST_VALUES",
    "MOTION_TOLERANCE",
    "ORDERS",
    "UNITS",
    "Evaluated",
    "Floor",
    "ForeignFile",
    "HalfUnits",
    "Interpolation",
    "JointLimits",
    "Motion",
    "MotionCheck",
    "MotionForm",
    "MotionJump",
    "MotionPeak",
    "Samples",
    "as_motion",
    "check_motion",
    "check_range",
    "check_samples",
    "csv_text",
    "factors_of",
    "interpolated",
    "motion_text",
    "neighbours",
    "numbered",
    "read_back",
    "read_motion",
    "read_yaml",
    "sampled",
    "shortest",
    "unstated_words",
]
