"""Whole case files drawn from their grammar, and a second reading of what they pose."""

import math
from typing import Any

import numpy as np
from support.toml_text import Bare

from attacks import cases

FACTORS = {"rad": 1.0, "deg": math.pi / 180, "s": 1.0, "ms": 1e-3}
"""What a unit is in rad and s; units of derivatives begin with one of these."""
SEARCHES: dict[str, dict[str, Any]] = {
    "pso": {"particles": 4, "iterations": 4},
    "mnam-pso": {"particles": 6, "iterations": 4},
    "constrained-pso": {"particles": 4, "iterations": 4},
    "woa": {"whales": 4, "iterations": 4},
    "improved-woa": {"whales": 4, "iterations": 4},
    "ga": {"population": 4, "iterations": 4},
    "improved-ga": {"population": 8, "iterations": 4},
}
"""Smallest settings of each algorithm that a case may replay."""
_WORDS = ("within_limits", "continuous", "jumps", "at_rest", "optimal", "none")
_STRANGE = ("joint 1", "θ₁", "a.b", "x" * 40, "1-2", "J\u00e9", "关节", "q/1", "l'axe", '"')
"""Labels that are allowed and awkward."""


def draw_case(rng: cases.Rng, small: bool = False) -> cases.Drawn:
    """A valid case file with problems, readings, claims, tables, algorithms and all the rest."""
    most = (4, 2) if small else (6, 3)
    asked = cases.draw_asked(
        rng, most_points=most[0], most_joints=most[1], scale=float(rng.integers(2))
    )
    labels = tuple(asked.labels)
    if rng.random() < 0.3:
        labels = tuple(rng.permutation(_STRANGE)[: len(labels)].tolist())
    raw = cases.raw_of(asked, str(rng.choice(["drawn", "a", "a-b.c", "0", "x" * 60])))
    raw["robot"]["joints"] = list(labels)
    raw["title"] = str(rng.choice(["drawn", "T\u00eate", "<b>&amp;</b>", "a|b", "`x` _y_ *z*"]))
    _reword(rng, raw)
    if rng.random() < 0.5:
        raw["source"] = {"authors": "A. Uthor", "year": 2020, "doi": "10.0/x", "note": "n"}
    problems = _problems(rng, raw, asked, labels)
    readings = _readings(rng, raw, asked)
    if problems:
        raw["problems"] = problems
    if readings:
        raw["readings"] = readings
    first = problems[0]["id"] if problems else "main"
    default = next((r["id"] for r in readings if r.get("default")), None)
    default = default or (readings[0]["id"] if readings else "as-printed")
    _claims(rng, raw, (first, default), first if problems else None)
    pairs = [
        (p, r)
        for p in [x["id"] for x in problems] or ["main"]
        for r in [x["id"] for x in readings] or ["as-printed"]
    ]
    return cases.Drawn(raw, {pair: asked_of(raw, *pair) for pair in pairs})


def _reword(rng: cases.Rng, raw: dict[str, Any]) -> None:
    """The same numbers in other units, by way-point instead of by joint, printed or exact."""
    for key, words in cases.UNITS.items():
        raw["units"][key] = str(rng.choice(words))

    def said(text: str, unit: str, exact: bool) -> str:
        if math.isinf(float(text)):
            return Bare(text)
        digits = f"{float(text) / FACTORS[unit.split('/')[0]]:.6g}"
        return Bare(digits) if exact else digits

    exact = bool(rng.random() < 0.5)
    mixed = bool(rng.random() < 0.3)
    units, way, limits = raw["units"], raw["waypoints"], raw["limits"]
    # Printed and exact numbers side by side, as where one entry is a plain 0.
    rows = [
        [said(x, units["position"], exact ^ (mixed and bool(rng.random() < 0.3))) for x in row]
        for row in way.pop("joint_rows")
    ]
    if rng.random() < 0.3:
        way["waypoint_rows"] = [list(column) for column in zip(*rows, strict=True)]
    else:
        way["joint_rows"] = rows
    if rng.random() < 0.5:
        way["labels"] = [f"P{k}" for k in range(len(rows[0]))]
    for key, values in limits.items():
        unit = units["position" if key.startswith("position") else key]
        limits[key] = [
            [said(side, unit, bool(rng.random() < 0.5)) for side in x]
            if isinstance(x, list)
            else said(x, unit, bool(rng.random() < 0.5))
            for x in values
        ]
        first = limits[key][0]
        if not isinstance(first, list) and len(values) > 1 and limits[key] == [first] * len(values):
            limits[key] = first
    for key, values in raw["durations"].items():
        raw["durations"][key] = [said(x, units["time"], exact) for x in values]
    raw["interpolant"] = ends_said(raw["interpolant"], units, said)


