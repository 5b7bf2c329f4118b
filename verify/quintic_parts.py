"""What moves over the boxes of a batch: sums of vectors, their norms and products.

Arrays lead with the leaf. A sum Σ x_i v_i with |x_i| ≤ 1 is held by its vectors, so that products
of theirs count: where vectors point to different sides, that is far less than their norms say.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

ROUND = 1e-12
"""Of a sum over absolute values: four times what its roundings can amount to."""


class Part:
    """Rπ or Rρ over each box: vectors of two orders with factors in [−1, 1], and a remainder.

    Parameters
    ----------
    leading, following : ndarray, shape (leaf, vector, unknown)
        Vectors of the lowest order, and of the next one.
    later : ndarray, shape (leaf,)
        Norm of the terms of higher order, and of what is 0 but for rounding, with all rounding.
    """

    def __init__(self, leading: Array, following: Array, later: Array) -> None:
        self.leading, self.following, self.later = leading, following, later
        # ‖Σ x_i v_i‖² ≤ Σ |v_iᵀv_j|, to which each vector adds a share.
        each = np.abs(leading @ np.swapaxes(leading, 1, 2)).sum(axis=2)
        self.first: Array = np.sqrt(each.sum(axis=1) + ROUND * norms(leading) ** 2)
        self.shares = each / np.maximum(self.first, 1e-300)[:, None]
        self.second = norms(following)

    @property
    def most(self) -> Array:
        """The largest norm."""
        return self.first + self.second + self.later

    def beyond(self, other: Part) -> Array:
        """The largest |xᵀy|, x of this part and y of the other, but for both lowest orders."""
        found = products(self.leading, other.following) + products(self.following, other.leading)
        found += self.second * other.second
        return found + (self.first + self.second) * other.later + self.later * other.most


def norms(vectors: Array) -> Array:
    """Sum of the norms of each leaf's vectors."""
    return np.asarray(np.linalg.norm(vectors, axis=2).sum(axis=1))


def products(these: Array, those: Array) -> Array:
    """Bound of |(Σ x_i v_i)ᵀ(Σ y_j w_j)| for all |x_i|, |y_j| ≤ 1."""
    found = np.abs(these @ np.swapaxes(those, 1, 2)).sum(axis=(1, 2))
    return np.asarray(found + ROUND * norms(these) * norms(those))
