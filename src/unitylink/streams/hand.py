# SPDX-License-Identifier: BSD-3-Clause
"""What tools do to a robot: each write takes the lease, writes, and gives the lease back."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator, Mapping
from typing import TYPE_CHECKING, Any

from unitylink.dashboard.desk import Desk
from unitylink.errors import LinkTimeout, OutcomeUnknown, UnknownName, shown
from unitylink.layer4_data import load_spec_objects
from unitylink.recording.json_messages import steps
from unitylink.server.stop_switch import now

if TYPE_CHECKING:
    from unitylink.layer2_message import Link
    from unitylink.server.gate import Client
    from unitylink.server.robot import Robot
    from unitylink.spec.model import Element


class Hand:
    """Takes requests from any thread, each of which waits for the board.

    A tool gives no signs of life. So it keeps no lease after a write: the outputs keep their values, and the
    next who asks can write. All methods raise AccessRefused, LeaseHeld, UnknownName, ValueRangeError, or
    another UnityLinkError if the board is away.
    """

    def __init__(self, robot: Robot) -> None:
        self.robot = robot
        self.elements = {path: element for path, element in robot.spec.walk() if element.writable}
        self._paths = {tuple(steps(path)): path for path in self.elements}
        self._link: Link | None = None
        self._desk: Desk | None = None
        self._lock = threading.Lock()  # guards the two above

    def login(self, token: str, where: str) -> Client:
        """Let a user in."""
        self.robot.board_link()
        with self.robot.switch.lock:
            return self.robot.gate.login(token, where, now())

    def present(self, client: Client) -> bool:
        """Tell whether a client is still logged in: its token has not expired."""
        with self.robot.switch.lock:
            return client in self.robot.gate.clients()

    def logout(self, client: Client) -> None:
        """Let a client go."""
        with self.robot.switch.lock:
            self.robot.gate.logout(client, now())

    def write(self, client: Client, tree: Mapping[str, Any]) -> int:
        """Write values, all together, by paths or as nested objects. Return how many there were."""
        values = dict(self._flat(tree))
        self._act(client, values, lambda desk: desk.write(client, values))
        return len(values)

    def pulse(self, client: Client, path: str) -> None:
        """Write a PULSE once."""
        self._act(client, (path,), lambda desk: desk.pulse(client, path))

    def stop(self, client: Client) -> int:
        """Make all outputs safe. Nobody writes before `arm`. Return how many outputs have a SAFE value.

        While the board is away, that is done when it comes back; it is an error all the same.
        """
        self.robot.switch.stop(client)
        return sum(one.safe is not None for one in self.elements.values())

    def arm(self, client: Client, stops: int) -> None:
        """Allow writes again. `stops` is the number of `StopSwitch.stops` that whoever asks has seen."""
        self.robot.switch.arm(client, stops=stops)

    def _at_board(self) -> Desk:
        link = self.robot.board_link()
        with self._lock:
            if self._desk is None or self._link is not link:  # the server has opened its line anew
                objects = load_spec_objects(self.robot.spec, link)
                self._link, self._desk = link, Desk(objects, self.robot.gate, self.robot.switch)
            return self._desk

    def _act(
        self, client: Client, paths: Mapping[str, Any] | tuple[str, ...], do: Callable[[Desk], None]
    ) -> None:
        desk = self._at_board()
        sent = False
        try:
            do(desk)
            sent = True
        except (LinkTimeout, OutcomeUnknown):
            sent = True  # perhaps
            raise
        finally:
            with desk.gate() as gate:
                held = gate.leases.of(client.number)
                for lease in held:
                    gate.release(client, lease.part, now())
            if sent and not held:
                # It was stopped, or lost its lease, while the write was under way. The SAFE values that came
                # then may be older than the write.
                desk.make_safe(paths)

    def _flat(self, tree: Mapping[str, Any], above: tuple[str, ...] = ()) -> Iterator[tuple[str, Any]]:
        for name, value in tree.items():
            here = (*above, *steps(name))
            if here in self._paths:
                yield self._paths[here], value
            elif isinstance(value, dict) and here:
                yield from self._flat(value, here)
            else:
                raise UnknownName(f"the robot has nothing to write at {shown('.'.join(here))}")


def pulses(elements: Mapping[str, Element]) -> list[str]:
    """Return the paths of what can be pulsed."""
    return [path for path, element in elements.items() if element.access == "PULSE"]


def set_points(elements: Mapping[str, Element]) -> dict[str, Element]:
    """Return what can be set to a value, by path."""
    return {path: one for path, one in elements.items() if one.access in ("WRITE", "READWRITE")}
