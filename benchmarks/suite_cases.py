"""The instances of the suite: way-points, limits and curves, the same on every machine.

Seeded way-points and limits come from `random.Random(name).random()`, whose numbers Python promises
to keep from version to version. `make_suite.py` writes them as case files.
"""

from __future__ import annotations

import random
from collections.abc import Iterator
from itertools import pairwise

from suite_written import LIMITS, REACH, Written

# --- seeded ---------------------------------------------------------------------------------------

SEEDED: dict[str, list[tuple[int, int, str, int]]] = {
    # (segments, joints, limits, how many)
    "353": [
        *((3, n, kind, 1) for n in (1, 2, 3, 4, 5, 6, 7) for kind in ("v", "a", "j")),
        *((3, n, "vaj", 1) for n in (1, 2, 3, 6, 7)),
        (3, 1, "v-only", 2),
        (3, 6, "v-only", 1),
    ],
    "434": [
        *((3, n, kind, 1) for n in (1, 2, 4, 6) for kind in ("v", "a", "j")),
        *((3, n, "vaj", 1) for n in (1, 3, 7)),
    ],
    "cubic": [
        (2, 1, "vaj", 1),
        (2, 3, "j", 1),
        (3, 2, "a", 1),
        (4, 4, "v", 1),
        (5, 6, "vaj", 1),
        (6, 3, "j", 1),
        (7, 6, "a", 1),
        (8, 7, "vaj", 1),
        (10, 6, "v", 1),
        (10, 7, "vaj", 1),
    ],
    "natural": [
        (2, 2, "vaj", 1),
        (3, 3, "v", 1),
        (4, 6, "a", 1),
        (6, 2, "vaj", 1),
        (7, 6, "vaj", 1),
        (10, 7, "a", 1),
    ],
    "virtual": [(4, 6, "vaj", 1), (6, 6, "a", 1), (7, 6, "vaj", 1), (8, 6, "vaj", 1)],
    "quintic": [
        (2, 1, "v", 1),
        (2, 2, "a", 1),
        (2, 3, "vaj", 1),
        (2, 6, "va-only", 1),
        (3, 1, "a", 1),
        (3, 2, "vaj", 1),
        (3, 3, "va-only", 1),
        (3, 7, "v", 1),
        (4, 1, "vaj", 1),
        (4, 2, "va-only", 1),
        (4, 6, "a", 1),
    ],
    "septic": [
        (2, 1, "v", 1),
        (3, 2, "a", 1),
        (4, 3, "j", 1),
        (5, 6, "vaj", 1),
        (6, 7, "vaj", 1),
        (8, 4, "v", 1),
        (10, 7, "j", 1),
    ],
    "septic-c6": [(2, 2, "a", 1), (3, 3, "va-only", 1), (4, 6, "va-only", 1), (6, 7, "v", 1)],
}
"""Per curve: segments, joints, limits and how many of them are drawn."""


SEVERAL_BASINS: dict[str, list[tuple[int, int, str, int]]] = {
    # (segments, joints, limits, number)
    "353": [
        *((3, 1, "vaj", k) for k in (7, 22)),
        *((3, 1, "j", k) for k in (3, 12, 14, 17)),
    ],
    "434": [*((3, 1, "a", k) for k in (16, 18, 21)), (3, 3, "a", 8)],
}
"""Numbers, of the first 25, whose total has several minima over the directions of the durations, on
a grid: a test counts them again."""


def _numbered() -> Iterator[tuple[str, int, int, str, int]]:
    """Curve, segments, joints, limits and number of each seeded instance."""
    for curve, entries in SEEDED.items():
        for segments, joints, kind, count in entries:
            for k in range(1, count + 1):
                yield curve, segments, joints, kind, k
    for curve, entries in SEVERAL_BASINS.items():
        for segments, joints, kind, k in entries:
            yield curve, segments, joints, kind, k


