# SPDX-License-Identifier: BSD-3-Clause
"""The requests of the protocol. Each is given to the module that answers it."""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Union
from urllib.parse import unquote, urlsplit

from lsprotocol import types
from pygls.exceptions import JsonRpcInvalidParams
from pygls.lsp.server import LanguageServer

from unitylink import __version__
from unitylink.spec import Diagnostic
from unitylink.spec.report.diagnostics import Edit
from unitylink.spec.text.syntax import Name

from .completion import completion
from .document import Document, range_in
from .edits import RenameRefused, fixes, formatting, rename
from .hover import hover
from .project import Project

_SEVERITIES = {"error": types.DiagnosticSeverity.Error, "warning": types.DiagnosticSeverity.Warning}
_SYMBOL_KINDS = {
    "constructor": types.SymbolKind.Class,
    "instance": types.SymbolKind.Module,
    "group": types.SymbolKind.Array,
}


_AtPlace = Union[
    types.HoverParams,
    types.DefinitionParams,
    types.ReferenceParams,
    types.RenameParams,
    types.CompletionParams,
]


class Server(LanguageServer):
    """The server with the open documents."""

    def __init__(self) -> None:
        super().__init__("unitylink", __version__, types.TextDocumentSyncKind.Full)
        self.documents: dict[str, Document] = {}

    def update(self, uri: str, version: int | None) -> None:
        """Take a new text and publish its diagnostics."""
        text = self.workspace.get_text_document(uri)
        codec, before = self.workspace.position_codec, self.documents.get(uri)
        document = Document(text.source, _file(uri), codec, before, self._opened(uri))
        self.documents[uri] = document
        found = [_diagnostic(document, uri, one) for one in document.own_diagnostics]
        found += _diagnostics_of_imports(document)
        self.text_document_publish_diagnostics(types.PublishDiagnosticsParams(uri, found, version))

    def _opened(self, but: str = "") -> dict[str, str]:
        """Return the editor's texts of all files except one, by real path."""
        others = [(uri, document) for uri, document in self.documents.items() if uri != but]
        return {os.path.realpath(document.file): document.text for _, document in others}

    def project(self, document: Document) -> Project:
        """Return the specs of the workspace.

        Without a workspace, return those in the folder of the document.
        """
        folders = [Path(_file(uri)) for uri in self.workspace.folders]
        if not folders and self.workspace.root_path:
            folders = [Path(self.workspace.root_path)]
        return Project(folders or [Path(document.file).parent], self._opened())

    def workspace_edit(self, edits: Mapping[str, Sequence[Edit]], project: Project) -> types.WorkspaceEdit:
        """Return edits of files, by real path, for the client. An open file keeps the client's name."""
        uris = {os.path.realpath(document.file): uri for uri, document in self.documents.items()}
        codec = self.workspace.position_codec
        return types.WorkspaceEdit(
            {
                uris.get(file) or Path(file).as_uri(): [
                    types.TextEdit(range_in(project.texts[file], start, end, codec), word)
                    for start, end, word in ours
                ]
                for file, ours in edits.items()
            }
        )

    def place(self, params: _AtPlace) -> tuple[Document, int]:
        """Return the document and the character to which a request refers."""
        document = self.documents[params.text_document.uri]
        return document, document.offset(params.position)


