"""How sentences write a share in percent and a time in seconds."""

from __future__ import annotations


def percent(share: float, form: str = ".3g") -> str:
    """A share in percent."""
    return f"{100 * share:{form}} %"


def seconds(value: float, form: str = ".6g") -> str:
    """A time."""
    return f"{value:{form}} s"
