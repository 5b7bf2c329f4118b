from .as_timed_by_toppra import retimed_motion as retimed_motion
from .squared_speed import (
    PathTime as PathTime,
    bound_along as bound_along,
    largest_derivatives as largest_derivatives,
)
from .third_order import (
    jerk_limited_path as jerk_limited_path,
    retime_third_order as retime_third_order,
)
from .toppra_check import Retiming as Retiming, retime as retime
