# SPDX-License-Identifier: BSD-3-Clause
"""`unitylink bridge zenoh`: the options, and the bridge between a board and a Zenoh network."""

from __future__ import annotations

import re
import sys
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING
from urllib.parse import parse_qsl

import click

from unitylink.dashboard.place import is_loopback
from unitylink.errors import UnityLinkError

from .failure import Failure
from .several_options import Command, with_options
from .stop_option import stop_file_option

if TYPE_CHECKING:
    from unitylink.server.robot import Robot
    from unitylink.server.scopes import Rights
    from unitylink.spec.model import Spec
    from unitylink.zenoh.bridge.bridge import Bridge
    from unitylink.zenoh.keys import Keys
    from unitylink.zenoh.session import Network


_LOCATOR = re.compile(r"[a-z_]+/(?:\[(?P<six>[^\]]+)\]|(?P<host>[^:/?#]+)):(?P<port>\d+)(?P<rest>[?#].*)?")
_LOOK_S = 0.2
_WHERE = ("connect", "listen", "config")
_OPTIONS = (
    click.option(
        "--key", metavar="NAME", help="Of the robot on Zenoh: lab/arm1. By default unitylink/ROBOT."
    ),
    click.option("--connect", metavar="LOCATOR", help="The router of the network: tcp/10.0.0.7:7447."),
    click.option("--listen", metavar="LOCATOR", help="Be the router of the network: tcp/127.0.0.1:7447."),
    click.option("--zenoh-config", metavar="FILE", help="A configuration of Zenoh, for TLS for example."),
    click.option("--anyone", is_flag=True, help="Listen where other machines reach it."),
    click.option(
        "--may",
        multiple=True,
        metavar="SCOPE",
        help="What clients on Zenoh may do: read, 'write j1.*', arm. Without it, all of that.",
    ),
    click.option("--audit", "audit_file", metavar="FILE", help="Add a line for each lease and refusal."),
    stop_file_option,
)


@contextmanager
def usage(option: str) -> Iterator[None]:
    """Say which option of the command line an error is about."""
    try:
        yield
    except UnityLinkError as error:
        raise click.UsageError(f"{option}: {error}") from None


def zenoh_options(command: Command) -> Command:
    """Give a command the options that are the fields of `ZenohOptions`."""
    return with_options(command, _OPTIONS)


@dataclass(frozen=True)
class ZenohOptions:
    """What was asked for. `check` raises an error if it cannot be. It opens nothing."""

    key: str | None
    connect: str | None
    listen: str | None
    zenoh_config: str | None
    anyone: bool
    may: Sequence[str]
    audit_file: str | None
    stop_file: str | None = None

    @property
    def given(self) -> list[str]:
        """The options that were given."""
        named = {"zenoh_config": "--zenoh-config", "audit_file": "--audit", "stop_file": "--stop-file"}
        return [named.get(name, f"--{name}") for name, value in vars(self).items() if value]

    def check(self) -> None:
        """Raises UsageError for a place that is none, or that others would reach."""
        if sum(one is not None for one in (self.connect, self.listen, self.zenoh_config)) > 1:
            raise click.UsageError("--connect, --listen and --zenoh-config: one of them says where")
        if self.listen is not None and (why := unfit(self.listen, anyone=self.anyone, remedy="add --anyone")):
            raise click.UsageError(f"--listen {self.listen}: {why}")
        self.rights()

    @property
    def exposed(self) -> bool:
        """Whether other machines reach the robot, and what goes there is not encrypted."""
        match = _LOCATOR.fullmatch(self.listen or self.connect or "")
        if match is None or match[0].startswith(("tls/", "quic/")):
            return False
        return not is_loopback(match["six"] or match["host"])

    def rights(self) -> Rights:
        """Return what all clients may do."""
        from unitylink.server.scopes import Rights

        with usage("--may"):
            return Rights.of(self.may or ["write", "arm"])

    def networks(self) -> list[tuple[Network, Network]]:
        """Return ways onto the network, to be tried in turn: for requests, and for publishes.

        Without an option, the first bridge of a machine is its router.
        """
        from unitylink.zenoh.session import ROUTER, Network

        if self.zenoh_config is not None:
            same = Network(config=self.zenoh_config)
            return [(same, same)]
        if self.connect is not None:
            same = Network(connect=self.connect)
            return [(same, same)]
        ways = []
        listen = self.listen or ROUTER
        inside = listen.replace("/0.0.0.0:", "/127.0.0.1:").replace("/[::]:", "/[::1]:")
        ways.append((Network(listen=listen), Network(connect=inside)))
        if self.listen is None:
            ways.append((Network(connect=ROUTER), Network(connect=ROUTER)))
        return ways

    def keys(self, robot: str) -> Keys:
        """Return the keys of a robot, by default those of its own name. Raises UrlError for a wildcard."""
        from unitylink.zenoh.keys import Keys

        return Keys(self.key or f"unitylink/{robot}")

    def opened(
        self,
        robot: Robot,
        spec_text: str,
        *,
        token: str,
        reading: str = "",
    ) -> tuple[Bridge, str]:
        """Return the bridge of `robot` (its class tells the rest), and the place of its router."""
        from unitylink.errors import LinkNotFound
        from unitylink.zenoh.bridge.bridge import Bridge

        keys, ways = self.keys(robot.spec.roots[0].name), self.networks()
        while True:
            network, publishing = ways.pop(0)
            try:
                bridge = Bridge(
                    robot,
                    keys,
                    network,
                    publishing,
                    spec_text,
                    token=token,
                    reading=reading,
                )
            except LinkNotFound:
                if not ways:
                    raise
            else:
                return bridge, publishing.connect or publishing.config


