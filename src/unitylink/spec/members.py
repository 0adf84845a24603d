# SPDX-License-Identifier: BSD-3-Clause
"""What can be told about the members of a constructor without expanding it."""

from __future__ import annotations

from itertools import islice

from ..protocol import RATE_BYTES_MAX
from .scope import Scope, Scopes, UsableNode
from .syntax import Argument, Binding, ElementNode, ExpansionNode, Name, Property

_DIVISOR_MAX = (1 << 8 * RATE_BYTES_MAX) - 1
_SHOWN = 150  # characters of a declaration in a hint
_NAMES = 20  # names of a list that are looked at for a message


def check_members(scopes: Scopes) -> None:
    """Report what is wrong with members, and take those out of `usable` that cannot be expanded."""
    checker = _Checker(scopes)
    checker.find_wrong_heads()
    for scope in scopes.all:
        for member in [*scope.usable.values()]:
            if not checker.check(scope, member):
                del scope.usable[member.name.text]


class _Checker:
    def __init__(self, scopes: Scopes) -> None:
        self.scopes = scopes
        self.reporter = scopes.reporter

    def find_wrong_heads(self) -> None:
        """Where all expansions of a constructor give the same wrong count, its head is the one mistake."""
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
            if code == "UL030":
                wrong = count != len(node.parameters)
                takes = _count(len(node.parameters), "argument")
            else:
                wrong = node.tuple_form and count not in (0, len(node.addresses))
                takes = _count(len(node.addresses), "address")
            if wrong:
                callee.wrong_head.add(code)
                if callee.excused["UL025" if code == "UL030" else "UL026"] > 0:
                    continue  # a name is declared twice in this head: that is the mistake
                message = f"`{name}` takes {takes}, but all {len(counts)} expansions give {count}"
                hint = f"make `{declaration(callee)}` agree with them"
                self.reporter.report(code, node.name.start, node.name.end, message, hint)

    def check(self, scope: Scope, member: UsableNode) -> bool:
        """Report what is wrong with a member; return whether it can be expanded."""
        if isinstance(member, ElementNode):
            return self._check_element(scope, member)
        if isinstance(member, ExpansionNode):
            return self._check_expansion(scope, member)
        return True  # a group is checked when all names are known

    def _check_element(self, scope: Scope, member: ElementNode) -> bool:
        good = (
            self.scopes.word(member.fixed, "an address")
            if member.fixed
            else self.scopes.own_address(scope, member.name)
        )
        for one in member.properties:
            if one.argument is not None:
                good = self._text(scope, one.argument, "ID") and good
            elif one.key == "PUBLISH":
                good = self._publish(member, one) and good
        return good

    def _publish(self, member: ElementNode, one: Property) -> bool:
        mode, divisor = one.numbers
        problems = [
            (
                member.access == "WRITE",
                ("UL060", one.start, one.end),
                f"`{member.name.text}` is a WRITE: only what the PC reads can be published",
                "remove PUBLISH, or make it a READ",
            ),
            (
                mode.value not in (1, 2),
                ("UL061", mode.start, mode.end),
                f"PUBLISH({mode.value},…) has no meaning: the first number is the mode, 1 or 2",
                "1 = hardware publish (the gateware sends), 2 = software publish (the PC polls); "
                "if a subscription group's number was meant: the compiler makes one for each rate: write 1",
            ),
            (
                divisor.value == 0,
                ("UL062", divisor.start, divisor.end),
                "the divisor of the base publish frequency is 0",
                "1 publishes at the base frequency (1000 Hz unless the gateware says otherwise), 10 at a "
                "tenth of it; to publish nothing remove PUBLISH",
            ),
            (
                divisor.value > _DIVISOR_MAX,
                ("UL063", divisor.start, divisor.end),
                f"the divisor is larger than {_DIVISOR_MAX:,}",
                f"the protocol sends it in at most {RATE_BYTES_MAX} bytes",
            ),
        ]
        for wrong, place, message, hint in problems:
            if wrong:
                self.reporter.report(*place, message, hint)
                return False
        return True

    def _check_expansion(self, scope: Scope, member: ExpansionNode) -> bool:
        words = [self.scopes.word(number, "an address") for b in member.bindings for number in b.numbers]
        good = all(words)
        if member.forwards:
            good = self.scopes.own_address(scope, member.name) and good
        callee = self.scopes.first.get(member.callee.text)
        if callee is None:
            self.scopes.unknown_constructor(member.callee)
            for given in member.arguments:
                self.scopes.names_of(scope, given)
            return False
        if callee.node.broken:
            for given in member.arguments:
                self.scopes.names_of(scope, given)
            return False
        taken = callee.node.parameters
        given_count = len(member.arguments)
        if len(taken) != given_count:
            if "UL030" not in callee.wrong_head:
                takes = _count(len(taken), "argument")
                message = f"`{member.callee.text}` takes {takes} but is given {given_count}"
                place = member.arguments[-1] if given_count > len(taken) else member.callee
                hint = f"it is declared as `{declaration(callee)}`"
                self.reporter.report("UL030", place.start, place.end, message, hint)
            good = False
        for given, name in zip(member.arguments, taken, strict=False):
            if name.text in callee.runtime:
                good = self._runtime_argument(scope, given, name, member.callee) and good
            else:
                good = self._text(scope, given, f"`{name.text}` of `{member.callee.text}`") and good
        for given in member.arguments[len(taken) :]:
            self.scopes.names_of(scope, given)
        return self._check_bindings(scope, member, callee) and good

    def _check_bindings(self, scope: Scope, member: ExpansionNode, callee: Scope) -> bool:
        """Do the bindings give the callee's addresses? What a forwarded vector's length tells comes later."""
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
            assert one.name is not None  # the caller looked
            text = one.name.text
            if text not in callee.addresses:
                if not self.scopes.news(f"address of {member.callee.text}", one.name):
                    return False
                hint = self.reporter.did_you_mean(text, callee.addresses, f"it is declared as `{declared}`")
                message = f"`{member.callee.text}` has no address `{text}`"
                self.reporter.report("UL026", one.name.start, one.name.end, message, hint)
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

    def _text(self, scope: Scope, argument: Argument, what: str) -> bool:
        """An argument that must be a string."""
        good = self.scopes.names_of(scope, argument)
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
    """Return the head of a constructor as it would be written."""
    node = scope.node
    parameters = ",".join(name.text for name in node.parameters[:_NAMES])
    head = f"{node.name.text}({parameters})"
    if node.addresses:
        names = [name.text for name in node.addresses[:_NAMES]]
        head += ": " + (
            f"@ ({','.join(names)})" if node.tuple_form else ", ".join(f"@{name}" for name in names)
        )
    return head if len(head) <= _SHOWN else head[:_SHOWN] + "…"


def _count(number: int, noun: str) -> str:
    """Return "1 address", "2 addresses"."""
    plural = noun + ("es" if noun.endswith("s") else "s")
    return f"{number} {noun if number == 1 else plural}"
