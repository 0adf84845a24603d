# SPDX-License-Identifier: BSD-3-Clause
"""Components in a design, or in a node of its ring: their generics, pins, events and wires."""

from __future__ import annotations

from collections.abc import Mapping

from unitylink.errors import BindingError

from ..quoting import Part, Vhdl
from .names import KEYWORDS, Names
from .plan import Placed, Port
from .words import PlacedComponent


def place(
    number: int,
    part: PlacedComponent,
    wires: Mapping[tuple[str, str], int],
    names: Names,
    *,
    data_width: Vhdl,
    events: tuple[tuple[str, tuple[int, ...]], ...] = (),
) -> Placed:
    """Place a component as this slave of a bus. Its pins get `names`, and it drives the lines of `events`."""
    component = part.component
    for name in (component.entity, *(port for port, _, _ in component.pins), *component.events):
        if name.lower() in KEYWORDS:
            raise BindingError(
                f"vhdl: {part.path}: {name} is a keyword of VHDL or Verilog; give it another name"
            )
    own: dict[str, Part] = {"clock_hz": "clock_hz", "data_width": data_width}
    given = {
        name: own.get(name, Vhdl.of('"{}"', value) if isinstance(value, str) else value)
        for name, value in component.generics
    }
    pins, ports = [], []
    for port, direction, bits in component.pins:
        name = names.claim(f"{part.path}_{port}")
        base = Vhdl("std_logic") if direction == "inout" else Vhdl("std_ulogic")
        kind = Vhdl.of("{}_vector({} downto 0)", base, bits - 1) if bits else base
        ports.append(Port(name, direction, kind))
        pins.append((port, name))
    return Placed(
        number=number,
        path=part.path,
        span=span(component.base, component.words),
        library="work" if component.sources else "unitylink",
        entity=component.entity,
        generics=tuple({**given, "data_width": own["data_width"]}.items()),
        pins=tuple(pins),
        events=events,
        wires=tuple((port, wire) for (path, port), wire in wires.items() if path == part.path),
        ports=tuple(ports),
    )


def span(base: int, words: int) -> str:
    """Return addresses for a comment."""
    return f"0x{base:03X}" if words == 1 else f"0x{base:03X} to 0x{base + words - 1:03X}"
