"""A proof on one core and on two, in the same run: the same proof, and how much sooner it is there.

The benchmarks of the kinds of proof use it. The ratio of the clocks means something on an idle
machine alone; processor seconds, of all processes, say what two cores cost on any.
"""

from __future__ import annotations

import resource
import time
from typing import Protocol

from trajgap.nlp import Certified
from trajgap.nlp.proofs import certificate

CORES = (
    "| problem | boxes | clock s, 1 | processor s, 1 | clock s, 2 | processor s, 2 | ratio |\n"
    "|---|---|---|---|---|---|---|"
)


class Asked(Protocol):
    def __call__(self, *, workers: int) -> Certified: ...


def processor() -> float:
    """Processor seconds of this process and of those that it has waited for."""
    every = (resource.getrusage(w) for w in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    return sum(one.ru_utime + one.ru_stime for one in every)


def on(workers: int, ask: Asked) -> tuple[Certified, float, float]:
    """A proof, its seconds of the clock and its processor seconds."""
    clock, spent = time.perf_counter(), processor()
    found = ask(workers=workers)
    return found, time.perf_counter() - clock, processor() - spent


def on_cores(name: str, ask: Asked) -> str:
    """A line of the table."""
    alone, first, spent = on(1, ask)
    shared, second, both = on(2, ask)
    assert certificate(shared)["proof"] == certificate(alone)["proof"]
    return (
        f"| {name} | {alone.nodes} | {first:.1f} | {spent:.1f} "
        f"| {second:.1f} | {both:.1f} | {first / second:.2f} |"
    )
