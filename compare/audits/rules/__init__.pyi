from .condition_count import judge_counts
from .continuous_time import judge_motions
from .distances import judge_distances
from .improvements import judge_improvements
from .on_instances import HANDLED, attributed, judge_instances, placed
from .open_points import list_open_points
from .other_places import judge_places
from .peaks import judge_peaks
from .printed_chain import judge_kinematics
from .printed_digits import judge_digits
from .printed_tables import judge_tables
from .printed_vertices import Vertex, judge_vertices, vertices
from .replays import judge_replays
from .scaling_law import judge_scaling

__all__ = [
    "HANDLED",
    "Vertex",
    "attributed",
    "judge_counts",
    "judge_digits",
    "judge_distances",
    "judge_improvements",
    "judge_instances",
    "judge_kinematics",
    "judge_motions",
    "judge_peaks",
    "judge_places",
    "judge_replays",
    "judge_scaling",
    "judge_tables",
    "judge_vertices",
    "list_open_points",
    "placed",
    "vertices",
]
