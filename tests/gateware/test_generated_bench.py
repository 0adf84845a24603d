# SPDX-License-Identifier: BSD-3-Clause
"""`unitylink generate --only bench`: its bench passes on the design, and finds what is wrong with it."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pytest

from unitylink.errors import ToolError
from unitylink.gateware.build import build
from unitylink.generate import SpecPlan, planned_files, write_files
from unitylink.spec import Spec, compile_text, load

ROOT = Path(__file__).resolve().parents[2]
PAGE = ROOT / "docs" / "generate-vhdl.md"
RIG = load(ROOT / "tests" / "ros" / "rig.ul")
WIDE = """
enum mode: u2 { off = 0; on = 2; }
public wide() {
   @speed = 0x10: i40 READWRITE();
   @count = 0x20: u64 READ(PUBLISH(on limit));
   @on = 0x24: bool WRITE();
   @go = 0x25: u8 PULSE();
   @address = 0x30: READWRITE();
   @value = 0x31: READ();
   @write = 0x32: READ();
   @read = 0x33: READ(PUBLISH(10 Hz));
   @std_ulogic_vector = 0x34: f32 WRITE();
   @mode_t = 0x35: mode WRITE();
   @mode = 0x36: mode WRITE();
}
"""  # from `address` on: names that the bench or the record could take for something else


SLOW = {"clock_hz": 24_000_000, "baud_hz": 3_000_000}  # the fewest clocks a bit, for the simulation's sake


def run(spec: Spec, folder: Path, bench: str = "", *own: str, **settings: Any) -> None:
    write_files(planned_files(SpecPlan(spec, {**SLOW, **settings}), ["vhdl", "bench"]), folder)
    made = sorted(folder.glob("*/*.vhd"))
    build("test", bench or f"{spec.name}_bench", folder, [*made, *(folder / name for name in own)])


@pytest.mark.parametrize("name", ["servo/servo", "scara/scara", "profile/profile"])
def test_examples(name: str, tmp_path: Path) -> None:
    run(load(ROOT / "examples" / f"{name}.ul"), tmp_path)


@pytest.mark.parametrize("protocol", ["both", "framed"])
def test_arrays_fields_and_types(protocol: str, tmp_path: Path) -> None:
    run(RIG, tmp_path, protocol=protocol)


@pytest.mark.parametrize(
    ("file", "right", "wrong", "found"),
    [
        ("user", "words(143 downto 128)", "words(142 downto 127)", "j_1_pos is not what to_pc has"),
        ("user", "words(107 downto 96)", "words(106 downto 95)", "was written to duty_1"),
        ("config", 'slow_address       : unsigned(31 downto 0) := x"00000003"', "01", "slow is not what"),
        ("config", 'duty_1_address     : unsigned(31 downto 0) := x"00000005"', "FF", "to 16#000000FF#"),
    ],
)
def test_what_is_wrong_is_found(file: str, right: str, wrong: str, found: str, tmp_path: Path) -> None:
    files = planned_files(SpecPlan(RIG, SLOW), ["vhdl", "bench"])
    write_files(files, tmp_path)
    path = tmp_path / "vhdl" / f"rig_{file}_pkg.vhd"
    text = path.read_text()
    wrong = f'{right[:-3]}{wrong}"' if file == "config" else wrong
    assert right in text
    path.write_text(text.replace(right, wrong))
    with pytest.raises(ToolError, match=re.escape(found)):
        build("test", "rig_bench", tmp_path, sorted(tmp_path.glob("*/*.vhd")))


def test_the_bench_of_the_page(tmp_path: Path) -> None:
    board, bench, *_ = re.findall(r"^```vhdl\n(.*?)^```", PAGE.read_text("utf-8"), re.MULTILINE | re.DOTALL)
    (tmp_path / "board.vhd").write_text(board)
    (tmp_path / "board_bench.vhd").write_text(bench)
    spec = load(ROOT / "examples" / "hello_led" / "hello_led.ul")
    run(spec, tmp_path, "board_bench", "board.vhd", "board_bench.vhd")
    (tmp_path / "board.vhd").write_text(board.replace("11_999", "23_999"))
    with pytest.raises(ToolError, match="the time is wrong"):
        run(spec, tmp_path, "board_bench", "board.vhd", "board_bench.vhd")


PUBLISHES = """library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
library unitylink;
  use unitylink.host_pkg.all;
use work.wide_host_pkg.all;
use work.wide_user_pkg.all;

entity publishes is
end entity;

architecture bench of publishes is
  signal clock, to_board, from_board : std_ulogic := '0';
  signal done    : boolean := false;
  signal request : host_request_t := host_request_idle;
  signal reply   : host_reply_t;
  signal publish : host_publish_t;
  signal events  : std_ulogic_vector(3 downto 0) := "0000";
  signal to_pc   : wide_to_pc_t;
begin
  clock <= not clock after 0.5 sec / 24_000_000 when not done;
  pc : entity unitylink.uart_host
    generic map (baud_hz => 3_000_000)
    port map (
      rx_line => from_board, tx_line => to_board, request => request, reply => reply, publish => publish);
  board : entity work.wide_top
    generic map (clock_hz => 24_000_000, baud_hz => 3_000_000)
    port map (clock => clock, rx_line => to_board, tx_line => from_board, to_pc => to_pc, events => events);
  test : process is
    variable count : unsigned(63 downto 0);
    variable speed : signed(39 downto 0);
  begin
    to_pc.count <= x"123456789ABCDEF0";
    read_count(request, reply, count);
    assert count = x"123456789ABCDEF0" report "two words, read" severity failure;
    write_speed(request, reply, shift_left(to_signed(-300_000, 40), 16));
    read_speed(request, reply, speed);
    assert speed = shift_left(to_signed(-300_000, 40), 16) report "two words, written" severity failure;
    write_go(request, reply, x"01");
    subscribe_on_limit(request, reply);
    events(on_limit_group) <= '1';
    await_publish(publish, on_limit_group, 2 ms);
    assert publish.words(0) = x"9ABCDEF0" and publish.words(1) = x"12345678" and publish.count = 2
      report "a publish" severity failure;
    report "publishes: passed";
    done <= true;
    wait;
  end process;
end architecture;
"""


def test_values_of_several_words_and_publishes(tmp_path: Path) -> None:
    result = compile_text(WIDE, "wide.ul")
    assert result.spec is not None, result.diagnostics
    (tmp_path / "publishes.vhd").write_text(PUBLISHES)
    run(result.spec, tmp_path, "publishes", "publishes.vhd")
    run(result.spec, tmp_path)
