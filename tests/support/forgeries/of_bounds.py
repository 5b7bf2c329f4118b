"""Forgeries of lower bounds: of closed forms, any curve and cubic splines."""

from __future__ import annotations

from support.forgeries.forgery import (
    B_SPLINE_AT_RATIOS,
    NO_ANSWER,
    WHOLE,
    Document,
    Forgery,
    beyond,
    document,
    spline,
)

ONE_LEAF = "a proof in closed form has one leaf"
CUTS = ([0, ["."], ["."]], [["/", 0, "1"], ["."], ["."]])
MISSING = "a limit that is not there"
APART = "closed_form.EachAlone.pieces: declaration not covered: no curve whose segments stand alone"
_RATIOS = "closed_form.FixedRatios."
BEND_FREE = {"problem.limits.0": ["1.6", None, None]}
"""Without a limit of joint 1's acceleration."""

_LEAF, _AT = "closed_form.EachAlone.leaf: ", "closed_form.ClosedForm.at: "
CLOSED = [
    *(Forgery(f"closed_form.ClosedForm.cut: {ONE_LEAF}", "by hand", {"proof.tree": cut})
      for cut in CUTS),
    Forgery(_LEAF + "segment {k + 1}: a negative duration",
            "by hand", {"proof.tree.0.1.3": "-1"}),
    Forgery(_LEAF + "segment {k + 1}: above its lower bound",
            "by hand", {"proof.tree.0.1": [-1, 0, 0, "0.1"]}),
    Forgery(_LEAF + "segment {k + 1}: above its lower bound",
            "stretched", {"proof.tree.0.2.3": "4.0001"}),
    Forgery(_AT + MISSING, "by hand", {"proof.tree.0.1.1": 2}),
    # Only the other side is limited: the first segment goes up, the second down.
    Forgery(_AT + MISSING, "by hand", {**NO_ANSWER, "problem.limits.0.0": ["-1", None]}),
    Forgery(_AT + MISSING, "by hand", {**NO_ANSWER, "problem.limits.0.0": [None, "1"]}),
    Forgery(_AT + MISSING + " (2)", "by hand", {**NO_ANSWER, "problem.limits.0.0": "0"}),
    *(Forgery(_LEAF + "segment {k + 1}: its least duration is not proved", base, changes)
      for base, changes in (
          ("by hand", {"proof.tree.0.1.3": "1.8750001"}),
          ("by hand", {"proof.tree.0.1.2": 2**19 + 1}),
          ("by hand", {**NO_ANSWER, "problem.limits.0.0": ["-1", "1.0001"]}),
          ("by hand", {**NO_ANSWER, "problem.limits.0.0": ["-1.0001", "1"]}),
          ("by hand", {**NO_ANSWER, "problem.waypoints.0.0": "0.5001"}),
          ("rest-to-rest", {"proof.tree.0.1.3": "1.67358237520544"}),
          ("stretched", {"proof.tree.0.1.3": "1.571935794763"}),
          ("stretched", {"proof.tree.0.3.3": "1.6014781118883"}))),
    Forgery(_LEAF + "the total is not proved", "by hand", {"proof.tree.0.1.3": "1.8749999"}),
    Forgery(_LEAF + "the total is not proved", "stretched", {"proof.total": "7.17341390665123"}),
    Forgery(APART, "stretched", {**NO_ANSWER, "problem.curve": "another"}),
    *(Forgery(APART, "by hand", changes) for changes in (
        {"problem.continuity": [3]},
        {"problem.prescribed.1": [[2, "0"]], "problem.continuity": [1]},
        {"problem.prescribed.1": [[1, "0.1"]]}, {"problem.prescribed.0": [[1, "-0.1"]]},
        {"problem.virtual": [1], "problem.waypoints": [["0"], ["1"]]})),
    # What determines no curve in a segment alone.
    *(Forgery("curve.pieces: the conditions do not determine the curve", "by hand", changes)
      for changes in (
          {"problem.degrees": [5, 3]}, {"problem.degrees": [4, 4]},
          {"problem.prescribed.1": [[1, "0"]]}, {"problem.prescribed.1": []})),
    Forgery(f"closed_form.ClosedForm.cut: {ONE_LEAF}", "fixed-ratios", {"proof.tree": CUTS[0]}),
    Forgery(_RATIOS + "__init__: the problem fixes no ratios that are rational numbers",
            "fixed-ratios", {**NO_ANSWER, "problem.ratios": "chord"}),
    *(Forgery(_RATIOS + "pieces: declaration not covered: no curve that may be stretched in time",
              "fixed-ratios",
              {f"problem.prescribed.{end}": [[1, ["0", "0.1"]], [2, "0"]]}) for end in (0, 3)),
    Forgery(_RATIOS + "leaf: the total is not proved", "stretched",
            {**B_SPLINE_AT_RATIOS, "proof.total": "5.12472996"}),
    Forgery(_RATIOS + "leaf: above its lower bound",
            "fixed-ratios", {"proof.tree": [[".", -1, 0, 0, 0]]}),
    Forgery(_AT + MISSING,
            "fixed-ratios", {"proof.tree": [[".", 0, 3, 1, 562965]]}),
    Forgery(_AT + MISSING + " (2)",
            "fixed-ratios", {**NO_ANSWER, "problem.limits.0.0": "0"}),
    *(Forgery(_RATIOS + "leaf: the total is not proved", "fixed-ratios", changes)
      for changes in (
          {"proof.total": "6.417801888546"}, {"proof.tree": [[".", 0, 1, 1, 560000]]},
          {"proof.tree": [[".", 1, 3, 1, 2]]}, {"proof.tree": [[".", 0, 2, 2, 0]]},
          {**NO_ANSWER, "problem.limits.0.0": "1.0001"})),
]  # fmt: skip

