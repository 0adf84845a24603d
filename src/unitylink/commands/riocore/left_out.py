# SPDX-License-Identifier: BSD-3-Clause
"""Why something of a configuration has no counterpart in a spec."""

from __future__ import annotations

import json

from .document import Node

_NETWORK = "the gateware has no Ethernet; the link is the one of our board"
_LINK = "the link is the one of our board, which its page names"
_SOFTWARE = "it uses the pins of the PC, not those of the FPGA"
NO_COMPONENT = "no component does this; docs/components.md has those that there are"
# kind of plugin -> why it is left out. Those that are not here have no component either.
KINDS = {
    **dict.fromkeys(("w5500", "rmii", "arty_mii", "enc28j60"), _NETWORK),
    **dict.fromkeys(("uart", "spi", "spi_prog", "axi"), _LINK),
    **dict.fromkeys(
        ("stepgen", "encoder", "pwmgen", "gpioin", "gpioout", "rpigpio", "rpii2c", "parport"), _SOFTWARE
    ),
    **dict.fromkeys(("hy_vfd", "spacenav", "mqtt", "camjog", "camera"), "it is no part of the FPGA"),
    "blink": "no component; let your program change a pin",
    "bldc": "foc closes a current loop; write it with its wires and numbers into the spec",
    **dict.fromkeys(
        ("modbus", "mbus"),
        "modbus_master does this; riocore's page does not say how its table is written, so write ours",
    ),
    "stepper": "stepgen gives step and direction, not the phases of a motor",
    "breakout": "its own wiring is not in this file; name its pins with --pin",
}
# keys that say how something is drawn, or that riocore ignores
_SILENT = frozenset(
    ("pos", "rotate", "image", "sub_pos", "uid", "comment", "description", "flow", "display", "axis", "gui")
)
_KEYS = {
    "net": "LinuxCNC connects it; your program does here",
    "setp": "LinuxCNC sets it; your program does here",
    "function": "LinuxCNC connects it; your program does here",
    "linuxcnc": "settings of LinuxCNC, which is not needed here",
    "toolchain": "`unitylink build` knows the tools of its boards",
    "flashcmd": "`unitylink flash` knows how to load its boards",
    "protocol": _LINK,
    "modules": "wiring that is not in this file; name its pins with --pin",
    "breakouts": "wiring that is not in this file; name its pins with --pin",
    "expansion": "no component gives pins behind shift registers",
    **dict.fromkeys(
        ("ferror", "min_ferror", "home", "home_offset", "home_search_vel", "home_latch_vel", "home_sequence"),
        "LinuxCNC plans the motion; your program does here",
    ),
    **dict.fromkeys(("min_limit", "max_limit"), "no limit of positions in gateware; your program keeps it"),
    "scale": "a scale of LinuxCNC; say it in the spec",
    "offset": "an offset of LinuxCNC; say it in the spec",
    "bitwidth": "the widths of our words are those of the component",
    "rps_sum": "no mean of speeds",
}


def left_out(node: Node) -> list[str]:
    """Return a note for each key of `node` that nobody has asked for."""
    notes = []
    for one in node.left():
        key = one.place.rpartition(".")[2]
        if key.startswith("_") or key in _SILENT or one.value in (None, "", [], {}, False):
            continue
        shown = "" if isinstance(one.value, (dict, list)) else f" = {json.dumps(one.value)[:60]}"
        notes.append(f"{one.place}{shown}: {_KEYS.get(key, 'not taken')}")
    return notes
