# SPDX-License-Identifier: BSD-3-Clause
"""The plan of a bench: a read and a write for each name, and what the bench tries."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from unitylink.spec.model import Element, Spec

from ..quoting import Vhdl
from ..vhdl.names import Names
from ..vhdl.plan import Plan
from ..vhdl.records import Leaf, Tree
from ..vhdl.value_types import ARRAYS, Part, width_of
from ..vhdl.words import components_of, named_elements

_MIXED = 0x9E3779B97F4A7C15F39CC0605CEDC835  # bits without a pattern: 2**128 over the golden ratio


@dataclass(frozen=True)
class Access:
    """The read and the write of a value. `from_bits` and `to_bits` convert its raw bits."""

    name: str
    width: int
    type: Vhdl
    from_bits: Vhdl
    to_bits: Vhdl
    reads: bool
    writes: bool
    remark: str


@dataclass(frozen=True)
class Publish:
    """A publish group of the spec: its words, and when it publishes."""

    name: str
    number: int
    divisor: int
    on_event: bool
    addresses: tuple[Vhdl, ...]
    remark: str


@dataclass(frozen=True)
class Trial:
    """What the generated bench does with a value: `before` it, and the checks after its read or write."""

    access: Access
    raw: Vhdl
    before: tuple[Vhdl, ...]
    after: tuple[tuple[Vhdl, Vhdl], ...]  # the value there, the value that must be there


@dataclass(frozen=True)
class Bench:
    """All that the templates lay out beside the plan of the design."""

    accesses: tuple[Access, ...]
    publishes: tuple[Publish, ...]
    reads: tuple[Trial, ...]
    writes: tuple[Trial, ...]

    @property
    def answered(self) -> Access | None:
        """The value that the bench reads if it can try nothing, so that it at least sees an answer."""
        readable = (access for access in self.accesses if access.reads)
        return None if self.reads or self.writes else next(readable, None)


def plan_bench(spec: Spec, design: Plan) -> Bench:
    """Plan the procedures, and what the bench tries: the words that a record has, in plain memory."""
    inside = {address for component in components_of(spec) for address in component.range}
    to_pc, from_pc = _by_word(design.to_pc), _by_word(design.from_pc)
    accesses, reads, writes = [], [], []
    for number, (_, name, element) in enumerate(named_elements(spec)):
        access = _access(name, element, design.configuration.data_bits)
        accesses.append(access)
        if element.link.kind != "memory" or element.address in inside:
            continue
        mixed = _MIXED >> number % 64 | 1
        if design.words.drives(element):
            leaves = to_pc.get(design.words.read[element.address], [])
            raw = mixed & sum(1 << bit for leaf in leaves for bit in range(leaf.part.low, leaf.part.high + 1))
            before = tuple(Vhdl.of("to_pc.{} <= {};", leaf.path, _literal(leaf.part, raw)) for leaf in leaves)
            reads += [Trial(access, _value(access, raw), before, ())] if before else []
        elif element.access in ("WRITE", "READWRITE"):
            leaves = from_pc.get(design.words.write[element.address], [])
            after = tuple((Vhdl.of("from_pc.{}", leaf.path), _literal(leaf.part, mixed)) for leaf in leaves)
            writes += [Trial(access, _value(access, mixed), (), after)] if after else []
    return Bench(tuple(accesses), tuple(_publishes(spec, design)), tuple(reads), tuple(writes))


def _access(name: str, element: Element, data_bits: int) -> Access:
    width = width_of(element, data_bits)
    base = "std_ulogic" if element.type.kind == "bool" else ARRAYS.get(element.type.kind, "std_ulogic_vector")
    if base == "std_ulogic":
        kind, back = Vhdl("std_ulogic"), Vhdl("(0 => value)")
        value = Vhdl("bits(0)")
    else:
        kind, back = Vhdl.of("{}({} downto 0)", base, width - 1), Vhdl("std_ulogic_vector(value)")
        value = Vhdl.of("{}(bits)", base)
    return Access(
        name,
        width,
        kind,
        value,
        back,
        reads=element.readable,
        writes=element.writable,
        remark=f"{element.access}{element.unit and f', in {element.unit}'}",
    )


def _by_word(tree: Tree) -> dict[int, list[Leaf]]:
    """Return the parts of each value, by the number of its first word."""
    parts: dict[int, list[Leaf]] = {}
    for leaf in tree.leaves:
        parts.setdefault(leaf.index, []).append(leaf)
    return parts


def _bits(raw: int, width: int) -> Vhdl:
    return Vhdl.of('"{}"', format(raw & (1 << width) - 1, f"0{width}b"))


def _value(access: Access, raw: int) -> Vhdl:
    return (
        _literal(Part(Vhdl(""), "std_ulogic", 0, 0), raw)
        if access.type == "std_ulogic"
        else _bits(raw, access.width)
    )


def _literal(part: Part, raw: int) -> Vhdl:
    """Return the bits of `part` in a raw value."""
    if part.base == "std_ulogic":
        return Vhdl("'1'") if raw >> part.low & 1 else Vhdl("'0'")
    return _bits(raw >> part.low, part.high - part.low + 1)


def _publishes(spec: Spec, design: Plan) -> Iterator[Publish]:
    names = Names()
    package = f"{design.name}_config_pkg"
    constants = {id(element): f"{package}.{name}_address" for _, name, element in named_elements(spec)}
    for device in spec.devices:
        for group in device.groups:
            words = [(constants[id(element)], n) for element in group.elements for n in range(element.words)]
            yield Publish(
                names.claim(group.name),
                group.number,
                group.divisor if group.trigger == "rate" else 0,
                group.trigger != "rate",
                tuple(Vhdl.of("{} => {} + {}", place, *word) for place, word in enumerate(words)),
                group.name,
            )
