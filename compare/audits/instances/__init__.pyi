from .drawn import examined, readings_of
from .entries import examined_entry
from .result import (
    MIDDLE,
    InstancesResult,
    Optimum,
    Sample,
    distribution,
    percent_range,
    reproduced,
)
from .study import STARTS

__all__ = [
    "MIDDLE",
    "STARTS",
    "InstancesResult",
    "Optimum",
    "Sample",
    "distribution",
    "examined",
    "examined_entry",
    "percent_range",
    "readings_of",
    "reproduced",
]
