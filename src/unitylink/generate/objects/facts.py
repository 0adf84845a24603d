# SPDX-License-Identifier: BSD-3-Clause
"""The tables of a robot: its values, links and committed memory, as initialisers of C, C++ and Rust."""

from __future__ import annotations

from dataclasses import dataclass

from unitylink import protocol
from unitylink.errors import BindingError
from unitylink.interface.wire_hash import wire_hashes
from unitylink.spec.model import Element, Instance, LinkBinding, Spec
from unitylink.spec.types import EnumType, Field, ValueType
from unitylink.values import Codec, Quantity

from ..quoting import Code, Part
from .dialect import Dialect

_COMMITTED = ("tosnet", "double_buffer")
_KINDS = {
    "bool": "BOOL",
    "enum": "ENUM",
    "bits": "BITS",
    "float": "REAL",
    "int": "SIGNED",
    "uint": "UNSIGNED",
}


@dataclass(frozen=True)
class LinkFacts:
    """A link of a robot. `parameter` is the name of the constructor's parameter that gives it."""

    parameter: str
    data_bits: int
    address_bits: int
    gateware: tuple[Code, ...]  # wire hashes


@dataclass(frozen=True)
class MemoryFacts:
    """Committed memory: the places of its links, the initialiser of its other facts, and its addresses."""

    link: int
    control: int
    facts: Code  # commit, and the bits of the status word
    addresses: tuple[Code, ...]  # all outputs, then the commit
    count: int


class RobotFacts:
    """The links, memories and values of one public constructor, in the order of their places."""

    def __init__(self, spec: Spec, root: Instance, dialect: Dialect) -> None:
        self.spec, self.root, self.dialect = spec, root, dialect
        self.elements = list(root.walk())
        self.index = {element.path: place for place, element in enumerate(self.elements)}
        self._keys: dict[str, int] = {}
        self._bits: dict[int, int] = {}
        self._address_bits: dict[int, int] = {}
        self._told: dict[str | None, tuple[int, ...]] = {}  # wire hashes behind each COMM
        self._hashes: dict[int, dict[int, None]] = {}
        self._outputs: dict[LinkBinding, list[int]] = {}
        self._slots: dict[str, int] = {}
        for element in self.elements:
            self._look_at(element)
        self._memory_places = {binding: place for place, binding in enumerate(self._outputs)}

    def _look_at(self, element: Element) -> None:
        binding = element.link
        bits = self.data_bits(element)
        if binding.comm not in self._told:
            self._told[binding.comm] = wire_hashes(self.spec, self.root.name, binding.comm)
        committed = binding.kind in _COMMITTED
        last = binding.base + binding.words if committed else element.address + element.words
        for name in (binding.comm, binding.ctrl) if binding.ctrl else (binding.comm,):
            place = self._keys.setdefault(name or binding.link or "link", len(self._keys))
            self._bits.setdefault(place, bits)
            top = max(self._address_bits.get(place, 1), (last - 1).bit_length())
            self._address_bits[place] = top
            self._hashes.setdefault(place, {}).update(dict.fromkeys(self._told[binding.comm]))
        if committed and element.access in ("PULSE", "W1C"):
            raise BindingError(
                f"{element.path} is a {element.access}, but {binding.kind} writes all words again at each "
                "commit; use a plain register for it"
            )
        if committed and element.writable:
            outputs = self._outputs.setdefault(binding, [])
            self._slots[element.path] = len(outputs)
            outputs += element.addresses

    def data_bits(self, element: Element) -> int:
        """Return the width of the bus behind the link of an element."""
        for device in self.spec.devices:
            if device.root == self.root.name and device.comm == element.link.comm:
                return device.link.data_bits
        return protocol.DATA_BITS_MAX

    def link_of(self, element: Element) -> int:
        return self._keys[element.link.comm or element.link.link or "link"]

    def width(self, element: Element) -> int:
        return self.data_bits(element) if element.type.bus else element.type.width

    def commanded(self, element: Element) -> bool:
        """Return whether a set may write it: it keeps what is written, and a second write does no harm."""
        return element.access in ("WRITE", "READWRITE") and element.link.kind != "fifo"

    def sampled(self, element: Element) -> bool:
        """Return whether a set may read it: a read has no side effect."""
        return element.pollable and element.link.kind != "fifo"

    def links(self) -> tuple[LinkFacts, ...]:
        return tuple(
            LinkFacts(
                name,
                self._bits[place],
                self._address_bits[place],
                tuple(self.dialect.number(told, 16) for told in self._hashes[place]),
            )
            for name, place in self._keys.items()
        ) or (LinkFacts("link", protocol.DATA_BITS_MAX, 1, ()),)

    def memories(self) -> tuple[MemoryFacts, ...]:
        made = []
        for binding, outputs in self._outputs.items():
            link = self._keys[binding.comm or binding.link or "link"]
            control = self._keys[binding.ctrl] if binding.ctrl else link
            commit, facts = _commit(binding, self.dialect)
            addresses = tuple(self.dialect.number(address) for address in (*outputs, commit))
            made.append(MemoryFacts(link, control, facts, addresses, len(outputs)))
        return tuple(made)

    def value(self, element: Element, members: Code) -> Code:
        """Return the initialiser of the facts of a value. `members` is the table of its enumeration."""
        memory = -1
        if element.path in self._slots:
            memory = self._memory_places[element.link]
        fifo = element.link.kind == "fifo"
        flags = [
            ("CHECKED", element.checked),
            ("READ_AGAIN", element.pollable and not fifo),
            ("WRITE_AGAIN", self.commanded(element)),
            ("FRAMES", bool(Quantity.of(element).asks_for_frames(element.access))),
        ]
        place = (self.link_of(element), memory, self._slots.get(element.path, 0))
        code = self.dialect.code
        return _initialiser(
            (code.text(element.path), code.text(element.unit), self.dialect.number(element.address)),
            Codec(element.path, Quantity.of(element), self.data_bits(element), commanded=True),
            flags,
            place,
            members,
            dialect=self.dialect,
        )


