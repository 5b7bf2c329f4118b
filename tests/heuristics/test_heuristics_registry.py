"""Algorithms from the settings of a case file: every bad one is named with how to fix it."""

import tomllib
from collections.abc import Mapping
from dataclasses import fields
from enum import StrEnum

import numpy as np
import pytest
from support.checkout import ROOT
from support.refusals import Refusal, each_refusal
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


@pytest.mark.parametrize(
    ("kind", "record", "text"),
    [("mnam-pso", MNAMPSO, PARTICLES), ("improved-woa", ImprovedWOA, WHALES)],
)
def test_settings_as_a_case_file_writes_them(kind: str, record: type, text: str) -> None:
    given = {k: tuple(v) if k.endswith("initial") else v for k, v in tomllib.loads(text).items()}
    found = from_settings(kind, tomllib.loads(text))
    assert found == record(**given)
    assert all(getattr(found, name) == value for name, value in given.items())
    assert isinstance(getattr(found, "c1", 1.0), float)
    assert hash(found) == hash(record(**given))


def test_defaults_are_what_the_shipped_cases_say() -> None:
    seen = set()
    for path in sorted((ROOT / "problem/published").glob("*.toml")):
        case = tomllib.loads(path.read_text("utf-8"))
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


@each_refusal("settings")
def test_bad_settings(one: Refusal) -> None:
    assert one.is_said(said(one.name, tomllib.loads(one.new)))


def test_a_number_beyond_float64_is_none() -> None:
    assert said("pso", {"c2": 10**400}).startswith("pso: c2: expected a number of 0 or more, got 1")


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
