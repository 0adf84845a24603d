# SPDX-License-Identifier: BSD-3-Clause
"""netlist(): the user's own sources, generics, and the messages when something is wrong."""

from __future__ import annotations

from pathlib import Path

import pytest

from unitylink.errors import ToolError
from unitylink.gateware import Ghdl, every_source, gateware_folder, gateware_sources, netlist

SMALL = Path(__file__).with_name("small.vhd")


def test_sources_are_all_but_the_benches() -> None:
    root = gateware_folder().parent
    names = {path.relative_to(root).as_posix() for path in gateware_sources()}
    assert {"gateware/core.vhd", "gateware/common/fifo.vhd", "components/gpio/gpio.vhd"} <= names
    assert not [name for name in names if "/test/" in name or name.endswith(("_tb.vhd", "_formal.vhd"))]


def test_a_checkout_has_each_file_once() -> None:
    root = gateware_folder().parent
    every = [*(root / "gateware").rglob("*.vhd"), *(root / "components").rglob("*.vhd")]
    assert sorted(every_source()) == sorted(every)


def test_an_entity_of_the_gateware_with_generics() -> None:
    assert "module fifo" in (verilog := netlist("fifo", generics={"width": 10, "depth": 4}))
    assert "input  [9:0] write_data" in verilog


def test_a_source_of_ones_own(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(SMALL.parent)
    assert "module small" in netlist("small", sources=[Path("small.vhd")])


def test_assertions_are_for_simulators(tmp_path: Path) -> None:
    source = tmp_path / "sure.vhd"
    source.write_text(
        "entity sure is port (clk, a : in bit; b : out bit); end;\n"
        "architecture rtl of sure is begin\n"
        "  process (clk) begin\n"
        "    if clk = '1' and clk'event then assert a = '1' severity failure; b <= a; end if;\n"
        "  end process;\n"
        "end;\n"
    )
    assert "$fatal" in netlist("sure", sources=[source])
    assert "$fatal" not in netlist("sure", sources=[source], assertions=False)


def test_missing_ghdl_names_the_package(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(ToolError, match="apt-get install ghdl"):
        netlist("core")


def test_missing_file() -> None:
    with pytest.raises(ToolError, match=r"nowhere\.vhd: there is no such VHDL file"):
        netlist("core", sources=[Path("nowhere.vhd")])


def test_unknown_entity_and_generic() -> None:
    with pytest.raises(ToolError, match="nothing"):
        netlist("nothing")
    with pytest.raises(ToolError, match="no generic"):
        netlist("fifo", generics={"colour": 3})


def test_ghdls_own_message_is_passed_on(tmp_path: Path) -> None:
    broken = tmp_path / "broken.vhd"
    broken.write_text(
        SMALL.read_text()
        .replace("entity small", "entity broken")
        .replace("of small", "of broken")
        .replace("chosen <= word", "chosen <= wrod")
    )
    with pytest.raises(ToolError, match=r'(?s)broken\.vhd:\d+:.*"wrod"'):
        netlist("broken", sources=[broken])


def test_wrong_logic_is_refused(tmp_path: Path) -> None:
    """GHDL warns that it ignores a choice with a don't-care, and goes on."""
    source = SMALL.read_text().replace("case choice is", "case? choice is").replace("end case;", "end case?;")
    (tmp_path / "small.vhd").write_text(source.replace('"01"', '"-1"').replace('"00"', '"10"'))
    with pytest.raises(ToolError, match="would not do what the source does"):
        Ghdl(tmp_path, [tmp_path / "small.vhd"]).synthesise("small", "verilog")
