# SPDX-License-Identifier: BSD-3-Clause
"""Follower: a robot on a link, that is observed and gets actions."""

from __future__ import annotations

import logging
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from typing import TYPE_CHECKING, Any

from unitylink.connection import connect
from unitylink.errors import DeviceMismatch, LinkError, UnityLinkError, ValueRangeError
from unitylink.gym.channel import Channel
from unitylink.layer4_data import Node, ReadValue, ValueGroup, WriteValue

if TYPE_CHECKING:
    from unitylink.layer2_message import Link

_log = logging.getLogger("unitylink.lerobot")
Build = Callable[["Link"], Node]


class Follower:
    """The values of a robot as LeRobot has them: a `float` for each path of the spec, in its unit.

    `build(link)` makes the objects of the robot. Actions beyond the limits of the spec are written as the
    limit where it says `OVERFLOW=saturate`, and refused where it does not.
    """

    def __init__(self, url: str, build: Build, observed: Sequence[str], commanded: Sequence[str]) -> None:
        self._url, self._build = url, build
        self.observed, self.commanded = tuple(observed), tuple(commanded)
        self._link: Link | None = None
        self.clipped = 0
        """How many numbers of actions were beyond a limit, and have been written as the limit."""

    @property
    def connected(self) -> bool:
        return self._link is not None and not self._link.closed

    def connect(self, *, deadman_s: float = 0.0) -> None:
        """Open the link. After `deadman_s` without a sign of life, the gateware makes its outputs safe.

        Raises LinkError, and UnityLinkError if it is open already.
        """
        if self.connected:
            raise UnityLinkError(f"{self._url}: it is connected already")
        link = connect(self._url)
        try:
            self._robot = self._build(link)
            self._sensors = ValueGroup(_values(self._robot, self.observed, ReadValue), "observation")
            values = _values(self._robot, self.commanded, WriteValue)
            self._channels = [Channel.of(value, bounded=False) for value in values]
            self._commands = ValueGroup(values, "action")
            if deadman_s:
                try:
                    link.set_dead_man(deadman_s)
                except DeviceMismatch as error:
                    _log.warning("%s: without a dead-man, its outputs stay at the end: %s", self._url, error)
        except BaseException:
            link.close()
            raise
        self._link = link

    def observation(self) -> dict[str, float]:
        """Read all values that are observed, as of one moment. Raises LinkError."""
        self._check()
        seen = self._sensors.snapshot()
        return {path: float(seen[path]) for path in self.observed}

    def act(self, action: Mapping[str, Any]) -> dict[str, float]:
        """Write an action, and return what was written. Numbers may be tensors of one number.

        Raises ValueRangeError before anything is sent, if a number is missing, unknown or out of its limits.
        """
        self._check()
        if set(action) != set(self.commanded):
            missing = ", ".join(sorted(set(self.commanded) - set(action))) or "nothing"
            unknown = ", ".join(sorted(set(action) - set(self.commanded))) or "nothing"
            raise ValueRangeError(f"an action without {missing}, and with {unknown} that the robot lacks")
        written, clipped = [], 0
        for channel in self._channels:
            value, beyond = channel.taken(float(action[channel.path]))
            written.append(value)
            clipped += beyond
        self._commands.write(written)
        self.clipped += clipped
        return {channel.path: float(value) for channel, value in zip(self._channels, written, strict=True)}

    def disconnect(self) -> None:
        """Write the safe values of the spec, and close the link. It may be called twice."""
        if self.connected:
            with suppress(LinkError):  # if the line is gone, the dead-man does it
                self._robot.apply_safe()
        self.close()

    def close(self) -> None:
        """Close the link. Nothing is written."""
        link, self._link = self._link, None
        if link is not None:
            link.close()

    def _check(self) -> None:
        if not self.connected:
            raise UnityLinkError(f"{self._url}: it is not connected; call connect()")


def _values(robot: Node, paths: Sequence[str], kind: type[Any]) -> list[Any]:
    values: list[Any] = [robot[path] for path in paths]
    for value in values:
        if not isinstance(value, kind):
            raise UnityLinkError(f"{value.path} is a {value.access}; generate the package again")
    return values
