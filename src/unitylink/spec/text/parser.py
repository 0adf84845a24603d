# SPDX-License-Identifier: BSD-3-Clause
"""From tokens to a syntax tree. Recursive descent goes on after a mistake, so that one run finds all of them.

Recovery: text that cannot be read is skipped up to the next `;`, `}`, constructor head, or line that starts
like a member. If the member continues after a `;` or `}`, this mark is itself the mistake. A member with a
mistake stays in the tree as a `BrokenNode`. The language nests only to a fixed depth, so no text can exhaust
the stack.
"""

from __future__ import annotations

from ..report.diagnostics import Advice, Reporter
from ..source import Source
from .cursor import Panic
from .declarations import DeclarationReader
from .lexer import Tokens, tokenize
from .syntax import ConstructorNode, Name, Notes, Parameter, Program

MAX_CONSTRUCTORS = 10_000


def parse(reporter: Reporter, source: Source | None = None) -> tuple[Program, Tokens]:
    """Return the syntax tree and the tokens of `source`. Without it, the reporter's first source is taken.

    Every mistake of form is reported.
    """
    source = source or reporter.sources.first
    tokens = tokenize(reporter, source)
    return _Parser(source, reporter, tokens).program(), tokens


class _Parser(DeclarationReader):
    header: int | None = None  # the token of the first `link`

    # --- the program and its constructors -------------------------------------------------------------------

    def program(self) -> Program:
        program = Program(damaged=self.tokens.truncated)
        self.constructors = self._declared()
        while self.kinds[self.i] != "end" and not self.reporter.full:
            notes = self._notes()
            kind = self.kinds[self.i]
            if kind == "keyword" and self.texts[self.i] == "link":
                self._header(program, notes)
            elif self.at_declaration():
                self.declaration(program, notes)
            elif len(program.constructors) >= MAX_CONSTRUCTORS:
                message = f"more than {MAX_CONSTRUCTORS:,} constructors"
                self.report("UL003", self.i, message, "divide the spec into several")
                program.damaged = True
                break
            elif self.at_head(keyword=True) or kind == "name":
                self._constructor(program, notes)
            elif kind == "}":
                advice = self.replace("remove it", *self.place(self.i), "")
                self.report("UL013", self.i, "this brace closes nothing", advice)
                self.i += 1
            else:
                start = self.first = self.i
                hint = "a `;` stands after members only: remove it" if kind == ";" else ""
                advice = self.replace(hint, *self.place(self.i), "") if hint else Advice("")
                self.unexpected("a constructor, `name(…) {…}`", advice, begins=True)
                self.skip_to_head()
                # A head may be so wrong that it was not recognised, and then its name is missing. Do not
                # report the uses of this name.
                program.damaged = program.damaged or self.i > start + 1
                if program.constructors:  # after a brace that comes too early, members are missing
                    program.constructors[-1].incomplete = True
        return program

    def _declared(self) -> frozenset[str]:
        """Return the names of this file's constructors, as far as they can be found before it is read."""
        kinds, texts = self.kinds, self.texts
        return frozenset(
            texts[i - 1]
            for i, kind in enumerate(kinds)
            if kind == "("
            and kinds[i - 1] == "name"
            and (i < 2 or kinds[i - 2] in ("}", ";", ")") or texts[i - 2] == "public")
        )

    def _notes(self) -> Notes:
        """Read annotations and documentation before something that stands outside of constructors."""
        self.first = self.i
        try:
            return self.notes()
        except Panic:
            self.skip_to_head()
            return Notes()

    def _header(self, program: Program, notes: Notes) -> None:
        """Read `link package.name;`, or a link with its properties.

        The first one of either form names the spec.
        """
        start = self.first = self.i
        self.i += 1
        self.broken = False
        links = len(program.declarations)
        try:
            names = [self.name("the spec's name")]
            while self.accept("."):
                names.append(self.name("a name"))
            plain = self.kinds[self.i] != "("
            if not plain:
                self.link(program, names[-1], notes)
            self.semicolon()
        except Panic:
            del program.declarations[links:]
            self.skip_member()
            return
        self.trailing(program.declarations[-1] if not plain else None)
        if self.header is not None and plain:
            labels = [(*self.place(self.header), "the first one")]
            message = "there is a `link` header already"
            self.reporter.report("UL017", *self.place(start), message, "remove one of the two", labels=labels)
        elif program.constructors:
            hint = "move it before the first constructor"
            self.report("UL018", start, "the `link` header stands after a constructor", hint)
        if self.header is None:
            self.header = start
            program.package = ".".join(name.text for name in names[:-1])
            program.name = names[-1].text

    def _constructor(self, program: Program, notes: Notes, outer: str = "") -> None:
        """Read one constructor. `outer` is the constructor in whose body it stands by mistake."""
        self.first = self.i
        public = self.kinds[self.i] == "keyword" and self.texts[self.i] == "public"
        self.i += public
        node = ConstructorNode(public, Name("", *self.place(self.i)), notes=notes)
        program.constructors.append(node)
        brace: int | None = None
        try:
            node.name = self.name("the constructor's name")
            if self.kinds[self.i] == "name" and not public:
                words = ("public", "link", "const", "enum", "bits", "import")
                at = (node.name.start, node.name.end)
                advice = self.reporter.did_you_mean(node.name.text, words, "", at)
                raise self.unexpected("`(` and the parameters", advice)
            self.expect("(", "`(` and the parameters")
            self._parameters(node)
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
        if self.accept("["):
            node.block = self.argument("how many words it takes")
            self.expect("]", "`]`")
            return
        while self.accept(","):
            self.expect("@", "`@`")
            node.addresses.append(self.name("an address name"))

    def _parameters(self, node: ConstructorNode) -> None:
        """Read parameters, and the `)` after them."""
        if self.accept(")"):
            return
        while True:
            name = self.name("a parameter")
            one = Parameter(name.text, name.start, name.end)
            if self.kinds[self.i] == ":":
                self.i += 1
                one.type = self.name("string, int, real, bool or wire")
            if self.accept("="):
                one.default = self.argument("a value")
            node.parameters.append(one)
            if self.accept(")"):
                return
            self.expect(",", "`,` or `)`")

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
                before = self.i
                self._constructor(program, self._notes(), node.name.text)
                self.i += self.i == before
                continue
            if at_end or (self.at_head() and not self.at_public_member()):
                swallowed = (at_end and self._swallowed_brace()) or self.kinds[self.i - 1] == "]"
                self.first = self.i
                if brace is not None and not (swallowed or self.faulty()):
                    where = "at the end of the file"
                    if not at_end:
                        line = self.source.line_of(self.tokens.starts[self.i])
                        where = f"before the next constructor in line {line}"
                    message = f"the brace of `{node.name.text}` is never closed"
                    self.report("UL012", brace, message, f"add `}}` {where}")
                return
            before = self.i
            member = self.member()
            if member is not None:
                node.members.append(member)
            elif self.texts[before] not in (";", "TOSNET"):
                node.incomplete = True
            self.i += self.i == before  # this token cannot begin anything
        self.i += 1

    def _swallowed_brace(self) -> bool:
        """Is the closing brace within a string that was not closed?"""
        text = self.texts[self.i - 1]
        return self.kinds[self.i - 1] == "string" and "}" in text and self.touched()

    def _closed_early(self, program: Program, node: ConstructorNode) -> None:
        """A member follows this brace, so continue with the body. A missing head may also be the mistake."""
        self.first = self.i
        if not self.faulty():
            what = self.texts[self.i + 1 + (self.kinds[self.i + 1] == "@")]
            message = f"this brace closes `{node.name.text}`, but the member `{what}` follows"
            self.report("UL013", self.i, message, "remove it, or give what follows the head of a constructor")
        self.i += 1
        node.broken = program.damaged = True
