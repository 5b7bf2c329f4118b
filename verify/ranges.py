"""Ranges and sizes that a certificate keeps, for both sides.

They are the table of docs/explanation/certificates.md.
Whoever writes a certificate must stay inside, whoever reads it checks it before it computes.
"""

from __future__ import annotations

from fractions import Fraction

# --- the file -------------------------------------------------------------------------------------

MOST_BYTES = 64_000_000
"""Of a file: eight times the largest proof that we have made, and read in some seconds."""
MOST_TEXT = 10_000
"""Characters of a name: a curve is named by all its fields, which is long."""
MOST_DIGITS = 120
"""Of a numerator, or on each side of a point: an exact float of usual size has at most 60."""

# --- the problem ----------------------------------------------------------------------------------

MOST_JOINTS = 64
"""More than any robot that is planned for as a whole."""
MOST_SEGMENTS = 1000
"""The longest path for which exact elimination ends within a usual time budget."""
MOST_DEGREE = 9
"""Of a piece and of the orders of derivatives: the polynomials of this field."""

# --- the tree -------------------------------------------------------------------------------------

MOST_NODES = 4_000_000
"""Of a tree: a file of `MOST_BYTES` holds no more leaves than that with anything in them."""
MOST_DEPTH = 1000
"""Boxes that wait in the walk through a tree: halving a side as often leaves no float of it."""
MOST_ROWS = 100_000
"""Of the table of rows in a proof."""
MOST_WEIGHTS = 20_000
"""Rows with a weight in one leaf or step."""

# --- closed forms and declared polynomials --------------------------------------------------------

PLACES = 2**20
"""A place on a piece is a multiple of 1/PLACES: about the square root of a float's precision."""

# --- any curve ------------------------------------------------------------------------------------

TANGENT_UNIT = 10**10
"""The numbers of a tangent are multiples of 1/TANGENT_UNIT: ten digits behind the point."""
MOST_TANGENT = 10**18
"""Of such a number, in its unit: fits 64 bits."""

# --- C2 cubic splines -----------------------------------------------------------------------------

TICKS = 2**24
"""Ticks in the proof's unit of time: what the sides of boxes are counted in."""
MOST_INTEGER = 2**28
"""Of the integers in such a proof: 16 units of time, and weights of 8 digits."""
MOST_POWER = 60
"""Units of time and angle are 2ᵖ of those of the problem, |p| up to here: 1e±18."""
SPOTS = 64
"""A velocity limit is looked at in multiples of 1/SPOTS of a span."""
MIX = 32
"""Shares of the two bounds of a product are multiples of 1/MIX."""
MIX_DIGITS = "0123456789abcdefghijklmnopqrstuvw"
"""The digits in which such a share is written, 0 to MIX."""
MOST_CUBIC_SEGMENTS = 64
"""Each box solves a system of three unknowns a segment, in time of the third power."""

# --- C4 quintic splines ---------------------------------------------------------------------------

MOST_QUINTIC_SEGMENTS = 26
"""What the number of roundings was counted for."""
MOST_QUINTIC_JOINTS = 12
"""What the number of roundings was counted for."""
MOST_LIMITS = 64
"""Rows in a leaf: what the number of roundings was counted for."""
MOST_WINDOWS = 100_000
"""Of the table of windows."""
SMALLEST = Fraction(1, 10**30)
"""Steps and limits, in the units of the proof, are 0 or between it and its inverse: nothing
underflows."""
SHORTEST_TOTAL = Fraction(1, 10**9)
"""The total, in the unit of time of the proof, lies between it and its inverse."""
LEAST_TAU = Fraction(1, 10**60)
"""A window's multiplier τ is 0 or between it and its inverse, for the same reason."""
MOST_WEIGHT = 2**52
"""Of a leaf's τ and weights, which are integers: floats hold them exactly."""
QUINTIC_PLACES = 1024
"""A place on a piece is a multiple of 1/QUINTIC_PLACES: its fifth power is exact in a float."""
WINDOW_UNIT = 2**16
"""The numbers of a window are multiples of 1/WINDOW_UNIT."""
MOST_WINDOW = 2**20
"""Of such a number, in its unit."""

# --- any declared curve ---------------------------------------------------------------------------

MOST_DECLARED_SEGMENTS = 12
"""What the number of roundings was counted for; boxes grow with a power of the segments."""
MOST_DECLARED_UNKNOWNS = 64
"""What the number of roundings was counted for: derivatives that agree at the inner breaks."""
SMALLEST_CAP = Fraction(1, 10**15)
"""Limits, with the total and the way of a joint about 1, are used between it and its inverse."""


def within(size: Fraction, least: Fraction) -> bool:
    """Whether a size lies between a least one and its inverse."""
    return least < size < 1 / least
