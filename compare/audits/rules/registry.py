"""Every rule of the audit, by its permanent id."""

from __future__ import annotations

from collections import ChainMap

from ...documents import Basis, Rule
from .along_path import judge_along_paths
from .compared_before import cite_comparisons
from .continuous_time import judge_bare_totals, judge_motions
from .distances import judge_distances
from .improvements import judge_improvements
from .linear_blends import judge_blends
from .motion_numbers import judge_numbers
from .on_instances import judge_instances
from .open_points import list_open_points
from .other_places import judge_places
from .peaks import judge_peak_limits
from .printed_chain import judge_kinematics
from .printed_digits import judge_digits
from .printed_joints import judge_joints
from .printed_tables import judge_tables
from .profiles import judge_profiles
from .replays import judge_replays
from .rule_group import Explained
from .scaling_law import judge_scaling
from .stated_curve import judge_counts, judge_vertices

GROUPS = (
    judge_digits,
    judge_joints,
    judge_improvements,
    judge_tables,
    judge_counts,
    judge_motions,
    judge_bare_totals,
    judge_numbers,
    judge_peak_limits,
    judge_blends,
    judge_places,
    judge_vertices,
    judge_scaling,
    judge_distances,
    judge_profiles,
    judge_along_paths,
    judge_replays,
    judge_instances,
    cite_comparisons,
    list_open_points,
    judge_kinematics,
)
"""In the order in which their findings of one severity and id stand; a new rule adds its line."""

NOT_COMPUTED = Explained(
    "TG502",
    "Not computed for this problem; the message says why",
    "What could not be computed here, and why?",
    "Not checkable, with the reason.",
    "The solver found no motion within the limits, so no distance can be given.",
    basis=Basis.CHECK,
)
"""Stands instead of a finding that a group could not compute; the audit itself says it."""

EXPLAINED = dict(
    sorted(ChainMap({NOT_COMPUTED.id: NOT_COMPUTED}, *(g.rules for g in GROUPS)).items())
)
"""Every rule by its id."""

RULES = tuple(Rule(one.id, one.title) for one in EXPLAINED.values())
"""Their ids and titles."""
