# SPDX-License-Identifier: BSD-3-Clause
"""The logic to build: the user's around the generated design, or one made here that puts words on pins."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

from unitylink.errors import BoardError
from unitylink.generate import SpecPlan
from unitylink.generate.quoting import Vhdl
from unitylink.generate.templates import environment
from unitylink.generate.vhdl import (
    FOLDER,
    Leaf,
    Plan,
    component_ports,
    design_file_names,
    design_name,
    own_source_names,
    plan_designs,
)
from unitylink.generate.vhdl.names import Names
from unitylink.interface.board_configuration import check_one_board
from unitylink.spec import load
from unitylink.spec.model import Spec

from .pins import OPEN, TRIPPED, Line, role_of, wished_names

WORD_BITS = 32  # of each address, in the vectors of a design's words
_PORTS = ("clock", "reset", "rx_line", "tx_line", "clock_hz", "baud_hz", "to_pc", "from_pc", "link", TRIPPED)


@dataclass(frozen=True)
class Logic:
    """The logic to build: the entity `top`, its files, and remarks about it."""

    top: str
    sources: tuple[Path, ...]
    generics: frozenset[str]  # clock_hz and baud_hz, if it has them
    components: dict[str, str] = field(default_factory=dict)  # port -> component of the gateware library
    notices: tuple[str, ...] = ()
    whence: str = ""  # a sentence for the terminal
    # bit of a port -> (address, bit) of the word that it is; only if the logic is made here
    words: Mapping[str, tuple[int, int]] = field(default_factory=dict)


def design_sources(spec: Spec, folder: Path) -> list[Path]:
    """Return the VHDL files that `generate` writes for `spec` into `folder`."""
    name = design_name(spec)
    generated = [folder / one for one in design_file_names(name) if one.endswith(".vhd")]
    return generated + [folder / FOLDER / one for one in own_source_names(name, spec)]


@dataclass(frozen=True, kw_only=True)
class Wanted:
    """A user's request: a spec, VHDL of their own (`logic`, with the entity `top`) and pins for ports.

    `root` is the public constructor or the link of the board, if the spec has several. `protocol` is that of
    the link: "both", "framed" or "classic". With None it is that of the board's manifest. `settings` are
    fields of the board configuration that differ from those of the spec.
    """

    spec_file: str
    folder: Path
    root: str | None = None
    logic: tuple[Path, ...] = ()
    top: str | None = None
    pins: tuple[str, ...] = ()
    protocol: str | None = None
    settings: Mapping[str, int | str | bool] = field(default_factory=dict)


def spec_of(wanted: Wanted) -> Spec:
    """Return the spec of the requested board.

    Raises SpecError, BoardError if `root` does not exist, and ValueRangeError if it must be chosen.
    """
    spec = load(wanted.spec_file)
    try:
        part = spec.only(wanted.root) if wanted.root is not None else spec
    except KeyError as error:
        raise BoardError(f"{wanted.spec_file}: {error.args[0]}; choose one with --root") from None
    check_one_board(part)
    return part


def logic_of(plan: SpecPlan, wanted: Wanted, *, pin_for_trips: bool = False) -> Logic:
    """Return the logic to build: the user's VHDL, else NAME_board.vhd beside the spec, else one made here.

    A NAME_board.vhd is for other boards if the link is not a UART and the file names none of the link's
    ports. Logic made here has the port `tripped` if a pin is requested for it, or if the board has one
    (`pin_for_trips`). Raises BoardError, also if `tripped` is requested and the gateware has no dead-man.
    """
    (design,) = plan.part(plan_designs)
    configuration = design.configuration
    name = f"{design.name}_board.vhd"
    beside = Path(wanted.spec_file).with_name(name)
    uart = configuration.physical == "uart"
    generics = ("clock_hz", "baud_hz") if uart else ("clock_hz",)
    if wanted.logic:
        return own_logic(wanted.logic, wanted.top, generics)
    if wanted.top is not None:
        raise BoardError(f"--top {wanted.top}: say with --logic which VHDL file it is in")
    passed_over: tuple[str, ...] = ()
    if beside.is_file():
        names = "|".join(port.name for port in design.layer.ports)
        if uart or re.search(rf"\b({names})\b", _plain(beside), re.IGNORECASE):
            return own_logic([beside], None, generics)
        passed_over = (
            f"{beside.name} is not used, because it is not for {design.layer.what}: --logic takes it",
        )
    wished = wished_names(wanted.pins)
    if pin_for_trips or TRIPPED in wished:
        wished |= {TRIPPED}
        watches = configuration.protocol != "classic" and configuration.deadman
        if not watches and f"{TRIPPED}={OPEN}" not in wanted.pins:
            raise BoardError(
                "the pin for tripped would never go high: this gateware has no dead-man; build it "
                f"with frames and deadman=true, or say --pin {TRIPPED}={OPEN}"
            )
    if design.tosnet is not None and design.tosnet.samples > 1:
        raise BoardError(
            f"the ring's line needs {design.tosnet.samples} samples in each clock, and those come from a DDR "
            f"or SERDES input of the FPGA: write {name} with one, or a lower BAUD in TOSNET"
        )
    logic = pin_logic(design, component_ports(design), wished, wanted.folder / FOLDER / name)
    return replace(logic, generics=frozenset(generics), notices=passed_over + logic.notices)


@dataclass(frozen=True)
class WordPort:
    """A word on pins: the port, its VHDL type, and the field that it shows."""

    name: str
    type: Vhdl
    path: Vhdl
    base: str
    bits: int
    word: int  # the place of its word among those of its direction
    low: int  # its lowest bit there
    seen: str  # the signal that has an input, synchronous to the clock

    @property
    def to_pc(self) -> Vhdl:
        plain = self.base in ("std_ulogic", "std_ulogic_vector")
        return Vhdl.of("{}", self.seen) if plain else Vhdl.of("{}({})", self.base, self.seen)

    @property
    def index(self) -> Vhdl:
        """Of a port that is one bit, in the vectors of the synchroniser."""
        return Vhdl("(0)") if self.type == "std_ulogic" else Vhdl("")

    @property
    def from_pc(self) -> Vhdl:
        plain = self.base in ("std_ulogic", "std_ulogic_vector")
        return Vhdl.of("from_pc.{}" if plain else "std_ulogic_vector(from_pc.{})", self.path)


def own_logic(files: Sequence[Path], top: str | None, wanted: Sequence[str]) -> Logic:
    """Return the user's entity: `top`, or the only entity of the first file. Raises BoardError."""
    for file in files:
        if not file.is_file():
            raise BoardError(f"{file}: there is no such VHDL file")
    text = _plain(files[0])
    entities = re.findall(r"^\s*entity\s+(\w+)\s+is\b", text, re.IGNORECASE | re.MULTILINE)
    if top is None:
        if len(entities) != 1:
            raise BoardError(
                f"{files[0]} has {len(entities)} entities ({', '.join(entities)}): say which with --top"
            )
        top = entities[0]
    texts = [text, *(_plain(file) for file in files[1:])]
    pattern = rf"^\s*entity\s+{re.escape(top)}\s+is\b(.*?)^\s*end\b"
    found = [
        m[1] for one in texts if (m := re.search(pattern, one, re.IGNORECASE | re.DOTALL | re.MULTILINE))
    ]
    if not found:
        raise BoardError(f"the entity {top} is in none of {', '.join(map(str, files))}")
    generics = {name for name in wanted if re.search(rf"\b{name}\b", found[0], re.IGNORECASE)}
    notices = [f"{top} has no generic {name}: its own value is used instead" for name in wanted]
    missing = tuple(text for text in notices if not any(f" {name}:" in text for name in generics))
    whence = f"{files[0]} is the logic around the link"
    return Logic(top.lower(), tuple(files), frozenset(generics), notices=missing, whence=whence)


