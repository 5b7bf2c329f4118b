"""Forgeries of lower bounds of C4 quintic splines, which are proved in floats."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from support.forgeries.forgery import NO_ANSWER, WHOLE, Document, Forgery, beyond, spline
from trajgap.verify import quintic_bound

_KIND, _BOUND, _BOXES = "quintic.QuinticSpline.", "quintic_bound.", "boxes.Boxes."
WIDE = "a leaf that is too wide is not proved"
NOT_COVERED = "quintic._covered: declaration not covered: no C4 quintic spline at rest at the ends"


def _first_leaf(change: Callable[[list[Any]], Any]) -> Callable[[Document], None]:
    """A change of the first leaf."""

    def altered(data: Document) -> None:
        change(next(node for node in data["proof"]["tree"] if type(node) is list))

    return altered


def _narrow(*durations: str, total: str, leaf: list[Any]) -> Callable[[Document], None]:
    """One box from these durations on, which are the lower bounds of the problem."""

    def altered(data: Document) -> None:
        spline(len(durations), 5)(data)
        data["problem"]["duration_lower"] = list(durations)
        data["proof"] |= {
            "powers": [0], "low": list(durations), "total": total, "rows": [[0, 0, 1, 1, 512]],
            "windows": [], "tree": [leaf],
        }  # fmt: skip
        data["claim"]["lower"] = total

    return altered


def _window(numbers: list[int], tau: str, **more: Any) -> dict[str, Any]:
    return {
        **NO_ANSWER, "proof.windows": [[0, *numbers]], "proof.tree": [[".", 0, tau]], **more,
    }  # fmt: skip


FORGERIES = [
    *(Forgery(_KIND + "__init__: a total that is no float of usual size is not proved",
              "quintic-spline", {"proof.total": total, "claim.lower": "0"})
      for total in ("6.1", "0", "2000000000", "1/2147483648")),
    *(Forgery(_KIND + "__init__: a number is of unusual size", "quintic-spline",
              {**NO_ANSWER, path: value})
      for path, value in (
          ("problem.waypoints.1.0", "0.25" + "0" * 30 + "1"), ("problem.waypoints.1.0", "-1e30"),
          ("problem.limits.0.1", "1e31"), ("problem.limits.0.1", "1e-31"))),
    *(Forgery(_KIND + "__init__: segment {k + 1}: its least duration is not proved",
              "quintic-spline", {f"proof.low.{k}": low})
      for k, low in ((0, "0.9375"), (0, "0.7"), (0, "-0.5"), (1, "1.5"), (2, "0.9375"))),
    Forgery(_BOXES + "cut: the place of a cut is not stated in this kind of proof",
            "quintic-spline", {"proof.tree": [["/", 0, "1"], ["."], ["."]]}),
    *(Forgery(_BOXES + "leaf: it is not empty", "quintic-spline", {"proof.tree": tree})
      for tree in ([["."]], [0, ["."], ["."]])),
    *(Forgery(_KIND + "leaf: a window's tau is of unusual size", "quintic-spline",
              _window([0] * 7, tau)) for tau in ("5e-61", "-1e-60", "1e60", "-2e60")),
    *(Forgery(_KIND + "leaf: it is not proved by its window", "quintic-spline",
              _window(numbers, tau))
      for numbers, tau in (([0] * 7, "0"), ([0] * 7, "1"), ([0] * 7, "-1"),
                           ([0, 0, 0, 0, 65536, 0, 0], "0"), ([0, 65536, 0, 0, 0, 0, 0], "0"))),
    Forgery(_BOXES + "end: a leaf with limits is not proved", "quintic-spline",
            {"proof.total": "6.1875"}),
    *(Forgery(_BOXES + "end: a leaf with limits is not proved", "quintic-spline",
              {**NO_ANSWER, "proof.low": ["0.5", "1", "0.5"], "problem.limits.0.0": limit})
      for limit in ("1.01", ["-1", "1.01"])),
    Forgery(_KIND + "_terms: a window leans on a limit that is not there", "quintic-spline",
            _window([0, 65536, 0, 0, 0, 0, 0], "0",
                    **{"problem.limits.0.1": None, "proof.rows": []})),
    Forgery(_KIND + "_terms: a window leans on a limit that is not there",
            "quintic-spline", _window([0, 0, 0, 0, 65536, 0, 0], "0",
                                      **{"problem.limits.0.0": None, "proof.low": ["0.5"] * 3,
                                         "proof.rows": []})),
    *(Forgery(NOT_COVERED, "quintic-spline", {**NO_ANSWER, path: value})
      for path, value in (
          ("problem.degrees.1", 4), ("problem.continuity.0", 3), ("problem.prescribed.0", []),
          ("problem.prescribed.1", [[1, "0"]]), ("problem.prescribed.3", [[1, "0"], [2, "1"]]))),
    Forgery(NOT_COVERED, "stretched", lambda data: data.update(
        proof={"kind": "quintic-spline", "total": data["proof"]["total"], "tree": [["."]],
               "powers": [0, 0], "second": 0, "low": ["0"] * 3, "windows": [], "rows": []})),
    Forgery(NOT_COVERED, "quintic-spline", spline(1, 5)),
    Forgery("quintic._covered: more than {MOST_QUINTIC_SEGMENTS} segments",
            "quintic-spline", spline(27, 5)),
    Forgery("quintic._covered: more than {MOST_QUINTIC_JOINTS} joints",
            "quintic-spline", spline(3, 5, 13)),
    *(Forgery("reading.sign_of: malformed: a sign is neither 1 nor -1", "quintic-spline",
              {"proof.rows.0.3": sign}) for sign in (0, 2, -2)),
    *(Forgery(_BOXES + "read_rows: a row leans on a limit that is not there",
              "quintic-spline", changes)
      for changes in ({"proof.rows.0.2": 3}, {**NO_ANSWER, "problem.limits.0.0": "0"},
                      {**NO_ANSWER, "problem.limits.0.0": ["-1", None]})),
    *beyond("quintic-spline", {
        "proof.rows.0.0": (0, 2), "proof.rows.0.1": (0, 1), "proof.rows.0.2": (1, 3),
        "proof.rows.0.4": (0, 1024), "proof.powers.0": (-60, 60), "proof.second": (-60, 60)}),
    *(Forgery(WHOLE, "quintic-spline", {path: value}) for path, value in (
        ("proof.tree", [[".", 0, "1"]]), ("proof.tree", [3]), ("proof.windows", [[2, *[0] * 7]]),
        ("proof.windows", [[0, 2**20 + 1, *[0] * 6]]),
        ("proof.windows", [[0, -(2**20) - 1, *[0] * 6]]))),
    *(Forgery(WHOLE, "quintic-spline",
              _first_leaf(lambda leaf, at=at, x=x: leaf.__setitem__(at, x)))
      for at, x in ((1, 2**52 + 1), (1, -(2**52) - 1), (2, 9999), (2, -1), (3, -1),
                    (3, 2**52 + 1))),
    Forgery("reading.listed: malformed: {what}: not {least} to {most} entries", "quintic-spline",
            {"proof.windows": [[0] * 7]}),
    Forgery(_BOUND + f"Centre.__init__: {WIDE}", "quintic-spline",
            {"proof.low": ["0", "0", "0"], "proof.tree": [[".", 1, 0, 1]]}),
    Forgery(_BOUND + f"Centre.__init__: {WIDE} (2)", "quintic-spline",
            {"proof.tree": [[".", 1, 0, 1]]}),
    Forgery(_BOXES + "end: a leaf misses a weight", "quintic-spline",
            _first_leaf(lambda leaf: leaf.append(0))),
    Forgery(_BOXES + "end: a leaf has too many rows", "quintic-spline",
            _first_leaf(lambda leaf: leaf.extend([0, 1] * 64))),
    # Two way-points so near in time that the equations hang on one digit.
    Forgery(_BOXES + "end: a leaf with limits is not proved", "quintic-spline",
            _narrow("1", "1/1048576", "1", total="2.00000095367431640625", leaf=[".", 1, 0, 1])),
    Forgery(_BOUND + "Centre._parts: the matrix of a leaf is not positive definite",
            "quintic-spline", {}, {"quintic_bound.STIFFNESS": -quintic_bound.STIFFNESS}),
    Forgery(_BOXES + "end: a leaf with limits is not proved", "quintic-spline",
            _narrow("1", "1/1024", total="2055/2048", leaf=[".", 1, 0, 1])),
]  # fmt: skip