def seeded() -> Iterator[Written]:
    """Instances through random way-points, each from a generator seeded with its own name."""
    for curve, segments, joints, kind, k in _numbered():
        name = f"{curve}-{segments}x{joints}-{kind}-{k}"
        draw = random.Random(name).random
        rows = [[_point(draw) for _ in range(joints)] for _ in range(segments + 1)]
        _apart(rows, draw)
        limits: list[tuple[float, ...] | None] = []
        for base in LIMITS[kind]:
            factors = [0.7 + 0.6 * draw() for _ in range(joints)]
            limits.append(
                None if base is None else tuple(float(f"{base * f:.3g}") for f in factors)
            )
        yield Written(
            name,
            curve,
            tuple(map(tuple, rows)),
            *limits,
            unit="rad",
            source="Seeded way-points and limits; Python's random, seeded with the id",
            note=f"drawn for tightness in {kind.replace('-only', ' alone')}",
        )


def _point(draw: object) -> float:
    return round(REACH * (2 * draw() - 1), 3)  # type: ignore[operator]


def _apart(rows: list[list[float]], draw: object) -> None:
    """Draw an angle anew where a joint would hardly move: coincidence is another question."""
    for before, after in pairwise(rows):
        for j in range(len(after)):
            while abs(after[j] - before[j]) < 0.05:
                after[j] = _point(draw)


# --- from the literature --------------------------------------------------------------------------

PUMA = (
    (0.1885, -1.6336, 0.2513, 0.3142, 0.1885, 0.3142),
    (0.8168, -2.0071, -0.3770, -0.0628, -0.1257, -0.1257),
    (0.1257, -1.0681, -1.0681, 0.4398, 0.2513, -0.1885),
    (-0.8796, -1.0053, -0.3142, 0.8796, 0.5027, -0.2513),
)
"""rad; case puma560-mnam-pso-353, Table 1."""
IRB460 = ((-1.0392,), (-0.8196,), (-0.4098,), (-0.5196,))
"""rad; case irb460-pso-353, Table 3, row of joint 5."""
IRB1600 = (
    (-0.0476, -2.2305, -1.4968, 21.9911, 0.7337, 59.7378),
    (-0.0478, -2.2769, -1.5070, 0.0, -0.7698, 0.0478),
    (-0.0481, -2.8252, -1.6241, 3.1416, 1.2011, -3.0935),
    (-0.0482, -2.8009, -1.6194, -3.1416, 1.1815, -3.0934),
    (-0.0481, -2.3184, -1.5171, -3.1416, 0.8013, -3.0935),
    (-0.0488, -2.4120, -1.5426, 0.0, -0.8693, 0.0488),
    (-0.0489, -2.3332, -1.5295, 3.1416, 0.8037, -3.0927),
    (-0.0488, -2.7752, -1.6250, -3.1416, 1.1501, -3.0928),
    (-0.0485, -2.1729, -1.4978, 3.1416, 0.6751, -3.0931),
    (-0.0481, -2.1258, -1.4860, 0.0, -0.6398, 0.0481),
)
"""rad; case irb1600-ga-cubic-bspline, Table 1."""
GASPARETTO = (
    (-10, 20, 15, 150, 30, 120),
    (60, 50, 100, 100, 110, 60),
    (20, 120, -10, 40, 90, 100),
    (55, 35, 30, 10, 70, 25),
)
"""deg; docs/examples/gasparetto-zanotto2008.toml, Tables 2 to 4."""
TOPPRA = ((0, 0), (1, 3), (2, 4), (0, 0))
"""rad; cpp/tests/test_algorithm.cpp of TOPPRA, class ProblemInstance."""
ARM = ((0, 0), (30, -60), (30, -90), (30, -60), (75, -90), (110, -60), (110, -90), (50, 0))
"""deg; data/robot_arm_waypoints.csv of pvc192000/robot-trajectory-interpolation."""
FANG1 = ((-10, 20, 15, 150, 30, 120), (55, 35, 30, 10, 70, 25))
"""deg; docs/examples/fang2020-task1.toml, Table 2."""
FANG2 = (
    (-1.047197551197, 0.523598775598, 0, -1.256637061436, 0.785398163397, 0),
    (
        1.256637061436,
        1.047197551197,
        -0.523598775598,
        -0.209439510239,
        -1.570796326795,
        0.785398163397,
    ),
)
"""rad; docs/examples/fang2020-task2.toml, Table 2."""
"""rad; the third instance of step 2.0 rad and the second of step 3.0 rad there."""


