"""What a browser says of the pages of the site: width, messages, formulas, pictures.

Opens pages by headless Chromium at widths of a desk and of a telephone. A fault is a page wider
than the window, a message on the console, a formula that is not typeset, or a picture without an
alternative text. Needs tornado, which the virtual environment of Sphinx has::

    tools/docs --look [PAGE…]
"""

from __future__ import annotations

import asyncio
import json
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from tornado.websocket import WebSocketClientConnection, websocket_connect

WIDTHS = 1280, 390
"""Widths of the window, in CSS pixels."""

DRIVER = "GL Driver Message"
"""Of the software that draws without a graphics card, not of a page."""

MEASURE = """
(() => {
  const root = document.documentElement;
  const out = [];
  if (root.scrollWidth > innerWidth + 1) {
    const wide = [...document.querySelectorAll("article *")].filter(
      (e) => e.getBoundingClientRect().right > innerWidth + 1
    );
    const first = wide.find((e) => !e.closest(".table-wrapper, .highlight, mjx-container"));
    const label = first ? first.tagName + " " + first.textContent.slice(0, 50) : "";
    out.push(`${root.scrollWidth} pixels wide: ${label}`);
  }
  const raw = document.querySelectorAll(".math").length;
  const set = document.querySelectorAll("mjx-container").length;
  if (set < raw) out.push(`${raw - set} formulas of ${raw} are not typeset`);
  const failed = document.querySelectorAll("mjx-merror, [data-mjx-error]").length;
  if (failed) out.push(`${failed} formulas have errors`);
  const silent = [...document.querySelectorAll("img")].filter((e) => !e.alt).length;
  if (silent) out.push(`${silent} pictures have no alternative text`);
  return out;
})()
"""

TYPESET = "window.MathJax?.startup?.promise?.then(() => 0) ?? 0"


class Browser:
    """A page of a headless Chromium, driven by its DevTools protocol."""

    def __init__(self, socket: WebSocketClientConnection) -> None:
        """Talk through a connection.

        Args:
            socket: Connection to the page.
        """
        self._socket, self._count = socket, 0
        self.messages: list[str] = []

    async def receive(self) -> dict[str, Any]:
        """Return the next message, and keep what belongs to the console."""
        text = await self._socket.read_message()
        if text is None:
            raise RuntimeError("Chromium has closed the connection")
        message: dict[str, Any] = json.loads(text)
        method, given = message.get("method"), message.get("params", {})
        if method == "Runtime.exceptionThrown":
            self.messages.append(given["exceptionDetails"]["text"])
        elif method == "Runtime.consoleAPICalled":
            parts = [str(part.get("value", part.get("description"))) for part in given["args"]]
            self.messages.append(" ".join(parts))
        elif method == "Log.entryAdded" and DRIVER not in given["entry"]["text"]:
            self.messages.append(given["entry"]["text"])
        return message

    async def call(self, method: str, **given: Any) -> dict[str, Any]:
        """Call a method of the protocol and return its result."""
        self._count += 1
        number = self._count
        await self._socket.write_message(
            json.dumps({"id": number, "method": method, "params": given})
        )
        while True:
            message = await self.receive()
            if message.get("id") == number:
                return dict(message.get("result", {}))

    async def open(self, page: Path) -> None:
        """Load a page, and wait until its formulas are typeset."""
        await self.call("Page.navigate", url=page.as_uri())
        while (await self.receive()).get("method") != "Page.loadEventFired":
            pass
        await self.evaluate(TYPESET)

    async def evaluate(self, expression: str) -> Any:
        """Value of a JavaScript expression; a promise is awaited."""
        found = await self.call(
            "Runtime.evaluate", expression=expression, awaitPromise=True, returnByValue=True
        )
        return found["result"].get("value")

    async def faults(self, page: Path, width: int) -> list[str]:
        """Faults of a page at one width of the window."""
        await self.call(
            "Emulation.setDeviceMetricsOverride",
            width=width,
            height=900,
            deviceScaleFactor=1,
            mobile=False,
        )
        self.messages.clear()
        await self.open(page)
        found = await self.evaluate(MEASURE) or []
        return [*found, *(f"console: {text}" for text in self.messages)]


def start(profile: Path) -> tuple[subprocess.Popen[str], str]:
    """Start Chromium; return its process and the address of its first page.

    Args:
        profile: An empty folder.
    """
    program = shutil.which("chromium")
    if program is None:
        raise SystemExit("chromium is not installed")
    options = ["--headless=new", "--no-sandbox", "--disable-dev-shm-usage"]
    options += ["--use-angle=swiftshader", "--enable-unsafe-swiftshader"]
    options += ["--remote-debugging-port=0", f"--user-data-dir={profile}", "about:blank"]
    process = subprocess.Popen([program, *options], stderr=subprocess.PIPE, text=True)
    assert process.stderr is not None
    for line in process.stderr:
        if "DevTools listening on " in line:
            return process, line.split("listening on ")[1].strip()
    raise SystemExit("chromium did not start")


async def look(address: str, folder: Path, pages: Sequence[Path]) -> int:
    """Print the faults of all pages; return how many there are.

    Args:
        address: DevTools address of the browser.
        folder: The site.
        pages: Pages to open.
    """
    whole = Browser(await websocket_connect(address, max_message_size=2**26))
    target = (await whole.call("Target.createTarget", url="about:blank"))["targetId"]
    host = address.split("/devtools")[0]
    page_socket = await websocket_connect(f"{host}/devtools/page/{target}", max_message_size=2**26)
    browser = Browser(page_socket)
    for domain in ("Page", "Runtime", "Log"):
        await browser.call(f"{domain}.enable")
    count = 0
    for page in pages:
        for width in WIDTHS:
            for fault in await browser.faults(page, width):
                print(f"{page.relative_to(folder)} at {width}: {fault}", flush=True)
                count += 1
    print(f"{len(pages)} pages at {WIDTHS}, {count} faults")
    return count


def main() -> None:
    """Look at the pages of a site; status 1 if there are faults."""
    folder = Path(sys.argv[1]).resolve()
    pages = [folder / name for name in sys.argv[2:]]
    pages = pages or sorted(p for p in folder.rglob("*.html") if "pages" not in p.parts)
    with tempfile.TemporaryDirectory() as profile:
        process, address = start(Path(profile))
        try:
            count = asyncio.run(look(address, folder, pages))
        finally:
            process.terminate()
            process.wait()
    sys.exit(bool(count))


if __name__ == "__main__":
    main()
