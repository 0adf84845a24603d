# SPDX-License-Identifier: BSD-3-Clause
"""Slaves of Unity-Link on a LiteX SoC: a Wishbone slave with an interrupt, for `soc.bus.add_slave`.

soc.submodules.unitylink = UnityLinkSlaves(soc.platform, pins)
soc.bus.add_slave("unitylink", soc.unitylink.bus, SoCRegion(origin=0x9000_0000, size=0x1000, cached=False))
soc.irq.add("unitylink")
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

from litex.soc.interconnect import wishbone
from litex.soc.interconnect.csr import AutoCSR
from litex.soc.interconnect.csr_eventmanager import EventManager, EventSourceLevel
from migen import Cat, ClockSignal, Instance, Module, ResetSignal, TSTriple

from unitylink.gateware import netlist

TOP = "litex_registers"
SOURCE = Path(__file__).with_name(f"{TOP}.vhd")


class UnityLinkSlaves(Module, AutoCSR):
    """The entity `litex_registers` as a LiteX module: `bus` is its Wishbone, `ev` its interrupt.

    The VHDL goes to the platform as the Verilog that GHDL makes of it, which all of LiteX's tools read.
    """

    def __init__(self, platform: Any, pins: Any) -> None:
        folder = Path(platform.output_dir) if getattr(platform, "output_dir", None) else Path("build")
        folder.mkdir(parents=True, exist_ok=True)
        verilog = folder / f"{TOP}.v"
        verilog.write_text(netlist(TOP, sources=[SOURCE], assertions=False), encoding="utf-8")
        platform.add_source(str(verilog))
        self.bus = bus = wishbone.Interface(data_width=32, adr_width=30)
        self.submodules.ev = EventManager()
        self.ev.unitylink = EventSourceLevel()
        self.ev.finalize()
        pads = [TSTriple() for _ in range(8)]
        self.specials += [pad.get_tristate(pins[number]) for number, pad in enumerate(pads)]
        self.specials += Instance(
            TOP,
            i_clock=ClockSignal(),
            i_reset=ResetSignal(),
            i_cyc=bus.cyc,
            i_stb=bus.stb,
            i_we=bus.we,
            i_adr=bus.adr,
            i_dat_w=bus.dat_w,
            i_sel=bus.sel,
            o_dat_r=bus.dat_r,
            o_ack=bus.ack,
            o_err=bus.err,
            o_interrupt=self.ev.unitylink.trigger,
            i_pin_in=Cat(*(pad.i for pad in pads)),
            o_pin_out=Cat(*(pad.o for pad in pads)),
            o_pin_drive=Cat(*(pad.oe for pad in pads)),
        )
