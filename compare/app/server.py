"""The form in the browser, what becomes of its fields, and its server on this machine alone."""

from __future__ import annotations

import logging
import threading
from collections import OrderedDict
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

import numpy as np
from markupsafe import Markup

from ...problem import (
    CHOICES,
    QUANTITIES,
    USUAL,
    Array,
    Case,
    CaseError,
    PackageError,
    TrajgapError,
    fit,
    parse_case,
    scaffold,
)
from ...problem.cases import identity_of
from ...problem.limit_files import limits_of_flags, merge
from ...problem.motions import (
    UNITS,
    Interpolation,
    Motion,
    MotionCheck,
    check_motion,
    check_samples,
    factors_of,
    interpolated,
    read_motion,
)
from ..audits import audit
from ..blocks import GLOSSARY
from ..pages import fill_template, page_files

if TYPE_CHECKING:
    from flask import Flask, Response
    from werkzeug.serving import BaseWSGIServer

_LIMITED = QUANTITIES[:USUAL]
"""Limits that the form asks for."""
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
    limits = {one: fields[one].strip() for one in _LIMITED if fields.get(one, "").strip()}
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
        known = place in (*_LIMITED, "durations", "total", "family")
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
    given = {one: fields.get(f"motion_{one}", "").strip() or None for one in _LIMITED}
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
        place = f"motion_{option if option in _LIMITED else 'velocity'}"
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


@dataclass(frozen=True)
class OfferedCurve:
    """A curve of the form: family, name, what tells it apart, and its picture."""

    family: str
    name: str
    trait: str
    picture: Markup


@cache
def offered_curves() -> tuple[OfferedCurve, ...]:
    """The curves of the form, drawn once a process."""
    # Family, as case files name it, its name, and what tells it apart.
    offered = (
        ("", "Usual for the table", "3-5-3 for four way-points, else C2 cubics"),
        ("3-5-3", "3-5-3 polynomials", "acceleration continuous; four way-points"),
        ("cubic-spline", "Cubic spline", "acceleration continuous, not 0 at the ends"),
        ("cubic-spline-virtual", "Cubic spline, two virtual points", "acceleration 0 at the ends"),
        ("quintic-spline", "Quintic spline", "jerk and snap continuous"),
        ("rest-to-rest", "Quintic, at rest at each way-point", "stops at every way-point"),
    )
    return tuple(OfferedCurve(*one, _picture(one[0]) if one[0] else Markup()) for one in offered)


def _picture(family: str, width: float = 160.0, height: float = 84.0) -> Markup:
    """Angle and acceleration of a curve; two pictures stand beside each other at 390 px."""
    units = {"position_unit": "rad", "jerk": "1", "jerk_unit": "rad/s^3"}
    # Way-points of the pictures, rad: unequal steps and a reversal.
    points = "a\n0\n0.7\n1.2\n0.5"
    _, case = case_of({"table": points, "family": family, **units})
    problem = case.problem()
    motion = fit(problem.curve, problem.waypoints, np.full(problem.segments, 1.0))
    times = np.linspace(0.0, motion.total_time, 161)[1:-1]
    angle, acceleration = motion(times)[:, 0], motion(times, 2)[:, 0]

    def placed(at: Array, values: Array, of: Array) -> list[tuple[float, float]]:
        low, high = of.min(), of.max()
        across, down = at / motion.total_time, (high - values) / (high - low)
        return list(zip(width * across, height * down, strict=True))

    first, second = (
        " ".join(f"{x:.1f},{y:.1f}" for x, y in placed(times, values, values))
        for values in (angle, acceleration)
    )
    dots = "".join(
        f'<circle cx="{x:.1f}" cy="{y:.1f}" r="2.4"/>'
        for x, y in placed(motion.breaks, motion(motion.breaks)[:, 0], angle)
    )
    return Markup(
        f'<svg viewBox="-4 -4 {width + 8:g} {height + 8:g}" role="img" aria-hidden="true">'
        f'<polyline class="second" points="{second}"/>'
        f'<polyline class="first" points="{first}"/>{dots}</svg>'
    )


ADDRESS = "127.0.0.1"
"""Where the server listens: no other machine reaches it."""
_TEMPLATE = Path(__file__).parent / "templates" / "form.html"
"""The form, as package data."""


def make_server(port: int = 0) -> BaseWSGIServer:
    """Make the server of the form, on this machine alone.

    Its ``port`` is bound; ``serve_forever()`` serves. `port`: 0 for any that is free.
    """
    app = make_form()
    from werkzeug.serving import make_server as bound

    logging.getLogger("werkzeug").setLevel(logging.ERROR)  # a line for each request otherwise
    try:
        return bound(ADDRESS, port, app, threaded=True)
    except (OSError, SystemExit):
        raise TrajgapError(f"--port: {port} cannot be used; choose another one") from None


