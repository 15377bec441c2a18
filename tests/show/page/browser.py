"""A headless Chromium, driven by its DevTools protocol."""

import base64
import contextlib
import json
import os
import shutil
import subprocess
import time
import urllib.request

NAMES = ("chromium", "chromium-browser", "google-chrome")
OPTIONS = (
    "--headless=new", "--no-sandbox", "--remote-debugging-port=0", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
    "--remote-allow-origins=*", "--window-size=900,900", "--no-first-run", "--disable-extensions", "--hide-scrollbars",
)  # fmt: skip


def found():
    """The browser's command, or None."""
    return next((path for name in NAMES if (path := shutil.which(name))), None)


FAINT = """
(() => {
  const numbers = (color) => color.match(/[\\d.]+/g).map(Number);
  const luminance = ([r, g, b]) => [r, g, b].map((v) => v / 255).map((v) => v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4)
    .reduce((sum, v, k) => sum + v * [0.2126, 0.7152, 0.0722][k], 0);
  const over = ([r, g, b, a = 1], below) => [r, g, b].map((v, k) => a * v + (1 - a) * below[k]);
  const behind = (element) => element ? over(numbers(getComputedStyle(element).backgroundColor), behind(element.parentElement)) : [255, 255, 255];
  const texts = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT), faint = [];
  while (texts.nextNode()) {
    const text = texts.currentNode.textContent.trim(), element = texts.currentNode.parentElement;
    if (!text || !element.checkVisibility({visibilityProperty: true, opacityProperty: true}) || element.closest(":disabled, script, style")) continue;
    const style = getComputedStyle(element), below = behind(element);
    const [high, low] = [luminance(over(numbers(style.color), below)), luminance(below)].sort((a, b) => b - a);
    const large = parseFloat(style.fontSize) >= (style.fontWeight >= 700 ? 18.66 : 24), ratio = (high + 0.05) / (low + 0.05);
    if (ratio < (large ? 3 : 4.5)) faint.push([text.slice(0, 40), Math.round(100 * ratio) / 100]);
  }
  return faint;
})()
"""
"""Finds texts whose contrast with their background is below that of WCAG 2.1, level AA."""

OVERLAPS = """
(() => {
  const texts = [...document.querySelectorAll("svg")].map((svg) => [...svg.querySelectorAll("text")]
    .map((text) => [text.textContent, text.getBoundingClientRect()]).filter(([, box]) => box.width));
  const found = [];
  for (const own of texts) own.forEach(([text, p], k) => own.slice(0, k).forEach(([other, q]) => {
    const across = Math.min(p.right, q.right) - Math.max(p.left, q.left), down = Math.min(p.bottom, q.bottom) - Math.max(p.top, q.top);
    if (across > 1 && down > 3) found.push([other, text]);
  }));
  return found;
})()
"""
"""Finds pairs of labels of one drawing (SVG) that cover each other."""

SPLIT = """
[...document.querySelectorAll("td")].flatMap((cell) => {
  const texts = document.createTreeWalker(cell, NodeFilter.SHOW_TEXT), found = [], range = document.createRange();
  while (texts.nextNode()) for (const { 0: number, index } of texts.currentNode.textContent.matchAll(/\\d+\\.\\d+/g)) {
    range.setStart(texts.currentNode, index); range.setEnd(texts.currentNode, index + number.length);
    if (new Set([...range.getClientRects()].map((box) => box.top)).size > 1) found.push(number);
  }
  return found;
})
"""
"""Finds numbers of tables that are broken over two lines."""

COVERED_NAMES = """
(() => {
  const shown = [...document.querySelectorAll(".viewer .name:not(.tip), .viewer .legend")].filter((one) => one.checkVisibility());
  const boxes = shown.map((one) => [one.textContent, one.getBoundingClientRect()]);
  return boxes.flatMap(([text, p], k) => boxes.slice(0, k).filter(([, q]) => p.left < q.right && q.left < p.right && p.top < q.bottom && q.top < p.bottom)
    .map(([other]) => [text, other]));
})()
"""
"""Finds pairs of names of a picture that cover each other."""


