"""Attacks on proofs: certificates and states altered, grafted, forged, with right hashes."""

from __future__ import annotations

import copy
import hashlib
import json
from collections.abc import Callable
from fractions import Fraction
from functools import cache, lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from attacks.attack import Attack, demand, keep
from attacks.cases import Rng, alone, draw_asked
from attacks.curves import Asked, NoCurve, excess
from attacks.mutations import places
from attacks.reading import well_ended
from attacks.sandbox import Ended, call, command
from attacks.stated import asked_in, claimed, least_any, least_declared

KINDS: dict[str, tuple[str, dict[str, Any], float]] = {
    "rest-to-rest": ("rest-to-rest", {}, 1e-6),
    "three-piece": ("3-5-3", {}, 0.05),
    "four-three-four": ("polynomials", {"degrees": [4, 3, 4]}, 0.05),
    "stretched": ("uniform-cubic-b-spline", {"time": "stretched"}, 1e-6),
    "cubic": ("cubic-spline", {}, 0.1),
    "cubic, virtual": ("cubic-spline-virtual", {}, 0.2),
    "quintic-spline": ("quintic-spline", {}, 0.2),
    "any-curve": ("cubic-spline", {}, 0.1),
}
"""Family, what its declaration must say, and the gap to prove, by kind of proof."""
_EACH = 3
"""Different certificates of each kind that are altered."""
_MAKE_SECONDS = 20.0
"""For making one of them."""
_BUDGETS = (0.3, 2.0, 8.0)
"""Time limits that the verifier is given, s."""
_SLACK = 1.5
"""Seconds that it may take beyond them: reading a file of the largest size."""
_MARGIN = 1e-9
"""Relative excess of a bound over a feasible total that counts as rounding of the samples."""


def _certified(kind: str, number: int, seconds: float) -> list[dict[str, Any]]:
    """The certificate of a drawn problem, and the state of a run cut short; in a child."""
    family, wanted, gap = KINDS[kind]
    asked = _drawn(family, wanted, number)

    def make() -> list[dict[str, Any]]:
        from trajgap.nlp import certificate, certify
        from trajgap.nlp.proofs import state_document
        from trajgap.problem import parse_case
        from trajgap.verify import Subject

        problem = parse_case(alone(asked).text, "case.toml").problem()
        subject = Subject.ANY if kind == "any-curve" else Subject.DECLARED
        made: list[dict[str, Any]] = []
        for goal, limit in ((gap, seconds), (1e-9, 0.2)):
            found = certify(problem, subject=subject, gap=goal, seconds=limit)
            state = state_document(found)
            made += [certificate(found)] if found.proof is not None else []
            made += [state] if state is not None else []
        return made

    ran = call(make, 6 * seconds)
    return [] if ran.value is None else list(ran.value)


def _drawn(family: str, wanted: dict[str, Any], number: int) -> Asked:
    for attempt in range(1000):
        rng = np.random.default_rng([number, attempt])
        asked = draw_asked(rng, family, 4, 2, bounds=0.3, odd=0.1)
        small = 3 <= len(asked.waypoints) <= 4 and not any(asked.ends.values())
        limited = np.isfinite(asked.acceleration).all() and np.isfinite(asked.velocity).all()
        if small and limited and all(asked.block.get(k) == v for k, v in wanted.items()):
            return asked
    raise RuntimeError(f"{family}: nothing drawn")


@cache
def _pool(kind: str, number: int) -> tuple[str, ...]:
    return tuple(json.dumps(d) for d in _certified(kind, number, _MAKE_SECONDS))


@lru_cache(maxsize=1)
def _shipped() -> tuple[str, ...]:
    from trajgap.nlp.proofs.document import shipped_folder

    return tuple(p.read_text("utf-8") for p in sorted(shipped_folder().glob("*.json")))


def _some(rng: Rng, states: bool) -> dict[str, Any] | None:
    """A true certificate, or a state."""
    if not states and rng.random() < 0.2:
        text = _shipped()[rng.integers(len(_shipped()))]
        return dict(json.loads(text))
    kind = str(rng.choice(list(KINDS)))
    pool = [json.loads(x) for x in _pool(kind, int(rng.integers(_EACH)))]
    fitting = [d for d in pool if ("state" in d["format"]) == states]
    # What proves nothing yet has little to alter.
    fitting = [d for d in fitting if d["proof"]] or fitting
    return dict(fitting[rng.integers(len(fitting))]) if fitting else None


