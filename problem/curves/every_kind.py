"""The functions that each kind of curve registers, with every kind registered.

The face hands these out, so that whoever asks for one of them finds all kinds known, whatever was
imported before.
"""

from . import clamped_fit, stretched, timed
from .kind import (
    batch_peaks,
    enclosed,
    end_conditions,
    fit,
    for_joint,
    motion_values,
    segment_of,
    smooth_order,
    value_gradients,
)
from .stretched import shape

KINDS = (clamped_fit, stretched, timed)
"""The modules that register a kind on import; the piecewise polynomial is registered in `kind`."""

__all__ = [
    "batch_peaks",
    "enclosed",
    "end_conditions",
    "fit",
    "for_joint",
    "motion_values",
    "segment_of",
    "shape",
    "smooth_order",
    "value_gradients",
]
