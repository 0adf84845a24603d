# SPDX-License-Identifier: BSD-3-Clause
"""The ports of a component side by side, for a bench that drives and sees them as vectors."""

from __future__ import annotations

from unitylink.interface.components import ComponentConfiguration

WIRE_BITS = 33  # of wire_pkg.vhd


def component_ports(one: ComponentConfiguration) -> dict[str, str | int]:
    """Return what a bench's text needs to contain a component: entity, generics, ports and the highest bits
    of the vectors inputs, outputs and events. Wires to other components are pins here, behind the others.
    """
    ports, width = "", {"in": 0, "out": 0}
    wires = [(name, direction, WIRE_BITS) for name, direction in one.wires]
    for name, direction, bits in (*one.pins, *wires):
        at = width[direction]
        width[direction] += bits or 1
        signal = "inputs" if direction == "in" else "outputs"
        ports += f",\n      {name} => {signal}" + (f"({at + bits - 1} downto {at})" if bits else f"({at})")
    for number, name in enumerate(one.events):
        ports += f",\n      {name} => events({number})"
    return {
        "entity": one.entity,
        "generics": ", ".join(
            f'{name} => "{value}"' if isinstance(value, str) else f"{name} => {value}"
            for name, value in one.generics
        ),
        "ports": ports,
        "inputs": max(1, width["in"]) - 1,
        "outputs": max(1, width["out"]) - 1,
        "events": max(1, len(one.events)) - 1,
    }