def _hash(part: Any) -> str:
    words = json.dumps(part, sort_keys=True, separators=(",", ":"), ensure_ascii=True)
    return hashlib.sha256(words.encode()).hexdigest()


def sealed(document: dict[str, Any]) -> dict[str, Any]:
    """The document with both hashes made right."""
    own = {**document, "problem_hash": _hash(document.get("problem"))}
    own.pop("seal", None)
    return {**own, "seal": _hash(own)}


# --- alterations ----------------------------------------------------------------------------------

_NUMBERS = ("9" * 120, "0", "-1", "1e99", "-1e99", "1e-99", "1/3", "1/0", "٣", " 1", "1_0", "nan")
"""Numbers as text that a reader may take for others."""


def altered(rng: Rng, document: dict[str, Any], other: dict[str, Any] | None) -> str:
    """Alter a certificate in place in one way; what was done."""
    ways: tuple[Callable[[], str], ...] = (
        lambda: _one_number(rng, document),
        lambda: _one_number(rng, document["proof"]),
        lambda: _one_number(rng, document["problem"]),
        lambda: _claim(rng, document),
        lambda: _claim(rng, document),
        lambda: _claim(rng, document),
        lambda: _structure(rng, document),
        lambda: _tree(rng, document),
        lambda: _graft(rng, document, other),
        lambda: _easier(rng, document),
        lambda: _infeasible(document),
    )
    return ways[rng.integers(len(ways))]()


def _leaf_places(value: Any) -> list[tuple[Any, ...]]:
    return [p for p in places(value) if not isinstance(_at(value, p), dict | list)]


def _at(value: Any, place: tuple[Any, ...]) -> Any:
    for key in place:
        value = value[key]
    return value


def _put(value: Any, place: tuple[Any, ...], new: Any) -> None:
    _at(value, place[:-1])[place[-1]] = new


def _one_number(rng: Rng, part: Any) -> str:
    every = _leaf_places(part) if isinstance(part, dict) else []
    if not every:
        return "nothing"
    place = every[rng.integers(len(every))]
    before = _at(part, place)
    _put(part, place, _other(rng, before))
    return f"{'.'.join(map(str, place))}: {str(before)[:40]} is {str(_at(part, place))[:40]}"


def _other(rng: Rng, value: Any) -> Any:
    draw = rng.random()
    if draw < 0.1:
        return [None, True, [], {}, "x", 0, -1, 2**53, 2**70, 1.5][rng.integers(10)]
    if isinstance(value, bool):
        return not value
    if isinstance(value, int):
        near = [value + 1, value - 1, -value, 0, 2 * value, int(rng.integers(-9, 2**20))]
        return near[rng.integers(len(near))]
    try:
        number = Fraction(value)
    except (TypeError, ValueError, ZeroDivisionError):
        return _NUMBERS[rng.integers(len(_NUMBERS))]
    if draw < 0.2:
        return _NUMBERS[rng.integers(len(_NUMBERS))]
    if draw < 0.3:
        return _text(-number)
    factor = 1 + Fraction(int(rng.integers(-99, 100)), 10 ** int(rng.integers(1, 13)))
    return _text(number * factor)


def _text(number: Fraction) -> str:
    return f"{number.numerator}/{number.denominator}" if number.denominator > 1 else str(number)


def _claim(rng: Rng, document: dict[str, Any]) -> str:
    """More than is proved: bounds raised together, or an answer shortened."""
    claim, proof = document["claim"], document["proof"]
    up = 1 + Fraction(int(rng.integers(1, 100)), 10 ** int(rng.integers(2, 7)))
    what = int(rng.integers(6))
    if what == 5 and claim["durations"]:
        claim["durations"] = [_text(Fraction(x) / up) for x in claim["durations"]]
        claim["upper"] = _text(Fraction(claim["upper"]) / up)
        return f"answer shorter by {float(up)}"
    claim["lower"] = _text(Fraction(claim["lower"]) * up)
    if what > 0 and proof:
        proof["total"] = _text(Fraction(proof["total"]) * up)
        if "cap" in proof:
            proof["cap"] = _text(Fraction(proof["cap"]) * up)
    if what > 1:
        claim["upper"] = claim["durations"] = claim["speeds"] = None
    return f"lower bound higher by {float(up)}"


