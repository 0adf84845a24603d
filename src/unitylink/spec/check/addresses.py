# SPDX-License-Identifier: BSD-3-Clause
"""Checks of the addresses of a spec. All of its names are already right."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from unitylink import protocol

from ..expand.resolve import Placed, Resolver
from ..model import Element, Instance, Link
from ..report.diagnostics import Reporter
from .blocks import check_blocks, check_windows
from .engine import check_engine
from .publishes import check_publishes
from .ring import check_rings

# (public constructor, its COMM): these share one address space and one set of groups
_Device = tuple[str, "str | None"]

_FIFO_WORDS = 3  # data, words that wait for the PC, room for words from the PC


def check_model(resolver: Resolver, links: Mapping[str, Link], reporter: Reporter) -> None:
    """Report errors and warnings about the addresses and publishes of expanded elements."""
    placed = resolver.placed
    _check_overlaps(placed, reporter)
    _check_links(placed, links, reporter)
    for one in placed:
        kind = one.element.link.kind
        if kind == "tosnet":
            _check_tosnet(one, reporter)
        elif kind == "double_buffer":
            _check_double_buffer(one, reporter)
        elif kind == "fifo":
            _check_fifo(one, reporter)
    check_windows(placed, reporter)
    check_blocks(resolver.blocks, placed, reporter)
    _check_events(resolver.roots, placed, reporter)
    check_publishes(tuple(resolver.roots), links, reporter)
    check_engine(tuple(resolver.roots), links, reporter)
    check_rings(resolver, links, reporter)


def _check_overlaps(placed: Sequence[Placed], reporter: Reporter) -> None:
    """There is one diagnostic for each pair of statements, because a copied expansion is one mistake."""
    first: dict[tuple[_Device, int], list[Placed]] = {}
    pairs: dict[tuple[str, int, int], tuple[Placed, Placed, int]] = {}
    for one in placed:
        element = one.element
        device = (one.root, element.link.comm)
        met: set[int] = set()  # values of several words overlap in several places
        for address in element.addresses:
            earlier_ones = first.setdefault((device, address), [])
            for earlier in earlier_ones:
                if id(earlier) not in met and not _may_share(earlier.element, element):
                    met.add(id(earlier))
                    same = (earlier.element.readable and element.readable) or (
                        earlier.element.writable and element.writable
                    )
                    key = ("UL051" if same else "UL052", earlier.statement, one.statement)
                    count = pairs[key][2] + 1 if key in pairs else 1
                    pairs[key] = (*pairs.get(key, (earlier, one))[:2], count)
            if len(earlier_ones) < 2:
                earlier_ones.append(one)
    for (code, _, _), (earlier, one, count) in pairs.items():
        _report_overlap(code, earlier, one, count, reporter)


def _may_share(one: Element, other: Element) -> bool:
    """May two elements share one address?

    A strobe keeps nothing, so a READ at its address is a separate value.
    """
    if one.readable == other.readable or one.writable == other.writable:
        return False
    return "PULSE" in (one.access, other.access)


def _report_overlap(code: str, earlier: Placed, one: Placed, count: int, reporter: Reporter) -> None:
    more = f", and {count - 1} more of the same statements" if count > 1 else ""
    words = one.element.addresses
    at = next((a for a in words if a in earlier.element.addresses), words[0])
    where = f"at address 0x{at:X}"
    path, other = one.element.path, earlier.element.path
    if code == "UL051":
        message = f"`{path}` lies {where}, where `{other}` is{more}"
        hint = "give one of them another address; a second name for elements is a group, `name = path`"
        if one.element.array and earlier.element.array == one.element.array:
            hint = "the address of an array's elements counts with `i`, such as `0x80 + i`"
    else:
        there = f"where the {earlier.element.access} `{other}` is{more}"
        message = f"`{path}` is a {one.element.access} {where}, {there}"
        hint = "give one of them another address; a WRITE keeps the value it wrote last, to be read back"
    labels = [(earlier.address.start, earlier.address.end, f"`{other}` is here")]
    if earlier.address.start == one.address.start:
        labels = []
    reporter.report(code, one.address.start, one.address.end, message, hint, labels=labels)


def _check_links(placed: Sequence[Placed], links: Mapping[str, Link], reporter: Reporter) -> None:
    several = len(links) > 2  # more than one declared link, beside "" for the default
    chosen: dict[_Device, tuple[str, Placed]] = {}
    for one in placed:
        element, name = one.element, one.element.link.link
        link = links[name if name in links else ""]
        bits = link.address_bits
        if bits is not None and element.addresses[-1] >> bits:
            where = f"0x{element.addresses[-1]:X}, beyond the {bits} bits of `{link.name}`"
            message = f"`{element.path}` lies at {where}"
            hint = "give it a lower address, or the link a wider ADDRESS"
            reporter.report("UL059", one.address.start, one.address.end, message, hint)
        if several:
            first, earlier = chosen.setdefault((one.root, element.link.comm), (name, one))
            names = ", ".join(f"`{known}`" for known in links if known)
            if not name and earlier is one:
                message = f"it is not clear which link leads to `{one.root}`"
                hint = f"there are {names}: write `MEMORY(LINK=…);` or `TOSNET(…, LINK=…);`"
                reporter.report("UL096", one.address.start, one.address.end, message, hint)
            elif first != name:
                message = (
                    f"`{element.path}` is reached by `{name}`, other elements of this device by `{first}`"
                )
                hint = "one COMM is one link: give the other part a COMM of its own"
                reporter.report("UL096", one.address.start, one.address.end, message, hint)


def _check_double_buffer(one: Placed, reporter: Reporter) -> None:
    element, size = one.element, one.element.link.size
    offset = element.addresses[-1] - element.link.base
    if offset < size:
        return
    what = "is the commit" if offset == size else "lies beyond it"
    message = f"`{element.path}` does not lie in the {size} words of the double buffer: +{offset} {what}"
    reporter.report("UL058", one.address.start, one.address.end, message, "make SIZE larger, or move it")


def _check_fifo(one: Placed, reporter: Reporter) -> None:
    """+0 is the queue itself, +1 is how many words wait for the PC, +2 is the room for words from the PC."""
    element = one.element
    offset = element.addresses[-1] - element.link.base
    if offset >= _FIFO_WORDS:
        message = f"`{element.path}` lies at +{offset}, but a FIFO has three words"
        hint = "+0 is the data, +1 the words that wait, +2 the room"
    elif offset == 0 and element.access not in ("READCLEAR", "PULSE"):
        does = "reading a FIFO takes a word out and writing puts one in"
        message = f"`{element.path}` is a {element.access}, but {does}"
        hint = "make it a READCLEAR to take words out, a PULSE to put words in"
    elif offset and element.access != "READ":
        message = f"`{element.path}` is a {element.access}, but the counts of a FIFO can only be read"
        hint = "make it a READ"
    else:
        return
    reporter.report("UL058", one.address.start, one.address.end, message, hint)


def _check_tosnet(one: Placed, reporter: Reporter) -> None:
    element, number = one.element, one.address
    offset = element.address - element.link.base
    if offset >= protocol.TOSNET_MEMORY_WORDS:
        memory = f"0x000-0x{protocol.TOSNET_MEMORY_WORDS - 1:03X}"
        if offset >> protocol.TOSNET_ADDRESS_BITS:
            message = f"0x{offset:X} lies beyond the {protocol.TOSNET_ADDRESS_BITS} bits of a TosNet address"
        else:
            message = f"0x{offset:X} lies among TosNet's registers, not in its shared memory"
        hint = f"the shared memory is {memory}; behind TOSNET addresses count from its BASE"
        reporter.report("UL053", number.start, number.end, message, hint)
        return
    if element.access not in ("READ", "WRITE", "READWRITE"):
        message = f"`{element.path}` is a {element.access}, but TosNet's shared memory is plain memory"
        hint = "reading and writing have no effect of their own there: choose READ, WRITE or READWRITE"
        reporter.report("UL058", number.start, number.end, message, hint)
        return
    inward = bool(offset >> protocol.TOSNET_IN_BIT & 1)
    section = 1 << protocol.TOSNET_IN_BIT
    if offset // section != (offset + element.words - 1) // section:
        message = (
            f"`{element.path}` has {element.words} words, and a register has {section} of each direction"
        )
        hint = (
            f"the next words belong to another direction: begin at 0x{element.address // section * section:X}"
        )
        reporter.report("UL054", number.start, number.end, message, hint)
        return
    if inward == element.writable:
        return
    node = offset >> protocol.TOSNET_NODE_SHIFT
    if element.writable and node == element.link.ring.node:
        return
    lies = f"0x{offset:X} is an {'IN' if inward else 'OUT'} word of node {node}"
    bit = f"bit {protocol.TOSNET_IN_BIT} of the address tells: 1 = IN, 0 = OUT"
    if element.writable:
        message = f"`{element.path}` is a {element.access}, but {lies}, which only the node itself may write"
        hint = f"right only if node {node} is the PC's own; {bit}"
    else:
        message = f"`{element.path}` is a READ, but {lies}, which the PC writes, and not the node"
        hint = f"what a node sends lies in its OUT words; {bit}"
    reporter.report("UL054", number.start, number.end, message, hint)


def _check_events(roots: Sequence[Instance], placed: Sequence[Placed], reporter: Reporter) -> None:
    """An event with a dot in its name belongs to a component or a FIFO."""
    known: dict[str, set[str]] = {}
    for one in placed:
        publish = one.element.publish
        if publish is None or "." not in publish.event:
            continue
        if one.root not in known:
            known[one.root] = {event for root in roots if root.name == one.root for event in _events(root)}
        if publish.event not in known[one.root]:
            span = one.element.span
            message = f"nothing has the event `{publish.event}`"
            some = ", ".join(f"`{event}`" for event in sorted(known[one.root])[:6])
            hint = f"there are {some}" if some else "a gpio has `changed`, a FIFO has `arrival`"
            start = reporter.sources.offset(span)
            reporter.report("UL102", start, start + span.end - span.start, message, hint)


def _events(instance: Instance) -> Iterator[str]:
    if instance.component is not None and instance.component.node is None:  # a node has no publishes
        yield from (f"{instance.path}.{event}" for event in instance.component.events)
    if own := instance.link.event_at(instance.path):
        yield own
    for inner in instance.instances:
        yield from _events(inner)
