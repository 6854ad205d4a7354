"""A headless Chromium driven over the DevTools protocol."""

from __future__ import annotations

import base64
import json
import subprocess
import time
from contextlib import ExitStack
from pathlib import Path
from typing import Any
from urllib.parse import urlparse

FLAGS = (
    "--headless",
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--remote-debugging-port=0",
    "--force-device-scale-factor=1",
    "--hide-scrollbars",
)
#: JavaScript: when two more frames have been drawn
NEXT = "new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => done(0))))"
_PATIENCE = 30.0  # s


class Tab:
    """One page: what it said on its console and what it asked the network for, and its controls."""

    def __init__(self, browser: Browser, target: str, session: str) -> None:
        self._browser = browser
        self._target = target
        self._session = session
        self._size: dict[str, Any] = {}
        self._sized = "true"  # whether the page has that size, in JavaScript
        self.errors: list[str] = []
        self.requests: list[str] = []

    def call(self, method: str, **parameters: Any) -> dict[str, Any]:
        return self._browser.call(method, parameters, self._session)

    def hear(self, method: str, said: dict[str, Any]) -> None:
        if method == "Runtime.exceptionThrown":
            details = said["exceptionDetails"]
            self.errors.append(details.get("exception", {}).get("description", details["text"]))
        elif method == "Runtime.consoleAPICalled" and said["type"] in ("error", "warning"):
            self.errors.append(str([one.get("value") for one in said["args"]]))
        elif method == "Log.entryAdded" and said["entry"]["level"] in ("error", "warning"):
            self.errors.append(said["entry"]["text"])
        elif method == "Network.webSocketCreated":
            self.requests.append(said["url"])
        elif method == "Network.requestWillBeSent":
            self.requests.append(said["request"]["url"])

    def run(self, script: str) -> Any:
        """The value of a JavaScript expression, awaited."""
        answer = self.call(
            "Runtime.evaluate", expression=script, awaitPromise=True, returnByValue=True
        )
        if "exceptionDetails" in answer:
            raise AssertionError(json.dumps(answer["exceptionDetails"], indent=1))
        return answer["result"].get("value")

    def wait(self, condition: str) -> None:
        """Wait until a JavaScript expression holds, which the page looks at itself."""
        end = time.monotonic() + _PATIENCE
        while not self._holds(condition):
            assert time.monotonic() < end, f"{condition} never held; the page said {self.errors}"
            time.sleep(0.02)

    def _holds(self, condition: str) -> bool:
        """Whether it does within a second."""
        look = (
            "(async () => { for (const end = performance.now() + 1e3; ; ) {"
            f"if ({condition}) return true;"
            "if (performance.now() > end) return false;"
            "await new Promise((done) => setTimeout(done, 20)); } })()"
        )
        try:
            return bool(self.run(look))
        except AssertionError as error:
            # asked between two pages: ask the next one
            if "navigated" in str(error) or "properties of null" in str(error):
                return False
            raise

    def open(self, path: Path, fragment: str = "play=0", *, ready: bool = True) -> None:
        """Open a page, and wait until it has built itself unless it is not expected to."""
        self.visit(f"{path.as_uri()}#{fragment}", ready=ready)

    def leave(self) -> None:
        """Show a blank page."""
        self.call("Page.navigate", url="about:blank")
        self.wait("location.href === 'about:blank'")

    def visit(self, address: str, *, ready: bool = True) -> None:
        """The same, of an address."""
        path = urlparse(address).path
        here = f"location.pathname === {json.dumps(path)}"
        if self.run(here):  # another fragment of the address that is shown loads nothing
            self.leave()
        self.call("Page.navigate", url=address)
        # the page before it is complete too
        self.wait(f"{here} && document.readyState === 'complete'")
        if ready:
            self.wait("document.documentElement.dataset.ready")
        # in the size that was asked for, and what follows from it drawn
        self.wait(self._sized)
        self.run(f"document.hidden || {NEXT}")

    def size(self, width: int, height: int, *, mobile: bool = False, ratio: float = 1) -> None:
        size = {"width": width, "height": height, "mobile": mobile, "deviceScaleFactor": ratio}
        if size == self._size:
            return
        screen = {"screenWidth": width, "screenHeight": height}
        self.call("Emulation.setDeviceMetricsOverride", **size, **screen)
        self.call("Emulation.setTouchEmulationEnabled", enabled=mobile)
        self._sized = (
            f"screen.width === {width} && screen.height === {height}"
            f" && devicePixelRatio === {ratio}"
        )
        self.wait(self._sized)  # the next page shall not be built in the size of this one
        self._size = size

    def dark(self, on: bool) -> None:
        value = "dark" if on else "light"
        features = [{"name": "prefers-color-scheme", "value": value}]
        self.call("Emulation.setEmulatedMedia", features=features)

    def key(self, key: str, *, shift: bool = False) -> None:
        for kind in ("keyDown", "keyUp"):
            self.call(
                "Input.dispatchKeyEvent",
                type=kind,
                key=key,
                text=key if kind == "keyDown" and len(key) == 1 else "",
                modifiers=8 if shift else 0,
            )

    def mouse(self, kind: str, x: float, y: float, **more: Any) -> None:
        self.call("Input.dispatchMouseEvent", type=kind, x=x, y=y, **more)

    def touch(self, kind: str, *points: tuple[float, float]) -> None:
        places = [{"x": x, "y": y} for x, y in points]
        self.call("Input.dispatchTouchEvent", type=kind, touchPoints=places)

    def hold(self, key: str, *, down: bool) -> None:
        """Press a key, or let it go."""
        self.call("Input.dispatchKeyEvent", type="keyDown" if down else "keyUp", key=key)

    def picture(self, path: Path | None = None, *, whole: bool = False) -> bytes:
        shot = self.call("Page.captureScreenshot", format="png", captureBeyondViewport=whole)
        png = base64.b64decode(shot["data"])
        if path:
            path.write_bytes(png)
        return png

    def close(self) -> None:
        self._browser.call("Target.closeTarget", {"targetId": self._target})


