# SPDX-License-Identifier: BSD-3-Clause
"""Which constructor expands which: recursion, the size of every expansion before it is made, and the paths of
groups.
"""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable
from dataclasses import dataclass
from itertools import islice
from typing import TypeVar

from ..report.diagnostics import KEPT, Reporter
from ..text.syntax import (
    Argument,
    BrokenNode,
    ElementNode,
    ExpansionNode,
    Expression,
    GroupNode,
    Operation,
    Step,
)
from .scope import Scope, Scopes

# instances, elements and group members of all public constructors; the limit stops macro bombs
MAX_ITEMS = 40_000
MAX_DEPTH = 64

_ENOUGH = 10**9  # larger sizes are not counted exactly
_CHEAP = 16  # this many names or parts of a string count as one item
_K = TypeVar("_K", bound=Hashable)


@dataclass
class Size:
    """The things that one expansion of a constructor makes."""

    items: int = 0
    elements: int = 0
    depth: int = 1


class Graph:
    """Sizes of all constructors and groups. Recursive and oversized members are removed from `usable`."""

    def __init__(self, scopes: Scopes, reporter: Reporter) -> None:
        self.scopes = scopes
        self.reporter = reporter
        self.sizes: dict[str, Size] = {}
        self._group_sizes: dict[tuple[str, str], int] = {}
        self._expanded: dict[str, dict[str, int]] = {}  # constructor -> callee -> instances directly in it
        self._unknown: set[tuple[str, str]] = set()  # (constructor, name), so that each is reported once
        self._rings: dict[
            str, dict[str, str]
        ] = {}  # constructor -> constructor that it must not expand -> the ring
        self._ring_count = 0
        order = _callees_first(scopes.first, self._callees, self._report_recursion)
        self._cut_rings()
        for name in order:
            self._measure(scopes.first[name])
        # constructors that are declared twice are not expanded, but their groups are checked
        for scope in scopes.all:
            if scopes.first.get(scope.node.name.text) is not scope:
                for member in scope.usable.values():
                    if isinstance(member, GroupNode):
                        self._check_paths(scope, member)

    def _callees(self, name: str) -> list[str]:
        callees = dict.fromkeys(expansion.callee.text for expansion in self.scopes.first[name].expansions)
        return [callee for callee in callees if callee in self.scopes.first]

    def _report_recursion(self, trail: list[str], callee: str) -> None:
        """`callee` is already on the trail.

        Note the expansion that closes the ring, so that it is left out.
        """
        shown: list[str] = []
        self._ring_count += 1
        if self._ring_count <= KEPT:
            ring = [*trail[trail.index(callee) :], callee]
            shown = ring if len(ring) <= 8 else [*ring[:4], "…", *ring[-3:]]
        self._rings.setdefault(trail[-1], {})[callee] = " → ".join(shown)

    def _cut_rings(self) -> None:
        hint = "a constructor is a macro: it cannot contain itself, directly or through others"
        for name, rings in self._rings.items():
            scope = self.scopes.first[name]
            for member in [m for m in scope.expansions if m.callee.text in rings]:
                callee = member.callee
                message = f"`{callee.text}` expands itself: {rings[callee.text]}"
                self.reporter.report("UL034", callee.start, callee.end, message, hint)
                del scope.usable[member.name.text]

    # --- sizes ----------------------------------------------------------------------------------------------

    def _measure(self, scope: Scope) -> None:
        # The work in each expansion counts too. Otherwise long lists in small constructors would take too
        # long.
        size = Size(items=(len(scope.parameters) + len(scope.addresses)) // _CHEAP)
        for member in scope.usable.values():
            if isinstance(member, ElementNode):
                times = self.times(member)
                size.items += times * (1 + cost_of_element(member))
                size.elements += times
            elif isinstance(member, ExpansionNode):
                times = self.times(member)
                inner = self.sizes.get(member.callee.text, Size())
                size.items += times * (1 + inner.items + cost_of_expansion(member))
                size.elements += times * inner.elements
                size.depth = max(size.depth, 1 + inner.depth)
        size.elements = min(size.elements, _ENOUGH)
        self.sizes[scope.node.name.text] = size
        size.items = min(size.items + self._measure_groups(scope), _ENOUGH)

    def times(self, member: ElementNode | ExpansionNode) -> int:
        """Return how many items an array has.

        If a parameter decides, return 1, because then the expansion counts.
        """
        if member.count is None:
            return 1
        return (
            self.scopes.declared.evaluator.integer(member.count, {}, "the size of an array", 1, MAX_ITEMS)
            or 1
        )

    def _measure_groups(self, scope: Scope) -> int:
        groups = {name: member for name, member in scope.usable.items() if isinstance(member, GroupNode)}

        def report_ring(trail: list[str], inner: str) -> None:
            node = groups[trail[-1]]
            message = f"group `{inner}` contains itself: " + " → ".join(
                [*trail[trail.index(inner) :][:8], inner]
            )
            hint = "list the elements, or another group"
            self.reporter.report("UL035", node.name.start, node.name.end, message, hint)
            scope.usable.pop(trail[-1], None)

        def inner_groups(name: str) -> list[str]:
            firsts = dict.fromkeys(p[0].name.text for p in groups[name].paths if not p[0].all)
            return [first for first in firsts if first in groups]

        total = 0
        for name in _callees_first(groups, inner_groups, report_ring):
            count = self._check_paths(scope, groups[name])
            self._group_sizes[scope.node.name.text, name] = count
            total += 1 + count
        return total

    # --- paths ----------------------------------------------------------------------------------------------

    def _check_paths(self, scope: Scope, group: GroupNode) -> int:
        """Report wrong paths.

        Return the number of elements that the right paths lead to. An element that is named twice counts
        twice.
        """
        for path in group.paths:
            for step in path:
                if step.index is not None:
                    self.scopes.names_of(scope, step.index)
        return min(sum(self._follow(scope, path) for path in group.paths), _ENOUGH)

    def _follow(self, scope: Scope, path: list[Step]) -> int:
        here = scope
        count = 1
        for position, step in enumerate(path):
            callee: Scope | None
            if step.all:
                found = self._all(here, step)
                callee, times = self.scopes.first.get(step.name.text), found
                if not found:
                    return 0
                count = min(count * times, _ENOUGH)
            else:
                member = here.members.get(step.name.text)
                if member is None or isinstance(member, BrokenNode):
                    if member is None:
                        self._report_unknown(here, step)
                    return 0
                if not isinstance(member, GroupNode) and member.count is not None:
                    count *= 1 if step.index else self.times(member)
                elif step.index is not None:
                    self._report_no_array(step)
                    return 0
                if not isinstance(member, ExpansionNode):
                    if position + 1 < len(path):
                        self._report_below(path[position + 1], member)
                        return 0
                    if isinstance(member, ElementNode):
                        return count
                    inner = self._group_sizes.get((here.node.name.text, member.name.text), 0)
                    return max(count, count * inner)
                callee = self.scopes.first.get(member.callee.text)
            if callee is None:
                return 0
            here = callee
        size = self.sizes.get(here.node.name.text)
        return min(max(count, count * size.elements), _ENOUGH) if size else 0

    def _all(self, here: Scope, step: Step) -> int:
        """Return how many expansions of the step's constructor are directly in `here`."""
        name = step.name.text
        if name not in self.scopes.first:
            self.scopes.unknown_constructor(step.name)
            return 0
        found = self._instances(here).get(name, 0)
        if not here.expanded[name] and here.complete:
            message = f"`{here.node.name.text}` has no expansion of `{name}`"
            hint = "ALL takes what stands directly in a constructor; go down with a path such as `a.ALL(b)`"
            self.reporter.report("UL028", step.name.start, step.name.end, message, hint)
        return found

    def _instances(self, here: Scope) -> dict[str, int]:
        known = self._expanded.get(here.node.name.text)
        if known is None:
            known = self._expanded[here.node.name.text] = {}
            for member in here.expansions:
                callee = member.callee.text
                known[callee] = known.get(callee, 0) + self.times(member)
        return known

    def _report_no_array(self, step: Step) -> None:
        message = f"`{step.name.text}` is no array"
        self.reporter.report("UL027", step.name.start, step.name.end, message, "remove the `[…]`")

    def _report_unknown(self, here: Scope, step: Step) -> None:
        name = step.name.text
        if here.node.broken or here.node.incomplete or (here.node.name.text, name) in self._unknown:
            return
        self._unknown.add((here.node.name.text, name))
        if here.excuses("UL027"):
            return
        hint = f"every expansion of a constructor is `ALL({name})`" if name in self.scopes.first else ""
        some = islice(here.members.values(), 50)
        others = [f"`{m.name.text}`" for m in some if not isinstance(m, GroupNode)]
        if others and not hint:
            hint = "its members are " + ", ".join(others[:6]) + (", …" if len(others) > 6 else "")
        at = (step.name.start, step.name.end)
        advice = self.reporter.did_you_mean(name, here.members, hint, at)
        self.reporter.report("UL027", *at, f"`{here.node.name.text}` has no member `{name}`", advice)

    def _report_below(self, step: Step, member: ElementNode | GroupNode) -> None:
        what = "an element" if isinstance(member, ElementNode) else "a group"
        message = f"`{member.name.text}` is {what}: there is no `{step.name.text}` below it"
        self.reporter.report("UL027", step.name.start, step.name.end, message, "end the path before the dot")


def _leaves(node: Expression) -> int:
    """Return the number of names, numbers and strings in an expression."""
    if isinstance(node, Argument):
        return 1 if node.literal else sum(map(_leaves, node.parts))
    if isinstance(node, Operation):
        return _leaves(node.right) + (_leaves(node.left) if node.left is not None else 0)
    return 1


def cost_of_element(node: ElementNode) -> int:
    """Return the cost of evaluating an element's properties in each expansion."""
    return sum(_leaves(one.argument) for one in node.properties if one.argument is not None) // _CHEAP


def cost_of_expansion(node: ExpansionNode) -> int:
    """Return the cost of evaluating the arguments and addresses of an expansion."""
    addresses = sum(len(binding.numbers) for binding in node.bindings)
    return (sum(map(_leaves, node.arguments)) + addresses) // _CHEAP


def _callees_first(
    nodes: Iterable[_K], callees: Callable[[_K], Iterable[_K]], on_ring: Callable[[list[_K], _K], None]
) -> list[_K]:
    """Return the nodes in an order in which each comes after those that it leads to.

    Report each edge that closes a ring.

    It uses no recursion, because a chain may be as long as the file.
    """
    order: list[_K] = []
    done: set[_K] = set()
    for first in nodes:
        if first in done:
            continue
        trail = [first]
        on_trail = {first}
        pending = [iter(callees(first))]
        while trail:
            following = next(pending[-1], None)
            if following is None:
                pending.pop()
                finished = trail.pop()
                on_trail.discard(finished)
                done.add(finished)
                order.append(finished)
            elif following in on_trail:
                on_ring(trail, following)
            elif following not in done:
                trail.append(following)
                on_trail.add(following)
                pending.append(iter(callees(following)))
    return order
