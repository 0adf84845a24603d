# SPDX-License-Identifier: BSD-3-Clause
"""What the dashboard costs: its page, its viewers, its charts. It needs Chromium (make develop).

    python bench/dashboard.py [--seconds 2] [--turns 8] [--only viewers|charts]

The robot has 18 values at 1 kHz, each a wave with noise. The board, `unitylink serve --page`, the program
that writes, the viewers and the browser are processes of their own. Phases without and with viewers take
turns, so that a change of the machine's load meets both.
"""

from __future__ import annotations

import argparse
import http.client
import json
import os
import statistics
import subprocess
import sys
import tempfile
import time
from contextlib import ExitStack
from pathlib import Path

from playwright.sync_api import sync_playwright

from unitylink.dashboard.page_files import page_files

VALUES, VIEWERS, CHARTS = 18, 16, 8
FLAGS = ["--no-sandbox", "--disable-gpu", "--disable-background-networking", "--disable-component-update"]
SPEC = (
    "public fast() {\n"
    + "\n".join(f"   @v{n} = {0x10 + n:#x}: i32 READ(PUBLISH(1000 Hz));" for n in range(VALUES))
    + "\n   @goal = 0x80: i32 WRITE(SAFE=0);\n}\n"
)
PLANT = f"""
import math, random
class Plant:
    period_s = 0.001
    def attach(self, spec, registers):
        self.registers, self.random = registers, random.Random(1)
        self.wave = [round(1000 * math.sin(2 * math.pi * k / 1000)) for k in range(1000)]
    def step(self, time_s):
        at = int(time_s * 1000)
        for n in range({VALUES}):
            self.registers[0x10 + n] = self.wave[at * (n + 1) // 4 % 1000] + at * 7919 % 61 & 0xffffffff
"""
WRITER = """
import sys, time, json
import unitylink
times, end = [], float(sys.argv[2])
with unitylink.connect(sys.argv[1]) as link:
    while time.monotonic() < end:
        began = time.monotonic()
        link.write(0x80, 1)
        times.append((began, time.monotonic() - began))
        time.sleep(0.002)
print(json.dumps(times))
"""
VIEWER = """
import asyncio, json, sys, time
from websockets.asyncio.client import connect
async def look(url, cookie, values, end):
    async with connect(url, additional_headers={"Cookie": cookie}, proxy=None, compression=None) as socket:
        hello = json.loads(await socket.recv())["hello"]
        series = [[item, 0.02, hello["now_s"]] for item in range(values)]
        await socket.send(json.dumps({"do": "view", "id": 1, "series": series}))
        while time.monotonic() < end:
            await socket.recv()
async def main(url, cookie, values, viewers, phases):
    for begin, end in phases:
        await asyncio.sleep(begin - time.monotonic())
        await asyncio.gather(*(look(url, cookie, values, end) for _ in range(viewers)))
asyncio.run(main(sys.argv[1], sys.argv[2], int(sys.argv[3]), int(sys.argv[4]), json.loads(sys.argv[5])))
"""
SETTLE_S = 0.4  # after a phase has begun, before it counts


def cookie(page: str, token: str) -> str:
    """Log in and return the cookie."""
    connection = http.client.HTTPConnection(page.partition("//")[2])
    connection.request("POST", "/login", json.dumps({"token": token}))
    answer = connection.getresponse()
    answer.read()
    connection.close()
    return str(answer.getheader("set-cookie")).partition(";")[0]


def processor_s(pid: int) -> float:
    fields = Path(f"/proc/{pid}/stat").read_text("ascii").rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def viewers(page: str, url: str, token: str, server: int, *, seconds: float, turns: int) -> dict[str, float]:
    """Return the share of a core that the server takes, and the time of a write, without and with viewers."""
    begin = time.monotonic() + 3
    starts = [begin + seconds * number for number in range(2 * turns)]
    phases = [(start, start + seconds) for start in starts[1::2]]
    environment = {**os.environ, "UNITYLINK_TOKEN": token}
    with ExitStack() as stack:
        writing = [sys.executable, "-c", WRITER, url, str(starts[-1] + seconds)]
        writer = stack.enter_context(
            subprocess.Popen(writing, stdout=subprocess.PIPE, text=True, env=environment)
        )
        looking = [sys.executable, "-c", VIEWER, page.replace("http", "ws") + "/socket", cookie(page, token)]
        looking += [str(VALUES), str(VIEWERS), json.dumps(phases)]
        stack.enter_context(subprocess.Popen(looking, stderr=subprocess.DEVNULL))
        used = []
        for start in starts:
            time.sleep(max(0.0, start + SETTLE_S - time.monotonic()))
            before, at = processor_s(server), time.monotonic()
            time.sleep(max(0.0, start + seconds - 0.05 - time.monotonic()))
            used.append((processor_s(server) - before) / (time.monotonic() - at))
        assert writer.stdout is not None
        times = json.loads(writer.stdout.readline())
    medians = [
        statistics.median(took for at, took in times if start + SETTLE_S <= at < start + seconds)
        for start in starts
    ]
    ratios = [after / before for before, after in zip(medians[::2], medians[1::2], strict=True)]
    return {
        "core of the server, no viewer": statistics.median(used[::2]),
        f"core of the server, {VIEWERS} viewers": statistics.median(used[1::2]),
        "write in µs, no viewer": statistics.median(medians[::2]) * 1e6,
        f"write in µs, {VIEWERS} viewers": statistics.median(medians[1::2]) * 1e6,
        "their ratio, median of the turns": statistics.median(ratios),
    }


