from .between import check_samples as check_samples
from .digits import HalfUnits as HalfUnits
from .divided import neighbours as neighbours
from .floor import Floor as Floor, shortest as shortest
from .foreign_objects import as_motion as as_motion
from .interpolation import interpolated as interpolated
from .joint_limits import (
    BRAKING as BRAKING,
    ORDERS as ORDERS,
    JointLimits as JointLimits,
    check_range as check_range,
    unstated_words as unstated_words,
)
from .judged import (
    MOTION_TOLERANCE as MOTION_TOLERANCE,
    MotionCheck as MotionCheck,
    MotionJump as MotionJump,
    MotionPeak as MotionPeak,
    check_motion as check_motion,
)
from .motion import Motion as Motion, numbered as numbered
from .plain_data import number_of as number_of, read_yaml as read_yaml
from .reading import (
    UNITS as UNITS,
    ForeignFile as ForeignFile,
    factors_of as factors_of,
    read_motion as read_motion,
)
from .samples import Interpolation as Interpolation, Samples as Samples
from .written import (
    Evaluated as Evaluated,
    MotionForm as MotionForm,
    csv_text as csv_text,
    motion_text as motion_text,
    read_back as read_back,
    sampled as sampled,
)