def _structure(rng: Rng, document: dict[str, Any]) -> str:
    every = places(document)
    place = every[rng.integers(len(every))]
    parent, key = _at(document, place[:-1]), place[-1]
    name = ".".join(map(str, place))
    match int(rng.integers(4)):
        case 0:
            del parent[key]
            return f"{name} left out"
        case 1 if isinstance(parent, list):
            parent.insert(key, copy.deepcopy(parent[int(rng.integers(len(parent)))]))
            return f"{name} put in"
        case 2:
            other = every[rng.integers(len(every))]
            value = copy.deepcopy(_at(document, other))
            _put(document, place, value)
            return f"{name} from {'.'.join(map(str, other))}"
    if isinstance(parent, dict):
        parent[f"{key} "] = 1
        return "a key more"
    parent.reverse()
    return f"around {name} turned round"


def _tree(rng: Rng, document: dict[str, Any]) -> str:
    """Nodes left out, doubled, exchanged, or a part replaced by a leaf from elsewhere."""
    proof = document["proof"]
    if not proof or not isinstance(proof.get("tree"), list) or len(proof["tree"]) < 2:
        return "no tree"
    tree = proof["tree"]
    i, j = (int(x) for x in rng.integers(0, len(tree), 2))
    match int(rng.integers(4)):
        case 0:
            del tree[i]
        case 1:
            tree.insert(i, copy.deepcopy(tree[j]))
        case 2:
            tree[i], tree[j] = tree[j], tree[i]
        case _:
            leaves = [n for n in tree if isinstance(n, list) and n and n[0] == "."]
            del tree[i : i + int(rng.integers(1, 6))]
            tree.insert(i, copy.deepcopy(leaves[rng.integers(len(leaves))]) if leaves else ["."])
    return f"tree at {i}, {j}"


def _graft(rng: Rng, document: dict[str, Any], other: dict[str, Any] | None) -> str:
    """The problem of one certificate with the proof of another."""
    if other is None:
        return "nothing to graft"
    key = str(rng.choice(["proof", "problem", "claim"]))
    document[key] = copy.deepcopy(other[key])
    return f"{key} of another"


def _easier(rng: Rng, document: dict[str, Any]) -> str:
    """Limits higher, ways shorter or bounds wider: the bound that is proved no longer holds."""
    problem = document["problem"]
    factor = 1 + Fraction(int(rng.integers(1, 100)), 10 ** int(rng.integers(1, 8)))

    def times(value: Any, by: Fraction) -> Any:
        if isinstance(value, dict):
            return {**value, "value": _text(Fraction(value["value"]) * by)}
        return None if value is None else _text(Fraction(value) * by)

    match int(rng.integers(3)):
        case 0:
            j = int(rng.integers(len(problem["limits"])))
            problem["limits"][j] = [times(x, factor) for x in problem["limits"][j]]
        case 1:
            problem["waypoints"] = [[times(x, 1 / factor) for x in r] for r in problem["waypoints"]]
        case _:
            problem["duration_lower"] = [times(x, 1 / factor) for x in problem["duration_lower"]]
            problem["duration_upper"] = [None] * len(problem["duration_upper"])
    return f"easier by {float(factor)}"


def _infeasible(document: dict[str, Any]) -> str:
    claim = document["claim"]
    claim["infeasible"] = True
    claim["upper"] = claim["durations"] = claim["speeds"] = None
    return "called infeasible"


# --- what is judged -------------------------------------------------------------------------------


