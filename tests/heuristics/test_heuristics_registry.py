"""Algorithms from the settings of a case file: every bad one is named with how to fix it."""

import tomllib
from collections.abc import Mapping
from enum import StrEnum

import numpy as np
import pytest
from support.checkout import ROOT
from support.two_joints import PROBLEM
from trajgap.heuristics import (
    GA,
    KINDS,
    MNAMPSO,
    PSO,
    WOA,
    ConstrainedPSO,
    ImprovedGA,
    ImprovedWOA,
    from_settings,
    open_choices,
    run,
)
from trajgap.problem import TrajgapError


def test_defaults() -> None:
    assert KINDS == (
        "pso", "mnam-pso", "constrained-pso", "woa", "improved-woa", "ga", "improved-ga",
    )  # fmt: skip
    records = (PSO, MNAMPSO, ConstrainedPSO, WOA, ImprovedWOA, GA, ImprovedGA)
    assert [from_settings(kind, {}) for kind in KINDS] == [record() for record in records]
    assert PSO().penalty == np.inf  # which no case file states


PARTICLES = """
particles = 20
c1 = 1
inertia_max = 0.8
inertia_reading = "rises"
position_initial = [0.5, 2]
niches_rule = "clusters"
"""
WHALES = 'whales = 20\ns = -0.5\ntent_rule = "single"\nexploration = "dropped"\nthreshold = inf'
GENES = """
population = 20
encoding = "binary"
crossover = "one-point"
mutated = "individual"
pool_rule = "double-best"
q_best = 0.5
"""


@pytest.mark.parametrize(
    ("kind", "record", "text"),
    [("mnam-pso", MNAMPSO, PARTICLES), ("improved-woa", ImprovedWOA, WHALES),
     ("improved-ga", ImprovedGA, GENES)],
)  # fmt: skip
def test_settings_as_a_case_file_writes_them(kind: str, record: type, text: str) -> None:
    given = {k: tuple(v) if k.endswith("initial") else v for k, v in tomllib.loads(text).items()}
    found = from_settings(kind, tomllib.loads(text))
    assert found == record(**given)
    assert all(getattr(found, name) == value for name, value in given.items())
    assert isinstance(getattr(found, "c1", 1.0), float)
    assert hash(found) == hash(record(**given))


def test_defaults_are_what_the_shipped_cases_say() -> None:
    seen = set()
    for path in sorted((ROOT / "problem" / "published").glob("*.toml")):
        case = tomllib.loads(path.read_text(encoding="utf-8"))
        for block in case.get("algorithms", ()):
            given = {**block.get("settings", {}), **block.get("chosen", {})}
            assert from_settings(block["kind"], given) == from_settings(block["kind"], {}), path
            seen.add(block["kind"])
    assert seen == set(KINDS)


