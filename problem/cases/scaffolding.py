"""A table of way-points (CSV) turned into the text of a case file to start from."""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from ..characters import listed
from ..errors import CaseError, TrajgapError
from ..files import read_text
from ..limits import BRAKING, ORDERS, QUANTITIES, USUAL, Limits
from ..printed import CHOICES, MINUS_SIGNS, Printed, Quantity, check_unit, is_linear, scale
from .declaration import FAMILIES
from .faults import Faults
from .literature import meant_by, unknown
from .load import parse_case
from .waypoint_table import WaypointTable, add_digits, read_waypoint_table

if TYPE_CHECKING:
    from jinja2 import Template


@dataclass(frozen=True)
class FileLimits:
    """Limits of joints as a file states them, such as a URDF."""

    joints: tuple[str, ...]
    """Names for the joints of the table, in its order."""
    limits: Limits
    """rad, m and s."""
    source: str
    """Name of the file."""
    doubt: str = ""
    """Doubt about the limits, such as sides that they leave out, in a sentence; empty if none."""


_MEASURED = (*ORDERS, "time")
"""Quantities that a new case asks for; a limit of snap is rare, and added by hand."""


def scaffold(
    csv_path: str | Path,
    units: Mapping[str, str],
    *,
    case_id: str | None = None,
    family: str | None = None,
    degree: int | None = None,
    velocity: str | None = None,
    acceleration: str | None = None,
    jerk: str | None = None,
    durations: str | None = None,
    total: str | None = None,
    where: str = "",
    limits_of: Callable[[tuple[str, ...]], FileLimits] | None = None,
    warn: Callable[[str], None] | None = None,
) -> str:
    """Write a case file for a table of way-points.

    Parameters
    ----------
    csv_path : str or Path
        Table separated by commas, semicolons, tabs or spaces. The header names the joints, each
        further row is a way-point; a first column headed "point", "label" or the like, or without
        any number, names them. Where the first column is headed "joint", each row is a joint.
    units : mapping
        Unit of "position", and of "velocity", "acceleration" and "jerk" where a limit is given or
        a peak is printed, or one for each joint, with commas between; "time" is "s" if left out.
    case_id : str, optional
        Id of the case; the file's name by default.
    family : str, optional
        Interpolant, by a name of case files, a name of the literature such as "natural cubic
        spline", or the degrees of its segments such as "4-3-3-4". By default 3-5-3 for four
        way-points; else the cubic spline with two virtual way-points, or without a jerk limit,
        which it needs to have a shortest motion, the one at rest at both ends.
    degree : int, optional
        Degree, for families that need one, such as rest-to-rest.
    velocity, acceleration, jerk : str, optional
        One limit for all joints, or one for each, separated by commas; they count as exact.
    durations, total : str, optional
        Printed durations of the segments, with commas between, and printed total time: each
        becomes a claim, with its digits as given.
    where : str, optional
        Table, section or figure that prints them. If it is empty the claim says that its place is
        not stated.
    limits_of : callable, optional
        Given the names in the header, the limits that a file states of these joints. A limit that
        is also given above takes precedence.
    warn : callable, optional
        Called with a sentence about input that may have been misread.

    Returns
    -------
    str
        TOML with every number as in the table, and comments on what to add. It can be loaded.
        Angles with decimals are in quotes, which stand for all
        that rounds to them; whole radians, and whole degrees where all are multiples of 5, are
        exact.

    Raises
    ------
    CaseError
        If the table or an argument cannot be used: all faults at once. Those of the table name its
        file, those of an argument the argument.
    """
    path = Path(csv_path)
    name = str(csv_path)
    table, options = Faults(name), Faults("")
    limits = {"velocity": velocity, "acceleration": acceleration, "jerk": jerk}
    given = {key: _listed(number) for key, number in limits.items() if number is not None}
    claimed = {"durations": _listed(durations or ""), "total": _listed(total or "")}
    checked = _units(options, units, given)
    for key, each in (given | claimed).items():
        for number in each:
            add_digits(options, key, number)
    found = read_waypoint_table(table, read_text(path))
    _refuse_units(table, found, checked.get("position", ""))
    joints, from_file, doubt = found.joints, "", ""
    stated: dict[str, str] = {}
    # Units for another number of joints are refused when the case is read.
    fits = all(isinstance(one, str) or len(one) == len(joints) for one in checked.values())
    if limits_of is not None and fits and "position" in checked and not table.found:
        of_file = limits_of(joints)
        joints, doubt = of_file.joints, of_file.doubt
        stated, units_of_file = _stated(of_file.limits, checked["position"], checked)
        stated = {key: text for key, text in stated.items() if key not in given}
        checked = units_of_file | checked
        from_file = f"{_named(stated)} from {Path(of_file.source).name}" if stated else ""
    for key, each in given.items():
        if len(each) not in (1, len(joints)):
            many = f"lists {len(each)} numbers for {len(joints)} joints"
            options.add(key, f"{many}; give one for all, or one each")
    curve = _curve(options, family, degree, len(found.rows), "jerk" in {**given, **stated})
    _refuse(table, options)
    identity = case_id if case_id is not None else identity_of(path.stem)

    def text(segments: int) -> str:
        printed = next(iter(claimed["total"]), None)
        return _template().render(
            identity=_quoted(identity),
            note=_quoted("; ".join(filter(None, (f"way-points from {path.name}", from_file)))),
            joints=[_quoted(joint) for joint in joints],
            units=_unit_lines(checked),
            labels=[_quoted(label) for label in found.labels],
            **_angles(found, checked["position"]),
            limits=_limit_lines(given, stated),
            from_file=_comment(from_file),
            families=FAMILIES,
            curve=curve,
            durations=json.dumps(claimed["durations"]) if claimed["durations"] else None,
            coarse=_coarse(claimed["durations"]),
            total=printed and json.dumps(printed),
            where=where and json.dumps(where, ensure_ascii=False),
            segments=segments,
            # Of these derivatives peaks are printed, the most usual first.
            derivative=next(
                (one for one in ("acceleration", "velocity", "jerk") if one in checked), None
            ),
        )

    try:
        segments = parse_case(text(len(found.rows) - 1), name).problem().segments
    except CaseError as error:
        for field, reason in error.faults:
            meant = _argument(field)
            (table if meant is None else options).add(meant or field, reason)
        _refuse(table, options)
        raise
    count = len(claimed["durations"])
    if count not in (0, segments):
        options.add(
            "durations",
            f"lists {count} number{'' if count == 1 else 's'}, and the curve has {segments} "
            f"segment{'' if segments == 1 else 's'}; give one for each, or change the family",
        )
        _refuse(table, options)
    if doubt and warn is not None:
        warn(f"{name}: {doubt}")
    if found.counted and warn is not None:
        warn(
            f"{name}: line 1 is read as the names of the joints, {', '.join(joints)}; if it is a "
            "way-point, put a header above it"
        )
    return text(segments)


