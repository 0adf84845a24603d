# SPDX-License-Identifier: BSD-3-Clause
"""A page as `make format` would write it."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


def formatted(page: str) -> str:
    """Return `page` with its lines wrapped, as .mdformat.toml says."""
    command = [sys.executable, "-m", "mdformat", "-"]
    done = subprocess.run(command, cwd=ROOT, input=page, capture_output=True, encoding="utf-8", check=False)
    if done.returncode:
        raise SystemExit(f"mdformat, which `make develop` installs: {done.stderr.strip()}")
    return done.stdout
