"""How results appear in a notebook."""

from __future__ import annotations

from html import escape


class InNotebooks:
    """A result whose text a notebook shows as it is printed, in columns."""

    def _repr_html_(self) -> str:
        return f"<pre>{escape(str(self))}</pre>"
