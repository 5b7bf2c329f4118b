from .case import Case, DurationBox
from .claim import (
    AnyClaim,
    Claim,
    ConditionsClaim,
    ControlVerticesClaim,
    ConvergenceClaim,
    DurationsClaim,
    ImprovementClaim,
    MaximumClaim,
    PeakClaim,
    StatementClaim,
    TimeClaim,
    TotalTimeClaim,
)
from .data_files import PUBLISHED
from .instances import InstancesBlock, instance_waypoints
from .load import load_case, parse_case, published_ids
from .references import motions_of_peak
from .robot_file import load_robot, robot_ids
from .scaffolding import scaffold
from .schema import (
    AlgorithmBlock,
    Assumption,
    Cartesian,
    CaseFile,
    NotCheckable,
    ProblemBlock,
    Reading,
    Robot,
    Source,
    Table,
    case_schema,
)
from .statement import Digits, Statement

__all__ = [
    "PUBLISHED",
    "AlgorithmBlock",
    "AnyClaim",
    "Assumption",
    "Cartesian",
    "Case",
    "CaseFile",
    "Claim",
    "ConditionsClaim",
    "ControlVerticesClaim",
    "ConvergenceClaim",
    "Digits",
    "DurationBox",
    "DurationsClaim",
    "ImprovementClaim",
    "InstancesBlock",
    "MaximumClaim",
    "NotCheckable",
    "PeakClaim",
    "ProblemBlock",
    "Reading",
    "Robot",
    "Source",
    "Statement",
    "StatementClaim",
    "Table",
    "TimeClaim",
    "TotalTimeClaim",
    "case_schema",
    "instance_waypoints",
    "load_case",
    "load_robot",
    "motions_of_peak",
    "parse_case",
    "published_ids",
    "robot_ids",
    "scaffold",
]
