"""Limits from flags: one for every joint, or one for each with commas between."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence

from ..arrays import Array
from ..errors import CaseError, TrajgapError
from ..motions import BRAKING
from ..printed import read_float
from .precedence import Range, StatedLimits


def limits_of_flags(
    given: Mapping[str, str | None], joints: Sequence[str], factors: Array
) -> StatedLimits:
    """Read limits as they stand on a command line.

    Parameters
    ----------
    given : mapping
        Quantity to text: ``6``, ``6,8,inf``, or ``-1:2`` for a range; of positions a range, or a
        number that stands for both sides. None if there is no flag.
    factors : ndarray, shape (joints,)
        Size of the unit in rad.

    Raises
    ------
    CaseError
        If one is not a number, or their number differs from that of the joints.
    """
    ranges: dict[str, dict[str, Range]] = {joint: {} for joint in joints}
    for quantity, text in given.items():
        if text is None:
            continue
        flag = f"--{quantity}"
        words = [x for x in re.split(r"[,\s]+", text.strip()) if x]
        if len(words) not in (1, len(joints)):
            raise CaseError(
                flag, "", f"{len(words)} limits for {len(joints)} joints; give one, or one each"
            )
        each = words * (len(joints) if len(words) == 1 else 1)
        for joint, word, factor in zip(joints, each, factors.tolist(), strict=True):
            low, high = _range(flag, word, quantity)
            ranges[joint][quantity] = (low * factor, high * factor)
    return StatedLimits("flags", ranges, named=False)


def _range(flag: str, word: str, quantity: str) -> Range:
    parts = word.split(":")
    try:
        numbers = [read_float(x) for x in parts]
    except TrajgapError as error:
        raise CaseError(flag, "", f"{error}; give 6, or -1:2") from None
    if len(numbers) > 2:
        raise CaseError(flag, "", f"{word[:40]!r} is not a limit; give 6, or -1:2")
    if len(numbers) == 1:
        if numbers[0] < 0:
            raise CaseError(flag, "", f"{word} is negative; give a size, or a range LOW:HIGH")
        return -numbers[0], numbers[0]
    if quantity == BRAKING:
        raise CaseError(flag, "", f"{word!r} is a range; give one size")
    return numbers[0], numbers[1]
