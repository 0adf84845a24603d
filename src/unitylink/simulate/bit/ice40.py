# SPDX-License-Identifier: BSD-3-Clause
"""From a bitstream of an iCE40 back to logic: the Verilog of IceStorm gets one clock and plain pins."""

from __future__ import annotations

import hashlib
import re
import tempfile
from collections.abc import Mapping
from pathlib import Path

from unitylink.errors import BoardError, ToolError
from unitylink.gateware import find_program, run_tool

from ..rtl.cache import cached
from .chip import Chip

_REMEDY = "on Debian or Ubuntu: sudo apt-get install fpga-icestorm"
_DEVICES = {
    "hx8k": "8k",
    "up5k": "5k",
    "hx1k": "1k",
    "lp1k": "1k",
    "lp8k": "8k",
}  # nextpnr's name -> IceStorm's
_LINES_SHOWN = 4
_HEAD = re.compile(r"^module chip \((.*?)\);$", re.MULTILINE)
_PORT = re.compile(r"(input|output|inout) pin_(\w+)")
_PLL = re.compile(r"SB_PLL40_(?P<kind>\w+) #\((?P<parameters>.*?)\n\) \w+ \((?P<wires>.*?)\n\);\n", re.DOTALL)
_GIVEN = re.compile(r"\.(\w+)\((.*?)\),?$", re.MULTILINE)
_RAM = re.compile(r"SB_RAM40_4K #\((?P<parameters>.*?)\n\) (?P<name>\w+) \((?P<wires>.*?)\n\);\n", re.DOTALL)
_WIRES = re.compile(r"^wire (.*?);$", re.MULTILINE)
_EDGE = re.compile(r"@\((posedge|negedge) (\w+)")  # the first is the clock's, a second one is a reset's
_SAME = re.compile(r"assign (\w+) += (?:/\*[^*]*\*/ )?(\w+|1'b[01]);")
_FLOATING = re.compile(r"^assign pin_(\w+) = (\w+) \? (\w+) : 1'bz;$", re.MULTILINE)
_DRIVEN = re.compile(r"\bassign (\w+) +=|\breg (\w+)\b|(?:^reg |, )(\w+) = 0(?=[,;])", re.MULTILINE)
_NET = re.compile(r"(?<![\w'.])(n\d+)\b")


def unpack(bitstream: bytes, *, device: str, package: str | None, clock_site: str, clock_hz: int) -> Chip:
    """Return the logic that `bitstream` puts into an iCE40 (`device`, `package` as nextpnr names them).

    Without a package the sites are places on the chip: "33_16_0". `clock_hz` is the frequency at the pin
    `clock_site`. If the bitstream has a PLL, its dividers say what becomes of it. Raises ToolError if a
    program is missing, or if the bitstream has a part that is not modelled. Raises BoardError if the file is
    not a bitstream of this chip.
    """
    if device not in _DEVICES:
        raise BoardError(f"IceStorm cannot unpack a bitstream of {device}; it can for {', '.join(_DEVICES)}")
    text = _icebox(bitstream, _DEVICES[device], package)
    text, clock, made_hz = _without_pll(text, clock_site, clock_hz)
    text = _one_clock(_with_rams(text), clock)
    verilog, inputs, outputs = _with_plain_pins(text, clock_site)
    check_driven(verilog)
    return Chip(verilog, made_hz, inputs, outputs)


def _icebox(bitstream: bytes, device: str, package: str | None) -> str:
    """Return the Verilog that IceStorm makes of a bitstream. It takes some seconds, so it is kept."""
    unpacker, printer = (find_program([name], _REMEDY) for name in ("iceunpack", "icebox_vlog"))
    parts = [
        bitstream,
        Path(unpacker).read_bytes(),
        Path(printer).read_bytes(),
        f"{device} {package}".encode(),
    ]
    key = hashlib.sha256(b"\0".join(parts)).hexdigest()[:32]

    def unpack_into(file: Path) -> None:
        file.write_text(_printed(bitstream, device, package, unpacker, printer), encoding="utf-8")

    return cached(key, unpack_into, kind="bit", suffix=".v").read_text(encoding="utf-8")


def _printed(bitstream: bytes, device: str, package: str | None, unpacker: str, printer: str) -> str:
    with tempfile.TemporaryDirectory(prefix="unitylink-bit-") as work:
        folder = Path(work)
        (folder / "chip.bin").write_bytes(bitstream)
        ended = run_tool([unpacker, "chip.bin", "chip.asc"], folder, joined=True)
        asc = folder / "chip.asc"
        if ended.code != 0 or not asc.is_file():
            raise BoardError(f"it is not a bitstream of an iCE40: {_last(ended.out)}")
        found = re.search(r"^\.device (\w+)$", asc.read_text(encoding="utf-8"), re.MULTILINE)
        if found is None or found[1] != device:
            raise BoardError(f"it is a bitstream of an iCE40 {found[1] if found else '?'}, not of a {device}")
        sites = [] if package is None else ["-l", "-d", package]
        ended = run_tool([printer, "-s", *sites, "chip.asc"], folder)
        if ended.code != 0:
            raise ToolError(f"icebox_vlog ended with {ended.code}: {_last(ended.err)}")
        return re.sub(r"\bio_(\d+_\d+_\d)\b", r"pin_\1", ended.out)


def _last(said: str) -> str:
    return "\n".join(said.strip().splitlines()[-_LINES_SHOWN:])


