# SPDX-License-Identifier: BSD-3-Clause
"""What the network tells of each robot: its bridge and its board, who has leases, the state of the bridge."""

from __future__ import annotations

import json
import threading
import time
from collections.abc import Callable, Collection, Iterable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from unitylink.zenoh.keys import Keys

if TYPE_CHECKING:
    import zenoh

_STATE_BYTES_MAX = 1 << 20


@dataclass
class Presence:
    """The tokens of one robot, and the last state that its bridge told."""

    bridges: set[str] = field(default_factory=set)
    boards: set[str] = field(default_factory=set)
    leases: dict[str, str] = field(default_factory=dict)  # part: holder
    state: dict[str, Any] = field(default_factory=dict)
    told_s: float = 0.0  # when the state came, by the monotonic clock
    board_gone_s: float = 0.0  # when its board's token went, by the monotonic clock

    @property
    def reachable(self) -> bool:
        """Whether a bridge is there, and its board answers it."""
        return bool(self.bridges & self.boards)

    @property
    def known(self) -> bool:
        """Whether the state is that of a bridge that is there now."""
        bridge = self.state.get("bridge")
        return isinstance(bridge, str) and bridge in self.bridges


class RollCall:
    """Hears the tokens of all robots of a fleet, and asks for their states.

    `heard` is called after each token that comes or goes, with the key, by a thread of Zenoh.
    """

    def __init__(
        self, session: zenoh.Session, keys: Iterable[str], heard: Callable[[str], None] = lambda key: None
    ) -> None:
        self._session, self._heard = session, heard
        self._lock = threading.Lock()
        self._presences = {key: Presence() for key in keys}
        self._waiting: set[str] = set()
        self._answered = threading.Condition(self._lock)
        self._listeners: list[Any] = []
        for key in self._presences:
            names = Keys(key)
            for pattern in (names.bridge("*"), names.board("*"), f"{key}/lease/**"):
                self._listeners.append(
                    session.liveliness().declare_subscriber(pattern, self._hearer(key), history=True)
                )

    def close(self) -> None:
        """Hear no more."""
        while self._listeners:
            self._listeners.pop().undeclare()

    def of(self, key: str) -> Presence:
        """Return what is known of a robot, as a copy."""
        with self._lock:
            one = self._presences[key]
            return Presence(
                set(one.bridges), set(one.boards), dict(one.leases), one.state, one.told_s, one.board_gone_s
            )

    def ask(self, timeout_s: float, keys: Collection[str] | None = None) -> None:
        """Ask all bridges that live for their states, or those of `keys`, and do not wait."""
        with self._lock:
            there = [key for key, one in self._presences.items() if one.bridges and key not in self._waiting]
            asked = [key for key in there if keys is None or key in keys]
            self._waiting.update(asked)
        for key in asked:
            self._session.get(Keys(key).fixed("state"), handler=self._taker(key), timeout=timeout_s)

    def ask_and_wait(self, timeout_s: float) -> None:
        """Ask all bridges that live for their states, and wait until each has answered or not."""
        self.ask(timeout_s)
        with self._lock:
            self._answered.wait_for(lambda: not self._waiting, timeout_s + 0.5)

    def _hearer(self, key: str) -> Callable[[zenoh.Sample], None]:
        from zenoh import SampleKind

        def hear(sample: zenoh.Sample) -> None:
            kind, _, rest = str(sample.key_expr)[len(key) + 1 :].partition("/")
            come = sample.kind == SampleKind.PUT
            with self._lock:
                one = self._presences[key]
                if kind == "lease":
                    part, _, holder = rest.rpartition("/")
                    if come:
                        one.leases[part] = holder
                    else:
                        one.leases.pop(part, None)
                elif kind in ("bridge", "board"):
                    there = one.bridges if kind == "bridge" else one.boards
                    (there.add if come else there.discard)(rest)
                    if kind == "board" and not come:
                        one.board_gone_s = time.monotonic()
            self._heard(key)

        return hear

    def _taker(self, key: str) -> Any:
        import zenoh

        def take(reply: zenoh.Reply) -> None:
            if (told := told_by(reply)) is not None:
                with self._lock:
                    self._presences[key].state = told
                    self._presences[key].told_s = time.monotonic()

        def over() -> None:
            with self._lock:
                self._waiting.discard(key)
                self._answered.notify_all()

        return zenoh.handlers.Callback(take, over)


def told_by(reply: zenoh.Reply) -> dict[str, Any] | None:
    """Return the object of JSON in a reply, or None. Anybody may have sent it."""
    if reply.ok is None or len(reply.ok.payload) > _STATE_BYTES_MAX:
        return None
    try:
        told = json.loads(reply.ok.payload.to_bytes())
    except (ValueError, RecursionError):
        return None
    return told if isinstance(told, dict) else None
