# SPDX-License-Identifier: BSD-3-Clause
"""`unitylink serve`: one board, many programs."""

from __future__ import annotations

import os
import re
import sys
from typing import TYPE_CHECKING

import click

from unitylink.program import stopped_by_signals

from .failure import Failure
from .output import json_option, print_json
from .root_option import part_of, root_option
from .serving import is_loopback, place_of

if TYPE_CHECKING:
    from unitylink.server.serving import Server
    from unitylink.server.tokens import Tokens
    from unitylink.spec.model import Spec

_NAMED = re.compile(r"([\w.-]+)=(.+)")
_FIRST_S = 5.0  # how long the announcement waits for the first attempts to open the links


@click.command()
@click.argument("links", metavar="LINK...", nargs=-1, required=True)
@click.argument("spec_file", metavar="SPEC")
@click.option("--listen", metavar="[HOST:]PORT", default="127.0.0.1:7450", show_default=True)
@click.option("--anyone", is_flag=True, help="Listen where other machines reach it. Tokens go unencrypted.")
@click.option(
    "--token-file",
    metavar="FILE",
    help="Who may do what; `unitylink token` writes it. Else a fresh token is made.",
)
@click.option(
    "--audit", "audit_file", metavar="FILE", help="Add a line for each login and refusal (else stderr)."
)
@root_option("Serve one board")
@json_option("the address")
def command(
    links: tuple[str, ...],
    spec_file: str,
    *,
    listen: str,
    anyone: bool,
    token_file: str | None,
    audit_file: str | None,
    root: str | None,
    as_json: bool,
) -> None:
    """Share boards among many programs, until Ctrl-C.

    To each program the server is a board, at serve://HOST:PORT/NAME. All tools and languages work there
    unchanged. LINK is where the board is. With several, write NAME=LINK. Else NAME is that of the spec.

    A program shows its token by UNITYLINK_TOKEN, or by ?token_file=FILE in the URL. Without --token-file
    the server makes a fresh token at each start, and prints it. It may do everything.

    If a board is away, the server waits for it. Programs are told so.

    \b
    Examples:
      unitylink serve serial:/dev/ttyUSB0 arm.ul
      unitylink serve left=tcp://10.0.0.7:5555 right=tcp://10.0.0.8:5555 arm.ul --token-file tokens.toml
      UNITYLINK_TOKEN=... unitylink watch serve://127.0.0.1:7450/arm --spec arm.ul
    """
    from unitylink.server.audit import Audit
    from unitylink.server.robot import Robot
    from unitylink.server.serving import Server
    from unitylink.spec import load

    spec = part_of(load(spec_file), root)
    host, port = place_of("listen", listen)
    host = host or "127.0.0.1"
    if not is_loopback(host) and not anyone:
        raise click.UsageError(
            f"{host} is no loopback address: other machines could reach the server, and tokens go there "
            "unencrypted; if you want that, add --anyone"
        )
    if len(spec.roots) > 1:
        raise Failure(
            f"{spec_file} has several boards: {', '.join(root.name for root in spec.roots)}",
            "choose one with --root",
        )
    tokens, fresh = _tokens(token_file)
    named = _named(links, spec)
    out = open(audit_file, "a", encoding="utf-8") if audit_file else sys.stderr  # noqa: SIM115
    audit = Audit(lambda line: print(line, file=out, flush=True))
    with stopped_by_signals() as stop:
        robots = [Robot(name, link, spec, tokens, audit) for name, link in named.items()]
        with Server(robots, tokens, audit, host, port) as server:
            for robot in robots:
                robot.opened.wait(_FIRST_S)
            _announce(server, spec, spec_file, fresh, as_json)
            stop.wait()
    if audit_file:
        out.close()


def _named(links: tuple[str, ...], spec: Spec) -> dict[str, str]:
    """Return link by name."""
    named: dict[str, str] = {}
    for text in links:
        match = _NAMED.fullmatch(text)
        is_named = match is not None and ":" not in match[1]
        if not is_named and len(links) > 1:
            raise click.UsageError(f"several boards need names: write NAME={text}")
        name, link = (match[1], match[2]) if match and is_named else (spec.roots[0].name, text)
        if name in named:
            raise click.UsageError(f"two boards have the name {name}")
        named[name] = link
    return named


def _tokens(path: str | None) -> tuple[Tokens, str]:
    """Return the tokens of the file, or a fresh one for everything."""
    from unitylink.server.scopes import Rights
    from unitylink.server.tokens import Tokens, User, digest, load_tokens, new_token

    if path is not None:
        return load_tokens(path), ""
    token = os.environ.get("UNITYLINK_TOKEN") or new_token()
    if not token.isascii() or not token.isprintable() or " " in token:
        raise Failure("UNITYLINK_TOKEN is not one word of printable characters", "unset it, and one is made")
    return Tokens([(digest(token), User("owner", Rights.of(["admin"])))]), token


def _announce(server: Server, spec: Spec, spec_file: str, token: str, as_json: bool) -> None:
    """Print where the boards are, the token, and a command to try."""
    urls = {name: f"serve://{server.place}/{name}" for name in server.robots}
    if as_json:
        print_json({"urls": urls, "token": token or None}, indent=None)
    else:
        for name, robot in server.robots.items():
            away = f" (it is away: {robot.away})" if robot.away else ""
            click.echo(f"serving {robot.url} at {urls[name]}{away}")
        if token:
            click.echo(f"the token of this start, for everything:  export UNITYLINK_TOKEN={token}")
        first = next((name for name, element in spec.walk() if element.access == "READ"), None)
        if first is not None:
            click.echo(f"try:  unitylink read {next(iter(urls.values()))} {first} --spec {spec_file}")
        click.echo("Ctrl-C ends it")
    sys.stdout.flush()
