# SPDX-License-Identifier: BSD-3-Clause
"""The dead-men of the devices behind a part of a robot."""

from __future__ import annotations

from typing import TYPE_CHECKING

from unitylink.layer3_hardware.arguments import positive

if TYPE_CHECKING:
    from unitylink.layer2_message import Link


class DeadMen:
    """The dead-men of several links, asked and set together. See `Link.dead_man`.

    >>> robot.dead_man.start(0.1)                  # doctest: +SKIP
    >>> if robot.dead_man.tripped:                 # doctest: +SKIP
    ...     robot.dead_man.arm()
    """

    def __init__(self, links: tuple[Link, ...]) -> None:
        self.links = links

    def start(self, silence_s: float) -> None:
        """Let the devices write the SAFE values after `silence_s` without a sign of life. 0: never.

        Raises DeviceMismatch on a classic link, or if the gateware has no dead-man.
        """
        time_s = positive("dead-man: silence_s", silence_s)
        for link in self.links:
            link.set_dead_man(time_s)

    def arm(self) -> None:
        """Allow writes again after a dead-man has tripped."""
        for link in self.links:
            link.arm()

    @property
    def tripped(self) -> bool:
        """Ask whether a dead-man has tripped. The result is False on classic links, which have none."""
        states = [link.dead_man() for link in self.links]
        return any(state is not None and state.tripped for state in states)

    @property
    def running(self) -> bool:
        """Ask whether the dead-man of every link runs."""
        states = [link.dead_man() for link in self.links]
        return all(state is not None and state.running for state in states)
