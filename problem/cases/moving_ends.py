"""Velocity and acceleration at both ends of a motion, with what their printed digits leave."""

from __future__ import annotations

import numpy as np

from ..arrays import Array
from ..printed import Quantity
from .statement import Statement


def end_states(statement: Statement) -> Array:
    """Velocity and acceleration at the start and at the finish as the interpolant prescribes them.

    Returns
    -------
    ndarray, shape (2, joints, 2, 3)
        Of each joint that takes part: as printed, and the least and the largest value whose digits
        were rounded or cut off, rad and s. 0 where none is prescribed.
    """
    block = statement.declaration
    ends = (
        ("end_derivatives", block.end_derivatives, block.orders),
        ("finish_derivatives", block.last_derivatives, block.last_orders),
    )
    measured: tuple[Quantity, ...] = ("velocity", "acceleration")
    found = np.zeros((2, len(statement.joints), len(measured), 3))
    for row, (key, values, orders) in zip(found, ends, strict=True):
        if values is None:
            continue
        for index, (order, given) in enumerate(zip(orders, values, strict=True)):
            for column, j in enumerate(statement.joints):
                one = given[j] if isinstance(given, tuple) else given
                if order > len(measured) or (one.fraction == 0 and one.exact):
                    continue
                quantity = measured[order - 1]
                if statement.unit(quantity, j) is not None:  # a zero needs none
                    field = f"interpolant.{key}[{index}]"
                    size = statement.si(one, quantity, field, j).cut_off()
                    row[column, order - 1] = size.value, size.lower, size.upper
    return found
