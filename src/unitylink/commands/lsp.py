# SPDX-License-Identifier: BSD-3-Clause
"""`unitylink lsp`: the language server for editors."""

from __future__ import annotations

import click

from unitylink.optional import absent


@click.command()
def command() -> None:
    """Serve editors: diagnostics while typing, hover with addresses, definition, rename, completion.

    It speaks the Language Server Protocol on standard input and output. The editor starts it. The extension
    for Visual Studio Code and settings for other editors are in the source tree (docs/editors.md). It needs
    the package pygls.

    \b
    Example, a line of an editor's configuration:
      unitylink lsp
    """
    try:
        from .language_server.server import make_server
    except ModuleNotFoundError as error:
        if (error.name or "").partition(".")[0] not in ("pygls", "lsprotocol"):
            raise
        raise absent("pygls", "the language server") from None
    make_server().start_io()
