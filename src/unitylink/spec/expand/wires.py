# SPDX-License-Identifier: BSD-3-Clause
"""Finds the elements to which the wires of components lead: `pid(feedback=wheel.position)`."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from fractions import Fraction

from ..meaning.evaluate import Evaluator, Plain, Quantity, Value, Wire
from ..model import Element, Instance, Member
from ..report.suggest import nearest
from ..text.syntax import Argument, Name, Path, Step
from ..units import unit

_NOT_YET = Wire("", "", "", "", 1, 2)  # its component is still to be placed


class Wires:
    """Finds elements by their path from a member on.

    `unplaced` says that some components have no place yet, and so no elements.
    """

    def __init__(self, evaluator: Evaluator) -> None:
        self.evaluator = evaluator
        self.reporter = evaluator.reporter
        self.unplaced = False
        self._driven: dict[tuple[str, str, str], str] = {}

    def clear(self) -> None:
        """Forget which inputs have a wire."""
        self._driven.clear()
        self.unplaced = False

    def drives(self, instance: Instance, root: str, start: int, end: int) -> None:
        """Note the inputs to which an instance leads. Each has one wire."""
        component = instance.component
        for _, direction, other, port in component.connections if component else ():
            first = self._driven.setdefault((root, other, port), instance.path)
            if direction == "out" and first != instance.path:
                message = f"`{first}` has a wire to `{port}` of `{other}` already"
                self.reporter.report("UL106", start, end, message, "give each loop an output of its own")

    def find(
        self, argument: Argument, found: Mapping[str, list[Member]], names: Mapping[str, Value]
    ) -> Wire | None:
        """Return the wire of an argument, or None after a diagnostic. `found` has the members before it."""
        given = self.evaluator.wire(argument, names)
        if given is not None:
            return given
        part = argument.parts[0] if len(argument.parts) == 1 else None
        if isinstance(part, Path):
            steps, text = part.steps, part.text
        elif isinstance(part, Name):
            steps, text = [Step(part, False)], part.text
        else:
            hint = "name an element of a component, such as `wheel.position`"
            self._report(argument, "this is no element to which a wire can lead", hint)
            return None
        members: Iterable[Member] = [one for some in found.values() for one in some]
        owner: Instance | None = None
        element: Element | None = None
        for step in steps:
            name = step.name.text
            if step.index is not None:
                index = self.evaluator.integer(step.index, names, f"the index of `{name}`", 0, 1 << 16)
                if index is None:
                    return None
                name = f"{name}[{index}]"
            member = next((one for one in members if one.name == name), None)
            if isinstance(member, Instance):
                owner, members = member, member.members
            element = member if isinstance(member, Element) else None
            if member is None:
                break
        port = self._port(owner, element)
        if port is None or element is None or owner is None:
            if self.unplaced:
                return _NOT_YET
            known = list(_wired(one for some in found.values() for one in some))
            near = nearest(text, known)
            hint = f"did you mean `{near}`?" if near else _choices(known)
            self._report(argument, f"no wire leads to `{text}`, of what stands before this", hint)
            return None
        return Wire(text, owner.path, *port, _scale(element), element.type.width)

    def _port(self, owner: Instance | None, element: Element | None) -> tuple[str, str] | None:
        wires = owner.component.wires if owner is not None and owner.component is not None else ()
        ports = ((port, way) for port, way, name in wires if element is not None and name == element.name)
        return next(ports, None)

    def _report(self, argument: Argument, message: str, hint: str) -> None:
        self.reporter.report("UL106", argument.start, argument.end, message, hint)


def _choices(known: list[str]) -> str:
    if not known:
        return "a wire leads to a component that stands before this, such as quadrature_encoder or h_bridge"
    return "there are " + ", ".join(known[:8])


def _wired(members: Iterable[Member], prefix: str = "") -> Iterable[str]:
    """Yield the paths of the elements to which a wire can lead."""
    for one in members:
        if isinstance(one, Instance):
            path = f"{prefix}{one.name}"
            names = {name for _, _, name in one.component.wires} if one.component else set()
            yield from (f"{path}.{element.name}" for element in one.elements if element.name in names)
            yield from _wired(one.instances, f"{path}.")


def _scale(element: Element) -> Plain | Quantity:
    scale = Fraction(element.scale)
    measured = unit(element.unit) if element.unit else None
    return scale if measured is None else Quantity(scale * measured.factor, measured.dimension, element.unit)
