# SPDX-License-Identifier: BSD-3-Clause
"""The Verilog for Verilator: a prepared netlist, in a module whose inputs are registers."""

from __future__ import annotations

import re
from collections.abc import Sequence

from unitylink.errors import ToolError
from unitylink.gateware import Port, ports_of

from .lean import lean

_ASSERTION = re.compile(
    r"/\* (?P<file>\S+):(?P<line>\d+):\d+  \*/\n(?P<before>\s*always @\*\n\s*if \(!\w+\)\n\s*)"
    r'\$fatal\(1, "[^"]*"\);'
)
_JOINED = re.compile(r"assign (\w+) = \{([\w, ]+)\};")
_CASE = re.compile(
    r"case \((?P<selector>\w+)\)\n(?P<arms>(?:\s*\d+'b[01]+: [^;]+;\n)+)"
    r"\s*default: (?P<otherwise>[^;]+;)\n\s*endcase"
)
_ARM = re.compile(r"'b([01]+): ([^;]+;)")
_CLOCK = re.compile(r"\bclock\b|\bnegedge\b|\bposedge\b")
_ONLY_CLOCKS = re.compile(r"posedge clock\b|\binput +clock\b|\.clock\(clock\)")
# Words and the clock have no registers. A board has many words, and copying them would cost time in every
# clock.
_STRAIGHT = ("clock", "read_words")
_STREAMS = {
    "clock": 1,
    "reset": 1,
    "rx_valid": 1,
    "rx_data": 8,
    "rx_error": 3,
    "tx_ready": 1,
    "rx_ready": 1,
    "tx_valid": 1,
    "tx_data": 8,
}


def stream_ports_of(netlist: str, top: str) -> tuple[Port, ...]:
    """Return the ports of the module `top`. Raises ToolError if it is absent or has no byte streams."""
    ports = ports_of(netlist, top)
    found = {port.name: port.bits for port in ports}
    if missing := [f"{name} ({bits} bits)" for name, bits in _STREAMS.items() if found.get(name) != bits]:
        raise ToolError(f"{top} cannot be simulated live: it has no port {', '.join(missing)}")
    return ports


def pins_of(netlist: str, top: str, names: Sequence[str]) -> tuple[tuple[Port, ...], tuple[Port, ...]]:
    """Return the inputs and the outputs of `top` that are pins, in the order of `names`."""
    found = {port.name: port for port in ports_of(netlist, top)}
    pins = [found[name] for name in names if name in found]
    return tuple(pin for pin in pins if pin.is_input), tuple(pin for pin in pins if not pin.is_input)


def model_of(netlist: str, top: str, pins: Sequence[str] = ()) -> str:
    """Return `netlist` with a module `model` around `top`. `pins` are the names of the pins of components.

    The inputs of `model` end in `_next`, and registers take them. So no logic depends directly on an input,
    and Verilator computes a clock once instead of three times. If `either_edge_will_do`, each edge of the
    clock is one of the design's clocks. A failing assertion of the VHDL calls unitylink_failed(). The pins
    are side by side in pins_in and pins_out.
    """
    design = with_plain_choices(with_named_assertions(lean(netlist)))
    edge = "posedge clock"
    if either_edge_will_do(netlist):
        edge += " or negedge clock"
        design = design.replace("@(posedge clock)", f"@({edge})")
    inputs, outputs = pins_of(netlist, top, pins)
    inner = stream_ports_of(netlist, top)
    wired = {port.name: port.name for port in inner}
    ports = [port for port in inner if port not in (*inputs, *outputs)]
    for joined, some in (("pins_in", inputs), ("pins_out", outputs)):
        if some:
            ports.append(Port(joined, joined == "pins_in", sum(pin.bits for pin in some)))
            wired |= _slices(joined, some)
    registers = [port for port in ports if port.is_input and port.name not in _STRAIGHT]
    outer = [
        f"  {'input' if port.is_input else 'output'} {port.range}{port.name}"
        + ("_next" if port in registers else "")
        for port in ports
    ]
    return "\n".join(
        [
            "module model(",
            ",\n".join(outer) + ");",
            *(f"  reg {port.range}{port.name} = 0;" for port in registers),
            f"  always @({edge}) begin",
            *(f"    {port.name} <= {port.name}_next;" for port in registers),
            "  end",
            f"  {top.lower()} design_(",
            ",\n".join(f"    .{port.name}({wired[port.name]})" for port in inner) + ");",
            "endmodule",
            design,
        ]
    )


def _slices(joined: str, pins: Sequence[Port]) -> dict[str, str]:
    """Return {port: its place in the vector `joined`}."""
    found, at = {}, 0
    if len(pins) == 1:
        return {pins[0].name: joined}
    for pin in pins:
        found[pin.name] = f"{joined}[{at + pin.bits - 1}:{at}]"
        at += pin.bits
    return found


def either_edge_will_do(netlist: str) -> bool:
    """Tell whether `netlist` uses clocks only to wait for the rising edge of `clock`."""
    return not _CLOCK.search(_ONLY_CLOCKS.sub("", netlist))


def with_named_assertions(netlist: str) -> str:
    """Let a failing assertion report its place in the VHDL, instead of ending the program."""

    def call(found: re.Match[str]) -> str:
        file = found["file"].rpartition("/")[2]
        return f'{found["before"]}$c("unitylink_failed(\\"{file}:{found["line"]}\\");");'

    named = _ASSERTION.sub(call, netlist)
    if "$fatal" in named:
        raise ToolError(
            "the netlist has an assertion in a form that is not known; is this GHDL newer than 2.0?"
        )
    return named


def with_plain_choices(netlist: str) -> str:
    """Turn cases over joined bits, of which one is set, into a chain of conditions.

    GHDL makes such cases from every case statement and selected assignment of the VHDL. Their choices exclude
    each other. Verilator would join the bits and compare them with every choice in every clock. That would be
    half of its work.
    """
    end = "endmodule"
    return end.join(_with_plain_choices(module) for module in netlist.split(end))


def _with_plain_choices(module: str) -> str:
    bits_of = {name: bits.split(", ") for name, bits in _JOINED.findall(module)}

    def questions(found: re.Match[str]) -> str:
        bits = bits_of.get(found["selector"])
        arms = _ARM.findall(found["arms"])
        if bits is None or any(len(choice) != len(bits) or choice.count("1") != 1 for choice, _ in arms):
            return found[0]
        asked = [f"if ({bits[choice.index('1')]}) {action}" for choice, action in arms]
        return "\n    else ".join([*asked, found["otherwise"]])

    return _CASE.sub(questions, module)
