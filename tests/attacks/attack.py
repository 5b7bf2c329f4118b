"""What an attack is: a seeded trial that holds, says nothing, or breaks with its input."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path

from attacks.cases import Rng

Trial = Callable[[Rng, Path], str | None]
"""One trial in an empty folder: the word for what was seen, or None if nothing can be judged."""


class Broken(Exception):
    """A property does not hold; the input that shows it lies in the folder of the trial."""


@dataclass(frozen=True)
class Attack:
    """One kind of trial.

    Attributes
    ----------
    name : str
        For the command line and the table.
    tries : str
        What is tried, for the table.
    holds : str
        What must hold, for the table.
    trial : callable
    share : float
        Part of a long run's time, relative to the others.
    quick : int
        Trials of the short run in the tests.
    inside : bool
        Whether the trial itself runs in a child that is bounded in time and memory.
    parts : mapping
        What one of the trial's parts is called, to the trial of that part alone.
    """

    name: str
    tries: str
    holds: str
    trial: Trial
    share: float = 1.0
    quick: int = 10
    inside: bool = False
    parts: Mapping[str, Trial] = field(default_factory=dict)

    @property
    def each(self) -> tuple[Attack, ...]:
        """The attack on every part by itself; the attack if it has none."""
        split = (
            replace(self, name=f"{self.name}: {part}", trial=trial, parts={})
            for part, trial in self.parts.items()
        )
        return tuple(split) or (self,)


def demand(holds: bool, why: str) -> None:
    """Break with a reason unless something holds."""
    if not holds:
        raise Broken(why)


def keep(folder: Path, **texts: str) -> None:
    """Write input into the folder of a trial before it is judged: ``case`` as ``case.toml``."""
    ends = {"case": "case.toml", "before": "before.toml", "proof": "proof.json"}
    for name, text in texts.items():
        (folder / ends.get(name, f"{name}.txt")).write_text(text, encoding="utf-8", newline="")
