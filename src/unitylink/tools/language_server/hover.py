# SPDX-License-Identifier: BSD-3-Clause
"""What is shown of the name under the mouse, as Markdown."""

from __future__ import annotations

from collections.abc import Iterator

from unitylink.spec import Element, Group, Instance, Spec
from unitylink.spec.symbols import Symbol

from .document import Document

_SHOWN = 8  # expansions that are listed


def hover(document: Document, offset: int) -> str:
    """Return the Markdown for the name at `offset`, "" if there is none."""
    found = document.symbols.at(offset)
    if found is None:
        return ""
    symbol, _ = found
    lines = [f"**{symbol.name}** ({symbol.kind}{f' of `{symbol.container}`' if symbol.container else ''})"]
    members = list(_expansions(document.spec, symbol)) if document.spec else []
    documentation = next((text for _, m in members if (text := getattr(m, "documentation", ""))), "")
    if documentation:
        lines += ["", documentation]
    shown = [_describe(path, member) for path, member in members[:_SHOWN]]
    if shown:
        lines += ["", *(f"- {line}" for line in shown)]
    if len(members) > _SHOWN:
        lines.append(f"- … and {len(members) - _SHOWN:,} more")
    return "\n".join(lines)


def _expansions(spec: Spec, symbol: Symbol) -> Iterator[tuple[str, Instance | Element | Group]]:
    """Yield what the symbol became in the model: a member once for each expansion of its constructor."""
    waiting = [(root.name, root) for root in reversed(spec.roots)]
    while waiting:
        path, instance = waiting.pop()
        if symbol.kind == "constructor" and instance.constructor == symbol.name:
            yield path, instance
        elif instance.constructor == symbol.container:
            yield from ((f"{path}.{m.name}", m) for m in instance.members if m.name == symbol.name)
        waiting += [(f"{path}.{inner.name}", inner) for inner in reversed(instance.instances)]


def _describe(path: str, member: Instance | Element | Group) -> str:
    if isinstance(member, Element):
        parts = [
            f"`{path}` at `0x{member.address:X}`",
            f"{'signed ' if member.signed else ''}{member.access}",
        ]
        if member.unit:
            parts.append(f"unit {member.unit}")
        if member.publish is not None:
            by = "hardware" if member.publish.mode == 1 else "software"
            parts.append(f"{by} publish, divisor {member.publish.divisor:,}")
        if member.display != member.path:
            parts.append(f'"{member.display}"')
        return ", ".join(parts)
    if isinstance(member, Group):
        return f"`{path}`: {len(member.elements)} elements"
    addresses = [element.address for element in member.walk()]
    span = f" at `0x{min(addresses):X}` to `0x{max(addresses):X}`" if addresses else ""
    return f"`{path}`: {len(addresses)} elements{span}"
