"""Forgeries that no list of values states: of a tree's nodes, of long splines, of the walk."""

from collections.abc import Callable, Iterable, Iterator
from itertools import islice
from typing import Any

from support.forgeries.forgery import Document, Forgery, document, spline
from trajgap.verify import quintic_bound

WHOLE = "reading.whole: malformed: no integer in {low}..{high}: {shown(repr(value))}"
OPEN = "tree._walked: the tree leaves a part open"
DEEP = "tree._walked: the tree is too deep"
MANY = "tree._walked: the tree has too many nodes"
NOT_JUDGED = "tree.walk: a part of the tree was not judged"
OUTSIDE = "any_curve.check_motion: answer: joint {j + 1} is outside its position limits"
NOT_PROVED = "boxes.Boxes.end: a leaf with limits is not proved"
QUINTIC = "quintic.QuinticSpline.read: "
NOT_QUINTIC = f"{QUINTIC}declaration not covered: no C4 quintic spline at rest at the ends"
DECLARED = "declared.DeclaredCurve.read: "


def _no_numpy(*_: Any) -> Any:
    raise ImportError("No module named 'numpy'")


def _none(*_: Any) -> Iterator[Any]:
    """No part is even asked for."""
    return iter(())


def _first(
    work: Callable[..., Any], common: Any, parts: Iterable[tuple[Any, ...]]
) -> Iterator[Any]:
    """The others are not asked for."""
    return (work(common, *part) for part in islice(parts, 1))


def _lost(work: Callable[..., Any], common: Any, parts: Iterable[tuple[Any, ...]]) -> Iterator[Any]:
    """The result of the last part does not come back."""
    return iter([work(common, *part) for part in parts][:-1])


def here(work: Callable[..., Any], common: Any, parts: Iterable[tuple[Any, ...]]) -> Iterator[Any]:
    return (work(common, *part) for part in parts)


def _deep(data: Document) -> None:
    """1500 cuts, one below the other; all but one of the parts are empty."""
    data["proof"]["tree"] = [*[["/", 0, 1]] * 1500, *[["."]] * 1501]
    data["claim"] |= {"durations": None, "upper": None}


def _still(data: Document) -> None:
    """Joint 2 stays at 5, outside its limits."""
    for row in data["problem"]["waypoints"]:
        row[1] = "5"
    for row in data["claim"]["speeds"]:
        row[1] = "0"
    data["problem"]["position_upper"][1] = "4.9999"


def _still_below(data: Document) -> None:
    _still(data)
    data["problem"]["position_upper"][1] = None
    data["problem"]["position_lower"][1] = "5.0001"


def _other_curve(data: Document) -> None:
    data["proof"] = document("cubic")["proof"] | {"total": data["proof"]["total"]}


def _leaf(change: Callable[[list[Any]], Any], least: int = 0) -> Callable[[Document], None]:
    """A change of the first leaf with weights whose τ is at least so large, without an answer."""

    def altered(data: Document) -> None:
        leaves = (node for node in data["proof"]["tree"] if type(node) is list and len(node) > 2)
        change(next(leaf for leaf in leaves if abs(leaf[1]) >= least))
        data["claim"] |= {"durations": None, "upper": None}

    return altered


def _turned(leaf: list[Any]) -> None:
    leaf[1] = -leaf[1]


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


