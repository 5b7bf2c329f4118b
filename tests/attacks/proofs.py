"""Attacks on proofs: certificates altered, grafted, forged, with right hashes.

Each certificate has an answer that is known, so a bound above it is false, and so is an answer
below its bound. What an altered number of the problem itself allows is searched by brute force in
`tests/verify/test_verify.py`; altered states are taken up again beside their certifiers.
"""

import copy
import json
from collections.abc import Callable
from fractions import Fraction
from functools import lru_cache
from pathlib import Path
from typing import Any

from support.alterations import changed, get, places, put
from support.forgeries.forgery import KEPT
from support.small_certificates import sealed

from attacks.attack import Attack, demand, keep
from attacks.cases import Rng
from attacks.mutations import structural
from attacks.reading import well_ended
from attacks.sandbox import call, command

Document = dict[str, Any]
_BUDGETS = (0.3, 2.0, 8.0)
"""Time limits that the verifier is given, s."""
_SLACK = 1.5
"""Seconds that it may take beyond them: reading a file of the largest size."""
_ALREADY_ALTERED = (
    TypeError, KeyError, ValueError, AttributeError, IndexError, ZeroDivisionError, OverflowError,
)  # fmt: skip
"""What an alteration raises where an earlier one left nothing to alter."""
_MARGIN = 1e-12
"""Relative: what a bound as float may be off by."""


def _number(rng: Rng, document: Document, *parts: str) -> str:
    """A number of the document, or of some of its parts, is another."""
    every = [p for p in places(document) if not parts or p[0] in parts]
    path = every[rng.integers(len(every))]
    put(document, path, changed(get(document, path), rng))
    return f"{'.'.join(map(str, path))} is {str(get(document, path))[:40]}"


def claim_more(rng: Rng, document: Document) -> str:
    """More than is proved: bounds raised together, or an answer shortened."""
    claim, proof = document["claim"], document["proof"]
    up = 1 + Fraction(int(rng.integers(1, 100)), 10 ** int(rng.integers(2, 7)))
    what = int(rng.integers(6))
    if what > 3 and claim["durations"]:
        claim["durations"] = [str(Fraction(x) / up) for x in claim["durations"]]
        upper = Fraction(claim["upper"]) / up
        claim["upper"] = str(upper)
        # A bound above its answer is refused whatever the answer is.
        claim["lower"] = proof["total"] = str(min(upper, Fraction(claim["lower"])))
        return f"answer shorter by {float(up)}"
    claim["lower"] = str(Fraction(claim["lower"]) * up)
    if what > 0 and proof:
        proof["total"] = str(Fraction(proof["total"]) * up)
        if "cap" in proof:
            proof["cap"] = str(Fraction(proof["cap"]) * up)
    if what > 1:
        _no_answer(document)
    return f"lower bound higher by {float(up)}"


def _no_answer(document: Document) -> None:
    document["claim"] |= {"upper": None, "durations": None, "speeds": None}


def _tree(rng: Rng, document: Document) -> str:
    """Nodes left out, doubled, exchanged, or a part replaced by a leaf from elsewhere."""
    tree = document["proof"]["tree"]
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


def _forged(rng: Rng, document: Document) -> str:
    """A proof from nothing: its own cuts and leaves in another tree, for any claim."""
    claim, proof = document["claim"], document["proof"]
    tree = proof["tree"]
    leaves = [n for n in tree if isinstance(n, list) and n and n[0] == "."]
    cuts = [n for n in tree if n not in leaves]
    grown: list[Any] = []

    def grow(level: int) -> None:
        if level and cuts and rng.random() < 0.8:
            grown.append(copy.deepcopy(cuts[rng.integers(len(cuts))]))
            if isinstance(grown[-1], int) or grown[-1][0] == "/":
                grow(level - 1)
            grow(level - 1)
            return
        grown.append(copy.deepcopy(leaves[rng.integers(len(leaves))]))

    grow(int(rng.integers(0, 6)))
    proof["tree"] = grown
    for _ in range(int(rng.integers(0, 4))):
        _number(rng, document, "proof")
    share = rng.uniform(1.002, 2.0) if rng.random() < 0.6 else 10 ** rng.uniform(-2.0, 0.0)
    total = Fraction(f"{float(claim['lower']) * share:.12g}")
    claim["lower"] = proof["total"] = str(total)
    claim["infeasible"] = bool(rng.random() < 0.2)
    if "cap" in proof:
        proof["cap"] = str(total * int(rng.integers(1, 4)))
    _no_answer(document)
    return "forged"


def _easier(rng: Rng, document: Document) -> str:
    """Limits higher or bounds wider: the known answer still keeps all."""
    problem = document["problem"]
    factor = 1 + Fraction(int(rng.integers(1, 100)), 10 ** int(rng.integers(1, 8)))

    def times(value: Any, by: Fraction) -> Any:
        if isinstance(value, list):
            return [times(one, by) for one in value]
        if isinstance(value, dict):
            return {**value, "value": str(Fraction(value["value"]) * by)}
        return None if value is None else str(Fraction(value) * by)

    if rng.random() < 0.7:
        j = int(rng.integers(len(problem["limits"])))
        problem["limits"][j] = times(problem["limits"][j], factor)
    else:
        problem["duration_lower"] = times(problem["duration_lower"], 1 / factor)
        problem["duration_upper"] = [None] * len(problem["duration_upper"])
    return f"easier by {float(factor)}"