def pin_logic(design: Plan, components: dict[str, str], wished: set[str], path: Path) -> Logic:
    """Write into `path` an entity that puts words on pins: those whose name tells a pin, and those in
    `wished`.

    Return it.

    If it is in `wished`, `tripped` is a port of this entity.

    Words without a pin are for the PC: a WRITE reads back, and a READ is 0. A notice says so.
    """
    names = Names((*_PORTS, *(item.name for item in design.layer.ports)))
    for port in components:
        names.claim(port)
    inputs, quiet = _words(design.to_pc.leaves, names, wished)
    outputs, _ = _words(design.from_pc.leaves, names, wished)
    top = path.stem
    text = (
        environment(Path(__file__).parent)
        .get_template("board.vhd.jinja")
        .render(
            plan=design,
            top=top,
            uart=design.configuration.physical == "uart",
            inputs=inputs,
            outputs=outputs,
            quiet=quiet,
            components=design.pins,
            tripped=TRIPPED in wished,
        )
    )
    path.write_text(text, encoding="utf-8")
    notices: tuple[str, ...] = ()
    if quiet:
        shown = ", ".join(leaf.path for leaf in quiet[:8]) + (
            f" and {len(quiet) - 8} more" if len(quiet) > 8 else ""
        )
        notices = (
            f"nothing drives {shown}: the PC reads 0; give --pin NAME=PIN, or your own VHDL with --logic",
        )
    whence = f"no {path.name} for this link is beside the spec: the words that have pins go to them"
    words = _places(inputs, tuple(design.words.read)) | _places(outputs, tuple(design.words.write))
    return Logic(top, (path,), frozenset(), components, notices, whence, words)


def _places(ports: Sequence[WordPort], addresses: Sequence[int]) -> dict[str, tuple[int, int]]:
    """Return (address, bit) for each bit of `ports`, except of a value that is longer than a word."""
    return {
        Line(port.name, "", port.bits).bit(number): (addresses[port.word], port.low + number)
        for port in ports
        if port.low + port.bits <= WORD_BITS
        for number in range(port.bits)
    }


def _words(leaves: Sequence[Leaf], names: Names, wished: set[str]) -> tuple[list[WordPort], list[Leaf]]:
    """Divide the leaves into those on pins and the others."""
    ports, others = [], []
    for leaf in leaves:
        plain = Names(_PORTS).claim(leaf.path)
        if plain not in wished and role_of(plain) is None:
            others.append(leaf)
            continue
        width = leaf.part.high - leaf.part.low + 1
        vector = Vhdl.of("std_ulogic_vector({} downto 0)", width - 1)
        kind = Vhdl("std_ulogic") if leaf.part.base == "std_ulogic" else vector
        name = names.claim(leaf.path)
        ports.append(
            WordPort(
                name,
                kind,
                leaf.path,
                leaf.part.base,
                width,
                leaf.index,
                leaf.part.low,
                names.claim(f"{name}_seen"),
            )
        )
    return ports, others


def _plain(file: Path) -> str:
    return re.sub(r"--.*", "", file.read_text(encoding="utf-8", errors="replace"))
