# SPDX-License-Identifier: BSD-3-Clause
"""The library that the programs are linked with."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="session")
def library() -> Path:
    subprocess.run([ROOT / "tools" / "setup.sh", "native"], check=True)
    return ROOT / "build" / "native"