_MOTION = "any_curve.check_motion: "
_JOINT = "answer: joint {j + 1}"
_SEGMENT = "{named} {k + 1}"
_NONE = "any_curve.AnyCurve.least_total: _NO_LIMI"
PROVES = "any_curve.AnyCurve.leaf: it proves only {float(proved):.12g} s"
CAP = "any_curve.AnyCurve.__init__: the total exceeds the cap below which the boxes lie"


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


ANY = [
    Forgery("any_curve.AnyCurve.row: a row of an unknown kind", "any-curve",
            {"proof.rows.0.0": "magic"}),
    *beyond("any-curve", {
        "proof.rows.0.1": (0, 1), "proof.rows.0.2": (0, 1), "proof.rows.0.4": (-(10**18), 10**18),
        "proof.rows.0.5": (-(10**18), 10**18), "proof.rows.0.6": (0, 10**18),
        "proof.tree.1.1": (0, 4), "proof.tree.0.1": (0, 1)}),
    Forgery("any_curve._Row.terms: a row looks the wrong way", "any-curve", {"proof.rows.1.3": -1}),
    Forgery("any_curve._Row.terms: a row looks the wrong way", "any-curve", {"proof.rows.0.3": -1}),
    Forgery("any_curve._Row.terms: a row leans on a least duration that is 0", "any-curve",
            {**NO_ANSWER, "problem.duration_lower.0": "0", "problem.limits.0.0": None,
             "problem.limits.1.0": None}),
    *(Forgery(CAP, "any-curve", {"proof.total": total, "claim.lower": lower})
      for total, lower in (("9", "3"), ("3.072003475524055", "3"), ("0", "0"))),
    Forgery("any_curve.AnyCurve.root: a joint that moves has the velocity limit 0", "any-curve",
            {**NO_ANSWER, "problem.limits.0.0": "0"}),
    *(Forgery("any_curve.AnyCurve.cut: a cut lies outside its box", "any-curve",
              {"proof.tree.0": ["/", 0, place]}) for place in ("99", "0", "2/3", "2")),
    Forgery("any_curve.AnyCurve.leaf: malformed: weights come in pairs", "any-curve",
            {"proof.tree.1": [".", 0]}),
    Forgery("any_curve.AnyCurve.leaf: a weight is negative", "any-curve",
            {"proof.tree.1": [".", 0, "-1"]}),
    *(Forgery(PROVES, "any-curve", changes) for changes in (
        {"proof.tree.1": ["."]}, {"proof.tree": [["."]]}, {"proof.total": "3.0720034755"},
        {"proof.tree.1.2": "150"}, {"proof.tree.8.4": "0.5"},
        {**NO_ANSWER, "problem.limits.0.1": "2.001"}, {**NO_ANSWER, "problem.limits.0.1":
                                                       ["-2", "2.001"]},
        {**NO_ANSWER, "problem.prescribed.0": [[1, "-0.001"]]}, {"proof.rows.0.4": 4974249087},
        {**NO_ANSWER, "problem.duration_upper.1": "1.88", "proof.cap": "3.1"})),
    Forgery(_NONE, "any-curve", {**NO_ANSWER, "problem.limits.0": [None, None, None]}),
    Forgery(_NONE, "any-curve", {**NO_ANSWER, "problem.limits.0.0": None,
                                 "problem.prescribed": [[], [], []]}),
    Forgery(f"{_NONE} (2)", "any-curve", {**NO_ANSWER, "problem.limits.0.1": None}),
    Forgery("any_curve.AnyCurve.least_total: a row leans on a limit of 0", "any-curve",
            {**NO_ANSWER, "problem.limits.0.1": "0"}),
    Forgery(_MOTION + "answer: lower and upper limits differ, which no answer of any curve keeps",
            "any-curve", {"problem.limits.0.0": ["-3", "2.9"]}),
    Forgery(_MOTION + _JOINT + " is outside its position limits", "any-curve", _still),
    Forgery(_MOTION + _JOINT + " is outside its position limits", "any-curve", _still_below),
    Forgery(_MOTION + "answer: jerk is limited", "any-curve", {"problem.limits.0.2": "4"}),
    Forgery(_MOTION + "answer: position is limited", "any-curve",
            {"problem.position_upper.0": "9"}),
    Forgery(_MOTION + "answer: position is limited", "any-curve",
            {"problem.position_lower.1": "-9"}),
    Forgery(_MOTION + _SEGMENT + " is too fast", "any-curve",
            {"problem.limits.0": ["1.4", None, None]}),
    # The mean speed is the limit, which no motion that speeds up from rest keeps.
    Forgery(_MOTION + _SEGMENT + " is too fast", "any-curve",
            {"problem.limits.0": ["22/15", None, None], "claim.durations.1": "1.875",
             "claim.upper": "3.1"}),
    *(Forgery(_MOTION + "answer: ends", "any-curve",
              {**BEND_FREE, f"problem.prescribed.{end}": [[1, [speed, "0"]]]})
      for end, speed in ((0, "1.7"), (0, "-1.7"), (2, "-1.7"), (2, "1.7"))),
    Forgery(_MOTION + _JOINT + " moves with the acceleration limit 0", "any-curve",
            {"problem.limits.0.1": "0"}),
    Forgery(_MOTION + "answer: no speeds at the way-points", "any-curve", {"claim.speeds": None}),
    *(Forgery(_MOTION + "answer: speed at an end", "any-curve", {path: "0.0001"})
      for path in ("claim.speeds.0.0", "claim.speeds.2.0", "claim.speeds.0.1", "claim.speeds.2.1")),
    *(Forgery(_MOTION + "answer: velocity at a way-point", "any-curve",
              {f"claim.speeds.1.{joint}": speed})
      for joint, speed in ((0, "3.0001"), (0, "-3.0001"), (1, "1.51"), (1, "-1.51"))),
    # With steep ramps it would hold: a velocity beyond the limit, on either side.
    *(Forgery(_MOTION + "answer: velocity at a way-point", "any-curve",
              {"problem.limits.0": ["1.6", "1e9", None], "claim.speeds.1.0": speed})
      for speed in ("-1.7", "1.7")),
    *(Forgery(_MOTION + _SEGMENT + " exceeds the acceleration", "any-curve", {path: speed})
      for path, speed in (("claim.speeds.1.0", "2.4"), ("claim.speeds.1.0", "-2.4"))),
    *(Forgery(_MOTION + _SEGMENT + " is out of reach", "any-curve", changes) for changes in (
        {"claim.speeds.1.0": "0"}, {"claim.speeds.1.0": "2.35"}, {"claim.speeds.1.0": "-0.1"},
        {"problem.waypoints.1.0": "0.2499"}, {"problem.waypoints.2.0": "3.0001"},
        {"problem.limits.1.1": "2"}, {"problem.limits.1.0": "0.9"},
        {"problem.limits.0.0": "1.7"})),
]  # fmt: skip

