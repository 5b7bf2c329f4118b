"""Attacks on proofs: certificates and states altered, grafted, forged, with right hashes."""

from __future__ import annotations

import copy
import json
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np

from attacks.attack import Attack, demand, keep
from attacks.cases import Rng
from attacks.curves import Asked, NoCurve, excess
from attacks.forging import altered, as_text, claim_more, forge_tables, one_number, sealed
from attacks.reading import well_ended
from attacks.sandbox import Ended, call, command
from attacks.stated import asked_in, claimed, least_any, least_declared
from attacks.true_proofs import some_proof

_BUDGETS = (0.3, 2.0, 8.0)
"""Time limits that the verifier is given, s."""
_SLACK = 1.5
"""Seconds that it may take beyond them: reading a file of the largest size."""
_ALREADY_ALTERED = (
    TypeError,
    KeyError,
    ValueError,
    AttributeError,
    IndexError,
    ZeroDivisionError,
)
"""What an alteration raises where an earlier one left nothing to alter."""
_MARGIN = 1e-9
"""Relative excess of a bound over a feasible total that counts as rounding of the samples."""


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
    ends: list[Any] = [None, None]
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
    original = some_proof(rng, states)
    if original is None:
        return None
    document = copy.deepcopy(original)
    other, done = some_proof(rng, states), []
    for _ in range(int(rng.integers(1, 4))):
        try:
            done.append(altered(rng, document, other))
        except _ALREADY_ALTERED:
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
    original = some_proof(rng, True)
    if original is None:
        return None
    document = copy.deepcopy(original)
    # The problem stays: a state of another question is refused before anything is looked at.
    parts = [p for p in ("proposals", "proof", "claim") if document[p]]
    done = one_number(rng, document[parts[rng.integers(len(parts))]])
    if rng.random() < 0.5:
        try:
            done += "; " + claim_more(rng, document)
        except _ALREADY_ALTERED:
            done += "; what is no longer there"
    document = sealed(document)
    keep(folder, proof=json.dumps(document), done=done)
    asked = asked_in(document)
    assert asked is not None
    subject = document["claim"]["subject"]

    def run() -> dict[str, Any] | str:
        from trajgap.nlp import certificate, certify
        from trajgap.problem import TrajgapError, parse_case
        from trajgap.verify import Subject

        from attacks.cases import alone as written_case

        problem = parse_case(written_case(_as_written(asked)).text, "case.toml").problem()
        # A damaged word names no subject: the question is then that of the declared curve.
        about = Subject(subject) if subject in list(Subject) else Subject.DECLARED
        try:
            found = certify(problem, subject=about, seconds=0.5, resume=document)
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


def _as_written(asked: Asked) -> Asked:
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
    original = some_proof(rng, False)
    if original is None:
        return None
    document = copy.deepcopy(original)
    proof, claim = document["proof"], document["claim"]
    claim["upper"] = claim["durations"] = claim["speeds"] = None
    best = Fraction(original["claim"]["upper"] or original["claim"]["lower"])
    share = rng.uniform(1.002, 2.0) if rng.random() < 0.6 else 10 ** rng.uniform(-2.0, 0.0)
    total = Fraction(_short(best * Fraction(float(share))))
    claim["lower"], proof["total"] = as_text(total), as_text(total)
    if "cap" in proof:
        proof["cap"] = as_text(total * int(rng.integers(1, 4)))
    if rng.random() < 0.2:
        claim["infeasible"] = True
    forge_tables(rng, proof)
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


def files(rng: Rng, folder: Path) -> str | None:
    """Files handed to `trajgap verify`: cut, doubled, nested, binary, with keys twice."""
    original = some_proof(rng, bool(rng.random() < 0.3))
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
        quick=4,
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
