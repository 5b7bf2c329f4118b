"""Stand-ins for the tests of algorithms: given random numbers, and functions with known minima."""

import numpy as np
from trajgap.heuristics import Bounds

R1 = np.array([[0.25, 0.5], [0.75, 0.125]])
R2 = np.array([[0.5, 0.25], [0.125, 1.0]])
"""Random numbers of a step of two particles in the plane."""
OPEN = Bounds(np.full(2, -np.inf), np.full(2, np.inf))


class Script:
    """Stands in for a generator: hands out given numbers, in order, in the shape asked for."""

    def __init__(self, *numbers: object) -> None:
        self.left = list(np.concatenate([np.ravel(n) for n in numbers]))

    def random(self, shape: object = None) -> np.ndarray | float:
        count = int(np.prod(shape)) if shape is not None else 1
        taken = [self.left.pop(0) for _ in range(count)]
        return np.array(taken).reshape(shape) if shape is not None else taken[0]


def off_centre(x: np.ndarray) -> np.ndarray:
    """Squared distance to (1, 2), the second axis weighted threefold."""
    return (x[:, 0] - 1) ** 2 + 3 * (x[:, 1] - 2) ** 2


def sphere(x: np.ndarray) -> np.ndarray:
    return (x**2).sum(axis=-1)


def rastrigin(x: np.ndarray) -> np.ndarray:
    return 10 * x.shape[-1] + (x**2 - 10 * np.cos(2 * np.pi * x)).sum(axis=-1)
