# SPDX-License-Identifier: BSD-3-Clause
"""What happens to a TosNet network while a program runs: it is cut and mended, nodes leave and come back."""

from __future__ import annotations

import logging
import threading
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal, Protocol

from unitylink import protocol
from unitylink.errors import LinkClosed, LinkError, NetworkError, NetworkHalted, NetworkOffline, NodeLost

from .arguments import wholes
from .tosnet_status import NetworkNode, TosNetStatus

if TYPE_CHECKING:
    from unitylink.layer2_message import Link

_log = logging.getLogger("unitylink.tosnet")


class Network(Protocol):
    """What a watch needs of a TosNetProxy."""

    base: int
    control: Link

    def nodes(self) -> tuple[NetworkNode, ...]:
        """Read the list of the nodes that are in the ring, in ring order."""


NetworkEventKind = Literal["offline", "online", "halted", "node_lost", "node_back", "ring_lost", "ring_back"]


@dataclass(frozen=True)
class NetworkEvent:
    """An event of a TosNet network. `error` is what a write would raise, or None for good news."""

    kind: NetworkEventKind
    """`offline`: nothing is exchanged. `online`: it is again, or it was away for a moment. `halted`: too many
    cycles had no commit. `node_lost`: a node is not in the ring. `node_back`: it is there again. `ring_lost`:
    one of two rings is broken, and the other one goes on. `ring_back`: both run again."""
    node: int | None
    """The node's id, of `node_lost` and `node_back`; the ring, 0 or 1, of `ring_lost` and `ring_back`."""
    time_s: float
    """When it was seen, by `Link.now_s()`."""
    text: str
    """What happened, in words."""
    error: NetworkError | None


NetworkCallback = Callable[[NetworkEvent], None]


def lost(nodes: Iterable[int], address: int) -> NodeLost:
    """Return the error that names nodes that are not in the ring."""
    ids = tuple(nodes)
    names = ", ".join(map(str, ids))
    which = f"node {names} is" if len(ids) == 1 else f"nodes {names} are"
    error = NodeLost(f"{which} not in the ring; see to its power and its fibres", address=address)
    error.nodes = ids
    return error


class NetworkWatch:
    """Compares a network with what it was. `nodes` are the ids that should be there.

    Without `nodes`, those count that are there at the first look. A look reads two words, and the list of the
    nodes if the ring was found anew.
    """

    def __init__(self, network: Network, nodes: Iterable[int] = ()) -> None:
        self._network = network
        self._there = {*wholes("tosnet: nodes", nodes)}
        self._status = TosNetStatus.decode(1 << protocol.TOSNET_STATUS_ONLINE_BIT)
        self._resets: int | None = None
        self._rings_down: set[int] = set()

    def look(self) -> list[NetworkEvent]:
        """Return what has happened since the last look. An error of the link is raised."""
        network = self._network
        where = (protocol.TOSNET_STATUS, protocol.TOSNET_RESET_COUNTER)
        words = network.control.read_many([network.base + one for one in where])
        status, resets = TosNetStatus.decode(int(words[0])), int(words[1])
        before, self._status = self._status, status
        first = self._resets is None
        found: list[NetworkEvent] = []
        if before.online and not status.online:
            found.append(self._event("offline", None, "the network is offline", NetworkOffline))
        if status.online and resets != self._resets:
            if not (first and before.online):
                found.append(self._event("online", None, "the network has found its ring anew"))
            found += self._compare({node.node_id for node in network.nodes()}, first=first)
            self._resets = resets
        if status.online:
            found += self._compare_rings(set(status.rings_down))
        if status.system_halt and not before.system_halt:
            text = "too many cycles had no commit; the network is halted until its reset"
            found.append(self._event("halted", None, text, NetworkHalted))
        return found

    def _compare_rings(self, down: set[int]) -> list[NetworkEvent]:
        """Compare the rings of a network that is online: at most one of its two is down."""
        before, self._rings_down = self._rings_down, down
        lost_ones = [
            self._event("ring_lost", ring, f"ring {ring} is broken, and the other one goes on", NetworkError)
            for ring in sorted(down - before)
        ]
        back = sorted(before - down)
        return lost_ones + [self._event("ring_back", ring, f"ring {ring} runs again") for ring in back]

    def _compare(self, there: set[int], *, first: bool) -> list[NetworkEvent]:
        before, self._there = self._there, there
        if first and not before:
            return []
        found = [
            NetworkEvent("node_lost", node, self._network.control.now_s(), error.message, error)
            for node in sorted(before - there)
            for error in [lost([node], self._network.base + protocol.TOSNET_NETWORK_REGISTERS)]
        ]
        if not first:
            back = sorted(there - before)
            found += [self._event("node_back", node, f"node {node} is in the ring") for node in back]
        return found

    def _event(
        self,
        kind: NetworkEventKind,
        node: int | None,
        text: str,
        error: type[NetworkError] | None = None,
    ) -> NetworkEvent:
        address = self._network.base + protocol.TOSNET_STATUS
        made = error(text, address=address) if error else None
        return NetworkEvent(kind, node, self._network.control.now_s(), text, made)


class NetworkListener:
    """Looks at a network every `period_s` in a thread of its own, and calls `callback` for each event.

    It ends with the link, or with `close`.
    """

    def __init__(self, watch: NetworkWatch, callback: NetworkCallback, period_s: float) -> None:
        self._watch, self._callback = watch, callback
        self._period_s = min(period_s, threading.TIMEOUT_MAX)
        self._ended = threading.Event()
        first = watch.look()  # here, because who calls should get its errors
        self._thread = threading.Thread(target=self._run, args=(first,), name="tosnet events", daemon=True)
        self._thread.start()

    def close(self) -> None:
        """End the calls, and wait for a running one. Calling it twice does no harm."""
        self._ended.set()
        if threading.current_thread() is not self._thread:
            self._thread.join()

    def _run(self, events: list[NetworkEvent]) -> None:
        while True:
            for event in events:
                if self._ended.is_set():
                    return
                try:
                    self._callback(event)
                except Exception:
                    _log.exception("the callback %r of an event failed; the events go on", self._callback)
            if self._ended.wait(self._period_s):
                return
            try:
                events = self._watch.look()
            except LinkClosed:
                return
            except LinkError:  # the events of the link tell about it
                events = []