FORGERIES = [
    Forgery("verdict.proof_kind: this kind of proof needs numpy ({error}); install numpy",
            "quintic-spline", {}, {"verdict.import_module": _no_numpy}),
    # Whatever lets a wrong proof pass, an answer below it shows that one of the two is wrong.
    Forgery("verdict._judged: the proof contradicts the answer: one of them is wrong",
            "by hand", {"proof.total": "5.6250001"}, {"verdict.walk": lambda *_: None}),
    Forgery(MANY, "by hand", lambda data: data["proof"]["tree"].append(["."])),
    Forgery(MANY, "declared", lambda data: data["proof"]["tree"].append([".", 0, 0, 1])),
    *(Forgery(OPEN, kind, lambda data: data["proof"]["tree"].pop())
      for kind in ("declared", "any-curve", "cubic")),
    Forgery(DEEP, "cubic", _deep),
    Forgery(DEEP, "cubic", _deep, spread=here),
    Forgery("tree.walk: why or ", "cubic-virtual", {"proof.tree.-1": ["?"]}, spread=here),
    # Both trees are one part, the cubic one below a chain of steps.
    *(Forgery(NOT_JUDGED, kind, {}, spread=spread)
      for kind in ("cubic-virtual", "quintic-spline") for spread in (_none, _lost)),
    Forgery(NOT_JUDGED, "quintic-spline", {}, {"boxes.Boxes.apart": 8}, spread=_first),
    Forgery(OUTSIDE, "any-curve", _still),
    Forgery(OUTSIDE, "any-curve", _still_below),
    Forgery("cubic/system.Cubic.__init__: the curve is not a declared piecewise polynomial",
            "stretched", _other_curve),
    Forgery("cubic/system.Cubic.__init__: more than {MOST_CUBIC_SEGMENTS} segments",
            "cubic", spline(65)),
    Forgery("cubic/weights.least: a product of an unknown without bounds", "cubic",
            lambda data: data["proof"]["tree"].pop(0)),
    Forgery(NOT_QUINTIC, "stretched", lambda data: data.update(
        proof={"kind": "quintic-spline", "total": data["proof"]["total"], "tree": [["."]],
               "powers": [0, 0], "second": 0, "low": ["0"] * 3, "windows": [], "rows": []})),
    Forgery(NOT_QUINTIC, "quintic-spline", spline(1, 5)),
    Forgery(QUINTIC + "more than {longest} segments",
            "quintic-spline", spline(27, 5)),
    Forgery(QUINTIC + "more than {most} joints",
            "quintic-spline", spline(3, 5, 13)),
    *(Forgery(WHOLE, "quintic-spline",
              _leaf(lambda leaf, at=at, x=x: leaf.__setitem__(at, x)))
      for at, x in ((1, 2**52 + 1), (1, -(2**52) - 1), (2, 9999), (2, -1), (3, -1),
                    (3, 2**52 + 1))),
    Forgery("reading.weights: malformed: weights come in pairs", "quintic-spline",
            _leaf(lambda leaf: leaf.append(0))),
    Forgery("reading.listed: malformed: {what}: not {least} to {most} entries", "quintic-spline",
            _leaf(lambda leaf: leaf.extend([0, 1] * 64))),
    # Two way-points so near in time that the equations hang on one digit.
    Forgery(NOT_PROVED, "quintic-spline",
            _narrow("1", "1/1048576", "1", total="2.00000095367431640625", leaf=[".", 1, 0, 1])),
    Forgery(NOT_PROVED, "quintic-spline",
            _narrow("1", "1/1024", total="2055/2048", leaf=[".", 1, 0, 1])),
    Forgery("quintic_bound.Centre._parts: the matrix of a leaf is not positive definite",
            "quintic-spline", {}, {"quintic_bound.STIFFNESS": -quintic_bound.STIFFNESS}),
    Forgery("declared.DeclaredCurve._task: the curve has too many unknowns",
            "declared", spline(12, 9)),
    Forgery(DECLARED + "one segment alone has no inner break", "declared", spline(1)),
    Forgery(DECLARED + "more than {most} segments",
            "declared", spline(13)),
    Forgery(DECLARED + "declaration not covered: no declared piecewise polynomial",
            "stretched", lambda data: data.update(
                proof={"kind": "declared", "total": data["proof"]["total"],
                       "rows": [], "tree": [["."]]})),
    Forgery(NOT_PROVED, "declared-free", _leaf(_turned, 600_000 // 1024)),
    Forgery(NOT_PROVED, "declared-free",
            _leaf(lambda leaf: leaf.__setitem__(slice(2, None), [2, 1]))),
    Forgery(NOT_PROVED, "declared", lambda data: data["proof"].update(
        tree=[0, *data["proof"]["tree"], [".", 0, 0, 1]])),
]  # fmt: skip