def _infeasible(document: Document) -> str:
    document["claim"]["infeasible"] = True
    _no_answer(document)
    return "called infeasible"


def altered(rng: Rng, document: Document, other: Document) -> str:
    """Alter a certificate in place in one way; what was done."""

    def graft() -> str:
        key = str(rng.choice(["proof", "problem", "claim"]))
        document[key] = copy.deepcopy(other[key])
        return f"{key} of another"

    ways: tuple[Callable[[], str], ...] = (
        lambda: _number(rng, document),
        lambda: _number(rng, document, "proof"),
        lambda: _number(rng, document, "problem"),
        *[lambda: claim_more(rng, document)] * 3,
        lambda: structural(rng, document),
        lambda: _tree(rng, document),
        lambda: _forged(rng, document),
        graft,
        lambda: _easier(rng, document),
        lambda: _infeasible(document),
    )
    return ways[rng.integers(len(ways))]()


@lru_cache(maxsize=1)
def _kept() -> tuple[tuple[str, ...], ...]:
    """Certificates with an answer: one of each kind of proof, and those that are shipped."""
    from trajgap.nlp.proofs.document import shipped_folder

    texts = (
        [p.read_text("utf-8") for p in sorted(folder.glob("*.json"))]
        for folder in (KEPT, shipped_folder())
    )
    return tuple(tuple(x for x in every if json.loads(x)["claim"]["durations"]) for every in texts)


def some_proof(rng: Rng) -> Document:
    """A true certificate."""
    pool = _kept()[int(rng.random() < 0.2)]
    return dict(json.loads(pool[rng.integers(len(pool))]))


def _verified(document: Document, budget: float) -> Document:
    """What the verifier says, in a child."""

    def run() -> Document:
        from trajgap.verify import verify_certificate

        said = verify_certificate(document, seconds=budget)
        return {
            "proves": said.proves,
            "late": said.out_of_time,
            "lower": None if said.lower is None else float(said.lower),
            "upper": None if said.upper is None else float(said.upper),
            "infeasible": said.infeasible,
            "subject": str(said.subject),
        }

    ran = call(run, 60.0)
    demand(not ran.late, f"no end after {ran.seconds:.0f} s")
    demand(ran.value is not None, f"the verifier crashed: {ran.err[-500:]}")
    spent = ran.processor
    demand(spent <= budget + _SLACK, f"{spent:.1f} s of a budget of {budget:g} s")
    return dict(ran.value)


def judged(said: Document, known: Document, same: bool = True) -> None:
    """Break if the known answer of a question, or of a harder one, refutes what is proved."""
    claim = known["claim"]
    demand(not said["infeasible"], f"infeasible, but {claim['upper']} is an answer")
    low, high = (float(Fraction(claim[key])) for key in ("lower", "upper"))
    why = f"a lower bound of {said['lower']!r}, but {high!r} is an answer"
    demand(said["lower"] <= high * (1 + _MARGIN), why)
    if same and said["upper"] is not None:
        why = f"an answer of {said['upper']!r}, but {low!r} is a lower bound"
        demand(said["upper"] >= low * (1 - _MARGIN), why)


def certificates(rng: Rng, folder: Path) -> str | None:
    """Certificates altered in one to three ways."""
    known = [some_proof(rng), some_proof(rng)]
    document, done = copy.deepcopy(known[0]), []
    for _ in range(int(rng.integers(1, 4))):
        try:
            done.append(altered(rng, document, known[1]))
        except _ALREADY_ALTERED:
            done.append("what is no longer there")
    if rng.random() < 0.8:
        try:
            document = sealed(document)
        except _ALREADY_ALTERED:
            done.append("nothing to seal")
    budget = float(rng.choice(_BUDGETS))
    keep(folder, proof=json.dumps(document), done="\n".join(done))
    said = _verified(document, budget)
    if not said["proves"]:
        return "out of time" if said["late"] else "refused"
    word = "proved, of a problem that was altered"
    for one in known:
        if said["subject"] == one["claim"]["subject"]:
            if document["problem"] == one["problem"]:
                judged(said, one)
                word = "proved, true"
            elif one is known[0] and all(d.startswith(("easier", "lower", "answer")) for d in done):
                judged(said, one, same=False)
                word = "proved, true"
    return word


def files(rng: Rng, folder: Path) -> str | None:
    """Files handed to `trajgap verify`: cut, doubled, nested, binary, with keys twice."""
    original = some_proof(rng)
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
        "certificates of every kind with one to three numbers, keys, nodes, rows, weights or "
        "claims altered or taken from others, and proofs put together at random, with claims "
        "from 0.01 to 2 times what is proved, or of infeasibility; hashes made right again",
        "nothing is proved that the known answer refutes; no crash; within the time limit",
        certificates,
        share=6.0,
        quick=30,
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
