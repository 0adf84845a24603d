# SPDX-License-Identifier: BSD-3-Clause
"""FIFOs and double buffers of a spec. These slaves have ports for the user's logic on their other side."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from unitylink.spec.model import Instance, Spec

from ..quoting import Part, Vhdl

# Port of the entity -> (direction, kind). The kind is a "bit", a "word" of the bus, or the "place" of a word.
_PINS = {
    "fifo": {
        "to_pc_valid": ("in", "bit"),
        "to_pc_ready": ("out", "bit"),
        "to_pc_data": ("in", "word"),
        "from_pc_valid": ("out", "bit"),
        "from_pc_ready": ("in", "bit"),
        "from_pc_data": ("out", "word"),
    },
    "double_buffer": {
        "committed": ("out", "bit"),
        "user_read_address": ("in", "place"),
        "user_read_data": ("out", "word"),
        "user_write_valid": ("in", "bit"),
        "user_write_ready": ("out", "bit"),
        "user_write_address": ("in", "place"),
        "user_write_data": ("in", "word"),
    },
}
# The value of an input that nothing drives.
_IDLE = {"bit": Vhdl("'0'"), "word": Vhdl("(others => '0')"), "place": Vhdl("0")}
# Accesses without which a side of a slave is useless. The key is the beginning of the names of that side's
# ports.
_NEEDED = {"to_pc_": ("READCLEAR",), "from_pc_": ("PULSE",), "user_write_": ("READ",)}


@dataclass(frozen=True)
class Pin:
    """A port of a slave.

    If it is `used`, it is a port of the design. An input has a `default`. For an output, this is "".
    """

    name: str
    direction: str
    type: Vhdl
    default: Vhdl
    used: bool


@dataclass(frozen=True)
class LinkSlave:
    """A FIFO or double buffer: its place in the spec, its words, and the PC's accesses to it."""

    root: str
    path: str  # qualified as in `Spec.walk`; for a root, its name
    kind: str
    base: int
    words: int
    size: int  # words of a double buffer, depth of a FIFO
    event: str  # the name of its event in the spec, "" for none
    accesses: frozenset[str]

    @property
    def entity(self) -> str:
        return f"{self.kind}_slave"

    def events(self) -> dict[str, str]:
        """Return its event ports, each with its name in the spec."""
        return {"arrival": self.event} if self.event else {}

    @property
    def range(self) -> range:
        """Its addresses."""
        return range(self.base, self.base + self.words)

    def generics(self) -> dict[str, Part]:
        """Return its generics, without `data_width`."""
        if self.kind == "double_buffer":
            return {"words": self.size}
        return {"depth": self.size, "remind_clocks": Vhdl("maximum(4, clock_hz / 50)")}

    def pins(self, data_bits: int) -> Iterator[Pin]:
        """Yield its ports for the user's logic.

        For a side that the spec never uses, yield only the inputs.
        """
        types = {
            "bit": Vhdl("std_ulogic"),
            "word": Vhdl.of("std_ulogic_vector({} downto 0)", data_bits - 1),
            "place": Vhdl.of("natural range 0 to {}", self.size - 1),
        }
        for name, (direction, kind) in _PINS[self.kind].items():
            used = all(
                not name.startswith(side) or self.accesses & set(needed) for side, needed in _NEEDED.items()
            )
            if used or direction == "in":
                default = _IDLE[kind] if direction == "in" else Vhdl("")
                yield Pin(name, direction, types[kind], default, used)


def link_slaves(spec: Spec) -> tuple[LinkSlave, ...]:
    """Return the FIFOs and double buffers of a spec, in its order."""
    found: dict[tuple[str, int, int], LinkSlave] = {}
    accesses: dict[tuple[str, int, int], set[str]] = {}
    for _, element in spec.walk():
        link = element.link
        accesses.setdefault((link.kind, link.base, link.size), set()).add(element.access)

    def below(instance: Instance, root: Instance) -> None:
        link = instance.link
        key = (link.kind, link.base, link.size)
        if link.kind in _PINS and key in accesses and key not in found:
            path = f"{root.name}.{instance.path}".rstrip(".") if len(spec.roots) > 1 else instance.path
            used = frozenset(accesses[key])
            place, event = (root.name, path or root.name), link.event_at(instance.path)
            found[key] = LinkSlave(*place, link.kind, link.base, link.words, link.size, event, used)
        for inner in instance.instances:
            below(inner, root)

    for root in spec.roots:
        below(root, root)
    return tuple(found.values())
