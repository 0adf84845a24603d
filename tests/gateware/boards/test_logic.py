# SPDX-License-Identifier: BSD-3-Clause
"""What is built around the link: the user's VHDL, or words on pins."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pytest

from unitylink.boards.logic import Logic, Wanted, design_sources, logic_of
from unitylink.errors import BoardError
from unitylink.gateware import netlist, ports_of
from unitylink.generate import SpecPlan, write
from unitylink.interface.board_configuration import BoardConfiguration
from unitylink.spec import load

pytestmark = pytest.mark.xdist_group("boards")  # one process, so that its tests share the netlists

SPEC = """
public arm() {
   drive: pwm(channels=2);
   pad: gpio(pins=3);
   @lamp = 0x40: bool WRITE(INITIAL=1);
   @speed = 0x41: i16 WRITE();
   @keys = 0x42: u4 READ();
   @level = 0x43: bool READ();
   @trips = 0x44: READCLEAR();
   j1: joint(1);
}
joint(n: int) {
   @led = 0x50 + n: u2 WRITE();
   @angle = 0x60 + n: signed READ();
}
"""


def wanted(folder: Path, **more: object) -> Wanted:
    (folder / "arm.ul").write_text(SPEC, encoding="utf-8")
    return Wanted(spec_file=str(folder / "arm.ul"), folder=folder / "out", **more)  # type: ignore[arg-type]


def logic(order: Wanted, **configuration: Any) -> Logic:
    spec = load(order.spec_file)
    return logic_of(SpecPlan(spec, configuration), order)


def test_words_on_pins_are_synthesised(tmp_path: Path) -> None:
    order = wanted(tmp_path, pins=("speed=P1A1", "level=BTN1"))
    spec = load(order.spec_file)
    write(spec, order.folder, "vhdl")
    made = logic(order)
    assert made.components["drive_pins"] == "pwm" and made.components["pad_pin_in"] == "gpio"
    assert made.notices == (
        "nothing drives trips, j1.angle: the PC reads 0; give --pin NAME=PIN, or your own VHDL with --logic",
    )
    verilog = netlist(
        made.top, sources=[*design_sources(spec, order.folder), *made.sources], assertions=False
    )
    ports = {port.name: (port.is_input, port.bits) for port in ports_of(verilog, made.top)}
    assert ports == {
        "clock": (True, 1),
        "reset": (True, 1),
        "rx_line": (True, 1),
        "tx_line": (False, 1),
        "drive_pins": (False, 2),
        "pad_pin_in": (True, 3),
        "pad_pin_out": (False, 3),
        "pad_pin_drive": (False, 3),
        "lamp": (False, 1),
        "speed": (False, 16),
        "keys": (True, 4),
        "level": (True, 1),
        "j1_led": (False, 2),
    }


SAFE = """
public arm() {
   @lamp = 0x40: bool WRITE(SAFE=0);
   @tripped = 0x41: bool READ();
}
"""


@pytest.mark.parametrize("pins", [("tripped=P1A1",), ()])
def test_the_dead_man_on_a_pin(tmp_path: Path, pins: tuple[str, ...]) -> None:
    """On request, or because the board has a pin for it. A word of the same name is something else."""
    order = wanted(tmp_path, pins=(*pins, "tripped_2=BTN1"))
    Path(order.spec_file).write_text(SAFE, encoding="utf-8")
    spec = load(order.spec_file)
    configuration = BoardConfiguration.for_spec(spec, protocol="framed")
    write(spec, order.folder, "vhdl", configuration)
    made = logic_of(SpecPlan(spec, configuration), order, pin_for_trips=not pins)
    sources = [*design_sources(spec, order.folder), *made.sources]
    verilog = netlist(made.top, sources=sources, assertions=False)
    ports = {port.name: (port.is_input, port.bits) for port in ports_of(verilog, made.top)}
    assert ports["tripped"] == ports["lamp"] == (False, 1) and ports["tripped_2"] == (True, 1)
    module = verilog[verilog.index(f"module {made.top}") :]
    assert re.search(r"\.tripped\((\w+)\)", module[: module.index("endmodule")]), "it comes from the link"


@pytest.mark.parametrize("without", [{"protocol": "classic"}, {"protocol": "framed", "deadman": False}])
def test_a_pin_that_would_never_show_a_trip(tmp_path: Path, without: dict[str, Any]) -> None:
    with pytest.raises(BoardError, match=r"no dead-man; .* or say --pin tripped=-"):
        logic(wanted(tmp_path, pins=("tripped=P1A1",)), **without)
    order = wanted(tmp_path, pins=("tripped=-",))
    (order.folder / "vhdl").mkdir(parents=True)
    assert "tripped => tripped" in logic(order, **without).sources[0].read_text("utf-8")


def test_own_vhdl_beside_the_spec(tmp_path: Path) -> None:
    order = wanted(tmp_path)
    (tmp_path / "arm_board.vhd").write_text(
        "-- entity not_this is\nentity Arm_Board is\n generic (clock_hz : positive);\nend;\n"
    )
    made = logic(order)
    assert (made.top, made.generics) == ("arm_board", {"clock_hz"})
    assert made.notices == ("Arm_Board has no generic baud_hz: its own value is used instead",)


@pytest.mark.parametrize(
    ("text", "top", "message"),
    [
        ("entity a is\nend;\nentity b is\nend;", None, r"has 2 entities \(a, b\): say which with --top"),
        ("entity a is\nend;", "c", "the entity c is in none of"),
        ("package p is\nend;", None, "has 0 entities"),
    ],
)
def test_own_vhdl_that_cannot_be(tmp_path: Path, text: str, top: str | None, message: str) -> None:
    (tmp_path / "x.vhd").write_text(text)
    order = wanted(tmp_path, logic=(tmp_path / "x.vhd",), top=top)
    with pytest.raises(BoardError, match=message):
        logic(order)


def test_files_and_options_that_are_not_there(tmp_path: Path) -> None:
    order = wanted(tmp_path, logic=(tmp_path / "none.vhd",))
    with pytest.raises(BoardError, match=r"none\.vhd: there is no such VHDL file"):
        logic(order)
    with pytest.raises(BoardError, match="--top a: say with --logic"):
        logic(wanted(tmp_path, top="a"))


def test_an_ft245_instead_of_a_line(tmp_path: Path) -> None:
    order = wanted(tmp_path)
    spec = load(order.spec_file)
    configuration = BoardConfiguration.for_spec(spec, physical="ft245_async")
    write(spec, order.folder, "vhdl", configuration)
    made = logic(order, physical="ft245_async")
    assert made.generics == {"clock_hz"}
    sources = [*design_sources(spec, order.folder), *made.sources]
    ports = {port.name for port in ports_of(netlist(made.top, sources=sources, assertions=False), made.top)}
    assert {"clock", "ft245_rxf_n", "ft245_siwu_n", "ft245_data_in", "ft245_data_drive"} <= ports
    assert not ports & {"rx_line", "tx_line"}