_KIND, _SYSTEM, _WEIGHTS = "cubic/kind.CubicSpline.", "cubic/system.", "cubic/weights."
_ENDS = f"{_SYSTEM}kind_of_ends: "
NOT_A_SIDE = f"{_KIND}step: a side is not proved"


def _other_curve(data: Document) -> None:
    data["proof"] = document("cubic")["proof"] | {"total": data["proof"]["total"]}


CUBICS = [
    Forgery(_KIND + "__init__: the total exceeds the cap below which the boxes lie",
            "cubic", {"proof.total": "5.353312492370605468751"}),
    Forgery(_KIND + "step: a floor is not proved", "cubic",
            {"proof.tree.12.1": 179627360 + 200000}),
    Forgery(_KIND + "step: a floor is not proved", "cubic",
            {"proof.tree.12": ["f", 179627360, 204814, [], [], ""]}),
    *(Forgery(NOT_A_SIDE, "cubic", {f"proof.tree.{node}.3": side})
      for node, side in ((1, 49478768 + 4000), (2, 59426594 - 4000), (4, 53512038 + 4000),
                         (8, 55874626 - 4000), (10, 56657315 + 4000))),
    Forgery(NOT_A_SIDE, "cubic", {"proof.tree.1.2": -1}),
    Forgery(NOT_A_SIDE, "cubic-virtual", {"proof.tree.1.3": 34388758 + 400000}),
    Forgery(NOT_A_SIDE, "cubic-virtual", {"proof.tree.2.3": 79930990 - 400000}),
    Forgery(NOT_A_SIDE, "cubic-virtual", {"proof.tree.5.3": 65867488 - 400000}),
    Forgery(_KIND + "leaf: the box is not proved to be empty", "cubic",
            {"proof.tree": [[".", [], [], ""]]}),
    Forgery(_KIND + "leaf: the floor of a box is below the total", "cubic",
            {"proof.tree": [["."]]}),
    Forgery(_SYSTEM + "Cubic.__init__: the curve is no declared piecewise polynomial",
            "stretched", _other_curve),
    Forgery(_SYSTEM + "Cubic.__init__: more than {MOST_CUBIC_SEGMENTS} segments",
            "cubic", spline(65)),
    *(Forgery(_SYSTEM + "Cubic.condition: a bound of a duration that is not there", kind,
              {"proof.rows.0": ["upper", -1, 0, 1, 0], "problem.duration_upper.0": None})
      for kind in ("cubic", "cubic-virtual")),
    Forgery(_SYSTEM + "Cubic.condition: a row of an unknown kind", "cubic",
            {"proof.rows.0": ["magic", 0, 0, 1, 0]}),
    *(Forgery(_SYSTEM + "Cubic.condition: a condition leans on a limit that is not there",
              "cubic", changes)
      for changes in ({"problem.limits.0.0": None}, {"problem.limits.0.0": ["-1", None]},
                      {"problem.limits.0.2": None, "proof.rows.0": ["jerk", 0, 0, 1, 0]},
                      {**NO_ANSWER, "problem.limits.0.0": "0"})),
    *(Forgery(_SYSTEM + "Cubic.root: root: a side is not proved", kind, {f"proof.root.{k}": side})
      for kind, k, side in (("cubic", 0, 25165825), ("cubic", 1, 50331649), ("cubic", 2, 29360129),
                            ("cubic-virtual", 0, 25165825), ("cubic-virtual", 3, 3355444),
                            ("cubic-virtual", 4, 6710887), ("cubic-virtual", 1, 50331649))),
    *beyond("cubic", {
        "proof.powers.0": (-60, 60), "proof.second": (-60, 60), "proof.cap": (1, 2**28),
        "proof.root.0": (0, 2**28), "proof.rows.1.1": (0, 1), "proof.rows.1.2": (0, 2),
        "proof.rows.1.4": (0, 64), "proof.tree.1.1": (0, 2), "proof.tree.1.3": (-(2**28), 2**28),
        "proof.tree.1.4": (1, 2**28), "proof.tree.12.1": (0, 2**28), "proof.tree.12.2": (1, 2**28),
        "proof.tree.1.5.0": (0, 2), "proof.tree.1.5.1": (0, 2**28), "proof.tree.1.6.0": (0, 15),
        "proof.tree.1.6.1": (-(2**28), 2**28)}),
    *(Forgery(WHOLE, "cubic", {"proof.rows.0": row}) for row in (
        ["upper", -1, 3, 1, 0], ["jerk", 0, 3, 1, 0], ["lower", -1, -1, 1, 0],
        ["jerk", 0, -1, 1, 0])),
    *(Forgery(WHOLE, "cubic", {"proof.tree": tree})
      for tree in ([3], [["/", 0, -1]], [["/", 0, 2**28 + 1]])),
    *(Forgery(_ENDS + "no C2 cubic spline", "cubic", {**NO_ANSWER, path: value})
      for path, value in (("problem.continuity", [2, 1]), ("problem.degrees", [3, 3, 4]))),
    *(Forgery(_ENDS + "conditions inside", "cubic", {**NO_ANSWER, path: value})
      for path, value in (("problem.prescribed.1", [[1, "0"]]),
                          ("problem.prescribed.0", [[1, "0.1"]]))),
    *(Forgery(_ENDS + "virtual way-points elsewhere", "cubic-virtual",
              {**NO_ANSWER, "problem.virtual": virtual}) for virtual in ([1, 3], [2, 4])),
    *(Forgery(_ENDS + "virtual way-points, but not at rest at the ends", "cubic-virtual",
              {**NO_ANSWER, f"problem.prescribed.{end}": [[1, "0"]]}) for end in (0, 5)),
    *(Forgery(_ENDS + "an end that is neither clamped nor natural", "cubic",
              {**NO_ANSWER, "problem.prescribed.0": entry})
      for entry in ([[1, "0"], [2, "0"]], [], [[3, "0"]])),
    *(Forgery(_WEIGHTS + "least: malformed: weights come in pairs", "cubic", {path: [0]})
      for path in ("proof.tree.1.5", "proof.tree.1.6")),
    Forgery(_WEIGHTS + "least: shares and products differ in number", "cubic",
            {"proof.tree.1.7": "0wf0"}),
    Forgery(_WEIGHTS + "least: malformed: a share of a product", "cubic",
            {"proof.tree.1.7": "0wf0x"}),
    Forgery(_WEIGHTS + "least: a product of an unknown without bounds", "cubic",
            lambda data: data["proof"]["tree"].pop(0)),
    Forgery(_WEIGHTS + "least: an unknown without bounds", "cubic",
            {"proof.tree": [["t", 0, 1, 1, 1, [], [0, 1], ""]]}),
    *(Forgery(_WEIGHTS + "_over: 1/T of a span that may vanish", "cubic",
              {"proof.root.0": 0, "proof.tree": [["r"], ["t", 0, 1, 1, 1, [], [3, w], "00"]]})
      for w in (1, -1)),
]  # fmt: skip
FORGERIES = [*CLOSED, *ANY, *CUBICS]
