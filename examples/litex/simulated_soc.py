# SPDX-License-Identifier: BSD-3-Clause
"""A SoC of LiteX with our slaves, whose bus is on pins:  python simulated_soc.py FOLDER

LiteX writes its Verilog into FOLDER/gateware/soc.v, and the addresses of its registers into FOLDER/csr.csv.
tests/gateware/litex_bench.sv is the master of the bus. On a board a processor of LiteX takes its place.
"""

from __future__ import annotations

import os
import sys
from pathlib import Path
from typing import Any

from litex.build.generic_platform import GenericPlatform, Pins, Subsignal
from litex.soc.integration.builder import Builder
from litex.soc.integration.soc import SoCRegion
from litex.soc.integration.soc_core import SoCMini
from litex.soc.interconnect import wishbone
from migen import ClockDomain, Module
from unitylink_module import UnityLinkSlaves

_MASTER = {"adr": 30, "dat_w": 32, "dat_r": 32, "sel": 4, "cti": 3, "bte": 2}
_MASTER |= dict.fromkeys(("cyc", "stb", "we", "ack", "err"), 1)
_IO = [
    ("clk", 0, Pins(1)),
    ("rst", 0, Pins(1)),
    ("pmoda", 0, Pins(8)),
    ("master", 0, *(Subsignal(name, Pins(bits)) for name, bits in _MASTER.items())),
]


class Platform(GenericPlatform):
    """Pins without places. Its `build` only writes the Verilog."""

    def __init__(self, folder: Path) -> None:
        super().__init__("simulation", _IO, name="soc")
        self.output_dir = str(folder)

    def build(self, fragment: Any, build_dir: str, build_name: str, **_: Any) -> None:
        os.chdir(build_dir)  # the Verilog writes files of memory beside itself
        self.finalize(fragment)
        self.get_verilog(fragment, name=build_name).write(f"{build_name}.v")


class Clocks(Module):
    """The clock and the reset of the SoC, from pins."""

    def __init__(self, platform: Platform) -> None:
        self.clock_domains.cd_sys = ClockDomain()
        self.comb += [
            self.cd_sys.clk.eq(platform.request("clk")),
            self.cd_sys.rst.eq(platform.request("rst")),
        ]


class SimulatedSoC(SoCMini):
    """LiteX's interconnect between a master on pins and our slaves at 0x90000000."""

    def __init__(self, platform: Platform) -> None:
        SoCMini.__init__(self, platform, clk_freq=50_000_000)
        self.submodules.clocks = Clocks(platform)
        master = wishbone.Interface(data_width=32, adr_width=30)
        self.comb += master.connect_to_pads(platform.request("master"), mode="slave")
        self.bus.add_master("master", master)
        self.submodules.unitylink = UnityLinkSlaves(platform, platform.request("pmoda"))
        region = SoCRegion(origin=0x90000000, size=0x1000, cached=False)
        self.bus.add_slave("unitylink", self.unitylink.bus, region)


def main() -> None:
    """Write the SoC into the folder of the command line."""
    folder = Path(sys.argv[1]).resolve()
    soc = SimulatedSoC(Platform(folder))
    builder = Builder(soc, output_dir=str(folder), compile_software=False, csr_csv=str(folder / "csr.csv"))
    builder.build(build_name="soc")


if __name__ == "__main__":
    main()
