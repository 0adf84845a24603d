# SPDX-License-Identifier: BSD-3-Clause
"""An hour of a stream, as fast as the page takes it. Memory stays flat, in the page and the server."""

from __future__ import annotations

import tracemalloc
from pathlib import Path

import numpy as np
import pytest
from playwright.sync_api import Browser, Page, Route

from unitylink.dashboard.history import CAPACITY, History
from unitylink.dashboard.page_files import page_files

VALUES, CHARTS = 18, 8
FRAME_S = 1 / 30
SERVER = (Path(__file__).parent / "hour.js").read_text("utf-8")


def heap_bytes(page: Page) -> float:
    """Return what the page holds in memory, after its garbage has been collected."""
    session = page.context.new_cdp_session(page)
    session.send("HeapProfiler.collectGarbage")
    used: float = session.send("Runtime.getHeapUsage")["usedSize"]
    session.detach()
    return used


def answer(route: Route) -> None:
    """Send a file of the page."""
    name = route.request.url.rpartition("/")[2].partition("#")[0] or "index.html"
    file = page_files()[name]
    route.fulfill(body=file.plain, content_type=file.kind)


@pytest.mark.parametrize("minutes", [6, pytest.param(60, marks=pytest.mark.long)])
def test_the_memory_of_the_page_is_flat(browser: Browser, minutes: int) -> None:
    context = browser.new_context(viewport={"width": 1920, "height": 1700})
    try:
        page = context.new_page()
        wrong: list[str] = []
        page.on("pageerror", lambda error: wrong.append(str(error)))
        page.route("http://page.test/**", answer)
        page.add_init_script(f"({SERVER})([{VALUES}, {FRAME_S}])")
        layout = ";".join(f"v{number},v{number + 8}/10" for number in range(CHARTS))
        page.goto(f"http://page.test/#charts={layout}")
        page.get_by_role("heading", name="arm").wait_for()
        page.evaluate("play(120)")
        before = heap_bytes(page)
        parts = 3
        after = []
        for _ in range(parts):
            played = page.evaluate(f"play({60 * minutes / parts})")
            after.append(heap_bytes(page))
        assert played == pytest.approx(120 + 60 * minutes, rel=0.01)
        assert max(after) - before < 1_500_000, [before, *after]
        assert page.get_by_role("region", name="chart of v0, v8").locator("canvas").is_visible()
        assert not wrong
    finally:
        context.close()


@pytest.mark.parametrize("minutes", [6, pytest.param(60, marks=pytest.mark.long)])
def test_the_memory_of_a_history_is_flat(minutes: int) -> None:
    """One item at 1 kHz. All its memory is taken before the stream begins."""
    history = History()
    portion = np.arange(CAPACITY // 2) / 1000
    history.add(portion, portion)
    tracemalloc.start()
    try:
        before, _ = tracemalloc.get_traced_memory()
        for number in range(1, 60_000 * minutes // len(portion)):
            history.add(portion + number * len(portion) / 1000, portion)
        after, _ = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert after - before < 20_000
    newest = history.newest()
    assert newest is not None and newest[0] > 60 * minutes - 20
