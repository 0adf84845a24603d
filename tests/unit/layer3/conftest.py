# SPDX-License-Identifier: BSD-3-Clause
from __future__ import annotations

import importlib.util
import sys
from pathlib import Path
from types import ModuleType

import pytest


@pytest.fixture(scope="session")
def fake() -> ModuleType:
    """The module `fake_link.py`, wherever pytest was started."""
    path = Path(__file__).parents[1] / "layer3" / "fake_link.py"
    spec = importlib.util.spec_from_file_location("fake_link", path)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules["fake_link"] = module
    spec.loader.exec_module(module)
    return module
