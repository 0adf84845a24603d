# SPDX-License-Identifier: BSD-3-Clause
"""The values of a constructor's parameters in one expansion."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction

from ..meaning.evaluate import MISSING, NONE, Evaluator, Quantity, RunTime, Value
from ..meaning.scope import Scope, matched
from ..model import Member
from ..text.syntax import Argument, ExpansionNode, Parameter
from .wires import Wires

_INT_MAX = 1 << 63
_NOTHING: dict[str, Value] = {}


class Parameters:
    """Evaluates arguments and defaults, and checks them against the declared types."""

    def __init__(self, evaluator: Evaluator) -> None:
        self.evaluator = evaluator
        self.wires = Wires(evaluator)

    def of_public(self, scope: Scope) -> dict[str, Value]:
        """Return the values for a public constructor.

        Nobody gives it arguments, so a string is its own name.
        """
        values: dict[str, Value] = {}
        for one in scope.node.parameters:
            if one.text in scope.runtime:
                values[one.text] = RunTime(one.text)
            elif one.default is not None:
                value = self._typed(one, one.default, values, scope.node.name.text)
                if value is not None:
                    values[one.text] = value
            elif one.type is None or one.type.text == "string":
                values[one.text] = one.text
            else:
                which = f"its {one.type.text} `{one.text}`"
                message = f"nothing gives public constructor `{scope.node.name.text}` {which}"
                hint = f"give it a default: `{one.text}: {one.type.text} = 1`"
                self.evaluator.reporter.report("UL094", one.start, one.end, message, hint)
        return values

    def given(
        self,
        node: ExpansionNode,
        callee: Scope,
        names: Mapping[str, Value],
        found: Mapping[str, list[Member]],
    ) -> dict[str, Value] | None:
        """Return the values of an expansion's parameters. Return None after a diagnostic.

        `found` has the members before it, to which wires may lead.
        """
        values: dict[str, Value] = {}
        for parameter, argument in matched(callee.node.parameters, node.arguments):
            is_wire = parameter.type is not None and parameter.type.text == "wire"
            is_wire = is_wire and not self.evaluator.is_missing(argument, names)
            value = (
                self.wires.find(argument, found, names)
                if is_wire
                else self._typed(parameter, argument, names, node.callee.text)
            )
            if value is None:
                return None
            values[parameter.text] = value
        for one in callee.node.parameters:
            if one.text not in values:
                value = self._typed(one, one.default, values, node.callee.text) if one.default else None
                if value is None:
                    return None
                values[one.text] = value
        return values

    def _typed(
        self, parameter: Parameter, argument: Argument, names: Mapping[str, Value], callee: str
    ) -> Value | None:
        what = f"`{parameter.text}` of `{callee}`"
        if self.evaluator.is_missing(argument, names):
            return self._none(parameter, argument, callee)
        kind = parameter.type.text if parameter.type else ""
        if kind == "int":
            return self.evaluator.integer(argument, names, what, -_INT_MAX, 2 * _INT_MAX - 1)
        if kind == "bool":
            return self.evaluator.integer(argument, names, what, 0, 1)
        if kind == "real":
            value = self.evaluator.value(argument, names)
            if value is None or isinstance(value, (int, Fraction, Quantity)):
                return value
            return self.evaluator.quantity(argument, names, what, None)
        value = self.evaluator.value(argument, names)
        if value is None or isinstance(value, str) or (not kind and isinstance(value, RunTime)):
            return value
        return self.evaluator.text(argument, names, what)

    def _none(self, parameter: Parameter, argument: Argument, callee: str) -> Value | None:
        """Return `none`, for a parameter whose default it is. Otherwise report it."""
        if self.evaluator.is_missing(parameter.default, _NOTHING):
            return MISSING
        message = f"`{parameter.text}` of `{callee}` cannot be `{NONE}`"
        hint = f"give it a value; only a parameter with the default `{NONE}` may be left out like this"
        self.evaluator.reporter.report("UL094", argument.start, argument.end, message, hint)
        return None