def _verified(document: dict[str, Any], budget: float) -> tuple[Ended, dict[str, Any] | None]:
    """What the verifier says, in a child."""

    def run() -> dict[str, Any]:
        from trajgap.verify import verify_certificate

        said = verify_certificate(document, seconds=budget)
        return {
            "proves": said.proves,
            "reason": said.reason,
            "late": said.out_of_time,
            "lower": None if said.lower is None else float(said.lower),
            "upper": None if said.upper is None else float(said.upper),
            "infeasible": said.infeasible,
            "any": str(said.subject) == "any curve",
        }

    ran = call(run, 60.0)
    return ran, ran.value


def judged(document: dict[str, Any], said: dict[str, Any], original: Any, seed: int) -> None:
    """Break if brute force refutes what is said to be proved."""
    asked = asked_in(document)
    demand(asked is not None, "proved, but the problem cannot be read a second time")
    assert asked is not None
    h = claimed(document)
    known = [x for x in (h, claimed(original)) if x is not None]
    if said["upper"] is not None and not said["any"]:
        demand(h is not None, "an upper bound without an answer")
        assert h is not None
        try:
            worst = excess(asked, h)[0]
        except NoCurve:
            worst = np.inf
        demand(worst <= 1 + 1e-6, f"the answer that is proved has the ratio {worst:.9g}")
        demand(h.sum() <= said["upper"] * (1 + _MARGIN), "the answer exceeds its upper bound")
    best = _least(document, asked, said["any"], known, seed)
    if said["infeasible"]:
        demand(best == np.inf, f"infeasible, but {best:.9g} is feasible")
        return
    why = f"a lower bound of {said['lower']:.12g}, but {best:.12g} is feasible"
    demand(said["lower"] <= best * (1 + _MARGIN), why)


def _least(
    document: dict[str, Any], asked: Asked, any_curve: bool, known: list[Any], seed: int
) -> float:
    if not any_curve:
        return least_declared(asked, seed, known)
    problem = document["problem"]
    ends: list[float | None] = [None, None]
    if "prescribed" in problem:
        form = asked.block["declared"]
        ends = [dict(form.prescribed[k]).get(1) for k in (0, -1)]
    elif problem.get("ends"):
        ends = [None if v is None else float(Fraction(v)) for v in problem["ends"]]
    try:
        stated = document["claim"]["speeds"] or []
        speeds = np.array([[float(Fraction(v)) for v in row] for row in stated])
    except (TypeError, ValueError, ZeroDivisionError, OverflowError):
        speeds = np.zeros(0)
    fits = speeds.shape == asked.waypoints.shape
    return least_any(asked, (ends[0], ends[1]), speeds if fits else None, seed)


def _attacked(rng: Rng, folder: Path, states: bool) -> str | None:
    original = _some(rng, states)
    if original is None:
        return None
    document = copy.deepcopy(original)
    other, done = _some(rng, states), []
    for _ in range(int(rng.integers(1, 4))):
        try:
            done.append(altered(rng, document, other))
        except (TypeError, KeyError, ValueError, AttributeError, IndexError, ZeroDivisionError):
            done.append("what is no longer there")
    if rng.random() < 0.8:
        document = sealed(document)
    budget = float(rng.choice(_BUDGETS))
    keep(folder, proof=json.dumps(document), done="\n".join(done))
    ran, said = _verified(document, budget)
    demand(not ran.late, f"no end after {ran.seconds:.0f} s")
    demand(said is not None, f"the verifier crashed: {ran.err[-500:]}")
    assert said is not None
    spent = ran.processor
    demand(spent <= budget + _SLACK, f"{spent:.1f} s of a budget of {budget:g} s")
    if not said["proves"]:
        return "out of time" if said["late"] else "refused"
    judged(document, said, original, int(rng.integers(1 << 30)))
    return "proved, true"


def certificates(rng: Rng, folder: Path) -> str | None:
    """Certificates altered in one to three ways."""
    return _attacked(rng, folder, False)


def states(rng: Rng, folder: Path) -> str | None:
    """States altered in one to three ways."""
    return _attacked(rng, folder, True)


