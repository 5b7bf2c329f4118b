"""Forgeries of lower bounds of declared curves, which are proved in floats."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from support.forgeries.forgery import GONE, NO_ANSWER, WHOLE, Document, Forgery, beyond, spline

_KIND, _COVERED, _BOXES = "declared.DeclaredCurve.", "declared.covered: ", "boxes.Boxes."
NOT_PROVED = _BOXES + "end: a leaf with limits is not proved"
UNDETERMINED = "declared_form.linear_form: the conditions do not determine the curve"
NOT_THERE = "boxes.Boxes.read_rows: a row leans on a limit that is not there"


def _leaf(change: Callable[[list[Any]], Any], least: int = 0) -> Callable[[Document], None]:
    """A change of the first leaf whose τ is at least so large."""

    def altered(data: Document) -> None:
        leaves = (node for node in data["proof"]["tree"] if type(node) is list and len(node) > 2)
        change(next(leaf for leaf in leaves if abs(leaf[1]) >= least))
        data["claim"] |= {"durations": None, "upper": None}

    return altered


def _turned(leaf: list[Any]) -> None:
    leaf[1] = -leaf[1]


FORGERIES = [
    Forgery(_KIND + "__init__: the total is not positive", "declared",
            {"proof.total": "0", "claim.lower": "0"}),
    Forgery(_KIND + "_task: the curve has too many unknowns", "declared", spline(12, 9)),
    *(Forgery(NOT_THERE, "declared", {**NO_ANSWER, **changes}) for changes in (
        {"proof.rows.0": [0, 0, 3, 1, 0]}, {"proof.rows.0": [0, 0, 0, 1, 0]},
        {"proof.rows.0": [0, 1, 0, -1, 0]}, {"problem.limits.0.0": "0"},
        {"problem.limits.0.0": [None, "1"]}, {"problem.limits.0.0": ["-1", None]},
        {"problem.limits.0.0": "1e16"})),
    # A segment in which nothing moves, and one next to a virtual way-point.
    *(Forgery(_KIND + "root: segment {min(zero, default=0)}: {_NO_FLOOR}", "declared-free",
              {**NO_ANSWER, "problem.duration_lower": ["0"] * 3, **changes})
      for changes in (
          {"problem.waypoints.1": ["-0.375", "0.75"]},
          {"problem.limits": [[None] * 3] * 2, "proof.rows": []},
          {"problem.degrees": [3, 3, 3], "problem.virtual": [1],
           "problem.waypoints": [["0"] * 2, ["1"] * 2, ["0.5"] * 2],
           "problem.prescribed.3": [[1, "0"]]})),
    *(Forgery(_BOXES + "cut: the place of a cut is not stated in this kind of proof",
              "declared", {"proof.tree": [["/", 0, place], ["."], ["."]]}) for place in ("1", 0)),
    *(Forgery(_BOXES + "leaf: it is not empty", "declared", {"proof.tree": tree})
      for tree in ([["."]], [0, ["."], ["."]])),
    *(Forgery(_KIND + "leaf: no way-point is beyond its limit there", "declared",
              {**NO_ANSWER, "proof.rows": [row], "proof.tree": [[".", 0]]})
      for row in ([0, 0, 0, -1, 0], [0, 0, 0, -1, 5], [1, 0, 0, -1, 2**19], [1, 1, 0, 1, 2**20],
                  [1, 1, 2, 1, 0])),
    # At a limit is not beyond it, and what hangs on the durations may be moved.
    *(Forgery(_KIND + "leaf: no way-point is beyond its limit there", "declared",
              {**NO_ANSWER, "problem.position_lower.0": low, "proof.rows": [row],
               "proof.tree": [[".", 0]]})
      for low, row in (("-0.375", [2, 0, 0, -1, 0]), ("-0.25", [2, 0, 0, -1, 5]))),
    Forgery(_BOXES + "end: a leaf misses a weight", "declared",
            {"proof.tree": [[".", 0, 0, 1, 0]]}),
    Forgery(_BOXES + "end: a leaf has too many rows", "declared",
            {"proof.tree": [[".", 0, *[0, 1] * 65]]}),
    *(Forgery(NOT_PROVED, kind, changes) for kind, changes in (
        ("declared", {"proof.tree": [[".", 0, 0, 1]]}),
        ("declared", {"proof.tree": [[".", 0, 0, 0]]}),
        ("declared", {**NO_ANSWER, "proof.total": "14.8583"}),
        ("declared-free", {**NO_ANSWER, "proof.total": "6.07595"}),
        ("declared", {**NO_ANSWER, "problem.limits.0.0": "1.05"}),
        ("declared", {**NO_ANSWER, "problem.limits.0.0": ["-1.05", "1"]}),
        ("declared-free", {**NO_ANSWER, "problem.limits.0.1": "2.1"}),
        ("declared-free", {**NO_ANSWER, "problem.limits.0.1": ["-2", "2.1"]}),
        ("declared-free", {**NO_ANSWER, "problem.waypoints.1.0": "0.99"}),
        # Ends in motion make the curve faster.
        ("declared", {**NO_ANSWER, "problem.prescribed.0": [[1, "0.5"], [2, "0"]]}),
        ("declared", {**NO_ANSWER, "problem.prescribed.3": [[1, ["0.5", "-0.25"]], [2, "0"]]}),
        ("declared", {**NO_ANSWER, "problem.prescribed.0": [[1, "0"], [2, ["1", "0.5"]]]}),
        # With an upper bound no answer is stretched to the total: nothing is cut off below it.
        ("declared-free", {**NO_ANSWER, "problem.duration_upper": ["5", "5", "5"],
                           "proof.tree": [[".", 1, 0, 1]]}),
        ("declared-free", _leaf(_turned, 600_000 // 1024)),
        ("declared-free", _leaf(lambda leaf: leaf.__setitem__(slice(2, None), [2, 1]))))),
    Forgery(NOT_PROVED, "declared", lambda data: data["proof"].update(
        tree=[0, *data["proof"]["tree"], [".", 0, 0, 1]])),
    Forgery(_COVERED + "declaration not covered: no declared piecewise polynomial", "stretched",
            lambda data: data.update(proof={"kind": "declared", "total": data["proof"]["total"],
                                            "rows": [], "tree": [["."]]})),
    *(Forgery(_KIND + "_task: a prescribed derivative is of unusual size", "declared",
              {**NO_ANSWER, f"problem.prescribed.{end}": [[1, value], [2, "0"]]})
      for end in (0, 3) for value in ("1e16", ["0", "-1e-17"])),
    Forgery(_COVERED + "one segment alone has no inner break", "declared", spline(1)),
    Forgery(_COVERED + "more than {MOST_DECLARED_SEGMENTS} segments", "declared", spline(13)),
    *(Forgery(UNDETERMINED, "declared", {**NO_ANSWER, path: value}) for path, value in (
        ("problem.degrees.0", 4), ("problem.degrees.1", 3), ("problem.continuity.0", 1),
        ("problem.prescribed.0", [[1, "0"]]))),
    # A straight line is not at rest at its end, nor a cubic with two such conditions before it.
    *(Forgery("curve.eliminated: the conditions contradict each other", "declared",
              {**NO_ANSWER, path: value})
      for path, value in (("problem.degrees.0", 1), ("problem.prescribed.1", [[1, "0"]]))),
    *beyond("declared", {
        "proof.rows.0.0": (0, 2), "proof.rows.0.1": (0, 1), "proof.rows.0.2": (0, 3),
        "proof.rows.0.4": (0, 2**20)}),
    # Only a total that answers may be stretched to lets τ be negative.
    *(Forgery(WHOLE, "declared", {"proof.tree": [node]}) for node in (
        3, [".", 99], [".", -1], [".", -1, 0, 1], [".", 0, 0, -1], [".", 0, 99, 1],
        [".", 0, -1, 1], [".", "1", 0, 1], [".", 2**52 + 1, 0, 1], [".", 0, 0, 2**52 + 1])),
    Forgery(WHOLE, "declared-free", {"proof.tree": [[".", -(2**52) - 1, 0, 1]]}),
    # Where ends move, no answer may be stretched to the total either.
    Forgery(WHOLE, "declared-free", {
        **NO_ANSWER, "problem.prescribed.0": [[1, "0.1"], [2, "0"]],
        "proof.tree": [[".", -1, 0, 1]]}),
    Forgery("reading.fields: malformed: {what}: {', '.join(missing)}: missing", "declared",
            {"proof.rows": GONE}),
]  # fmt: skip
