"""Fixtures that several tests here share."""

from __future__ import annotations

import pytest
from support.families import examined
from trajgap.compare.audits.instances.result import InstancesResult


@pytest.fixture(scope="module")
def result() -> InstancesResult:
    return examined()
