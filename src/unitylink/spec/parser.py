# SPDX-License-Identifier: BSD-3-Clause
"""Tokens to syntax tree: recursive descent that goes on after a mistake, so that one run finds all of them.

Recovery: what cannot be read is skipped up to the next `;`, `}`, constructor head, or line that starts like
a member; a `;` or `}` behind which the member goes on is the mistake itself. A member with a mistake stays in
the tree as a `BrokenNode`. The language nests to a fixed depth, so no text can exhaust the stack.
"""

from __future__ import annotations

from .cursor import Cursor, Panic
from .diagnostics import Reporter
from .lexer import Tokens, tokenize, unescape
from .syntax import (
    Argument,
    Binding,
    BrokenNode,
    ConstructorNode,
    ElementNode,
    ExpansionNode,
    GroupNode,
    MemberNode,
    Name,
    Number,
    Program,
    Property,
    Step,
    Text,
    TosNetNode,
)

MAX_CONSTRUCTORS = 10_000
_LINK_PROPERTIES = ("CTRL", "COMM", "UART", "BASE")
_ELEMENT_PROPERTIES = ("ID", "CRC", "PUBLISH")


def parse(reporter: Reporter) -> tuple[Program, Tokens]:
    """Return the syntax tree and the tokens of the reporter's source; report every mistake of form."""
    tokens = tokenize(reporter)
    return _Parser(reporter, tokens).program(), tokens


