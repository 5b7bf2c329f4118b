"""Rules with their permanent ids, in plain words: what a rule file gives to the registry."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

from ....problem.cases import Claim
from ...documents import Finding
from ..study import Study

ON_DIGITS = "A claim that fits only if digits were cut off instead of rounded gets a warning."
"""What rules on the printed digits have in common."""
INFORMS = "It informs. No claim is supported or refuted by it."
"""What is said of rules that enter no verdict."""

Judge = Callable[[Study], Iterator[Finding]]
"""From a study to the findings of some rules."""


@dataclass(frozen=True)
class Explained:
    """A rule for a reader who has met its id in a report.

    Attributes
    ----------
    title : str
        What the rule looks at, in a table of all rules.
    asks : str
        What the rule compares, and how.
    concludes : str
        What it may say of a claim, and what it never says.
    example : str
        With made-up numbers.
    """

    title: str
    asks: str
    concludes: str
    example: str


@dataclass(frozen=True)
class RuleGroup:
    """Rules that one function judges.

    Attributes
    ----------
    rules : dict
        By their permanent ids; an id is never reused.
    without_waypoints : bool
        Whether it says something while the way-points are missing.
    """

    judge: Judge
    rules: dict[str, Explained]
    without_waypoints: bool = False

    def __call__(self, study: Study) -> Iterator[Finding]:
        """What the rules find."""
        return self.judge(study)


def rule_group(
    *, without_waypoints: bool = False, **rules: Explained
) -> Callable[[Judge], RuleGroup]:
    """Make a function the judge of rules, each under its permanent id with its explanation."""
    return lambda judge: RuleGroup(judge, rules, without_waypoints)


def finding(rule: str, claim: Claim | None, kind: str, *sentences: str, **facts: Any) -> Finding:
    """A finding of a rule on a claim, or on none; a sentence may be empty."""
    about = None if claim is None else claim.id
    return Finding(rule=rule, claim=about, kind=kind, sentences=sentences, **facts)