def unfit(locator: str, *, anyone: bool, remedy: str) -> str:
    """Return why a router cannot be, or should not be, at a place, or an empty text.

    `remedy` is how a user says that `anyone` may reach it.
    """
    match = _LOCATOR.fullmatch(locator)
    if match is None:
        return "this is no place of Zenoh; it looks like tcp/127.0.0.1:7447"
    if int(match["port"]) == 0:
        return "give the port that clients connect to"
    if not anyone and not is_loopback(match["six"] or match["host"]):
        return (
            "other machines could reach the robot, and what goes there is not encrypted; if you want that, "
            f"{remedy}, or say it with TLS in a file of Zenoh"
        )
    return ""


def read_zenoh(text: str, *, anyone: bool, may: Sequence[str]) -> ZenohOptions:
    """Return what NAME[?connect=LOCATOR] says, the `--zenoh` of `unitylink serve`. Raises UsageError."""
    name, _, query = text.partition("?")
    where: dict[str, str] = {}
    for key, value in parse_qsl(query, keep_blank_values=True):
        if key not in _WHERE or not value or where:
            raise click.UsageError(
                f"--zenoh {text}: expected NAME, or NAME with one of ?connect=LOCATOR, ?listen=LOCATOR and "
                "?config=FILE"
            )
        where[key] = value
    options = ZenohOptions(
        name, where.get("connect"), where.get("listen"), where.get("config"), anyone, may, None
    )
    try:
        options.keys("")
        options.check()
    except (click.UsageError, UnityLinkError) as error:
        raise click.UsageError(f"--zenoh {text}: {error}") from None
    return options


def run_zenoh(link: str, spec: Spec, file: str, options: ZenohOptions) -> int:
    """Serve the robot until a signal, or until something ends it. Return the exit code."""
    from unitylink.program import stopped_by_signals
    from unitylink.server.audit import Audit
    from unitylink.server.log_file import LogFile, check_writable
    from unitylink.server.robot import Robot
    from unitylink.server.scopes import Rights
    from unitylink.server.stop_file import StopFile
    from unitylink.server.tokens import Tokens, User, digest, new_token
    from unitylink.zenoh.spec_files import pack_spec

    root = spec.roots[0].name
    options.keys(root)  # a name that cannot be is said before a board is touched
    if options.audit_file is not None:
        check_writable(options.audit_file, "--audit")
    memory = StopFile(options.stop_file) if options.stop_file is not None else None
    token, reading = new_token(), new_token()
    rights = options.rights()
    with usage("--may"):
        rights.check(spec.roots[0])
    readers = Rights.of(f"read {part}".strip() for part in rights.parts("read"))
    users = [
        (token, User("zenoh", rights)),
        (reading, User("zenoh readers", readers)),
    ]
    tokens = Tokens([(digest(one), user) for one, user in users])
    with stopped_by_signals() as stop, ExitStack() as stack:
        log = LogFile(options.audit_file, "--audit") if options.audit_file else None
        if log is not None:
            stack.callback(log.close)
        audit = Audit(log.put if log else lambda line: print(line, file=sys.stderr, flush=True), apart=True)
        stack.callback(audit.close)
        robot = Robot(root, link, spec, tokens, audit, memory=memory)
        stack.callback(robot.close)
        robot.start()
        bridge, where = options.opened(robot, pack_spec(file, root), token=token, reading=reading)
        stack.enter_context(bridge)
        _announce(spec, bridge.keys.name, where, robot.url)
        while not stop.wait(_LOOK_S) and not bridge.ended.is_set():
            pass
        trouble = bridge.trouble
    if trouble:
        raise Failure(trouble, "give each robot a --key of its own")
    return 0


def _announce(spec: Spec, name: str, where: str, link: str) -> None:
    from unitylink.zenoh.session import ROUTER

    way = "" if where == ROUTER else f"?connect={where}"
    click.echo(f"{link} is {name} on Zenoh, at {where}")
    first = next((path for path, element in spec.walk() if element.access == "READ"), None)
    if first is not None:
        click.echo(f'try:  unitylink read "zenoh:{name}{way}" {first}')
    click.echo("Ctrl-C ends it")
    sys.stdout.flush()
