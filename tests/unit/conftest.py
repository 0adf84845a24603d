# SPDX-License-Identifier: BSD-3-Clause
"""What the tests of the layers share."""

from __future__ import annotations

import importlib
from types import ModuleType

import pytest


@pytest.fixture(scope="session")
def fake() -> ModuleType:
    """Return the module of the fake link, for the layers above it."""
    return importlib.import_module("unit.layer3.fake_link")
