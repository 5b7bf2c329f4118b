"""The command `app`: the form in the browser."""

from __future__ import annotations

from typing import Annotated

import typer


def app(
    port: Annotated[
        int, typer.Option(min=0, max=65535, help="Port on this machine; 0 for any free one.")
    ] = 8350,
    browser: Annotated[bool, typer.Option(help="Open the form in the browser.")] = True,
) -> int:
    """Open a form in the browser.

    It audits a table of way-points, or checks a motion. The form runs on this machine alone;
    nothing leaves it.
    """
    import webbrowser

    from ..app import make_server
    from .output import say

    server = make_server(port)
    address = f"http://{server.host}:{server.port}/"
    say(f"{address}  (stop with Ctrl+C)\n")
    if browser:
        webbrowser.open(address)
    try:
        server.serve_forever()
    finally:
        server.server_close()
    return 0
