"""Claims that `trajgap new` writes: of its options, and a block to fill in of every other kind."""

from __future__ import annotations

import json
import re
from collections.abc import Collection, Sequence

_DERIVATIVES = ("acceleration", "velocity", "jerk")
"""Derivatives of which peaks are printed, the most usual first."""
_UNPLACED = "a place not stated"
"""Place of a claim for which none is given: it reads as what it is in every message."""


def claim_blocks(
    durations: Sequence[str],
    total: str | None,
    where: str,
    segments: int,
    units: Collection[str],
    joint: str,
) -> list[str]:
    """Lines of the claims that are given, and of every other kind as comments.

    Whoever takes the first mark off each line of a block and fills in what is between empty quotes
    has a block that loads: prose carries a second mark, and no block needs another one, but for
    the durations where nothing is given.

    Parameters
    ----------
    durations : sequence of str
        Printed durations; may be empty.
    total : str or None
        Printed total.
    where : str
        Where they are printed; said to be not stated if empty.
    segments : int
        How many durations there are to print.
    units : collection of str
        Quantities that have a unit.
    joint : str
        Label of the first joint.

    Returns
    -------
    list of str
        Lines of TOML.
    """
    lines = _claim_of_options(durations, total, where)
    # What a block is about: durations, unless a total stands alone. Where nothing is given the
    # block of durations comes first, and whoever leaves it empty has no use for the others.
    timed = "total" if total and not durations else "durations"
    about = f'of = ["{timed}"]'
    motion = 'of = "durations"' if timed == "durations" else None
    for block in (
        _commented(
            ["A row of segment times, and its total where it is printed."],
            'id = "durations"',
            'quantity = "durations"',
            'where = ""',
            f'durations = [""]  # {segments} number{"" if segments == 1 else "s"}',
            '# total = ""',
        )
        if not durations
        else [],
        _commented(
            ["“The motion keeps its limits.”"],
            'id = "limits-kept"',
            'quantity = "statement"',
            'where = ""',
            'text = "The motion keeps its limits."',
            'checks = "within_limits"',
            about,
        ),
        _commented(
            ["“The motion is time-optimal.”"],
            'id = "time-optimal"',
            'quantity = "statement"',
            'where = ""',
            'text = "The motion is time-optimal."',
            'checks = "optimal"',
            about,
        ),
        _commented(
            ["“Velocity and acceleration are continuous.”"],
            'id = "smooth"',
            'quantity = "statement"',
            'where = ""',
            'text = "Velocity and acceleration are continuous."',
            'checks = "continuous"',
            about if motion else None,
        ),
        _commented(
            ["A total printed in a second place, such as the abstract or the conclusion."],
            'id = "second-total"',
            'quantity = "total_time"',
            'where = ""',
            'value = ""',
            motion,
        ),
        _rival(timed),
        _commented(
            ["The largest value of a derivative, as a table or a figure prints it.", *_unit(units)],
            'id = "peak"',
            'quantity = "peak"',
            'where = ""',
            f'derivative = "{_derivative(units)}"',
            'value = ""  # or values = [...], one for each joint',
            '# joint = ""  # whose value it is, where it is one joint\'s',
            motion,
        ),
        _commented(
            ["A mean, a root mean square or an integral of a derivative.", *_unit(units)],
            'id = "mean"',
            'quantity = "measure"',
            'where = ""',
            f'derivative = "{_derivative(units)}"',
            'measure = "mean"  # of the absolute value; or rms, integral, integral-square',
            'value = ""  # or values = [...], one for each joint',
            motion,
        ),
        _commented(
            ["A position or a derivative at one place of the motion.", *_unit(units)],
            'id = "at-finish"',
            'quantity = "value"',
            'where = ""',
            f'derivative = "{_derivative(units)}"  # or position',
            'place = "finish"  # or start, largest, smallest, a way-point; or time = "..."',
            f"joint = {json.dumps(joint, ensure_ascii=False)}",
            'value = ""  # or values = [...], one for each joint, and no joint above',
            motion,
        ),
    ):
        lines += block
    return lines


def _claim_of_options(durations: Sequence[str], total: str | None, where: str) -> list[str]:
    """The claim of what is given on the command line."""
    place = f"where = {json.dumps(where or _UNPLACED, ensure_ascii=False)}"
    place += "" if where else "  # say which table, section or figure"
    if durations:
        return [
            "[[claims]]",
            'id = "durations"',
            'quantity = "durations"',
            place,
            f"durations = {json.dumps(list(durations))}{_coarse(durations)}",
            *([f"total = {json.dumps(total)}"] if total else []),
            "",
        ]
    if total:
        return [
            "[[claims]]",
            'id = "total"',
            'quantity = "total_time"',
            place,
            f"value = {json.dumps(total)}",
            "",
        ]
    return []


def _rival(timed: str) -> list[str]:
    """Another method's row of the same table, and how much shorter the paper's own is."""
    method = _commented(
        ["Another method, which its rows name, so that they are not taken for the paper's own."],
        'id = "other"',
        'name = ""',
        block="algorithms",
    )
    rival = _commented(
        ["Another method's total, as tables print it beside this one: a claim for each row."],
        'id = "rival"',
        'quantity = "total_time"',
        'where = ""',
        'value = ""',
        'algorithm = "other"',
        '# other_curve = ""  # its curve, where it is another one than under [interpolant]',
        '# objective = ""  # what it minimises, where that is not time alone',
    )
    gain = _commented(
        ["“10 % shorter than the other method.”"],
        'id = "improvement"',
        'quantity = "improvement"',
        'where = ""',
        'slower = "rival"',
        f'faster = "{timed}"',
        'percent = ""',
    )
    # One paragraph: each block names the one before.
    return [*method[:-1], *rival[:-1], *gain]


def _commented(prose: Sequence[str], *keys: str | None, block: str = "claims") -> list[str]:
    """A block as comments; the prose keeps a mark when one is taken off every line."""
    comments = [f"## {line}" for line in prose]
    return [*comments, f"# [[{block}]]", *(f"# {key}" for key in keys if key is not None), ""]


def _derivative(units: Collection[str]) -> str:
    """The derivative of an example: one that has a unit, if any has."""
    return next((one for one in _DERIVATIVES if one in units), "velocity")


def _unit(units: Collection[str]) -> list[str]:
    """What a block needs beside itself where no derivative has a unit."""
    return [] if _derivative(units) in units else ["Needs its unit under [units], above."]


def _coarse(durations: Sequence[str]) -> str:
    """A remark on durations without decimals, which may be meant exactly."""
    whole = next((one for one in durations if re.fullmatch("[0-9]+", one)), None)
    if whole is None:
        return ""
    return f'  # "{whole}" may be {int(whole) - 0.5:g} to {int(whole) + 0.5:g}; no quotes: exact'
