# SPDX-License-Identifier: BSD-3-Clause
"""`unitylink token`: a new token for a user of a server."""

from __future__ import annotations

import datetime
import json
import os

import click


@click.command()
@click.argument("name")
@click.argument("scopes", metavar="SCOPE...", nargs=-1, required=True)
@click.option("--expires", metavar="DAY", help="The first day on which it is invalid: 2027-01-31, in UTC.")
@click.option(
    "--file", "path", metavar="FILE", help="Add the entry to this file of tokens, or make the file."
)
def command(name: str, scopes: tuple[str, ...], expires: str | None, path: str | None) -> None:
    """Make a token for the user NAME of a server.

    The token is printed once, and kept nowhere. Give it to the user over a safe way. The file of tokens has
    only a digest of it. SCOPE is `read`, `write`, `arm` (go on after a stop) or `admin`. `read` and `write`
    may name a part of the robot.

    \b
    Examples:
      unitylink token ana read 'write j1.*' --file tokens.toml
      unitylink token class read --expires 2027-02-01 --file tokens.toml
      unitylink token lab admin
    """
    from unitylink.errors import UnityLinkError
    from unitylink.server.token_file import load_tokens, parse_tokens
    from unitylink.server.tokens import digest, new_token

    day = None
    if expires is not None:
        try:
            day = datetime.date.fromisoformat(expires)
        except ValueError as error:
            raise UnityLinkError(f"--expires {expires}: {error}; write a day as 2027-01-31") from error
    token = new_token()
    lines = ["[[token]]", f"name = {json.dumps(name)}", f'sha256 = "{digest(token)}"']
    lines.append(f"scopes = {json.dumps(list(scopes))}")
    lines += [f"expires = {day.isoformat()}"] if day else []
    entry = "\n".join(lines) + "\n"
    parse_tokens(entry, "the entry")
    if path is None:
        click.echo(f"Add this entry to the file of tokens:\n\n{entry}\nThe token of {name}:", err=True)
    else:
        before = ""
        if os.path.exists(path):
            if name in load_tokens(path).names():
                raise UnityLinkError(f"{path} has a token of {name}; take another name, or remove it there")
            with open(path, encoding="utf-8") as file:
                before = file.read().rstrip("\n") + "\n\n"
        parse_tokens(before + entry, path)
        _write(path, before + entry)
        click.echo(f"{path} has an entry for {name} now. The token:", err=True)
    click.echo(token)


def _write(path: str, text: str) -> None:
    """Replace the file whole. A new one is readable by its owner alone."""
    from unitylink.errors import UnityLinkError
    from unitylink.output_file import replace_file

    try:
        os.close(os.open(path, os.O_WRONLY | os.O_CREAT, 0o600))
        replace_file(path, text)
    except OSError as error:
        raise UnityLinkError(f"{path}: {error.strerror or error}") from error
