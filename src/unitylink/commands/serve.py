# SPDX-License-Identifier: BSD-3-Clause
"""`unitylink serve`: one board, many programs."""

from __future__ import annotations

import os
import re
import sys
import tempfile
from contextlib import ExitStack
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import click

from unitylink.dashboard.place import Place, is_loopback
from unitylink.program import stopped_by_signals

from .failure import Failure
from .output import json_option, print_json
from .page_options import page_extras, page_options
from .root_option import part_of, root_option
from .serving import place_of
from .stop_option import stop_file_option
from .stream_options import StreamOptions, stream_options
from .tls_options import exposed, tls_files_of, tls_options

if TYPE_CHECKING:
    from threading import Event

    from unitylink.dashboard.extras import Extras
    from unitylink.server.serving import Server
    from unitylink.server.tokens import Tokens
    from unitylink.spec.model import Spec

_NAMED = re.compile(r"([\w.-]+)=(.+)")
_METRICS_S = 5.0
_FIRST_S = 5.0  # how long the announcement waits for the first attempts to open the links


@click.command()
@click.argument("links", metavar="LINK...", nargs=-1)
@click.argument("spec_file", metavar="SPEC")
@click.option("--listen", metavar="[HOST:]PORT", default="127.0.0.1:7450", show_default=True)
@click.option("--anyone", is_flag=True, help="Listen where other machines reach it. See --tls-cert.")
@tls_options
@click.option(
    "--token-file",
    metavar="FILE",
    help="Who may do what; `unitylink token` writes it. Else a fresh token is made.",
)
@click.option(
    "--audit", "audit_file", metavar="FILE", help="Add a line for each login and refusal (else stderr)."
)
@click.option(
    "--lease-silence",
    metavar="SECONDS",
    type=click.FloatRange(0.1, 86400),
    help="Who sends nothing for so long loses its leases, and its outputs become safe.",
)
@click.option(
    "--page", metavar="[HOST:]PORT", help="Also serve the board's page for browsers (unitylink dashboard)."
)
@page_options
@stream_options
@click.option(
    "--metrics", "metrics_file", metavar="FILE", help="Write the counters there every 5 s, for Prometheus."
)
@stop_file_option
@click.option(
    "--check-config", is_flag=True, help="Check the arguments and the files, print the URLs, and end."
)
@root_option("Serve one board")
@json_option("the address")
def command(
    links: tuple[str, ...],
    spec_file: str,
    *,
    listen: str,
    anyone: bool,
    tls_cert: str | None,
    tls_key: str | None,
    tls_ca: str | None,
    token_file: str | None,
    audit_file: str | None,
    lease_silence: float | None,
    page: str | None,
    foxglove: str | None,
    mqtt: str | None,
    mqtt_password_file: str | None,
    plotjuggler: str | None,
    zenoh: str | None,
    may: tuple[tuple[str, str], ...],
    metrics_file: str | None,
    stop_file: str | None,
    check_config: bool,
    root: str | None,
    as_json: bool,
    **extras: Any,
) -> None:
    """Share boards among many programs, until Ctrl-C.

    To each program the server is a board, at serve://HOST:PORT/NAME. All tools and languages work there
    unchanged. LINK is where the board is. With several, write NAME=LINK. Else NAME is that of the spec.

    A program shows its token by UNITYLINK_TOKEN, or by ?token_file=FILE in the URL. Without --token-file
    the server makes a fresh token at each start, and prints it. It may do everything.

    If a board is away, the server waits for it. Programs are told so.

    With --tls-cert all connections of clients are encrypted, also those of the page and of Foxglove.
    Programs say whom they trust: ?tls_ca=FILE in the URL.

    With --page, people share the board with the programs: at any time, one of them all writes a part. The
    page is for one board, which must be there at the start. With --foxglove, --mqtt, --plotjuggler and
    --zenoh, other tools and machines see the board, too.

    \b
    Examples:
      unitylink serve serial:/dev/ttyUSB0 arm.ul
      unitylink serve sim:arm.ul arm.ul --page 8080
      unitylink serve sim:arm.ul arm.ul --foxglove 8765 --plotjuggler 127.0.0.1:9870
      unitylink serve sim:arm.ul arm.ul --zenoh lab/arm1 --may zenoh write
      unitylink serve left=tcp://10.0.0.7:5555 right=tcp://10.0.0.8:5555 arm.ul --token-file tokens.toml
      unitylink serve serial:/dev/ttyUSB0 arm.ul --token-file tokens.toml --check-config
      unitylink serve sim:arm.ul arm.ul --listen 0.0.0.0:7450 --anyone --tls-cert cert.pem --tls-key key.pem
      UNITYLINK_TOKEN=... unitylink watch "serve://lab:7450/arm?tls_ca=cert.pem" --spec arm.ul
      UNITYLINK_TOKEN=... unitylink watch serve://127.0.0.1:7450/arm --spec arm.ul
    """
    from unitylink.dashboard.place import read_place
    from unitylink.server.audit import Audit, complain
    from unitylink.server.log_file import LogFile, check_writable
    from unitylink.server.robot import Robot
    from unitylink.server.scopes import Rights
    from unitylink.server.serving import Server, allow_files
    from unitylink.server.stop_file import StopFile
    from unitylink.server.tokens import Tokens, User, new_token
    from unitylink.spec import load

    if not links:
        raise click.UsageError(
            "give both: LINK, where the board is, and SPEC, the file that says what it has; for example "
            "unitylink serve serial:/dev/ttyUSB0 arm.ul"
        )
    spec = part_of(load(spec_file), root)
    host, port = place_of("listen", listen)
    host = host or "127.0.0.1"
    tls = tls_files_of(tls_cert, tls_key, tls_ca)
    if not is_loopback(host) and not anyone:
        raise exposed(f"{host} is no loopback address: other machines could reach the server", tls)
    if len(spec.roots) > 1:
        raise Failure(
            f"{spec_file} has several boards: {', '.join(root.name for root in spec.roots)}",
            "choose one with --root",
        )
    tokens, fresh = _tokens(token_file)
    for text in tokens.vain_scopes(spec.roots[0]):
        complain(text)
    streams = StreamOptions(foxglove, mqtt, mqtt_password_file, plotjuggler, zenoh, may, tls)
    streams.check(spec.roots[0], anyone=anyone)
    known = len(tokens)
    own = {"page": Rights.of(["read"])} if page is not None else {}  # users that are part of this server
    own |= streams.users(fresh=bool(fresh))
    own_tokens = {name: new_token() for name in own}
    insiders = Tokens(())
    for name, rights in own.items():
        insiders = insiders.with_user(own_tokens[name], User(name, rights))
        tokens = tokens.with_user(own_tokens[name], User(name, rights))
    named = _named(links, spec)
    place = read_place(page, tls=tls, option="--page") if page is not None else None
    if place is not None and place.exposed and not anyone:
        raise exposed(f"--page {page}: other machines could reach the page", tls)
    if own_tokens and len(named) > 1:
        raise click.UsageError("--page and streams are for one board; start a server for each")
    if stop_file is not None and len(named) > 1:
        raise click.UsageError("--stop-file is for one board; start a server for each")
    memory = StopFile(stop_file) if stop_file is not None else None
    more = page_extras(spec.roots[0], spec_file, **extras)
    for option, path in (("--audit", audit_file), ("--metrics", metrics_file)):
        if path is not None:
            check_writable(path, option)
    if check_config:
        return _report_check(named, host, port, known, tls=tls is not None)
    log = LogFile(audit_file, "--audit") if audit_file else None
    audit = Audit(log.put if log else lambda line: print(line, file=sys.stderr, flush=True), apart=True)
    allow_files()
    with stopped_by_signals() as stop, ExitStack() as boards, ExitStack() as pages:
        boards.callback(audit.close)
        robots = [
            Robot(name, link, spec, tokens, audit, silence_s=lease_silence or 0.0, memory=memory)
            for name, link in named.items()
        ]
        for robot in robots:
            boards.callback(robot.close)  # also if the server cannot begin, because its port is in use
        with Server(robots, tokens, audit, host, port, tls=tls, own=insiders) as server:
            for robot in robots:
                robot.opened.wait(_FIRST_S)
            page_url, lines = None, []
            if place is not None:
                reads = _url_for(pages, server, own_tokens["page"])
                page_url = _serve_page(pages, server, reads, spec, place=place, extras=more)
            if streams.any:
                reads = _url_for(pages, server, own_tokens["streams"])
                opened = streams.opened(robots[0], reads, own_tokens, spec_file)
                lines = pages.enter_context(opened)
            trust = f"?tls_ca={tls_cert}" if tls else ""
            _announce(server, spec, spec_file, fresh, as_json, trust=trust, page=page_url, streams=lines)
            how = f"{'is' if tls else 'is not'} encrypted"
            for reached in (host, server.place), (place.host if place else host, page_url):
                if reached[1] and not is_loopback(reached[0]):
                    click.echo(
                        f"warning: other machines can reach {reached[1]}; what they send {how}", err=True
                    )
            for what in streams.unencrypted():
                click.echo(f"warning: not encrypted: {what}", err=True)
            _write_metrics_until(stop, metrics_file, server)
            pages.close()  # before the link
    if log:
        log.close()
    return None


