# SPDX-License-Identifier: BSD-3-Clause
"""From a configuration of riocore to the text of a spec, and to the pins for `unitylink build`."""

from __future__ import annotations

import re
import sys
from pathlib import Path

from unitylink.boards.pins import OPEN, lines_of
from unitylink.gateware import Port
from unitylink.generate import SpecPlan
from unitylink.generate.vhdl import plan_designs
from unitylink.spec.model import Spec

from ..failure import Failure
from ..imported import Imported, checked
from ..spec_names import Names
from .document import Node, read_document
from .left_out import left_out
from .part import Part
from .parts import Parts
from .pins import BoardPins
from .plugins import Plugin, PluginPin, read_plugins

INVERTED = "/// A pin on which 0 is on.\nenum inverted: u1 { on = 0; off = 1; }\n\n"
_COLUMNS = 100
_CLOCK_HZ = 25_000_000  # of a board that we do not know


def import_riocore(path: str, board: str | None = None, out: str | None = None) -> Imported:
    """Return the spec of a configuration. `board` is one of ours, if it is not that of the file.

    `out` is the name that the spec will have. Raises Failure with the place of a mistake in the file, and
    BoardError if there is no such board.
    """
    document = read_document(path)
    document.object()
    notes: list[str] = []
    listed = document.get("plugins")
    if listed is None:
        raise document.wrong("a configuration of riocore has plugins", "is it another JSON file?")
    plugins = read_plugins(listed.rows(), notes)
    theirs = document.text("boardcfg") or _node_type(plugins) or document.text("name")
    pins = BoardPins(theirs, board, plugins)
    if pins.board is None:
        notes.append(
            f"boardcfg = {theirs!r}: no board of ours; say --board, or add it (docs/own-fpga-board.md)"
        )
    clock_hz = pins.board.design_hz if pins.board is not None else _CLOCK_HZ
    parts = Parts(plugins, notes, clock_hz=clock_hz, inches=_inches(document))
    document.text("name"), document.text("description")
    notes += [note for note in left_out(document) if not note.startswith("plugins")]
    name = re.sub(r"\W+", "_", Path(out or path).stem.lower(), flags=re.ASCII).strip("_") or "board"
    name = name if name[0].isalpha() else f"n_{name}"
    file = Path(out).name if out else f"{name}.ul"
    title = f"Made by `unitylink import` from {Path(path).name}, a configuration of riocore."
    body, spec = _compiled(name, title, parts.found)
    options, places, open_pins = _options(spec, parts.found, pins)
    notes += open_pins
    build = ""
    if pins.board is not None:
        build = " ".join([f"unitylink build {file} --board {board or pins.board.name}", *options])
    comment = _wrapped("Build it with: ", build) if build else _listed("Its pins", places)
    text, _ = checked(body.replace("\nlink ", f"\n{comment}\nlink ", 1), name)
    return Imported(text, tuple(sorted(notes, key=_place)), build)


def _place(note: str) -> int:
    """Return the number of the plugin that a note is about."""
    found = re.match(r"plugins\[(\d+)\]", note)
    return int(found[1]) if found else sys.maxsize


def _compiled(name: str, title: str, parts: list[Part]) -> tuple[str, Spec]:
    """Return the text with the narrowest addresses that are enough, and its spec."""
    try:
        text = _text(name, title, parts, 8)
        return text, checked(text, name)[1]
    except Failure:
        text = _text(name, title, parts, 16)
        return text, checked(text, name)[1]


def _node_type(plugins: list[Plugin]) -> str:
    return next((one.node.text("node_type") for one in plugins if one.kind == "fpga"), "")


def _inches(document: Node) -> bool:
    """Tell whether LinuxCNC is set to inches."""
    value = document.value
    for key in ("linuxcnc", "ini", "TRAJ", "LINEAR_UNITS"):
        value = value.get(key) if isinstance(value, dict) else None
    return isinstance(value, str) and value.lower() in ("inch", "in", "imperial")


def _text(name: str, title: str, parts: list[Part], address_bits: int) -> str:
    lines = []
    address = 0
    for part in parts:
        lines += [f"   /// {_printable(comment)}\n" for comment in part.comments]
        if part.is_word:
            lines.append(f"   @{part.name} = 0x{address:X}: {part.line};\n")
            address += 1
        else:
            lines.append(f"   {part.name}: {part.line};\n")
    inverted = INVERTED if any(part.line.startswith("inverted") for part in parts) else ""
    constructor = Names().unique(name)
    return (
        f"/// {_printable(title)}\nlink {constructor} (ADDRESS={address_bits});\n\n{inverted}"
        f"public {constructor}() {{\n{''.join(lines)}}}\n"
    )


def _options(spec: Spec, parts: list[Part], board: BoardPins) -> tuple[list[str], list[str], list[str]]:
    """Return the `--pin` options, the places of all pins, and notes about pins that are not known."""
    (design,) = SpecPlan(spec).part(plan_designs)
    widths = {
        (one.path, port): bits
        for root in spec.roots
        for one in root.instances
        if one.component is not None
        for port, _, bits in one.component.pins
    }
    lines: dict[str, list[tuple[str, int, str]]] = {}  # path -> its lines: name, bits, name in the component
    for one in design.components:
        ports = [Port(name, False, widths[one.path, port] or 1) for port, name in one.pins]
        own = {name: port for port, name in one.pins}
        own |= {name.removesuffix("_in"): port.removesuffix("_in") for name, port in own.items()}  # two-way
        lines[one.path] = [(line.name, line.bits, own[line.name]) for line in lines_of(ports)]
    options, places, notes = [], [], []
    for part in parts:
        for port, bits, role in [(part.name, 1, "")] if part.is_word else lines.get(part.name, []):
            wanted = part.pins.get(role, [])
            row: list[PluginPin | None] = [*wanted, *[None] * (bits - len(wanted))]
            found = [board.find(pin) if pin is not None and pin.where else None for pin in row]
            for number, pin in enumerate(row):
                if pin is not None and pin.where:
                    place = f"{port}[{number}]" if len(row) > 1 else port
                    places.append(f"{place} is {_printable(pin.where)}")
                    if found[number] is None and board.board is not None:
                        notes.append(f"{pin.node.place}: {pin.where}: say --pin {place}=PIN")
            options.append(f"--pin {port}={','.join(one or OPEN for one in found)}")
    return options, places, notes


def _wrapped(begin: str, text: str) -> str:
    lines = [begin.rstrip()]
    for word in text.split(" "):
        if len(lines[-1]) + len(word) > _COLUMNS:
            lines.append("  ")
        lines[-1] += f" {word}"
    return "".join(f"// {line}\n" for line in lines)


def _listed(title: str, rows: list[str]) -> str:
    return f"// {title}:\n" + "".join(f"// {row}\n" for row in rows) if rows else ""


def _printable(text: str) -> str:
    return "".join(c if c.isprintable() else " " for c in text)
