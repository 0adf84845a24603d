# SPDX-License-Identifier: BSD-3-Clause
"""What all tests share: nothing is judged by how long it took, for the machine may be busy."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
from pathlib import Path

import pytest
from hypothesis import settings

settings.register_profile("untimed", deadline=None)
settings.load_profile("untimed")

ROOT = Path(__file__).resolve().parents[1]
FAKE = ROOT / "native" / "test" / "fake_usb" / "fake_libusb.cpp"


@pytest.fixture(scope="session")
def fake_library(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The fake of libusb, compiled."""
    library = tmp_path_factory.mktemp("usb") / "fake_libusb.so"
    compiler = os.environ.get("CXX") or shutil.which("c++") or "g++"
    options = ["-std=c++20", "-O1", "-shared", "-fPIC", "-pthread", "-I", str(ROOT / "native" / "src")]
    subprocess.run([compiler, *options, str(FAKE), "-o", str(library)], check=True, timeout=300)
    return library


# A shell starts background jobs with interrupts ignored; here they are heeded, and by whatever is started.
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)