def field_value(name: str, field: Field, members: Code, dialect: Dialect) -> Code:
    """Return the initialiser of the facts of a field of a packed value."""
    codec = Codec(name, Quantity.of(field), field.high - field.low + 1, commanded=True)
    code = dialect.code
    where = (code.text(name), code.text(field.unit), code.of("{}", field.low))
    return _initialiser(where, codec, [], (0, -1, 0), members, dialect=dialect)


def member_numbers(enum: EnumType, dialect: Dialect) -> tuple[Code, ...]:
    return tuple(dialect.unsigned(item.value) for item in enum.values)


def kind_of(kind: ValueType, quantity: Quantity) -> str:
    """Return how the raw number is read, as the name of a UL_KIND."""
    if kind.kind != "float" and quantity.scaled:
        return "SCALED"
    return _KINDS[kind.kind]


def _commit(binding: LinkBinding, dialect: Dialect) -> tuple[int, Code]:
    """Return the address of the commit, and the initialisers of it and of the bits of the status word."""
    if binding.kind != "tosnet":
        address = binding.base + binding.size
        bits: tuple[int | None, ...] = (None,) * 4
    else:
        address = binding.base + protocol.TOSNET_STATUS
        bits = (
            protocol.TOSNET_STATUS_COMMIT_PENDING_BIT,
            protocol.TOSNET_STATUS_COMMIT_ABORTED_BIT,
            protocol.TOSNET_STATUS_ONLINE_BIT,
            protocol.TOSNET_STATUS_SYSTEM_HALT_BIT,
        )
    masks: list[Part] = [0 if bit is None else dialect.number(1 << bit) for bit in bits]
    names = ("commit", "pending", "aborted", "online", "halted")
    rows = list(zip(names, [dialect.number(address), *masks], strict=True))
    listed = [dialect.code.of("{}: {}", *row) if dialect.rust else row[1] for row in rows]
    return address, dialect.code(", ").join(listed)


def _initialiser(
    where: tuple[Code, Code, Code],  # path, unit, address
    codec: Codec,
    flags: list[tuple[str, bool]],
    place: tuple[int, int, int],
    members: Code,
    *,
    dialect: Dialect,
) -> Code:
    quantity, kind = codec.quantity, codec.type
    told = [
        ("SIGNED", kind.signed),
        ("SATURATE", quantity.overflow == "saturate"),
        ("OPEN", kind.enum is not None and kind.enum.open),
        *flags,
    ]
    set_flags = [dialect.constant("VALUE", name) for name, holds in told if holds]
    low, high = (dialect.number(number & (1 << 64) - 1) for number in (codec.low, codec.high))
    ratio = codec.ratio if quantity.scaled and codec.ratio is not None else (0, 0, 0)
    ends = (codec.minimum, codec.maximum) if kind.numeric else (0, codec.mask)
    rows: list[tuple[str, Part]] = [
        *zip(("path", "unit", "address"), where, strict=True),
        ("kind", dialect.constant("KIND", kind_of(kind, quantity))),
        ("width", codec.width),
        ("words", max(1, codec.words)),
        ("flags", dialect.either(set_flags)),
        *zip(("link", "memory", "slot"), place, strict=True),
        ("low", low),
        ("high", high),
        ("scale", float(quantity.scale / (1 << kind.fraction))),
        ("offset", float(quantity.offset)),
        *zip(("multiplier", "added", "divisor"), map(float, ratio), strict=True),
        *zip(("minimum", "maximum"), map(float, ends), strict=True),
        ("members", members),
        ("member_count", len(kind.enum.values) if kind.enum is not None else 0),
    ]
    return dialect.table("Facts", rows)
