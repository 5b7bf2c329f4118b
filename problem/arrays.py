"""The one alias for arrays of float64: shapes and units stand in each docstring."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
"""Angles, times and limits inside the house, rad and s; (way-point, joint), batches lead."""
