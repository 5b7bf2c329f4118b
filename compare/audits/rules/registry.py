"""Every rule of the audit, with its permanent id and what it looks at."""

from __future__ import annotations

from ...documents import Rule
from .compared_before import cite_comparisons
from .condition_count import judge_counts
from .continuous_time import judge_bare_totals, judge_motions
from .distances import judge_distances
from .improvements import judge_improvements
from .linear_blends import judge_blends
from .motion_numbers import judge_measures, judge_peaks, judge_values
from .on_instances import judge_instances
from .open_points import list_open_points
from .other_places import judge_places
from .peaks_and_limits import judge_peak_limits
from .printed_chain import judge_kinematics
from .printed_digits import judge_digits
from .printed_equations import judge_equations
from .printed_joints import judge_joints
from .printed_tables import judge_tables
from .printed_vertices import judge_vertices
from .profiles import judge_profiles
from .replays import judge_replays
from .rule_group import RuleGroup
from .scaling_law import judge_scaling

GROUPS = (
    RuleGroup(
        judge_digits,
        {
            "TG101": "A printed total is the sum of its printed parts",
            "TG102": "Printed longest durations are the longest of the printed rows",
            "TG106": "Unrelated columns do not repeat each other's digits",
            "TG109": "As many durations are printed as there are segments",
        },
        without_waypoints=True,
    ),
    RuleGroup(
        judge_joints,
        {
            "TG110": "A joint that is said to vary most does, among the printed joints",
            "TG602": "A position that is said to lie above another does",
        },
        without_waypoints=True,
    ),
    RuleGroup(
        judge_improvements,
        {"TG103": "A printed improvement follows from the printed totals"},
        without_waypoints=True,
    ),
    RuleGroup(
        judge_tables,
        {
            "TG104": "Tables under different names print different digits",
            "TG105": "Two places that print the same total agree",
        },
        without_waypoints=True,
    ),
    RuleGroup(
        judge_counts,
        {
            "TG107": "The conditions stated fit the number of coefficients",
            "TG207": "The motion is at rest where it is said to be",
        },
    ),
    RuleGroup(
        judge_motions,
        {
            "TG201": "Printed durations keep the limits for all t, over the rounding box",
            "TG202": "Position, velocity and acceleration are continuous",
            "TG204": "The limits are used up by the printed durations",
            "TG206": "Acceleration jumps where it is said to",
        },
    ),
    RuleGroup(judge_bare_totals, {}),  # finds what TG201 finds
    RuleGroup(judge_peaks, {"TG203": "Printed peaks are those of the printed durations"}),
    RuleGroup(judge_peak_limits, {"TG209": "Printed peaks lie within the limits that they keep"}),
    RuleGroup(
        judge_blends,
        {"TG210": "Linear segments with parabolic blends keep the limits"},
    ),
    RuleGroup(
        judge_measures,
        {"TG208": "Printed means and integrals are those of the printed durations"},
    ),
    RuleGroup(
        judge_values, {"TG211": "Printed values at one place are those of the printed durations"}
    ),
    RuleGroup(judge_places, {"TG108": "Printed numbers fit their own row, column or table best"}),
    RuleGroup(
        judge_vertices,
        {"TG205": "Printed control vertices follow from the printed way-points"},
    ),
    RuleGroup(
        judge_scaling,
        {"TG301": "Totals of one path under two velocity limits obey the scaling law"},
    ),
    RuleGroup(
        judge_distances,
        {
            "TG302": "A printed total beside the optimum of its own formulation",
            "TG303": "A printed total beside the optimum with shared durations",
        },
    ),
    RuleGroup(
        judge_profiles,
        {"TG304": "What is printed of a profile beside the profile that the limits allow"},
    ),
    RuleGroup(
        judge_replays,
        {
            "TG401": "An improvement beside the spread over seeds",
            "TG402": "A printed total beside replays of its algorithm",
            "TG403": "Convergence within a number of iterations, beside replays",
        },
    ),
    RuleGroup(
        judge_instances,
        {"TG404": "A relative claim beside instances drawn from the robot's workspace"},
        without_waypoints=True,
    ),
    RuleGroup(
        cite_comparisons,
        {"TG405": "A comparison of two algorithms beside a committed study of it"},
        without_waypoints=True,
    ),
    RuleGroup(list_open_points, {"TG501": "Not checkable from the text"}, without_waypoints=True),
    RuleGroup(
        judge_kinematics,
        {"TG601": "Joint and Cartesian way-points are consistent with the printed chain"},
    ),
    RuleGroup(
        judge_equations,
        {"TG603": "Printed kinematic equations hold on the printed chain"},
        without_waypoints=True,
    ),
)
"""In the order in which their findings of one severity and id stand; a new rule adds its line."""

NOT_COMPUTED = Rule("TG502", "Not computed for this problem; the message says why")
"""What stands in place of a finding that a group could not compute; the audit itself says it."""

RULES = tuple(
    sorted(
        (
            NOT_COMPUTED,
            *(Rule(id_, title) for group in GROUPS for id_, title in group.rules.items()),
        ),
        key=lambda rule: rule.id,
    )
)
"""Every rule, by its id."""
