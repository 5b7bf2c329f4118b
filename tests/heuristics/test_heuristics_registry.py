"""Algorithms from the settings of a case file: every bad one is named with how to fix it."""

import tomllib
from collections.abc import Mapping
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
    run,
)
from trajgap.problem import Limits, Problem, TrajgapError, three_five_three


def test_defaults() -> None:
    assert KINDS == (
        "pso", "mnam-pso", "constrained-pso", "woa", "improved-woa", "ga", "improved-ga",
    )  # fmt: skip
    assert from_settings("pso", {}) == PSO()
    assert from_settings("mnam-pso", {}) == MNAMPSO()
    assert from_settings("constrained-pso", {}) == ConstrainedPSO()
    assert from_settings("woa", {}) == WOA()
    assert from_settings("improved-woa", {}) == ImprovedWOA()
    assert from_settings("ga", {}) == GA()
    assert from_settings("improved-ga", {}) == ImprovedGA()


def test_settings_as_a_case_file_writes_them() -> None:
    text = """
    particles = 20
    c1 = 1
    inertia_max = 0.8
    inertia_reading = "rises"
    position_initial = [0.5, 2]
    niches_rule = "clusters"
    """
    record = from_settings("mnam-pso", tomllib.loads(text))
    assert record == MNAMPSO(
        particles=20,
        c1=1.0,
        inertia_max=0.8,
        inertia_reading="rises",
        position_initial=(0.5, 2.0),
        niches_rule="clusters",
    )
    assert isinstance(record.c1, float)
    assert record.position_initial == (0.5, 2.0)
    assert hash(record) == hash(record)


def test_settings_of_the_other_papers() -> None:
    text = """
    whales = 20
    s = -0.5
    tent_rule = "single"
    exploration = "dropped"
    threshold = inf
    """
    assert from_settings("improved-woa", tomllib.loads(text)) == ImprovedWOA(
        whales=20, s=-0.5, tent_rule="single", exploration="dropped", threshold=float("inf")
    )
    text = """
    population = 20
    encoding = "binary"
    crossover = "one-point"
    mutated = "individual"
    pool_rule = "double-best"
    q_best = 0.5
    """
    record = from_settings("improved-ga", tomllib.loads(text))
    assert record == ImprovedGA(
        population=20,
        encoding="binary",
        crossover="one-point",
        mutated="individual",
        pool_rule="double-best",
        q_best=0.5,
    )
    assert hash(record) == hash(record)


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
        (
            "pso",
            {"particles": 2.5},
            "pso: particles: expected a whole number of 1 or more, got 2.5",
        ),
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
        (
            "constrained-pso",
            {"ties": "keeps"},
            "constrained-pso: ties: 'keeps' is unknown; did you",
        ),
        ("constrained-pso", {"velocity_max": 0}, "velocity_max: expected a positive number, got 0"),
        ("improved-woa", {"S": 0}, "improved-woa: S: unknown setting; did you mean "),
        ("woa", {"s": 0}, "woa: s: unknown setting; did you mean "),
        ("woa", {"counter": "two"}, "woa: counter: 'two' is unknown; did you mean "),
        ("woa", {"replacement": 1}, "replacement: expected one of always, feasible, greedy, got 1"),
        ("ga", {"q_best": 0.1}, "ga: q_best: unknown setting; did you mean "),
        ("ga", {"encoding": "gray"}, "ga: encoding: 'gray' is unknown; did you mean "),
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
    way = np.array([[0.19, -1.63], [0.82, -2.01], [0.13, -1.07], [-0.88, -1.31]])
    problem = Problem(way, Limits(6.0, 8.0), three_five_three(), 0.1, 3.0)
    record = from_settings(kind, {})
    for field in type(record).__dataclass_fields__:
        current = getattr(record, field)
        if isinstance(current, StrEnum):
            for option in type(current):
                found = run(from_settings(kind, {field: option}), problem, 1, 3)
                assert found.trace.size == 4
                assert getattr(found.settings, field) is option
