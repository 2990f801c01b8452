"""A headless Chromium, told what to do over a pipe (DevTools protocol): real time, real mouse."""

from __future__ import annotations

import base64
import json
import os
import shlex
import shutil
import subprocess
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

CHROMIUM = next((path for name in ("chromium", "chromium-browser", "google-chrome") if (path := shutil.which(name))), None)
OPTIONS = (
    "--headless", "--no-sandbox", "--disable-gpu", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--disable-quic",
    "--no-first-run", "--disable-background-networking", "--disable-component-update", "--disable-sync", "--hide-scrollbars",
    "--disable-dev-shm-usage", "--remote-debugging-pipe", "about:blank",
)  # fmt: skip
HARMLESS = ("willReadFrequently", "GL Driver Message")
"""Notes on speed, of software rendering."""


class Tab:
    """One page.

    Parameters
    ----------
    send, receive : binary files
        The pipe.
    """

    def __init__(self, send: Any, receive: Any) -> None:
        self._send, self._receive, self._last, self._session = send, receive, 0, None
        self.complaints: list[str] = []
        target = self.ask("Target.createTarget", url="about:blank")["targetId"]
        self._session = self.ask("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        for domain in ("Page", "Runtime", "Log", "Network"):
            self.ask(f"{domain}.enable")
        self.screen()

    def ask(self, method: str, **parameters: Any) -> dict[str, Any]:
        """Send a command and wait for its answer; what the page complains of meanwhile is kept."""
        self._last += 1
        message = {"id": self._last, "method": method, "params": parameters}
        if self._session is not None:
            message["sessionId"] = self._session
        self._send.write(json.dumps(message).encode() + b"\0")
        self._send.flush()
        while True:
            answer = self._next()
            if answer.get("id") == self._last:
                if "error" in answer:
                    raise RuntimeError(f"{method}: {answer['error']}")
                return answer["result"]

    def _next(self) -> dict[str, Any]:
        data = bytearray()
        while (byte := self._receive.read(1)) != b"\0":
            if not byte:
                raise RuntimeError("the browser has gone")
            data += byte
        message = json.loads(data)
        method, told = message.get("method", ""), message.get("params", {})
        if method == "Runtime.exceptionThrown":
            self.complaints.append(str(told["exceptionDetails"]))
        elif method == "Runtime.consoleAPICalled" and told["type"] in ("error", "warning", "assert"):
            self.complaints.append(str(told["args"]))
        elif method == "Log.entryAdded" and not any(word in told["entry"]["text"] for word in HARMLESS):
            self.complaints.append(told["entry"]["text"])
        elif method == "Network.requestWillBeSent" and not told["request"]["url"].startswith(("file:", "data:", "blob:")):
            self.complaints.append(f"asks for {told['request']['url']}")
        return message

    def open(self, file: Path) -> None:
        """Load a file."""
        self.ask("Page.navigate", url=file.as_uri())
        self.run("new Promise(done => document.readyState === 'complete' ? done() : addEventListener('load', () => done()))")

    def open_drawn(self, file: Path) -> bool:
        """Load a page and wait for its 3-D view; False where this browser has no WebGL."""
        self.open(file)
        if not self.run("document.documentElement.classList.contains('drawn')"):
            return False
        for _ in range(300):
            if self.run("document.getElementById('view').dataset.ready") == "yes":
                self.frames(5)
                return True
            self.frames(2)
        raise RuntimeError("the 3-D view was never drawn")

    def run(self, code: str) -> Any:
        """Value of an expression; promises are waited for."""
        answer = self.ask("Runtime.evaluate", expression=code, awaitPromise=True, returnByValue=True)
        if "exceptionDetails" in answer:
            raise RuntimeError(str(answer["exceptionDetails"]))
        return answer["result"].get("value")

    def mouse(self, kind: str, x: float, y: float, **more: Any) -> None:
        """mouseMoved, mousePressed, mouseReleased, mouseWheel at a place in the window."""
        self.ask("Input.dispatchMouseEvent", type=kind, x=x, y=y, **more)

    def drag(self, places: Sequence[tuple[float, float]], **more: Any) -> None:
        """Press at the first of these places, move over the others, and release at the last."""
        self.mouse("mousePressed", *places[0], button="left", buttons=1, clickCount=1, **more)
        for place in places[1:]:
            self.mouse("mouseMoved", *place, button="left", buttons=1, **more)
            self.frames(1)
        self.mouse("mouseReleased", *places[-1], button="left", buttons=0, clickCount=1, **more)
        self.frames(4)

    def touch(self, *steps: Sequence[tuple[float, float]]) -> None:
        """Fingers at these places, step by step, and lifted."""
        for kind, places in zip(["touchStart", *["touchMove"] * (len(steps) - 1), "touchEnd"], [*steps, ()], strict=True):
            points = [{"x": x, "y": y, "id": number} for number, (x, y) in enumerate(places)]
            self.ask("Input.dispatchTouchEvent", type=kind, touchPoints=points)
            self.frames(1)
        self.frames(4)

    def key(self, key: str) -> None:
        """Press and release a key of the keyboard."""
        text = {"text": key} if len(key) == 1 else {}
        self.ask("Input.dispatchKeyEvent", type="keyDown", key=key, **text)
        self.ask("Input.dispatchKeyEvent", type="keyUp", key=key)
        self.frames(4)

    def screen(self, width: int = 1280, height: int = 900, density: float = 1.0, mobile: bool = False) -> None:
        """The size of the window, CSS pixels, and device pixels for each."""
        self.ask("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=density, mobile=mobile)

    def frames(self, count: int) -> None:
        """Let so many frames be drawn."""
        self.run(f"(async () => {{ for (let i = 0; i < {count}; i++) await new Promise(requestAnimationFrame); }})()")

    def picture(self, x: float, y: float, width: float, height: float) -> bytes:
        """PNG of a part of the window."""
        clip = {"x": x, "y": y, "width": width, "height": height, "scale": 1}
        return base64.b64decode(self.ask("Page.captureScreenshot", format="png", clip=clip)["data"])


@contextmanager
def browser(folder: Path) -> Iterator[Tab]:
    """A fresh browser with a profile in `folder`, ended with the block."""
    assert CHROMIUM is not None
    theirs_in, ours_out = os.pipe()
    ours_in, theirs_out = os.pipe()
    command = shlex.join([CHROMIUM, *OPTIONS, f"--user-data-dir={folder}"])
    script = f"exec {command} 3<&{theirs_in} 4>&{theirs_out}"
    with open(folder / "log", "wb") as log:
        process = subprocess.Popen(["bash", "-c", script], pass_fds=(theirs_in, theirs_out), stdout=log, stderr=log)
    os.close(theirs_in)
    os.close(theirs_out)
    with os.fdopen(ours_out, "wb") as send, os.fdopen(ours_in, "rb") as receive:
        try:
            yield Tab(send, receive)
        finally:
            process.terminate()
            process.wait(20)
