# SPDX-License-Identifier: BSD-3-Clause
"""Read the members of a constructor: elements, expansions, groups, the kind of the link."""

from __future__ import annotations

from ..report.diagnostics import Advice
from .cursor import ACCESS_WORDS, Panic
from .interpolation import interpolate
from .properties import ELEMENT_PROPERTIES, LINK_KIND_PROPERTIES, PropertyReader
from .syntax import (
    NO_NOTES,
    AnnotationNode,
    Argument,
    Binding,
    BrokenNode,
    ElementNode,
    ExpansionNode,
    Expression,
    GroupNode,
    LinkKindNode,
    MemberNode,
    Name,
    Notes,
    Number,
    Step,
    TypeNode,
)

_NEW_ACCESS = ACCESS_WORDS[2:]


class MemberReader(PropertyReader):
    """A cursor that reads members. A member with a mistake stays in the tree as a `BrokenNode`."""

    # those of this file, because their names hide new access words
    constructors: frozenset[str] = frozenset()

    def member(self) -> MemberNode | None:
        self.broken = False
        start = self.first = self.i
        member: MemberNode | None = None
        try:
            notes = self.notes()
            start = self.i
            member = self._member_by_form(notes)
            self.semicolon()
        except Panic:
            self.broken = True
            self.skip_member()
        self.trailing(member)
        if not (self.broken or self.touched()):
            return member
        name = self._name_of(start)
        return BrokenNode(name) if name else None

    def _name_of(self, start: int) -> Name | None:
        """Return the name of the broken member that starts at token `start`, if it has one."""
        start += self.kinds[start] == "@"
        if self.kinds[start] != "name" or start >= self.i:
            return None
        return Name(self.texts[start], self.tokens.starts[start], self.tokens.ends[start])

    def _member_by_form(self, notes: Notes) -> MemberNode:
        kind = self.kinds[self.i]
        following = self.kinds[self.i + 1] if kind != "end" else "end"
        if kind == "@":
            self.i += 1
            return self._addressed(notes)
        if self.at_link_kind(self.i) or (
            kind == "keyword" and self.texts[self.i] == "TOSNET" and following not in (":", "=")
        ):
            return self._link_kind()
        if kind == "name" or (kind == "keyword" and following in (":", "=")):
            return self._named(notes)
        hint = "remove it" if kind == ";" else ""
        if kind == "keyword" and self.texts[self.i] == "public":
            hint = "constructors are public, not their members: remove it"
        advice = self.replace(hint, *self.place(self.i), "") if hint else hint
        raise self.unexpected("a member, such as `@name: READ();`", advice, begins=True)

    def _named(self, notes: Notes) -> MemberNode:
        name = self.name("a member")
        if self.kinds[self.i] == "(":
            known = ("TOSNET", "MEMORY", "DOUBLE_BUFFER", "FIFO")
            advice = self.reporter.did_you_mean(name.text, known, "", (name.start, name.end))
            raise self.unexpected("`:` and a constructor, or `=` and the members of a group", advice)
        if self.accept("="):
            return self._group(name, notes)
        count = self._count()
        self.expect(":", "`:` and a constructor, or `=` and the members of a group")
        if self._at_element() and not self._at_new_access():  # this may be a constructor of another file
            shown = f"`@{name.text}: {self.texts[self.i]}`"
            if not self.faulty():
                advice = self.replace(f"write {shown}", name.start, name.start, "@")
                self.report("UL010", self.i, "an element's name stands after `@`", advice)
            raise Panic
        return self._expansion(name, notes, count)

    def _count(self) -> Argument | None:
        """Read the `[6]` of an array, if there is one."""
        if not self.accept("["):
            return None
        count = self.argument("how many there are")
        self.expect("]", "`]`")
        return count

    def _addressed(self, notes: Notes) -> ElementNode | ExpansionNode:
        name = self.name("the address name")
        count = self._count()
        fixed = self.address() if self.accept("=") else None
        if self.kinds[self.i] != ":" and self._at_element():
            last = self.i - 1
            if self.kinds[last] == "name" and self.texts[last - 1][0].isdigit():
                last -= 1  # a type that was read as the unit of the address
            end = self.tokens.ends[last]
            raise self.unexpected("`:`", self.replace("add `:`", end, end, ":"))
        self.expect(":", "`:`" if fixed else "`:`, or `=` and an address,")
        if self._at_element():
            return self._element(name, fixed, count, notes)
        if fixed is not None or count is not None:
            shown = f" (0x{fixed.value:X})" if isinstance(fixed, Number) else "…"
            hint = f"to bind it to an expansion write `{name.text}: constructor(…) @{shown}`"
            words = (*ACCESS_WORDS, "signed")
            if self.kinds[self.i : self.i + 3] == ["name", "name", "("]:
                self.i += 1  # a type, then a word that is no access word
            advice = self.reporter.did_you_mean(self.texts[self.i], words, hint, self.place(self.i))
            raise self.unexpected("READ or WRITE after an address", advice)
        return self._expansion(name, notes, None, forwards=True)

    def address(self) -> Expression:
        """Read an address. A single number is hexadecimal, anything else is an expression."""
        first = self.i
        whole = self.argument("an address such as 0x80")
        part = whole.parts[0]
        if len(whole.parts) > 1 or not isinstance(part, Number):
            return whole if len(whole.parts) > 1 else part
        text = self.texts[first]
        if text[:2] not in ("0x", "0X") and not self.broken:
            if not self.touched():
                hint = f"write 0x{text} if the 0x was forgotten"
                if isinstance(part.value, int):
                    hint = (
                        f"write 0x{part.value:X} if decimal {text} is meant, 0x{text} if the 0x was forgotten"
                    )
                self.report("UL019", first, "addresses are written in hexadecimal", hint)
            self.broken = True
        if self.broken:
            return Number(0, part.start, part.end)
        return part

    # --- elements -------------------------------------------------------------------------------------------

    def _at_element(self) -> bool:
        """Do an optional type and an access word come next, and not a constructor?"""
        i = self.i
        if self.kinds[i] == "keyword":
            return self.texts[i] in ("READ", "WRITE", "signed")
        if self.kinds[i] != "name":
            return False
        if (
            self.texts[i] in _NEW_ACCESS
            and self.texts[i] not in self.constructors
            and self.kinds[i + 1] == "("
        ):
            return True
        if self.kinds[i + 1] == "(":  # `fixed(8,8) READ`, or an expansion
            i = self.behind_bracket(i + 1)
        else:
            i += 1
        if self.kinds[i] == "keyword":
            return self.texts[i] in ("READ", "WRITE")
        return self.kinds[i] == "name" and self.texts[i] in _NEW_ACCESS and self.kinds[i + 1] == "("

    def _at_new_access(self) -> bool:
        return self.texts[self.i] in _NEW_ACCESS and self.kinds[self.i + 1] == "("

    def _element(
        self, name: Name, fixed: Expression | None, count: Argument | None, notes: Notes
    ) -> ElementNode:
        kind: TypeNode | None = None
        if self.kinds[self.i] == "keyword" and self.texts[self.i] == "signed":
            kind = TypeNode(Name("signed", *self.place(self.i)), [], self.tokens.ends[self.i])
            self.i += 1
        elif self.texts[self.i] not in ("READ", "WRITE") and not self._at_new_access():
            kind = self.type()
        access = self.texts[self.i]
        if access not in ACCESS_WORDS or self.kinds[self.i] == "string":
            at = self.place(self.i)
            raise self.unexpected("READ or WRITE", self.reporter.did_you_mean(access, ACCESS_WORDS, "", at))
        self.i += 1
        if self.kinds[self.i] == "keyword" and self.texts[self.i] == "signed":
            hint = f"write `signed {access}`"
            both = (self.tokens.starts[self.i - 1], self.tokens.ends[self.i], f"signed {access}")
            raise self.unexpected("`(`", Advice(hint, (both,)))
        found = self.properties(ELEMENT_PROPERTIES)
        for one in found if count is not None else ():
            if one.key == "ID" and one.argument is not None:
                one.argument = interpolate(one.argument, self.reporter)
        node = ElementNode(name, fixed, kind, access, found, count, notes)
        if self.kinds[self.i] == "@" and self.kinds[self.i + 1] == "(":
            hint = f"an element's address stands behind its name: `@{name.text} = 0x…: …`"
            raise self.unexpected("`;`", hint)
        return node

    def _link_kind(self) -> LinkKindNode:
        start, end = self.place(self.i)
        kind = self.texts[self.i]
        self.i += 1
        return LinkKindNode(kind, self.properties(LINK_KIND_PROPERTIES[kind]), start, end)

    # --- expansions -----------------------------------------------------------------------------------------

    def _expansion(
        self, name: Name, notes: Notes, count: Argument | None, *, forwards: bool = False
    ) -> ExpansionNode:
        callee = self.name("a constructor")
        if self.kinds[self.i] == "keyword":
            advice = self.replace(f"remove `{callee.text}`", callee.start, callee.end, "")
            raise self.unexpected(f"`(` and the arguments of `{callee.text}`", advice)
        arguments = self.arguments(callee)
        if count is not None:
            arguments = [interpolate(one, self.reporter) for one in arguments]
        bindings: list[Binding] = []
        if self.kinds[self.i] == ";" and self.at_binding(self.i + 1):
            self.unexpected("the addresses", self.replace("remove this `;`", *self.place(self.i), ""))
            self.broken = True
            self.i += 1
        if self.kinds[self.i] == "@" and not (forwards or (self.on_new_line() and self.at_member())):
            bindings.append(self._binding())
            while self.accept(","):
                bindings.append(self._binding())
        elif self.kinds[self.i] == "@" and not (self.on_new_line() and self.at_member()):
            hint = f"`@{name.text}` forwards addresses already; to bind others write `{name.text}: …`"
            raise self.unexpected("`;`", hint)
        return ExpansionNode(name, callee, arguments, bindings, forwards, count, notes)

    def _binding(self) -> Binding:
        start = self.tokens.starts[self.i]
        self.expect("@", "`@` and addresses")
        name: Name | None = None
        if self.kinds[self.i] in ("name", "keyword") and self.kinds[self.i + 1] == "=":
            name = self.name("an address name")
            self.i += 1
        if self.kinds[self.i] == "(" and not self._is_sum():
            self.i += 1
            numbers = [self.address()]
            while not self.accept(")"):
                self.expect(",", "`,` or `)`")
                numbers.append(self.address())
        else:
            if self.kinds[self.i] not in ("number", "name", "("):
                self.expect("(", "`(` and addresses" if name is None else "`=` and addresses")
            numbers = [self.address()]
        return Binding(name, numbers, start, self.tokens.ends[self.i - 1])

    def _is_sum(self) -> bool:
        """Does this bracket belong to an expression such as `(A+1)*8`, and not to a list of addresses?"""
        behind = self.behind_bracket(self.i)
        return self.kinds[behind] in ("+", "-", "*", "/", "%", "<<", ">>", "&", "|")

    # --- groups ---------------------------------------------------------------------------------------------

    def _group(self, name: Name, notes: Notes) -> GroupNode:
        paths = [self._path()]
        while self.accept(","):
            paths.append(self._path())
        if self.kinds[self.i] == "(":
            last = paths[-1][-1].name
            hint = f"an expansion is written `{name.text}: {last.text}(…)`"
            advice = self.reporter.did_you_mean(last.text, ("ALL",), hint, (last.start, last.end))
            raise self.unexpected("`;`", advice)
        return GroupNode(name, paths, notes)

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
        return Step(self.name("a member of the group"), False, self._count())

    # --- documentation and annotations ----------------------------------------------------------------------

    def notes(self) -> Notes:
        """Read the annotations before a declaration, and the `///` lines around them."""
        texts = [self.tokens.documentation.pop(self.i, "")] if self.tokens.documentation else []
        annotations: list[AnnotationNode] = []
        while self.at_annotation(self.i):
            self.i += 1
            name = self.name("an annotation")
            annotations.append(AnnotationNode(name, self.arguments(name)))
            texts.append(self.tokens.documentation.pop(self.i, ""))
        text = "\n".join(filter(None, texts))
        return Notes(text, tuple(annotations)) if text or annotations else NO_NOTES

    def trailing(self, member: object) -> None:
        """Add the `///` after a member in the same line to its notes."""
        text = self.tokens.trailing.pop(self.i - 1, "") if self.tokens.trailing else ""
        notes: Notes | None = getattr(member, "notes", None)
        if text and notes is not None:
            whole = "\n".join(filter(None, [notes.documentation, text]))
            member.notes = Notes(whole, notes.annotations)  # type: ignore[attr-defined]
