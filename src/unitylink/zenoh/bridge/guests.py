# SPDX-License-Identifier: BSD-3-Clause
"""Who uses the robot over the network: hellos, signs of life, and the leases that all can see."""

from __future__ import annotations

import contextlib
import json
import re
import threading
import time
from collections.abc import Callable
from typing import TYPE_CHECKING

from unitylink.errors import AccessRefused, LinkBusy, ProtocolError, UnityLinkError
from unitylink.server.stop_switch import now

from .queries import Refused, payload_of
from .visits import Visit, Visits

if TYPE_CHECKING:
    import zenoh

    from unitylink.server.gate import Client
    from unitylink.server.robot import Robot

    from ..keys import Keys

_NAME = re.compile(r"[A-Za-z0-9_-]{1,40}")


class Guests:
    """The visits of clients, each with a login at the gate of the robot.

    `token` is that of the user as whom all come, and `reading` of those who only read. `bridge` and
    `spec_hash` are told to them. `ended` is called with each visit that has ended. `lock` guards `visits`.
    """

    def __init__(
        self, robot: Robot, keys: Keys, token: str, *, reading: str, bridge: str, spec_hash: str
    ) -> None:
        self.visits, self.lock = Visits(), threading.Lock()
        self.ended: Callable[[Visit], None] = lambda visit: None
        self._robot, self._keys, self._token, self._reading = robot, keys, token, reading
        self._bridge, self._hash = bridge, spec_hash
        self._leases: dict[str, zenoh.LivelinessToken] = {}

    def enter(self, where: str, token: str = "") -> Client:
        """Log somebody in, by default as all."""
        with self._robot.switch.lock:
            return self._robot.gate.login(token or self._token, where, now())

    def exit(self, client: Client) -> None:
        """Log somebody out."""
        with self._robot.switch.lock:
            self._robot.gate.logout(client, now())

    def leave(self, visit: Visit) -> None:
        """A client goes in order. Its outputs keep their values."""
        self._let_go(visit)
        self.exit(visit.client)

    def leave_all(self) -> None:
        """All go in order, because the bridge ends."""
        with self.lock:
            visits = self.visits.all()
        for visit in visits:
            self.leave(visit)

    def dismiss_all(self, why: str) -> None:
        """End all visits without their doing. The clients have to say hello again."""
        with self.lock:
            visits = self.visits.all()
        for visit in visits:
            self._gone(visit, why)

    def look(self, session: zenoh.Session) -> None:
        """Renew the leases of those who are there, and show all leases as tokens. Call it often."""
        with self.lock:
            late = self.visits.absent(time.monotonic_ns())
            present = [one for one in self.visits.all() if one.present]
        for visit in late:
            self._gone(visit, "its token was never there")
        gate = self._robot.gate
        with self._robot.switch.lock:
            for visit in present:
                with contextlib.suppress(AccessRefused):
                    gate.renew(visit.client, now())
            names = {one.client.number: one.name for one in present}
            leases = gate.leases.all()
        held = {self._keys.lease(one.part, names.get(one.client, "other")) for one in leases}
        for key in held - set(self._leases):
            self._leases[key] = session.liveliness().declare_token(key)
        for key in set(self._leases) - held:
            self._leases.pop(key).undeclare()

    def heard(self, sample: zenoh.Sample) -> None:
        """The token of a client came or went."""
        import zenoh

        name = str(sample.key_expr).rpartition("/")[2]
        with self.lock:
            ended = self.visits.token(name, sample.kind == zenoh.SampleKind.PUT)
        for visit in ended:
            self._gone(visit, "its token is gone")

    def hello(self, query: zenoh.Query) -> None:
        """Let a client in, and tell it what it has to know. Raises Refused or UnityLinkError.

        Who comes by the key `hello_read` can only read, whatever the others may do.
        """
        if "*" in str(query.key_expr):
            raise Refused("wildcard", ProtocolError("a hello is for one robot"))
        name, spec_hash = _read_hello(payload_of(query))
        if spec_hash and spec_hash != self._hash:
            text = f"{self._keys.name} has the spec {self._hash}, and {name} was made from {spec_hash}"
            raise Refused("spec", LinkBusy(text))
        link = self._robot.board_link()
        reads = str(query.key_expr) == self._keys.fixed("hello_read")
        if reads and not self._reading:
            raise Refused(
                "access", AccessRefused(f"{self._keys.name} knows nobody who only reads: say hello")
            )
        client = self.enter(f"zenoh client {name}", self._reading if reads else "")
        try:
            with self.lock:
                if any(one.name == name for one in self.visits.all()):
                    raise Refused("access", AccessRefused(f"a client of the name {name} is there already"))
                try:
                    visit = self.visits.add(name, client, time.monotonic_ns())
                except LinkBusy as error:
                    raise Refused("full", error) from None
        except UnityLinkError:
            self.exit(client)
            raise
        told = {
            "visit": visit.number,
            "bridge": self._bridge,
            "now_ns": time.monotonic_ns(),
            "hash": self._hash,
            "may": str(client.user.rights),
            "configuration": dict(vars(link.configuration)),
        }
        query.reply(query.key_expr, json.dumps(told))

    def _gone(self, visit: Visit, why: str) -> None:
        """A client is gone without a word. Its parts become safe, by the thread of the robot."""
        self._let_go(visit)
        with self._robot.switch.lock:
            self._robot.gate.gone(visit.client, now(), why)

    def _let_go(self, visit: Visit) -> None:
        with self.lock:
            self.visits.remove(visit.number)
        self.ended(visit)


def _read_hello(data: bytes) -> tuple[str, str]:
    """Return the name of a client, and the hash of its spec or "". Raises ProtocolError."""
    try:
        told = json.loads(data[:4096])
        name, spec_hash = str(told["client"]), str(told.get("hash", ""))
    except (ValueError, TypeError, KeyError, AttributeError, RecursionError):
        raise ProtocolError('a hello is JSON: {"client": NAME, "hash": HASH OF THE SPEC}') from None
    if not _NAME.fullmatch(name):
        raise ProtocolError("the name of a client has 1 to 40 letters, digits, `_` or `-`")
    return name, spec_hash
