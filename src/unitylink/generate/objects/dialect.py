# SPDX-License-Identifier: BSD-3-Clause
"""How C, C++ and Rust spell the same table, number or type."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

from ..quoting import Code, Cpp, Part, Rust
from .names import RUST_KEYWORDS

# Facts that a table of C has and one of Rust has not: there the members of an enumeration are in its type.
_OF_C = frozenset({"members", "member_count"})


@dataclass(frozen=True)
class Dialect:
    """The spelling of one language. Whole numbers have `ending` there, and tables are of `table`."""

    code: type[Code]
    ending: str
    null: Code
    keywords: frozenset[str] = field(default=frozenset(), repr=False)  # beside those of C and C++

    @property
    def rust(self) -> bool:
        return self.code is Rust

    def number(self, number: int, digits: int = 1) -> Code:
        """Return an address, a mask or a hash."""
        return self.code.of("0x{}{}", f"{number:0{digits}X}", self.ending)

    def unsigned(self, number: int) -> Code:
        return self.code.of("{}{}", number, self.ending)

    def constant(self, group: str, name: str) -> Code:
        """Return a constant of the library: KIND, SCALED -> UL_KIND_SCALED, Kind::Scaled."""
        if not self.rust:
            return self.code.of("UL_{}_{}", group, name)
        if group == "VALUE":
            return self.code.of("::unitylink::{}", name)
        return self.code.of("::unitylink::{}::{}", group.title(), name.title())

    def either(self, flags: Sequence[Code]) -> Code:
        """Return several flags as one number."""
        return self.code(" | ").join(flags) or self.code("0")

    def table(self, kind: str, rows: Sequence[tuple[str, Part]]) -> Code:
        """Return the initialiser of a struct from the names of its members and their values."""
        if not self.rust:
            return self.code.of("{{{}}}", self.code(", ").join([value for _, value in rows]))
        named = [self.code.of("{}: {}", name, value) for name, value in rows if name not in _OF_C]
        return self.code.of("::unitylink::{} {{ {} }}", kind, self.code(", ").join(named))

    def whole(self, bits: int, *, signed: bool) -> tuple[Code, str]:
        """Return the type of a whole number, and the short name that C's functions have for it."""
        short = f"{'i' if signed else 'u'}{bits}"
        if self.rust:
            return self.code.of("{}", short), short
        std = "" if self is C else "std::"
        return self.code(f"{std}{'' if signed else 'u'}int{bits}_t"), short


C = Dialect(Cpp, "U", Cpp("NULL"))
CPP = Dialect(Cpp, "U", Cpp("nullptr"))
RUST = Dialect(Rust, "", Rust(""), RUST_KEYWORDS)
