"""How much is read of what others give: more is no case, no motion and no robot."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class MostRead:
    """The most that is read, so that no file takes memory or time without end."""

    waypoints: int = 10_000
    """Of one problem: the curve through them takes half a second and 50 MB to declare."""
    poses: int = 500
    """Of a straight line in a case file: each takes some milliseconds of inverse kinematics."""
    joints: int = 100
    """Of one robot: no arm and no humanoid has as many."""
    entries: int = 1_000
    """Of one list of a case file, such as its claims: no paper prints as many."""
    values: int = 100_000
    """In a case file: 1,000 way-points of 10 joints take a tenth, reading them a few seconds."""
    pairs: int = 1_000
    """Problems times readings: each is a question, and the largest shipped case has 16."""
    angles: int = 200_000
    """Joint angles over all problems and readings, 50 microseconds each: about ten seconds."""
    instances: int = 10_000
    """Of one block, all step lengths together: each is solved for every reading."""
    runs: int = 100_000
    """On the instances of one block: a millisecond or more each, as a rule hundreds."""
    seed: int = 2**63 - 1
    """What TOML promises to keep."""
    digits: int = 64
    """Characters of one number: arithmetic on more could run away."""
    exponent: int = 300
    """Powers of ten that a float64 holds, with room for units and outward rounding."""
    equation: int = 400
    """Characters of an equation with its definitions: twice the longest printed one, and no deeper
    than a stack bears."""
    positions: int = 10_000_000
    """Samples times joints of one motion, about half a gigabyte at work."""
    messages: int = 100_000
    """Of a bag, looked through for trajectories."""
    nesting: int = 40
    """Levels of plain data: a message of ROS has six."""
    case_bytes: int = 5_000_000
    """Two hundred times the longest case file shipped."""
    robot_bytes: int = 20_000_000
    """A hundred times the URDF of a humanoid."""
    yaml_bytes: int = 20_000_000
    """Reading it takes ten times as long as JSON, here up to a minute."""
    json_bytes: int = 300_000_000
    """Ten million positions with derivatives."""
    table_bytes: int = 500_000_000
    """Ten million positions with derivatives of 17 digits each."""
    bag_bytes: int = 2_000_000_000
    """A recording of an hour; what is read of it is one message."""


MOST = MostRead()
"""What holds everywhere."""
