"""Writes what the docs say of the documents: ``python -m trajgap.compare.documents docs``."""

from __future__ import annotations

import sys
from pathlib import Path

from ..audits import RULES
from .export import write_docs

if __name__ == "__main__":
    write_docs(Path(sys.argv[1] if sys.argv[1:] else "docs"), RULES)
