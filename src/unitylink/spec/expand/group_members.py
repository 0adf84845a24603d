# SPDX-License-Identifier: BSD-3-Clause
"""Resolves the paths of groups while one public constructor is expanded."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from unitylink.protocol import GROUP_SIZE_MAX

from ..meaning.evaluate import Evaluator, Value
from ..meaning.graph import MAX_ITEMS
from ..meaning.notes import annotations_of
from ..model import Element, Group, Instance, Member
from ..text.syntax import GroupNode, Step
from .node_parts import report_if_hidden

Found = dict[str, list[Member]]  # by the declared name; that of an array has all members of the array


class GroupMaker:
    """Makes the groups of instances. `members` has the members of each instance, by its path."""

    def __init__(self, evaluator: Evaluator) -> None:
        self.evaluator = evaluator
        self.reporter = evaluator.reporter
        self.members: dict[str, Found] = {}
        self._by_constructor: dict[str, dict[str, list[Instance]]] = {}

    def clear(self) -> None:
        """Forget the instances, because another public constructor comes."""
        self.members.clear()
        self._by_constructor.clear()

    def add(self, waiting: Sequence[GroupNode], path: str, names: Mapping[str, Value]) -> None:
        """Make the groups of the instance at `path`. A group that lists another group is made after it."""
        found = self.members[path]
        of_groups = {node.name.text for node in waiting}
        needed = {
            n.name.text: [p[0].name.text for p in n.paths if not p[0].all and p[0].name.text in of_groups]
            for n in waiting
        }
        by_name = {node.name.text: node for node in waiting}
        prefix = f"{path}." if path else ""
        for first in waiting:
            stack = [first.name.text]
            while stack:
                text = stack[-1]
                missing = [name for name in needed[text] if name not in found]
                if missing:
                    stack.extend(missing)
                    continue
                stack.pop()
                if text not in found:
                    found[text] = [self._group(by_name[text], path, prefix + text, names)]

    def _group(self, node: GroupNode, here: str, path: str, names: Mapping[str, Value]) -> Group:
        elements: dict[str, Element] = {}
        for steps in node.paths:
            for element in self._elements(steps, here, names):
                if element.path in elements:
                    at = steps[0].name
                    message = f"`{element.path}` is in group `{node.name.text}` already"
                    self.reporter.report("UL069", at.start, steps[-1].name.end, message, "list it once")
                elements[element.path] = element
        words = sum(element.words for element in elements.values())
        name = node.name
        if words > GROUP_SIZE_MAX:
            what = "elements" if words == len(elements) else "words"
            message = f"group `{name.text}` has {words:,} {what}"
            hint = f"a message carries at most {GROUP_SIZE_MAX}: divide it into several groups"
            self.reporter.report("UL068", name.start, name.end, message, hint)
        span = self.reporter.sources.span(name.start, name.end)
        notes = annotations_of(node.notes, self.evaluator, names) if node.notes.annotations else ()
        return Group(name.text, path, tuple(elements.values()), span, node.notes.documentation, notes)

    def _elements(self, steps: list[Step], path: str, names: Mapping[str, Value]) -> list[Element]:
        paths = [path]
        reached: list[Member] = []
        for step in steps:
            name = step.name.text
            if step.all:
                reached = [one for at in paths for one in self._expansions(at).get(name, ())]
            else:
                reached = []
                for at in paths:
                    found = self.members[at].get(name, [])
                    reached += found if step.index is None else self._at_index(step, found, names)
            paths = [member.path for member in reached if isinstance(member, Instance)]
        elements: list[Element] = []
        for member in reached:
            if isinstance(member, Element):
                if len(steps) > 1:  # a component's own group goes without what does not travel
                    report_if_hidden(member, steps[-1].name, self.reporter)
                elements.append(member)
            else:
                elements.extend(member.walk() if isinstance(member, Instance) else member.elements)
        return elements

    def _at_index(self, step: Step, found: list[Member], names: Mapping[str, Value]) -> list[Member]:
        assert step.index is not None  # the caller has checked it
        if not found:
            return []
        what = f"the index of `{step.name.text}`"
        index = self.evaluator.integer(step.index, names, what, 0, min(len(found), MAX_ITEMS) - 1)
        return [] if index is None else [found[index]]

    def _expansions(self, path: str) -> dict[str, list[Instance]]:
        """Return the instances directly below `path` by their constructor."""
        known = self._by_constructor.get(path)
        if known is None:
            known = self._by_constructor[path] = {}
            for members in self.members[path].values():
                for member in members:
                    if isinstance(member, Instance):
                        known.setdefault(member.constructor, []).append(member)
        return known