def _write_metrics_until(stop: Event, file: str | None, server: Server) -> None:
    """Write the metrics until `stop`. If that fails, it is said once, and the server goes on."""
    from unitylink.server.audit import complain
    from unitylink.server.metrics import write_metrics

    failing = False
    while not stop.is_set():
        try:
            if file:
                write_metrics(file, server.report())
            failing = False
        except OSError as error:
            if not failing:
                complain(f"--metrics {file}: {error.strerror or error}; it is tried again")
            failing = True
        stop.wait(_METRICS_S if file else None)


def _report_check(named: dict[str, str], host: str, port: int, tokens: int, *, tls: bool) -> None:
    """Check the links, and print what would be served. No link is opened."""
    from unitylink.connection import check_link

    for name, link in named.items():
        check_link(link)
        click.echo(f"{link} at serve://{host}:{port}/{name}")
    click.echo(f"{tokens} tokens" if tokens != 1 else "1 token")
    if tls:
        click.echo("encrypted")


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
    from unitylink.errors import UnityLinkError
    from unitylink.server.scopes import Rights
    from unitylink.server.token_file import load_tokens
    from unitylink.server.tokens import Tokens, User, chosen_token, digest, new_token

    if path is not None:
        return load_tokens(path), ""
    try:
        token = chosen_token(os.environ.get("UNITYLINK_TOKEN") or new_token())
    except UnityLinkError as error:
        raise Failure(f"UNITYLINK_TOKEN: {error}", "unset it, and one is made") from error
    return Tokens([(digest(token), User("owner", Rights.of(["admin"])))]), token


