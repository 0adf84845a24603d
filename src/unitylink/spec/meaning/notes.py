# SPDX-License-Identifier: BSD-3-Clause
"""From annotations of the syntax tree to those of the model, and to components.

`@component("pwm")` names the entity of the gateware library for a constructor. `@generic(name=value)` gives
its generics. `@pin("pins", "out", 4)` and `@event("changed")` name the ports that are connected.
`@limit(value, most=other)` says what the generics cannot be (`generic_limits.py`).
`@source("pwm.vhd")` names the VHDL of an entity that is not of the library. `@sequence`, `@setup` and
`@cycle` are the program of a device on SPI or I²C (`sequence.py`). `@wire("port", "out", "position")` is a
port for the value of an element, and `@wire("port", "in", parameter)` leads to one. `@when(number)` is before
an element.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from fractions import Fraction

from ..annotation import Annotation, AnnotationValue
from ..model import Component
from ..text.syntax import AnnotationNode, Argument, Notes
from .evaluate import Evaluator, Value
from .generic_limits import check_limit, check_ranges, is_limit
from .sequence import KINDS, generics_of
from .vhdl_names import check_names
from .vhdl_source import find_source

RESERVED = ("component", "generic", "pin", "event", "source", "limit", "when", "wire", *KINDS)
_DIRECTIONS = ("in", "out", "inout")
_MAX_BITS = 4096
_NAME = re.compile(r"[A-Za-z](?:_?[A-Za-z0-9])*", re.ASCII)  # name of an entity, a port or a generic in VHDL


def annotations_of(notes: Notes, evaluator: Evaluator, names: Mapping[str, Value]) -> tuple[Annotation, ...]:
    """Return the annotations except those of a component."""
    found = []
    for node in notes.annotations:
        if node.name.text not in RESERVED:
            values: list[AnnotationValue] = []
            options: list[tuple[str, AnnotationValue]] = []
            for argument in node.arguments:
                value = _plain(evaluator.value(argument, names))
                if value is None:
                    continue
                if argument.key is None:
                    values.append(value)
                else:
                    options.append((argument.key.text, value))
            found.append(Annotation(node.name.text, tuple(values), tuple(options)))
    return tuple(found)


def is_there(notes: Notes, evaluator: Evaluator, names: Mapping[str, Value]) -> bool:
    """Is there an element with these notes? `@when(number)` leaves it out if the number is 0."""
    for node in notes.annotations:
        if node.name.text == "when":
            if len(node.arguments) != 1 or node.arguments[0].key is not None:
                _wrong(node, evaluator)
                return False
            if not evaluator.integer(node.arguments[0], names, "`@when`", 0, (1 << 31) - 1):
                return False
    return True


def _plain(value: Value | None) -> AnnotationValue | None:
    if isinstance(value, Fraction):
        return float(value)
    return value if isinstance(value, (int, str)) else None


def component(
    notes: Notes, evaluator: Evaluator, names: Mapping[str, Value], base: int, words: int
) -> Component | None:
    """Return the component for which a constructor stands.

    Return None if it stands for none, or has a mistake.
    """
    entity = ""
    generics: list[tuple[str, int | str]] = []
    given: list[tuple[Argument, str, int]] = []
    told: list[tuple[AnnotationNode, str]] = []  # names of the VHDL
    pins: list[tuple[str, str, int]] = []
    events: list[str] = []
    sources: list[str] = []
    steps: list[AnnotationNode] = []
    wires: list[tuple[str, str, str]] = []
    connections: list[tuple[str, str, str, str]] = []
    clock_least_hz = 0
    for node in notes.annotations:
        kind = node.name.text
        if kind not in RESERVED or kind == "when":
            continue
        if kind in KINDS:
            steps.append(node)
            continue
        texts = [
            v for a in node.arguments if a.key is None and isinstance(v := evaluator.value(a, names), str)
        ]
        keys = [a.key.text for a in node.arguments if a.key is not None]
        named = () if kind == "source" else texts[:1]
        if kind in ("pin", "event", "wire"):
            told += [(node, name) for name in named]
        elif kind == "generic":
            told += [(node, name) for name in keys]
        wrong = next((name for name in (*named, *keys) if not _NAME.fullmatch(name)), None)
        if wrong is not None:
            message = f"{wrong!r} is no name of VHDL"
            hint = "a letter first, then letters, digits and single `_` between them"
            evaluator.reporter.report("UL098", node.name.start, node.name.end, message, hint)
        elif kind == "component" and len(texts) == 1 and len(node.arguments) == 1:
            entity = texts[0]
        elif kind == "source" and texts and len(texts) == len(node.arguments):
            paths = zip(texts, node.arguments, strict=True)
            found = [find_source(text, argument, evaluator.reporter) for text, argument in paths]
            sources += [path for path in found if path is not None]
        elif kind == "event" and len(texts) == 1 and len(node.arguments) == 1:
            events.append(texts[0])
        elif kind == "generic" and node.arguments and all(a.key is not None for a in node.arguments):
            for argument in node.arguments:
                value = evaluator.integer(argument, names, "a generic", -(1 << 31), (1 << 31) - 1)
                if value is not None and argument.key is not None:
                    generics.append((argument.key.text, value))
                    given.append((argument, argument.key.text, value))
        elif kind == "pin" and len(texts) == 2 and texts[1] in _DIRECTIONS and len(node.arguments) <= 3:
            bits: int | None = 0
            if len(node.arguments) == 3:
                bits = evaluator.integer(node.arguments[2], names, "the number of pins", 0, _MAX_BITS)
            if bits is not None:
                pins.append((texts[0], texts[1], bits))
        elif kind == "wire" and len(texts) == 3 and texts[1] in ("in", "out"):
            wires.append((texts[0], texts[1], texts[2]))
        elif kind == "wire" and texts[1:] in (["in"], ["out"]) and len(node.arguments) == 3:
            port, direction = texts
            is_open = evaluator.is_missing(node.arguments[2], names)
            wire = None if is_open else evaluator.wire(node.arguments[2], names)
            if wire is None and not is_open:
                _wrong(node, evaluator)
                continue
            wires.append((port, direction, ""))
            if wire is None:
                continue
            if wire.direction == direction:
                given_or_taken = "takes a value" if direction == "in" else "gives a value"
                message = f"`{wire.name}` {given_or_taken} itself, and cannot be the {port} of this"
                hint = "a wire leads from an output to an input"
                evaluator.reporter.report("UL106", node.name.start, node.name.end, message, hint)
            elif wire.component:
                connections.append((port, direction, wire.component, wire.port))
            if direction == "out" and wire.component:
                generics.append((f"{port}_bits", wire.bits))
                given.append((node.arguments[2], f"{port}_bits", wire.bits))
        elif kind == "limit" and is_limit(node):
            clock_least_hz = max(clock_least_hz, check_limit(node, evaluator, names))
        else:
            _wrong(node, evaluator)
    if steps:
        generics += generics_of(steps, evaluator, names, entity)
    if not entity:
        return None
    check_names(entity, sources, told, evaluator.reporter)
    check_ranges(entity, sources, given, evaluator)
    ports = tuple(pins), tuple(events)
    ends = tuple(wires), tuple(connections)
    return Component(entity, base, words, tuple(generics), *ports, tuple(sources), clock_least_hz, *ends)


def _wrong(node: AnnotationNode, evaluator: Evaluator) -> None:
    kind = node.name.text
    hint = {
        "component": '`@component("entity")`',
        "generic": "`@generic(name=number)`",
        "pin": '`@pin("port", "in")`, `@pin("port", "out", bits)`',
        "event": '`@event("port")`',
        "source": '`@source("stepper.vhd")`',
        "limit": "`@limit(shortest, least=20, most=longest)`, `@limit(clock_hz, least=8*baud)`",
        "when": "`@when(with_index)`",
        "wire": '`@wire("port", "out", "element")`, `@wire("port", "in", parameter)`',
    }[kind]
    message = f"this is no `@{kind}`" if kind == "when" else f"this is no `@{kind}` of a component"
    evaluator.reporter.report("UL098", node.name.start, node.name.end, message, f"write it like {hint}")
