# SPDX-License-Identifier: BSD-3-Clause
"""The names and keywords that an editor offers at a place."""

from __future__ import annotations

from collections.abc import Iterable

from lsprotocol import types

from unitylink.spec.meaning.symbols import Scope, Symbol, Symbols
from unitylink.spec.report.diagnostics import Reporter
from unitylink.spec.source import Source
from unitylink.spec.text.lexer import Tokens, tokenize

from .document import Document
from .words import (
    ACCESS_WORDS,
    BUILT_IN_TYPES,
    CHOICES,
    ELEMENT_PROPERTIES,
    FIELD_PROPERTIES,
    LINK_KIND_PROPERTIES,
    LINK_KINDS,
    LINK_PROPERTIES,
    TOP,
)

_Kind = types.CompletionItemKind
_KINDS = {
    "constructor": _Kind.Class,
    "parameter": _Kind.Variable,
    "address": _Kind.Field,
    "element": _Kind.Field,
    "instance": _Kind.Module,
    "group": _Kind.Reference,
    "constant": _Kind.Constant,
    "enum": _Kind.Enum,
    "value": _Kind.EnumMember,
    "bits": _Kind.Struct,
    "field": _Kind.Field,
    "link": _Kind.Interface,
}


def completion(document: Document, offset: int) -> list[types.CompletionItem]:
    """Return the words that are possible at `offset`.

    The client filters them by what the user has already typed.
    """
    tokens = tokenize(Reporter(Source(document.file, document.text[:offset])))
    count = tokens.kinds.index("end")
    if any(
        start < offset < end or (offset == end and document.text[start:end][:2] == "//")
        for start, end in tokens.comments
    ):
        return []
    if count and tokens.ends[count - 1] == offset and tokens.kinds[count - 1] in ("name", "keyword"):
        count -= 1  # the word being typed
    elif count and tokens.kinds[count - 1] == "string" and tokens.starts[count - 1] in tokens.faults:
        return []  # inside a string
    return _Place(document.symbols, tokens, count, offset).items()


class _Place:
    """The tokens before the word being typed, since the last `;`, `{` or `}`."""

    def __init__(self, symbols: Symbols, tokens: Tokens, count: int, offset: int) -> None:
        kinds = tokens.kinds[:count]
        first = max((i + 1 for i, kind in enumerate(kinds) if kind in (";", "{", "}")), default=0)
        self.symbols = symbols
        self.words = tokens.texts[first:count]
        self.in_type = self.in_body = False
        if kinds.count("{") > kinds.count("}"):
            opened = len(kinds) - kinds[::-1].index("{") - 1
            head = max((i + 1 for i in range(opened) if kinds[i] in (";", "{", "}")), default=0)
            self.in_type = any(word in ("enum", "bits") for word in tokens.texts[head : head + 2])
            self.in_body = not self.in_type
        self.scope = symbols.scope_at(offset) if self.in_body else None
        self.callee = self._callee()

    def items(self) -> list[types.CompletionItem]:
        words, scope = self.words, self.scope
        last = words[-1] if words else ""
        opener, property_ = self._opener()
        if opener:
            return self._inside(opener, property_, last)
        if scope is None:
            return self._outside(last)
        if not words:
            return _keywords(LINK_KINDS) + _symbols(scope.members.values())
        if last == "@":
            addresses = self.callee.members if self.callee and len(words) > 1 else scope.members
            return _symbols(s for s in addresses.values() if s.declared is not None)
        if last == ":":
            found = _symbols(self.symbols.constructors.values())
            if words[0] == "@":
                found += _symbols(self.symbols.types.values()) + _keywords((*BUILT_IN_TYPES, *ACCESS_WORDS))
            return found
        if last == ".":
            return self._below(scope)
        if len(words) > 1 and words[1] == "=" and last in ("=", ","):
            return _symbols(s for s in scope.members.values() if s.kind != "address") + _keywords(("ALL",))
        if words[0] == "@" and ":" in words:  # after the type
            return _keywords(ACCESS_WORDS)
        return []

    def _outside(self, last: str) -> list[types.CompletionItem]:
        """The place is outside of constructors."""
        if not self.words:
            return _keywords(TOP) if not self.in_type else []
        if last == ":":
            return _keywords(BUILT_IN_TYPES) + _symbols(self.symbols.types.values())
        return _symbols(self.symbols.constants.values()) if last in ("=", "+", "-", "*") else []

    def _inside(self, opener: str, property_: str, last: str) -> list[types.CompletionItem]:
        """The place is inside brackets that belong to `opener`, after `property_=` if that is given."""
        if opener == "ALL":
            return _symbols(self.symbols.constructors.values())
        properties: tuple[str, ...] = LINK_KIND_PROPERTIES.get(opener, ())
        if opener in ACCESS_WORDS:
            properties = ELEMENT_PROPERTIES
        elif not self.in_body:
            properties = FIELD_PROPERTIES if self.in_type else LINK_PROPERTIES
        if properties and last in ("(", ","):
            return _keywords(properties)
        if property_ in CHOICES:
            return _keywords(CHOICES[property_])
        if property_ == "LINK":
            return _symbols(self.symbols.links.values())
        if last not in ("=", "+", "-", "*", "/", "(", "[", ","):
            return []
        found = _symbols(self.symbols.constants.values())
        if property_ in ("INITIAL", "SAFE"):
            found += _symbols(v for word in self.words for v in self.symbols.items.get(word, {}).values())
        if self.scope is not None:
            found += _symbols(self.scope.parameters.values())
        if self.callee is not None and opener == self.callee.node.name.text and last in ("(", ","):
            found += [
                types.CompletionItem(f"{name}=", kind=_Kind.Variable) for name in self.callee.parameters
            ]
        return found

    def _opener(self) -> tuple[str, str]:
        """Return the word before the innermost open bracket, and the property whose value comes next."""
        depth, property_ = 0, ""
        for i in range(len(self.words) - 1, 0, -1):
            word = self.words[i]
            depth += (word in (")", "]")) - (word in ("(", "["))
            if depth < 0:
                return self.words[i - 1] if word == "(" else word, property_
            if depth == 0 and word == "," and not property_:
                property_ = " "  # another one's
            elif depth == 0 and word == "=" and not property_:
                property_ = self.words[i - 1]
        return "", ""

    def _callee(self) -> Scope | None:
        """Return the constructor that the statement expands."""
        after = self.words.index(":") + 1 if ":" in self.words else len(self.words)
        return self.symbols.scope_of(self.words[after]) if after < len(self.words) else None

    def _below(self, scope: Scope) -> list[types.CompletionItem]:
        """Return the members below the path that ends with a dot."""
        path = "".join(self.words[self.words.index("=") + 1 :] if "=" in self.words else ())
        here: Scope | None = scope
        for step in path.split(",")[-1].strip(".").split("."):
            if here is None:
                return []
            inner = step[4:-1] if step.startswith("ALL(") else here.callees.get(step, "")
            here = self.symbols.scope_of(inner)
        return _symbols(here.members.values()) + _keywords(("ALL",)) if here is not None else []


def _keywords(words: Iterable[str]) -> list[types.CompletionItem]:
    return [types.CompletionItem(word, kind=_Kind.Keyword) for word in words]


def _symbols(symbols: Iterable[Symbol]) -> list[types.CompletionItem]:
    return [types.CompletionItem(s.name, kind=_KINDS.get(s.kind), detail=s.kind) for s in symbols]
