# SPDX-License-Identifier: BSD-3-Clause
"""The work of a node on an open link: the robot's values, its dead-man, commands in and publishes out."""

from __future__ import annotations

from contextlib import suppress
from typing import TYPE_CHECKING

from unitylink.errors import BindingError, DeviceMismatch, LinkError
from unitylink.layer4_data import Node, ValueGroup

from .dead_man import DeadManGuard
from .inbox import Inbox
from .outbox import Outbox

if TYPE_CHECKING:
    from unitylink.layer2_message import Link

    from .node import RobotNode


class RobotSession:
    """A robot on one link, from its first connection on. The line may be lost and come back.

    `again`: this node had another link before, so the device is made safe first.
    """

    def __init__(self, node: RobotNode, link: Link, tree: Node, *, again: bool) -> None:
        self.link, self.tree = link, tree
        self._node, self._say = node, node.plane.say
        values = {value.path: value for value in tree}
        missing = [path for topic in node.interface.published for path in topic.paths if path not in values]
        if missing:
            raise BindingError(
                f"{node.interface.package}: the robot has no {missing[0]}; generate both again"
            )
        if link.notice:
            self._say(1, link.notice)
        if link.unverified:
            self._say(1, f"the gateware is not verified: {link.unverified}")
        self.guard = DeadManGuard(link, node.options.deadman_s, safe=bool(self.said_safe()))
        self._make_fit(again)
        if self.guard.lacking and not again and any(value.writable for value in tree):
            self._say(0, self.guard.lacking)
        self.outbox = Outbox(tree, node.senders, node.plane.gathered, node.life)
        group = ValueGroup({path: v for path, v in values.items() if v.writable}, node.interface.robot)
        self.inbox = Inbox(
            group,
            node.complain,
            timeout_s=node.options.command_timeout_s,
            on_silence=self._silent,
            current=self._current,
            life=node.life,
        )
        try:
            tree.start_publishing(fallback=True)
            with suppress(DeviceMismatch):  # mapped memory: there is no line
                link.watch_program(node.life.patience_s)
        except BaseException:
            self.close()
            raise

    def said_safe(self) -> str:
        """Return a sentence about the SAFE values that are written, or "" if the spec has none."""
        names = [v.path for v in self.tree if v.quantity.safe is not None and v.writable]
        return f"safe values written: {', '.join(names)}" if names else ""

    def _make_fit(self, old: bool) -> None:
        """If the node is armed, arm a gateware that has tripped. Then write the safe values."""
        if self.guard.tripped and self._node.armed:
            self.guard.arm()
            self._say(1, "the dead-man had tripped and made the outputs safe; they are armed again")
        self._generation = self.link.generation  # a loss from here on: all of it once more
        if self.guard.tripped:
            self._say(1, "the dead-man has tripped: the outputs are safe until the service arm is called")
        elif old:  # first of all, because commands before the loss are old
            self.tree.apply_safe()
            said = self.said_safe() or "the spec gives no SAFE values, so its outputs stay as they are"
            self._say(1, f"the device is back; {said}; commands of before are forgotten")

    # Asked by the keeper

    def forget(self) -> None:
        self.inbox.forget()

    def stale(self) -> bool:
        self._node.make_safe_when_hanging(self)
        return not self._current() or self.guard.has_tripped()

    def renew(self) -> None:
        self.guard.renew()
        self.inbox.forget()
        self._make_fit(True)

    def close(self) -> None:
        self._node.leave(self)
        self.outbox.close()
        self.inbox.close()
        with suppress(LinkError):
            self.tree.stop_publishing()

    # Asked by the inbox

    def _current(self) -> bool:
        """Whether the device is the one that was made ready, and holds what was written since."""
        return self.link.generation == self._generation and self.link.up

    def _silent(self) -> None:
        self._node.complain("no command came for command_timeout_s: the safe values are written")
        try:
            self.tree.apply_safe()
        except LinkError as error:
            self._node.complain(f"the safe values were not written: {error}")
