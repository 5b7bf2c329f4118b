"""The verdicts: gaps, audits of published claims, waterfalls, pages, and the command line.

Names are loaded on first use, so that the command line starts at once.
"""

from __future__ import annotations

import sys
from importlib import import_module
from types import ModuleType
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .audit import AuditReport, CaseAudit, audit
    from .finding import RULES, Basis, ClaimVerdict, Finding, Judgement, Rule, Scope, Severity
    from .gap import Gap, GapKind, Reference, gap
    from .report import write_report
    from .rounding import Box, Rounding, RoundingVerdict, judge_rounding
    from .study import Study
    from .waterfall import Step, Waterfall, waterfalls

__all__ = [
    "RULES",
    "AuditReport",
    "Basis",
    "Box",
    "CaseAudit",
    "ClaimVerdict",
    "Finding",
    "Gap",
    "GapKind",
    "Judgement",
    "Reference",
    "Rounding",
    "RoundingVerdict",
    "Rule",
    "Scope",
    "Severity",
    "Step",
    "Study",
    "Waterfall",
    "audit",
    "gap",
    "judge_rounding",
    "waterfalls",
    "write_report",
]

_MODULES = {
    "audit": ("AuditReport", "CaseAudit", "audit"),
    "finding": (
        "RULES",
        "Basis",
        "ClaimVerdict",
        "Finding",
        "Judgement",
        "Rule",
        "Scope",
        "Severity",
    ),
    "gap": ("Gap", "GapKind", "Reference", "gap"),
    "report": ("write_report",),
    "rounding": ("Box", "Rounding", "RoundingVerdict", "judge_rounding"),
    "study": ("Study",),
    "waterfall": ("Step", "Waterfall", "waterfalls"),
}
_HOME = {name: module for module, names in _MODULES.items() for name in names}


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    value = getattr(import_module(f".{_HOME[name]}", __name__), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})


class _Package(ModuleType):
    """Keeps ``audit`` and ``gap`` the functions.

    Python binds every loaded submodule to its package, which would hide the function of its name.
    """

    def __setattr__(self, name: str, value: object) -> None:
        if not (name in _HOME and isinstance(value, ModuleType)):
            super().__setattr__(name, value)


sys.modules[__name__].__class__ = _Package
