"""The runner: trials in turn until the time is up, every one to be repeated by its number."""

import contextlib
import io
import os
import shutil
import tempfile
import time
import traceback
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path

import numpy as np

from attacks import faults, judging, motions, nasty, proofs, reading
from attacks.attack import Attack, Broken
from attacks.sandbox import call

ATTACKS: tuple[Attack, ...] = (
    *reading.ATTACKS,
    *judging.ATTACKS,
    *motions.ATTACKS,
    *nasty.ATTACKS,
    *proofs.ATTACKS,
    *faults.ATTACKS,
)
"""In the order of the table."""
TRIAL_SECONDS = 240.0
"""Processor time of one trial inside a child."""
LARGEST_KEPT = 500_000
"""Bytes of an input file that is kept with a failure."""


@dataclass(frozen=True)
class Failure:
    """A trial whose property does not hold: its number, why, and its files."""

    number: int
    why: str
    files: dict[str, bytes]


@dataclass
class Account:
    """What became of the trials of one attack."""

    attack: Attack
    tried: int = 0
    undecided: int = 0
    seconds: float = 0.0
    words: Counter[str] = field(default_factory=Counter)
    broken: list[Failure] = field(default_factory=list)

    @property
    def held(self) -> int:
        return self.tried - self.undecided - len(self.broken)


def one_trial(attack: Attack, seed: int, number: int, folder: Path) -> str | None:
    """One trial, by its number; the same number draws the same input."""
    stream = np.frombuffer(attack.name.encode(), dtype=np.uint8)
    rng = np.random.default_rng([seed, number, *map(int, stream)])
    if not attack.inside:
        return attack.trial(rng, folder)

    def judged() -> tuple[str | None, str | None]:
        try:
            return attack.trial(rng, folder), None
        except Broken as broken:
            return None, str(broken)

    ran = call(judged, TRIAL_SECONDS)
    if ran.value is None:
        raise Broken(f"no end after {ran.seconds:.0f} s" if ran.late else f"crashed: {ran.err}")
    word, why = ran.value
    if why is not None:
        raise Broken(why)
    return str(word) if word is not None else None


def tried(
    account: Account, seed: int, number: int, say: Callable[[str], None] = lambda _: None
) -> None:
    """Run one trial and enter what became of it."""
    began = time.monotonic()
    folder = Path(tempfile.mkdtemp(prefix="attack-"))
    try:
        word = one_trial(account.attack, seed, number, folder)
        if word is None:
            account.undecided += 1
        else:
            account.words[word] += 1
    except Broken as broken:
        account.broken.append(Failure(number, str(broken), _kept(folder)))
        say(f"{account.attack.name}: trial {number}: {broken}")
    except Exception:
        # A slip of the attack is a failure like any other, not the end of an hour's run.
        why = f"the attack itself failed: {traceback.format_exc()}"
        account.broken.append(Failure(number, why, _kept(folder)))
        say(f"{account.attack.name}: trial {number}: {why}")
    finally:
        account.tried += 1
        account.seconds += time.monotonic() - began
        shutil.rmtree(folder, ignore_errors=True)


def _kept(folder: Path) -> dict[str, bytes]:
    """The input files of a trial; what is large or no plain file was not drawn but made."""
    return {
        path.name: path.read_bytes()
        for path in folder.iterdir()
        if path.is_file() and os.access(path, os.R_OK) and path.stat().st_size <= LARGEST_KEPT
    }


def run(
    attacks: Sequence[Attack], seed: int, seconds: float, say: Callable[[str], None]
) -> list[Account]:
    """Run trials until the time is up; each attack gets its share of it."""
    warm()
    accounts = [Account(attack) for attack in attacks]
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        # Whichever is furthest behind its share is next.
        next_one = min(accounts, key=lambda a: a.seconds / a.attack.share)
        tried(next_one, seed, next_one.tried, say)
    return accounts


def run_each(
    attacks: Sequence[Attack], seed: int, trials: int, say: Callable[[str], None]
) -> list[Account]:
    """Run so many trials of every part of each attack."""
    warm()
    accounts = [Account(part) for attack in attacks for part in attack.each]
    for account in accounts:
        for number in range(trials):
            tried(account, seed, number, say)
        say(f"{account.attack.name}: {account.held} of {account.tried} held")
    return accounts


@cache
def warm() -> None:
    """Import and compile once what every child needs."""
    import matplotlib.pyplot  # noqa: F401
    import scipy.interpolate
    import scipy.optimize
    import scipy.spatial.transform  # noqa: F401
    import trajgap.problem.curves.clamped_fit
    import trajgap.problem.curves.timed  # noqa: F401
    from trajgap.compare.audits import audit  # noqa: F401
    from trajgap.compare.cli import main
    from trajgap.compare.pages import write_report  # noqa: F401

    case = "irb460-pso-353"
    for arguments in (
        ("check", case, "--durations", "2,2,2", "--json"),
        ("show", case),
        ("solve", case),
    ):
        sink = io.StringIO()
        with contextlib.redirect_stdout(sink), contextlib.redirect_stderr(sink):
            code = main(list(arguments))
        if code:
            raise RuntimeError(f"a shipped case is not read: {sink.getvalue()}")
