# SPDX-License-Identifier: BSD-3-Clause
"""Plays the same stimuli to the VHDL of a component and to its model, and compares every clock.

A stimulus is (clock, what, number, value): `p` drives an input pin, `r` reads, `w` writes, `c` opens (1) and
closes (0) a block of accesses. Both sides give (state, what, number, value): `o` an output pin, `a` the
answer of an access (number 1 is `err`), `e` an event that became high.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import Any

from unitylink import _native
from unitylink.gateware import gateware_sources
from unitylink.gateware.dependencies import needed_sources
from unitylink.interface.components import ComponentConfiguration
from unitylink_lab.conformance.component_ports import WIRE_BITS, component_ports

Stimulus = tuple[int, str, int, int]
Trace = list[tuple[int, str, int, int]]

RESET_CLOCKS = 8
BENCH = """-- SPDX-License-Identifier: BSD-3-Clause
library ieee;
  use ieee.std_logic_1164.all;
  use ieee.numeric_std.all;
  use std.textio.all;
  use work.wishbone_pkg.all;

entity clock_true_tb is
end entity;

architecture bench of clock_true_tb is
  signal clock   : std_ulogic := '0';
  signal reset   : std_ulogic := '1';
  signal m2s     : wishbone_m2s_t := wishbone_m2s_idle;
  signal s2m     : wishbone_s2m_t;
  signal inputs  : std_ulogic_vector({inputs} downto 0) := (others => '0');
  signal outputs : std_ulogic_vector({outputs} downto 0) := (others => '0');
  signal events  : std_ulogic_vector({events} downto 0) := (others => '0');
