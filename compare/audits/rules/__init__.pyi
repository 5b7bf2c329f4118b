from .condition_count import judge_counts
from .continuous_time import judge_motions, said_to_keep
from .distances import judge_distances
from .on_instances import HANDLED, attributed, judge_instances, placed
from .open_points import list_open_points
from .printed_chain import judge_kinematics
from .printed_digits import judge_digits
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
    "judge_instances",
    "judge_kinematics",
    "judge_motions",
    "judge_replays",
    "judge_scaling",
    "judge_vertices",
    "list_open_points",
    "placed",
    "said_to_keep",
    "vertices",
]