class Tab:
    """A page in a browser: its console, scripts run in it, pictures of it."""

    def __init__(self, socket):
        self.socket, self.number, self.errors, self.requests = socket, 0, [], []
        for domain in ("Page", "Runtime", "Log", "Network"):
            self.do(f"{domain}.enable")

    def do(self, method, **parameters):
        self.number += 1
        self.socket.send(json.dumps({"id": self.number, "method": method, "params": parameters}))
        while True:
            message = json.loads(self.socket.recv())
            if message.get("id") == self.number:
                assert "error" not in message, message
                return message["result"]
            self._heard(message)

    def _heard(self, message):
        parameters = message.get("params", {})
        match message.get("method"):
            case "Runtime.exceptionThrown":
                self.errors.append(
                    parameters["exceptionDetails"].get("exception", {}).get("description", str(parameters))
                )
            case "Runtime.consoleAPICalled" if parameters["type"] in ("error", "warning"):
                self.errors.append(str(parameters["args"]))
            case "Log.entryAdded" if parameters["entry"]["level"] == "error":
                self.errors.append(parameters["entry"]["text"])
            case "Network.requestWillBeSent":
                self.requests.append(parameters["request"]["url"])

    def run(self, script):
        """The value of an expression, awaited."""
        found = self.do("Runtime.evaluate", expression=script, awaitPromise=True, returnByValue=True)
        assert "exceptionDetails" not in found, found["exceptionDetails"]
        return found["result"].get("value")

    def open(self, path):
        """Open a file; returns the seconds until its mechanism is drawn."""
        begun = time.monotonic()
        self.do("Page.navigate", url=f"file://{path}")
        self.wait("window.shown && shown.frames > 0")
        return time.monotonic() - begun

    def wait(self, condition, patience=60.0):
        """Wait until a script says yes."""
        end = time.monotonic() + patience
        while not self.run(f"Boolean({condition})"):
            assert time.monotonic() < end, (condition, self.errors)
            time.sleep(0.02)

    def picture(self, whole=False):
        """A screenshot, PNG."""
        content = self.do("Page.captureScreenshot", format="png", captureBeyondViewport=whole)["data"]
        return base64.b64decode(content)

    def key(self, key, code="", text="", number=0):
        """Press and release a key; its number makes the browser do what it does by default, 9 for Tab."""
        for kind in ("keyDown", "keyUp"):
            text = text if kind == "keyDown" else ""
            self.do(
                "Input.dispatchKeyEvent", type=kind, key=key, code=code or key, text=text, windowsVirtualKeyCode=number
            )

    def drag(self, start, end):
        """Press at a point, move to another, let go."""
        points = (("mousePressed", start), ("mouseMoved", start), ("mouseMoved", end), ("mouseReleased", end))
        for kind, (x, y) in points:
            self.do("Input.dispatchMouseEvent", type=kind, x=x, y=y, button="left", buttons=1, clickCount=1)


@contextlib.contextmanager
def tab(folder):
    """A page of a browser that lives as long as this does."""
    import websocket

    command = [found(), *OPTIONS, f"--user-data-dir={folder}", "about:blank"]
    browser = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True)
    try:
        told = folder / "DevToolsActivePort"
        end = time.monotonic() + 60
        while not (told.exists() and told.read_text().count("\n")):
            assert browser.poll() is None and time.monotonic() < end, "the browser did not start"
            time.sleep(0.05)
        port = told.read_text().split()[0]
        with urllib.request.urlopen(f"http://127.0.0.1:{port}/json") as answer:
            address = next(page for page in json.load(answer) if page["type"] == "page")["webSocketDebuggerUrl"]
        socket = websocket.create_connection(address, timeout=120, suppress_origin=True)
        yield Tab(socket)
        socket.close()
    finally:
        with contextlib.suppress(ProcessLookupError):
            os.killpg(browser.pid, 15)
        browser.wait()
