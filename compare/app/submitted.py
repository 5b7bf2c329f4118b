"""From the fields of the form to an audit or a check; every fault stands beside its field."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory

from ...problem import QUANTITIES, Case, CaseError, PackageError, TrajgapError, parse_case, scaffold
from ...problem.cases import identity_of
from ...problem.limit_files import limits_of_flags, merge
from ...problem.motions import (
    Interpolation,
    Motion,
    MotionCheck,
    check_motion,
    check_samples,
    factors_of,
    interpolated,
    read_motion,
)

_TABLE = "way-points.csv"
"""Name of the file that the pasted table becomes."""


class FormError(Exception):
    """What is wrong with the form: one line for each field."""

    def __init__(self, faults: Mapping[str, str]) -> None:
        super().__init__("; ".join(faults.values()))
        self.faults = dict(faults)


def case_of(fields: Mapping[str, str]) -> tuple[str, Case]:
    """The case file that the form describes, as text and as a case.

    `fields`: what the form holds, by the names of its fields.
    """
    table = fields.get("table", "").strip()
    if not table:
        raise FormError(
            {"table": "paste the way-points, one per row, below a header with the joint names"}
        )
    limits = {one: fields[one].strip() for one in QUANTITIES if fields.get(one, "").strip()}
    asked = ("position", *limits, "time")
    units = {one: fields.get(f"{one}_unit", "") for one in asked}
    identity = identity_of(fields.get("name", "").strip() or "my-paper")
    with TemporaryDirectory() as folder:
        path = Path(folder, _TABLE)
        path.write_text(table + "\n", encoding="utf-8", errors="replace")
        try:
            text = scaffold(
                path,
                {one: unit for one, unit in units.items() if unit},
                case_id=identity,
                family=fields.get("other", "").strip() or fields.get("family") or None,
                degree=5 if fields.get("family") == "rest-to-rest" else None,
                durations=fields.get("durations") or None,
                total=fields.get("total") or None,
                where=fields.get("where", "").strip(),
                velocity=limits.get("velocity"),
                acceleration=limits.get("acceleration"),
                jerk=limits.get("jerk"),
            )
            return text, parse_case(text, f"{identity}.toml")
        except CaseError as error:
            found = _beside(error.faults)
            if "family" in found and fields.get("other", "").strip():
                found["other"] = found.pop("family")
            raise FormError(found) from None


def _beside(faults: Iterable[tuple[str, str]]) -> dict[str, str]:
    """The first fault of each field of the form."""
    found: dict[str, str] = {}
    for place, why in faults:
        known = place in (*QUANTITIES, "durations", "total", "family")
        if place.startswith("units."):
            field = f"{place.removeprefix('units.').split('[')[0]}_unit"
        else:
            # Fields of the form for what they do not ask by this name.
            places = {"": "table", "case_id": "name", "degree": "family"}
            field = place if known else places.get(place, "table")
        shown = f"{place}: {why}" if field == "table" and place else why
        found.setdefault(field, shown)
    return found


def judge_motion(
    fields: Mapping[str, str], name: str, content: bytes
) -> tuple[MotionCheck, Interpolation | None]:
    """Judge a motion from a file against the limits of the form.

    The interpolation between samples; None for polynomials. `name`: of the file: its ending says
    what it is.
    """
    if not content:
        raise FormError({"motion": "choose a file: CSV with a time column, JSON or YAML"})
    given = {one: fields.get(f"motion_{one}", "").strip() or None for one in QUANTITIES}
    if not any(given.values()):
        raise FormError(
            {"motion_velocity": "give at least one limit, which the motion is judged by"}
        )
    with TemporaryDirectory() as folder:
        path = Path(folder, "motion").with_suffix(Path(name).suffix[:8])
        path.write_bytes(content)
        try:
            read = read_motion(path, [fields.get("motion_unit", "rad")])
        except (TrajgapError, PackageError, ValueError) as error:
            # Without the path of a file that the browser sent.
            said = str(error).replace(f"{path}: ", "").replace(str(path), "the file")
            raise FormError({"motion": " ".join(said.split())}) from None
    factors = factors_of(read.units, len(read.joints), "motion_unit")
    try:
        stated = replace(limits_of_flags(given, read.joints, factors), source="the form")
        limits = merge(read.joints, [stated])
    except CaseError as error:
        field, why = error.faults[0]
        option = (error.file or field).removeprefix("--")
        place = f"motion_{option if option in QUANTITIES else 'velocity'}"
        raise FormError({place: why}) from None
    try:
        if isinstance(read.content, Motion):
            return check_motion(read.content, limits), None
        how = Interpolation(fields.get("between") or Interpolation.NONE)
        if how is Interpolation.NONE:
            return check_samples(read.content, limits), how
        return check_motion(interpolated(read.content, how), limits), how
    except (TrajgapError, ValueError) as error:
        raise FormError({"between": str(error).replace("--", "")}) from None
