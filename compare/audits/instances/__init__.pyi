from .drawn import (
    STARTS as STARTS,
    examinable as examinable,
    examined as examined,
    readings_of as readings_of,
    unexamined as unexamined,
)
from .result import (
    MIDDLE as MIDDLE,
    InstancesResult as InstancesResult,
    Optimum as Optimum,
    Sample as Sample,
    distribution as distribution,
    examined_entry as examined_entry,
    percent_range as percent_range,
    reproduced as reproduced,
)
