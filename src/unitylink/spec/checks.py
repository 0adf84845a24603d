# SPDX-License-Identifier: BSD-3-Clause
"""What can be wrong with a spec whose every name is right: addresses, publishing, things without use."""

from __future__ import annotations

from collections.abc import Sequence

from .. import protocol
from .diagnostics import Reporter
from .model import Element, Instance
from .resolve import Placed
from .scope import Scope, Scopes
from .syntax import Name

# The 2012 gateware never stops publishing a group that is filled to its advertised size.
_USABLE_2012 = protocol.GROUP_SIZE_2012 - 1

_Device = tuple[str, "str | None"]  # public constructor and its COMM: one address space, one set of groups


def check_model(placed: Sequence[Placed], reporter: Reporter) -> None:
    """Report what is wrong or doubtful about the addresses and publishes of expanded elements."""
    _check_overlaps(placed, reporter)
    for one in placed:
        if one.element.link.kind == "tosnet":
            _check_tosnet(one, reporter)
    _check_publishes(placed, reporter)


def check_unused(scopes: Scopes, roots: Sequence[Instance], reporter: Reporter) -> None:
    """Report what has no effect; meant for a spec without errors, where nothing is unused by accident."""
    for root in roots:
        _check_groups(root, reporter)
    expanded = {e.callee.text for scope in scopes.all for e in scope.expansions}
    for scope in scopes.all:
        name = scope.node.name
        if not scope.node.public and name.text not in expanded:
            message = f"constructor `{name.text}` is never expanded"
            reporter.report(
                "UL070", name.start, name.end, message, "make it `public`, expand it, or remove it"
            )
            continue
        _check_parameters(scope, reporter)
        for address in scope.node.addresses:
            if address.text not in scope.used_addresses and address.text[0] != "_":
                _report_unused(reporter, "UL072", "address", address)


def _check_groups(instance: Instance, reporter: Reporter) -> None:
    for group in instance.groups:
        if not group.elements:
            message = f"group `{group.path}` has no elements"
            hint = "what its paths lead to is empty: remove it, or list elements"
            reporter.report("UL074", group.span.start, group.span.end, message, hint)
    for inner in instance.instances:
        _check_groups(inner, reporter)


def _check_parameters(scope: Scope, reporter: Reporter) -> None:
    for parameter in scope.node.parameters:
        if parameter.text not in scope.used_parameters:
            if parameter.text[0] != "_":
                _report_unused(reporter, "UL071", "parameter", parameter)
        elif scope.node.public and parameter.text not in scope.runtime:
            message = (
                f"nothing gives public constructor `{scope.node.name.text}` its string `{parameter.text}`"
            )
            hint = f'its value is its own name, "{parameter.text}"; write the text itself instead'
            reporter.report("UL073", parameter.start, parameter.end, message, hint)


def _report_unused(reporter: Reporter, code: str, what: str, name: Name) -> None:
    message = f"{what} `{name.text}` is never used"
    reporter.report(
        code, name.start, name.end, message, f"remove it, or call it `_{name.text}` if it is meant so"
    )


# --- addresses ----------------------------------------------------------------------------------------------


