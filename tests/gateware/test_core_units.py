# SPDX-License-Identifier: BSD-3-Clause
"""The benches of the core's entities, each over the generics that matter to it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from unitylink.gateware import netlist

BENCHES: list[tuple[str, dict[str, Any]]] = [
    ("fifo_tb", {"depth": 2}),
    ("fifo_tb", {"depth": 16, "seed": 5}),
    ("reset_synchroniser_tb", {"clocks": 2}),
    ("synchroniser_tb", {"width": 3}),
    ("synchroniser_tb", {"width": 1, "idle": "'1'", "seed": 2}),
    ("reset_synchroniser_tb", {"clocks": 8, "seed": 3}),
    ("decoder_tb", {}),
    ("receiver_tb", {"checksum": "crc8"}),
    ("receiver_tb", {"checksum": "xor"}),
    ("receiver_tb", {"checksum": "none"}),
    ("lite_receiver_tb", {"digits": True}),
    ("lite_receiver_tb", {"digits": False}),
    ("datalink_tb", {"datalink": "full", "checksum": "crc8"}),
    ("datalink_tb", {"datalink": "full", "checksum": "none", "stalls": 0}),
    ("datalink_tb", {"datalink": "lite"}),
    ("datalink_tb", {"datalink": "none", "stalls": 60}),
    ("transmitter_tb", {"checksum": "crc8"}),
    ("transmitter_tb", {"checksum": "crc8", "stalls": 0}),
    ("transmitter_tb", {"checksum": "xor"}),
    ("transmitter_tb", {"checksum": "none"}),
    ("request_buffer_tb", {"complete": True}),
    ("request_buffer_tb", {"complete": False}),
    ("request_stream_tb", {}),
    ("application_tb", {"publish_mode": 2}),
    ("application_tb", {"publish_mode": 2, "stalls": 60}),
    ("application_tb", {"publish_mode": 1}),
    ("application_tb", {"publish_mode": 0}),
    ("program_sharing_tb", {"seed": 1}),
    ("wishbone_master_tb", {}),
    ("wishbone_memory_tb", {"words": 24, "data_width": 32}),
    ("wishbone_memory_tb", {"words": 256, "data_width": 16}),
    ("subscription_manager_tb", {"groups": 4, "group_size": 5}),
    ("subscription_manager_tb", {"groups": 16, "group_size": 32, "address_width": 32}),
    ("subscription_manager_tb", {"groups": 256, "group_size": 255}),
]


@pytest.mark.parametrize(
    ("bench", "generics"), BENCHES, ids=lambda v: v if isinstance(v, str) else "-".join(map(str, v.values()))
)
def test_bench(ghdl: Any, bench: str, generics: dict[str, Any]) -> None:
    ghdl.run(bench, **generics)


def test_words_narrower_than_a_rate_do_without_publishing(tmp_path: Path) -> None:
    source = tmp_path / "narrow.vhd"
    source.write_text(
        """
        library ieee;
          use ieee.std_logic_1164.all;
        library unitylink;
          use unitylink.bii_pkg.all;
          use unitylink.settings_pkg.all;
        entity narrow is
          port (
            clock, reset, rx_valid, tx_ready : in std_ulogic;
            rx_data      : in  std_ulogic_vector(7 downto 0);
            bii_request  : out bii_request_t;
            bii_response : in  bii_response_t);
        end entity;
        architecture rtl of narrow is
        begin
          core_bii : entity unitylink.core_bii
            generic map (settings => core_settings(data_bits => 8, publish_mode => 0))
            port map (
              clock => clock, reset => reset, rx_valid => rx_valid, rx_ready => open, rx_data => rx_data,
              tx_valid => open, tx_ready => tx_ready, tx_data => open, tx_last => open, tx_publish => open,
              bii_request => bii_request, bii_response => bii_response);
        end architecture;
        """
    )
    assert "module narrow" in netlist("narrow", sources=[source], assertions=False)


def test_generics_that_may_not_be(ghdl: Any) -> None:
    ghdl.refuse("fifo_tb", "depth must be a power of two", depth=3)
    ghdl.refuse("datalink_tb", "datalink must be full, lite or none", datalink="light")
    ghdl.refuse("receiver_tb", "checksum must be crc8, xor or none", checksum="crc16")
    ghdl.refuse("subscription_manager_tb", "lower base_hz", groups=16, period=12)
    ghdl.refuse("dead_man_tb", "base_hz is 21, above clock_hz", base_hz=21)
