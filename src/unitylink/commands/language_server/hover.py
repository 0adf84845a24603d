# SPDX-License-Identifier: BSD-3-Clause
"""The text for the name under the mouse, as Markdown."""

from __future__ import annotations

from collections.abc import Iterator

from unitylink.spec import Element, Group, Instance, Spec
from unitylink.spec.meaning.symbols import Symbol
from unitylink.spec.model import Publish

from .document import Document

_SHOWN = 8  # the most expansions that are listed


def hover(document: Document, offset: int) -> str:
    """Return the Markdown for the name at `offset`, or "" if there is none."""
    found = document.symbols.at(offset)
    if found is None:
        return ""
    symbol, _ = found
    lines = [f"**{symbol.name}** ({symbol.kind}{f' of `{symbol.container}`' if symbol.container else ''})"]
    if symbol.documentation:
        lines += ["", symbol.documentation]
    members = list(_expansions(document.spec, symbol)) if document.spec else []
    facts = _type_facts(document.spec, symbol) if document.spec else []
    shown = [*facts, *(_describe(path, member) for path, member in members[:_SHOWN])]
    if shown:
        lines += ["", *(f"- {line}" for line in shown)]
    if len(members) > _SHOWN:
        lines.append(f"- … and {len(members) - _SHOWN:,} more")
    return "\n".join(lines)


def _expansions(spec: Spec, symbol: Symbol) -> Iterator[tuple[str, Instance | Element | Group]]:
    """Yield the symbol's objects in the model. A member has one for each expansion of its constructor."""
    waiting = [(root.name, root) for root in reversed(spec.roots)]
    while waiting:
        path, instance = waiting.pop()
        if symbol.kind == "constructor" and instance.constructor == symbol.name:
            yield path, instance
        elif instance.constructor == symbol.container:
            for member in instance.members:
                if symbol.name in (member.name, getattr(member, "array", "")):
                    yield f"{path}.{member.name}", member
        waiting += [(f"{path}.{inner.name}", inner) for inner in reversed(instance.instances)]


def _type_facts(spec: Spec, symbol: Symbol) -> list[str]:
    """Return the text for an enumeration, packed bits, or one of their names."""
    for enum in spec.enums:
        if enum.name in (symbol.name, symbol.container):
            values = [v for v in enum.values if symbol.kind == "enum" or v.name == symbol.name]
            return [
                f"`{v.name} = {v.value}`{f' {v.documentation}' if v.documentation else ''}" for v in values
            ]
    for bits in spec.bits:
        if bits.name in (symbol.name, symbol.container):
            fields = [f for f in bits.fields if symbol.kind == "bits" or f.name == symbol.name]
            return [
                f"`{f.name}: {f.type.text} @ {f.high}..{f.low}`{f' in {f.unit}' if f.unit else ''}"
                f"{f' {f.documentation}' if f.documentation else ''}"
                for f in fields
            ]
    return []


def _describe(path: str, member: Instance | Element | Group) -> str:
    if isinstance(member, Element):
        parts = [f"`{path}` at `0x{member.address:X}`", f"{member.type.text} {member.access}"]
        if member.words > 1:
            parts.append(f"{member.words} words")
        if member.unit:
            parts.append(f"in {member.unit}")
        if member.scale != 1 or member.offset:
            parts.append(f"raw × {member.scale:g}{f' + {member.offset:g}' if member.offset else ''}")
        if member.minimum is not None or member.maximum is not None:
            ends = ["…" if end is None else f"{end:g}" for end in (member.minimum, member.maximum)]
            parts.append(f"{ends[0]} to {ends[1]}")
        if member.publish is not None:
            parts.append(_published(member.publish))
        if member.display != member.path:
            parts.append(f'"{member.display}"')
        return ", ".join(parts)
    if isinstance(member, Group):
        return f"`{path}`: {len(member.elements)} elements"
    addresses = [element.address for element in member.walk()]
    span = f" at `0x{min(addresses):X}` to `0x{max(addresses):X}`" if addresses else ""
    return f"`{path}`: {len(addresses)} elements{span}"


def _published(publish: Publish) -> str:
    if publish.trigger != "rate":
        return f"published on {publish.event or publish.trigger}"
    by = "published by the gateware" if publish.mode == 1 else "polled by the PC"
    rate = f" at {publish.rate_hz:g} Hz" if publish.rate_hz is not None else ""
    return f"{by}{rate} (divisor {publish.divisor:,})"
