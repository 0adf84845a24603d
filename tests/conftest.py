# SPDX-License-Identifier: BSD-3-Clause
"""What all tests share: nothing is judged by how long it took, for the machine may be busy."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
import textwrap
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from hypothesis import settings

settings.register_profile("untimed", deadline=None)
settings.load_profile("untimed")

ROOT = Path(__file__).resolve().parents[1]
FAKES = ROOT / "native" / "test"
SHORT_RUN_S = 300  # of which nobody wants to know the slowest files


def _compiled(source: Path, library: Path) -> Path:
    compiler = os.environ.get("CXX") or shutil.which("c++") or "g++"
    options = ["-std=c++20", "-O1", "-shared", "-fPIC", "-pthread", "-I", str(ROOT / "native" / "src")]
    subprocess.run([compiler, *options, str(source), "-o", str(library)], check=True, timeout=300)
    return library


@pytest.fixture(scope="session")
def fake_library(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The fake of libusb, compiled."""
    return _compiled(
        FAKES / "fake_usb" / "fake_libusb.cpp", tmp_path_factory.mktemp("usb") / "fake_libusb.so"
    )


@pytest.fixture(scope="session")
def fake_spidev(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The fake of the kernel's SPI port, to be preloaded, compiled."""
    return _compiled(
        FAKES / "fake_spi" / "fake_spidev.cpp", tmp_path_factory.mktemp("spi") / "fake_spidev.so"
    )


@pytest.fixture
def spi_client(fake_spidev: Path, tmp_path: Path) -> Callable[..., str]:
    """Run a program that has /dev/spidev0.0: spi_client(code, port=5555) returns what it prints."""
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
    """The path of a native bench program by its name; all are built if one is not."""
    from unitylink_lab.bench.programs import native

    names = ("bench_round_trip", "bench_publish_source", "bench_uartbone", "journal_board")
    if not all((ROOT / "build" / "native" / name).exists() for name in names):
        subprocess.run([ROOT / "tools" / "setup.sh", "native"], cwd=ROOT, check=True)
    return lambda name: native(ROOT, name)


def pytest_terminal_summary(terminalreporter: Any) -> None:
    """Name the files whose tests took longest, for what becomes slow shall be seen."""
    took: Counter[str] = Counter()
    for reports in terminalreporter.stats.values():
        for report in reports:
            if isinstance(report, pytest.TestReport):
                took[report.nodeid.partition("::")[0]] += report.duration
    if sum(took.values()) > SHORT_RUN_S:
        terminalreporter.write_sep("=", "slowest files, of all workers together")
        for file, seconds in took.most_common(15):
            terminalreporter.write_line(f"{seconds:6.0f} s  {file}")


# A shell starts background jobs with interrupts ignored; here they are heeded, and by whatever is started.
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)
