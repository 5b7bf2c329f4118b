"""What each reading of a case means, in a few words that no other reading of the case has."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Sequence

from ..characters import listed
from ..limits import QUANTITIES, USUAL
from ..printed import CHOICES, is_linear, shown_unit
from ..problem import Coupling
from .declaration import InterpolantBlock, Values
from .schema import CaseFile, Reading

_UNITS = {
    "position": "angles",
    "velocity": "velocities",
    "acceleration": "accelerations",
    "jerk": "jerks",
    "snap": "snaps",
    "time": "times",
}
"""What a unit is of, as a reader calls it."""
_SHOWN = {
    "rad": "radians",
    "deg": "degrees",
    "m": "metres",
    "cm": "centimetres",
    "mm": "millimetres",
    "s": "seconds",
    "ms": "milliseconds",
    "min": "minutes",
}
"""Units that read better in full; of the others the signs are changed alone."""
_LIMITS = {
    "velocity": "velocity limits",
    "acceleration": "acceleration limits",
    "deceleration": "deceleration limits",
    "jerk": "jerk limits",
    "snap": "snap limits",
    "position_lower": "lower position limits",
    "position_upper": "upper position limits",
}
"""Keys of the limits, as a reader calls them."""
_FAMILIES = {
    "3-5-3": "3-5-3 polynomials",
    "cubic-spline": "cubic spline",
    "quintic-spline": "quintic spline",
    "septic-spline": "septic spline",
    "cubic-spline-virtual": "cubic spline with virtual points",
    "quintic-spline-virtual": "quintic spline with virtual points",
    "rest-to-rest": "at rest at every way-point",
    "uniform-cubic-b-spline": "uniform cubic B-spline",
    "clamped-b-spline": "clamped B-spline",
}
"""Families of curves in words; the others are called as case files call them."""
_KEYS = {
    "knots": {
        "waypoints": "knots at the way-points",
        "averaged": "averaged knots",
        "averaged-continued": "averaged knots, continued at the ends",
        "given": "printed knots",
    },
    "parameters": {
        "times": "knots by the times",
        "chord": "knots by chord lengths",
        "joint-chord": "knots by the chord lengths of each joint",
        "given": "knots by printed parameters",
    },
    "time": {"stretched": "each segment stretched in time separately", "timed": "smooth time"},
    "time_ends": {
        "equal-vertices": "time ending in equal vertices",
        "natural": "natural ends of time",
    },
}
"""Keys of B-splines, and what their words say."""
_SITES = {"times": "way-points at the times", "given": "way-points at printed parameters"}
"""What the parameters say beside printed knots: where the way-points lie among these."""


def reading_labels(document: CaseFile, readings: Sequence[Reading]) -> dict[str, str]:
    """The meaning of each reading, in words: its `label`, else in what it differs from the others.

    Returns
    -------
    dict of str to str
        By the readings' ids. No two are alike: where words do not tell readings apart, their ids
        stand beside.
    """
    found = {one.id: one.label or _differing(document, one, readings) for one in readings}
    count = Counter(found.values())
    return {
        name: label if label and count[label] == 1 else f"{label} ({name})" if label else name
        for name, label in found.items()
    }


def _differing(document: CaseFile, reading: Reading, readings: Sequence[Reading]) -> str:
    """What a reading says where another one says something else."""
    parts = []
    for aspect in _ASPECTS:
        own = list(aspect(document, reading))
        others = [list(aspect(document, one)) for one in readings]
        # A part that all readings share tells none from another.
        parts += [part for part in own if not all(part in other for other in others)]
    return ", ".join(dict.fromkeys(parts))


def _key_value(document: CaseFile, reading: Reading, block: str, key: str) -> object:
    """A key of a block as a reading has it, else the file; None if a problem says it."""
    own = getattr(reading, block)
    if key in own.model_fields_set:
        return getattr(own, key)
    if any(key in getattr(problem, block).model_fields_set for problem in document.problems):
        return None
    return getattr(getattr(document, block), key)


def _units(document: CaseFile, reading: Reading) -> Iterator[str]:
    for quantity in CHOICES:
        unit = _key_value(document, reading, "units", quantity)
        if isinstance(unit, tuple | str):
            each = unit if isinstance(unit, tuple) else (unit,)
            shown = listed([_SHOWN.get(one, shown_unit(one)) for one in dict.fromkeys(each)])
            linear = quantity == "position" and any(map(is_linear, each))
            yield f"{'positions' if linear else _UNITS[quantity]} in {shown}"


def _waypoints(document: CaseFile, reading: Reading) -> Iterator[str]:
    own = reading.waypoints
    if own is not None:
        yield f"way-points of {own.where}" if own.where else "other way-points"
    if reading.joints is not None:
        yield f"joint{'s' if len(reading.joints) > 1 else ''} {listed(reading.joints)} alone"
    turned = [joint for joint, turns in reading.turns.items() if any(turns)]
    if turned:
        every = [turn for joint in turned for turn in reading.turns[joint]]
        off = "taken off" if max(every) <= 0 else "added to"
        yield f"whole turns {off} joint{'s' if len(turned) > 1 else ''} {listed(turned)}"


def _limits(document: CaseFile, reading: Reading) -> Iterator[str]:
    for key, name in _LIMITS.items():
        if key in reading.limits.model_fields_set:
            value = getattr(reading.limits, key)
            several = isinstance(value, tuple)
            where = reading.limits.where
            of = f"of {where}" if where else "of its own"
            yield f"no {name}" if value is None else f"{name} {of if several else value}"


def _curve(document: CaseFile, reading: Reading) -> Iterator[str]:
    block = reading.interpolant
    if block is None:
        # What a problem states, a reading that is silent leaves as it is.
        own = any(problem.interpolant for problem in document.problems)
        block = None if own else document.interpolant
    if block is not None:
        yield from _declared(block)


def _declared(block: InterpolantBlock) -> Iterator[str]:
    """A curve in words, as many as its block has keys."""
    yield _FAMILIES.get(block.family, block.family)
    if block.degree is not None:
        yield f"degree {block.degree}"
    if block.degrees is not None:
        yield f"degrees {'-'.join(map(str, block.degrees))}"
    if block.continuity is not None:
        yield f"continuous up to derivative {block.continuity}"
    for key, words in _KEYS.items():
        word = getattr(block, key)
        if word is not None:
            sites = key == "parameters" and block.knots == "given"
            yield (_SITES if sites else words)[word]
    apart = block.finish_orders is not None or block.finish_derivatives is not None
    if block.end_orders is not None or block.end_derivatives is not None or apart:
        yield from _end_words("start" if apart else "end", block.orders, block.end_derivatives)
    if apart:
        yield from _end_words("finish", block.last_orders, block.last_derivatives)
    if block.virtual:
        several = len(block.virtual) > 1
        breaks = listed([str(b) for b in sorted(block.virtual)])
        yield f"virtual point{'s' if several else ''} at break{'s' if several else ''} {breaks}"
    if block.free:
        yield f"{block.free} free coefficient{'s' if block.free > 1 else ''}"


def _end_words(end: str, orders: tuple[int, ...], values: Values | None) -> Iterator[str]:
    for order, value in zip(orders, values or ("0",) * len(orders), strict=True):
        each = " ".join(map(str, value)) if isinstance(value, tuple) else value
        name = QUANTITIES[order - 1] if order <= USUAL else f"derivative {order}"
        yield f"{end} {name} {each}"


def _durations(document: CaseFile, reading: Reading) -> Iterator[str]:
    unit = document.units.time or "s"
    for key, least in (("lower", "at least"), ("upper", "at most")):
        value = _key_value(document, reading, "durations", key)
        if value is None or isinstance(value, tuple):
            if key in reading.durations.model_fields_set:
                yield f"{key} bounds on the durations" if value else f"no {key} bound on durations"
        elif key == "lower" and float(str(value)) == 0.0:
            yield "durations only positive"
        else:
            yield f"durations {least} {value} {unit}"


def _ratios(document: CaseFile, reading: Reading) -> Iterator[str]:
    value = _key_value(document, reading, "durations", "ratios")
    if value is None and any(p.durations.ratios is not None for p in document.problems):
        return
    yield ratio_words(value)


def ratio_words(value: object) -> str:
    """What ratios of durations in a case file say, in words."""
    if isinstance(value, tuple):
        # More than six in a row are no label.
        shown = " : ".join(map(str, value)) if len(value) <= 6 else "as listed"
        return f"durations in the ratios {shown}"
    words = {"equal": "durations all alike", "chord": "durations in the ratios of the distances"}
    return words.get(str(value), "each duration chosen")


def _coupling(document: CaseFile, reading: Reading) -> Iterator[str]:
    if reading.coupling is not None:
        shared = reading.coupling is Coupling.SHARED
        yield "durations shared by the joints" if shared else "each joint timed separately"


_ASPECTS: tuple[Callable[[CaseFile, Reading], Iterator[str]], ...] = (
    _units,
    _waypoints,
    _limits,
    _curve,
    _durations,
    _ratios,
    _coupling,
)
"""What a reading may change, in the order in which a label tells it."""