class Browser:
    """Chromium and the connection to it; one thread only."""

    def __init__(self, program: str, profile: Path) -> None:
        from websockets.sync.client import connect

        self._closing = ExitStack()
        self._process = subprocess.Popen(
            [program, *FLAGS, f"--user-data-dir={profile}", "about:blank"],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        try:
            address = self._address(profile / "DevToolsActivePort")
            self._socket = self._closing.enter_context(
                connect(address, max_size=None, compression=None)
            )
        except BaseException:
            self._process.kill()
            raise
        self._count = 0
        self._tabs: dict[str, Tab] = {}

    def _address(self, file: Path) -> str:
        end = time.monotonic() + _PATIENCE
        while time.monotonic() < end and self._process.poll() is None:
            lines = file.read_text().split() if file.exists() else []
            if len(lines) == 2:
                return f"ws://127.0.0.1:{lines[0]}{lines[1]}"
            time.sleep(0.05)
        raise RuntimeError(f"Chromium did not start (exit status {self._process.poll()})")

    def call(
        self, method: str, parameters: dict[str, Any], session: str | None = None
    ) -> dict[str, Any]:
        self._count += 1
        message = {"id": self._count, "method": method, "params": parameters}
        if session:
            message["sessionId"] = session
        self._socket.send(json.dumps(message))
        while True:
            answer = json.loads(self._socket.recv(timeout=_PATIENCE))
            if answer.get("id") == self._count:
                assert "error" not in answer, f"{method}: {answer['error']}"
                return dict(answer["result"])
            tab = self._tabs.get(answer.get("sessionId", ""))
            if tab and "method" in answer:
                tab.hear(answer["method"], answer["params"])

    def tab(self) -> Tab:
        target = self.call("Target.createTarget", {"url": "about:blank"})["targetId"]
        attached = self.call("Target.attachToTarget", {"targetId": target, "flatten": True})
        session = attached["sessionId"]
        tab = self._tabs[session] = Tab(self, target, session)
        for domain in ("Page", "Runtime", "Log", "Network"):
            tab.call(f"{domain}.enable")
        return tab

    def close(self) -> None:
        try:
            self.call("Browser.close", {})
            self._closing.close()
            self._process.wait(10)
        except Exception:  # whatever it dies of, it must not outlive the tests
            self._process.kill()
            self._process.wait(10)