class _Parser(Cursor):
    # --- the program and its constructors -------------------------------------------------------------------

    def program(self) -> Program:
        program = Program(damaged=self.tokens.truncated)
        headers = 0
        while (kind := self.kinds[self.i]) != "end" and not self.reporter.full:
            if kind == "keyword" and self.texts[self.i] == "link":
                headers += 1
                self._header(program, headers)
            elif len(program.constructors) >= MAX_CONSTRUCTORS:
                message = f"more than {MAX_CONSTRUCTORS:,} constructors"
                self.report("UL003", self.i, message, "divide the spec into several")
                program.damaged = True
                break
            elif self.at_head(keyword=True) or kind == "name":
                self._constructor(program)
            elif kind == "}":
                self.report("UL013", self.i, "this brace closes nothing", "remove it")
                self.i += 1
            else:
                start = self.first = self.i
                hint = "a `;` stands after members only: remove it" if kind == ";" else ""
                self.unexpected("a constructor, `name(…) {…}`", hint, begins=True)
                self.skip_to_head()
                # A head so wrong that it was not seen takes its name along; do not report the name's uses.
                program.damaged = program.damaged or self.i > start + 1
                if program.constructors:  # a brace too early takes members along
                    program.constructors[-1].incomplete = True
        return program

    def _header(self, program: Program, count: int) -> None:
        start = self.first = self.i
        self.i += 1
        try:
            names = [self.name("the spec's name")]
            while self.accept("."):
                names.append(self.name("a name"))
            self.semicolon()
        except Panic:
            self.skip_member()
            return
        if count > 1:
            self.report("UL017", start, "there is a `link` header already", "remove one of the two")
        elif program.constructors:
            hint = "move it before the first constructor"
            self.report("UL018", start, "the `link` header stands after a constructor", hint)
        program.package = ".".join(name.text for name in names[:-1])
        program.name = names[-1].text

    def _constructor(self, program: Program, outer: str = "") -> None:
        """Read one constructor; `outer` is the one whose body it stands in by mistake."""
        self.first = self.i
        public = self.kinds[self.i] == "keyword" and self.texts[self.i] == "public"
        self.i += public
        node = ConstructorNode(public, Name("", self.tokens.starts[self.i], self.tokens.ends[self.i]))
        program.constructors.append(node)
        brace: int | None = None
        try:
            node.name = self.name("the constructor's name")
            if self.kinds[self.i] == "name" and not public:
                hint = self.reporter.did_you_mean(node.name.text, ("public", "link"))
                raise self.unexpected("`(` and the parameters", hint)
            self.expect("(", "`(` and the parameters")
            node.parameters = self.names("a parameter")
            if self.accept(":"):
                self._addresses(node)
            elif self.kinds[self.i] == "@" and not self.at_member():
                self.unexpected("`:` before the addresses")
                self._addresses(node)
            if self.kinds[self.i] == "{":
                brace = self.i
                self.i += 1
            else:
                self.unexpected("`{`")
                if not (self.kinds[self.i] == "}" or self.at_member()):
                    raise Panic
        except Panic:
            node.broken = True
            if not self.skip_to_body():
                return
        node.broken = node.broken or self.touched()
        self._body(program, node, brace, bool(outer))

    def _addresses(self, node: ConstructorNode) -> None:
        self.expect("@", "`@` and the addresses")
        if self.accept("("):
            node.tuple_form = True
            node.addresses = self.names("an address name")
            return
        node.addresses.append(self.name("an address name"))
        while self.accept(","):
            self.expect("@", "`@`")
            node.addresses.append(self.name("an address name"))

    def _body(self, program: Program, node: ConstructorNode, brace: int | None, nested: bool) -> None:
        while not self.reporter.full:
            if self.kinds[self.i] == "}":
                if nested or not self.at_member(self.i + 1):
                    break
                self._closed_early(program, node)
            at_end = self.kinds[self.i] == "end"
            if not nested and self.at_nested():
                hint = f"put it behind the closing brace of `{node.name.text}`"
                self.unexpected("a member", hint, begins=True)
                self._constructor(program, node.name.text)
                continue
            if at_end or (self.at_head() and not self.at_public_member()):
                swallowed = at_end and self._swallowed_brace()
                self.first = self.i
                if brace is not None and not (swallowed or self.faulty()):
                    where = "at the end of the file"
                    if not at_end:
                        line = self.reporter.source.line_of(self.tokens.starts[self.i])
                        where = f"before the next constructor in line {line}"
                    message = f"the brace of `{node.name.text}` is never closed"
                    self.report("UL012", brace, message, f"add `}}` {where}")
                return
            before = self.i
            member = self._member()
            if member is not None:
                node.members.append(member)
            elif self.texts[before] not in (";", "TOSNET"):
                node.incomplete = True
            self.i += self.i == before  # nothing can be made of this token
        self.i += 1

    def _swallowed_brace(self) -> bool:
        """Is the closing brace within a string that was not closed?"""
        text = self.texts[self.i - 1]
        return self.kinds[self.i - 1] == "string" and "}" in text and self.touched()

    def _closed_early(self, program: Program, node: ConstructorNode) -> None:
        """A member follows this brace: go on with the body. What is missing may also be a head."""
        self.first = self.i
        if not self.faulty():
            what = self.texts[self.i + 1 + (self.kinds[self.i + 1] == "@")]
            message = f"this brace closes `{node.name.text}`, but the member `{what}` follows"
            self.report("UL013", self.i, message, "remove it, or give what follows the head of a constructor")
        self.i += 1
        node.broken = program.damaged = True

    # --- members --------------------------------------------------------------------------------------------

    def _member(self) -> MemberNode | None:
        self.broken = False
        start = self.first = self.i
        member: MemberNode | None = None
        try:
            member = self._member_by_form()
            self.semicolon()
        except Panic:
            self.broken = True
            self.skip_member()
        if not (self.broken or self.touched()):
            return member
        name = self._name_of(start)
        return BrokenNode(name) if name else None

    def _name_of(self, start: int) -> Name | None:
        """Return the name of the broken member that starts at token `start`, if it got as far as a name."""
        start += self.kinds[start] == "@"
        if self.kinds[start] != "name" or start >= self.i:
            return None
        return Name(self.texts[start], self.tokens.starts[start], self.tokens.ends[start])

    def _member_by_form(self) -> MemberNode:
        kind = self.kinds[self.i]
        following = self.kinds[self.i + 1] if kind != "end" else "end"
        if kind == "@":
            self.i += 1
            return self._addressed()
        if kind == "keyword" and self.texts[self.i] == "TOSNET" and following not in (":", "="):
            return self._tosnet()
        if kind == "name" or (kind == "keyword" and following in (":", "=")):
            name = self.name("a member")
            if self.kinds[self.i] == "(":
                hint = self.reporter.did_you_mean(name.text, ("TOSNET",))
                raise self.unexpected("`:` and a constructor, or `=` and the members of a group", hint)
            if self.accept("="):
                return self._group(name)
            self.expect(":", "`:` and a constructor, or `=` and the members of a group")
            if self.kinds[self.i] == "keyword" and self.texts[self.i] in ("READ", "WRITE", "signed"):
                shown = f"`@{name.text}: {self.texts[self.i]}`"
                if not self.faulty():
                    self.report("UL010", self.i, "an element's name stands after `@`", f"write {shown}")
                raise Panic
            return self._expansion(name, False)
        hint = "remove it" if kind == ";" else ""
        if kind == "keyword" and self.texts[self.i] == "public":
            hint = "constructors are public, not their members: remove it"
        raise self.unexpected("a member, such as `@name: READ();`", hint, begins=True)

    def _addressed(self) -> ElementNode | ExpansionNode:
        name = self.name("the address name")
        fixed = self.address() if self.accept("=") else None
        self.expect(":", "`:`" if fixed else "`:`, or `=` and an address,")
        if self.kinds[self.i] == "keyword" and self.texts[self.i] in ("READ", "WRITE", "signed"):
            return self._element(name, fixed)
        if fixed is not None:
            hint = f"to bind it to an expansion write `{name.text}: constructor(…) @ (0x{fixed.value:X})`"
            hint = self.reporter.did_you_mean(self.texts[self.i], ("READ", "WRITE", "signed"), hint)
            raise self.unexpected("READ or WRITE after an address", hint)
        return self._expansion(name, True)

    def _tosnet(self) -> TosNetNode:
        start = self.tokens.starts[self.i]
        end = self.tokens.ends[self.i]
        self.i += 1
        return TosNetNode(self._properties(_LINK_PROPERTIES), start, end)

    def _element(self, name: Name, fixed: Number | None) -> ElementNode:
        signed = self.texts[self.i] == "signed"
        self.i += signed
        access = self.texts[self.i]
        if self.kinds[self.i] != "keyword" or access not in ("READ", "WRITE"):
            raise self.unexpected("READ or WRITE")
        self.i += 1
        if self.kinds[self.i] == "keyword" and self.texts[self.i] == "signed":
            raise self.unexpected("`(`", f"write `signed {access}`")
        node = ElementNode(name, fixed, signed, access, self._properties(_ELEMENT_PROPERTIES))
        if self.kinds[self.i] == "@" and self.kinds[self.i + 1] == "(":
            raise self.unexpected(
                "`;`", f"an element's address stands behind its name: `@{name.text} = 0x…: …`"
            )
        return node

    def _expansion(self, name: Name, forwards: bool) -> ExpansionNode:
        callee = self.name("a constructor")
        if self.kinds[self.i] == "keyword":
            hint = "words are unsigned without `signed`: remove it"
            if callee.text != "unsigned":
                hint = self.reporter.did_you_mean(callee.text, ("signed",), f"remove `{callee.text}`")
            raise self.unexpected(f"`(` and the arguments of `{callee.text}`", hint)
        self.expect("(", f"`(` and the arguments of `{callee.text}`")
        arguments: list[Argument] = []
        if not self.accept(")"):
            arguments.append(self._argument(callee))
            while not self.accept(")"):
                self.expect(",", "`,` or `)`")
                arguments.append(self._argument(callee))
        bindings: list[Binding] = []
        if self.kinds[self.i] == ";" and self.at_binding(self.i + 1):
            self.unexpected("the addresses", "remove this `;`")
            self.broken = True
            self.i += 1
        if self.kinds[self.i] == "@" and not (forwards or (self.on_new_line() and self.at_member())):
            bindings.append(self._binding())
            while self.accept(","):
                bindings.append(self._binding())
        elif self.kinds[self.i] == "@" and not (self.on_new_line() and self.at_member()):
            hint = f"`@{name.text}` forwards addresses already; to bind others write `{name.text}: …`"
            raise self.unexpected("`;`", hint)
        return ExpansionNode(name, callee, arguments, bindings, forwards)

    def _binding(self) -> Binding:
        start = self.tokens.starts[self.i]
        self.expect("@", "`@` and addresses")
        name: Name | None = None
        if self.kinds[self.i] in ("name", "keyword"):
            name = self.name("an address name")
            self.expect("=", "`=` and addresses")
        if name and self.kinds[self.i] == "number":
            numbers = [self.address()]
        else:
            self.expect("(", "`(` and addresses")
            numbers = [self.address()]
            while not self.accept(")"):
                self.expect(",", "`,` or `)`")
                numbers.append(self.address())
        return Binding(name, numbers, start, self.tokens.ends[self.i - 1])

    def _group(self, name: Name) -> GroupNode:
        paths = [self._path()]
        while self.accept(","):
            paths.append(self._path())
        if self.kinds[self.i] == "(":
            last = paths[-1][-1].name.text
            hint = f"an expansion is written `{name.text}: {last}(…)`"
            raise self.unexpected("`;`", self.reporter.did_you_mean(last, ("ALL",), hint))
        return GroupNode(name, paths)

    def _path(self) -> list[Step]:
        if self.kinds[self.i] == "number":
            hint = f"an element with its address is written `@name = {self.texts[self.i][:20]}: …`"
            raise self.unexpected("a member of the group", hint)
        steps = [self._step()]
        while self.accept("."):
            steps.append(self._step())
        return steps

    def _step(self) -> Step:
        if self.kinds[self.i] == "keyword" and self.texts[self.i] == "ALL":
            self.i += 1
            self.expect("(", "`(` and a constructor")
            name = self.name("a constructor")
            self.expect(")", "`)`")
            return Step(name, True)
        return Step(self.name("a member of the group"), False)

    # --- properties and arguments ---------------------------------------------------------------------------

    def _properties(self, known: tuple[str, ...]) -> list[Property]:
        self.expect("(", "`(`")
        found: list[Property] = []
        if self.accept(")"):
            return found
        while True:
            start = self.i
            one = self._property(known)
            if one is not None:
                if any(other.key == one.key for other in found):
                    self.report("UL016", start, f"{one.key} is given twice", "remove one of the two")
                else:
                    found.append(one)
            if self.accept(")"):
                return found
            self.expect(",", "`,` or `)`")

    def _property(self, known: tuple[str, ...]) -> Property | None:
        key = self.texts[self.i]
        if self.kinds[self.i] not in ("name", "keyword"):
            raise self.unexpected("a property: " + ", ".join(known))
        one = Property("COMM" if key == "UART" else key, self.tokens.starts[self.i], self.tokens.ends[self.i])
        if key not in known:
            hint = self.reporter.did_you_mean(key, known, "there are " + ", ".join(known))
            self.report("UL015", self.i, f"there is no property `{key}` here", hint)
            self._skip_property()
            return None
        self.i += 1
        if key == "PUBLISH":
            self.expect("(", "`(mode, divisor)` after PUBLISH")
            one.numbers.append(self.number("the mode: 1 hardware, 2 software"))
            self.expect(",", "`,` and the divisor of the base publish frequency")
            one.numbers.append(self.number("the divisor of the base publish frequency"))
            self.expect(")", "`)`")
        elif key != "CRC":
            self.expect("=", f"`=` after {key}")
            if key == "ID":
                one.argument = self._argument(None)
            elif key == "BASE":
                one.numbers.append(self.number("a number"))
            else:
                one.name = self.name("a parameter of the constructor")
        return one

    def _skip_property(self) -> None:
        depth = 0
        while (kind := self.kinds[self.i]) not in ("end", ";", "{", "}"):
            if depth == 0 and kind in (",", ")"):
                return
            depth += (kind == "(") - (kind == ")")
            self.i += 1

    def _argument(self, callee: Name | None) -> Argument:
        parts: list[Text | Name] = [self._term(callee)]
        while self.accept("+"):
            parts.append(self._term(callee))
        return Argument(parts, parts[0].start, parts[-1].end)

    def _term(self, callee: Name | None) -> Text | Name:
        kind = self.kinds[self.i]
        if kind == "string":
            self.i += 1
            return Text(
                unescape(self.texts[self.i - 1]), self.tokens.starts[self.i - 1], self.tokens.ends[self.i - 1]
            )
        if kind == "name" or (kind == "keyword" and self.kinds[self.i + 1] != "="):
            return self.name("a parameter")
        hint = ""
        if kind == "number":
            hint = f'arguments are strings and parameters: write "{self.texts[self.i]}"'
        elif callee and callee.text.upper() in ("READ", "WRITE"):
            hint = f"keywords are written in capitals: `{callee.text.upper()}`"
        raise self.unexpected("a string or a parameter", hint)
