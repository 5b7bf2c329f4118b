from .case import Case as Case
from .claim import (
    AnyClaim as AnyClaim,
    AuthorsAnswer as AuthorsAnswer,
    Claim as Claim,
    ConditionsClaim as ConditionsClaim,
    ControlVerticesClaim as ControlVerticesClaim,
    ConvergenceClaim as ConvergenceClaim,
    DurationsClaim as DurationsClaim,
    ImprovementClaim as ImprovementClaim,
    MaximumClaim as MaximumClaim,
    MeasureClaim as MeasureClaim,
    MotionValueClaim as MotionValueClaim,
    Nature as Nature,
    PeakClaim as PeakClaim,
    PhasesClaim as PhasesClaim,
    ProfiledClaim as ProfiledClaim,
    StatementClaim as StatementClaim,
    TimeClaim as TimeClaim,
    TotalTimeClaim as TotalTimeClaim,
    ValueClaim as ValueClaim,
)
from .claim_fit import (
    motions_of as motions_of,
    named_places as named_places,
    profile_of as profile_of,
)
from .clue import (
    AnyClue as AnyClue,
    AxisClue as AxisClue,
    DataSheetClue as DataSheetClue,
    HalfTurnsClue as HalfTurnsClue,
    SmoothClue as SmoothClue,
)
from .data_files import (
    PUBLISHED as PUBLISHED,
    SUITE_PREFIX as SUITE_PREFIX,
    case_files as case_files,
    check_format as check_format,
    load_robot as load_robot,
    robot_ids as robot_ids,
    validated as validated,
)
from .digits import Digits as Digits, RoundingBox as RoundingBox, end as end
from .faults import all_faults as all_faults, refusal as refusal
from .instances import InstancesBlock as InstancesBlock, instance_waypoints as instance_waypoints
from .joint_units import unit_of as unit_of, with_unit as with_unit
from .labels import ratio_words as ratio_words
from .load import (
    check_case as check_case,
    load_case as load_case,
    parse_case as parse_case,
    published_ids as published_ids,
)
from .moving_ends import end_states as end_states
from .scaffolding import (
    FileLimits as FileLimits,
    identity_of as identity_of,
    scaffold as scaffold,
    units_in_header as units_in_header,
)
from .schema import (
    AlgorithmBlock as AlgorithmBlock,
    Assumption as Assumption,
    Cartesian as Cartesian,
    CaseFile as CaseFile,
    Column as Column,
    NotCheckable as NotCheckable,
    ProblemBlock as ProblemBlock,
    Reading as Reading,
    Robot as Robot,
    Source as Source,
    Table as Table,
    Transcription as Transcription,
    case_schema as case_schema,
)
from .statement import Statement as Statement
from .transcripts import Difference as Difference, compare_transcriptions as compare_transcriptions
