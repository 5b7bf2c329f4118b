"""CasADi, imported where an NLP is built: small problems need none, and it takes a while."""

from __future__ import annotations

from importlib import import_module
from typing import Any


class _Casadi:
    """Stands for the module. A lazily loaded one would be loaded by whatever lists all modules."""

    def __getattr__(self, name: str) -> Any:
        return getattr(import_module("casadi"), name)


ca: Any = _Casadi()
"""The module, for ``ca.SX`` and the like."""
