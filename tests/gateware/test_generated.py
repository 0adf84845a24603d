# SPDX-License-Identifier: BSD-3-Clause
"""Generated designs in GHDL: analysed, synthesised without a latch or warning, answering on their UART."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from unitylink.board_configuration import BoardConfiguration
from unitylink.generate import generate_vhdl
from unitylink.generate.vhdl import design_name
from unitylink.spec import Spec, compile_text, load

ROOT = Path(__file__).resolve().parents[2]
Make = Callable[..., Any]


def spec_of(text: str, file: str = "robot.ul") -> Spec:
    result = compile_text(text, file)
    assert result.spec is not None, result.diagnostics
    return result.spec


@pytest.fixture
def design(ghdl: Any, tmp_path: Path) -> Make:
    """Write the design of a spec into `tmp_path`; a library of it and of all gateware."""

    def make(spec: Spec, configuration: BoardConfiguration | None = None, *others: Path) -> Any:
        (tmp_path / "vhdl").mkdir(exist_ok=True)
        for name, text in generate_vhdl(spec, configuration).items():
            (tmp_path / name).write_text(text, encoding="utf-8")
        gateware = sorted((ROOT / "gateware").rglob("*.vhd"))
        return type(ghdl)(tmp_path, [*gateware, *sorted((tmp_path / "vhdl").glob("*.vhd")), *others])

    return make


AWKWARD = """
public signal(ctrl, ^comm) {
   @Led = 0x10: WRITE(ID="synthesis translate_off");
   @led = 0x11: READ(ID="end package; -- \\n constant x");
   @lED_2 = 0x12: signed READ();
   @_ = 0x13: READ();
   @__a__b__ = 0x14: WRITE();
   @entity = 0x15: WRITE();
   @std_ulogic = 0x16: WRITE();
   @z = 0xFFFFFF: READ();
   process: signal_2("\\"quoted\\"") @ (0x40,0x41);
   PROCESS: signal_2("\\u00b5") @ (0x50,0x5F);
   all_of_it = process, PROCESS;
}
signal_2(n): @ (x,^signed) {
   @x: signed READ(ID=n);
   @^signed: WRITE(ID=n);
}
"""
DESIGNS = {
    "hello_led": (ROOT / "examples" / "hello_led" / "hello_led.ul", {}),
    "awkward": (AWKWARD, {}),
    "narrow": (
        "public a() { @x = 0x0: signed READ(); @y = 0x1: WRITE(); }",
        {"data_bits": 12, "publish_mode": 0},
    ),
    "reads": ("public a() { @x = 0x7: READ(); }", {"groups": 2, "read_many": 0, "checksum": "xor"}),
    "writes": ("public a() { @x = 0x7: WRITE(); }", {"edge_event_groups": (0, 15)}),
    "nothing": ("public a() { }", {}),
    "devices": ("public a() { @x = 0x7: READ(); } public b() { @x = 0x7: READ(); @y = 0x9: WRITE(); }", {}),
}


@pytest.mark.parametrize("name", DESIGNS)
def test_synthesis(design: Make, name: str) -> None:
    source, overrides = DESIGNS[name]
    spec = load(source) if isinstance(source, Path) else spec_of(source)
    netlist = design(spec, BoardConfiguration.for_spec(spec, **overrides)).synthesise(
        f"{design_name(spec)}_top"
    )
    assert f"entity {design_name(spec)}_top is" in netlist
