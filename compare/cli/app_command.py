"""The command `app`: the form in the browser."""

from __future__ import annotations

from dataclasses import dataclass

from .options import Options, option


@dataclass(frozen=True, kw_only=True)
class FormOptions(Options):
    """Where the form is."""

    port: int = option("", 8350, min=0, max=65535)
    """Port on this machine; 0 for any free one."""
    browser: bool = option("", True, "--browser/--no-browser")
    """Open the form in the browser."""


def app(form: FormOptions) -> int:
    """Open a form in the browser.

    It audits a table of way-points, or checks a motion. The form runs on this machine alone;
    nothing leaves it.
    """
    import webbrowser

    from ..app import make_server
    from .output import say

    server = make_server(form.port)
    address = f"http://{server.host}:{server.port}/"
    say(f"{address}  (stop with Ctrl+C)\n")
    if form.browser:
        webbrowser.open(address)
    try:
        server.serve_forever()
    finally:
        server.server_close()
    return 0
