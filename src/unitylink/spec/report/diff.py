# SPDX-License-Identifier: BSD-3-Clause
"""Compare two specs by meaning: does a program for the old one work with gateware of the new one?

>>> from unitylink.spec.compile import compile_text
>>> old = compile_text("public a() { @x = 0x1: READ(); }").spec
>>> new = compile_text("public a() { @x = 0x2: READ(); @y = 0x3: WRITE(); }").spec
>>> [(c.kind, c.path, c.compatible) for c in compare(old, new)]
[('moved', 'a.x', False), ('added', 'a.y', True)]
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict, dataclass

from ..model import Element, Group, Instance, Publish, Spec
from ..ring import rings_of
from ..types import Field, ValueType

# What each access allows a program to do.
_WIDER = {("READ", "READWRITE"), ("WRITE", "READWRITE")}


@dataclass(frozen=True)
class Change:
    """One difference.

    `kind` is "added", "removed", "renamed", "moved" or "changed". `path` is the new name with its public
    constructor, or the old one if it was removed. `compatible` means that a program and gateware on either
    side of this change still understand each other.
    """

    kind: str
    path: str
    what: str  # what has changed: "type", "access", "scale" …
    before: str
    after: str
    compatible: bool

    def to_json(self) -> dict[str, object]:
        """Return the change for JSON."""
        return {
            "kind": self.kind,
            "path": self.path,
            "what": self.what,
            "before": self.before,
            "after": self.after,
            "compatible": self.compatible,
        }


def compare(old: Spec, new: Spec) -> tuple[Change, ...]:
    """Return every difference of meaning. They are in the order of the new spec, with removals last.

    Layout, comments and the names of specs and files do not count.
    """
    before, after = dict(_elements(old)), dict(_elements(new))
    renamed = _renamed(before, after)
    found: list[Change] = []
    for path, element in after.items():
        was = before.get(renamed.get(path, path))
        if was is None:
            found.append(Change("added", path, "", "", _summary(element), True))
            continue
        if path in renamed:
            found.append(Change("renamed", path, "name", renamed[path], path, True))
        found += _element_changes(path, was, element)
    found += _other_changes(old, new)
    gone = [path for path in before if path not in after and path not in renamed.values()]
    found += [Change("removed", path, "", _summary(before[path]), "", False) for path in gone]
    return tuple(found)


def _elements(spec: Spec) -> Iterator[tuple[str, Element]]:
    for root in spec.roots:
        for element in root.walk():
            yield f"{root.name}.{element.path}", element


def _renamed(before: dict[str, Element], after: dict[str, Element]) -> dict[str, str]:
    """Return {new path: old path} of elements that are the same word under another name."""
    lost = {_word(path, e): path for path, e in before.items() if path not in after}
    return {
        path: lost[_word(path, e)]
        for path, e in after.items()
        if path not in before and _word(path, e) in lost
    }


def _word(path: str, element: Element) -> tuple[object, ...]:
    root = path.partition(".")[0]
    return root, element.link.comm, element.address, element.access, _meaning(element.type)


def _summary(element: Element) -> str:
    unit = f" {element.unit}" if element.unit else ""
    return f"{element.access} {element.type.text}{unit} at 0x{element.address:04X}"


# --- elements -----------------------------------------------------------------------------------------------


def _element_changes(path: str, old: Element, new: Element) -> Iterator[Change]:
    if old.address != new.address:
        yield Change("moved", path, "address", f"0x{old.address:04X}", f"0x{new.address:04X}", False)

    def changed(what: str, before: object, after: object, compatible: bool) -> Iterator[Change]:
        if before != after:
            yield Change("changed", path, what, _shown(before), _shown(after), compatible)

    yield from changed("access", old.access, new.access, (old.access, new.access) in _WIDER)
    if _meaning(old.type) != _meaning(new.type):
        before, after = old.type.text, new.type.text
        if before == after:
            before, after = _detail(old.type), _detail(new.type)
        yield Change("changed", path, "type", before, after, _extends(old.type, new.type))
    for what in ("scale", "offset", "unit"):
        yield from changed(what, getattr(old, what), getattr(new, what), False)
    yield from changed("link", _link(old), _link(new), False)
    for what in ("minimum", "maximum", "overflow", "initial", "safe", "checked"):
        yield from changed(what, getattr(old, what), getattr(new, what), True)
    by_rate = all(p is None or p.trigger == "rate" for p in (old.publish, new.publish))
    yield from changed("publish", _publish(old.publish), _publish(new.publish), by_rate)
    for what in ("display", "documentation", "annotations"):
        yield from changed(what, getattr(old, what), getattr(new, what), True)


def _shown(value: object) -> str:
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, tuple):
        return " ".join(f"@{annotation.name}" for annotation in value)
    return "" if value is None else str(value)


def _link(element: Element) -> str:
    link = element.link
    return f"{link.kind} {link.link}".strip()


def _publish(publish: Publish | None) -> str:
    if publish is None:
        return ""
    how = (
        f"{publish.trigger} {publish.event}".strip()
        if publish.trigger != "rate"
        else f"divisor {publish.divisor}"
    )
    return ", ".join(part for part in (how, "polled" if publish.mode == 2 else "", publish.group) if part)


# --- types --------------------------------------------------------------------------------------------------


def _meaning(kind: ValueType) -> tuple[object, ...]:
    """Return the parts of a type that reach the wire or change a value. Names and documentation do not."""
    values = tuple((v.name, v.value) for v in kind.enum.values) if kind.enum else ()
    fields = tuple((f.name, _field_meaning(f)) for f in kind.fields)
    return kind.kind, kind.width, kind.fraction, bool(kind.enum and kind.enum.open), values, fields


def _detail(kind: ValueType) -> str:
    if kind.enum is not None:
        return ", ".join(f"{v.name}={v.value}" for v in kind.enum.values)
    return ", ".join(f"{f.name} {f.type.text} @ {f.high}..{f.low}" for f in kind.fields) or kind.kind


def _extends(old: ValueType, new: ValueType) -> bool:
    """Return whether the new type only adds to the old one: names to an open enumeration, or fields."""
    if (old.kind, old.width, old.fraction) != (new.kind, new.width, new.fraction):
        return False
    if old.enum is not None and new.enum is not None:
        kept = {(v.name, v.value) for v in old.enum.values} <= {(v.name, v.value) for v in new.enum.values}
        return old.enum.open and new.enum.open and kept
    if old.fields:
        fields = {f.name: _field_meaning(f) for f in new.fields}
        return all(fields.get(f.name) == _field_meaning(f) for f in old.fields)
    return False


def _field_meaning(field: Field) -> tuple[object, ...]:
    return field.low, field.high, field.scale, field.offset, field.unit, _meaning(field.type)


# --- instances, groups, links -------------------------------------------------------------------------------


def _other_changes(old: Spec, new: Spec) -> Iterator[Change]:
    before, after = _facts(old), _facts(new)
    for (path, what), (fact, compatible) in after.items():
        was = before.get((path, what))
        if was is not None and was[0] != fact:
            yield Change("changed", path, what, was[0], fact, compatible)
        elif was is None and what == "group":
            yield Change("added", path, what, "", fact, True)
    for (path, what), (fact, _) in before.items():
        if what == "group" and (path, what) not in after:
            yield Change("removed", path, what, fact, "", True)


def _facts(spec: Spec) -> dict[tuple[str, str], tuple[str, bool]]:
    """Return {(path, what): (fact, whether both sides are still compatible after a change of it)}."""
    found: dict[tuple[str, str], tuple[str, bool]] = {}
    for device in spec.devices:
        path = f"{device.root}({device.comm})" if device.comm else device.root
        found[path, "data width"] = f"{device.link.data_bits} bits", False
        found[path, "base rate"] = f"{device.link.base_hz} Hz", False
        for root in (one for one in spec.roots if one.name == device.root):
            for ring in rings_of(root, device.comm):
                for name, value in asdict(ring.options).items():
                    found[path, f"{name} of the ring at {ring.base:#x}"] = _shown(value), False
    for root in spec.roots:
        found[root.name, "parameters"] = ", ".join(root.parameters), True
        waiting: list[tuple[str, Instance]] = [(root.name, root)]
        while waiting:
            path, instance = waiting.pop(0)
            found[path, "constructor"] = instance.constructor, True
            found[path, "documentation"] = instance.documentation, True
            for member in instance.members:
                if isinstance(member, Group):
                    members = ", ".join(element.path for element in member.elements)
                    found[f"{path}.{member.name}", "group"] = members, True
                elif isinstance(member, Instance):
                    waiting.append((f"{path}.{member.name}", member))
    return found
