# SPDX-License-Identifier: BSD-3-Clause
"""The options of `serve` for the tools that people already have, and opening their streams."""

from __future__ import annotations

import threading
from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING

import click

from unitylink.dashboard.place import Place, is_loopback, read_place

from .bridge_zenoh import ZenohOptions, read_zenoh, usage
from .serving import place_of
from .several_options import Command, with_options
from .tls_options import exposed

if TYPE_CHECKING:
    from unitylink.server.robot import Robot
    from unitylink.server.scopes import Rights
    from unitylink.server.tls_files import TlsFiles
    from unitylink.spec.model import Instance
    from unitylink.streams.mqtt.broker import Broker
    from unitylink.streams.source import Stream
    from unitylink.zenoh.bridge.bridge import Bridge


_OPTIONS = (
    click.option(
        "--foxglove",
        metavar="[HOST:]PORT",
        help="Serve Foxglove: samples, parameters, services. Usually 8765.",
    ),
    click.option("--mqtt", metavar="URL", help="Publish values at a broker: mqtt://[USER@]HOST, or mqtts:."),
    click.option(
        "--mqtt-password-file", metavar="FILE", help="Or put the password into UNITYLINK_MQTT_PASSWORD."
    ),
    click.option("--plotjuggler", metavar="HOST:PORT", help="Send samples to PlotJuggler, as JSON over UDP."),
    click.option(
        "--zenoh",
        metavar="NAME[?connect=LOCATOR]",
        help="Also put the board on a Zenoh network, under this name, such as lab/arm1.",
    ),
    click.option(
        "--may",
        nargs=2,
        multiple=True,
        metavar="TOOL SCOPE",
        help="What a tool may do, such as mqtt 'write j1.*'. Without it, a tool reads everything.",
    ),
)
TOOLS = ("foxglove", "mqtt", "plotjuggler", "zenoh")


def stream_options(command: Command) -> Command:
    """Give a command the options that are the fields of `StreamOptions`."""
    return with_options(command, _OPTIONS)


