# SPDX-License-Identifier: BSD-3-Clause
"""What the dashboard costs: its page, its viewers, its charts. It needs Chromium (make develop).

    python bench/dashboard.py [--seconds 10]

The robot has 18 values at 1 kHz, on a virtual board in a process of its own.
"""

from __future__ import annotations

import argparse
import http.client
import json
import os
import resource
import statistics
import subprocess
import sys
import tempfile
import time
from contextlib import ExitStack
from pathlib import Path

from playwright.sync_api import sync_playwright

from unitylink import Link, connect
from unitylink.dashboard.opening import open_dashboard
from unitylink.dashboard.page_files import page_files
from unitylink.dashboard.server import Dashboard
from unitylink.server.scopes import Rights
from unitylink.server.tokens import Tokens, User, digest
from unitylink.spec import load

VALUES, VIEWERS, CHARTS = 18, 16, 8
FLAGS = ["--no-sandbox", "--disable-gpu", "--disable-background-networking", "--disable-component-update"]
SPEC = (
    "public fast() {\n"
    + "\n".join(f"   @v{n} = {0x10 + n:#x}: i32 READ(PUBLISH(1000 Hz));" for n in range(VALUES))
    + "\n   @goal = 0x80: i32 WRITE(SAFE=0);\n}\n"
)


def cookie(page: Dashboard) -> str:
    """Log in and return the cookie."""
    connection = http.client.HTTPConnection(page.url.partition("//")[2])
    connection.request("POST", "/login", json.dumps({"token": "bench"}))
    answer = connection.getresponse()
    answer.read()
    connection.close()
    return str(answer.getheader("set-cookie")).partition(";")[0]


def processor_s() -> float:
    used = resource.getrusage(resource.RUSAGE_SELF)
    return used.ru_utime + used.ru_stime


def writes_us(link: Link, seconds: float) -> float:
    """Return the median time of a confirmed write, in µs."""
    times, end = [], time.perf_counter() + seconds
    while time.perf_counter() < end:
        began = time.perf_counter()
        link.write(0x80, 1)
        times.append(time.perf_counter() - began)
        time.sleep(0.002)
    return statistics.median(times) * 1e6


VIEWER = """
import asyncio, json, sys
from websockets.asyncio.client import connect
async def look(url, cookie, values):
    async with connect(url, additional_headers={"Cookie": cookie}, proxy=None, compression=None) as socket:
        hello = json.loads(await socket.recv())["hello"]
        series = [[item, 0.02, hello["now_s"]] for item in range(values)]
        await socket.send(json.dumps({"do": "view", "id": 1, "series": series}))
        while True:
            await socket.recv()
async def main(url, cookie, values, viewers):
    await asyncio.gather(*(look(url, cookie, values) for _ in range(viewers)))
asyncio.run(main(sys.argv[1], sys.argv[2], int(sys.argv[3]), int(sys.argv[4])))
"""


def viewers(page: Dashboard, link: Link, seconds: float) -> dict[str, float]:
    """Return the share of a core that no viewer and VIEWERS viewers take, and the time of a write then."""
    found: dict[str, float] = {}
    url = page.url.replace("http", "ws") + "/socket"
    for number in (0, VIEWERS):
        with ExitStack() as stack:
            if number:
                command = [sys.executable, "-c", VIEWER, url, cookie(page), str(VALUES), str(number)]
                running = stack.enter_context(subprocess.Popen(command, stderr=subprocess.DEVNULL))
                stack.callback(running.terminate)
                while len(page.station.viewers) < number:
                    time.sleep(0.05)
                time.sleep(1)
            before, began = processor_s(), time.perf_counter()
            time.sleep(seconds)
            found[f"core with {number} viewers"] = (processor_s() - before) / (time.perf_counter() - began)
            found[f"write in µs with {number} viewers"] = writes_us(link, seconds / 2)
    return found


def charts(page: Dashboard, seconds: float) -> dict[str, float]:
    """Return how often CHARTS charts are drawn a second in headless Chromium, and when the page is there."""
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path="/usr/bin/chromium", args=FLAGS)
        try:
            tab = browser.new_page(viewport={"width": 1400, "height": 1000})
            layout = ";".join(f"v{number}/10" for number in range(CHARTS))
            tab.add_init_script(
                "window.draws = 0; const before = CanvasRenderingContext2D.prototype.clearRect;"
                "CanvasRenderingContext2D.prototype.clearRect = function (...all) {"
                " window.draws++; return before.apply(this, all); };"
            )
            tab.goto(f"{page.url}/#charts={layout}&token=bench")
            tab.wait_for_selector(".chart canvas")
            paint_ms = tab.evaluate(
                "performance.getEntriesByName('first-contentful-paint')[0]?.startTime ?? NaN"
            )
            tab.wait_for_timeout(5000)
            first = tab.evaluate("window.draws")
            began = time.perf_counter()
            tab.wait_for_timeout(seconds * 1000)
            drawn = tab.evaluate("window.draws") - first
            each = drawn / CHARTS / (time.perf_counter() - began)
            return {"draws of each chart a second": each, "first paint in ms": paint_ms}
        finally:
            browser.close()


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--seconds", type=float, default=10.0)
    seconds = parser.parse_args().seconds
    found: dict[str, float] = {
        "page in kB over the wire": sum(len(one.small) for one in page_files().values()) / 1000
    }
    with tempfile.TemporaryDirectory() as folder, ExitStack() as stack:
        file = Path(folder) / "fast.ul"
        file.write_text(SPEC)
        command = [sys.executable, "-m", "unitylink", "simulate", str(file), "--tcp", "0", "--json"]
        board = stack.enter_context(subprocess.Popen(command, stdout=subprocess.PIPE, text=True))
        stack.callback(board.terminate)
        assert board.stdout is not None
        link = stack.enter_context(connect(json.loads(board.stdout.readline())["url"]))
        tokens = Tokens([(digest("bench"), User("bench", Rights.of(["admin"])))])
        page = stack.enter_context(open_dashboard(link, load(file), tokens, lambda _: None))
        time.sleep(1)
        found |= viewers(page, link, seconds)
        found |= charts(page, seconds)
    for name, value in found.items():
        print(f"{name:<34} {value:10.3g}")
    print(f"load of the machine {os.getloadavg()[0]:.1f}")


if __name__ == "__main__":
    main()
