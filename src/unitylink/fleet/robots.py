# SPDX-License-Identifier: BSD-3-Clause
"""The robots of a fleet for a program: by name, and values of several of them together."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING, Any

from unitylink.connection import connect
from unitylink.errors import FleetError, UnknownName
from unitylink.layer4_data import Node, ValueGroup
from unitylink.zenoh.link import ZenohLink

from .description import Fleet
from .reader import read_fleet

if TYPE_CHECKING:
    from typing_extensions import Self


class Robots(Mapping[str, Node]):
    """The robots of a fleet that runs, by name: `robots["arm1"]["x.position"].read()`.

    `file` is the description of the fleet. `names` are those of the robots that are wanted, by default all.
    `who` is the name in the certificate of this program, if the fleet has `security`. Raises LinkError if one
    of them cannot be reached.

    >>> with Robots("fleet.toml") as robots:                                       # doctest: +SKIP
    ...     robots.group("x.target").write(dict.fromkeys(robots, 100))
    """

    def __init__(self, file: str | Path, *names: str, who: str = "") -> None:
        self.fleet: Fleet = read_fleet(file)
        unknown = [name for name in names if name not in self.fleet.names]
        if unknown:
            raise FleetError(f"{file}: no robot {unknown[0]}; there are {', '.join(self.fleet.names)}")
        self._nodes: dict[str, Node] = {}
        with ExitStack() as stack:
            for robot in self.fleet.robots:
                if not names or robot.name in names:
                    link = stack.enter_context(connect(self.fleet.url(robot, who=who)))
                    assert isinstance(link, ZenohLink)
                    self._nodes[robot.name] = link.robot()
            self._links = stack.pop_all()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Close all links. The outputs keep their values."""
        self._links.close()

    def __getitem__(self, name: str) -> Node:
        try:
            return self._nodes[name]
        except KeyError:
            raise UnknownName(f"no robot {name}; there are {', '.join(self._nodes)}") from None

    def __iter__(self) -> Iterator[str]:
        return iter(self._nodes)

    def __len__(self) -> int:
        return len(self._nodes)

    def group(self, path: str) -> ValueGroup:
        """Return the same item of all robots as one group. The keys are the names of the robots.

        Its `write` asks all boards at the same time, best effort: no gateware here writes at a given time.
        Write once before, so that each bridge has given the lease. `snapshot` reads all at the same time.
        """
        values: dict[str, Any] = {name: node[path] for name, node in self._nodes.items()}
        return ValueGroup(values, path)
