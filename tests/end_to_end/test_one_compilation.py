# SPDX-License-Identifier: BSD-3-Clause
"""All files of a C++ library can be compiled as one, so a new file can stand beside any of them."""

from __future__ import annotations

import os
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
SOURCES = sorted((ROOT / "native" / "src").rglob("*.cpp"))
TWIN = [
    path for path in SOURCES if path.relative_to(ROOT / "native" / "src").parts[0] in ("device", "faults")
]
CORE = [path for path in SOURCES if path not in TWIN]


@pytest.mark.parametrize("sources", [CORE, TWIN], ids=["core", "twin"])
def test_names_in_anonymous_namespaces_differ_between_files(sources: list[Path]) -> None:
    """CMake compiles eight files as one. A new file changes which eight these are."""
    assert len(sources) > 20
    compiler = os.environ.get("CXX", "g++")
    folders = [f"-I{ROOT / 'native' / name}" for name in ("include", "src")]
    done = subprocess.run(
        [compiler, "-std=c++20", "-fsyntax-only", '-DUNITYLINK_VERSION="0"', *folders, "-x", "c++", "-"],
        input="".join(f'#include "{path}"\n' for path in sources),
        capture_output=True,
        text=True,
        check=False,
        timeout=300,
    )
    errors = [line for line in done.stderr.splitlines() if "error:" in line]
    assert done.returncode == 0, f"two files have a name in common; rename it in one: {errors[:3]}"