def _url_for(opened: ExitStack, server: Server, token: str) -> str:
    """Return the URL by which the page or the streams read the only board, until `opened` is closed."""
    (robot,) = server.robots.values()
    file = opened.enter_context(tempfile.NamedTemporaryFile("w", encoding="ascii"))  # noqa: SIM115
    file.write(token)
    file.flush()
    return f"serve://{server.own_place}/{robot.name}?token_file={file.name}"


def _serve_page(
    pages: ExitStack, server: Server, url: str, spec: Spec, *, place: Place, extras: Extras
) -> str:
    """Serve the page of the only board, read by `url`, until `pages` is closed. Return its own URL."""
    from unitylink.connection import connect
    from unitylink.dashboard.opening import page_of

    (robot,) = server.robots.values()
    reader = pages.enter_context(connect(url, reconnect=True))
    extras = replace(extras, report=server.report)
    opened = page_of(
        robot.board_link(), spec, robot.gate, robot.switch, reader=reader, place=place, extras=extras
    )
    return pages.enter_context(opened).url


def _announce(
    server: Server,
    spec: Spec,
    spec_file: str,
    token: str,
    as_json: bool,
    *,
    trust: str,
    page: str | None,
    streams: list[str],
) -> None:
    """Print where the boards are, the token, and a command to try.

    `trust` is what the URLs need for TLS.
    """
    urls = {name: f"serve://{server.place}/{name}{trust}" for name in server.robots}
    if as_json:
        print_json({"urls": urls, "token": token or None, "page": page}, indent=None)
    else:
        for name, robot in server.robots.items():
            away = f" (it is away: {robot.away})" if robot.away else ""
            click.echo(f"serving {robot.url} at {urls[name]}{away}")
        for line in streams:
            click.echo(line)
        if page:
            click.echo(f"its page:  {page}/" + (f"#token={token}" if token else ""))
        if token:
            click.echo(f"the token of this start, for everything:  export UNITYLINK_TOKEN={token}")
        first = next((name for name, element in spec.walk() if element.access == "READ"), None)
        if first is not None:
            url = next(iter(urls.values()))
            quoted = f'"{url}"' if trust else url
            click.echo(f"try:  unitylink read {quoted} {first} --spec {spec_file}")
        click.echo("Ctrl-C ends it")
    sys.stdout.flush()
