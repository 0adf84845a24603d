# SPDX-License-Identifier: BSD-3-Clause
"""The channels of the robot, for each set of rights that a client can have."""

from __future__ import annotations

import json
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from unitylink.server.scopes import Rights

    from ..topic import Topic, View


@dataclass(frozen=True)
class Channel:
    """A topic as somebody sees it. The same number always means the same values."""

    number: int
    view: View

    def description(self) -> dict[str, Any]:
        """Return what a client is told of it. Recordings have the same names and schemas."""
        title = "unitylink" + self.view.topic.name.replace("/", ".")
        return {
            "id": self.number,
            "topic": self.view.topic.name,
            "encoding": "json",
            "schemaName": title,
            "schemaEncoding": "jsonschema",
            "schema": json.dumps({"title": title, **self.view.schema}, separators=(",", ":")),
        }

    def message(self, row: Sequence[int]) -> bytes:
        return self.view.text(self.view.plain(row)).encode()


class Channels:
    """All channels. `newest` has the last sample of each topic: its time in s since 1970, and its row."""

    def __init__(self) -> None:
        self.topics: tuple[Topic, ...] = ()
        self.newest: dict[Topic, tuple[float, Sequence[int]]] = {}
        self._found: dict[tuple[Topic, Rights], Channel | None] = {}
        self._numbers: dict[tuple[str, tuple[str, ...]], int] = {}

    def replace(self, topics: Iterable[Topic]) -> None:
        """The board has come, perhaps with other topics."""
        self.topics = tuple(topics)
        self.newest.clear()
        self._found.clear()

    def find(self, topic: Topic, rights: Rights) -> Channel | None:
        """Return the channel of a topic for somebody with these rights, or None if he sees nothing of it."""
        key = topic, rights
        if key not in self._found:
            view = topic.view(rights)
            self._found[key] = None if view is None else Channel(self._number(view), view)
        return self._found[key]

    def all(self, rights: Rights) -> list[Channel]:
        """Return the channels for somebody with these rights."""
        found = (self.find(topic, rights) for topic in self.topics)
        return [channel for channel in found if channel is not None]

    def values(self, rights: Rights) -> dict[str, Any]:
        """Return the newest values that somebody with these rights sees, by path."""
        newest: dict[str, Any] = {}
        for channel in self.all(rights):
            if (sample := self.newest.get(channel.view.topic)) is not None:
                newest.update(zip(channel.view.paths, channel.view.plain(sample[1]), strict=True))
        return newest

    def _number(self, view: View) -> int:
        return self._numbers.setdefault((view.topic.name, view.paths), len(self._numbers) + 1)
