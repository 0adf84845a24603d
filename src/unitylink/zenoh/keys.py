# SPDX-License-Identifier: BSD-3-Clause
"""The keys of a robot on a Zenoh network. All of them are below its name, such as `lab/arm1`."""

from __future__ import annotations

import re
from dataclasses import dataclass

from unitylink.errors import UrlError, shown
from unitylink.recording.json_messages import steps

NAME_MAX = 200  # characters
_CHUNK = re.compile(r"[A-Za-z0-9_-][A-Za-z0-9_.-]*")


@dataclass(frozen=True)
class Keys:
    """The keys of one robot. Raises UrlError for a name that would match others, or that no key can have.

    >>> Keys("lab/arm1").value("leg[2].angle")
    'lab/arm1/value/leg/2/angle'
    """

    name: str

    def __post_init__(self) -> None:
        if "*" in self.name or "$" in self.name:
            raise UrlError(f"the key {shown(self.name)} has a wildcard; a robot has a name of its own")
        if len(self.name) > NAME_MAX or not all(map(_CHUNK.fullmatch, self.name.split("/"))):
            raise UrlError(
                f"the key {shown(self.name)} is no name; expected names of letters, digits, `_`, `-` and `.` "
                f"with `/` between them, at most {NAME_MAX} characters: lab/arm1"
            )

    def value(self, path: str) -> str:
        """The key of an item, which answers reads and writes."""
        return self._below("value", path)

    def set_point(self, part: str) -> str:
        """The key that takes the set-points of an item, or of all items below a part."""
        return self._below("set", part)

    def publish(self, topic: str) -> str:
        """The key of values that are sampled together."""
        return f"{self.name}/publish/{topic}"

    def words(self, bridge: str, group: int | str) -> str:
        """The key of the words that a client has subscribed to at a bridge."""
        return f"{self.name}/words/{bridge}/{group}"

    def request(self, bridge: str) -> str:
        """The key at which one bridge takes requests in words. No other bridge answers them."""
        return f"{self.name}/do/{bridge}"

    def bridge(self, bridge: str) -> str:
        """The token of a bridge that lives."""
        return f"{self.name}/bridge/{bridge}"

    def board(self, bridge: str) -> str:
        """The token of a board that answers its bridge."""
        return f"{self.name}/board/{bridge}"

    def client(self, client: str) -> str:
        """The token of a client that lives."""
        return f"{self.name}/client/{client}"

    def lease(self, part: str, holder: str) -> str:
        """The token of a write lease. The whole robot is the part `all`."""
        return f"{self.name}/lease/{'/'.join(steps(part)) or 'all'}/{holder}"

    def fixed(self, what: str) -> str:
        """The key of one of: spec, schema, hash, hello, hello_read, clock, state, stop, refused."""
        return f"{self.name}/{what}"

    def _below(self, kind: str, path: str) -> str:
        return "/".join([self.name, kind, *steps(path)])
