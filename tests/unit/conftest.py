# SPDX-License-Identifier: BSD-3-Clause
from __future__ import annotations

import importlib
from types import ModuleType

import pytest


@pytest.fixture(scope="session")
def fake() -> ModuleType:
    """The module of the fake link, for the layers above it."""
    return importlib.import_module("unit.layer3.fake_link")
