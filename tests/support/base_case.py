"""A case file that uses every field, for tests that change one place of it."""

from pathlib import Path

BASE = Path(__file__).with_suffix(".toml").read_text(encoding="utf-8")
