# SPDX-License-Identifier: BSD-3-Clause
"""One board behind a server: its link, which is opened again if it ends, its native server and its gate."""

from __future__ import annotations

import threading
import time
from contextlib import ExitStack, suppress
from typing import TYPE_CHECKING, Any

from unitylink.connection import connect
from unitylink.connection.schemes import scheme_of
from unitylink.errors import AccessRefused, DeadManTripped, LeaseHeld, UnityLinkError
from unitylink.interface.safe_words import safe_words
from unitylink.interface.wire_hash import wire_hashes
from unitylink.layer2_message import Link
from unitylink.protocol import REPLY_STATUS_DENIED, REPLY_STATUS_OK, SERVE_LEASE_HELD, SERVE_STOPPED_SINCE
from unitylink.spec.model import Spec

from .audit import Audit
from .gate import Client, Gate
from .grants import grant, paths_of, plain_words, words_of
from .stop_switch import StopSwitch, now
from .subtree import WHOLE, contains
from .tokens import Tokens, User

if TYPE_CHECKING:
    from unitylink._native import BoardServer, Knock

    from .stop_file import StopFile

_PAUSE_S = 1.0  # between two attempts to open a link
_LOOK_S = 0.2  # how often leases are renewed and looked at, if there is no news


class Robot:
    """A board with a name. A thread opens its link, opens it again if it ends, and decides about leases.

    A client is alive as long as its connection is. Its leases are renewed meanwhile. If `silence_s` is given,
    a client that has sent nothing for so long loses its leases, although its connection exists. The server
    starts it when it has its port: a server that cannot begin touches no board.
    """

    def __init__(
        self,
        name: str,
        url: str,
        spec: Spec,
        tokens: Tokens,
        audit: Audit,
        *,
        silence_s: float = 0.0,
        memory: StopFile | None = None,
    ) -> None:
        self.name, self.url, self.spec = name, url, spec
        self.opened = threading.Event()  # set after the first attempt
        self._away = f"{url} is being opened"
        self._silence_s = silence_s
        self._audit, self._said = audit, ""
        self.gate = Gate(name, spec.roots[0], tokens, audit)
        self.switch = StopSwitch(self.gate, memory, self._tell_changes)
        self._paths = paths_of(spec)
        self._clients: dict[int, Client] = {}  # by the number that the native server gives
        self._told: dict[int, list[str]] = {}  # the parts that the native server lets each client write
        self._link: Link | None = None
        self._server: BoardServer | None = None
        self._lock = self.switch.lock  # guards all above, and the gate
        self._closed = threading.Event()
        self._thread = threading.Thread(target=self._govern, name=f"serve {name}", daemon=True)

    def start(self) -> None:
        """Begin to open the link."""
        self._thread.start()

    @property
    def away(self) -> str:
        """Why the board cannot be used now, or an empty text."""
        with self._lock:
            return self._why_away()

    @property
    def connected(self) -> int:
        """How many clients are connected."""
        return len(self._clients)

    def has(self, user: str) -> bool:
        """Whether a user of this name is connected."""
        with self._lock:
            return any(client.name == user for client in self._clients.values())

    def admit(self, knock: Knock) -> None:
        """Hand a client over to the board, if its token is known. Raises AccessRefused or UnityLinkError."""
        with self._lock:
            where = (
                f"{knock.peer} with the certificate {knock.certificate}" if knock.certificate else knock.peer
            )
            client = self.gate.login(knock.token, where, now())
            try:
                server = self._there()
            except UnityLinkError:
                self.gate.logout(client, now())
                raise
            may = grant(self.spec, client.user.rights)
            text = f"{client.name} may {client.user.rights}"
            number = server.admit(knock, client.name, may.reads, may.writes, may.leased, may.arm, text)
            self._clients[number] = client

    def board_link(self) -> Link:
        """Return the link, for others who serve the same board. Raises UnityLinkError if it is away."""
        with self._lock:
            self._there()
            assert self._link is not None
            return self._link

    def report(self) -> dict[str, Any]:
        """Return the state of the board, of its link, of its clients and leases, as plain values."""
        with self._lock:
            told: dict[str, Any] = {"name": self.name, "link": self.url, "away": self._why_away()}
            now_s = time.monotonic()
            where = {client.number: client.where for client in self.gate.clients()}
            told["stopped_by"] = self.gate.stopped_by
            told["leases"] = [
                {
                    "part": lease.part or "*",
                    "holder": lease.holder,
                    "where": where.get(lease.client, ""),
                    "ending": lease.ending,
                }
                for lease in self.gate.leases.all()
            ]
            told["wishes"] = [
                {
                    "part": wish.part or "*",
                    "user": wish.user,
                    "left_s": wish.until_s - now_s,
                    "kept": wish.kept,
                }
                for wish in self.gate.wishes.all(now_s)
            ]
            if self._link is not None and self._server is not None:
                told["statistics"] = dict(vars(self._link.statistics()))
                told.update(self._server.report())
                for client in told["clients"]:
                    known = self._clients.get(client["id"])
                    client["where"] = known.where if known else ""
                    client["age_s"] = max(0.0, now_s - client.pop("since_s"))
            return told

    def ask(self, user: User, where: str, part: str) -> list[str]:
        """Ask for a lease in the name of a user. Return who holds it."""
        with self._lock, self.gate.visit(user, where) as client:
            return list(self.gate.ask(client, part, now()))

    def give(self, user: User, where: str, part: str, to: str) -> str:
        """Give leases back in order, in the name of a user. Return for whom the part is kept."""
        with self._lock, self.gate.visit(user, where) as client:
            kept_for = self.gate.give(client, part, to, now())
            self._tell_changes()  # before anybody else can write
            return kept_for

    def break_up(self, user: User, where: str, part: str) -> None:
        """Take leases away, in the name of an administrator. The outputs become safe."""
        with self._lock, self.gate.visit(user, where) as client:
            self.gate.break_up(client, part, now())

    def close(self) -> None:
        """Drop all clients and close the link."""
        self._closed.set()
        if self._thread.ident is not None:
            self._thread.join()
        with self._lock:
            self._let_go()

    def _why_away(self) -> str:
        """Return why clients cannot come in now. Hold the lock."""
        link = self._link
        if link is None or self._server is None:
            return self._away
        if link.closed:
            return "its link has ended"
        return "" if link.up else link.trouble or "its line is gone"

    def _there(self) -> BoardServer:
        """Return the native server, or raise UnityLinkError. Hold the lock."""
        why = self._why_away()
        if why or self._server is None:
            raise UnityLinkError(f"the board {self.name} is away: {why}")
        return self._server

    def _govern(self) -> None:
        while not self._closed.is_set():
            with self._lock:
                if self._link is not None and self._link.closed:
                    self._let_go()
                server = self._server
            if server is None:
                self._open()
                self._log_state()
                self.opened.set()
                if self._server is None:
                    self._closed.wait(_PAUSE_S)
                continue
            news = server.wait_news(_LOOK_S)
            self._log_state()
            with self._lock:
                try:
                    self._take(server, news)
                except UnityLinkError as error:  # the board refuses it, or is gone
                    self._let_go()
                    self._away = str(error)
                    continue
            for number, kind, _, at_ns in news:
                if kind == "arms":
                    self._arm(server, number, at_ns)
            with suppress(UnityLinkError):  # it is tried again
                self.switch.keep()

    def _take(self, server: BoardServer, news: list[tuple[int, str, int, int]]) -> None:
        """Act on what clients did. Hold the lock."""
        for number, kind, address, _ in news:
            if kind == "asks":
                self._decide(server, number, address)
            elif kind in ("left", "gone"):
                self._left(number, in_order=kind == "left")
            elif kind == "silent" and number in self._clients:
                self.gate.leases.lose(self._clients[number].number, "its dead-man has tripped")
        self._look_at_leases(server)

    def _log_state(self) -> None:
        """Note when the board goes away, and when it comes back."""
        away = self.away
        if away != self._said or not self.opened.is_set():
            self._said = away
            self._audit.line("away" if away else "up", time.time(), robot=self.name, reason=away or None)

    def _open(self) -> None:
        try:
            once = scheme_of(self.url).once or "reconnect=" in self.url
            link = connect(self.url, reconnect=None if once else True)
        except UnityLinkError as error:
            self._away = str(error)
            return
        with ExitStack() as opened:
            opened.callback(link.close)
            try:
                link.check_time_passes("a server")
                link.check_spec(self.spec.source, wire_hashes(self.spec, self.spec.roots[0].name))
                server = link.serve(plain_words(self.spec))
                opened.callback(server.close)
                self.switch.attach((link,), lambda: self._write_safe(link, WHOLE))
            except UnityLinkError as error:
                self._away = str(error)
                return
            opened.pop_all()
        with self._lock:
            self._link, self._server = link, server

    def _let_go(self) -> None:
        self.switch.detach()
        if self._server is not None:
            self._server.close()
        if self._link is not None:
            self._away = "its link has ended"
            self._link.close()
        self._server = self._link = None
        for number in list(self._clients):
            self._left(number, in_order=False)

    # ---- leases. Hold the lock

    def _left(self, number: int, in_order: bool) -> None:
        client = self._clients.pop(number, None)
        self._told.pop(number, None)
        if client is not None:
            self.gate.logout(client, now()) if in_order else self.gate.gone(client, now())

    def _arm(self, server: BoardServer, number: int, asked_ns: int) -> None:
        """A client wants that writes are allowed again. Do not hold the lock: a stop must not wait for it."""
        with self._lock:
            client = self._clients.get(number)
        if client is None:
            return
        try:
            self.switch.arm(client, asked_ns)
            answer = REPLY_STATUS_OK
        except (
            UnityLinkError
        ) as error:  # without a stop since, all that it can be told is that it is not over
            answer = SERVE_STOPPED_SINCE if isinstance(error, AccessRefused) else SERVE_LEASE_HELD
            self._audit.line("refused", time.time(), robot=self.name, action="arm", reason=str(error))
        with self._lock:
            self._tell(server, number, client, ("arms", answer))

    def _decide(self, server: BoardServer, number: int, address: int) -> None:
        """Give a client the lease that its write needs, or not."""
        client = self._clients.get(number)
        if client is None:
            return
        try:
            self.gate.check_write(client, self._paths.get(address, WHOLE), now())
            answer = REPLY_STATUS_OK
        except (AccessRefused, LeaseHeld):
            answer = REPLY_STATUS_DENIED if self.gate.stopped_by else SERVE_LEASE_HELD
        self._tell(server, number, client, ("asks", answer))

    def _tell(
        self, server: BoardServer, number: int, client: Client, decided: tuple[str, int] | None
    ) -> None:
        self._told[number] = held = self._held(client)
        may = grant(self.spec, client.user.rights, held)
        server.set_grant(number, may.reads, may.writes, may.leased, may.arm, decided)

    def _held(self, client: Client) -> list[str]:
        return [lease.part for lease in self.gate.leases.of(client.number)]

    def _look_at_leases(self, server: BoardServer) -> None:
        silent = set(server.silent(self._silence_s)) if self._silence_s else ()
        for number, client in self._clients.items():
            if number not in silent:
                self.gate.leases.renew(client.number, time.monotonic())
        for late in self.gate.expire(now()):
            for number in [one for one, client in self._clients.items() if client == late]:
                server.drop(number)
        self._tell_changes()
        for part in self.gate.unsafe():
            if self._make_safe(part):
                self.gate.made_safe(part, now())

    def _tell_changes(self) -> None:
        """Tell the native server which leases have ended or were given: others change them, too."""
        for number, client in self._clients.items():
            if self._server is not None and self._held(client) != self._told.get(number, []):
                self._tell(self._server, number, client, None)

    def _write_safe(self, link: Link, part: str) -> None:
        """Write the SAFE values of a part."""
        mine = words_of(self.spec, lambda path: contains(part, path))
        words = safe_words(self.spec, 8 * link.configuration.data_bytes)
        safe = [(to, word) for to, word in words if any(first <= to <= last for first, last in mine)]
        link.write_many([to for to, _ in safe], [word for _, word in safe])

    def _make_safe(self, part: str) -> bool:
        """Write the SAFE values of a part. Return False if the board did not take them."""
        assert self._link is not None
        try:
            self._write_safe(self._link, part)
        except DeadManTripped:  # then the board has written them all
            return True
        except UnityLinkError:  # it is tried again
            return False
        return True
