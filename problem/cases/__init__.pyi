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
from .instances import FamilyBlock, family_waypoints
from .load import load_case, parse_case, published_ids
from .robot_file import load_robot, robot_ids
from .scaffolding import scaffold
from .schema import (
    Algorithm,
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
from .statement import Posing

__all__ = [
    "Algorithm",
    "AnyClaim",
    "Assumption",
    "Cartesian",
    "Case",
    "CaseFile",
    "Claim",
    "ConditionsClaim",
    "ControlVerticesClaim",
    "ConvergenceClaim",
    "DurationBox",
    "DurationsClaim",
    "FamilyBlock",
    "ImprovementClaim",
    "MaximumClaim",
    "NotCheckable",
    "PeakClaim",
    "Posing",
    "ProblemBlock",
    "Reading",
    "Robot",
    "Source",
    "StatementClaim",
    "Table",
    "TotalTimeClaim",
    "case_schema",
    "family_waypoints",
    "load_case",
    "load_robot",
    "parse_case",
    "published_ids",
    "robot_ids",
    "scaffold",
]
