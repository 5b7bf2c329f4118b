from .pose import examined, readings_of
from .result import (
    MIDDLE,
    Effect,
    FamilyResult,
    Optimum,
    Procedure,
    Sample,
    distribution,
    percent_range,
    reproduced,
)
from .study import STARTS

__all__ = [
    "MIDDLE",
    "STARTS",
    "Effect",
    "FamilyResult",
    "Optimum",
    "Procedure",
    "Sample",
    "distribution",
    "examined",
    "percent_range",
    "readings_of",
    "reproduced",
]
