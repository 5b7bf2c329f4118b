"""Algorithms from the settings of a case file: every bad one is named with how to fix it."""

import tomllib
from collections.abc import Mapping
from dataclasses import fields
from enum import StrEnum

import numpy as np
import pytest
from support.checkout import ROOT
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


def said(kind: str, settings: Mapping[str, object]) -> str:
    with pytest.raises(TrajgapError) as caught:
        from_settings(kind, settings)
    assert "\n" not in str(caught.value)
    return str(caught.value)


@pytest.mark.parametrize("kind", KINDS)
def test_each_setting_refuses_what_is_of_another_kind(kind: str) -> None:
    record = from_settings(kind, {})
    for name in (field.name for field in fields(record)):
        value = getattr(record, name)
        if isinstance(value, StrEnum):
            assert f"{kind}: {name}: 'zzz' is unknown; did you mean '" in said(kind, {name: "zzz"})
            wrong, words = [1], f"expected one of {', '.join(type(value))}"
        elif isinstance(value, bool):
            wrong, words = [1, "yes"], "expected true or false"
        elif isinstance(value, tuple):
            wrong = [1, [1, 2, 3], [2, 1], ["a", 1], [0, np.inf]]
            words = "expected two numbers, the smaller first"
        elif isinstance(value, int):
            wrong, words = [-1, 2.5, True, "many"], "expected a whole number of "
        else:
            wrong, words = [-1.5, "2", np.nan, True], "expected a "
        for one in wrong:
            message = said(kind, {name: one})
            assert message.startswith(f"{kind}: {name}: {words}")
            assert ", got " in message


@pytest.mark.parametrize(
    ("kind", "settings", "message"),
    [
        ("psoo", {}, "algorithm kind: 'psoo' is unknown; did you mean 'pso'?"),
        ("mnam", {}, "algorithm kind: 'mnam' is unknown; did you mean 'mnam-pso'?"),
        ("pso", {"particle": 3}, "pso: particle: unknown setting; did you mean 'particles'?"),
        ("woa", {"s": 0}, "woa: s: unknown setting; did you mean "),
        ("ga", {"q_best": 0.1}, "ga: q_best: unknown setting; did you mean "),
        ("pso", {"particles": 0}, "pso: particles: expected a whole number of 1 or more, got 0"),
        ("pso", {"inertia": np.inf}, "pso: inertia: expected a number of 0 or more, got inf"),
        ("pso", {"c2": 10**400}, "pso: c2: expected a number of 0 or more, got 1000"),
        ("pso", {"penalty": 0}, "pso: penalty: expected a positive number, got 0"),
        ("mnam-pso", {"niches": 0}, "mnam-pso: niches: expected a whole number of 1 or more"),
        ("mnam-pso", {"inertia_reading": "fall"}, "did you mean 'falls'?"),
        ("mnam-pso", {"particles": 3, "niches": 4}, "mnam-pso: niches: 4 niches for 3 particles"),
        ("mnam-pso", {"inertia_max": 0.4, "inertia_min": 0.9}, "inertia_min: exceeds inertia_max"),
        ("constrained-pso", {"inertia_max": 0.3}, "inertia_min: exceeds inertia_max"),
        ("constrained-pso", {"velocity_max": 0}, "velocity_max: expected a positive number, got 0"),
        ("improved-woa", {"s": -1.0}, "improved-woa: s: expected a number above -1, got -1.0"),
        ("improved-woa", {"s": np.inf}, "improved-woa: s: expected a number above -1, got inf"),
        ("improved-woa", {"beta": 0.0}, "beta: expected a number between 0 and 1, got 0.0"),
        ("improved-woa", {"beta": 1.0}, "beta: expected a number between 0 and 1, got 1.0"),
        ("ga", {"population": 5}, "ga: population: must be a multiple of 2, got 5"),
        ("ga", {"population": 4, "elite": 4}, "ga: elite: 4 survivors leave no room in 4"),
        ("ga", {"position_range": [1.0, 1.0]}, "ga: position_range: has no width"),
        ("ga", {"crossover_rate": 1.1}, "crossover_rate: expected a number from 0 to 1, got 1.1"),
        ("ga", {"resolution": 0}, "ga: resolution: expected a positive number, got 0"),
        ("improved-ga", {"population": 6}, "improved-ga: population: must be a multiple of 4"),
        ("improved-ga", {"position_range": [2.0, 2.0]}, "position_range: has no width"),
        ("improved-ga", {"q_best": 0.1, "q_worst": 0.2}, "improved-ga: q_worst: exceeds q_best"),
        ("improved-ga", {"q_worst": 0.0}, "q_worst: expected a number between 0 and 1, got 0.0"),
    ],
)
def test_bad_settings(kind: str, settings: Mapping[str, object], message: str) -> None:
    assert message in said(kind, settings)


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
