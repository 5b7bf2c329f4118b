"""What is true is proved: certificates of every kind, values at their ranges, what is said."""

import json
from collections.abc import Callable, Iterable, Iterator
from fractions import Fraction
from pathlib import Path
from typing import Any

import pytest
from support.forgeries.forgery import (
    B_SPLINE_AT_RATIOS,
    KEPT,
    NO_ANSWER,
    Document,
    altered,
    document,
)
from support.forgeries.of_documents import here
from trajgap.verify import reading, tree, verify_certificate
from trajgap.verify.problem import PI

KINDS = sorted(path.stem for path in KEPT.glob("*.json"))
INFEASIBLE = {**NO_ANSWER, "claim.infeasible": True}


def backwards(work: Callable[..., Any], common: Any, parts: Iterable[Any]) -> Iterator[Any]:
    return reversed([work(common, *part) for part in reversed(list(parts))])


@pytest.mark.parametrize("kind", [*KINDS, "by hand"])
def test_each_kind_is_proved_whole_and_in_parts(kind: str) -> None:
    verdict = verify_certificate(document(kind))
    claim = document(kind)["claim"]
    assert verdict.proves, verdict
    assert not verdict.altered
    assert (verdict.lower, verdict.upper) == (Fraction(claim["lower"]), Fraction(claim["upper"]))
    for spread in (here, backwards):
        assert verify_certificate(document(kind), spread=spread) == verdict


def test_a_kind_whose_leaves_leave_traces_is_kept_back(monkeypatch: pytest.MonkeyPatch) -> None:
    def seen(work: Callable[..., Any], common: Any, parts: Iterable[Any]) -> Iterator[Any]:
        handed.extend(parts)
        return here(work, common, handed)

    handed: list[Any] = []
    monkeypatch.setattr(tree, "_PARTS", 1)
    # The one leaf of a closed form tells its kind whether a segment is late.
    assert verify_certificate(document("rest-to-rest"), spread=seen).proves
    assert handed == []
    assert verify_certificate(document("cubic-virtual"), spread=seen).proves
    assert handed != []


def stays(data: Document) -> None:
    """Joint 2 stays at 5, which is both of its position limits."""
    for row in data["problem"]["waypoints"]:
        row[1] = "5"
    for row in data["claim"]["speeds"]:
        row[1] = "0"
    data["problem"] |= {"position_lower": [None, "5"], "position_upper": [None, "5"]}


def ramps(data: Document) -> None:
    """Joint 1 without a limit of acceleration, both ends at the limit of velocity."""
    data["problem"]["limits"][0] = ["1.6", None, None]
    data["problem"]["prescribed"] = [[[1, ["1.6", "0"]]], [], [[1, ["-1.6", "0"]]]]
    data["claim"]["speeds"][0][0] = data["claim"]["speeds"][-1][0] = "0"
    unproved(data)


def unproved(data: Document) -> None:
    data |= {"format": "trajgap-state-2", "proposals": None, "proof": None}
    data["claim"]["lower"] = "0"


def shortest(data: Document) -> None:
    """The first duration is its lower bound."""
    data["problem"]["duration_lower"][0] = "1.197003475524181"
    unproved(data)


def by_hand_motion(speed: str, way: str, velocity: str | None, ends: str) -> Any:
    """One joint, 1 s from an end speed to another, with an acceleration of up to 2."""

    def change(data: Document) -> None:
        data["problem"] |= {
            "degrees": [3], "continuity": [], "prescribed": [[], []], "waypoints": [["0"], [way]],
            "limits": [[velocity, "2", None]], "duration_lower": ["0"], "duration_upper": [None],
        }  # fmt: skip
        data["claim"] |= {"subject": "any curve", "durations": ["1"], "upper": "1",
                          "speeds": [[speed], [ends]]}  # fmt: skip

    return change


