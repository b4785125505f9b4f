"""The viewer in a browser: the picture is there, at desktop and phone width, and nothing is asked of the internet."""

import asyncio
import base64
import io
import json
import os
import shutil
import signal
import subprocess
import sys
import time
import urllib.request

import numpy as np
import pytest

pytest.importorskip("tornado")
Image = pytest.importorskip("PIL.Image")

CHROMIUM = shutil.which("chromium")
FLAGS = (
    "--headless",
    "--no-sandbox",
    "--no-first-run",
    "--use-gl=angle",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--remote-debugging-port=0",
)
PATIENCE = 100.0  # seconds; without a graphics card and on a busy machine the viewer is slow


class Page:
    """A page of a browser, spoken to by its debugging protocol."""

    def __init__(self, socket):
        self.socket, self.count, self.asked = socket, 0, {}

    async def call(self, method, **params):
        self.count += 1
        await self.socket.write_message(json.dumps({"id": self.count, "method": method, "params": params}))
        while True:
            answer = json.loads(await self.socket.read_message())
            self.note(answer.get("method"), answer.get("params", {}))
            if answer.get("id") == self.count:
                return answer.get("result", {})

    def note(self, event, params):
        """Note what the page asks for, and forget what its policy did not let out."""
        if event == "Network.requestWillBeSent":
            self.asked[params["requestId"]] = params["request"]["url"]
        elif event == "Network.loadingFailed" and params.get("blockedReason") == "csp":
            del self.asked[params["requestId"]]

    async def picture(self, width, height):
        """Grey values of the upper left of the page, where the tissue is."""
        await self.call(
            "Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=False
        )
        shot = await self.call("Page.captureScreenshot", format="png")
        if "data" not in shot:
            return np.full((1, 1), 255)
        pixels = np.asarray(Image.open(io.BytesIO(base64.b64decode(shot["data"]))).convert("L"))
        return pixels[120 : height // 3, width // 20 : width // 2]


async def look(debugger, address, sizes):
    """Pictures of a page at some sizes, each as soon as there is something dark and bright on it."""
    from tornado.websocket import websocket_connect

    page = Page(await websocket_connect(debugger, max_message_size=2**28))
    await page.call("Network.enable")
    await page.call("Page.navigate", url=address)
    found, end = [], time.monotonic() + PATIENCE
    for size in sizes:
        while True:
            pixels = await page.picture(*size)
            if time.monotonic() > end or ((pixels < 100).mean() > 0.02 and (pixels > 200).mean() > 0.05):
                break
            await asyncio.sleep(0.3)
        found.append(pixels)
    page.socket.close()
    while await page.socket.read_message() is not None:
        pass
    return found, list(page.asked.values())


@pytest.mark.slow
@pytest.mark.skipif(CHROMIUM is None, reason="needs Chromium")
def test_the_tissue_is_on_the_screen_and_nobody_else_is_asked(tissue_run, tmp_path):
    command = [sys.executable, "-u", "-m", "vasculo", "view", str(tissue_run.folder), "--no-open"]
    profile = tmp_path / "profile"
    flags = [*FLAGS, f"--user-data-dir={profile}", "about:blank"]
    quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    with (
        subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as viewer,
        subprocess.Popen([CHROMIUM, *flags], env={**os.environ, "HOME": str(tmp_path)}, **quiet) as browser,
    ):
        try:
            address = viewer.stdout.readline().split(" at ")[1].strip()
            told = profile / "DevToolsActivePort"
            while not told.exists():
                time.sleep(0.1)
            port = int(told.read_text().splitlines()[0])
            with urllib.request.urlopen(f"http://127.0.0.1:{port}/json", timeout=60.0) as answer:
                target = next(page for page in json.load(answer) if page["type"] == "page")
            pictures, asked = asyncio.run(look(target["webSocketDebuggerUrl"], address, [(1200, 800), (390, 844)]))
        finally:
            for program in (viewer, browser):
                program.send_signal(signal.SIGTERM)
    for pixels in pictures:
        assert (pixels < 100).mean() > 0.02, "no springs"
        assert (pixels > 200).mean() > 0.05, "no paper"
        assert len(np.unique(pixels)) > 20
    assert any("re_viewer" in url for url in asked)
    assert [url for url in asked if not url.startswith((address, "data:", "blob:"))] == []
