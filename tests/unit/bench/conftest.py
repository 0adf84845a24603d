# SPDX-License-Identifier: BSD-3-Clause
"""The bench's native programs, built if they are not."""

from __future__ import annotations

import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest

from unitylink.tools.bench.programs import find_checkout, native

NAMES = ("bench_round_trip", "bench_publish_source", "bench_uartbone")


@pytest.fixture(scope="session")
def program() -> Callable[[str], Path]:
    """Return the path of a native bench program by its name."""
    root = find_checkout()
    if not all((root / "build" / "native" / name).exists() for name in NAMES):
        subprocess.run([root / "tools" / "setup.sh", "native"], cwd=root, check=True)
    return lambda name: native(root, name)
