# SPDX-License-Identifier: BSD-3-Clause
"""Read what stands beside constructors: `import`, `const`, `enum`, `bits`, and links with properties.

None of these words is a keyword. For example, `const` begins a constant only if a name follows it.
"""

from __future__ import annotations

from .cursor import Panic
from .lexer import unescape
from .member_reader import MemberReader
from .properties import FIELD_PROPERTIES, LINK_PROPERTIES
from .syntax import (
    Argument,
    BitsNode,
    ConstantNode,
    EnumNode,
    EnumValueNode,
    FieldNode,
    ImportNode,
    LinkNode,
    Name,
    Notes,
    Number,
    Program,
    Text,
    TypeNode,
)

_NO_TYPE = TypeNode(Name("", 0, 0), [], 0)  # for a declaration with a mistake; it is never used


class DeclarationReader(MemberReader):
    """A cursor that reads declarations into a program."""

    def at_declaration(self) -> bool:
        kinds, texts, i = self.kinds, self.texts, self.i
        if kinds[i] != "name":
            return False
        if texts[i] == "import":
            return kinds[i + 1] == "string"
        if texts[i] == "open":
            return texts[i + 1] == "enum" and kinds[i + 1 : i + 3] == ["name", "name"]
        if texts[i] == "const":
            return kinds[i + 1] in ("name", "keyword") and kinds[i + 2] == "="
        # without the `:` it lacks its type, and it cannot be a constructor
        declared = kinds[i + 1] in ("name", "keyword") and kinds[i + 2] in (":", "{")
        return texts[i] in ("enum", "bits") and declared

    def declaration(self, program: Program, notes: Notes) -> None:
        """Read one declaration. If that fails, its name is added to `program.lost`."""
        start = self.first = self.i
        self.broken = False
        word = self.texts[self.i]
        name = self.texts[self.i + 1 + (word == "open")]
        try:
            if word == "import":
                self._import(program)
                return
            node = self._constant(notes) if word == "const" else self._type(word, notes)
        except Panic:
            program.lost.add(name)
            self._skip_declaration(word in ("enum", "open", "bits"))
            return
        if self.broken or self.touched():
            program.lost.add(name)
        else:
            program.declarations.append(node)
        self.trailing(node)
        assert self.i > start  # a declaration has at least its word

    def _skip_declaration(self, braces: bool) -> None:
        """Skip to after the `;` or `}` that ends it, or to the beginning of something else."""
        while (kind := self.kinds[self.i]) != "end":
            if kind == "}" or (kind == ";" and not braces):
                self.i += 1
                return
            if self.on_new_line() and (self.at_head() or self.at_declaration()):
                return
            if kind == "keyword" and self.texts[self.i] in ("public", "link"):
                return
            self.i += 1

    def _import(self, program: Program) -> None:
        self.i += 1
        text = unescape(self.texts[self.i])
        file = Text(text, *self.place(self.i))
        self.i += 1
        self.semicolon()
        if not self.touched():
            program.imports.append(ImportNode(file))

    def _constant(self, notes: Notes) -> ConstantNode:
        self.i += 1
        name = self.name("the constant's name")
        self.i += 1
        value = self.argument("a number")
        self.semicolon()
        return ConstantNode(name, value, notes)

    def _type(self, word: str, notes: Notes) -> EnumNode | BitsNode:
        self.i += 1 + (word == "open")
        name = self.name("the type's name")
        kind: TypeNode | None = None
        if self.kinds[self.i] != "{":
            self.expect(":", "`:` and the type it is made of, such as u8")
            kind = self.type()
        self.expect("{", "`{`")
        node: EnumNode | BitsNode
        if word == "bits":
            fields: list[FieldNode] = []
            while not self._closed():
                fields.append(self._field())
            width = 1 + max((_number(field.high) for field in fields), default=0)
            node = BitsNode(name, kind or _NO_TYPE, fields, notes)
        else:
            values: list[EnumValueNode] = []
            while not self._closed():
                values.append(self._value_of_enum())
            width = max((_number(value.value).bit_length() for value in values), default=0)
            node = EnumNode(name, word == "open", kind or _NO_TYPE, values, notes)
        if kind is None:
            self._missing_type(name, min(max(width, 1), 64))
        return node

    def _missing_type(self, name: Name, width: int) -> None:
        """Advise the narrowest type for the declared values."""
        advice = self.replace(f"`{name.text}: u{width} {{` is wide enough", name.end, name.end, f": u{width}")
        message = f"`{name.text}` has no type, which says how many bits it takes"
        self.reporter.report("UL010", name.start, name.end, message, advice)
        self.broken = True

    def _closed(self) -> bool:
        if self.kinds[self.i] == "end" or self.at_head():
            raise self.unexpected("`}`")
        return self.accept("}")

    def _item_ends(self, item: FieldNode | EnumValueNode) -> None:
        """The `;` after the last one may be missing."""
        if self.kinds[self.i] != "}":
            following = self.kinds[self.i + 1]
            if self.kinds[self.i] == "," or (self.kinds[self.i] == "name" and following in ("=", ":")):
                self._missing_semicolon()
            else:
                self.expect(";", "`;`")
        self.trailing(item)

    def _missing_semicolon(self) -> None:
        end = self.tokens.ends[self.i - 1]
        upto = self.tokens.ends[self.i] if self.kinds[self.i] == "," else end
        advice = self.replace("add `;`" if upto == end else "write `;` for `,`", end, upto, ";")
        self.reporter.report("UL011", end, end, "`;` is missing here", advice)
        self.i += upto != end

    def _value_of_enum(self) -> EnumValueNode:
        notes = self.notes()
        name = self.name("the name of a value")
        self.expect("=", "`=` and a number")
        item = EnumValueNode(name, self.argument("a number"), notes)
        self._item_ends(item)
        return item

    def _field(self) -> FieldNode:
        notes = self.notes()
        name = self.name("the name of a field")
        self.expect(":", "`:` and a type")
        kind = self.type()
        self.expect("@", "`@` and the bits, such as `@ 3..0`")
        high = self.argument("the highest bit")
        low: Argument | None = None
        if self.accept(".."):
            low = self.argument("the lowest bit")
        properties = self.properties(FIELD_PROPERTIES) if self.kinds[self.i] == "(" else []
        item = FieldNode(name, kind, high, low, properties, notes)
        self._item_ends(item)
        return item

    def link(self, program: Program, name: Name, notes: Notes) -> None:
        """Read the properties of a link. Its name has already been read."""
        node = LinkNode(name, self.properties(LINK_PROPERTIES), notes)
        program.declarations.append(node)


def _number(argument: Argument) -> int:
    """Return the whole number of an argument, or 0 if it is something else."""
    part = argument.parts[0]
    plain = argument.literal and isinstance(part, Number) and isinstance(part.value, int)
    return part.value if plain else 0  # type: ignore[union-attr, return-value]
