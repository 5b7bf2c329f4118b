from .instance import (
    BenchmarkInstance as BenchmarkInstance,
    BoundEvidence as BoundEvidence,
    Hardness as Hardness,
)
from .plain import LOADER as LOADER, plain_text as plain_text
from .shelf import (
    instance_of as instance_of,
    list_instances as list_instances,
    load_instance as load_instance,
    select_curve as select_curve,
    select_instances as select_instances,
    suite_version as suite_version,
)
