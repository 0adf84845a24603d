# SPDX-License-Identifier: BSD-3-Clause
"""`unitylink dashboard`: a robot in the browser."""

from __future__ import annotations

import sys
from collections.abc import Callable
from contextlib import ExitStack
from typing import TYPE_CHECKING, Any

import click

from unitylink.program import stopped_by_signals

from .failure import Failure
from .link_option import link_argument, open_target, spec_option
from .output import json_option, print_json
from .page_options import page_extras, page_options
from .root_option import root_option
from .tls_options import tls_files_of, tls_options

if TYPE_CHECKING:
    from unitylink.server.tokens import Tokens

_LOOK_S = 0.2  # between two looks whether the link has ended


@click.command()
@link_argument
@spec_option
@click.option(
    "--listen", metavar="[HOST:]PORT", default="127.0.0.1:0", help="Where. Port 0 takes a free one (default)."
)
@click.option("--anyone", is_flag=True, help="With --listen: other machines may reach the page.")
@click.option(
    "--name", "names", multiple=True, metavar="HOST", help="A further name of this machine in URLs."
)
@tls_options
@click.option("--token-file", metavar="FILE", help="Who may do what (unitylink token). Else one fresh token.")
@click.option("--audit", "audit_file", metavar="FILE", help="Append who did what to this file.")
@click.option(
    "--rate",
    "rate_hz",
    type=click.FloatRange(0.1, 1000),
    default=5.0,
    show_default=True,
    metavar="HZ",
    help="How often to read items without PUBLISH.",
)
@page_options
@root_option("Show one board")
@json_option("the address")
def command(
    link: str,
    *,
    spec_file: str | None,
    listen: str,
    anyone: bool,
    names: tuple[str, ...],
    tls_cert: str | None,
    tls_key: str | None,
    tls_ca: str | None,
    token_file: str | None,
    audit_file: str | None,
    rate_hz: float,
    root: str | None,
    as_json: bool,
    **extras: Any,
) -> None:
    """Serve a page with the values of a robot, until Ctrl-C.

    The page shows values, charts, alarms and the health of the link, all from the spec. It writes what may be
    written, after its user has taken control. It records, and replays recordings. Open the URL that is
    printed. It has a fresh token in it, which may do everything. With --token-file, each user logs in with a
    token of his own.

    Only this machine reaches the page. Other machines need --listen HOST:PORT and --anyone. Without
    --tls-cert, tokens go over that network unencrypted.

    \b
    Examples:
      unitylink dashboard sim:arm.ul
      unitylink dashboard serial:/dev/ttyUSB0 --spec arm.ul --listen 8080
      unitylink dashboard sim:arm.ul --urdf arm.urdf --joint waist=j1.cpos
      unitylink dashboard sim:arm.ul --listen 0.0.0.0:8443 --anyone --name lab7 --tls-cert lab7.pem
    """
    from unitylink.dashboard.opening import board_of, open_dashboard
    from unitylink.dashboard.place import read_place
    from unitylink.server.audit import complain

    place = read_place(listen, names, tls_files_of(tls_cert, tls_key, tls_ca))
    if place.exposed and not anyone:
        raise click.UsageError(
            f"--listen {listen}: other machines could reach the page; if you want that, add --anyone"
        )
    tokens, fresh = _tokens(token_file)
    with ExitStack() as stack:
        stop = stack.enter_context(stopped_by_signals())
        put = _audit(stack, audit_file)
        target = stack.enter_context(open_target(link, spec_file, quiet=True))
        if target.spec is None:
            raise Failure("the page is made from a spec", "add --spec FILE.ul")
        board = board_of(target.spec, root)
        for text in tokens.vain_scopes(board):
            complain(text)
        more = page_extras(board, target.names.source, **extras)
        page = stack.enter_context(
            open_dashboard(
                target.link, target.spec, tokens, put, place=place, root=root, read_hz=rate_hz, extras=more
            )
        )
        if as_json:
            print_json({"url": page.url, "token": fresh or None}, indent=None)
        else:
            click.echo(f"the dashboard of {link}:\n  {page.url}/{f'#token={fresh}' if fresh else ''}")
            click.echo("Ctrl-C ends it")
        if place.exposed and not place.tls:
            click.echo("warning: without --tls-cert, tokens go over the network unencrypted", err=True)
        sys.stdout.flush()
        while not stop.wait(_LOOK_S):
            target.link.check_alive()


def _tokens(path: str | None) -> tuple[Tokens, str]:
    """Return the tokens of a file, or a fresh one for everything, and this one as text."""
    from unitylink.server.scopes import Rights
    from unitylink.server.token_file import load_tokens
    from unitylink.server.tokens import Tokens, User, digest, new_token

    if path is not None:
        return load_tokens(path), ""
    token = new_token()
    return Tokens([(digest(token), User("owner", Rights.of(["admin"])))]), token


def _audit(stack: ExitStack, path: str | None) -> Callable[[str], object]:
    """Return what takes the lines of the audit log."""
    if path is None:
        return lambda _: None
    from unitylink.server.log_file import LogFile

    log = LogFile(path, "--audit")
    stack.callback(log.close)
    return log.put