def make_form(largest: int = 20_000_000, remembered: int = 20) -> Flask:
    """Make the form and its pages.

    `largest`: bytes of a request; half an hour of six joints at 125 rows a second takes that much
    as text. `remembered`: audits whose pages are kept in memory, the last ones.
    """
    try:
        from flask import Flask, abort, redirect, request
    except ImportError as error:
        raise PackageError(
            f"trajgap app: needs the package flask ({error}); install it with "
            "`python -m pip install flask`"
        ) from None
    app = Flask(__name__, static_folder=None)
    app.config["MAX_CONTENT_LENGTH"] = largest
    kept: OrderedDict[int, dict[str, str]] = OrderedDict()
    one_at_a_time = threading.Lock()

    def _fields() -> dict[str, str]:
        # Browsers end the lines of a form by two characters.
        return {name: text.replace("\r\n", "\n") for name, text in request.form.items()}

    @app.before_request
    def _of_this_machine() -> None:
        # Pages of other sites can send forms here, or reach it by a name of their own.
        if request.host.partition(":")[0] not in (ADDRESS, "localhost"):
            abort(403)
        if request.headers.get("Origin", request.host_url[:-1]) != request.host_url[:-1]:
            abort(403)

    @app.after_request
    def _closed(response: Response) -> Response:
        # What pages may load: nothing from elsewhere, and no script at all.
        policy = (
            "default-src 'none'; img-src 'self' data:; style-src 'unsafe-inline'; "
            "form-action 'self'; frame-ancestors 'none'; base-uri 'none'"
        )
        response.headers["Content-Security-Policy"] = policy
        response.headers["X-Content-Type-Options"] = "nosniff"
        response.headers["Cache-Control"] = "no-store"
        return response

    @app.get("/")
    def _form() -> str:
        return form_page({}, {})

    @app.post("/audit")
    def _audit() -> Any:
        fields = _fields()
        try:
            text, case = case_of(fields)
            with one_at_a_time:
                save = "Save the case file", f"{case.id}.toml"
                links = ("New audit", "/"), save, ("Glossary", GLOSSARY)
                files = page_files(audit(case).cases[0], links)
                number = next(reversed(kept), 0) + 1
                kept[number] = files | {f"{case.id}.toml": text}
                if len(kept) > remembered:
                    kept.popitem(last=False)
        except FormError as error:
            return form_page(fields, error.faults), 422
        except TrajgapError as error:
            return form_page(fields, {"table": " ".join(str(error).split())}), 422
        return redirect(f"/audits/{number}/{next(iter(files))}", 303)

    @app.get("/audits/<int:number>/<path:name>")
    def _page(number: int, name: str) -> Any:
        if name not in kept.get(number, {}):
            abort(404)
        # Kinds of files; anything else is plain text.
        types = {".html": "text/html", ".svg": "image/svg+xml", ".json": "application/json"}
        kind = types.get(Path(name).suffix, "text/plain")
        head = {"Content-Disposition": "attachment"} if name.endswith(".toml") else {}
        return app.response_class(kept[number][name], mimetype=kind, headers=head)

    @app.post("/check")
    def _check() -> Any:
        fields, sent = _fields(), request.files.get("motion")
        name, content = (sent.filename or "", sent.read()) if sent else ("", b"")
        try:
            found, how = judge_motion(fields, name, content)
        except FormError as error:
            return form_page(fields, error.faults), 422
        between = "" if how is None else f", interpolation {how}"
        return form_page(fields, {}, f"{name}{between}\n{found}", str(found.verdict))

    @app.errorhandler(500)
    def _failed(_: Exception) -> Any:
        said = "this is a bug in trajgap; please report the lines in the terminal"
        return form_page(_fields(), {"table": said}), 500

    @app.errorhandler(413)
    def _too_large(_: Exception) -> Any:
        return form_page({}, {"motion": f"larger than {largest // 10**6} MB"}), 413

    return app


def form_page(
    fields: Mapping[str, str], faults: Mapping[str, str], result: str = "", verdict: str = ""
) -> str:
    """The form with what was filled in, faults beside their fields, and a verdict on a motion."""
    # What the form shows in grey.
    example = {
        "table": "j1,j2\n0.0,0.2\n0.6,0.9\n1.1,0.4\n0.8,-0.1",
        "velocity": "3",
        "durations": "0.7, 0.8, 0.65",
        "where": "Table 2",
        "name": "my-paper",
    }
    return fill_template(
        _TEMPLATE,
        fields=fields,
        faults=faults,
        example=example,
        limits=_LIMITED,
        choices=CHOICES,
        units=tuple(UNITS),
        between=[str(one) for one in Interpolation],
        curves=offered_curves(),
        result=result,
        verdict=verdict,
    )
