"""The problem of doi 10.12677/mos.2024.136535, typed from its tables."""

import numpy as np
from trajgap.problem import Limits

PUMA = np.array(
    [
        [0.1885, 0.8168, 0.1257, -0.8796],
        [-1.6336, -2.0071, -1.0681, -1.0053],
        [0.2513, -0.3770, -1.0681, -0.3142],
        [0.3142, -0.0628, 0.4398, 0.8796],
        [0.1885, -0.1257, 0.2513, 0.5027],
        [0.3142, -0.1257, -0.1885, -0.2513],
    ]
).T
"""Way-points A, B, C, D of the six joints, rad."""
PUMA_LIMITS = Limits(6.0, 8.0, joints=6)
