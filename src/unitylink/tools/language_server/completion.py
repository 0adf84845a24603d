# SPDX-License-Identifier: BSD-3-Clause
"""What may stand at a place: the names and keywords an editor offers."""

from __future__ import annotations

from collections.abc import Iterable

from lsprotocol import types

from unitylink.spec.diagnostics import Reporter
from unitylink.spec.lexer import Tokens, tokenize
from unitylink.spec.source import Source
from unitylink.spec.symbols import Scope, Symbol, Symbols

from .document import Document
from .words import ACCESS, ELEMENT_PROPERTIES, LINK_PROPERTIES, TOP

_Kind = types.CompletionItemKind
_KINDS = {
    "constructor": _Kind.Class,
    "parameter": _Kind.Variable,
    "address": _Kind.Field,
    "element": _Kind.Field,
    "instance": _Kind.Module,
    "group": _Kind.Reference,
}


def completion(document: Document, offset: int) -> list[types.CompletionItem]:
    """Return what may stand at `offset`; the client filters by what is typed already."""
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
        self.in_body = kinds.count("{") > kinds.count("}")
        self.scope = symbols.scope_at(offset) if self.in_body else None
        self.callee = self._callee()

    def items(self) -> list[types.CompletionItem]:
        words, scope = self.words, self.scope
        last = words[-1] if words else ""
        if scope is None:
            return [] if words else _keywords(TOP)
        opener = self._opener()
        if opener:
            return self._inside(opener, last, scope)
        if not words:
            return _keywords(("TOSNET",)) + _symbols(scope.members.values())
        if last == "@":
            addresses = self.callee.members if self.callee and len(words) > 1 else scope.members
            return _symbols(s for s in addresses.values() if s.declared is not None)
        if last == ":":
            found = _symbols(self.symbols.constructors.values())
            return found + _keywords(("signed", *ACCESS)) if words[0] == "@" else found
        if last == "signed":
            return _keywords(ACCESS)
        if last == ".":
            return self._below(scope)
        if len(words) > 1 and words[1] == "=" and last in ("=", ","):
            return _symbols(s for s in scope.members.values() if s.kind != "address") + _keywords(("ALL",))
        return []

    def _inside(self, opener: str, last: str, scope: Scope) -> list[types.CompletionItem]:
        """The place is inside brackets that belong to `opener`."""
        if opener == "ALL":
            return _symbols(self.symbols.constructors.values())
        properties = ELEMENT_PROPERTIES if opener in ACCESS else LINK_PROPERTIES if opener == "TOSNET" else ()
        if properties and last in ("(", ","):
            return _keywords(properties)
        if last in ("=", "+", "(", ","):
            return _symbols(scope.parameters.values())
        return []

    def _opener(self) -> str:
        """Return the word before the innermost open bracket, "" outside of brackets."""
        depth = 0
        for i in range(len(self.words) - 1, 0, -1):
            depth += (self.words[i] == ")") - (self.words[i] == "(")
            if depth < 0:
                return self.words[i - 1]
        return ""

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