def _refuse(table: Faults, options: Faults) -> None:
    """Name all faults at once, those of the table, which names its file, in front."""
    faults = Faults(table.file if table.found else "")
    faults.found = [*table.found, *options.found]
    faults.refuse()


def _argument(field: str) -> str | None:
    """The argument that a field of the case comes from; None for the table."""
    if field.startswith("interpolant"):
        return "degree" if field.endswith("degree") else "family"
    if field.startswith("units."):
        return field.split("[")[0]
    if field.startswith("limits."):
        return field.removeprefix("limits.").split("[")[0]
    if field.startswith("claims[0]."):
        return "durations" if "durations" in field else "total"
    return "case_id" if field == "id" else None


def _listed(numbers: str) -> list[str]:
    """Numbers with commas between."""
    return [one.strip() for one in numbers.split(",")] if numbers.strip() else []


def _curve(
    faults: Faults, family: str | None, degree: int | None, points: int, jerk: bool
) -> list[str]:
    """Lines of the block that declares the curve, with the reason for it."""
    why = "as given"
    if family is None and points == 4:
        family, why = "3-5-3", "usual for four way-points; change it to the paper's curve"
    elif family is None and jerk:
        family, why = "cubic-spline-virtual", "C2 cubics at rest at both ends; change it if needed"
    elif family is None:
        family = "cubic-spline"
        why = "cubic-spline-virtual has no shortest motion without a jerk limit; add one to use it"
    meant = None if family is None else meant_by(family, FAMILIES)
    if meant is None:
        faults.add("family", unknown(family or "", FAMILIES))
        return []
    if meant.family != family:
        why = f"what papers call {family}"
    keys = dict(meant.keys)
    if degree is not None:
        keys["degree"] = degree
    note = [f"# {meant.note}"] if meant.note else []
    lines = [f"family = {_quoted(meant.family)}  # {_comment(why)}", *note]
    return lines + [f"{key} = {json.dumps(value)}" for key, value in keys.items()]


