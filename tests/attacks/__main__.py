"""The long run.

``python tests/attacks --seconds 3600 --seed 1 | python docs/tables.py attacks``.
"""

import argparse
import os
import sys
from collections.abc import Sequence
from pathlib import Path

# One thread a process: children are forked, and the machine has other work.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
os.environ.setdefault("OMP_NUM_THREADS", "1")
# The folder above this one, as the tests have it; not this one, whose modules have plain names.
_HERE = Path(__file__).resolve().parent
sys.path[:] = [str(_HERE.parent), *(x for x in sys.path if Path(x or ".").resolve() != _HERE)]

from attacks.run import ATTACKS, Account, run, run_each, tried, warm  # noqa: E402
from attacks.sandbox import available  # noqa: E402


def main() -> int:
    """Run, say what broke, print the table; 1 if anything broke."""
    parser = argparse.ArgumentParser(prog="python tests/attacks", description=__doc__)
    parser.add_argument("--seconds", type=float, default=60.0, help="how long, on the clock")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument(
        "--only", action="append", metavar="NAME[,NAME]", help='only these, such as "killed: new"'
    )
    parser.add_argument("--trial", type=int, help="repeat one trial of one attack")
    parser.add_argument(
        "--trials", type=int, metavar="N", help="N trials of each attack, of each of its commands"
    )
    parser.add_argument(
        "--failures", type=Path, metavar="FOLDER", help="keep the input of what broke"
    )
    parser.add_argument("--list", action="store_true", help="list the attacks")
    given = parser.parse_args()
    named = {name for entry in given.only or () for name in (entry, *entry.split(","))}
    chosen = [a for a in ATTACKS if not named or a.name in named]
    chosen += [p for a in ATTACKS if a.parts for p in a.each if p.name in named]
    if given.list or not chosen:
        print("\n".join(a.name for a in ATTACKS))
        return 0 if given.list else 2
    if not available():
        print("attacks: need Linux: children are forked, limited and watched", file=sys.stderr)
        return 2
    if given.trial is not None:
        warm()
        accounts = [Account(attack) for attack in chosen]
        for account in accounts:
            tried(account, given.seed, given.trial, _say)
    elif given.trials is not None:
        accounts = run_each(chosen, given.seed, given.trials, _say)
    else:
        accounts = run(chosen, given.seed, given.seconds, _say)
    for account in accounts:
        _say(f"{account.attack.name}: {account.seconds:.0f} s, {_outcomes(account)}")
    if given.failures is not None:
        _keep(given.failures, accounts, given.seed)
    trials, broken = sum(a.tried for a in accounts), sum(len(a.broken) for a in accounts)
    print(f"{trials:,} trials, {broken} failures\n\n{table(accounts, given.trials is not None)}")
    return int(broken > 0)


def table(accounts: Sequence[Account], apart: bool) -> str:
    """What was tried and held, as `docs/tables.py` takes it; each command separately or not."""
    what = ("command",) if apart else ("what is tried", "what must hold")
    seen = ("what was seen",) if apart else ()
    head = ("attack", *what, "trials", "held", "not judged", "failures", *seen)
    lines = [head, ("---",) * len(head)]
    for a in accounts:
        counts = (f"{n:,}" for n in (a.tried, a.held, a.undecided, len(a.broken)))
        name, _, part = a.attack.name.partition(": ")
        if apart:
            own = _outcomes(a).replace(f"{part}: ", "")
            lines.append((name, f"`{part}`", *counts, own))
        else:
            lines.append((name, a.attack.tries, a.attack.holds, *counts))
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)


def _outcomes(account: Account) -> str:
    """How often each word was seen."""
    return "; ".join(f"{word} {n}" for word, n in account.words.most_common())


def _say(text: str) -> None:
    shown = "".join(c if c.isprintable() or c == "\n" else "?" for c in text)
    print(shown, file=sys.stderr, flush=True)


def _keep(folder: Path, accounts: list[Account], seed: int) -> None:
    for account in accounts:
        for failure in account.broken:
            plain = "".join(c if c.isalnum() else "-" for c in account.attack.name)
            own = folder / f"{plain}-{seed}-{failure.number}"
            own.mkdir(parents=True, exist_ok=True)
            (own / "why.txt").write_text(failure.why, "utf-8")
            for name, data in failure.files.items():
                (own / name).write_bytes(data)


if __name__ == "__main__":
    sys.exit(main())
