# SPDX-License-Identifier: BSD-3-Clause
"""The hash by which a program and gateware find out whether they were made from the same interface."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Sequence
from typing import Protocol

from unitylink.spec.model import Element, Spec
from unitylink.spec.types import ValueType

_FORMAT = "unity-link wire 2"  # changes whenever the lines below change their form


def wire_hash(spec: Spec) -> int:
    """Return 64 bits over all of `spec` that could move the wrong joint where two specs differ in it.

    That is, of every value: its name with those of the parts around it, addresses, access, type with fields
    and members, unit, scale, limits, initial and safe values, the hardware behind it, and the event line that
    publishes it. What cannot do harm does not count: comments, annotations, display names, names of types and
    constructors, the order in the file, publish rates (the program asks for its own). Nor does the width of
    the bus, which the device tells. Never 0, which a device says that knows no spec.

    >>> spec = unitylink.spec.load("scara.ul")  # doctest: +SKIP
    >>> f"{wire_hash(spec):016x}"  # doctest: +SKIP
    '3f0c…'
    """
    lines = {_element(f"{root.name}.{e.path}", e) for root in spec.roots for e in root.walk()}
    for device in spec.devices:
        for group in device.groups:
            if group.trigger != "rate":
                names = " ".join(f"{device.root}.{element.path}" for element in group.elements)
                lines.add(f"event {group.number} {group.trigger} {group.event} {names}")
    text = "\n".join(sorted(lines))
    return int(hashlib.sha256(f"{_FORMAT}\n{text}\n".encode()).hexdigest()[:16], 16) or 1


def wire_hashes(spec: Spec, root: str, *comms: str | None) -> tuple[int, ...]:
    """Return the hashes of gateware that has what the public constructor `root` reaches through `comms`.

    Without `comms` that is all of it. Gateware may be built from all of the spec, from the constructor alone,
    or from what is behind a link: two arms are two boards, each behind a link of its own.
    """
    wanted = {(d.root, d.comm) for d in spec.devices if d.root == root and (not comms or d.comm in comms)}
    there = (part for part in _parts(spec) if wanted <= {(d.root, d.comm) for d in part.devices})
    return tuple(dict.fromkeys(wire_hash(part) for part in (spec, *there)))


def part_behind(link: Asked, spec: Spec) -> Spec:
    """Return the part of `spec` which the gateware behind `link` was built from; all, where it cannot tell.

    Raises DeviceMismatch where it was built from another spec.
    """
    parts = {wire_hash(part): part for part in reversed(_parts(spec))}
    link.check_spec(spec.source, tuple(reversed(parts)))
    return parts.get(link.description.spec_hash, spec) if link.description is not None else spec


class Told(Protocol):
    """What a device says of itself."""

    @property
    def spec_hash(self) -> int: ...


class Asked(Protocol):
    """A link, which can ask its gateware what it was built from."""

    @property
    def description(self) -> Told | None: ...
    def check_spec(self, spec: str, hashes: Sequence[int]) -> None: ...


def _parts(spec: Spec) -> list[Spec]:
    """Return what gateware may be built from: the whole spec first."""
    roots = [spec.only(root.name) for root in spec.roots] if len(spec.roots) > 1 else []
    boards = spec.boards if len(spec.boards) > 1 else ()
    return [spec, *boards, *roots]


def _element(name: str, element: Element) -> str:
    link = element.link
    addresses = " ".join(f"{address:x}" for address in element.addresses)
    facts = _facts(element.unit, element.scale, element.offset, element.minimum, element.maximum)
    more = f"{element.overflow} {_facts('', element.initial, element.safe)}"
    hardware = f"{link.kind} {link.base:x} {link.size}"
    return f"value {name} {addresses} {element.access} {_type(element.type)} {facts} {more} on {hardware}"


def _type(kind: ValueType) -> str:
    """Return all of a type but what it is called."""
    if kind.bus:
        return "signed" if kind.signed else "unsigned"
    if kind.enum is not None:
        values = sorted(f"{one.name}={one.value}" for one in kind.enum.values)
        return f"enum {kind.width} {kind.enum.open:d} {','.join(values)}"
    fields = sorted(
        f"{one.name} {one.high} {one.low} {_type(one.type)} "
        + _facts(one.unit, one.scale, one.offset, one.minimum, one.maximum)
        for one in kind.fields
    )
    return f"{kind.kind} {kind.width} {kind.fraction} {';'.join(fields)}"


def _facts(unit: str, *numbers: float | bool | None) -> str:
    """Return numbers so that 1 and 1.0 are the same, and a whole one of 64 bits keeps all its digits."""
    return " ".join([repr(unit), *_texts(numbers)])


def _texts(numbers: Iterable[float | bool | None]) -> list[str]:
    return [
        "-" if n is None else str(int(n)) if isinstance(n, int) or n.is_integer() else repr(n)
        for n in numbers
    ]
