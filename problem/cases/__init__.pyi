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
    TotalTimeClaim,
)
from .instances import InstancesBlock, instance_waypoints
from .load import load_case, parse_case, published_ids
from .robot_file import load_robot, robot_ids
from .scaffolding import scaffold
from .schema import Cartesian, CaseFile, case_schema
from .statement import Statement

__all__ = [
    "AnyClaim",
    "Cartesian",
    "Case",
    "CaseFile",
    "Claim",
    "ConditionsClaim",
    "ControlVerticesClaim",
    "ConvergenceClaim",
    "DurationBox",
    "DurationsClaim",
    "ImprovementClaim",
    "InstancesBlock",
    "MaximumClaim",
    "PeakClaim",
    "Statement",
    "StatementClaim",
    "TotalTimeClaim",
    "case_schema",
    "instance_waypoints",
    "load_case",
    "load_robot",
    "parse_case",
    "published_ids",
    "robot_ids",
    "scaffold",
]