begin

  dut : entity work.{entity}
    generic map ({generics})
    port map (
      clock => clock, reset => reset, wishbone_m2s => m2s, wishbone_s2m => s2m{ports});

  process is
    file stimuli       : text open read_mode is "stimuli.txt";
    file trace         : text open write_mode is "trace.txt";
    variable next_line : line;
    variable out_line  : line;
    variable at, number, low, high : integer := -1;
    variable what      : character;
    variable blank     : character;
    variable last_out  : std_ulogic_vector(outputs'range) := (others => '0');
    variable last_events : std_ulogic_vector(events'range) := (others => '0');
    variable waits     : boolean := false; -- for the answer of an access
    variable answered  : integer := -10;
    variable held      : boolean := false;

    procedure fetch is
    begin
      at := -1;
      if not endfile(stimuli) then
        readline(stimuli, next_line);
        read(next_line, at);
        read(next_line, blank);
        read(next_line, what);
        read(next_line, number);
        read(next_line, high);
        read(next_line, low);
      end if;
    end procedure;

    procedure tell (state : integer; kind : character; index : integer; value : std_ulogic_vector) is
    begin
      write(out_line, state);
      write(out_line, ' ');
      write(out_line, kind);
      write(out_line, ' ');
      write(out_line, index);
      write(out_line, ' ');
      hwrite(out_line, value);
      writeline(trace, out_line);
    end procedure;

  begin
    for count in 1 to {reset_clocks} loop
      clock <= '1'; wait for 1 ns;
      clock <= '0'; wait for 1 ns;
    end loop;
    reset <= '0';
    fetch;
    for state in 0 to {end} loop
      wait for 1 ns;  -- what the last edge changed has settled
      for pin in outputs'reverse_range loop
        if outputs(pin) /= last_out(pin) then
          tell(state, 'o', pin, "000" & outputs(pin));
        end if;
      end loop;
      last_out := outputs;
      for event in events'reverse_range loop
        if events(event) = '1' and last_events(event) = '0' then
          tell(state, 'e', event, x"1");
        end if;
      end loop;
      last_events := events;
      if waits and (s2m.ack or s2m.err) = '1' then
        waits    := false;
        answered := state;
        if s2m.err = '1' then
          tell(state, 'a', 1, x"00000000");
        elsif m2s.we = '1' then
          tell(state, 'a', 0, x"00000000");
        else
          tell(state, 'a', 0, s2m.dat);
        end if;
      elsif answered = state - 1 then
        m2s.stb <= '0';
        if not held then
          m2s.cyc <= '0';
        end if;
      end if;
      while at = state loop
        case what is
          when 'p' =>
            inputs(number) <= '1' when low = 1 else '0';
          when 'c' =>
            held := low = 1;
            m2s.cyc <= '1' when held else '0';
          when others =>
            assert not waits report "no answer" severity failure;
            waits := true;
            m2s.cyc <= '1';
            m2s.stb <= '1';
            m2s.we  <= '1' when what = 'w' else '0';
            m2s.adr <= std_ulogic_vector(to_unsigned(number, 32));
            m2s.dat <= std_ulogic_vector(to_unsigned(high, 16)) & std_ulogic_vector(to_unsigned(low, 16));
            m2s.sel <= (others => '1');
        end case;
        fetch;
      end loop;
      wait for 1 ns;
      clock <= '1'; wait for 1 ns;
      clock <= '0'; wait for 1 ns;
    end loop;
    report "clock_true_tb: passed";
    wait;
  end process;

end architecture;
"""


@cache
def sources_of(entity: str) -> list[Path]:
    """Return the gateware that an entity needs. Many tests are about one."""
    return needed_sources(entity, gateware_sources())


def play_vhdl(
    make: Callable[[Path, Sequence[Path]], Any],
    folder: Path,
    one: ComponentConfiguration,
    stimuli: Sequence[Stimulus],
    end: int,
) -> Trace:
    """Return what the VHDL does. `make` makes a library of analysed VHDL in a folder."""
    text = BENCH.format(**component_ports(one), reset_clocks=RESET_CLOCKS, end=end)
    (folder / "clock_true_tb.vhd").write_text(text, encoding="ascii")
    lines = [f"{at} {what} {number} {value >> 16} {value & 0xFFFF}" for at, what, number, value in stimuli]
    (folder / "stimuli.txt").write_text("\n".join(lines) + "\n", encoding="ascii")
    sources = [*sources_of(one.entity), folder / "clock_true_tb.vhd"]
    make(folder, sources).run("clock_true_tb")
    found = []
    for line in (folder / "trace.txt").read_text(encoding="ascii").splitlines():
        state, what, number, value = line.split()
        found.append((int(state), what, int(number), int(value, 16)))
    return found


def play_model(
    one: ComponentConfiguration, stimuli: Sequence[Stimulus], end: int, late: bool = False
) -> Trace:
    """Return what the model does. With `late` nobody waits for its pins, so it may do much at once."""
    seen = _native.ComponentModel(one).play(stimuli, end, late=late)
    order = {"o": 0, "e": 1, "a": 2}
    return sorted((s for s in seen if s[0] <= end), key=lambda one: (one[0], order[one[1]], one[2]))


@dataclass(frozen=True)
class Case:
    """Arguments of a component in a spec, and how it is tried.

    `values` has, for some addresses, the values that make the component do something. `pause` is the longest
    time in clocks between two blocks of accesses, and `quiet` that between two bursts on the pins. `wait` is
    the longest time for which a write waits for its answer, and for which any access waits after the reset.
    `start` is that time of a component whose writes do not wait. `slow` is the longest time for which any
    access waits, so no pin changes meanwhile. `first` is written at the start, and the pins `still` do not
    change. `clocks` is how long the short form is. `outside` gives
    the changes of the pins until a clock, if pins at random would never be what the component waits for.
    `device` is a device of the component's folder, to be tried instead of the component. `program` is that of
    a device, if no description has such a one, and `generics` are those that go with it. With `shaft` the
    first two pins are those of an encoder, which turns, turns back, and rests: its edges are so many clocks
    apart. `rest` is the level of all pins between two bursts. Without it they stay as they are. `answers`
    gives the changes of the pins from the accesses, for a component that must be answered: it plays its
    model to see what is asked.
    """

    arguments: str = ""
    values: Mapping[int, Sequence[int]] = field(default_factory=dict)
    pause: int = 40
    quiet: int = 120
    wait: int = 0
    device: str = ""
    program: str = ""
    generics: Mapping[str, int] = field(default_factory=dict)
    start: int = 0
    shaft: Sequence[int] = ()
    slow: int = 0
    first: Mapping[int, int] = field(default_factory=dict)
    still: Sequence[int] = ()
    clocks: int = 20_000
    clock_hz: int = 2_300_000  # so that a microsecond is no whole number of clocks
    outside: Callable[[random.Random, int], Iterator[Stimulus]] | None = None
    answers: (
        Callable[[random.Random, ComponentConfiguration, Sequence[Stimulus], int], Iterator[Stimulus]] | None
    ) = None
    rest: int | None = None


def random_stimuli(one: ComponentConfiguration, case: Case, end: int, seed: int) -> list[Stimulus]:
    """Return accesses, blocks of accesses and changes of pins at random.

    Pins change in bursts, some as fast as the clock.
    """
    draw = random.Random(seed)
    accesses = list(_accesses(draw, one, case, end))
    if case.answers:
        return in_order([*accesses, *case.answers(draw, one, accesses, end)], end)
    busy = {at + more for at, what, _, _ in accesses if what in "rw" for more in range(case.slow + 2)}
    changes = case.outside(draw, end) if case.outside else _pins(draw, one, case, end)
    pins = [
        pin
        for pin in (_shaft(draw, case, end) if case.shaft else changes)
        if pin[2] not in case.still and not (case.slow and pin[0] in busy)
    ]
    return in_order([*accesses, *pins], end)


def in_order(stimuli: Sequence[Stimulus], end: int) -> list[Stimulus]:
    """Return the stimuli before a clock as they happen.

    A block is closed before anything else of its clock begins.
    """
    order = {"p": 0, "c": 1, "r": 2, "w": 2}
    return sorted(
        (one for one in stimuli if one[0] < end),
        key=lambda s: (s[0], order[s[1]] - (s[1] == "c" and s[3] == 0) * 2, s[2]),
    )


def _accesses(draw: random.Random, one: ComponentConfiguration, case: Case, end: int) -> Iterator[Stimulus]:
    now = max(case.wait, case.start) + draw.randrange(4)
    for address, value in case.first.items():
        yield now, "w", address, value
        now += case.slow + 2
    while now < end - 20 - 6 * (case.wait + case.slow):
        count = draw.choice((1, 1, 1, 2, 3, 6))
        if count > 1:
            yield now, "c", 0, 1
        for _ in range(count):
            address = draw.randrange(one.words + 1)  # one behind the last, too
            if draw.random() < 0.5:
                yield now, "r", address, 0
            else:
                known = case.values.get(address)
                value = draw.choice(known) if known and draw.random() < 0.9 else draw.getrandbits(32)
                yield now, "w", address, value
                now += case.wait
            now += case.slow + 2 + (draw.randrange(3) if draw.random() < 0.3 else 0)
        if count > 1:
            yield now, "c", 0, 0
        now += 1 + (draw.randrange(3) if draw.random() < 0.3 else draw.randrange(1, case.pause))


def _pins(draw: random.Random, one: ComponentConfiguration, case: Case, end: int) -> Iterator[Stimulus]:
    count = sum(bits or 1 for _, direction, bits in one.pins if direction == "in")
    count += sum(WIRE_BITS for _, direction in one.wires if direction == "in")
    levels = [0] * count
    now = RESET_CLOCKS
    while count and now < end - 20:
        for _ in range(draw.randrange(1, 60)):
            for pin in draw.sample(range(count), draw.choice((1, 1, 1, min(2, count)))):
                levels[pin] ^= 1
                yield now, "p", pin, levels[pin]
            now += draw.choice((1, 2, 3, 4, 7))
        if case.rest is not None:
            for pin in range(count):
                if levels[pin] != case.rest:
                    levels[pin] = case.rest
                    yield now, "p", pin, case.rest
        now += draw.randrange(1, case.quiet)


def _shaft(draw: random.Random, case: Case, end: int) -> Iterator[Stimulus]:
    now, count = RESET_CLOCKS, 0
    while now < end - 20:
        way, apart = draw.choice((1, 1, -1)), draw.choice(case.shaft)
        for _ in range(1 + draw.randrange(max(2, min(40, 1500 // apart)))):
            pin = count & 1 if way > 0 else ~count & 1
            count += way
            yield now, "p", pin, (count + 1 - pin >> 1) & 1
            now += apart