def _units(
    faults: Faults, units: Mapping[str, str], limits: Iterable[str]
) -> dict[str, str | tuple[str, ...]]:
    for key in units:
        if key not in _MEASURED:
            faults.add(f"units.{key}", f"no such quantity; known: {', '.join(_MEASURED)}")
    checked: dict[str, str | tuple[str, ...]] = {}
    needed = {"position", *limits, "time"}
    # A unit without a limit serves a printed peak.
    for key in (one for one in _MEASURED if one in needed or one in units):
        quantity = cast(Quantity, key)
        unit = units.get(key, "s" if key == "time" else None)
        if unit is None:
            faults.add(f"units.{key}", f"is missing; give one of {', '.join(CHOICES[key])}")
            continue
        try:
            each = tuple(check_unit(one, quantity) for one in _listed(unit) or [unit])
            if key == "time" and len(each) > 1:
                raise TrajgapError(f"{unit!r} are several units of time; give one")
            checked[key] = each if len(each) > 1 else each[0]
        except TrajgapError as error:
            faults.add(f"units.{key}", str(error))
    return checked


def units_in_header(csv_path: str | Path) -> str:
    """Units of positions that the header of a table states, with commas between.

    It is empty if one of them is missing, or if the table cannot be read.
    """
    faults = Faults(str(csv_path))
    try:
        units = read_waypoint_table(faults, read_text(Path(csv_path))).units
    except CaseError:
        return ""
    return "" if faults.found else ",".join(units) * all(units)


def _refuse_units(faults: Faults, table: WaypointTable, units: str | tuple[str, ...]) -> None:
    """Add that the header states another unit of a joint than the one it is to be read in."""
    each = (units,) * len(table.units) if isinstance(units, str) else units
    for joint, stated, unit in zip(table.joints, table.units, each, strict=False):
        if stated and unit and stated != unit:
            why = f"states joint {joint} in {stated}, but {unit} is the unit asked for"
            return faults.add("line 1", f"{why}; give {stated} as the unit of positions")


def identity_of(stem: str) -> str:
    """An id made from a file's name: lower-case letters, digits, dots and dashes."""
    return re.sub(r"[^a-z0-9.]+", "-", stem.lower()).strip("-.") or "case"


def _quoted(text: str) -> str:
    # TOML's basic strings escape as JSON's do, except that DEL must be escaped too.
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")


def _template() -> Template:
    """The text of a case file, with the claims that are given, and every other kind to fill in."""
    from jinja2 import Environment, StrictUndefined

    environment = Environment(
        trim_blocks=True, keep_trailing_newline=True, undefined=StrictUndefined, autoescape=False
    )
    text = files(__package__ or "").joinpath("new_case.jinja").read_text(encoding="utf-8")
    return environment.from_string(text)


def _unit_lines(units: Mapping[str, str | tuple[str, ...]]) -> list[str]:
    lines = []
    for key, choices in ((one, CHOICES[one]) for one in _MEASURED):
        unit = units.get(key)
        if isinstance(unit, tuple):
            lines.append(f"{key} = [{', '.join(map(_quoted, unit))}]")
        else:
            lines.append(
                f'# {key} = "{choices[0]}"' if unit is None else f"{key} = {_quoted(unit)}"
            )
    return lines


def _limit_lines(limits: Mapping[str, Sequence[str]], stated: Mapping[str, str]) -> list[str]:
    lines = []
    for key in QUANTITIES[:USUAL]:
        each = [str(Printed(text).decimal) for text in limits.get(key, ())]
        shown = each[0] if len(each) == 1 else f"[{', '.join(each)}]"
        shown = shown if each else stated.get(key, "")
        lines.append(f"{key} = {shown}" if shown else f"# {key} = inf")
    return lines + [f"{key} = {text}" for key, text in stated.items() if key not in QUANTITIES]


