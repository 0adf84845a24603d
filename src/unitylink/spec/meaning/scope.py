# SPDX-License-Identifier: BSD-3-Clause
"""The meaning of the names in each constructor."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass, field
from itertools import chain
from typing import TypeVar, Union

from unitylink.protocol import ADDRESS_BITS_MAX

from ..model import READS, WRITES
from ..report.diagnostics import Advice, Reporter
from ..text.cursor import ACCESS_WORDS
from ..text.imports import component_names
from ..text.syntax import (
    Argument,
    BrokenNode,
    ConstructorNode,
    ElementNode,
    ExpansionNode,
    Expression,
    GroupNode,
    LinkKindNode,
    Name,
    Number,
    Parameter,
    Program,
    Property,
)
from .declared import Declared
from .evaluate import WORDS
from .type_names import names_of

UsableNode = Union[ExpansionNode, ElementNode, GroupNode]
ADDRESS_MAX = (1 << ADDRESS_BITS_MAX) - 1
INDEX = "i"  # the name of the index in the statement of an array

_T = TypeVar("_T", "Scope", Name, Parameter, Union[ExpansionNode, ElementNode, GroupNode, BrokenNode])


@dataclass
class Scope:
    """The names of one constructor."""

    node: ConstructorNode
    parameters: dict[str, int] = field(default_factory=dict)  # name -> position
    addresses: dict[str, int] = field(default_factory=dict)
    members: dict[str, UsableNode | BrokenNode] = field(default_factory=dict)
    # members without a mistake, which are expanded
    usable: dict[str, UsableNode] = field(default_factory=dict)
    link_kind: LinkKindNode | None = None
    runtime: set[str] = field(default_factory=set)  # parameters that reach CTRL or COMM
    used_parameters: set[str] = field(default_factory=set)
    used_addresses: set[str] = field(default_factory=set)
    # addresses that are used in expressions, with their first use
    computed: dict[str, Name] = field(default_factory=dict)
    expanded: Counter[str] = field(
        default_factory=Counter
    )  # constructor -> members that expand it, whether they are right or wrong
    wrong_head: set[str] = field(
        default_factory=set
    )  # codes that are reported at the head, because all expansions differ from it
    complete: bool = True  # whether no member is broken or missing
    excused: Counter[str] = field(
        default_factory=Counter
    )  # code -> unknown names that may be meant as a name that is declared twice

    @property
    def expansions(self) -> Iterable[ExpansionNode]:
        """The expansions without a mistake."""
        return (member for member in self.usable.values() if isinstance(member, ExpansionNode))

    def excuses(self, code: str) -> bool:
        """Return whether this unknown name may be one that is lost because it was declared twice.

        Then it is not a second mistake.
        """
        self.excused[code] -= 1
        return self.excused[code] >= 0

    def link_property(self, key: str) -> Property | None:
        """Return the property `key` of TOSNET, MEMORY, DOUBLE_BUFFER or FIFO, if it is given."""
        properties = self.link_kind.properties if self.link_kind else ()
        return next((one for one in properties if one.key == key), None)


def matched(parameters: list[Parameter], arguments: list[Argument]) -> Iterable[tuple[Parameter, Argument]]:
    """Return the argument of each parameter. Leave out arguments that fit no parameter."""
    if not any(argument.key for argument in arguments):
        return zip(parameters, arguments, strict=False)
    places = {parameter.text: parameter for parameter in parameters}
    pairs = []
    for position, argument in enumerate(arguments):
        parameter = places.get(argument.key.text) if argument.key else None
        if argument.key is None and position < len(parameters):
            parameter = parameters[position]
        if parameter is not None:
            pairs.append((parameter, argument))
    return pairs


class Scopes:
    """The scopes of a program.

    `first` finds a scope by its name. `all` also has scopes that are declared twice.
    """

    def __init__(self, program: Program, declared: Declared, reporter: Reporter) -> None:
        self.program = program
        self.declared = declared
        self.reporter = reporter
        self.all: list[Scope] = []
        self.first: dict[str, Scope] = {}
        self._unknown: set[tuple[str, str]] = set()
        for node in program.constructors:
            self._declare(node)
        self._find_runtime_parameters()

    # --- declarations ---------------------------------------------------------------------------------------

    def _declare(self, node: ConstructorNode) -> None:
        scope = Scope(node, complete=not (node.broken or node.incomplete))
        self.all.append(scope)
        if node.name.text:
            self._once(self.first, scope, node.name, "UL020")
        known: dict[str, Parameter] = {}
        for position, one in enumerate(node.parameters):
            scope.excused["UL025"] += not self._once(known, one, one, "UL022")
            scope.parameters.setdefault(one.text, position)
        seen: dict[str, Name] = {}
        for position, name in enumerate(node.addresses):
            scope.excused["UL026"] += not self._once(seen, name, name, "UL023")
            scope.addresses.setdefault(name.text, position)
        for member in node.members:
            if isinstance(member, LinkKindNode):
                self._declare_link_kind(scope, member)
                continue
            if isinstance(member, BrokenNode) and member.name.text in scope.members:
                continue
            if not self._once(scope.members, member, member.name, "UL021"):
                scope.excused["UL027"] += 1
                # its address counts as used all the same
                if isinstance(member, (ElementNode, ExpansionNode)):
                    scope.used_addresses.add(member.name.text)
                continue
            if isinstance(member, BrokenNode):
                scope.complete = False
                continue
            scope.usable[member.name.text] = member
            if isinstance(member, ExpansionNode):
                scope.expanded[member.callee.text] += 1

    def _once(self, table: dict[str, _T], value: _T, name: Name, code: str) -> bool:
        """Put `value` into `table`. If the name is already there, report it instead."""
        if name.text not in table:
            table[name.text] = value
            return True
        first = _name_of(table[name.text])
        what = {"UL020": "constructor", "UL021": "member", "UL022": "parameter", "UL023": "address"}[code]
        message = f"{what} `{name.text}` is declared twice"
        labels = [(first.start, first.end, "first declared here")]
        self.reporter.report(
            code, name.start, name.end, message, "give one of them another name", labels=labels
        )
        return False

    def _declare_link_kind(self, scope: Scope, node: LinkKindNode) -> None:
        if scope.link_kind is not None:
            first = scope.link_kind
            message = f"`{scope.node.name.text}` has a {first.kind} already"
            hint = "one instance has one hardware proxy: put the second into a constructor of its own"
            labels = [(first.start, first.end, "the first one")]
            self.reporter.report("UL041", node.start, node.end, message, hint, labels=labels)
            return
        scope.link_kind = node
        for one in node.properties:
            if one.key in ("CTRL", "COMM"):
                if one.name is not None and self.parameter(scope, one.name):
                    scope.runtime.add(one.name.text)
            elif one.key == "NODES":
                continue  # a word of the language
            elif one.key == "LINK":
                self._link(one)
            elif one.argument is not None:
                self.names_of(scope, one.argument)
                for part in one.argument.parts[:1]:
                    if isinstance(part, Number):
                        self.word(part, one.key)

    def _link(self, one: Property) -> None:
        name, links = one.name, self.declared.links
        if name is None or name.text in links or name.text in self.declared.lost:
            return
        at = name.start, name.end
        advice = self.reporter.did_you_mean(
            name.text, links, f"declare it: `link {name.text} (DATA=32);`", at
        )
        self.reporter.report("UL095", *at, f"there is no link `{name.text}` with properties", advice)

    def _find_runtime_parameters(self) -> None:
        """A parameter is a run-time parameter if it reaches CTRL or COMM, here or in a constructor to which
        it is passed.
        """
        givers: dict[tuple[str, str], list[tuple[Scope, str]]] = {}
        for scope in self.all:
            for expansion in scope.expansions:
                callee = self.first.get(expansion.callee.text)
                if callee is None:
                    continue
                for taken, given in matched(callee.node.parameters, expansion.arguments):
                    part = given.parts[0]
                    if len(given.parts) == 1 and isinstance(part, Name) and part.text in scope.parameters:
                        givers.setdefault((expansion.callee.text, taken.text), []).append((scope, part.text))
        waiting = [(scope, name) for scope in self.all for name in sorted(scope.runtime)]
        while waiting:
            scope, name = waiting.pop()
            for giver, parameter in givers.get((scope.node.name.text, name), ()):
                if parameter not in giver.runtime:
                    giver.runtime.add(parameter)
                    waiting.append((giver, parameter))

    # --- names and numbers ----------------------------------------------------------------------------------

    def unknown_constructor(self, name: Name) -> None:
        """Report that there is no constructor of this name, unless part of the text is missing."""
        if not self.program.damaged and self.news("constructor", name):
            candidates = chain(ACCESS_WORDS, self.first, component_names())
            otherwise = f"declare it: `{name.text}(…) {{ … }}`"
            if name.text in WRITES or name.text in READS:
                otherwise = f"an element's name stands after `@`: `@name: {name.text}();`"
            at = (name.start, name.end)
            advice = self.reporter.did_you_mean(name.text, candidates, otherwise, at)
            self.reporter.report("UL024", *at, f"there is no constructor `{name.text}`", advice)

    def own_address(self, scope: Scope, name: Name) -> bool:
        if name.text in scope.addresses:
            scope.used_addresses.add(name.text)
            return not scope.node.broken
        known = not scope.node.broken and "UL031" not in scope.wrong_head
        if known and self.news(f"address of {scope.node.name.text}", name) and not scope.excuses("UL026"):
            otherwise = f"declare it behind the parameters, or give the address: `@{name.text} = 0x…`"
            at = (name.start, name.end)
            advice = self.reporter.did_you_mean(name.text, scope.addresses, otherwise, at)
            message = f"`{scope.node.name.text}` has no address `{name.text}`"
            self.reporter.report("UL026", *at, message, advice)
        return False

    def parameter(self, scope: Scope, name: Name) -> bool:
        if name.text in scope.parameters:
            scope.used_parameters.add(name.text)
            return True
        self._no_parameter(scope, name, "parameter", scope.parameters)
        return False

    def _no_parameter(
        self, scope: Scope, name: Name, what: str, candidates: Iterable[str], advice: Advice | None = None
    ) -> None:
        known = not scope.node.broken and "UL030" not in scope.wrong_head
        if not known or not self.news(f"parameter of {scope.node.name.text}", name) or scope.excuses("UL025"):
            return
        at = (name.start, name.end)
        if advice is None:
            otherwise = f"declare it: `{scope.node.name.text}({name.text})`, or put text into quotes"
            advice = self.reporter.did_you_mean(name.text, candidates, otherwise, at)
        message = f"`{scope.node.name.text}` has no {what} `{name.text}`"
        self.reporter.report("UL025", *at, message, advice)

    def names_of(
        self, scope: Scope, node: Expression, *, array: bool = False, advice: Advice | None = None
    ) -> bool:
        """Are all names of an expression known here: parameters, addresses, constants, an array's index?"""
        known = True
        for name in () if isinstance(node, Argument) and node.literal else names_of(node):
            text = name.text
            if text in scope.parameters:
                scope.used_parameters.add(text)
            elif text in scope.addresses:
                scope.used_addresses.add(text)
                scope.computed.setdefault(text, name)
            elif text in self.declared.constants:
                self.declared.used.add(text)
            elif not (array and text == INDEX) and text not in WORDS:
                if text not in self.declared.lost:
                    candidates = chain(scope.parameters, self.declared.constants, ("true", "false"))
                    self._no_parameter(scope, name, "parameter", candidates, advice)
                known = False
        return known

    def knows(self, scope: Scope, name: Name) -> bool:
        """Is this a parameter, an address or a constant here?"""
        return name.text in (
            *scope.parameters,
            *scope.addresses,
            *self.declared.constants,
            *self.declared.lost,
        )

    def depends(self, scope: Scope, node: Expression, *, array: bool = False) -> bool:
        """Does the value of an expression differ between expansions?"""
        if isinstance(node, Argument) and node.literal:
            return False
        return any(
            name.text in scope.parameters or name.text in scope.addresses or (array and name.text == INDEX)
            for name in names_of(node)
        )

    def word(self, number: Number, what: str) -> bool:
        if number.value <= ADDRESS_MAX:
            return True
        message = f"{what} has at most {ADDRESS_BITS_MAX} bits"
        self.reporter.report("UL050", number.start, number.end, message, f"the largest is 0x{ADDRESS_MAX:X}")
        return False

    def news(self, what: str, name: Name) -> bool:
        """Is this the first report of an unknown name?

        A missing name is one mistake, however often it is used.
        """
        if (what, name.text) in self._unknown:
            return False
        self._unknown.add((what, name.text))
        return True


def _name_of(thing: Scope | Name | UsableNode | BrokenNode) -> Name:
    if isinstance(thing, Scope):
        return thing.node.name
    return thing if isinstance(thing, Name) else thing.name
