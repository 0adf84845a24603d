# SPDX-License-Identifier: BSD-3-Clause
from __future__ import annotations

import importlib.util
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

from unitylink import Link, connect


def _load(name: str) -> ModuleType:
    spec = importlib.util.spec_from_file_location(name, Path(__file__).with_name(f"{name}.py"))
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture(scope="session")
def fake() -> ModuleType:
    """The module of the fake device: FakeDevice, message, crc8."""
    return _load("fake_device")


@pytest.fixture
def device(fake: ModuleType) -> Iterator[Any]:
    device = fake.FakeDevice()
    yield device
    device.close()


@pytest.fixture
def link(device: Any) -> Iterator[Link]:
    with connect(device.url()) as link:
        yield link
