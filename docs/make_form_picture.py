"""Make the picture of the form: `python docs/make_form_picture.py`; it needs chromedriver."""

import sys
import threading
from pathlib import Path

from trajgap.compare.app import make_server

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "tests"))

from support.browser import browser  # noqa: E402


def main() -> None:
    server = make_server()
    threading.Thread(target=server.serve_forever, daemon=True).start()
    with browser() as window:
        window.size(900, 1100)
        window.open(f"http://127.0.0.1:{server.port}/")
        window.fill("#table", "j1,j2\n0.0,0.2\n0.6,0.9\n1.1,0.4\n0.8,-0.1")
        window.fill("#velocity", "3 rad/s")
        window.fill("#durations", "0.7, 0.8, 0.65")
        window.click("input[value='3-5-3']")
        window.click("form[action='/audit'] button")
        window.find("#velocity-fault")
        (ROOT / "docs" / "pictures" / "form.png").write_bytes(window.picture(whole=False))
    server.shutdown()


if __name__ == "__main__":
    main()
