# SPDX-License-Identifier: BSD-3-Clause
"""What all tests share. No test judges how long something took, because the machine may be busy."""

from __future__ import annotations

import gc
import os
import signal
import subprocess
import sys
import textwrap
from collections import Counter
from collections.abc import Callable, Generator
from pathlib import Path
from typing import Any

import pytest
from effort import many
from hypothesis import settings
from watchdog import HANG_S, Watchdog

settings.register_profile("untimed", deadline=None, max_examples=many(100))
settings.load_profile("untimed")

# Modules and tests stay until the end, so the collector need not look for cycles in them: not while they are
# made, and not whenever a test collects.
gc.disable()

ROOT = Path(__file__).resolve().parents[1]
WHOLE_FILES = (ROOT / "tests" / "unit", ROOT / "tests" / "programs")
USUAL_S = 0.1
SHORT_RUN_S = 300  # after a shorter run, the slowest files are not printed


def built(name: str) -> Path:
    """Return a file of the native build by its name. Everything is built if the file is not there."""
    file = ROOT / "build" / "native" / name
    if not file.exists():
        subprocess.run([ROOT / "tools" / "setup.sh", "native"], cwd=ROOT, check=True)
    return file


@pytest.fixture(scope="session")
def fake_library() -> Path:
    """The fake of libusb."""
    return built("fake_libusb.so")


@pytest.fixture(scope="session")
def fake_spidev() -> Path:
    """The fake of the kernel's SPI port, to be preloaded."""
    return built("fake_spidev.so")


@pytest.fixture
def spi_client(fake_spidev: Path, tmp_path: Path) -> Callable[..., str]:
    """Return a function that runs a program with /dev/spidev0.0: `spi_client(code, port=5555)` returns its
    output.
    """
    log, file = tmp_path / "spi.log", tmp_path / "spidev"
    file.touch()

    def run(code: str, **settings: object) -> str:
        words = {"device": "/dev/spidev0.0", "file": file, "log": log, **settings}
        fake = " ".join(f"{key}={value}" for key, value in words.items())
        environment = {**os.environ, "LD_PRELOAD": str(fake_spidev), "FAKE_SPI": fake}
        command = [sys.executable, "-W", "error", "-c", textwrap.dedent(code)]
        done = subprocess.run(
            command, env=environment, capture_output=True, text=True, check=False, timeout=120
        )
        assert done.returncode == 0, done.stderr
        return done.stdout

    return run


@pytest.fixture(scope="session")
def program() -> Callable[[str], Path]:
    """The path of a native bench program by its name."""
    return built


WATCHDOG = pytest.StashKey[Watchdog]()


def pytest_configure(config: pytest.Config) -> None:
    config.stash[WATCHDOG] = Watchdog(os.dup(2))  # the run's own stderr: a test may have another


@pytest.hookimpl(wrapper=True)
def pytest_runtest_protocol(item: pytest.Item) -> Generator[None, object, object]:
    """Let no test hang."""
    watchdog, mark = item.config.stash[WATCHDOG], item.get_closest_marker("patience")
    watchdog.watch(mark.args[0] if mark else HANG_S)
    try:
        return (yield)
    finally:
        # Pytest disarms it when a test fails, also when one fails in a pytest that a test runs.
        if item.session.testsfailed or "pytester" in getattr(item, "fixturenames", ()):
            watchdog.disarmed()


@pytest.hookimpl(tryfirst=True)  # before pytest-xdist reads the groups
def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Make each file of some folders a group, which runs in one worker, and let long groups begin first.

    What its tests share is imported, compiled and opened only there. Tests that share something with those of
    another file keep their own group.
    """
    marks: dict[Path, pytest.MarkDecorator | None] = {}  # of each file
    for item in items:
        if item.path not in marks:
            whole = any(item.path.is_relative_to(folder) for folder in WHOLE_FILES)
            marks[item.path] = pytest.mark.xdist_group(str(item.path.relative_to(ROOT))) if whole else None
        mark = marks[item.path]
        if mark is not None and item.get_closest_marker("xdist_group") is None:
            item.add_marker(mark)
    if hasattr(config, "workerinput"):  # of several workers; one process alone keeps the order of the files
        takes_s: Counter[str] = Counter()
        for item in items:
            takes_s[group_of(item)] += seconds_of(item)
        items.sort(key=lambda item: -takes_s[group_of(item)])


def group_of(item: pytest.Item) -> str:
    mark = item.get_closest_marker("xdist_group")
    return str(mark.args[0]) if mark else item.nodeid


def seconds_of(item: pytest.Item) -> float:
    """Return about how long a test takes: what it says, `@pytest.mark.takes(5)`, or what most take."""
    mark = item.get_closest_marker("takes")
    return float(mark.args[0]) if mark else USUAL_S


def pytest_collection_finish() -> None:
    """Let the collector look only at what is made from now on."""
    gc.freeze()
    gc.enable()


def pytest_terminal_summary(terminalreporter: Any) -> None:
    """Name the folders and files whose tests took longest, so that a slow test is noticed."""
    took: Counter[Path] = Counter()
    for reports in terminalreporter.stats.values():
        for report in reports:
            if isinstance(report, pytest.TestReport):
                took[Path(report.nodeid.partition("::")[0])] += report.duration
    if sum(took.values()) < SHORT_RUN_S:
        return
    folders: Counter[Path] = Counter()
    for file, seconds in took.items():
        folders[Path(*file.parts[:2])] += seconds
    for title, times in (("folders", folders), ("slowest files", took)):
        terminalreporter.write_sep("=", f"{title}, of all workers together")
        for path, seconds in times.most_common(15):
            terminalreporter.write_line(f"{seconds:6.0f} s  {path}")


# A shell starts background jobs with interrupts ignored. Here they are handled, also by programs that a test
# starts.
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)
