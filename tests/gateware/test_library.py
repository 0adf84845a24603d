# SPDX-License-Identifier: BSD-3-Clause
"""A generated design stands beside a user's own entities that have the names of ours."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from gateware.simulators import Ghdl

from unitylink.errors import ToolError
from unitylink.gateware import gateware_sources, netlist, run_tool
from unitylink.gateware.build import build
from unitylink.gateware.dependencies import entities_of, units_of
from unitylink.generate import SpecPlan, planned_files, write_files
from unitylink.spec import compile_text

NAMES = ("core", "fifo", "uart", "gpio", "framed", "synchroniser")
# What a user has under such a name: it inverts. Nothing of ours has such ports.
OWN = """library ieee;
  use ieee.std_logic_1164.all;

entity {name} is
  port (level : in std_ulogic; inverted : out std_ulogic);
end entity;

architecture own of {name} is
begin
  inverted <= not level;
end architecture;
"""
BOARD = """library ieee;
  use ieee.std_logic_1164.all;
library unitylink;
use work.lamp_user_pkg.all;

entity board is
  port (
    clock, usb_rx, pin : in  std_ulogic;
    usb_tx, lamp       : out std_ulogic;
    seen               : out std_ulogic_vector(1 to {count})
  );
end entity;

architecture rtl of board is
  signal to_pc   : lamp_to_pc_t;
  signal from_pc : lamp_from_pc_t;
  signal levels  : std_ulogic_vector(0 downto 0);
begin
  link : entity work.lamp_top
    port map (clock => clock, rx_line => usb_rx, tx_line => usb_tx, to_pc => to_pc, from_pc => from_pc);
  ours : entity unitylink . Synchroniser
    port map (clock => clock, asynchronous(0) => pin, levels => levels);
  to_pc.key <= (0 => levels(0), others => '0');
  lamp      <= from_pc.on_now(0);
{own}
end architecture;
"""
TEST = """library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
library unitylink;
  use unitylink.host_pkg.all;
use work.lamp_host_pkg.all;

entity board_bench is
end entity;

architecture bench of board_bench is
  signal clock                     : std_ulogic := '0';
  signal done                      : boolean    := false;
  signal to_board, from_board, lit : std_ulogic;
  signal pin                       : std_ulogic := '1';
  signal seen                      : std_ulogic_vector(1 to {count});
  signal request                   : host_request_t := host_request_idle;
  signal reply                     : host_reply_t;
begin
  clock <= not clock after 0.5 sec / 24_000_000 when not done;

  pc : entity unitylink.uart_host
    generic map (baud_hz => 3_000_000)
    port map (rx_line => from_board, tx_line => to_board, request => request, reply => reply);

  board : entity work.board
    port map (
      clock => clock, usb_rx => to_board, usb_tx => from_board, pin => pin, lamp => lit, seen => seen);

  test : process is
    variable value : unsigned(31 downto 0);
  begin
    write_on_now(request, reply, x"00000001");
    read_key(request, reply, value);
    assert lit = '1' and value = 1 and unsigned(seen) = 0 report "not as it was written" severity failure;
    pin <= '0';
    read_key(request, reply, value);
    assert value = 0 and (and seen) = '1' report "the level is not seen" severity failure;
    report "board_bench: passed";
    done <= true;
    wait;
  end process;
end architecture;
"""


@pytest.fixture
def sources(tmp_path: Path) -> list[Path]:
    result = compile_text("public lamp() { @on_now = 0x0: WRITE(); @key = 0x1: READ(); }", "lamp.ul")
    assert result.spec is not None
    plan = SpecPlan(result.spec, {"clock_hz": 24_000_000, "baud_hz": 3_000_000, "protocol": "framed"})
    write_files(planned_files(plan, ["vhdl", "bench"]), tmp_path)
    own = "\n".join(
        f"  own_{n} : entity work.{name} port map (level => pin, inverted => seen({n}));"
        for n, name in enumerate(NAMES, 1)
    )
    texts = {name: OWN.format(name=name) for name in NAMES}
    texts |= {"board": BOARD.format(count=len(NAMES), own=own), "board_bench": TEST.format(count=len(NAMES))}
    for name, text in texts.items():
        (tmp_path / f"{name}.vhd").write_text(text)
    return [*tmp_path.glob("vhdl/*.vhd"), *tmp_path.glob("bench/*host_pkg.vhd"), *tmp_path.glob("*.vhd")]


def test_the_names_are_those_of_the_gateware() -> None:
    assert set(NAMES) <= entities_of(gateware_sources())
    assert "unitylink" not in units_of(gateware_sources()), "GHDL refuses a unit with the name of its library"


def test_the_board_works(sources: list[Path], tmp_path: Path) -> None:
    build("test", "board_bench", tmp_path, sources)


def test_its_netlist_has_both(sources: list[Path], tmp_path: Path) -> None:
    synthesised = [path for path in sources if path.stem not in ("board_bench", "lamp_host_pkg")]
    verilog = netlist("board", sources=synthesised, assertions=False)
    modules = re.findall(r"^module (\w+)", verilog, re.MULTILINE)
    assert len(set(modules)) == len(modules)
    assert {*NAMES, "board"} <= set(modules)
    for name in ("core", "uart", "synchroniser"):
        assert [module for module in modules if module.startswith(f"unitylink_{name}")]
    (tmp_path / "board.v").write_text(verilog)
    ended = run_tool(["yosys", "-q", "-p", "read_verilog board.v; hierarchy -check -top board"], tmp_path)
    assert ended.code == 0, ended.err


def test_what_is_wrong_in_a_users_file_is_told_at_its_place(sources: list[Path], tmp_path: Path) -> None:
    board = tmp_path / "board.vhd"
    board.write_text(board.read_text().replace("levels => levels", "levls => levels"))
    with pytest.raises(ToolError, match=rf"{re.escape(str(board))}:\d+:.*levls") as told:
        netlist("board", sources=sources)
    assert "unitylink_synchroniser" not in str(told.value)


def test_a_name_in_the_wrong_library_is_told(tmp_path: Path) -> None:
    old = tmp_path / "old.vhd"
    old.write_text("use work.width_pkg.all;\nentity old is end;\narchitecture a of old is begin end;\n")
    with pytest.raises(ToolError, match=r"width_pkg is in the library unitylink: write `library unitylink;`"):
        build("check", "old", tmp_path, [old])


@pytest.mark.parametrize(
    ("wrong", "warning"),
    [
        ("component c is end component; begin c1 : c;", "not bound"),
        ("/* a comment /* in another one */ begin", "comment"),
    ],
)
def test_what_ghdl_only_warns_of_is_refused(tmp_path: Path, wrong: str, warning: str) -> None:
    (tmp_path / "a.vhd").write_text(f"entity a is end;\narchitecture x of a is\n{wrong}\nend;\n")
    with pytest.raises(AssertionError, match=warning):
        Ghdl(tmp_path, [tmp_path / "a.vhd"]).run("a")
