# SPDX-License-Identifier: BSD-3-Clause
"""The bench of docs/gateware/testing.md runs as it is printed there, and fails if the entity is wrong."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pytest
from gateware.simulators import Ghdl

ROOT = Path(__file__).resolve().parents[2]
BLINKER = """library ieee;
  use ieee.std_logic_1164.all;

entity blinker is
  generic (clocks : positive);
  port (clock : in std_ulogic; led : out std_ulogic := '0');
end entity;

architecture rtl of blinker is
  signal count : natural := 1;
begin
  process (clock)
  begin
    if rising_edge(clock) then
      count <= count + 1;
      if count = LAST then
        count <= 1;
        led   <= not led;
      end if;
    end if;
  end process;
end architecture;
"""


@pytest.mark.parametrize("last", ["clocks", "clocks + 1"], ids=["right", "wrong"])
def test_bench_of_the_page(tmp_path: Path, last: str) -> None:
    page = (ROOT / "docs" / "gateware" / "testing.md").read_text(encoding="utf-8")
    (bench,) = re.findall(r"```vhdl\n(.*?)```", page, re.DOTALL)
    (tmp_path / "blinker_tb.vhd").write_text(bench, encoding="utf-8")
    (tmp_path / "blinker.vhd").write_text(BLINKER.replace("LAST", last), encoding="utf-8")
    sources = [ROOT / "gateware" / "test" / "bench_pkg.vhd", *tmp_path.glob("*.vhd")]
    own = Ghdl(tmp_path, sources)
    if last == "clocks":
        for clocks in (1, 5, 100):
            own.run("blinker_tb", clocks=clocks)
    else:
        own.refuse("blinker_tb", "led after a blink", clocks=5)


@pytest.mark.parametrize(("address_bits", "data_bits"), [(16, 32), (8, 8)])
def test_the_host_of_benches(ghdl: Any, address_bits: int, data_bits: int) -> None:
    ghdl.run("uart_host_tb", address_bits=address_bits, data_bits=data_bits)
