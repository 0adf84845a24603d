# SPDX-License-Identifier: BSD-3-Clause
"""The options of `serve` for the tools that people already have, and opening their streams."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TypeVar

import click

from unitylink.errors import UnityLinkError

from .serving import place_of

if TYPE_CHECKING:
    from unitylink.server.robot import Robot
    from unitylink.server.scopes import Rights
    from unitylink.streams.source import Stream

F = TypeVar("F", bound=Callable[..., Any])

_OPTIONS = (
    click.option("--plotjuggler", metavar="HOST:PORT", help="Send samples to PlotJuggler, as JSON over UDP."),
    click.option(
        "--may",
        nargs=2,
        multiple=True,
        metavar="TOOL SCOPE",
        help="What a tool may do, such as mqtt 'write j1.*'. Without it, a tool reads everything.",
    ),
)
TOOLS = ("plotjuggler",)  # those without tokens of their own users


def stream_options(command: F) -> F:
    """Give a command the options that are the fields of `StreamOptions`."""
    for option in reversed(_OPTIONS):
        command = option(command)
    return command


@dataclass(frozen=True)
class StreamOptions:
    """What was asked for. `check` raises an error if it cannot be. It opens nothing."""

    plotjuggler: str | None
    may: Sequence[tuple[str, str]]

    @property
    def any(self) -> bool:
        return self.plotjuggler is not None

    def check(self) -> None:
        for tool, _ in self.may:
            if tool not in TOOLS:
                raise click.UsageError(f"--may {tool}: there is no such tool; there are {', '.join(TOOLS)}")
            if getattr(self, tool) is None:
                raise click.UsageError(f"--may {tool}: add --{tool}, too")
            self._rights(tool)
        if self.plotjuggler is not None:
            self._plotjuggler()

    def _rights(self, tool: str) -> Rights:
        from unitylink.server.scopes import Rights

        try:
            return Rights.of([scope for name, scope in self.may if name == tool] or ["read"])
        except UnityLinkError as error:
            raise click.UsageError(f"--may {tool}: {error}") from error

    def _plotjuggler(self) -> tuple[str, int]:
        assert self.plotjuggler is not None
        host, port = place_of("plotjuggler", self.plotjuggler)
        if not port:
            raise click.UsageError(
                f"--plotjuggler {self.plotjuggler}: expected the port of PlotJuggler: 9870"
            )
        return host or "127.0.0.1", port

    @contextmanager
    def opened(self, robot: Robot, url: str) -> Iterator[list[str]]:
        """Open the streams of a robot within a `with` block, and yield lines about them. `url` reads it."""
        from unitylink.streams.plotjuggler import PlotJuggler
        from unitylink.streams.source import Source

        streams: list[Stream] = []
        lines = []
        with ExitStack() as stack:
            if self.plotjuggler is not None:
                host, port = self._plotjuggler()
                streams.append(PlotJuggler(robot.name, host, port, self._rights("plotjuggler")))
                lines.append(f"to PlotJuggler:  udp {host}:{port}")
            stack.enter_context(Source(url, robot.spec, streams))
            yield lines