def ends_said(block: dict[str, Any], units: dict[str, str], said: Any) -> dict[str, Any]:
    """A block whose end derivatives, in rad and s, are written in the units of a file."""
    written = dict(block)
    first = block.get("end_orders", [1] if block["family"] == "cubic-spline" else [1, 2])
    for key, orders in (
        ("end_derivatives", first),
        ("finish_derivatives", block.get("finish_orders", first)),
    ):
        if key in written:
            written[key] = [
                _each_said(value, r, units, said)
                for r, value in zip(orders, written[key], strict=True)
            ]
    return written


def _each_said(value: Any, order: int, units: dict[str, str], said: Any) -> Any:
    if isinstance(value, list):
        return [_each_said(one, order, units, said) for one in value]
    if order > len(cases.DERIVATIVES):
        return Bare("0")
    return said(repr(value), units[cases.DERIVATIVES[order - 1]], True)


def _problems(
    rng: cases.Rng, raw: dict[str, Any], asked: cases.Asked, labels: tuple[str, ...]
) -> list[dict[str, Any]]:
    if rng.random() < 0.6:
        return []
    made: list[dict[str, Any]] = [{"id": "p-1", "title": "first", "where": "s. 1"}]
    second: dict[str, Any] = {"id": "p.2", "why": "slower"}
    second["limits"] = {"velocity": Bare(f"{rng.uniform(20, 90):.3g}")}
    if len(labels) > 1 and asked.block["family"] != "clamped-b-spline" and rng.random() < 0.5:
        second["joints"] = [labels[-1]]
    return [*made, second]


def _readings(rng: cases.Rng, raw: dict[str, Any], asked: cases.Asked) -> list[dict[str, Any]]:
    if rng.random() < 0.5:
        return []
    made: list[dict[str, Any]] = [{"id": "as-is", "why": "as printed"}]
    many = len(asked.labels)
    kinds = ["units", "angles", "limits", "sides", "durations", "curve", "ends", "coupling"]
    for kind in rng.permutation(kinds)[:2]:
        own: dict[str, Any] = {"id": f"r.{kind}", "why": f"another {kind}"}
        match kind:
            case "units":
                key = str(rng.choice(["velocity", "acceleration"]))
                other = [u for u in cases.UNITS[key] if u != raw["units"][key]]
                own["units"] = {key: other[0]}
            case "angles":
                own["units"] = {"position": "deg" if raw["units"]["position"] == "rad" else "rad"}
            case "sides":
                pairs = [[Bare(f"{-x:.3g}"), f"{y:.3g}"] for x, y in rng.uniform(9, 90, (many, 2))]
                own["limits"] = {"velocity": pairs}
            case "ends" if cases.segments_of(asked.block, 9) == 8:
                start, finish = rng.uniform(-9, 9, (2, many))
                own["interpolant"] = {
                    "family": "cubic-spline",
                    "end_derivatives": [[Bare(f"{x:.3g}") for x in start]],
                    "finish_derivatives": [[Bare(f"{x:.3g}") for x in finish]],
                }
            case "limits":
                own["limits"] = {"acceleration": f"{rng.uniform(30, 90):.3g}", "jerk": Bare("inf")}
            case "durations":
                own["durations"] = {"lower": Bare("0"), "upper": Bare("inf")}
            case "curve" if cases.segments_of(asked.block, 9) == 8:
                family = rng.choice(["jtraj", "cubic-spline", "uniform-cubic-b-spline"])
                own["interpolant"] = {"family": str(family)}
                if family == "uniform-cubic-b-spline":
                    own["interpolant"]["time"] = "timed"
            case _:
                own["coupling"] = str(rng.choice(["shared", "per-joint"]))
        made.append(own)
    made[int(rng.integers(len(made)))]["default"] = True
    return made


