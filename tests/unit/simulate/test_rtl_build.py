# SPDX-License-Identifier: BSD-3-Clause
"""The input of Verilator, and the messages if a design or a tool cannot be used."""

from __future__ import annotations

from pathlib import Path

import pytest

from unitylink import connect
from unitylink.errors import ToolError, UrlError, ValueRangeError
from unitylink.interface.board_configuration import BoardConfiguration
from unitylink.simulate.rtl import RtlDesign, build_model, design_of
from unitylink.simulate.rtl.verilated import has_one_trigger
from unitylink.simulate.rtl.verilog import (
    Port,
    either_edge_will_do,
    model_of,
    stream_ports_of,
    with_named_assertions,
    with_plain_choices,
)
from unitylink.spec import load

ROOT = Path(__file__).parents[3]

HEAD = """module part
  (input  clock);
endmodule

module top
  (input  clock,
   input  reset,
   input  rx_valid,
   input  [7:0] rx_data,
   input  [2:0] rx_error,
   input  tx_ready,
   input  [1:0] events,
   input  [63:0] read_words,
   output rx_ready,
   output tx_valid,
   output [7:0] tx_data,
   output [31:0] write_words);
endmodule
"""
ASSERTION = """  /* /some/where/fifo.vhd:73:5  */
  always @*
    if (!n1760_q)
      $fatal(1, "assertion failure n1744");
"""
CHOICES = """  assign n3_o = {n2_o, n1_o};
  always @*
    case (n3_o)
      2'b10: n4_o <= a;
      2'b01: n4_o <= b;
      default: n4_o <= 1'b0;
    endcase
"""


def test_ports() -> None:
    ports = {port.name: port for port in stream_ports_of(HEAD, "Top")}
    assert ports["rx_data"] == Port("rx_data", True, 8)
    assert ports["write_words"] == Port("write_words", False, 32)
    assert ports["clock"].bits == 1


def test_inputs_go_through_registers_but_clock_and_words() -> None:
    model = model_of(HEAD, "top")
    assert "  input [7:0] rx_data_next" in model
    assert "    rx_data <= rx_data_next;" in model
    assert "  input [63:0] read_words,\n" in model
    assert "clock_next" not in model
    assert "    .write_words(write_words)" in model


def test_either_edge_can_be_a_clock_if_it_is_only_waited_for() -> None:
    registers = HEAD.replace("endmodule", "  always @(posedge clock)\n    q <= d;\nendmodule")
    model = model_of(registers, "top")
    assert model.count("always @(posedge clock or negedge clock)") == 3
    for other in ("posedge clk", "negedge clock"):
        assert "or negedge clock" not in model_of(registers.replace("posedge clock", other, 1), "top")
    assert not either_edge_will_do(registers.replace("q <= d", "q <= clock"))


def test_a_failed_assertion_tells_its_place() -> None:
    assert '$c("unitylink_failed(\\"fifo.vhd:73\\");");' in with_named_assertions(ASSERTION)
    with pytest.raises(ToolError, match="in a form that is not known"):
        with_named_assertions('$fatal(2, "else");')


def test_choices_that_exclude_each_other_become_a_chain_of_conditions() -> None:
    plain = with_plain_choices(CHOICES)
    assert "case" not in plain
    assert "    if (n2_o) n4_o <= a;\n    else if (n1_o) n4_o <= b;\n    else n4_o <= 1'b0;\n" in plain


@pytest.mark.parametrize(
    "other",
    [
        CHOICES.replace("2'b01", "2'b11"),  # 2'b11 is a number and selects no single choice
        CHOICES.replace("assign n3_o = {n2_o, n1_o};", "assign n3_o = word;"),
        "endmodule\n".join(CHOICES.split("\n", 1)),  # the bits belong to another module
    ],
)
def test_other_cases_stay_as_they_are(other: str) -> None:
    assert with_plain_choices(other) == other


def test_design_without_streams() -> None:
    with pytest.raises(
        ToolError, match=r"part cannot be simulated live: it has no port reset \(1 bits\), rx_valid"
    ):
        stream_ports_of(HEAD, "part")
    with pytest.raises(ToolError, match="no module nothing"):
        stream_ports_of(HEAD, "nothing")


