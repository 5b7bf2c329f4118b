from .case import Case, DurationBox
from .claim import (
    AnyClaim,
    AuthorsAnswer,
    Claim,
    ConditionsClaim,
    ControlVerticesClaim,
    ConvergenceClaim,
    DurationsClaim,
    ImprovementClaim,
    MaximumClaim,
    MeasureClaim,
    MotionValueClaim,
    Nature,
    PeakClaim,
    StatementClaim,
    TimeClaim,
    TotalTimeClaim,
)
from .claim_fit import motions_of
from .clue import AnyClue, AxisClue, DataSheetClue, HalfTurnsClue, SmoothClue
from .data_files import PUBLISHED, SUITE_PREFIX, case_files
from .digits import Digits
from .faults import all_faults, refusal
from .instances import InstancesBlock, instance_waypoints
from .joint_units import unit_of, with_unit
from .labels import ratio_words
from .load import load_case, parse_case, published_ids
from .robot_file import load_robot, robot_ids
from .scaffolding import identity_of, scaffold
from .schema import (
    AlgorithmBlock,
    Assumption,
    Cartesian,
    CaseFile,
    Column,
    NotCheckable,
    ProblemBlock,
    Reading,
    Robot,
    Source,
    Table,
    Transcription,
    case_schema,
)
from .statement import Statement
from .transcripts import Difference, compare_transcriptions

__all__ = [
    "PUBLISHED",
    "SUITE_PREFIX",
    "AlgorithmBlock",
    "AnyClaim",
    "AnyClue",
    "Assumption",
    "AuthorsAnswer",
    "AxisClue",
    "Cartesian",
    "Case",
    "CaseFile",
    "Claim",
    "Column",
    "ConditionsClaim",
    "ControlVerticesClaim",
    "ConvergenceClaim",
    "DataSheetClue",
    "Difference",
    "Digits",
    "DurationBox",
    "DurationsClaim",
    "HalfTurnsClue",
    "ImprovementClaim",
    "InstancesBlock",
    "MaximumClaim",
    "MeasureClaim",
    "MotionValueClaim",
    "Nature",
    "NotCheckable",
    "PeakClaim",
    "ProblemBlock",
    "Reading",
    "Robot",
    "SmoothClue",
    "Source",
    "Statement",
    "StatementClaim",
    "Table",
    "TimeClaim",
    "TotalTimeClaim",
    "Transcription",
    "all_faults",
    "case_files",
    "case_schema",
    "compare_transcriptions",
    "identity_of",
    "instance_waypoints",
    "load_case",
    "load_robot",
    "motions_of",
    "parse_case",
    "published_ids",
    "ratio_words",
    "refusal",
    "robot_ids",
    "scaffold",
    "unit_of",
    "with_unit",
]
