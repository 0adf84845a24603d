# SPDX-License-Identifier: BSD-3-Clause
"""Leader: a second board, whose positions are the actions of the first."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from unitylink.errors import UnityLinkError

from .follower import Build, Follower


class Leader:
    """A robot that a person moves. What it measures is the action for a follower.

    `follow` gives, for each path of an action, the path of what the leader measures. `hold` gives the
    numbers of those paths that no joint of the leader gives, such as a speed limit.
    """

    def __init__(
        self,
        url: str,
        build: Build,
        commanded: Sequence[str],
        follow: Mapping[str, str],
        hold: Mapping[str, float],
    ) -> None:
        known = set(commanded)
        if unknown := sorted((set(follow) | set(hold)) - known):
            raise UnityLinkError(
                f"{', '.join(unknown)} is no action of the follower; there are {', '.join(commanded)}"
            )
        self._follow = {path: read for path, read in follow.items() if path not in hold}
        self._hold = {path: float(value) for path, value in hold.items()}
        if open_paths := [path for path in commanded if path not in self._follow and path not in self._hold]:
            raise UnityLinkError(
                f"nothing says what {', '.join(open_paths)} gets: name what the leader measures in `follow`, "
                "or a number in `hold`"
            )
        self._order = tuple(commanded)
        self._side = Follower(url, build, tuple(dict.fromkeys(self._follow.values())), ())

    @property
    def connected(self) -> bool:
        return self._side.connected

    def connect(self) -> None:
        """Open the link. The leader gets no commands, so its dead-man is left alone. Raises LinkError."""
        self._side.connect()

    def action(self) -> dict[str, float]:
        """Return the action that follows from where the leader is now. Raises LinkError."""
        seen = self._side.observation() if self._follow else {}
        return {
            path: self._hold[path] if path in self._hold else seen[self._follow[path]] for path in self._order
        }

    def disconnect(self) -> None:
        """Close the link. Nothing is written to the leader. It may be called twice."""
        self._side.close()
