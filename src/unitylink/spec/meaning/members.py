# SPDX-License-Identifier: BSD-3-Clause
"""Checks of the members of a constructor, without expanding it."""

from __future__ import annotations

from itertools import islice

from ..model import Link
from ..report.diagnostics import Advice
from ..text.syntax import Argument, Binding, ElementNode, ExpansionNode, Name, Notes, Number, Parameter, Text
from ..units import spoken, unit
from .elements import ElementReader
from .generic_limits import is_clock
from .scope import Scope, Scopes, UsableNode, matched
from .type_names import names_of

_SHOWN = 150  # the most characters of a declaration in a hint
_NAMES = 20  # the most names of a list that are searched for a message


_PARAMETER_TYPES = ("string", "int", "real", "bool", "wire")


def check_members(scopes: Scopes, elements: ElementReader, link: Link) -> None:
    """Report mistakes in members, and remove from `usable` those that cannot be expanded."""
    checker = _Checker(scopes, elements, link)
    checker.find_wrong_heads()
    for scope in scopes.all:
        checker.check_head(scope)
        for member in [*scope.usable.values()]:
            if not checker.check(scope, member):
                del scope.usable[member.name.text]


class _Checker:
    def __init__(self, scopes: Scopes, elements: ElementReader, link: Link) -> None:
        self.scopes = scopes
        self.elements = elements
        self.link = link  # any link will do, because what depends on it is computed again when it is known
        self.reporter = scopes.reporter

    def check_head(self, scope: Scope) -> None:
        """Report wrong types and defaults of parameters, and wrong notes."""
        behind_default: Parameter | None = None
        for one in scope.node.parameters:
            if one.type is not None and one.type.text not in _PARAMETER_TYPES:
                at = (one.type.start, one.type.end)
                advice = self.reporter.did_you_mean(
                    one.type.text, _PARAMETER_TYPES, "there are string, int, real, bool and wire", at
                )
                self.reporter.report("UL093", *at, f"`{one.type.text}` is no type of a parameter", advice)
            if one.default is not None:
                self.scopes.names_of(scope, one.default)
                behind_default = behind_default or one
            elif behind_default is not None:
                message = f"`{one.text}` has no default, but `{behind_default.text}` before it has one"
                hint = "put the parameters with a default last"
                labels = [(behind_default.start, behind_default.end, "this one has a default")]
                self.reporter.report("UL094", one.start, one.end, message, hint, labels=labels)
        if scope.node.block is not None:
            self.scopes.names_of(scope, scope.node.block)
        self._check_notes(scope, scope.node.notes, array=False)

    def _check_notes(self, scope: Scope, notes: Notes, *, array: bool) -> bool:
        known = [
            self.scopes.names_of(scope, argument, array=array)
            for node in notes.annotations
            for argument in node.arguments
            if not (node.name.text == "limit" and is_clock(argument))
        ]
        return all(known)

    def find_wrong_heads(self) -> None:
        """If all expansions of a constructor have the same wrong count, the mistake is in its head."""
        given: dict[tuple[str, str], list[int]] = {}
        for scope in self.scopes.all:
            for member in scope.expansions:
                name = member.callee.text
                given.setdefault((name, "UL030"), []).append(len(member.arguments))
                unnamed = len(member.bindings) == 1 and member.bindings[0].name is None
                given.setdefault((name, "UL031"), []).append(
                    len(member.bindings[0].numbers) if unnamed else 0
                )
        for (name, code), counts in given.items():
            callee = self.scopes.first.get(name)
            if callee is None or callee.node.broken or len(counts) == 1 or len({*counts}) > 1:
                continue
            node, count = callee.node, counts[0]
            if node.block is not None or any(one.default for one in node.parameters):
                continue  # optional arguments may be missing
            if code == "UL030":
                wrong = count != len(node.parameters)
                takes = _count(len(node.parameters), "argument")
            else:
                wrong = node.tuple_form and count not in (0, len(node.addresses))
                takes = _count(len(node.addresses), "address")
            if wrong:
                callee.wrong_head.add(code)
                if callee.excused["UL025" if code == "UL030" else "UL026"] > 0:
                    continue  # the mistake is that this head declares a name twice
                message = f"`{name}` takes {takes}, but all {len(counts)} expansions give {count}"
                hint = f"make `{declaration(callee)}` agree with them"
                self.reporter.report(code, node.name.start, node.name.end, message, hint)

    def check(self, scope: Scope, member: UsableNode) -> bool:
        """Report the mistakes of a member. Return whether it can be expanded."""
        if isinstance(member, ElementNode):
            return self._check_element(scope, member)
        if isinstance(member, ExpansionNode):
            return self._check_expansion(scope, member)
        return True  # a group is checked when all names are known

    def _check_element(self, scope: Scope, member: ElementNode) -> bool:
        array = member.count is not None
        if member.fixed is None:
            good = self.scopes.own_address(scope, member.name)
        elif isinstance(member.fixed, Number):
            good = self.scopes.word(member.fixed, "an address")
        else:
            good = self.scopes.names_of(scope, member.fixed, array=array)
        if not (member.count or member.type or member.properties or member.notes.annotations):
            return good
        depends, known = False, True
        given = [member.count] if member.count else []
        if member.type is not None:
            given += member.type.arguments
            self.scopes.declared.used.add(member.type.name.text)
        for one in member.properties:
            if one.key == "ID" and one.argument is not None:
                good = self._text(scope, one.argument, "ID", array=array) and good
            elif one.publish is not None:
                given += one.publish.arguments
            elif one.key in ("INITIAL", "SAFE") and one.name and self._is_value(member, one.name):
                continue
            elif one.key == "UNIT" and one.argument is not None:
                known = self._unit(scope, one.argument) and known
                depends = depends or self.scopes.depends(scope, one.argument)
            elif one.argument is not None and one.key != "OVERFLOW":
                given.append(one.argument)
        for argument in given:
            known = self.scopes.names_of(scope, argument, array=array) and known
            depends = depends or self.scopes.depends(scope, argument, array=array)
        good = self._check_notes(scope, member.notes, array=array) and good
        if known and not depends:
            known = self.elements.read(member, {}, self.link) is not None
        return good and known

    def _is_value(self, member: ElementNode, name: Name) -> bool:
        """Is this meant as a value of the element's enumeration?"""
        if member.type is None or member.type.name.text not in self.scopes.declared.enums:
            return False
        return name.text not in self.scopes.declared.constants

    def _unit(self, scope: Scope, argument: Argument) -> bool:
        """Are all names of UNIT known?

        A unit without its quotes is one mistake, however many names it has.
        """
        names = [] if argument.literal else list(names_of(argument))
        if not names or any(self.scopes.knows(scope, name) for name in names):
            return self.scopes.names_of(scope, argument)
        text = self.scopes.reporter.sources.text(argument.start, argument.end)
        written = text if unit(text) is not None else spoken(text)
        if written is None and len(names) > 1:
            return self.scopes.names_of(scope, argument)
        place = argument.start, argument.end
        advice = Advice(
            f'a unit stands in quotes: `"{written or text}"`', ((*place, f'"{written or text}"'),)
        )
        whole = Name(text, *place)
        return self.scopes.names_of(scope, Argument([whole], *place), advice=advice)

    def _check_expansion(self, scope: Scope, member: ExpansionNode) -> bool:
        array = member.count is not None
        good = True
        for binding in member.bindings:
            for number in binding.numbers:
                if isinstance(number, Number):
                    good = self.scopes.word(number, "an address") and good
                else:
                    good = self.scopes.names_of(scope, number, array=array) and good
        if member.count is not None:
            good = self.scopes.names_of(scope, member.count) and good
        if member.notes.annotations:
            good = self._check_notes(scope, member.notes, array=array) and good
        if member.forwards:
            good = self.scopes.own_address(scope, member.name) and good
        callee = self.scopes.first.get(member.callee.text)
        if callee is None:
            self.scopes.unknown_constructor(member.callee)
        if callee is None or callee.node.broken:
            for given in member.arguments:
                self.scopes.names_of(scope, given, array=array)
            return False
        taken = callee.node.parameters
        good = self._check_count(member, callee) and good
        for name, given in matched(taken, member.arguments):
            if name.text in callee.runtime:
                good = self._runtime_argument(scope, given, name, member.callee) and good
            elif name.type is None or name.type.text == "string":
                what = f"`{name.text}` of `{member.callee.text}`"
                good = self._text(scope, given, what, array=array) and good
            else:
                good = self.scopes.names_of(scope, given, array=array) and good
        for given in member.arguments[len(taken) :]:
            self.scopes.names_of(scope, given, array=array)
        return self._check_bindings(scope, member, callee) and good

    def _check_count(self, member: ExpansionNode, callee: Scope) -> bool:
        """Is everything given that a constructor takes, each once, and nothing else?"""
        taken = callee.node.parameters
        hint = f"it is declared as `{declaration(callee)}`"
        if not any(one.key for one in member.arguments):
            least = sum(1 for one in taken if one.default is None)
            count = len(member.arguments)
            if least <= count <= len(taken):
                return True
            if "UL030" not in callee.wrong_head:
                takes = (
                    _count(len(taken), "argument")
                    if least == len(taken)
                    else f"{least} to {len(taken)} arguments"
                )
                message = f"`{member.callee.text}` takes {takes} but is given {count}"
                place = member.arguments[-1] if count > len(taken) else member.callee
                self.reporter.report("UL030", place.start, place.end, message, hint)
            return False
        good = True
        given: set[str] = set()
        for position, one in enumerate(member.arguments):
            place = one.key or one
            if one.key is None:
                text = taken[position].text if position < len(taken) else ""
            else:
                text = one.key.text
            if text not in callee.parameters:
                advice = self.reporter.did_you_mean(text, callee.parameters, hint, (place.start, place.end))
                message = (
                    f"`{member.callee.text}` has no parameter `{text}`" if text else "one argument too many"
                )
                self.reporter.report("UL094", place.start, place.end, message, advice)
                good = False
            elif text in given or (one.key is None and given and member.arguments[position - 1].key):
                message = (
                    f"`{text}` is given twice"
                    if text in given
                    else "an argument without a name after one with a name"
                )
                self.reporter.report("UL094", place.start, place.end, message, hint)
                good = False
            given.add(text)
        missing = [one.text for one in taken if one.default is None and one.text not in given]
        if missing and good:
            message = f"`{member.callee.text}` is given no " + ", ".join(f"`{text}`" for text in missing[:5])
            self.reporter.report("UL030", member.callee.start, member.callee.end, message, hint)
        return good and not missing

    def _check_bindings(self, scope: Scope, member: ExpansionNode, callee: Scope) -> bool:
        """Do the bindings give the callee's addresses?

        What depends on the length of a forwarded vector is checked later.
        """
        names = callee.node.addresses
        declared = declaration(callee)
        bindings = member.bindings
        place: Name | Binding = bindings[0] if bindings else member.name
        code = "UL031"
        message = ""
        hint = f"it is declared as `{declared}`"
        if not names:
            if bindings or member.forwards:
                message = f"`{member.callee.text}` takes no addresses"
        elif member.forwards:
            if not callee.node.tuple_form and len(names) > 1:
                code = "UL032"
                message = (
                    f"one vector cannot be forwarded to the {len(names)} vectors of `{member.callee.text}`"
                )
            elif scope.node.tuple_form and callee.node.tuple_form and len(names) > 1:
                message = f"`{member.name.text}` is 1 address but `{member.callee.text}` takes {len(names)}"
        elif callee.node.block is not None and (not bindings or _one_number(bindings, names[0].text)):
            return True  # if nothing is bound, the compiler finds room
        elif _is_component(callee) and bindings and all(_is_word(one, callee) for one in bindings):
            return self._check_words(member, callee)
        elif not bindings:
            place = member.callee
            message = f"`{member.callee.text}` takes {_count(len(names), 'address')} but none is bound"
            example = ",".join(f"0x{i:X}" for i in range(min(len(names), 8)))
            hint += f"; bind them like `@ ({example})`" if callee.node.tuple_form else ""
        elif any(b.name for b in bindings) != all(b.name for b in bindings):
            code, message = "UL032", "bindings with and without a name cannot be mixed"
        elif bindings[0].name:
            return self._check_named_bindings(member, callee, declared)
        elif callee.node.tuple_form and len(bindings) > 1:
            place = bindings[1]
            code, message = (
                "UL032",
                f"`{member.callee.text}` takes one list of {_count(len(names), 'address')}",
            )
        elif callee.node.tuple_form and len(bindings[0].numbers) != len(names):
            if "UL031" in callee.wrong_head:
                return False
            count = len(bindings[0].numbers)
            message = f"`{member.callee.text}` takes {_count(len(names), 'address')} but is given {count}"
        elif not callee.node.tuple_form and len(bindings) != len(names):
            message = (
                f"`{member.callee.text}` takes {len(names)} address vectors but is given {len(bindings)}"
            )
        if message:
            self.reporter.report(code, place.start, place.end, message, hint)
        return not message

    def _check_named_bindings(self, member: ExpansionNode, callee: Scope, declared: str) -> bool:
        bound: set[str] = set()
        good = True
        for one in member.bindings:
            assert one.name is not None  # the caller has checked it
            text = one.name.text
            if text not in callee.addresses:
                if not self.scopes.news(f"address of {member.callee.text}", one.name):
                    return False
                at = (one.name.start, one.name.end)
                advice = self.reporter.did_you_mean(
                    text, callee.addresses, f"it is declared as `{declared}`", at
                )
                message = f"`{member.callee.text}` has no address `{text}`"
                self.reporter.report("UL026", *at, message, advice)
                return False
            if text in bound:
                message = f"address `{text}` is bound twice"
                self.reporter.report("UL033", one.start, one.end, message, "remove one of the two")
                good = False
            elif callee.node.tuple_form and len(one.numbers) != 1:
                message = f"`{text}` is 1 address but is given {len(one.numbers)}"
                self.reporter.report("UL031", one.start, one.end, message, f"it is declared as `{declared}`")
                good = False
            bound.add(text)
        unbound = (name.text for name in callee.node.addresses if name.text not in bound)
        missing = list(islice(unbound, 5))
        if missing and good:
            message = f"`{member.callee.text}` is given no " + ", ".join(f"`{name}`" for name in missing)
            self.reporter.report(
                "UL031", member.callee.start, member.callee.end, message, f"it is declared as `{declared}`"
            )
        return good and not missing

    def _check_words(self, member: ExpansionNode, callee: Scope) -> bool:
        """Do the bindings name elements of a component, each once? This is for a node of a ring."""
        elements = [one.name.text for one in callee.node.members if isinstance(one, ElementNode)]
        bound: set[str] = set()
        good = True
        for one in member.bindings:
            assert one.name is not None  # the caller has checked it
            text, at = one.name.text, (one.name.start, one.name.end)
            if text not in elements:
                otherwise = "there are " + ", ".join(elements[:_NAMES])
                advice = self.reporter.did_you_mean(text, elements, otherwise, at)
                message = f"`{member.callee.text}` has no word `{text}`"
                self.reporter.report("UL026", *at, message, advice)
                good = False
            elif text in bound:
                message = f"`{text}` is bound twice"
                self.reporter.report("UL033", one.start, one.end, message, "remove one of the two")
                good = False
            bound.add(text)
        return good

    def _text(self, scope: Scope, argument: Argument, what: str, *, array: bool = False) -> bool:
        """Check an argument that must be a string."""
        if len(argument.parts) == 1 and isinstance(argument.parts[0], Text):
            return True
        good = self.scopes.names_of(scope, argument, array=array)
        for part in argument.parts:
            if isinstance(part, Name) and part.text in scope.runtime:
                message = f"{what} is a string, but `{part.text}` is a run-time parameter"
                hint = "a parameter that reaches CTRL or COMM is a controller or connection given at run time"
                self.reporter.report("UL037", part.start, part.end, message, hint)
                good = False
        return good

    def _runtime_argument(self, scope: Scope, argument: Argument, taken: Name, callee: Name) -> bool:
        if len(argument.parts) == 1 and isinstance(argument.parts[0], Name):
            return self.scopes.parameter(scope, argument.parts[0])
        self.scopes.names_of(scope, argument)
        message = f"`{taken.text}` of `{callee.text}` is a run-time parameter, but is given a string"
        hint = "it reaches CTRL or COMM: hand a parameter of the public constructor down to it"
        self.reporter.report("UL037", argument.start, argument.end, message, hint)
        return False


