"""Instances: way-points drawn from a robot's workspace where a paper prints none."""

from __future__ import annotations

from typing import Annotated, Literal

import numpy as np
from pydantic import Field, StrictInt, field_validator

from ..arrays import Array
from ..files import MOST
from ..printed import Id, Length, Printed, Strict, Text, fault
from ..robots import Chain, StepKind, sample_workspace, waypoint_sequences

Count = Annotated[StrictInt, Field(ge=1, le=10_000)]
"""How many; all together are bounded as well, by `check_sizes`."""


class InstancesBlock(Strict):
    """Instances on which a relative claim is examined, drawn from the workspace of the robot."""

    id: Id
    claim: Id
    """The claim of quantity "improvement"; its two totals name problem and algorithm each."""
    why: Text
    """Why such instances say something about the claim."""
    kind: Literal["joint", "end"] = "end"
    """What a step measures: the largest change of a joint, or the way of the end."""
    steps: Annotated[tuple[Length, ...], Field(min_length=1, max_length=MOST.entries)]
    """Step lengths, rad where kind is "joint", m where it is "end"."""
    instances: Count
    """Instances of each step length."""
    seed: Annotated[StrictInt, Field(ge=0, le=MOST.seed)] = 0
    """Of the workspace and of the way-points."""
    samples: Annotated[StrictInt, Field(ge=1, le=1_000_000)] = 20_000
    """Positions of the workspace that way-points are drawn from."""
    runs: Count = 2
    """Runs of each algorithm on each instance, seeds 0 to runs − 1."""
    objectives: Annotated[
        tuple[Literal["death-penalty", "stretch", "rescale"], ...], Field(min_length=1)
    ] = ("death-penalty", "stretch")
    """What happens to durations that break a limit; the first is the paper's."""
    readings: tuple[Id, ...] = ()
    """Readings under which the instances are examined; all of them if empty."""

    @field_validator("steps")
    @classmethod
    def _proper(cls, steps: tuple[Printed, ...]) -> tuple[Printed, ...]:
        for index, step in enumerate(steps):
            if step.value <= 0:
                raise fault(f"[{index}]", "is 0; give a positive step")
            if step.value in [other.value for other in steps[:index]]:
                raise fault(f"[{index}]", f"{step} is given twice; leave one out")
        return steps

    @property
    def unit(self) -> str:
        """Unit of the steps."""
        return "rad" if self.kind == "joint" else "m"

    @property
    def lengths(self) -> tuple[float, ...]:
        """Step lengths in `unit`."""
        return tuple(step.value for step in self.steps)


def instance_waypoints(
    block: InstancesBlock, chain: Chain, labels: tuple[str, ...], waypoints: int
) -> Array:
    """Draw the way-points of every instance of a block.

    Every step length has a stream of its own: its instances depend neither on the other steps nor,
    save for their number, on how many there are.

    Parameters
    ----------
    labels : tuple of str
        Joints of the chain to keep, in order.

    Returns
    -------
    ndarray, shape (steps, instances, waypoints, joints)
        Joint variables, rad (m where a joint slides).

    Raises
    ------
    TrajgapError
        If a joint slides without bounds, or no sampled position can be reached at a step.
    """
    workspace = sample_workspace(chain, block.samples, block.seed)
    columns = [chain.labels.index(label) for label in labels]
    drawn = []
    for step in block.lengths:
        # Named by the step itself, so adding a step leaves the others as they were.
        named = int(np.float64(step).view(np.uint64))
        stream = np.random.SeedSequence([block.seed, named])
        drawn.append(
            waypoint_sequences(
                workspace,
                step=step,
                count=block.instances,
                seed=int(stream.generate_state(1, np.uint64)[0]),
                waypoints=waypoints,
                kind=StepKind(block.kind),
            )
        )
    return np.array(drawn)[..., columns]
