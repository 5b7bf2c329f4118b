"""How results appear in a notebook."""

from __future__ import annotations

from html import escape


class InNotebooks:
    """A result that a notebook shows as printed text, in columns."""

    def _repr_html_(self) -> str:
        return f"<pre>{escape(str(self))}</pre>"
