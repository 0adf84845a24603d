# SPDX-License-Identifier: BSD-3-Clause
"""The meaning of a type's name."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping

from ..text.syntax import Argument, Expression, Name, Operation, Path, TypeNode
from ..types import EnumType, ValueType
from .evaluate import Evaluator, Value

_WIDTHS = range(1, 65)
_FLOATS = (32, 64)
_LETTERS = {"u": "uint", "i": "int", "f": "float"}
_BUILT_IN = re.compile(r"bool|signed|u?fixed|[uif]([0-9]{1,3})?")
BUILT_IN_TYPES = (  # the ones that people write; widths between them are rare
    "bool",
    "u8",
    "u16",
    "u32",
    "u64",
    "i8",
    "i16",
    "i32",
    "i64",
    "f32",
    "f64",
    "fixed",
    "ufixed",
    "signed",
)
_FOREIGN = {
    "float": "f32",
    "double": "f64",
    "int": "i32",
    "uint": "u32",
    "byte": "u8",
    "char": "u8",
    "bit": "bool",
    "boolean": "bool",
    "unsigned": "",
}
_FOREIGN_WIDTH = re.compile(r"(u?int|s|float|uint)([0-9]{1,2})(_t)?")


class TypeNames:
    """Resolves the types of a spec. `enums` and `bits` grow while types are declared."""

    def __init__(
        self,
        evaluator: Evaluator,
        enums: Mapping[str, EnumType],
        bits: Mapping[str, ValueType],
        lost: set[str],
    ) -> None:
        self.evaluator = evaluator
        self.reporter = evaluator.reporter
        self.enums = enums
        self.bits = bits
        self.lost = lost
        self._known: dict[str, ValueType] = {"bool": ValueType("bool", 1)}

    def may_be_declared(self, name: Name) -> bool:
        """Report a type with the name of a built-in one."""
        if not _BUILT_IN.fullmatch(name.text):
            return True
        message = f"`{name.text}` is the name of a built-in type"
        self.reporter.report("UL082", name.start, name.end, message, "give the type another name")
        return False

    def resolve(self, node: TypeNode, names: Mapping[str, Value]) -> ValueType | None:
        """Return the meaning of a type, or None after a diagnostic."""
        name = node.name.text
        known = self._known.get(name)
        if known is None and not node.arguments:
            known = self._plain(node)
            if known is not None:
                self._known[name] = known
        if node.arguments:
            return self._with_arguments(node, names)
        return known

    def _plain(self, node: TypeNode) -> ValueType | None:
        name = node.name.text
        enum = self.enums.get(name)
        if enum is not None:
            return ValueType("enum", enum.width, 0, enum, (), name, enum.documentation, enum.annotations)
        if name in self.bits:
            return self.bits[name]
        if name in self.lost:
            return None
        match = _BUILT_IN.fullmatch(name)
        if match is None:
            self._unknown(node)
            return None
        if match.group(1) is None:
            message = f"`{name}` needs " + (
                "its bits before and behind the point" if "fixed" in name else "a width"
            )
            hint = f"write it like `{name}(8,8)`" if "fixed" in name else f"write it like `{name}16`"
            self.reporter.report("UL081", node.name.start, node.end, message, hint)
            return None
        return self._sized(node, name[0], int(match.group(1)))

    def _sized(self, node: TypeNode, letter: str, width: int) -> ValueType | None:
        allowed = _FLOATS if letter == "f" else _WIDTHS
        if width in allowed:
            return ValueType(_LETTERS[letter], width)
        message = f"there is no type `{letter}{width}`"
        hint = "there are f32 and f64" if letter == "f" else f"there are {letter}1 to {letter}64"
        self.reporter.report("UL081", node.name.start, node.end, message, hint)
        return None

    def _with_arguments(self, node: TypeNode, names: Mapping[str, Value]) -> ValueType | None:
        name = node.name.text
        wanted = 2 if name in ("fixed", "ufixed") else 1 if name in _LETTERS else 0
        if wanted == 0 and not _BUILT_IN.fullmatch(name) and name not in self.enums and name not in self.bits:
            self._unknown(node)
            return None
        if len(node.arguments) != wanted:
            takes = {0: "nothing", 1: "its width", 2: "its bits before and behind the point"}[wanted]
            message = f"the type `{name}` takes {takes} in brackets"
            hint = "write it like " + {0: f"`{name}`", 1: f"`{name}(12)`", 2: f"`{name}(8,8)`"}[wanted]
            self.reporter.report("UL081", node.name.start, node.end, message, hint)
            return None
        sizes = [self.evaluator.integer(one, names, "the number of bits", 0, 64) for one in node.arguments]
        if None in sizes:
            return None
        whole, fraction = [size for size in sizes if size is not None] + [0] * (2 - wanted)
        if wanted == 1:
            return self._sized(node, name, whole)
        if 1 <= whole + fraction <= 64:
            return ValueType(name, whole + fraction, fraction)
        message = f"`{name}({whole},{fraction})` has {whole + fraction} bits"
        self.reporter.report("UL081", node.name.start, node.end, message, "it has 1 to 64 bits in all")
        return None

    def _unknown(self, node: TypeNode) -> None:
        name = node.name.text
        if name in self.lost:
            return
        at = node.name.start, node.name.end
        if name == "unsigned":
            advice = self.reporter.did_you_mean("", (), "words are unsigned without `signed`: remove it")
            advice = advice._replace(fixes=((node.name.start, node.end, ""),))
        else:
            match = _FOREIGN_WIDTH.fullmatch(name)
            foreign = _FOREIGN.get(name)
            if match:
                foreign = {"uint": "u", "int": "i", "s": "i", "float": "f"}[match.group(1)] + match.group(2)
            if foreign:
                advice = self.reporter.did_you_mean("", (), f"write `{foreign}`")
                advice = advice._replace(fixes=((*at, foreign),))
            else:
                candidates = (*BUILT_IN_TYPES, *self.enums, *self.bits)
                hint = (
                    "types are bool, u1 to u64, i1 to i64, f32, f64, fixed(i,f), ufixed(i,f), enums and bits"
                )
                advice = self.reporter.did_you_mean(name, candidates, hint, at)
        self.reporter.report("UL080", *at, f"there is no type `{name}`", advice)


def names_of(node: Expression) -> Iterator[Name]:
    """Yield the names in an expression."""
    if isinstance(node, Name):
        yield node
    elif isinstance(node, Argument):
        for part in node.parts:
            yield from names_of(part)
    elif isinstance(node, Operation):
        if node.left is not None:
            yield from names_of(node.left)
        yield from names_of(node.right)
    elif isinstance(node, Path):
        for step in node.steps:
            if step.index is not None:
                yield from names_of(step.index)
