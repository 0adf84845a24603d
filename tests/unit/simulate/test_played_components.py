# SPDX-License-Identifier: BSD-3-Clause
"""A plant plays a component of the user's own on the twin, in place of its VHDL."""

from __future__ import annotations

from pathlib import Path

import pytest

from unitylink import connect
from unitylink.errors import ToolError, UnityLinkError

SPEC = """
link mover (ADDRESS=8);
public mover() { motor: stepper(); }
@component("stepper") @source("stepper.vhd") @pin("step", "out")
stepper(): @base[2] { @target = base: signed READWRITE(); @position = base+1: signed READ(); }
"""
VHDL = "entity stepper is generic (data_width : positive := 32); port (step : out std_ulogic); end;"
PLANT = """
from unitylink.simulate import BoardValues

class Plant:
    period_s, plays, order = 0.001, ("stepper",), ""

    def attach(self, spec, registers):
        self.values = BoardValues(spec, registers)

    def play(self, time_s):
        self.order += "p"
        self.values["motor.position"] = 2 * self.values["motor.target"]

    def step(self, time_s):
        self.order += "s"
"""


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A spec with its plant, on a machine without GHDL."""
    monkeypatch.setenv("PATH", str(tmp_path))
    for name, text in (("mover.ul", SPEC), ("stepper.vhd", VHDL), ("plant.py", PLANT)):
        (tmp_path / name).write_text(text, encoding="utf-8")
    return tmp_path


def test_the_board_is_the_twin_and_play_comes_before_each_step(folder: Path) -> None:
    with connect(f"sim:{folder / 'mover.ul'}?plant={folder / 'plant.py'}", time="lockstep") as link:
        target, position = (element.addresses[0] for _, element in link.board.spec.walk())
        link.write(target, 21)
        link.step(0.01)
        assert link.read(position) == 42
        assert link.board.plant.order.startswith("psps")


def test_without_such_a_plant_the_vhdl_is_compiled(folder: Path) -> None:
    other = folder / "other.py"
    other.write_text(PLANT.replace('("stepper",)', '("servo",)'), encoding="utf-8")
    for plant in ("ramp", str(other)):
        with pytest.raises(ToolError, match="missing: ghdl"):
            connect(f"sim:{folder / 'mover.ul'}?plant={plant}")
    with pytest.raises(ToolError, match="missing: ghdl"):
        connect(f"rtl:{folder / 'mover.ul'}?plant={folder / 'plant.py'}")


@pytest.mark.parametrize("plays", ['"stepper"', "None", "(1,)"])
def test_what_a_plant_plays_are_entities(plays: str, folder: Path) -> None:
    """One text would be all entities whose names are in it."""
    (folder / "plant.py").write_text(PLANT.replace('("stepper",)', plays), encoding="utf-8")
    with pytest.raises(UnityLinkError, match="it must be entities, such as"):
        connect(f"sim:{folder / 'mover.ul'}?plant={folder / 'plant.py'}")


def test_a_plant_that_plays_needs_the_method(folder: Path) -> None:
    (folder / "plant.py").write_text(PLANT.replace("def play(", "def played("), encoding="utf-8")
    with pytest.raises(UnityLinkError, match=r"Plant has no method play\(\)"):
        connect(f"sim:{folder / 'mover.ul'}?plant={folder / 'plant.py'}")
