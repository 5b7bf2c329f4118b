from .instance import BenchmarkInstance, BoundEvidence, Hardness
from .plain import LOADER, plain_text
from .shelf import (
    instance_of,
    list_instances,
    load_instance,
    select_curve,
    select_instances,
    suite_version,
)

__all__ = [
    "LOADER",
    "BenchmarkInstance",
    "BoundEvidence",
    "Hardness",
    "instance_of",
    "list_instances",
    "load_instance",
    "plain_text",
    "select_curve",
    "select_instances",
    "suite_version",
]
