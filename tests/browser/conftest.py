# SPDX-License-Identifier: BSD-3-Clause
"""One browser for the tests of a module, and pages of robots in it."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from playwright.sync_api import Browser, BrowserContext, Page, expect, sync_playwright
from unit.dashboard.robot import Robot, robot, simulated

from unitylink.dashboard.body.joint_values import with_values
from unitylink.dashboard.body.urdf import read_urdf
from unitylink.dashboard.extras import Extras
from unitylink.dashboard.shelf import Shelf
from unitylink.server.rate_limit import RateLimit
from unitylink.simulate import load_plant
from unitylink.spec import load

ROOT = Path(__file__).resolve().parents[2]
ARM = ROOT / "examples" / "dashboard" / "arm.ul"
FLAGS = [
    "--no-sandbox",  # tests may run as root
    "--disable-gpu",
    "--use-angle=swiftshader",  # WebGL without a graphics card
    "--enable-unsafe-swiftshader",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--host-resolver-rules=MAP evil.test 127.0.0.1",
]
SHOWN = (
    "dashboard",
    "dashboard-phone",
    "dashboard-stopped",
    "dashboard-replay",
    "dashboard-robot",
)  # in the documents
Open = Callable[..., Page]
expect.set_options(timeout=15_000)  # a busy machine


HERE = Path(__file__).parent


@pytest.hookimpl(tryfirst=True)  # before pytest-xdist reads the groups
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Let one worker have all of these tests: a browser takes more than one processor by itself."""
    for item in items:
        if item.path.is_relative_to(HERE):
            item.add_marker(pytest.mark.xdist_group("browser"))


@pytest.fixture(scope="module")  # while Playwright runs, no other test of this worker can have an event loop
def browser() -> Iterator[Browser]:
    with sync_playwright() as playwright:
        made = playwright.chromium.launch(executable_path="/usr/bin/chromium", args=FLAGS)
        yield made
        made.close()


@pytest.fixture(autouse=True)
def patient(monkeypatch: pytest.MonkeyPatch) -> None:
    """Give pages a long lease: on a busy machine, a browser may pause for longer than the usual one."""
    monkeypatch.setattr("unitylink.dashboard.viewer.LEASE_S", 10.0)


@pytest.fixture
def shape() -> None:
    """Lets `arm` have its shape, which is drawn without a graphics card here."""


@pytest.fixture
def arm(tmp_path: Path, request: pytest.FixtureRequest) -> Iterator[Robot]:
    """The SCARA with its plant. Its users are those of `unit.dashboard.robot`."""
    shaped = "shape" in request.fixturenames
    body = with_values(read_urdf(ARM.with_suffix(".urdf")), load(ARM).root()) if shaped else None
    extras = Extras(Shelf(tmp_path / "recordings"), ARM.read_text("utf-8"), body)
    with simulated(Path(os.path.relpath(ARM)), "scara", extras) as served:
        served.page.app.logins = RateLimit(1000, 1000)
        yield served


@pytest.fixture
def wired() -> Iterator[Robot]:
    """The same on TCP, so that its line can be cut."""
    spec = load(ARM)
    plant = load_plant("scara", spec)
    with robot(spec=spec, plant=plant, endpoint="tcp", options="?reconnect=1") as served:
        yield served


@pytest.fixture
def open_page(browser: Browser, request: pytest.FixtureRequest) -> Iterator[Open]:
    """Return a function that opens the robot's page as a user. An error in the page fails the test."""
    served: Robot = request.getfixturevalue(
        next((name for name in ("wired", "oven") if name in request.fixturenames), "arm")
    )
    contexts: list[BrowserContext] = []
    wrong: list[str] = []

    def open_one(user: str = "owner", layout: str = "", **options: Any) -> Page:
        options.setdefault("viewport", {"width": 1280, "height": 860})
        context = browser.new_context(**options)
        context.set_default_timeout(15_000)
        contexts.append(context)
        page = context.new_page()
        page.on("pageerror", lambda error: wrong.append(str(error)))
        page.goto(f"{served.page.url}/#{layout}&token={user}")
        page.get_by_role("heading", name="arm").wait_for()
        return page

    yield open_one
    for context in contexts:
        context.close()
    assert not wrong


@pytest.fixture
def shoot() -> Callable[[Page, str], None]:
    """Return a function that keeps a screenshot, with UPDATE_SCREENS=1 for the documents."""

    def keep(page: Page, name: str) -> None:
        folders = [ROOT / "build" / "screens"]
        if name in SHOWN and os.environ.get("UPDATE_SCREENS"):
            folders.append(ROOT / "docs" / "images")
        for folder in folders:
            folder.mkdir(parents=True, exist_ok=True)
            page.screenshot(path=folder / f"{name}.png")

    return keep