@pytest.mark.parametrize(
    ("kind", "settings", "message"),
    [
        ("psoo", {}, "algorithm kind: 'psoo' is unknown; did you mean 'pso'?"),
        ("mnam", {}, "algorithm kind: 'mnam' is unknown; did you mean 'mnam-pso'?"),
        ("pso", {"particle": 3}, "pso: particle: unknown setting; did you mean 'particles'?"),
        ("pso", {"omega": 3}, "pso: omega: unknown setting; did you mean "),
        ("pso", {"particles": 0}, "pso: particles: expected a whole number of 1 or more, got 0"),
        ("pso", {"particles": 2.5}, "pso: particles: expected a whole number of 1 or more, got 2"),
        ("pso", {"particles": True}, "pso: particles: expected a whole number"),
        ("pso", {"iterations": "many"}, "pso: iterations: expected a whole number of 0 or more, "),
        ("pso", {"c1": -1}, "pso: c1: expected a number of 0 or more, got -1"),
        ("pso", {"c1": "2"}, "pso: c1: expected a number of 0 or more, got '2'"),
        ("pso", {"inertia": float("nan")}, "pso: inertia: expected a number of 0 or more, got nan"),
        ("pso", {"inertia": float("inf")}, "pso: inertia: expected a number of 0 or more, got inf"),
        ("pso", {"c2": 10**400}, "pso: c2: expected a number of 0 or more, got 1000"),
        ("pso", {"penalty": 0}, "pso: penalty: expected a positive number, got 0"),
        ("pso", {"draws": "each"}, "pso: draws: 'each' is unknown; did you mean "),
        ("pso", {"draws": 1}, "pso: draws: expected one of coordinate, particle, iteration, got 1"),
        ("pso", {"position_initial": 1}, "pso: position_initial: expected two numbers, the smal"),
        ("pso", {"position_initial": [1, 2, 3]}, "pso: position_initial: expected two numbers"),
        ("pso", {"position_initial": [2, 1]}, "pso: position_initial: expected two numbers"),
        ("pso", {"velocity_initial": ["a", 1]}, "pso: velocity_initial: expected two numbers"),
        ("pso", {"velocity_initial": [0, float("inf")]}, "pso: velocity_initial: expected two"),
        ("mnam-pso", {"niches": 0}, "mnam-pso: niches: expected a whole number of 1 or more"),
        ("mnam-pso", {"inertia_reading": "fall"}, "did you mean 'falls'?"),
        ("mnam-pso", {"mutated": "non"}, "mnam-pso: mutated: 'non' is unknown; did you mean 'one'"),
        ("constrained-pso", {"ties": "keeps"}, "constrained-pso: ties: 'keeps' is unknown; did "),
        ("constrained-pso", {"velocity_max": 0}, "velocity_max: expected a positive number, got 0"),
        ("improved-woa", {"S": 0}, "improved-woa: S: unknown setting; did you mean "),
        ("woa", {"s": 0}, "woa: s: unknown setting; did you mean "),
        ("woa", {"counter": "two"}, "woa: counter: 'two' is unknown; did you mean "),
        ("woa", {"replacement": 1}, "replacement: expected one of always, feasible, greedy, got 1"),
        ("ga", {"q_best": 0.1}, "ga: q_best: unknown setting; did you mean "),
        ("ga", {"encoding": "gray"}, "ga: encoding: 'gray' is unknown; did you mean "),
        ("mnam-pso", {"particles": 3, "niches": 4}, "mnam-pso: niches: 4 niches for 3 particles"),
        ("mnam-pso", {"inertia_max": 0.4, "inertia_min": 0.9}, "inertia_min: exceeds inertia_max"),
        ("constrained-pso", {"inertia_max": 0.3}, "inertia_min: exceeds inertia_max"),
        ("improved-woa", {"s": -1.0}, "improved-woa: s: expected a number above -1, got -1.0"),
        ("improved-woa", {"s": np.inf}, "improved-woa: s: expected a number above -1, got inf"),
        ("improved-woa", {"beta": 0.0}, "beta: expected a number between 0 and 1, got 0.0"),
        ("improved-woa", {"beta": 1.0}, "beta: expected a number between 0 and 1, got 1.0"),
        ("improved-woa", {"beta": "half"}, "beta: expected a number between 0 and 1, got 'half'"),
        ("ga", {"population": 5}, "ga: population: must be a multiple of 2, got 5"),
        ("ga", {"population": 4, "elite": 4}, "ga: elite: 4 survivors leave no room in 4"),
        ("ga", {"position_range": [1.0, 1.0]}, "ga: position_range: has no width"),
        ("ga", {"crossover_rate": 1.1}, "crossover_rate: expected a number from 0 to 1, got 1.1"),
        ("ga", {"mutation_rate": "x"}, "mutation_rate: expected a number from 0 to 1, got 'x'"),
        ("ga", {"resolution": 0}, "ga: resolution: expected a positive number, got 0"),
        ("improved-ga", {"population": 6}, "improved-ga: population: must be a multiple of 4"),
        ("improved-ga", {"best_quarter": "dies"}, "best_quarter: 'dies' is unknown; did you mean"),
        ("improved-ga", {"position_range": [2.0, 2.0]}, "position_range: has no width"),
        ("improved-ga", {"q_best": 0.1, "q_worst": 0.2}, "improved-ga: q_worst: exceeds q_best"),
        ("improved-ga", {"q_worst": 0.0}, "q_worst: expected a number between 0 and 1, got 0.0"),
        ("improved-ga", {"k1": -1.0}, "improved-ga: k1: expected a number of 0 or more, got -1.0"),
        ("improved-ga", {"adaptive_mutation": 1}, "adaptive_mutation: expected true or false, got"),
    ],
)
def test_bad_settings(kind: str, settings: Mapping[str, object], message: str) -> None:
    with pytest.raises(TrajgapError) as caught:
        from_settings(kind, settings)
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("kind", KINDS)
def test_open_choices_name_real_parameters(kind: str) -> None:
    """A choice that starts with a parameter's name names one that exists."""
    fields = set(type(from_settings(kind, {})).__dataclass_fields__)
    record = from_settings(kind, {})
    rules = {name for name in fields if isinstance(getattr(record, name), StrEnum)}
    text = "\n".join(open_choices(kind))
    assert all(name in text for name in rules)


def test_open_choices_of_an_unknown_kind() -> None:
    with pytest.raises(TrajgapError, match=r"algorithm kind: 'sa' is unknown"):
        open_choices("sa")


@pytest.mark.parametrize("kind", KINDS)
def test_every_word_of_every_choice_runs(kind: str) -> None:
    """Replays change one open choice at a time, so no word may contradict the other defaults."""
    record = from_settings(kind, {})
    for field in type(record).__dataclass_fields__:
        current = getattr(record, field)
        if isinstance(current, StrEnum):
            for option in type(current):
                found = run(from_settings(kind, {field: option}), PROBLEM, 1, 3)
                assert found.trace.size == 4
                assert getattr(found.settings, field) is option