def literature() -> Iterator[Written]:
    """Instances through printed way-points."""
    puma = (
        "Fan and Tang, MNAM-PSO, Modeling and Simulation 13(6) (case puma560-mnam-pso-353): "
        "Table 1 and limits of section 4.1"
    )
    limits = {"velocity": (6,) * 6, "acceleration": (8,) * 6, "jerk": None}
    six = {"unit": "rad", "source": puma, **limits}
    for curve in ("353", "434", "cubic", "natural", "virtual", "quintic", "septic"):
        yield Written(f"{curve}-puma560", curve, PUMA, note="way-points A to D", year=2024, **six)
    yield Written(
        "353-puma560-at-least-0.3",
        "353",
        PUMA,
        note="way-points A to D, durations of at least 0.3 s",
        year=2024,
        lower=0.3,
        **six,
    )
    for j in range(6):
        yield Written(
            f"353-puma560-joint-{j + 1}",
            "353",
            tuple((row[j],) for row in PUMA),
            (6,),
            (8,),
            None,
            "rad",
            puma,
            f"joint {j + 1} by itself",
            year=2024,
        )
    irb460 = (
        "PSO for 3-5-3 polynomials, IRB 460 (case irb460-pso-353): Table 3, joint 5; the limit of "
        "80 °/s rounded to 1.396 rad/s"
    )
    for curve in ("353", "434"):
        yield Written(
            f"{curve}-irb460", curve, IRB460, (1.396,), None, None, "rad", irb460, "joint 5"
        )
    irb1600 = (
        "GA for cubic B-splines, IRB 1600 (case irb1600-ga-cubic-bspline): Tables 1 and 3, all in "
        "rad; the curve is another one"
    )
    for curve in ("cubic", "natural", "septic"):
        yield Written(
            f"{curve}-irb1600",
            curve,
            IRB1600,
            (180, 180, 185, 385, 400, 460),
            (65, 65, 80, 120, 140, 150),
            None,
            "rad",
            irb1600,
            "joints of very different ways",
        )
    gasparetto = (
        "Gasparetto and Zanotto, A technique for time-jerk optimal planning of robot "
        "trajectories, Robotics and Computer-Integrated Manufacturing 24, Tables 2 to 4"
    )
    for curve in ("353", "434", "cubic", "natural", "virtual", "quintic", "septic"):
        yield Written(
            f"{curve}-gasparetto2008",
            curve,
            GASPARETTO,
            (100, 95, 100, 150, 130, 110),
            (60, 60, 75, 70, 90, 80),
            (60, 66, 85, 70, 75, 70),
            "deg",
            gasparetto,
            "all three limits",
            2008,
        )
    for curve in ("353", "cubic", "natural", "quintic"):
        yield Written(
            f"{curve}-toppra",
            curve,
            TOPPRA,
            (1, 1),
            (0.2, 0.2),
            None,
            "rad",
            "TOPPRA, cpp/tests/test_algorithm.cpp, class ProblemInstance",
            "there and back",
        )
    for curve in ("cubic", "natural", "septic"):
        yield Written(
            f"{curve}-arm2",
            curve,
            ARM,
            (90, 120),
            (180, 240),
            (900, 1200),
            "deg",
            "pvc192000/robot-trajectory-interpolation, data/robot_arm_waypoints.csv; it prints no "
            "limits, these are chosen here",
            "planar arm",
        )
    fang = "Fang, Qi, Hu et al., Mechanism and Machine Theory 153, 103957: Tables 2 and 3"
    yield Written(
        "septic-fang2020-task1",
        "septic",
        FANG1,
        (100, 95, 100, 150, 130, 110),
        (60, 60, 75, 70, 90, 80),
        (60, 66, 85, 70, 75, 70),
        "deg",
        fang,
        "point to point, task 1",
        2020,
    )
    yield Written(
        "septic-fang2020-task2",
        "septic",
        FANG2,
        (1.8, 2, 1.5, 2, 2.5, 2),
        (4, 5, 3.5, 4, 5, 4),
        (20, 25, 20, 20, 30, 25),
        "rad",
        fang,
        "point to point, task 2",
        2020,
    )


def instances() -> tuple[Written, ...]:
    """Every instance, by name."""
    every = [*seeded(), *literature()]
    found = {one.name: one for one in every}
    assert len(found) == len(every), "two instances have the same name"
    return tuple(found[name] for name in sorted(found))