def _check_overlaps(placed: Sequence[Placed], reporter: Reporter) -> None:
    """One diagnostic for each pair of statements: an expansion copied whole is one mistake."""
    first: dict[tuple[_Device, int, str], Placed] = {}
    pairs: dict[tuple[str, int, int], tuple[Placed, Placed, int]] = {}
    for one in placed:
        element = one.element
        device = (one.root, element.link.comm)
        other = "WRITE" if element.access == "READ" else "READ"
        for code, access in (("UL051", element.access), ("UL052", other)):
            earlier = first.get((device, element.address, access))
            if earlier is not None:
                key = (code, earlier.statement, one.statement)
                count = pairs[key][2] + 1 if key in pairs else 1
                pairs.setdefault(key, (earlier, one, 0))
                pairs[key] = (*pairs[key][:2], count)
        first.setdefault((device, element.address, element.access), one)
    for (code, _, _), (earlier, one, count) in pairs.items():
        line = reporter.source.line_of(earlier.address.start)
        more = f", and {count - 1} more of the same statements" if count > 1 else ""
        where = f"at address 0x{one.element.address:X}"
        if code == "UL051":
            message = (
                f"`{one.element.path}` lies {where}, where `{earlier.element.path}` of line {line} is{more}"
            )
            hint = "give one of them another address; a second name for elements is a group, `name = path`"
        else:
            message = (
                f"`{one.element.path}` is a {one.element.access} {where}, where line {line} has the "
                f"{earlier.element.access} `{earlier.element.path}`{more}"
            )
            hint = "give one of them another address; a WRITE keeps the value it wrote last, to be read back"
        reporter.report(code, one.address.start, one.address.end, message, hint)


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
    inward = bool(offset >> protocol.TOSNET_IN_BIT & 1)
    if inward == (element.access == "WRITE"):
        return
    node = offset >> protocol.TOSNET_NODE_SHIFT
    lies = f"0x{offset:X} is an {'IN' if inward else 'OUT'} word of node {node}"
    bit = f"bit {protocol.TOSNET_IN_BIT} of the address tells: 1 = IN, 0 = OUT"
    if element.access == "WRITE":
        message = f"`{element.path}` is a WRITE, but {lies}, which only the node itself may write"
        hint = f"right only if node {node} is the PC's own; {bit}"
    else:
        message = f"`{element.path}` is a READ, but {lies}, which is written from here and not by the node"
        hint = f"what a node sends lies in its OUT words; {bit}"
    reporter.report("UL054", number.start, number.end, message, hint)


# --- publishing ---------------------------------------------------------------------------------------------


def _check_publishes(placed: Sequence[Placed], reporter: Reporter) -> None:
    """Hardware publishes of one device and rate are one group, split where the gateware's are smaller."""
    rates: dict[_Device, dict[int, list[Element]]] = {}
    for one in placed:
        publish = one.element.publish
        if publish is not None and publish.mode == 1:
            device = (one.root, one.element.link.comm)
            rates.setdefault(device, {}).setdefault(publish.divisor, []).append(one.element)
    for by_divisor in rates.values():
        groups = 0
        told = False
        for divisor, elements in by_divisor.items():
            _check_rate(divisor, elements, reporter)
            before, groups = groups, groups + -(-len(elements) // _USABLE_2012)
            if before <= protocol.GROUPS_2012 < groups and not told:
                told = True
                message = f"with this rate the publishes need more than {protocol.GROUPS_2012} groups"
                hint = f"the 2012 gateware has at most {protocol.GROUPS_2012}: use fewer rates, or mode 2"
                reporter.report("UL066", *_place(elements[0]), message, hint)
        if len(by_divisor) > protocol.GROUPS_MAX:
            message = f"{len(by_divisor)} different rates need more than {protocol.GROUPS_MAX} groups"
            hint = f"the group number is one byte: use at most {protocol.GROUPS_MAX} rates, or mode 2"
            last = list(by_divisor.values())[protocol.GROUPS_MAX]
            reporter.report("UL067", *_place(last[0]), message, hint)


def _check_rate(divisor: int, elements: list[Element], reporter: Reporter) -> None:
    count = f"{len(elements)} elements publish"
    if len(elements) > protocol.GROUP_SIZE_MAX:
        message = f"{count} at divisor {divisor}; a message carries {protocol.GROUP_SIZE_MAX}"
        hint = "all of one rate are one snapshot: use several rates, or mode 2 for some"
        reporter.report("UL065", *_place(elements[protocol.GROUP_SIZE_MAX]), message, hint)
    elif len(elements) > _USABLE_2012:
        message = f"{count} at divisor {divisor}; a group of the 2012 gateware holds {_USABLE_2012}"
        hint = "there they come as several groups, no longer as one snapshot; use several rates, or mode 2"
        reporter.report("UL064", *_place(elements[_USABLE_2012]), message, hint)


def _place(element: Element) -> tuple[int, int]:
    return element.span.start, element.span.end