def browser_s() -> float:
    """Return the processor time of the browser: of all processes below this one that have its name."""
    parents, names = {}, {}
    for stat in Path("/proc").glob("[0-9]*/stat"):
        try:
            text = stat.read_text("ascii", "replace")
        except OSError:  # it has just ended
            continue
        pid = int(stat.parent.name)
        names[pid] = text[text.index("(") + 1 : text.rindex(")")]
        parents[pid] = int(text.rpartition(")")[2].split()[1])

    def ours(pid: int) -> bool:
        while pid in parents:
            if pid == os.getpid():
                return True
            pid = parents[pid]
        return False

    return sum(processor_s(pid) for pid, name in names.items() if name.startswith("chrom") and ours(pid))


def charts(page: str, token: str, seconds: float) -> dict[str, float]:
    """Return how often CHARTS charts are drawn a second in headless Chromium, and when the page is there.

    The window is so large that all of them are seen, because the others are not drawn.
    """
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path="/usr/bin/chromium", args=FLAGS)
        try:
            tab = browser.new_page(viewport={"width": 1920, "height": 1700})
            layout = ";".join(f"v{number}/10" for number in range(CHARTS))
            tab.add_init_script(
                "window.draws = 0; const before = CanvasRenderingContext2D.prototype.clearRect;"
                "CanvasRenderingContext2D.prototype.clearRect = function (...all) {"
                " window.draws++; return before.apply(this, all); };"
            )
            tab.goto(f"{page}/#charts={layout}&token={token}")
            tab.wait_for_selector(".chart canvas")
            paint_ms = tab.evaluate(
                "performance.getEntriesByName('first-contentful-paint')[0]?.startTime ?? NaN"
            )
            tab.wait_for_timeout(5000)
            first, used_s = tab.evaluate("window.draws"), browser_s()
            began = time.perf_counter()
            tab.wait_for_timeout(seconds * 1000)
            drawn = (tab.evaluate("window.draws") - first) / CHARTS
            used_s, took_s = browser_s() - used_s, time.perf_counter() - began
            return {
                "draws of each chart a second": drawn / took_s,
                "browser, ms of a core for each draw": 1000 * used_s / drawn,
                "first paint in ms": paint_ms,
            }
        finally:
            browser.close()


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--seconds", type=float, default=2.0, help="of each phase")
    parser.add_argument("--turns", type=int, default=8)
    parser.add_argument("--only", choices=("viewers", "charts"))
    options = parser.parse_args()
    found: dict[str, float] = {
        "page in kB over the wire": sum(len(one.small) for one in page_files().values()) / 1000
    }
    load = [os.getloadavg()[0]]
    with tempfile.TemporaryDirectory() as folder, ExitStack() as stack:
        file, plant = Path(folder) / "fast.ul", Path(folder) / "wave.py"
        file.write_text(SPEC)
        plant.write_text(PLANT)

        def run(*arguments: str) -> tuple[subprocess.Popen[str], dict[str, object]]:
            command = [sys.executable, "-m", "unitylink", *arguments, "--json"]
            quiet = subprocess.DEVNULL
            running = stack.enter_context(
                subprocess.Popen(command, stdout=subprocess.PIPE, stderr=quiet, text=True, cwd=folder)
            )
            stack.callback(running.terminate)
            assert running.stdout is not None
            return running, json.loads(running.stdout.readline())

        _, board = run("simulate", str(file), "--plant", str(plant), "--tcp", "0")
        serving = ("serve", str(board["url"]), str(file), "--listen", "127.0.0.1:0", "--page", "0")
        server, told = run(*serving)
        page, token, urls = str(told["page"]), str(told["token"]), told["urls"]
        assert isinstance(urls, dict)
        time.sleep(1)
        if options.only != "charts":
            found |= viewers(
                page, urls["fast"], token, server.pid, seconds=options.seconds, turns=options.turns
            )
        if options.only != "viewers":
            found |= charts(page, token, 4 * options.seconds)
    for name, value in found.items():
        print(f"{name:<36} {value:10.3g}")
    print(f"load of the machine {load[0]:.1f} at the beginning, {os.getloadavg()[0]:.1f} at the end")


if __name__ == "__main__":
    main()
