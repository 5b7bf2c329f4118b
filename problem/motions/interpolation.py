"""The motion through samples under a stated interpolation."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ..errors import TrajgapError
from .digits import HalfUnits
from .hermite import hermite
from .motion import Motion
from .samples import Interpolation, Samples
from .through_spline import not_a_knot_spline


def interpolated(samples: Samples, how: Interpolation) -> Motion:
    """The motion through samples under a stated interpolation.

    Parameters
    ----------
    how : Interpolation
        Any but ``none``.

    Returns
    -------
    Motion
        With bounds on the effect of noise and rounding.

    Raises
    ------
    TrajgapError
        If the interpolation needs a derivative that is not given.
    """
    if how is Interpolation.NONE:
        raise TrajgapError("interpolation: 'none' is not a motion; check_samples judges samples")
    if how is Interpolation.SPLINE:
        return not_a_knot_spline(samples)
    velocities, accelerations = samples.has(1), samples.has(2)
    pairs = samples.time.size - 1
    both = [velocities[1:] & velocities[:-1], accelerations[1:] & accelerations[:-1]]
    if how is Interpolation.CONTROLLER:
        if (both[1] & ~both[0]).any():
            k = int(np.argmax(both[1] & ~both[0]))
            raise TrajgapError(
                f"points {k + 1} and {k + 2}: accelerations without velocities; give velocities too"
            )
        degree = np.where(both[0], np.where(both[1], 5, 3), 1)
        # The controller is given these very numbers, however they were rounded before.
        samples = replace(samples, rounding=HalfUnits())
    else:
        degree = np.full(pairs, {"linear": 1, "cubic": 3, "quintic": 5}[how])
        for order, word, least in ((1, "velocity", 3), (2, "acceleration", 5)):
            missing = (degree >= least) & ~both[order - 1]
            if missing.any():
                first = int(np.argmax(~samples.has(order))) + 1
                raise TrajgapError(
                    f"interpolation {how}: sample {first} has no {word}; "
                    "give it, or state another --interpolation"
                )
    return hermite(samples, degree, _words(how, degree))


def _words(how: Interpolation, degree: NDArray[np.int64]) -> str:
    names = {1: "straight lines", 3: "cubic Hermite", 5: "quintic Hermite"}
    used = [names[d] for d in (1, 3, 5) if (degree == d).any()]
    said = " and ".join(used) + " between samples"
    return f"{said}, as in joint_trajectory_controller" if how is Interpolation.CONTROLLER else said
