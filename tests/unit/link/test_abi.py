# SPDX-License-Identifier: BSD-3-Clause
"""What the shared library shows is what unitylink.h promises, no more and no less."""

from __future__ import annotations

import re
import subprocess
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]


def test_symbols() -> None:
    subprocess.run([ROOT / "tools" / "setup.sh", "native"], check=True)
    library = ROOT / "build" / "native" / "libunitylink.so"
    listing = subprocess.run(
        ["nm", "-D", "--defined-only", library], check=True, capture_output=True, text=True
    ).stdout
    shown = sorted(line.split()[2] for line in listing.splitlines())
    listed = (ROOT / "native" / "abi_symbols.txt").read_text().split()
    header = (ROOT / "native" / "include" / "unitylink.h").read_text()
    assert shown == listed
    assert sorted(re.findall(r"^UL_API .*?(ul_\w+)\(", header, re.M)) == listed