def _without_pll(text: str, clock_site: str, clock_hz: int) -> tuple[str, str, int]:
    """Take the PLL out. Return the rest, the net of the clock, and its frequency."""
    found = _PLL.search(text)
    if found is None:
        return text, f"pin_{clock_site}", clock_hz
    given = {name: value.strip('"') for name, value in _GIVEN.findall(found["parameters"])}
    wires = dict(_GIVEN.findall(found["wires"]))
    reference = wires.get("PACKAGEPIN", wires.get("REFERENCECLK", ""))
    path = given.get("FEEDBACK_PATH")
    if found["kind"] not in ("PAD", "CORE") or path != "SIMPLE" or given.get("PLLOUT_SELECT") != "GENCLK":
        raise ToolError(f"the bitstream has a PLL that is not modelled: SB_PLL40_{found['kind']}, {path}")
    if reference != f"pin_{clock_site}":
        raise ToolError(
            f"the PLL of the bitstream takes its clock from {reference}, not from pin {clock_site}"
        )
    dividers = {name: int(given[name].partition("'b")[2], 2) for name in ("DIVR", "DIVF", "DIVQ")}
    oscillator = clock_hz * (dividers["DIVF"] + 1) / (dividers["DIVR"] + 1)
    lock = f"unitylink_lock lock_(.clock(clock), .lock({wires['LOCK']}));\n"
    outputs = [wires[name] for name in ("PLLOUTGLOBAL", "PLLOUTCORE") if name in wires]
    text = text[: found.start()] + lock + text[found.end() :]
    for net in outputs[1:]:  # both outputs are the same clock
        text = re.sub(rf"\b{net}\b", outputs[0], text)
    return text, outputs[0], round(oscillator / 2 ** dividers["DIVQ"])


def _with_rams(text: str) -> str:
    """Turn block RAMs into cells of cells.v, which have one clock. A constant clock is none, as of a ROM."""
    same = dict(_SAME.findall(text))

    def cell(found: re.Match[str]) -> str:
        wires = dict(_GIVEN.findall(found["wires"]))
        clocks = {_origin(wires.pop(name, "1'b0"), same) for name in ("RCLK", "WCLK")} - {"1'b0", "1'b1"}
        if len(clocks) != 1:
            raise ToolError(
                f"the bitstream has a block RAM with two clocks ({found['name']}): that is not modelled"
            )
        links = ", ".join(f".{name}({value})" for name, value in wires.items())
        return (
            f"unitylink_ram40 #({found['parameters']}) {found['name']} (.clock({clocks.pop()}), {links});\n"
        )

    return _RAM.sub(cell, text)


def _origin(net: str, same: Mapping[str, str]) -> str:
    """Return the net or the constant of which `net` is only another name."""
    while net in same:
        net = same[net]
    return net


def _one_clock(text: str, clock: str) -> str:
    """Call the net of the clock `clock`. Raises ToolError if a flip-flop or a memory has another one."""
    used = {net for _, net in _EDGE.findall(text)} | set(re.findall(r"\.clock\((\w+)\)", text))
    if others := used - {clock, "clock"}:
        raise ToolError(
            f"the bitstream has a second clock ({', '.join(sorted(others))}): only one clock can be run"
        )
    if re.search(r"SB_RAM40|dsp\d_", text):
        raise ToolError(
            "the bitstream has a multiplier or a block RAM on a falling edge: they are not modelled"
        )
    return re.sub(rf"\b{clock}\b", "clock", text)


def _with_plain_pins(text: str, clock_site: str) -> tuple[str, tuple[str, ...], tuple[str, ...]]:
    """Give each pin its own ports in each direction. Return the text, the inputs and the outputs."""
    head = _HEAD.search(text)
    if head is None:
        raise ToolError("icebox_vlog printed no module `chip`; is this another version of IceStorm?")
    inputs, outputs, ports, body = [], [], ["input clock"], []
    floating = {site: (drive, value) for site, drive, value in _FLOATING.findall(text)}
    rest = _FLOATING.sub("", text[head.end() :])
    for way, site in _PORT.findall(head[1]):
        if site == clock_site and not re.search(rf"\bpin_{site}\b", _WIRES.sub("", rest)):
            continue  # only the PLL takes it
        pin = f"pin_{site}"
        if way == "input" and site not in floating:
            ports.append(f"input {pin}_in")
            body.append(f"assign {pin} = {pin}_in;")
            inputs.append(site)
            continue
        drive, value = floating.get(site, ("1'b1", pin))
        ports += [f"output {pin}_out", f"output {pin}_drive"]
        body += [f"assign {pin}_out = {value};", f"assign {pin}_drive = {drive};"]
        outputs.append(site)
        if site in floating:
            ports.append(f"input {pin}_in")
            body.append(f"assign {pin} = {pin}_drive ? {pin}_out : {pin}_in;")
            inputs.append(site)
    declared = _WIRES.sub(_without_clock, rest)
    end = declared.rindex("endmodule")
    verilog = f"module chip({', '.join(ports)});\n{declared[:end]}" + "\n".join(body) + "\nendmodule\n"
    return verilog, tuple(inputs), tuple(outputs)


def _without_clock(wires: re.Match[str]) -> str:
    """Leave the clock out of a declaration, because it is a port."""
    names = [name for name in wires[1].split(", ") if name != "clock"]
    return f"wire {', '.join(names)};" if names else ""


def check_driven(verilog: str) -> None:
    """Raise ToolError if a net is used that nothing drives: the output of a block that is not modelled."""
    driven = {name for names in _DRIVEN.findall(verilog) for name in names if name}
    for wires in re.findall(r"\.(?:RDATA\(\{(.*?)\}\)|lock\((\w+)\))", verilog):
        driven |= set(_NET.findall(" ".join(wires)))
    used = set(_NET.findall(_WIRES.sub("", verilog)))
    if floating := sorted(used - driven):
        raise ToolError(
            "the bitstream uses a block of the chip that is not modelled: nothing drives "
            + ", ".join(floating[:4])
        )