def sized(joints: int, degree: int) -> Any:
    def change(data: Document) -> None:
        rest = [[order, "0"] for order in range(1, (degree + 1) // 2)]
        data["problem"] |= {
            "joints": [str(j) for j in range(joints)], "degrees": [degree] * 2,
            "prescribed": [rest] * 3, "waypoints": [["0"] * joints, ["1"] * joints, ["0"] * joints],
            "limits": [["1", None, None]] * joints, "position_lower": [None] * joints,
            "position_upper": [None] * joints, "duration_upper": [None, None],
        }  # fmt: skip
        data["claim"] |= {"durations": ["3", "3"], "upper": "6"}
        unproved(data)

    return change


INSIDE: list[tuple[str, Any]] = [
    *(("by hand", {"claim.lower": number}) for number in (
        "5.625e0", "56250e-4", "45/8", "-3", "0", "5." + "1" * 120, "0" * 119 + "5",
        "1e-99")),
    ("by hand", {"claim.upper": "1" * 120}), ("by hand", {"claim.upper": "1e99"}),
    ("by hand", {"problem.duration_lower": ["1.875", "3.75"],
                 "problem.duration_upper": ["1.875", "3.75"]}),
    ("by hand", {"problem.position_lower": ["-0.5"], "problem.position_upper": ["1.5"]}),
    ("by hand", {"problem.limits.0.0": ["-1", "1"]}),
    ("by hand", {"problem.limits.0.2": "9.11"}), ("by hand", {"problem.limits.0.1": "1.65"}),
    ("by hand", {"problem.unit": "r" * 10_000}), ("state", {"problem.continuity.0": 2}),
    ("by hand", {"proof.tree.0.1": [0, 1, 2**19 + 1, "1.8749"], "proof.total": "5.6249",
                 "claim.lower": "5"}),
    ("by hand", {"proof.tree.0.1": [-1, 1, 0, "1"], "problem.duration_lower.0": "1",
                 "proof.total": "4.75", "claim.lower": "4.75"}),
    ("by hand", {"proof.tree.0.1": [0, 3, 0, "1.8"], "problem.limits.0.2": "10.28",
                 "proof.total": "5.55", "claim.lower": "5"}),
    # Straight lines keep their speed where they do not turn.
    ("state", {"problem.degrees": [1, 1], "problem.prescribed": [[], [], []],
               "problem.waypoints": [["0"], ["1"], ["3"]], "claim.durations": ["1", "2"],
               "problem.limits.0": ["1", "1", "1"]}),
    # The acceleration may jump where the jerk has no limit.
    ("state", {"problem.degrees": [3, 3], "problem.prescribed": [[[1, "0"]]] * 3,
               "claim.durations": ["2", "3.25"], "problem.limits.0": ["1", "99", None]}),
    ("state", {"problem.ratios": ["0.5", "1"]}), ("state", {"proof": None}),
    ("state", sized(64, 9)), ("state", sized(1, 9)), ("state", sized(1, 7)),
    *(("state", {"problem.limits.0.0": {"value": value, "pi": power}}) for value, power in (
        ("1", 0), ("0.31830989", 1), ("3.1415927", -1))),
    # What the upper bounds do not allow, by the proof itself or by its total.
    ("by hand", {**INFEASIBLE, "problem.duration_upper": ["1.8749", None]}),
    ("by hand", {**INFEASIBLE, "problem.duration_upper": ["2", "3.6"], "claim.lower": "5.61"}),
    ("fixed-ratios", {**INFEASIBLE, "problem.duration_upper.0": "1.604"}),
    ("stretched", {**INFEASIBLE, "problem.duration_upper.0": "1.57"}),
    ("fixed-ratios", {**NO_ANSWER, "proof.tree": [[".", -1, 0, 1, 0]],
                      "problem.duration_lower.1": "2.81"}),
    ("fixed-ratios", {"proof.tree": [[".", 1, 3, 1, 0]], "proof.total": "1", "claim.lower": "1"}),
    ("stretched", {**B_SPLINE_AT_RATIOS, "proof.total": "5.12472995"}),
    ("any-curve", stays), ("any-curve", ramps),
    ("any-curve", lambda data: data["proof"]["tree"][1].extend([2, "0"])),
    ("any-curve", {"problem.duration_upper.1": "1.874999999999873"}),
    ("any-curve", shortest),
    # 1 s at full acceleration; there and back; at the limit of velocity all along.
    *(("state", by_hand_motion(*given)) for given in (
        ("0", "1", None, "2"), ("0", "0.5", None, "0"), ("0", "-0.5", None, "0"),
        ("1", "0", None, "-1"),
        ("1", "1", "1", "1"), ("-1", "-1", "1", "-1"), ("1", "0.5", None, "1"))),
    # Zeros for each joint are the same zeros.
    *((kind, {"problem.prescribed.0.0": [1, ["0", "0"]]}) for kind in (
        "cubic", "quintic-spline", "declared", "fixed-ratios", "any-curve")),
    ("cubic", {"proof.rows.0.1": 0}), ("cubic", {"proof.rows.0.4": 64}),
    ("declared", {"proof.tree.0": ["/", 2, None]}),
    ("declared-free", {"proof.tree.0": ["/", 2, None]}),
]  # fmt: skip


@pytest.mark.parametrize("row", range(len(INSIDE)))
def test_what_is_just_inside_is_proved(row: int) -> None:
    base, changes = INSIDE[row]
    verdict = verify_certificate(altered(base, changes))
    assert verdict.proves, (base, verdict)
    assert not verdict.altered
    claim = altered(base, changes)["claim"]
    assert verdict.infeasible == claim["infeasible"]


@pytest.mark.parametrize(
    ("lower", "upper", "said"),
    [
        ("1/3", "17/3", "is at least 0.333333333333 s and at most 5.66666666667 s"),
        ("2/3", "100/3", "is at least 0.666666666666 s and at most 33.3333333334 s"),
        ("5", "5.625", "is at least 5 s and at most 5.625 s"),
    ],
)
def test_a_bound_is_rounded_to_its_safe_side(lower: str, upper: str, said: str) -> None:
    verdict = verify_certificate(altered("by hand", {"claim.lower": lower, "claim.upper": upper}))
    assert str(verdict) == f"proves: the least total of the declared curve {said}"


def test_words_of_a_verdict() -> None:
    infeasible = {**INFEASIBLE, "problem.duration_upper": ["1.8", None]}
    said = str(verify_certificate(altered("by hand", infeasible)))
    assert said == "proves: no durations within their bounds keep the limits: infeasible"
    said = str(verify_certificate(altered("by hand", NO_ANSWER)))
    assert said == "proves: the least total of the declared curve is at least 5.625 s"
    nothing = {f"question.{key}": None for key in ("case", "problem", "reading", "joint")}
    asked = verify_certificate(altered("by hand", nothing)).asked
    assert asked.startswith("a problem without a case; problem sha256 ")
    full = {"question.reading": "r", "question.joint": "2\u202e" + "j" * 99}
    asked = verify_certificate(altered("by hand", full)).asked
    assert asked.startswith(f"case a-case, problem first, reading r, joint 2\\u202e{'j' * 72}…; ")


@pytest.mark.parametrize("part", ["problem_hash", "seal"])
def test_a_wrong_hash_is_said(part: str) -> None:
    verdict = verify_certificate({**document("by hand"), part: "0"})
    assert verdict.proves
    assert verdict.altered
    assert str(verdict).startswith("altered, still proves: ")


def test_files_are_read_up_to_a_size(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "certificate.json"
    path.write_text(json.dumps(document("by hand")))
    monkeypatch.setattr(reading, "MOST_BYTES", path.stat().st_size)
    assert str(verify_certificate(path)).startswith("proves: ")


def test_pi_lies_between_its_bounds() -> None:
    # Machin: π/4 = 4 atan(1/5) − atan(1/239), by partial sums that alternate around it.
    def atan(x: int, terms: int) -> Fraction:
        return sum(
            (Fraction((-1) ** k, (2 * k + 1) * x ** (2 * k + 1)) for k in range(terms)), Fraction(0)
        )

    low = 4 * (4 * atan(5, 40) - atan(239, 41))
    high = 4 * (4 * atan(5, 41) - atan(239, 40))
    assert low < high
    assert PI[0] < low
    assert high < PI[1]
    assert PI[1] - PI[0] == Fraction(1, 10**50)