def make_server() -> Server:
    """Return a server with all its features."""
    server = Server()

    @server.feature(types.TEXT_DOCUMENT_DID_OPEN)
    def opened(params: types.DidOpenTextDocumentParams) -> None:
        server.update(params.text_document.uri, params.text_document.version)

    @server.feature(types.TEXT_DOCUMENT_DID_CHANGE)
    def changed(params: types.DidChangeTextDocumentParams) -> None:
        server.update(params.text_document.uri, params.text_document.version)

    @server.feature(types.TEXT_DOCUMENT_DID_CLOSE)
    def closed(params: types.DidCloseTextDocumentParams) -> None:
        server.documents.pop(params.text_document.uri, None)
        server.text_document_publish_diagnostics(types.PublishDiagnosticsParams(params.text_document.uri, []))

    @server.feature(types.TEXT_DOCUMENT_HOVER)
    def hovered(params: types.HoverParams) -> types.Hover | None:
        document, offset = server.place(params)
        text = hover(document, offset)
        return types.Hover(types.MarkupContent(types.MarkupKind.Markdown, text)) if text else None

    @server.feature(types.TEXT_DOCUMENT_DEFINITION)
    def definition(params: types.DefinitionParams) -> types.Location | None:
        document, offset = server.place(params)
        found = document.symbols.at(offset)
        if found is None:
            return None
        return document.location(params.text_document.uri, found[0].target(offset))

    @server.feature(types.TEXT_DOCUMENT_REFERENCES)
    def references(params: types.ReferenceParams) -> list[types.Location]:
        document, offset = server.place(params)
        found = document.symbols.at(offset)
        if found is None:
            return []
        symbol = found[0]
        places = symbol.places if params.context.include_declaration else symbol.references
        return [document.location(params.text_document.uri, place) for place in places]

    @server.feature(types.TEXT_DOCUMENT_RENAME)
    def renamed(params: types.RenameParams) -> types.WorkspaceEdit:
        document, offset = server.place(params)
        try:
            project = server.project(document)
            edits = rename(document, offset, params.new_name, project)
        except RenameRefused as reason:
            raise JsonRpcInvalidParams(str(reason)) from None
        return server.workspace_edit(edits, project)

    @server.feature(
        types.TEXT_DOCUMENT_COMPLETION, types.CompletionOptions(trigger_characters=["@", ":", ".", "(", "="])
    )
    def complete(params: types.CompletionParams) -> list[types.CompletionItem]:
        return completion(*server.place(params))

    @server.feature(types.TEXT_DOCUMENT_FORMATTING)
    def formatted(params: types.DocumentFormattingParams) -> list[types.TextEdit]:
        return formatting(server.documents[params.text_document.uri])

    @server.feature(types.TEXT_DOCUMENT_CODE_ACTION, types.CodeActionOptions([types.CodeActionKind.QuickFix]))
    def actions(params: types.CodeActionParams) -> list[types.CodeAction]:
        document = server.documents[params.text_document.uri]
        start, end = document.offset(params.range.start), document.offset(params.range.end)
        return [
            types.CodeAction(
                title,
                types.CodeActionKind.QuickFix,
                [_diagnostic(document, params.text_document.uri, about)],
                edit=types.WorkspaceEdit({params.text_document.uri: edits}),
            )
            for about, title, edits in fixes(document, start, end)
        ]

    @server.feature(types.TEXT_DOCUMENT_DOCUMENT_SYMBOL)
    def outline(params: types.DocumentSymbolParams) -> list[types.DocumentSymbol]:
        document = server.documents[params.text_document.uri]
        found = []
        for scope in document.symbols.scopes:
            one = _outline(document, "constructor", scope.node.name)
            one.range = document.range(scope.start, scope.end)
            members = list(scope.members.values())
            one.children = [_outline(document, m.kind, m.defined) for m in members if m.defined is not None]
            found.append(one)
        return found

    return server


def _outline(document: Document, kind: str, name: Name) -> types.DocumentSymbol:
    place = document.range(name.start, name.end)
    return types.DocumentSymbol(
        name.text or "?", _SYMBOL_KINDS.get(kind, types.SymbolKind.Field), place, place, kind
    )


def _diagnostic(document: Document, uri: str, one: Diagnostic) -> types.Diagnostic:
    message = f"{one.message}\nhelp: {one.hint}" if one.hint else one.message
    return types.Diagnostic(
        document.range(one.span.start, max(one.span.end, one.span.start)),
        message,
        _SEVERITIES[one.severity],
        one.code,
        source="unitylink",
        related_information=[
            types.DiagnosticRelatedInformation(
                types.Location(uri, document.range(label.span.start, label.span.end)), label.text
            )
            for label in one.labels
            if label.span.file == document.file
        ],
    )


def _diagnostics_of_imports(document: Document) -> list[types.Diagnostic]:
    """Report at the head of the document which of its imported files have errors."""
    counts = Counter(
        one.span.file
        for one in document.result.diagnostics
        if one.severity == "error" and one.span.file != document.file
    )
    return [
        types.Diagnostic(
            document.range(0, 0),
            f"{file} has {count} error{'' if count == 1 else 's'}: open it, or run `unitylink check`",
            types.DiagnosticSeverity.Error,
            source="unitylink",
        )
        for file, count in counts.items()
    ]


def _file(uri: str) -> str:
    """Return the path of a file URI, or the URI itself for a text that is not a file."""
    parts = urlsplit(uri)
    return unquote(parts.path) if parts.scheme == "file" else uri
