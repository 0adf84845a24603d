# SPDX-License-Identifier: BSD-3-Clause
"""A replay on bitstreams: the core is placed on a chip, unpacked and compiled."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from unitylink._native import RtlDevice
from unitylink.errors import ToolError
from unitylink.gateware import netlist, ports_of
from unitylink.simulate.bit.bare import HX8K, BareChip, on_chip
from unitylink.simulate.rtl import RtlModel
from unitylink.simulate.rtl.build import build_of_netlist

from .bench import CLOCKS_MOST
from .rtl import generics_of

if TYPE_CHECKING:
    from unitylink.simulate import BoardConfiguration

_HERE = Path(__file__).parent
_TOP, _CORE = "replay_core", "core_pins"
_MEMORY = ("recorded", "bad_base")  # generics of the memory, not of the core
_STREAMS = ("rx_valid", "rx_ready", "rx_data", "rx_error", "tx_valid", "tx_ready", "tx_data", "events")
_LOOK_CLOCKS = 50
_LATE_CLOCKS = 1  # inputs of a model pass a register, so its bytes come later than in the bench


class ChipPlayer:
    """A player that gives the steps to the core on a chip, as `RtlPlayer` gives them to the core in GHDL.

    Without `placed` it is the compiled VHDL, with the same memory around it. A core is built at its first
    use, which takes about a minute. `say` gets what is being done.
    """

    def __init__(
        self,
        *,
        placed: bool = True,
        say: Callable[[str], None] = lambda _: None,
        protocol: str = "both",
        chip: BareChip = HX8K,
    ) -> None:
        self._placed = placed
        self._say = say
        self._protocol = protocol
        self._chip = chip

    def __call__(
        self,
        configuration: BoardConfiguration,
        exchanges: Sequence[Sequence[tuple[str, Any]]],
        /,  # positional only, because the core has a generic of that name, too
        **generics: int | str | bool,
    ) -> list[bytes]:
        """Do the exchanges in order from reset.

        Return the bytes that the core sent during each one. Raises ToolError, and BoardError if it does not
        fit.
        """
        from unitylink.simulate import BoardConfiguration

        settings = {**generics_of(configuration), "protocol": self._protocol, **generics}
        model = RtlModel(self._library(settings), (), ())
        device = RtlDevice(BoardConfiguration(groups=int(settings["groups"])), model)
        sent: list[tuple[int, int]] = []
        ends = [_play(device, steps, sent) for steps in exchanges]
        device.run_until(device.clock + _LATE_CLOCKS)
        sent += device.take_timed()
        starts = [-1, *ends[:-1]]
        ends[-1] = device.clock
        return [
            bytes(byte for at, byte in sent if start + _LATE_CLOCKS < at <= end + _LATE_CLOCKS)
            for start, end in zip(starts, ends, strict=True)
        ]

    def _library(self, settings: dict[str, int | str | bool]) -> str:
        core = {name: value for name, value in settings.items() if name not in _MEMORY}
        verilog = netlist(_CORE, sources=[_HERE / f"{_CORE}.vhd"], generics=core, assertions=False)
        ports = {port.name: port.bits for port in ports_of(verilog, _CORE)}
        if self._placed:
            verilog = on_chip(verilog, _CORE, self._say, self._chip)
        sizes = {
            "ADDRESS_BITS": settings.get("address_bits", 8),
            "PORT_BITS": ports["address"],
            "DATA_BITS": ports["to_memory"],
            "RECORDED": int(settings.get("recorded", 1)),
            "BAD": settings.get("bad_base", 0),
        }
        memory = (_HERE / "memory.v").read_text(encoding="utf-8")
        return build_of_netlist(_around(ports, sizes) + memory + verilog, _TOP, self._say)


def _around(ports: dict[str, int], sizes: dict[str, Any]) -> str:
    """Return the module that joins the core and its memory."""
    given = {name: ports[name] for name in ("clock", "reset", *_STREAMS)}
    heads = ",\n   ".join(
        f"{'output' if name in ('rx_ready', 'tx_valid', 'tx_data') else 'input '} "
        f"{f'[{bits - 1}:0] ' if bits > 1 else ''}{name}"
        for name, bits in given.items()
    )
    streams = ", ".join(f".{name}({name})" for name in given)
    bus = ("strobe", "write", "address", "to_memory", "from_memory", "done", "refused")
    wires = "\n".join(f"wire {f'[{ports[name] - 1}:0] ' if ports[name] > 1 else ''}{name};" for name in bus)
    links = ", ".join(f".{name}({name})" for name in bus)
    parameters = ", ".join(f".{name}({value})" for name, value in sizes.items())
    return (
        f"module {_TOP}\n  ({heads});\n{wires}\n{_CORE} core_ ({streams}, {links});\n"
        f"replay_memory #({parameters}) memory_ (.clock(clock), .strobe(strobe), .write(write), "
        ".address(address), .given(to_memory), .word(from_memory), .done(done), .refused(refused));\n"
        "endmodule\n"
    )


def _play(device: RtlDevice, steps: Sequence[tuple[str, Any]], sent: list[tuple[int, int]]) -> int:
    """Do the steps of an exchange, and append (clock, byte) of what the core sends.

    Return the clock at the end.
    """
    for kind, value in steps:
        _step(device, kind, value, sent)
        sent += device.take_timed()
    return device.clock


def _step(device: RtlDevice, kind: str, value: Any, sent: list[tuple[int, int]]) -> None:
    if kind == "send":
        data = value.encode("latin-1")
        while data or not device.input_empty:
            data = data[device.receive(data) :]
            device.run_until(device.clock + 1)
    elif kind == "wait":
        device.run_until(device.clock + value)
    elif kind == "quiet":
        _run_until_quiet(device, value, sent)
    elif kind == "events":
        device.run_until(device.clock + 1)
        device.set_events(value)
    elif kind == "reset":
        device.reset()
    elif kind == "rx_error":
        device.receive_error(value)
        device.run_until(device.clock + 1)
    else:
        raise ToolError(f"a core on a chip cannot be given the step {kind!r}")


def _run_until_quiet(device: RtlDevice, clocks: int, sent: list[tuple[int, int]]) -> None:
    """Run until no byte has moved for so many clocks."""
    start = last = device.clock
    while device.clock < last + clocks:
        device.run_until(min(device.clock + _LOOK_CLOCKS, last + clocks))
        sent += device.take_timed()
        last = max(last, sent[-1][0]) if sent else last
        if device.clock - start > CLOCKS_MOST:
            raise ToolError("the core does not fall quiet")