def test_missing_tools_are_named_all_at_once(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.delenv("CXX", raising=False)
    with pytest.raises(
        ToolError, match=r"missing: ghdl, verilator, g\+\+;.* apt-get install ghdl verilator g\+\+"
    ):
        build_model(RtlDesign("core"))


@pytest.mark.parametrize(
    ("url", "message"),
    [
        ("rtl:", r"expected sim:SPEC\.ul or rtl:SPEC\.ul"),
        ("rtl:x.ul?clock_hz=fast", "clock_hz=fast is not a whole number"),
        (f"rtl:{ROOT}/examples/scara/scara.ul?physical=spi", "spi sends only when a master asks"),
    ],
)
def test_urls_that_will_not_do(url: str, message: str) -> None:
    with pytest.raises(UrlError, match=message):
        connect(url)


def test_a_board_behind_a_chip_has_its_files_and_refuses_an_unknown_layer(tmp_path: Path) -> None:
    file = tmp_path / "lamp.ul"
    file.write_text("public lamp() { @led = 0x10: WRITE(); }")
    spec = load(file)
    behind = design_of(
        spec, BoardConfiguration.for_spec(spec, physical="ft245_async", send_immediate="never")
    )
    plain = design_of(spec, BoardConfiguration.for_spec(spec))
    assert (behind.top, plain.top) == ("lamp_behind_ft245_async", "lamp_design")
    assert set(behind.files) - set(plain.files) == {"lamp_behind_ft245_async.vhd", "ft245_chip.vhd"}
    assert "send_immediate => never" in behind.files["lamp_behind_ft245_async.vhd"]
    with connect(f"sim:{file}?physical=ft245_async") as link:  # the twin always has flow control
        link.write(0x10, 1)
    with pytest.raises(ValueRangeError, match="physical is 'usb'"):
        connect(f"sim:{file}?physical=usb")


ROOT_HEADER = "    VlTriggerVec<1> __VactTriggered;\n    VlTriggerVec<1> __VnbaTriggered;\n"
VERILATED = """void Vmodel___024root___eval_act(Vmodel___024root* vlSelf) {
    if (false && vlSelf) {}  // Prevent unused
    VL_DEBUG_IF(VL_DBG_MSGF("+    Vmodel___024root___eval_act\\n"); );
}
void Vmodel___024root___eval_nba(Vmodel___024root* vlSelf) {
    if (false && vlSelf) {}  // Prevent unused
    // Body
    if (vlSelf->__VnbaTriggered.at(0U)) {
        Vmodel___024root___nba_sequent__TOP__0(vlSelf);
    }
}
"""


@pytest.mark.parametrize(
    ("find", "instead", "one"),
    [
        ("", "", True),
        ("<1> __Vnba", "<2> __Vnba", False),
        ("__VactTriggered;", "__VactTriggered;\n    VlTriggerVec<1> __VicoTriggered;", False),
        ("VL_DEBUG_IF(", "Vmodel___024root___act_comb__TOP__0(vlSelf);\n    VL_DEBUG_IF(", False),
        (".at(0U)", ".word(0U)", False),
        ("    if (vlSelf", "    if (vlSelf->__VactTriggered.at(0U)) {\n    }\n    if (vlSelf", False),
        ("___eval_nba(", "___eval_late(", False),
    ],
    ids=[
        "as it is",
        "two clocks",
        "straight input",
        "logic before",
        "other code",
        "two conditions",
        "other name",
    ],
)
def test_a_clock_is_one_call_if_nothing_else_can_happen(
    find: str, instead: str, one: bool, tmp_path: Path
) -> None:
    (tmp_path / "Vmodel___024root.h").write_text(ROOT_HEADER.replace(find, instead), encoding="utf-8")
    (tmp_path / "Vmodel___024root__0.cpp").write_text(VERILATED.replace(find, instead), encoding="utf-8")
    assert has_one_trigger(tmp_path) == one
