# SPDX-License-Identifier: BSD-3-Clause
"""The public names of the package. Using a few of them loads little."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest

import unitylink


def test_public_names() -> None:
    assert unitylink.__all__ == sorted(unitylink.__all__)
    for name in unitylink.__all__:
        assert getattr(unitylink, name) is not None
    assert set(unitylink.__all__) <= set(dir(unitylink))
    with pytest.raises(AttributeError, match="no attribute 'nonsense'"):
        _ = unitylink.nonsense


def test_the_version_is_the_same_everywhere() -> None:
    root = Path(__file__).resolve().parents[3]
    for name in ("pyproject.toml", "CMakeLists.txt"):
        text = (root / name).read_text(encoding="utf-8")
        assert re.search(rf'(^version = "|VERSION ){re.escape(unitylink.__version__)}\b', text, re.M), name


def test_importing_the_package_loads_no_numpy() -> None:
    code = "import sys, unitylink; unitylink.LinkTimeout; sys.exit('numpy' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0
