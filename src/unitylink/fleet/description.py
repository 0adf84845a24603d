# SPDX-License-Identifier: BSD-3-Clause
"""What a fleet is: its robots, where each board is, its key on the network, and what clients may do there."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from urllib.parse import urlencode

from unitylink.errors import FleetError
from unitylink.zenoh.session import ROUTER, Network

NAME = "fleet"  # of a fleet that has none
ROUTER_NAME = "router"  # in its certificate
ROBOT_PREFIX = "robot-"  # of the name of a robot in its certificate
RIGHTS = ("write", "arm")  # as `unitylink bridge zenoh` gives without --may


@dataclass(frozen=True)
class FleetRobot:
    """One robot. Paths in `link` and `spec` are relative to the folder of the description.

    `may` are scopes, such as `write j1.*`: the most that any client on the network may do. `writers` and
    `readers` are the names in the certificates of those who may (docs/fleet.md, security).
    """

    name: str
    link: str
    spec: str
    key: str
    root: str = ""
    may: tuple[str, ...] = RIGHTS
    writers: tuple[str, ...] = ()
    readers: tuple[str, ...] = ()


@dataclass(frozen=True)
class Fleet:
    """Robots, and the network on which they are.

    Without `connect` and `zenoh_config`, the program that runs the fleet is the router, at `router`. `audit`
    is a folder with a log for each robot, `stops` one with a file for each robot that is stopped, `security`
    one with what `unitylink fleet security` made.
    """

    file: Path
    name: str
    robots: tuple[FleetRobot, ...]
    router: str = ROUTER
    connect: str = ""
    zenoh_config: str = ""
    anyone: bool = False
    audit: str = ""
    stops: str = ""
    security: str = ""

    @property
    def folder(self) -> Path:
        """Where the paths of the description begin."""
        return self.file.resolve().parent

    @property
    def is_router(self) -> bool:
        """Whether the program that runs the fleet is the router of the network."""
        return not self.connect and not self.zenoh_config

    def place(self, path: str) -> Path:
        """Return where a path of the description is."""
        return self.folder / path

    @property
    def names(self) -> tuple[str, ...]:
        """The names of the robots, in the order of the description."""
        return tuple(robot.name for robot in self.robots)

    def router_network(self) -> Network:
        """How the router opens its session."""
        return Network(config=self.secret(ROUTER_NAME)) if self.security else Network(listen=self.router)

    def network(self, who: str = "") -> Network:
        """How a program on this machine gets on the network.

        `who` is its name in its certificate, which the fleet needs if it has `security`. Raises FleetError.
        """
        if self.security:
            if not who:
                raise FleetError(f"{self.file}: the network is encrypted; say who you are: --as NAME")
            return Network(config=self.secret(who))
        if self.zenoh_config:
            return Network(config=str(self.place(self.zenoh_config)))
        return Network(connect=self.connect or inside(self.router))

    def url(self, robot: FleetRobot, *, who: str = "", name: str = "") -> str:
        """Return the link of a program on this machine to a robot. `name` is what others see of it."""
        network = self.network(who)
        way = {"config": network.config} if network.config else {"connect": network.connect}
        return f"zenoh:{robot.key}?{urlencode({**({'name': name} if name else {}), **way}, safe='/:')}"

    def secret(self, who: str) -> str:
        """Return the file of Zenoh for a name in a certificate."""
        file = self.place(self.security) / f"{who}.json5"
        if not file.is_file():
            raise FleetError(f"{file} is not there: unitylink fleet security {self.file}")
        return str(file)


def inside(locator: str) -> str:
    """Return how a program of this machine reaches a router that listens at a locator.

    >>> inside("tcp/0.0.0.0:7447")
    'tcp/127.0.0.1:7447'
    """
    return locator.replace("/0.0.0.0:", "/127.0.0.1:").replace("/[::]:", "/[::1]:")
