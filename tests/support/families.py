"""A small family of instances, and its examination."""

from __future__ import annotations

from pathlib import Path

from trajgap.compare.audits.instances.result import (
    InstancesResult,
)
from trajgap.compare.audits.study import Study
from trajgap.problem import (
    Case,
    parse_case,
)

WHALE = "z1-woa-bspline"


SMALL = Path(__file__).with_name("family.toml").read_text("utf-8")


UNSOLVED = (
    ("upper = 8", "upper = 0.05"),
    ("position_initial = [0, 8]", "position_initial = [0, 0.05]"),
)
"""Changes after which nothing keeps its limits."""


def small(*changes: tuple[str, str]) -> Case:
    text = SMALL
    for old, new in changes:
        assert text.count(old) >= 1, old
        text = text.replace(old, new)
    return parse_case(text, "small.toml")


def examined(*changes: tuple[str, str], workers: int = 1) -> InstancesResult:
    study = Study(small(*changes), seeds=2, workers=workers, certify_seconds=0)
    return study.instances(study.instance_blocks[0])