def resumed(rng: Rng, folder: Path) -> str | None:
    """An altered state taken up again: refused, or only what is true comes of it."""
    original = _some(rng, True)
    if original is None:
        return None
    document = copy.deepcopy(original)
    # The problem stays: a state of another question is refused before anything is looked at.
    parts = [p for p in ("proposals", "proof", "claim") if document[p]]
    done = _one_number(rng, document[parts[rng.integers(len(parts))]])
    if rng.random() < 0.5:
        done += "; " + _claim(rng, document)
    document = sealed(document)
    keep(folder, proof=json.dumps(document), done=done)
    asked = asked_in(document)
    assert asked is not None
    subject = document["claim"]["subject"]

    def run() -> dict[str, Any] | str:
        from trajgap.nlp import certificate, certify
        from trajgap.problem import TrajgapError, parse_case
        from trajgap.verify import Subject

        from attacks.cases import alone as posed

        problem = parse_case(posed(_posable(asked)).text, "case.toml").problem()
        try:
            found = certify(problem, subject=Subject(subject), seconds=0.5, resume=document)
        except TrajgapError as error:
            return str(error)
        return certificate(found) if found.proof is not None else "nothing proved"

    ran = call(run, 60.0)
    demand(not ran.late, f"no end after {ran.seconds:.0f} s")
    demand(ran.value is not None, f"crashed: {ran.err[-800:]}")
    if isinstance(ran.value, str):
        return "refused" if "resume" in ran.value or "state" in ran.value else "nothing proved"
    _, said = _verified(ran.value, 20.0)
    demand(said is not None and said["proves"], f"what comes of it is refused: {said}")
    assert said is not None
    judged(ran.value, said, original, int(rng.integers(1 << 30)))
    return "true"


def _posable(asked: Asked) -> Asked:
    """The question of a state in words of a case file."""
    from dataclasses import replace

    if asked.family != "stated":
        labels = tuple(str(j + 1) for j in range(asked.waypoints.shape[1]))
        return replace(asked, labels=labels)
    form = asked.block["declared"]
    ends = [r for r, _ in form.prescribed[0]]
    if form.virtual:
        block: dict[str, Any] = {"family": "cubic-spline-virtual"}
    elif set(form.degrees) == {5} and form.continuity[:1] == (4,):
        block = {"family": "quintic-spline"}
    elif form.continuity[:1] == (0,):
        block = {"family": "rest-to-rest", "degree": form.degrees[0]}
    else:
        block = {
            "family": "polynomials",
            "degrees": list(form.degrees),
            "continuity": form.continuity[0] if form.continuity else 2,
            "end_orders": ends,
        }
    labels = tuple(str(j + 1) for j in range(asked.waypoints.shape[1]))
    return replace(asked, block=block, labels=labels)


def forged(rng: Rng, folder: Path) -> str | None:
    """Proofs made from nothing: rows, weights, trees and bounds at random, for a true problem."""
    original = _some(rng, False)
    if original is None:
        return None
    document = copy.deepcopy(original)
    proof, claim = document["proof"], document["claim"]
    claim["upper"] = claim["durations"] = claim["speeds"] = None
    best = Fraction(original["claim"]["upper"] or original["claim"]["lower"])
    share = rng.uniform(1.002, 2.0) if rng.random() < 0.6 else 10 ** rng.uniform(-2.0, 0.0)
    total = Fraction(_short(best * Fraction(float(share))))
    claim["lower"], proof["total"] = _text(total), _text(total)
    if "cap" in proof:
        proof["cap"] = _text(total * int(rng.integers(1, 4)))
    if rng.random() < 0.2:
        claim["infeasible"] = True
    _forged_tables(rng, proof)
    document = sealed(document)
    keep(folder, proof=json.dumps(document))
    ran, said = _verified(document, 8.0)
    demand(not ran.late, f"no end after {ran.seconds:.0f} s")
    demand(said is not None, f"the verifier crashed: {ran.err[-500:]}")
    assert said is not None
    if not said["proves"]:
        return "out of time" if said["late"] else "refused"
    judged(document, said, original, int(rng.integers(1 << 30)))
    return "proved, true"


def _short(number: Fraction) -> str:
    return f"{float(number):.12g}"


