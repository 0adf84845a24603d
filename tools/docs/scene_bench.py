# SPDX-License-Identifier: BSD-3-Clause
"""Plays a scene to the VHDL of its component, for components that have no model. It needs GHDL."""

from __future__ import annotations

import shutil
import subprocess
import tempfile
from collections.abc import Sequence
from pathlib import Path

from unitylink.gateware import gateware_sources
from unitylink.gateware.dependencies import needed_sources
from unitylink.interface.components import ComponentConfiguration
from unitylink_lab.conformance.component_ports import component_ports

Stimulus = tuple[int, str, int, int]
RESET_CLOCKS = 8
BENCH = """library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use std.textio.all;
  use work.wishbone_pkg.all;

entity scene_tb is
end entity;

architecture bench of scene_tb is
  signal clock   : std_ulogic := '0';
  signal reset   : std_ulogic := '1';
  signal m2s     : wishbone_m2s_t := wishbone_m2s_idle;
  signal s2m     : wishbone_s2m_t;
  signal inputs  : std_ulogic_vector({inputs} downto 0) := (others => '0');
  signal outputs : std_ulogic_vector({outputs} downto 0) := (others => '0');
  signal events  : std_ulogic_vector({events} downto 0) := (others => '0');
  signal now_at  : integer := -{reset_clocks};
begin

  dut : entity work.{entity}
    generic map ({generics})
    port map (
      clock => clock, reset => reset, wishbone_m2s => m2s, wishbone_s2m => s2m{ports});

  -- the clock, and what the lines do in each state
  process is
    file trace           : text open write_mode is "lines.txt";
    variable out_line    : line;
    variable last_out    : std_ulogic_vector(outputs'range) := (others => '0');
    variable last_events : std_ulogic_vector(events'range) := (others => '0');

    procedure tell (what : character; number : natural; level : std_ulogic) is
    begin
      write(out_line, integer'image(now_at) & ' ' & what & ' ' & integer'image(number) & ' ');
      write(out_line, character'value(std_ulogic'image(level)));
      writeline(trace, out_line);
    end procedure;

  begin
    while now_at <= {end} loop
      wait for 2 ns;
      if now_at >= 0 then
        reset <= '0';
        for pin in outputs'reverse_range loop
          if outputs(pin) /= last_out(pin) then
            tell('o', pin, outputs(pin));
          end if;
        end loop;
        for event in events'reverse_range loop
          if events(event) = '1' and last_events(event) = '0' then
            tell('e', event, '1');
          end if;
        end loop;
        last_out    := outputs;
        last_events := events;
      end if;
      clock  <= '1';
      wait for 2 ns;
      clock  <= '0';
      now_at <= now_at + 1;
      wait for 0 ns;
    end loop;
    wait;
  end process;

  process is
  begin
{drives}    wait;
  end process;

  process is
    file trace        : text open write_mode is "answers.txt";
    variable out_line : line;

    procedure access_word (at : natural; we : std_ulogic; address : natural; high : natural; low : natural) is
    begin
      while now_at < at loop
        wait until falling_edge(clock);
      end loop;
      m2s <= (cyc => '1', stb => '1', we => we, adr => std_ulogic_vector(to_unsigned(address, 32)),
              dat => std_ulogic_vector(to_unsigned(high, 16) & to_unsigned(low, 16)), sel => (others => '1'));
      loop
        wait until rising_edge(clock);
        exit when s2m.ack = '1' or s2m.err = '1';
      end loop;
      m2s <= wishbone_m2s_idle;
      write(out_line, integer'image(at) & " a " & integer'image(boolean'pos(s2m.err = '1')) & ' ');
      hwrite(out_line, s2m.dat);
      writeline(trace, out_line);
      wait until rising_edge(clock);
    end procedure;

  begin
{accesses}    wait;
  end process;

end architecture;
"""


def play_vhdl(one: ComponentConfiguration, stimuli: Sequence[Stimulus], end: int) -> list[Stimulus]:
    """Return what the VHDL does: (clock, `o` a pin, `e` an event or `a` an answer, number, value)."""
    ghdl = shutil.which("ghdl")
    if ghdl is None:
        raise SystemExit("GHDL is missing: tools/setup.sh rtl installs it")
    with tempfile.TemporaryDirectory() as made:
        folder = Path(made)
        (folder / "scene_tb.vhd").write_text(_bench(one, stimuli, end), "ascii")
        sources = [*needed_sources(one.entity, gateware_sources()), folder / "scene_tb.vhd"]
        for step in (["-i", "--std=08", *map(str, sources)], ["-m", "--std=08", "-Wno-hide", "scene_tb"]):
            _run([ghdl, *step], folder)
        _run([ghdl, "-r", "--std=08", "scene_tb", "--ieee-asserts=disable-at-0"], folder)
        rows = [
            line.split()
            for name in ("lines.txt", "answers.txt")
            for line in (folder / name).read_text("ascii").splitlines()
        ]
    return sorted((int(at), what, int(number), int(value, 16)) for at, what, number, value in rows)


def _run(command: list[str], folder: Path) -> None:
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    if done.returncode:
        raise SystemExit(f"{' '.join(command[:3])}: {done.stdout}{done.stderr}")


def _bench(one: ComponentConfiguration, stimuli: Sequence[Stimulus], end: int) -> str:
    drives = "".join(
        f"    while now_at < {at} loop wait until falling_edge(clock); end loop;\n"
        f"    inputs({number}) <= '{level}';\n"
        for at, what, number, level in stimuli
        if what == "p"
    )
    accesses = "".join(
        f"    access_word({at}, '{int(what == 'w')}', {address}, {value >> 16}, {value & 0xFFFF});\n"
        for at, what, address, value in stimuli
        if what in "rw"
    )
    return BENCH.format(
        **component_ports(one),
        reset_clocks=RESET_CLOCKS,
        end=end,
        drives=drives,
        accesses=accesses,
    )
