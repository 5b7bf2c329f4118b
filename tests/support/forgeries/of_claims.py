"""Forgeries of the claim, of the answer and of the walk through the tree."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from itertools import islice
from typing import Any

from support.forgeries.forgery import NO_ANSWER, Document, Forgery

BOUNDS = "answer.check_durations: answer: duration {k} is outside its bounds"
JUMPS = "answer.check_answer: answer: the {what} jumps"
EXCEEDS = (
    "answer._keeps: answer: joint {joint + 1}, segment {segment + 1}, derivative {order} exceeds "
    "its limit"
)
EXCEEDS_TOTAL = "verdict._judged: the lower bound exceeds the total that is proved"
INFEASIBLE = (
    "verdict._judged: infeasible only above the sum of all upper bounds, or by a proof of its own"
)
RATIOS = (
    "verdict._read_proof: at fixed ratios of the durations the kind of proof is {_OF_RATIOS}, "
    "and only there"
)
DEEP = "tree._walked: the tree is too deep"
OPEN = "tree._walked: the tree leaves a part open"
MANY = "tree._walked: the tree has too many nodes"

CALLED_INFEASIBLE = {**NO_ANSWER, "claim.infeasible": True}
NO_CONDITIONS = {
    "problem.degrees": [1, 1],
    "problem.prescribed": [[], [], []],
    "claim.durations": ["1", "2"],
}
"""Straight lines from 0.5 to 1.5 to −0.5, in each of which the speed is 1."""
ARCS = {
    "problem.degrees": [3, 3],
    "problem.prescribed": [[[1, "0"]]] * 3,
    "claim.durations": ["2", "3.25"],
}
"""Cubics from rest to rest, whose acceleration jumps."""


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


ANSWERS = [
    Forgery("answer.check_durations: answer: one duration per segment",
            "by hand", {"claim.durations": ["1.875"]}),
    Forgery("answer.check_durations: answer: one duration per segment",
            "by hand", {"claim.durations": ["1.875", "1.875", "1.875"]}),
    Forgery(BOUNDS, "by hand", {"claim.durations": ["1.6", "4.025"]}),
    Forgery(BOUNDS, "by hand", {"problem.duration_upper.1": "3.7499999"}),
    Forgery(BOUNDS, "by hand", {"problem.duration_lower.0": "1.8750001"}),
    Forgery(BOUNDS, "by hand", {"claim.durations": ["0", "3.75"]}),
    Forgery(BOUNDS, "by hand", {"claim.durations": ["-1.875", "3.75"]}),
    # Of every kind, one duration that is a little longer or shorter than its bound.
    *(Forgery(BOUNDS, kind, {f"problem.duration_{side}.{k}": bound})
      for kind, k in (("declared", 1), ("declared-free", 1), ("cubic", 1),
                      ("cubic-virtual", 2), ("quintic-spline", 1), ("rest-to-rest", 1),
                      ("stretched", 1), ("fixed-ratios", 1), ("any-curve", 1))
      for side, bound in (("upper", "1.8"), ("lower", "5.75"))),
    Forgery("answer.check_answer: answer: no durations are exactly in the ratios of chord lengths",
            "state", {"problem.ratios": "chord"}),
    Forgery("answer.check_answer: answer: the durations have other ratios",
            "fixed-ratios", {"claim.durations.0": "1.60445"}),
    Forgery("answer.check_answer: answer: the durations have other ratios",
            "state", {"problem.ratios": ["1", "2.1"]}),
    # The velocity never jumps; the acceleration does not where the jerk is limited.
    *(Forgery(JUMPS, "state", {**NO_CONDITIONS, "problem.limits.0": limits})
      for limits in ([None, None, "1"], [None, "1", None], ["2", None, None], [None] * 3,
                     [None, None, ["-1", None]], [None, None, [None, "1"]])),
    *(Forgery(JUMPS, "state", {**ARCS, "problem.limits.0": [None, None, jerk]})
      for jerk in ("99", ["-99", None], [None, "99"])),
    Forgery(JUMPS, "state", {**ARCS, "problem.limits.0": ["9", "99", "99"]}),
    Forgery(EXCEEDS, "by hand", {"claim.durations": ["1.8749", "3.75"]}),
    Forgery(EXCEEDS, "by hand", {"problem.limits.0.0": ["-0.999", "1"]}),
    Forgery(EXCEEDS, "by hand", {"problem.limits.0.0": [None, "0.999"]}),
    Forgery(EXCEEDS, "by hand", {"problem.limits.0.1": "1.64"}),
    Forgery(EXCEEDS, "by hand", {"problem.limits.0.2": "9.09"}),
    Forgery(EXCEEDS, "by hand", {"problem.position_upper.0": "1.4999"}),
    Forgery(EXCEEDS, "by hand", {"problem.position_lower.0": "-0.4999"}),
    Forgery(EXCEEDS, "stretched", {"problem.limits.0.1": ["-1.99", "2"]}),
    Forgery(EXCEEDS, "stretched", {"problem.position_lower.0": "-0.37"}),
    Forgery("curve.pieces: the curve is no declared piecewise polynomial",
            "stretched", {"problem.curve": "another"} | {"proof": None} |
            {"format": "trajgap-state-2", "proposals": None, "claim.lower": "0"}),
    Forgery("curve.pieces: the conditions do not determine the curve",
            "state", {"problem.prescribed.1": []}),
    Forgery("curve.pieces: the conditions do not determine the curve",
            "state", {"problem.prescribed.1": [[1, "0"], [2, "0"], [3, "0"]]}),
    # The third derivative of a cubic is one number.
    Forgery("curve.pieces: the conditions do not determine the curve (2)",
            "state", {"problem.degrees": [3], "problem.continuity": [],
                      "problem.prescribed": [[[3, "0"]]] * 2,
                      "problem.waypoints": [["0"], ["1"]], "problem.duration_lower": ["0"],
                      "problem.duration_upper": [None], "claim.durations": ["2"]}),
]  # fmt: skip

CLAIMS = [
    Forgery("verdict.proof_kind: this kind of proof needs numpy ({error}); install numpy",
            "quintic-spline", {}, {"verdict.import_module": _no_numpy}),
    *(Forgery("verdict._judged: malformed: infeasible: neither true nor false",
              "by hand", {"claim.infeasible": value}) for value in (0, 1, None, "false")),
    *(Forgery("verdict._judged: malformed: subject: neither the declared curve nor any curve",
              "by hand", {"claim.subject": value}) for value in ("any", ["any curve"], None)),
    Forgery("verdict._judged: this kind of proof speaks about {kind.subject}",
            "by hand", {"claim.subject": "any curve"}),
    Forgery("verdict._judged: this kind of proof speaks about {kind.subject}",
            "any-curve", {**NO_ANSWER, "claim.subject": "the declared curve"}),
    Forgery(EXCEEDS_TOTAL, "by hand", {"claim.lower": "5.6250001"}),
    Forgery(EXCEEDS_TOTAL, "state", {"claim.lower": "0.001"}),
    *(Forgery(EXCEEDS_TOTAL, kind, {"claim.lower": lower})
      for kind, lower in (("declared", "14.4570305663"), ("declared-free", "6.0704720574"),
                          ("cubic", "5.3533124924"), ("quintic-spline", "6.1107397602"),
                          ("any-curve", "3.0719962632"))),
    # Above the sum of all upper bounds, but not proved.
    Forgery(EXCEEDS_TOTAL, "by hand", {**CALLED_INFEASIBLE, "claim.lower": "9",
                                       "problem.duration_upper": ["4", "4"]}),
    Forgery("verdict._judged: infeasible, but with an answer",
            "by hand", {"claim.infeasible": True}),
    Forgery("verdict._judged: the durations exceed the upper bound",
            "by hand", {"claim.upper": "5.6249999"}),
    Forgery("verdict._judged: the durations exceed the upper bound",
            "any-curve", {"claim.upper": "3.072003475524053"}),
    # Whatever lets a wrong proof pass, an answer below it shows that one of the two is wrong.
    Forgery("verdict._judged: the proof contradicts the answer: one of them is wrong",
            "by hand", {"proof.total": "5.6250001"}, {"verdict.walk": lambda *_: None}),
    Forgery(INFEASIBLE, "by hand", CALLED_INFEASIBLE),
    Forgery(INFEASIBLE, "by hand", {**CALLED_INFEASIBLE, "problem.duration_upper": ["1.875", None],
                                    "problem.limits.0.0": "0.9999"}),
    # At the sum of the upper bounds, but not above it.
    Forgery(INFEASIBLE, "by hand", {**CALLED_INFEASIBLE,
                                    "problem.duration_upper": ["1.875", "3.75"]}),
    Forgery(INFEASIBLE, "state", {**CALLED_INFEASIBLE, "problem.duration_upper": ["1", "1"]}),
    *(Forgery(INFEASIBLE, kind, CALLED_INFEASIBLE)
      for kind in ("declared", "declared-free", "cubic", "cubic-virtual", "quintic-spline",
                   "rest-to-rest", "stretched", "fixed-ratios", "any-curve")),
    Forgery("verdict._read_answer: an upper bound without durations",
            "by hand", {"claim.durations": None}),
    Forgery("verdict._read_answer: speeds without durations",
            "by hand", {**NO_ANSWER, "claim.speeds": [["0"]] * 3}),
    Forgery("verdict._read_answer: speeds belong to an answer of any curve",
            "by hand", {"claim.speeds": [["0"]] * 3}),
    Forgery("verdict._read_proof: malformed: proof is no object", "by hand", {"proof": None}),
    Forgery("verdict._read_proof: malformed: proof is no object", "state", {"proof": []}),
    *(Forgery("verdict._read_proof: unknown kind of proof {shown(repr(name))}",
              "by hand", {"proof.kind": name}) for name in ("none", ["cubic"], None)),
    Forgery(RATIOS, "by hand", {"problem.ratios": ["1", "2"]}),
    Forgery(RATIOS, "by hand", {**NO_ANSWER, "problem.ratios": "chord"}),
    Forgery(RATIOS, "by hand", {"proof.kind": "fixed-ratios"}),
    Forgery("verdict._read_proof: the total is negative",
            "by hand", {"proof.total": "-1", "claim.lower": "-1"}),
]  # fmt: skip

TREES = [
    Forgery("tree.ProofKind.step: the tree has an unknown tag {shown(repr(tag))}",
            "by hand", {"proof.tree": [["r"]]}),
    Forgery("tree.ProofKind.step: the tree has an unknown tag {shown(repr(tag))}",
            "cubic", {"proof.tree": [["x"]]}),
    *(Forgery("tree._below: malformed: node {count} of the tree",
              "by hand", {"proof.tree": [node]}) for node in ([], ".[", None, True)),
    Forgery("tree._below: leaf at node {count}: {error}",
            "by hand", {"proof.tree.0.1.3": "1.8750001"}),
    *(Forgery("tree._below: the tree leaves a part open: node {count}",
              kind, {"proof.tree": [["?"]]}) for kind in ("by hand", "any-curve", "cubic")),
    Forgery(MANY, "by hand", lambda data: data["proof"]["tree"].append(["."])),
    Forgery(MANY, "declared", lambda data: data["proof"]["tree"].append([".", 0, 0, 1])),
    Forgery(OPEN, "declared", lambda data: data["proof"]["tree"].pop()),
    Forgery(OPEN, "any-curve", lambda data: data["proof"]["tree"].pop()),
    Forgery(OPEN, "cubic", lambda data: data["proof"]["tree"].pop()),
    Forgery(DEEP, "cubic", _deep),
    Forgery("tree._walked: the tree is too deep", "cubic", _deep, spread=here),
    Forgery("tree.walk: why or ", "cubic-virtual",
            {"proof.tree.-1": ["?"]}, spread=here),
    # Both trees are one part, the cubic one below a chain of steps.
    *(Forgery("tree.walk: a part of the tree was not judged", kind, {}, spread=spread)
      for kind in ("cubic-virtual", "quintic-spline") for spread in (_none, _lost)),
    Forgery("tree.walk: a part of the tree was not judged", "quintic-spline", {},
            {"boxes.Boxes.apart": 8}, spread=_first),
]  # fmt: skip
FORGERIES = [*ANSWERS, *CLAIMS, *TREES]