def declaration(scope: Scope) -> str:
    """Return the head of a constructor in the form of the language."""
    node = scope.node
    parameters = ",".join(_parameter(one) for one in node.parameters[:_NAMES])
    head = f"{node.name.text}({parameters})"
    if node.block is not None and node.addresses:
        head += f": @{node.addresses[0].text}[…]"
    elif node.addresses:
        names = [name.text for name in node.addresses[:_NAMES]]
        head += ": " + (
            f"@ ({','.join(names)})" if node.tuple_form else ", ".join(f"@{name}" for name in names)
        )
    return head if len(head) <= _SHOWN else head[:_SHOWN] + "…"


def _parameter(one: Parameter) -> str:
    return one.text + (f": {one.type.text}" if one.type else "") + (" = …" if one.default else "")


def _one_number(bindings: list[Binding], address: str) -> bool:
    """Is this the only address, to which a block is bound?"""
    (first, *others) = bindings
    return not others and len(first.numbers) == 1 and (first.name is None or first.name.text == address)


def _is_component(callee: Scope) -> bool:
    head = callee.node
    return head.block is not None and any(one.name.text == "component" for one in head.notes.annotations)


def _is_word(one: Binding, callee: Scope) -> bool:
    """Does this bind an element of a component, and not its block?"""
    return one.name is not None and one.name.text not in callee.addresses


def _count(number: int, noun: str) -> str:
    """Return "1 address", "2 addresses"."""
    plural = noun + ("es" if noun.endswith("s") else "s")
    return f"{number} {noun if number == 1 else plural}"