@dataclass(frozen=True)
class StreamOptions:
    """What was asked for. `check` raises an error if it cannot be. It opens nothing."""

    foxglove: str | None
    mqtt: str | None
    mqtt_password_file: str | None
    plotjuggler: str | None
    zenoh: str | None
    may: Sequence[tuple[str, str]]
    tls: TlsFiles | None = None  # for the clients of Foxglove

    @property
    def any(self) -> bool:
        return any(getattr(self, tool) is not None for tool in TOOLS)

    def check(self, root: Instance, *, anyone: bool) -> None:
        """Raises UsageError. `root` is the robot, which has the parts that scopes name."""
        for tool, _ in self.may:
            if tool not in TOOLS:
                raise click.UsageError(f"--may {tool}: there is no such tool; there are {', '.join(TOOLS)}")
            if getattr(self, tool) is None:
                raise click.UsageError(f"--may {tool}: add --{tool}, too")
            with usage(f"--may {tool}"):
                self._rights(tool).check(root)
        if self.foxglove is not None and self._foxglove.exposed and not anyone:
            raise exposed(f"--foxglove {self.foxglove}: other machines could reach it", self.tls)
        if self.plotjuggler is not None:
            self._plotjuggler()
        if self.mqtt is not None:
            self._mqtt()
        elif self.mqtt_password_file is not None:
            raise click.UsageError("--mqtt-password-file: add --mqtt, too")
        if self.zenoh is not None:
            self._zenoh(anyone=anyone)

    def unencrypted(self) -> Iterator[str]:
        """Yield what goes over a network as it is."""
        if self.foxglove is not None and self._foxglove.exposed and not self.tls:
            yield f"what goes to and from Foxglove (--foxglove {self.foxglove})"
        if self.plotjuggler is not None and not is_loopback(self._plotjuggler()[0]):
            yield f"what goes to PlotJuggler (--plotjuggler {self.plotjuggler}), which takes nothing else"
        if self.mqtt is not None and not self._mqtt().secure and not is_loopback(self._mqtt().host):
            yield f"what goes to and from {self._mqtt()}; mqtts: is encrypted"
        if self.zenoh is not None and self._zenoh(anyone=True).exposed:
            yield f"what goes over Zenoh (--zenoh {self.zenoh}); a ?config=FILE can have TLS"

    def users(self, *, fresh: bool) -> dict[str, Rights]:
        """Return the rights of the users that are part of the server: who reads, and who is at a tool.

        `fresh` says that there is no token file. Then people at Foxglove are one user.
        """
        from unitylink.server.scopes import Rights

        users = {"streams": Rights.of(["read"])} if self.any else {}
        if self.foxglove is not None and fresh:
            users["foxglove"] = self._rights("foxglove")
        for tool in ("mqtt", "zenoh"):
            if getattr(self, tool) is not None:
                users[tool] = self._rights(tool)
        return users

    def _rights(self, tool: str) -> Rights:
        from unitylink.server.scopes import Rights

        with usage(f"--may {tool}"):
            return Rights.of([scope for name, scope in self.may if name == tool] or ["read"])

    @property
    def _foxglove(self) -> Place:
        assert self.foxglove is not None
        return read_place(self.foxglove, tls=self.tls, option="--foxglove")

    def _mqtt(self) -> Broker:
        from unitylink.streams.mqtt.broker import read_broker

        assert self.mqtt is not None
        return read_broker(self.mqtt, self.mqtt_password_file)

    def _plotjuggler(self) -> tuple[str, int]:
        assert self.plotjuggler is not None
        host, port = place_of("plotjuggler", self.plotjuggler)
        if not port:
            raise click.UsageError(
                f"--plotjuggler {self.plotjuggler}: expected the port of PlotJuggler: 9870"
            )
        return host or "127.0.0.1", port

    def _zenoh(self, *, anyone: bool) -> ZenohOptions:
        assert self.zenoh is not None
        may = [scope for tool, scope in self.may if tool == "zenoh"] or ["read"]
        return read_zenoh(self.zenoh, anyone=anyone, may=may)

    @contextmanager
    def opened(
        self, robot: Robot, url: str, tokens: Mapping[str, str], spec_file: str
    ) -> Iterator[list[str]]:
        """Open the streams of a robot within a `with` block, and yield lines about them.

        `url` reads the robot. `tokens` are those of `users`.
        """
        from unitylink.streams.foxglove.server import Foxglove
        from unitylink.streams.hand import Hand
        from unitylink.streams.mqtt.robot import Mqtt
        from unitylink.streams.plotjuggler import PlotJuggler
        from unitylink.streams.source import Source
        from unitylink.zenoh.spec_files import pack_spec

        streams: list[Stream] = []
        lines = []
        with ExitStack() as stack:
            if self.foxglove is not None:
                foxglove = Foxglove(Hand(robot), self._foxglove)
                stack.callback(foxglove.close)
                streams.append(foxglove)
                lines.append(f"for Foxglove:  {foxglove.url}/?token={tokens.get('foxglove', 'TOKEN')}")
            if self.plotjuggler is not None:
                host, port = self._plotjuggler()
                plotjuggler = PlotJuggler(robot.name, host, port, self._rights("plotjuggler"))
                stack.callback(plotjuggler.close)
                streams.append(plotjuggler)
                lines.append(f"to PlotJuggler:  udp {host}:{port}")
            if self.mqtt is not None:
                mqtt = Mqtt(Hand(robot), self._mqtt(), self._rights("mqtt"), tokens["mqtt"])
                stack.callback(mqtt.close)
                streams.append(mqtt)
                lines.append(f"at a broker:  {mqtt.broker}, unitylink/{robot.name}/...")
            if streams:
                stack.enter_context(Source(url, robot.spec, streams))
            if self.zenoh is not None:
                spec_text = pack_spec(spec_file, robot.spec.roots[0].name)
                options = self._zenoh(anyone=True)
                bridge, where = options.opened(robot, spec_text, token=tokens["zenoh"])
                stack.enter_context(_until_it_ends(bridge, f"--zenoh {self.zenoh}"))
                lines.append(f"on Zenoh:  zenoh:{bridge.keys.name}, at {where}")
            yield lines


@contextmanager
def _until_it_ends(bridge: Bridge, option: str) -> Iterator[None]:
    """Close a bridge at the end of a `with` block, or before, when it gives up, which is said for `option`.

    It gives up in a thread of Zenoh, which cannot close the session that runs it.
    """

    def close() -> None:
        from unitylink.server.audit import complain

        bridge.ended.wait()
        if bridge.trouble:
            complain(f"{option}: {bridge.trouble}")
        bridge.close()

    closer = threading.Thread(target=close, name="zenoh end", daemon=True)
    closer.start()
    try:
        yield
    finally:
        bridge.ended.set()
        closer.join()
