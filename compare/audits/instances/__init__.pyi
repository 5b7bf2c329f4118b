from .drawn import STARTS, examinable, examined, readings_of, unexamined
from .result import (
    MIDDLE,
    InstancesResult,
    Optimum,
    Sample,
    distribution,
    examined_entry,
    percent_range,
    reproduced,
)

__all__ = [
    "MIDDLE",
    "STARTS",
    "InstancesResult",
    "Optimum",
    "Sample",
    "distribution",
    "examinable",
    "examined",
    "examined_entry",
    "percent_range",
    "readings_of",
    "reproduced",
    "unexamined",
]