def _stated(
    limits: Limits, position: str | tuple[str, ...], units: Mapping[str, str | tuple[str, ...]]
) -> tuple[dict[str, str], dict[str, str | tuple[str, ...]]]:
    """Finite limits of a file as a case file writes them, and the units of their derivatives.

    In the units that are given, and in SI where none is.
    """
    count = limits.sides.shape[1]

    def each(unit: str | tuple[str, ...]) -> tuple[str, ...]:
        return unit if isinstance(unit, tuple) else (unit,) * count

    def scaled(values: np.ndarray, unit: str | tuple[str, ...]) -> list[float]:
        factors = [float(scale(one).bounds[0]) for one in each(unit)]
        return [x / factor + 0.0 for x, factor in zip(values.tolist(), factors, strict=True)]

    found: dict[str, str] = {}
    added: dict[str, str | tuple[str, ...]] = {}
    for order, key in enumerate(QUANTITIES[:USUAL]):
        low, high = limits.ends(key)
        if np.isinf([low, high]).all():
            continue
        per = "/s" if order == 0 else f"/s^{order + 1}"
        si = tuple(("m" if is_linear(one) else "rad") + per for one in each(position))
        unit = units.get(key, si if len(set(si)) > 1 else si[0])
        added[key] = unit
        ends = zip(scaled(low, unit), scaled(high, unit), strict=True)
        found[key] = _one_or_each(
            [repr(high) if low == -high else f"[{low!r}, {high!r}]" for low, high in ends]
        )
    if limits.braking.any():
        slower = scaled(limits.deceleration, added["acceleration"])
        found[BRAKING] = _one_or_each([repr(x) for x in slower])
    for key in ("position_lower", "position_upper"):
        values = getattr(limits, key)
        if np.isfinite(values).any():
            found[key] = _one_or_each([repr(x) for x in scaled(values, position)])
    return found, added


def _one_or_each(numbers: Sequence[str]) -> str:
    alike = len(set(numbers)) == 1 and "[" not in numbers[0]
    return numbers[0] if alike else f"[{', '.join(numbers)}]"


def _named(stated: Iterable[str]) -> str:
    """Which limits are those of a file, in words."""
    return f"limits of {listed([*dict.fromkeys(key.partition('_')[0] for key in stated)])}"


def _angles(table: WaypointTable, unit: str | tuple[str, ...]) -> dict[str, Any]:
    """Angles as a case file writes them, settings bare, what may be rounded in quotes.

    Beside the rows a remark on whole numbers: how they are taken, and how to say otherwise.
    """
    cells = [cell for row in table.rows for cell in row]
    whole = {cell: int(cell.translate(MINUS_SIGNS)) for cell in cells if _whole(cell)}
    # Settings are multiples of 5°; angles rounded to whole degrees hardly ever all are.
    exact = unit == "rad" or all(number % 5 == 0 for number in whole.values())
    rows = []
    for label, row in zip(table.labels, table.rows, strict=True):
        shown = [str(whole[cell]) if exact and cell in whole else _quoted(cell) for cell in row]
        rows.append(f"[{', '.join(shown)}],  # {_comment(label)}")
    remark = ""
    if whole and exact:
        remark = "Whole numbers count as exact; quote those that the paper rounds."
    elif whole:
        at = next(k for k, cell in enumerate(cells) if cell in whole)
        own = unit if isinstance(unit, str) else unit[at % len(table.joints)]
        low, high = whole[cells[at]] - 0.5, whole[cells[at]] + 0.5
        remark = f"{_quoted(cells[at])} may be {low:g} to {high:g} {own}; no quotes: exact"
    return {"rows": rows, "rounding": remark}


def _coarse(durations: Sequence[str]) -> str:
    """A remark on durations without decimals, which may be meant exactly."""
    whole = next((one for one in durations if re.fullmatch("[0-9]+", one)), None)
    if whole is None:
        return ""
    return f'  # "{whole}" may be {int(whole) - 0.5:g} to {int(whole) + 0.5:g}; no quotes: exact'


def _whole(text: str) -> bool:
    return re.fullmatch("[+-]?[0-9]+", text.translate(MINUS_SIGNS)) is not None


def _comment(label: str) -> str:
    return "".join(c if c.isprintable() else " " for c in label)
