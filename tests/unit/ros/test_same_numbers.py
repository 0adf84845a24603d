# SPDX-License-Identifier: BSD-3-Clause
"""Python nodes, C++ nodes, parameter files and docs/ros.md each contain some numbers.

They are the same everywhere.
"""

from __future__ import annotations

import re
from pathlib import Path

from unitylink.ros import life, node, parameters

ROOT = Path(__file__).resolve().parents[3]
NATIVE = ROOT / "native" / "include" / "unitylink"
TEMPLATES = ROOT / "src" / "unitylink" / "generate"
PAGE = " ".join((ROOT / "docs" / "ros.md").read_text("utf-8").split())


def number(text: str, before: str) -> float:
    found = re.search(rf"\b{before}([\d.]+)", text)
    assert found, before
    return float(found[1])


def test_the_dead_man_s_time() -> None:
    default = parameters.Parameters.deadman_s
    assert node.Options.deadman_s == default
    assert number((NATIVE / "robot_options.hpp").read_text(), "deadman_s = ") == default
    for ros in ("ros1", "ros2"):
        assert number((TEMPLATES / ros / "parameters.yaml.jinja").read_text(), "deadman_s: ") == default
    assert f"`deadman_s` ({default:g} s; 0: never)" in PAGE


def test_the_patience_with_threads() -> None:
    native = (NATIVE / "robot_life.hpp").read_text()
    assert number(native, "patience_s = ") == life.PATIENCE_S
    assert number(native, "device_s = ") == life.DEVICE_S
    assert (
        f"stands still for {life.PATIENCE_S:g} s ({life.DEVICE_S:g} s where it waits for the device)" in PAGE
    )