def _claims(
    rng: cases.Rng, raw: dict[str, Any], pair: tuple[str, str], problem: str | None
) -> None:
    """One claim of each quantity, some of them; and what they refer to."""
    posed = cases.problem_of(cases.Drawn(raw, {}), pair)
    try:
        h = cases.near_limits(rng, posed, 1.0, float(rng.choice([0.7, 1.0, 1.4])))
    except cases.NoCurve:
        h = np.ones(posed.curve.segments)
    h = h / FACTORS[raw["units"]["time"]]
    raw["algorithms"] = []
    if rng.random() < 0.5:
        kind = str(rng.choice(list(SEARCHES)))
        own = {"id": "search", "name": "S", "kind": kind, "settings": SEARCHES[kind]}
        raw["algorithms"].append(own | {"open": ["seed"]})
    places = int(rng.integers(1, 7))
    common: dict[str, Any] = {"where": "Table 1", "problem": problem}
    if raw["algorithms"]:
        common["algorithm"] = "search"
    claims: list[dict[str, Any]] = []
    for name, factor in (("d-1", 1.0), ("d-2", 1.1)):
        durations = [_digits(x * factor, places) for x in h]
        claims.append({"id": name, "quantity": "durations", **common, "durations": durations})
        if rng.random() < 0.5:
            claims[-1]["total"] = _digits(sum(map(float, durations)), places)
    drawn = rng.permutation(cases.CLAIMS)[: rng.integers(len(cases.CLAIMS) + 1)]
    for quantity in drawn:
        if quantity != "durations":
            claims.append({"id": f"c-{quantity}".replace("_", "-"), "quantity": str(quantity)})
            claims[-1] |= common | _claim(rng, str(quantity), raw, claims, h)
    if rng.random() < 0.3:
        raw["tables"] = [{"id": "t", "where": "Table 1", "title": "Times"}]
        claims[0]["table"] = "t"
    raw["claims"] = claims
    if rng.random() < 0.3:
        raw["assumptions"] = [
            {"id": "as", "text": "open", "choice": "closed", "affects": ["limits", "d-1"]}
        ]
        raw["not_checkable"] = [{"id": "n", "where": "F. 1", "what": "plot", "why": "blurred"}]
        raw["columns"] = [{"id": "col", "where": "T", "unit": "-", "values": ["1", "2.50"]}]


def _claim(
    rng: cases.Rng, quantity: str, raw: dict[str, Any], claims: list[dict[str, Any]], h: cases.Array
) -> dict[str, Any]:
    joints, points = len(raw["robot"]["joints"]), _points(raw)
    match quantity:
        case "maximum":
            longest = [max(a, b, key=float) for a, b in _pairs(claims)]
            return {"of": ["d-1", "d-2"], "durations": longest}
        case "total_time":
            return {"value": f"{h.sum():.3g}"}
        case "improvement":
            return {"slower": "d-2", "faster": "d-1", "percent": "9.1"}
        case "peak":
            key = str(rng.choice(cases.DERIVATIVES))
            value = f"{10 ** rng.uniform(-1, 2):.3g}"
            own = {"of": "d-1", "derivative": key}
            return own | ({"value": value} if rng.random() < 0.5 else {"values": [value] * joints})
        case "measure":
            key, kind = str(rng.choice(cases.DERIVATIVES)), str(rng.choice(cases.MEASURES))
            return {"of": "d-1", "derivative": key, "measure": kind, "value": "1.3"}
        case "value":
            key, place = (
                str(rng.choice(("position", *cases.DERIVATIVES))),
                str(rng.choice(cases.PLACES)),
            )
            return {"of": "d-1", "derivative": key, "place": place, "values": ["-1.3"] * joints}
        case "convergence":
            return {"iterations": Bare("30")}
        case "control_vertices":
            rows = rng.normal(size=(joints, points + 2))
            return {"joint_rows": [[f"{x:.2f}" for x in row] for row in rows]}
        case "conditions":
            own = {"rest_at": "ends", "orders": [1, 2], "degrees": [3, 5, 3], "count": Bare("14")}
            return own
    checks = str(rng.choice(_WORDS))
    return {"checks": checks} | (
        {"not_checkable": "a word"} if checks == "none" else {"of": ["d-1"]}
    )


