# SPDX-License-Identifier: BSD-3-Clause
"""The plugins of a configuration: their pins, their joints, and what LinuxCNC connects to them."""

from __future__ import annotations

import re
from dataclasses import dataclass, field

from .document import Node


@dataclass
class PluginPin:
    """A pin as the file names it.

    `inverted`: at 0 it is on. `error_level` is that of an output when the PC is silent, or None.
    """

    node: Node
    where: str
    inverted: bool = False
    error_level: bool | None = None

    def turn(self) -> None:
        """Invert it."""
        self.inverted = not self.inverted
        self.error_level = None if self.error_level is None else not self.error_level


@dataclass
class Plugin:
    """A plugin of the file. `joint` is its number among the joints of LinuxCNC."""

    node: Node
    kind: str
    name: str
    pins: dict[str, PluginPin]
    joint: int | None = None
    nets: dict[str, str] = field(default_factory=dict)  # signal -> pin of LinuxCNC


def read_plugins(rows: list[Node], notes: list[str]) -> list[Plugin]:
    """Return the plugins in the order of the file. Raises Failure with the place of a mistake."""
    found: list[Plugin] = []
    joints = 0
    for number, node in enumerate(rows):
        kind = node.text("type")
        if not kind:
            raise node.wrong("a plugin has a type", 'riocore\'s examples write {"type": "stepdir", ...}')
        plugin = Plugin(node, kind, node.text("name") or node.text("uid") or f"{kind}{number}", {})
        pins = node.get("pins")
        for role, pin in pins.members() if pins is not None else ():
            plugin.pins[role] = _pin(pin, notes)
        if node.flag("is_joint"):
            plugin.joint = joints
            joints += 1
        signals = node.get("signals")
        for name, signal in signals.members() if signals is not None else ():
            if re.fullmatch(r"[\w.,\s-]+", net := signal.text("net")):
                plugin.nets[name] = net
            signal.give_back("net")  # whoever understands it takes it
        found.append(plugin)
    return found


def _pin(node: Node, notes: list[str]) -> PluginPin:
    if isinstance(node.value, (str, int)):  # the short form
        return PluginPin(node, str(node.value).strip())
    pin = PluginPin(node, node.text("pin"))
    for key in ("modifier", "modifiers"):
        told = node.get(key)
        for one in told.rows() if told is not None else ():
            kind = one.text("type")
            if kind == "invert":
                pin.turn()
            elif kind == "onerror":
                pin.error_level = one.flag("invert")
            else:
                notes.append(f"{one.place}: {kind or 'a modifier without a type'}: there is none on our pins")
    pull = node.text("pull")
    if pull not in ("", "up"):
        notes.append(f"{node.place}.pull: {pull}: the pull of a pin is said in the board's board.toml")
    return pin
