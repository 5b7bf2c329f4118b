"""Rules with their permanent ids, in plain words: what a rule file gives to the registry."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any, Protocol

from ....problem.cases import Claim
from ...documents import Basis, Finding
from ..study import Study

ON_DIGITS = "A claim that fits only if digits were cut off instead of rounded gets a warning."
"""What rules on the printed digits have in common."""
INFORMS = "It informs. No claim is supported or refuted by it."
"""What is said of rules that enter no verdict."""

Judge = Callable[[Study], Iterator[Finding]]
"""From a study to the findings of some rules."""


class AskedAbout(Protocol):
    """A claim under a problem and a reading, as a `PrintedRow` is."""

    @property
    def claim(self) -> Claim: ...  # noqa: D102

    @property
    def problem(self) -> str: ...  # noqa: D102

    @property
    def reading(self) -> str: ...  # noqa: D102


@dataclass(frozen=True)
class Explained:
    """A rule for a reader who has met its id in a report, and what its findings have in common.

    Attributes
    ----------
    id : str
        Permanent; an id is never reused.
    title : str
        What the rule looks at, in a table of all rules.
    asks : str
        What the rule compares, and how.
    concludes : str
        What it may say of a claim, and what it never says.
    example : str
        With made-up numbers.
    basis : Basis
        What its findings rest on, where they do not say.
    decides : bool
        Whether its findings enter verdicts, where they do not say.
    """

    id: str
    title: str
    asks: str
    concludes: str
    example: str
    basis: Basis
    decides: bool = True

    def finding(
        self, about: AskedAbout | Claim | None, kind: str, *sentences: str, **facts: Any
    ) -> Finding:
        """A finding on a row, a claim or none; a sentence may be empty."""
        given: dict[str, Any] = {"rule": self.id, "basis": self.basis, "decides": self.decides}
        claim = about if about is None or isinstance(about, Claim) else about.claim
        if about is not None and not isinstance(about, Claim):
            given |= {"problem": about.problem, "reading": about.reading}
        given["claim"] = None if claim is None else claim.id
        return Finding(kind=kind, sentences=sentences, **given | facts)


@dataclass(frozen=True)
class RuleGroup:
    """Rules that one function judges, by their ids.

    Attributes
    ----------
    without_waypoints : bool
        Whether it says something while the way-points are missing.
    """

    judge: Judge
    rules: dict[str, Explained]
    without_waypoints: bool = False

    def __call__(self, study: Study) -> Iterator[Finding]:
        """What the rules find."""
        return self.judge(study)


def rule_group(*rules: Explained, without_waypoints: bool = False) -> Callable[[Judge], RuleGroup]:
    """Make a function the judge of rules."""
    return lambda judge: RuleGroup(judge, {one.id: one for one in rules}, without_waypoints)
