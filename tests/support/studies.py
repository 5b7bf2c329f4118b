"""Studies of shipped cases, as printed or with a few places changed, each computed once.

A study is a cache of what is computed: tests may share one, none may alter it. A test that is about
computing twice builds its own with `Study`.
"""

import tomllib
from dataclasses import replace
from decimal import Decimal
from functools import cache
from importlib.resources import files

import pytest
from support.drawn import sketched
from support.findings import OwnCurve
from trajgap.compare.audits.case_audit import CaseAudit, audit_case
from trajgap.compare.audits.revision import Reworded
from trajgap.compare.audits.study import Study
from trajgap.compare.blocks import Page
from trajgap.compare.pages.writer import case_page
from trajgap.problem import Case, parse_case, published_ids
from trajgap.problem.cases.load import check_case

# A spread needs two seeds; more show nothing further in a test.
SEEDS = 2


def source(case_id: str) -> str:
    """The case file as shipped."""
    return files("trajgap.problem.published").joinpath(f"{case_id}.toml").read_text("utf-8")


@cache
def shipped(case_id: str) -> Study:
    """The case as shipped."""
    return OwnCurve(parse_case(source(case_id), f"{case_id}.toml"), seeds=SEEDS)


PUMA = "puma560-mnam-pso-353"


def without(case: Case, *blocks: str) -> Case:
    """The case without what some blocks list; one reading stays."""
    document = case.document
    left = {name: getattr(document, name)[: name == "readings"] for name in blocks}
    return replace(case, document=document.model_copy(update=left))


def briefly(case: Case) -> Case:
    """The case; the PUMA paper under its default reading alone, because each takes seconds."""
    return without(case, "readings") if case.id == PUMA else case


@cache
def original(case_id: str) -> Study:
    """The case as most tests know it."""
    whole = shipped(case_id)
    return OwnCurve(briefly(whole.case), seeds=SEEDS) if case_id == PUMA else whole


@cache
def changed(case_id: str, *swaps: tuple[str, str], tail: str = "") -> Study:
    """The case with a few places of its file changed, and more at its end."""
    if not swaps and not tail:
        return original(case_id)
    text = source(case_id)
    for old, new in swaps:
        assert old in text, old
        text = text.replace(old, new)
    return Reworded(briefly(parse_case(text + tail, f"{case_id}.toml")), original(case_id))


def hurried(case_id: str) -> Case:
    """The case with replays of three iterations, for tests that are not about what they find."""
    raw = tomllib.loads(source(case_id), parse_float=Decimal)
    for algorithm in raw["algorithms"]:
        stated = "chosen" if "iterations" in algorithm.get("chosen", {}) else "settings"
        algorithm[stated]["iterations"] = 3
    return check_case(raw, f"{case_id}.toml")


@cache
def audited(case_id: str) -> CaseAudit:
    """The audit of a case, with hurried replays."""
    return audit_case(Reworded(briefly(hurried(case_id)), original(case_id)))


@cache
def audited_alone(case_id: str) -> CaseAudit:
    """The audit of all readings, without families of instances, which take minutes."""
    case = hurried(case_id)
    if not case.document.families and case_id != PUMA:
        return audited(case_id)
    return audit_case(Reworded(without(case, "families"), shipped(case_id)))


@cache
def page_alone(case_id: str) -> Page:
    """The page of `audited_alone`."""
    with sketched():
        return case_page(audited_alone(case_id))


QUICKLY = ("irb460-pso-353", "z1-woa-bspline")
"""Shipped cases whose audit by `audited_alone` takes a few seconds on an idle core."""
EVERY = [
    case_id if case_id in QUICKLY else pytest.param(case_id, marks=pytest.mark.slow)
    for case_id in published_ids()
]
"""Every shipped case, as parameters of a test."""
