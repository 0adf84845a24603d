# SPDX-License-Identifier: BSD-3-Clause
from __future__ import annotations

import importlib
from collections.abc import Iterator
from types import ModuleType
from typing import Any

import pytest
from unit.link.reconnect_rig import Rig

from unitylink import Link, connect


@pytest.fixture(scope="session")
def fake() -> ModuleType:
    """Return the module of the fake device: FakeDevice, message, crc8."""
    return importlib.import_module("unit.link.fake_device")


@pytest.fixture
def device(fake: ModuleType) -> Iterator[Any]:
    device = fake.FakeDevice()
    yield device
    device.close()


@pytest.fixture
def link(device: Any) -> Iterator[Link]:
    with connect(device.url()) as link:
        yield link


@pytest.fixture
def rig() -> Iterator[Rig]:
    """A board behind a line that can be cut."""
    made = Rig()
    yield made
    made.close()
