# SPDX-License-Identifier: BSD-3-Clause
"""The fixture of the package, used as a user would."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from unitylink.errors import SpecError
from unitylink.testing import Simulated

LAMP = "public lamp() { @led = 0x10: WRITE(); @light = 0x11: signed READ(); }"
Sim = Callable[..., Simulated]


@pytest.fixture
def lamp(tmp_path: Path) -> Path:
    path = tmp_path / "lamp.ul"
    path.write_text(LAMP)
    return path


class Still:
    """A plant that changes nothing, so everything stays as the test sets it."""

    period_s = 0.01

    def attach(self, spec: object, registers: object) -> None: ...

    def step(self, time_s: float) -> None: ...


def test_both_sides_of_a_robot_are_at_hand(unitylink_sim: Sim, lamp: Path) -> None:
    sim = unitylink_sim(lamp, plant=Still())
    sim.robot["led"].write(1)  # type: ignore[union-attr]
    sim.registers[0x11] = -7
    assert sim.registers[0x10] == 1
    assert sim.robot["light"].read() == -7  # type: ignore[union-attr]


def test_several_robots_and_their_generics(unitylink_sim: Sim, lamp: Path) -> None:
    one, other = (
        unitylink_sim(lamp, plant=Still()),
        unitylink_sim(lamp, plant=Still(), data_bits=16, options="crc=1"),
    )
    assert one.link.configuration.data_bits == 32 and other.link.configuration.data_bits == 16
    one.link.write(0x10, 3)
    assert other.link.read(0x10) == 0


def test_a_wrong_spec_is_told(unitylink_sim: Sim, tmp_path: Path) -> None:
    (tmp_path / "wrong.ul").write_text("public wrong( { }")
    with pytest.raises(SpecError):
        unitylink_sim(tmp_path / "wrong.ul")
    with pytest.raises(SpecError, match=r"absent\.ul"):
        unitylink_sim("absent.ul")
