# SPDX-License-Identifier: BSD-3-Clause
"""A member of the spec that is made, and what all makers of them need."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass

from ..spec_names import Names
from .plugins import Plugin, PluginPin

_VHDL = frozenset(
    ("in", "out", "signal", "label", "reset", "clock", "range", "process", "port", "wait", "on")
)


@dataclass
class Part:
    """A member of the spec: `line` after the name, comments before it, and the pins of its ports.

    A word at a pin has one port, which is called "".
    """

    name: str
    line: str
    comments: list[str]
    pins: dict[str, list[PluginPin | None]]

    @property
    def is_word(self) -> bool:
        return "" in self.pins


class PartList:
    """Collects parts. `notes` gets what has no counterpart. `clock_hz` is that of the design."""

    def __init__(self, notes: list[str], clock_hz: int) -> None:
        self.notes, self.clock_hz = notes, clock_hz
        self.names = Names()
        self.found: list[Part] = []

    def output(self, one: Plugin, role: str, name: str) -> bool:
        """Make a word of an output pin. Return whether there is such a pin."""
        pin = one.pins.get(role)
        if pin is not None:
            off = pin.inverted if pin.error_level is None else pin.error_level
            safe = ("on" if off != pin.inverted else "off") if pin.inverted else int(off)
            self.add(self.new_name(name), f"{bit_type(pin)} WRITE(SAFE={safe})", [], {"": [pin]})
        return pin is not None

    def plain(self, one: Plugin, role: str) -> PluginPin | None:
        """Return a pin of a component. Only the board can invert it."""
        pin = one.pins.get(role)
        if pin is not None and pin.inverted:
            self.notes.append(
                f'{pin.node.place}: invert: mark the pin active = "low" in a board.toml of your own'
            )
        return pin

    def whole(self, one: Plugin, key: str, default: int, least: int, most: int) -> int:
        """Return the whole number at `key`. Raises Failure with its place if it is another value."""
        value = one.node.number(key, default)
        if value is None or value != int(value) or not least <= value <= most:
            where = one.node.get(key)
            assert where is not None
            raise where.wrong(f"a whole number from {least} to {most} is expected")
        return int(value)

    def new_name(self, wanted: str) -> str:
        """Return a name for the spec that no other part has."""
        snake = re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "_", wanted).lower()
        plain = re.sub(r"[^a-z0-9]+", "_", snake).strip("_") or "part"
        plain = f"{plain}_pin" if plain in _VHDL else plain if plain[0].isalpha() else f"n_{plain}"
        return self.names.unique(plain)

    def add(self, name: str, line: str, comments: list[str], pins: dict[str, list[PluginPin | None]]) -> None:
        """Add a part."""
        self.found.append(Part(name, line, comments, pins))

    def leave_out(self, one: Plugin, why: str) -> None:
        """Tell that a plugin gives nothing."""
        self.notes.append(f"{one.node.place} ({one.kind} {one.name}): left out: {why}")


def bit_type(pin: PluginPin) -> str:
    """Return the type of a word at a pin."""
    return "inverted" if pin.inverted else "bool"


def chunks(found: list[Plugin], most: int) -> Iterator[list[Plugin]]:
    """Yield the plugins in groups of at most `most`."""
    for first in range(0, len(found), most):
        yield found[first : first + most]
