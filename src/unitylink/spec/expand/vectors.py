# SPDX-License-Identifier: BSD-3-Clause
"""The addresses that are bound to a constructor's names, and how many each name needs."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from ..meaning.evaluate import Evaluator, Value
from ..meaning.members import declaration
from ..meaning.scope import ADDRESS_MAX, Scope, Scopes
from ..text.syntax import Binding, ExpansionNode, Expression, Name, Number


@dataclass(frozen=True)
class Vector:
    """Bound addresses. `start` to `end` is the binding, and `statement` is the member around it."""

    numbers: list[Number]
    start: int
    end: int
    statement: int


class Vectors:
    """Binds addresses. It collects vectors of a wrong length, and reports each only once."""

    def __init__(self, scopes: Scopes, evaluator: Evaluator) -> None:
        self.scopes = scopes
        self.reporter = scopes.reporter
        self.evaluator = evaluator
        # (constructor, address taken as one word or "") -> (wrong vectors, users, one user of a right one)
        self._lengths: dict[tuple[str, str], tuple[dict[int, tuple[Vector, Name]], list[Name]]] = {}

    def address(self, node: Expression, names: Mapping[str, Value]) -> Number | None:
        """Return the value of the expression of an address."""
        if type(node) is Number and not node.unit:
            return node  # the range has been checked
        value = self.evaluator.integer(node, names, "an address", 0, ADDRESS_MAX)
        return None if value is None else Number(value, node.start, node.end)

    def bound(
        self, node: ExpansionNode, callee: Scope, given: Mapping[str, Vector], names: Mapping[str, Value]
    ) -> dict[str, Vector] | None:
        """Return the vectors of the called constructor. Only forwarded vectors may still have a wrong length.

        `given` are the vectors of the constructor in which it stands. Return None after a diagnostic.
        """
        addresses = [name.text for name in callee.node.addresses]
        if node.forwards:
            vector = given.get(node.name.text)
            if vector is None:
                return None
            if not callee.node.tuple_form:
                return {addresses[0]: vector}
            return self._take_apart(vector, addresses, node)
        vectors: dict[str, Vector] = {}
        for position, one in enumerate(node.bindings):
            bound = self._vector(one, node, names)
            if bound is None:
                return None
            if one.name is None and callee.node.tuple_form:
                return self._take_apart(bound, addresses, node)
            vectors[one.name.text if one.name else addresses[position]] = bound
        return vectors

    def _vector(self, one: Binding, node: ExpansionNode, names: Mapping[str, Value]) -> Vector | None:
        numbers = []
        for expression in one.numbers:
            number = self.address(expression, names)
            if number is None:
                return None
            numbers.append(number)
        return Vector(numbers, one.start, one.end, node.name.start)

    def _take_apart(self, vector: Vector, names: list[str], node: ExpansionNode) -> dict[str, Vector] | None:
        fits = len(vector.numbers) == len(names)
        if node.forwards:
            self.note_length((node.callee.text, ""), vector, fits, node.name)
        if fits:
            return {
                n: Vector([a], a.start, a.end, vector.statement)
                for n, a in zip(names, vector.numbers, strict=True)
            }
        return None

    def note_length(self, key: tuple[str, str], vector: Vector, fits: bool, user: Name) -> None:
        """Note whether a vector has the length that its user needs."""
        wrong, right = self._lengths.setdefault(key, ({}, []))
        if not fits:
            wrong[vector.start] = vector, user
        elif not right:
            right.append(user)

    def report_lengths(self) -> None:
        """Report each wrong vector. If several have the same wrong length, report their user instead."""
        for (constructor, address), (wrong, right) in self._lengths.items():
            scope = self.scopes.first[constructor]
            names = scope.node.addresses
            takes = f"`{address}` is one word" if address else f"`{constructor}` takes {len(names)} addresses"
            block = bool(address) and scope.node.block is not None  # the head has no such block to compare
            counts = {len(vector.numbers) for vector, _ in wrong.values()}
            if len(wrong) > 1 and len(counts) == 1 and not right and not block:
                at = next((name for name in names if name.text == address), scope.node.name)
                message = f"{takes}, but all {len(wrong)} vectors it is given have {counts.pop()}"
                hint = f"make `{declaration(scope)}` agree with them"
                if address:
                    hint = f"take them apart in a constructor of its own: `@{address}: …(…)`"
                self.reporter.report("UL031", at.start, at.end, message, hint)
                continue
            for vector, user in wrong.values():
                does = "but is bound to" if address else f"but `{user.text}` forwards"
                message = f"{takes} {does} these {len(vector.numbers)}"
                hint = f"they are used in line {self.reporter.sources.line_of(user.start)}"
                labels = [(user.start, user.end, "used here")]
                if block:
                    message = f"`{constructor}` is a block of words, {does} these {len(vector.numbers)}"
                    one = vector.numbers[0] if vector.numbers else None
                    first = self.reporter.sources.text(one.start, one.end) if one else "0x10"
                    hint = f"give its first word: `@ ({first})`; or none, and the compiler finds its place"
                    labels = []
                self.reporter.report("UL031", vector.start, vector.end, message, hint, labels=labels)