def _pairs(claims: list[dict[str, Any]]) -> list[tuple[str, str]]:
    return list(zip(claims[0]["durations"], claims[1]["durations"], strict=True))


def _digits(value: float, places: int) -> str:
    """The value as a paper might print it: fixed places, but never 0."""
    text = f"{value:.{places}f}"
    return text if float(text) > 0 and len(text) < 60 else f"{value:.3e}"


def _points(raw: dict[str, Any]) -> int:
    way = raw["waypoints"]
    return len(way["joint_rows"][0]) if "joint_rows" in way else len(way["waypoint_rows"])


def asked_of(raw: dict[str, Any], problem: str, reading: str) -> cases.Asked:
    """What a case file asks under a problem and a reading, read a second time."""
    layers = [raw]
    for key, name in (("problems", problem), ("readings", reading)):
        layers += [block for block in raw.get(key, []) if block["id"] == name]
    units: dict[str, str] = {}
    limits: dict[str, Any] = {}
    bounds: dict[str, Any] = {}
    block, coupling, taken = raw["interpolant"], "shared", raw["robot"]["joints"]
    for layer in layers:
        units |= layer.get("units", {})
        limits |= layer.get("limits", {})
        bounds |= layer.get("durations", {})
        block = layer.get("interpolant", block)
        coupling = layer.get("coupling", coupling)
        taken = layer.get("joints", taken)
    way = raw["waypoints"]
    rows = way.get("joint_rows") or [list(c) for c in zip(*way["waypoint_rows"], strict=True)]
    own = {key: FACTORS[unit.split("/")[0]] for key, unit in units.items()}
    labels = raw["robot"]["joints"]
    columns = [j for j, label in enumerate(labels) if label in taken]
    points = np.array([[float(x) for x in row] for row in rows]).T * own["position"]
    segments = cases.segments_of(block, len(points))

    def each(values: Any, count: int, default: float, factor: float) -> cases.Array:
        if values is None:
            return np.full(count, default)
        if not isinstance(values, list):
            values = [values] * count
        return np.array([float(x) for x in values]) * factor

    def limit(key: str, default: float, side: int = 0) -> cases.Array:
        unit = own["position" if key.startswith("position") else key]
        given = limits.get(key)
        if isinstance(given, list):
            given = [(x[1], -float(x[0]))[side] if isinstance(x, list) else x for x in given]
        return each(given, len(labels), default, unit)[columns]

    sides = [[limit(key, np.inf, side) for key in cases.DERIVATIVES] for side in (1, 0)]
    in_si = {r: own[key] for r, key in enumerate(cases.DERIVATIVES, 1)}
    ends, finish = (
        {r: v[columns] * in_si.get(r, 1.0) for r, v in end.items()}
        for end in cases.ends_in(block, len(labels))
    )
    return cases.Asked(
        block,
        points[:, columns],
        np.moveaxis(np.array(sides), 1, 2),
        limit("position_lower", -np.inf),
        limit("position_upper", np.inf),
        each(bounds.get("lower"), segments, 0.0, own["time"]),
        each(bounds.get("upper"), segments, np.inf, own["time"]),
        tuple(labels[j] for j in columns),
        coupling,
        ends,
        finish,
    )