def _forged_tables(rng: Rng, proof: dict[str, Any]) -> None:
    """Leaves from a pool of the proof's own numbers, in another tree, or of few large weights."""
    tree = proof["tree"]
    leaves = [n for n in tree if isinstance(n, list) and n and n[0] == "."]
    cuts = [n for n in tree if n not in leaves]
    if not leaves:
        return
    depth = int(rng.integers(0, 6))
    forged_tree: list[Any] = []

    def grow(level: int) -> None:
        if level and cuts and rng.random() < 0.8:
            forged_tree.append(copy.deepcopy(cuts[rng.integers(len(cuts))]))
            if isinstance(forged_tree[-1], int) or forged_tree[-1][0] == "/":
                grow(level - 1)
            grow(level - 1)
            return
        leaf = copy.deepcopy(leaves[rng.integers(len(leaves))])
        if rng.random() < 0.5:
            _one_number(rng, {"leaf": leaf})
        forged_tree.append(leaf)

    grow(depth)
    proof["tree"] = forged_tree
    for key in ("rows", "windows"):
        if proof.get(key) and rng.random() < 0.5:
            for _ in range(int(rng.integers(1, 4))):
                _one_number(rng, {key: proof[key]})


def files(rng: Rng, folder: Path) -> str | None:
    """Files handed to `trajgap verify`: cut, doubled, nested, binary, with keys twice."""
    original = _some(rng, bool(rng.random() < 0.3))
    if original is None:
        return None
    text = json.dumps(original)
    at = int(rng.integers(len(text)))
    match int(rng.integers(9)):
        case 0:
            text = text[:at]
        case 1:
            text = text[:at] + chr(int(rng.integers(1, 0x250))) + text[at + 1 :]
        case 2:
            text = "[" * int(rng.integers(1, 200_000))
        case 3:
            text = text[:-1] + ', "claim": {}}'
        case 4:
            text = text.replace('"', "'", 1)
        case 5:
            text = '{"a":' * int(rng.integers(1, 100_000))
        case 6:
            text = text.replace("1", "1" + "0" * int(rng.integers(1, 100_000)), 1)
        case 7:
            text = text.replace('"tree": [', '"tree": [' + "0, " * int(rng.integers(1, 300_000)), 1)
        case _:
            text = json.dumps([original, original])
    data = text.encode() if rng.random() < 0.9 else rng.bytes(int(rng.integers(0, 5000)))
    (folder / "proof.json").write_bytes(data)
    ran = command(["verify", "proof.json", "--json"], folder, 100.0)
    demand(not ran.late, f"no end after {ran.seconds:.0f} s")
    if ran.code == 2:
        well_ended(ran, (2,), "verify")
        return "refused in one line"
    demand(ran.code in (0, 1), f"exit code {ran.code}: {ran.err[-500:]}")
    demand(ran.err == "", f"standard error: {ran.err[-500:]}")
    (one,) = json.loads(ran.out)["verified"]
    demand((ran.code == 0) == ("proves" in one["worth"]), f"{one['worth']}, code {ran.code}")
    return str(one["worth"])


ATTACKS = (
    Attack(
        "certificates",
        "certificates of every kind, shipped and made, with one to three numbers, keys, nodes, "
        "rows, weights or claims altered or taken from others, hashes made right again",
        "nothing is proved that brute force refutes; no crash; within the time limit",
        certificates,
        share=4.0,
        quick=12,
    ),
    Attack(
        "forged proofs",
        "proofs put together at random for true problems, with claims from 0.01 to 2 times the "
        "optimum, or of infeasibility",
        "the same",
        forged,
        share=2.0,
        quick=8,
    ),
    Attack(
        "states",
        "states of stopped runs, altered likewise",
        "the same",
        states,
        share=1.0,
        quick=4,
    ),
    Attack(
        "states taken up again",
        "altered states given to `certify(resume=...)`",
        "refused, or an interval that is proved and true",
        resumed,
        share=1.0,
        quick=3,
    ),
    Attack(
        "files to verify",
        "certificates cut, nested, doubled, with keys twice, long numbers or random bytes; "
        "`trajgap verify`",
        "exit code 0, 1 or 2 and nothing on standard error but one line",
        files,
        share=0.7,
        quick=10,
    ),
)
