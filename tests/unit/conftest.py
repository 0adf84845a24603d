# SPDX-License-Identifier: BSD-3-Clause
"""The tests of a file run in one worker. What they share is imported, compiled and opened only there."""

from __future__ import annotations

import importlib
from pathlib import Path
from types import ModuleType

import pytest

HERE = Path(__file__).parent


@pytest.hookimpl(tryfirst=True)  # before pytest-xdist reads the groups
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Make each file a group. Tests that share something with those of another file keep their own group."""
    for item in items:
        if item.path.is_relative_to(HERE) and item.get_closest_marker("xdist_group") is None:
            item.add_marker(pytest.mark.xdist_group(str(item.path.relative_to(HERE))))


@pytest.fixture(scope="session")
def fake() -> ModuleType:
    """Return the module of the fake link, for the layers above it."""
    return importlib.import_module("unit.layer3.fake_link")
