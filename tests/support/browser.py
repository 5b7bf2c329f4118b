"""A real browser, headless, driven by the protocol that all browsers share."""

import base64
import json
import shutil
import socket
import subprocess
import time
import urllib.error
import urllib.request
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

ELEMENT = "element-6066-11e4-a52e-4f735466cecf"
"""Key of an element in the WebDriver protocol."""


class Browser:
    """A window of chromium."""

    def __init__(self, address: str) -> None:
        self._address = address
        options = {"args": ["--headless=new", "--no-sandbox", "--disable-gpu", "--hide-scrollbars"]}
        wanted = {"browserName": "chrome", "goog:chromeOptions": options}
        wanted["goog:loggingPrefs"] = {"browser": "ALL"}
        asked = {"capabilities": {"alwaysMatch": wanted}}
        self._session = ""
        self._session = f"/session/{self.call('POST', '/session', asked)['sessionId']}"

        self.call("POST", "/timeouts", {"implicit": 60_000})  # ms until an element must be there

    def call(self, method: str, path: str, content: object = None) -> Any:
        data = None if content is None else json.dumps(content).encode()
        address = f"{self._address}{self._session}{path}"
        request = urllib.request.Request(address, data, method=method)
        with urllib.request.urlopen(request, timeout=240) as answer:
            return json.load(answer)["value"]

    def size(self, width: int, height: int) -> None:
        """Of the page as a phone or a screen shows it, whatever a window needs at least."""
        shape = {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": False}
        command = {"cmd": "Emulation.setDeviceMetricsOverride", "params": shape}
        self.call("POST", "/goog/cdp/execute", command)

    def open(self, address: str) -> None:
        self.call("POST", "/url", {"url": address})

    @property
    def address(self) -> str:
        return str(self.call("GET", "/url"))

    def run(self, script: str) -> Any:
        return self.call("POST", "/execute/sync", {"script": f"return {script}", "args": []})

    def find(self, selector: str) -> str:
        found = self.call("POST", "/element", {"using": "css selector", "value": selector})
        return f"/element/{found[ELEMENT]}"

    def text(self, selector: str) -> str:
        return str(self.call("GET", f"{self.find(selector)}/text"))

    def fill(self, selector: str, text: str) -> None:
        self.call("POST", f"{self.find(selector)}/value", {"text": text})

    def click(self, selector: str) -> None:
        self.call("POST", f"{self.find(selector)}/click", {})

    def picture(self, whole: bool = True) -> bytes:
        command = {"cmd": "Page.captureScreenshot", "params": {"captureBeyondViewport": whole}}
        return base64.b64decode(self.call("POST", "/goog/cdp/execute", command)["data"])

    @property
    def complaints(self) -> list[str]:
        """What the console says."""
        return [str(one["message"]) for one in self.call("POST", "/se/log", {"type": "browser"})]


def installed() -> bool:
    return shutil.which("chromedriver") is not None


@contextmanager
def browser() -> Iterator[Browser]:
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    driver = subprocess.Popen(
        ["chromedriver", f"--port={port}"], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
    )
    try:
        for _ in range(100):
            try:
                urllib.request.urlopen(f"http://127.0.0.1:{port}/status").close()
                break
            except urllib.error.URLError:
                time.sleep(0.1)
        window = Browser(f"http://127.0.0.1:{port}")
        yield window
        window.call("DELETE", "")
    finally:
        driver.terminate()
        driver.wait()
