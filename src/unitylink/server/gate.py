# SPDX-License-Identifier: BSD-3-Clause
"""The gate of one robot: every request of every user passes it, or is refused with the reason.

Programs and the dashboard use the same gate. The rules:

- Nobody does anything without a token. Its scopes say what he may read and write.
- A write needs the write lease of the item. The first write of a client takes a lease of the part below the
  root in which the item is (`j1` for `j1.target`), if his scopes allow all of it, or else of the item.
- A lease ends in order by `release` or `logout`: the outputs keep their values. It is lost if the client is
  gone without a logout, if it is not renewed in time, if the token expires, or if an administrator breaks it.
  Then the server has to make the part safe, and says so by `made_safe`. Nobody writes the part before.
- Everyone who is logged in may stop the robot. To go on (`arm`) needs the scope `arm`.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass

from unitylink.errors import AccessRefused, LeaseHeld, UnknownName
from unitylink.spec.model import Instance

from .audit import Audit
from .leases import Lease, Leases
from .rate_limit import RateLimit
from .subtree import WHOLE, contains, known, overlap, shown, subtree
from .tokens import Tokens, User
from .wishes import Wishes

REFUSED_RATE_HZ, REFUSED_BURST = 5.0, 20  # lines about refusals; more of them are only counted
LEASE_S = 2.0  # a lease that a write takes, and the default of a lease that is asked for


@dataclass(frozen=True)
class Now:
    """The time of a request. `steady_s` never jumps. `wall_s` is in s since 1970, in UTC."""

    steady_s: float
    wall_s: float


@dataclass(frozen=True)
class Client:
    """A connection of a user. `where` is its address."""

    number: int
    user: User
    where: str

    @property
    def name(self) -> str:
        return self.user.name


class Gate:
    """See the head of this file. `root` is the tree of the robot, `name` its name in the audit log.

    >>> from unitylink.spec import compile_text
    >>> from unitylink.server.scopes import Rights
    >>> from unitylink.server.tokens import digest
    >>> spec = compile_text("public arm() { @goal = 0x10: WRITE(); }", "arm.ul").spec
    >>> people = [("a", User("ana", Rights.of(["write"]))), ("b", User("ben", Rights()))]
    >>> users = Tokens((digest(token), user) for token, user in people)
    >>> gate, now = Gate("arm", spec.roots[0], users, Audit(lambda line: None)), Now(0.0, 0.0)
    >>> ana, ben = gate.login("a", "loopback", now), gate.login("b", "loopback", now)
    >>> gate.check_write(ana, "goal", now)
    >>> gate.check_write(ben, "goal", now)
    Traceback (most recent call last):
    unitylink.errors.AccessRefused: goal: ben may not write it; the token needs the scope `write goal.*`
    """

    def __init__(self, name: str, root: Instance, tokens: Tokens, audit: Audit) -> None:
        self.name, self.root = name, root
        self.leases, self.wishes = Leases(), Wishes()
        self._tokens, self._audit = tokens, audit
        self._clients: dict[int, Client] = {}
        self._numbers = itertools.count(1)
        self._lines = RateLimit(REFUSED_RATE_HZ, REFUSED_BURST)
        self._noted: set[str] = set()  # parts whose loss is in the audit log
        self.refused = 0
        self.stopped_by = ""  # who has stopped the robot, until somebody arms it

    # -- who is there

    def login(self, token: str, where: str, now: Now) -> Client:
        """Let a user in. Raises AccessRefused if the token is unknown or has expired."""
        client = Client(next(self._numbers), self.user(token, where, now), where)
        self._clients[client.number] = client
        self._log("login", now, client)
        return client

    def user(self, token: str, where: str, now: Now) -> User:
        """Return whose token this is, without a login. Raises AccessRefused as `login` does."""
        user = self._tokens.user(token, now.wall_s)
        if user is None:
            self._refused(now, "login", where=where)
            raise AccessRefused(f"{self.name}: the server does not know this token, or it has expired")
        return user

    @contextmanager
    def visit(self, user: User, where: str) -> Iterator[Client]:
        """Let a user in who has a question, and goes again. That is no login for the log."""
        client = Client(next(self._numbers), user, where)
        self._clients[client.number] = client
        try:
            yield client
        finally:
            self._clients.pop(client.number, None)

    def logout(self, client: Client, now: Now) -> None:
        """Let a user go who says so. His leases are given back, and the outputs keep their values."""
        for lease in self.leases.of(client.number):
            self.release(client, lease.part, now)
        if self._clients.pop(client.number, None):
            self._log("logout", now, client)

    def gone(self, client: Client, now: Now, reason: str = "its connection ended") -> None:
        """A client is gone without a logout. Its leases are lost."""
        self.leases.lose(client.number, reason)
        self._note_lost(now)
        if self._clients.pop(client.number, None):
            self._log("logout", now, client, reason=reason)

    def clients(self) -> tuple[Client, ...]:
        """Return who is logged in."""
        return tuple(self._clients.values())

    def expire(self, now: Now) -> tuple[Client, ...]:
        """End leases whose time is over, and return the clients whose tokens have expired.

        Call it often. The server has to disconnect these clients.
        """
        self.leases.expire(now.steady_s)
        self._note_lost(now)
        late = [one for one in self.clients() if _expired(one.user, now)]
        for client in late:
            self.gone(client, now, "its token expired")
        return tuple(late)

    # -- what they may do

    def check_read(self, client: Client, part: str, now: Now) -> None:
        """Raises AccessRefused if this user may not read the part."""
        self._check(client, "read", part, now)

    def check_write(self, client: Client, path: str, now: Now) -> None:
        """Raises AccessRefused or LeaseHeld if this client may not write the item now.

        It may take a lease.
        """
        self._check(client, "write", path, now)
        if not self.leases.may_write(client.number, path, now.steady_s):
            part = _first(path) if client.user.rights.allow("write", _first(path)) else path
            self.take(client, part, LEASE_S, now)

    def check_arm(self, client: Client, now: Now) -> None:
        """Raises AccessRefused if this user may not arm the robot after a stop."""
        self._check(client, "arm", WHOLE, now)

    def check_acknowledge(self, client: Client, path: str, now: Now) -> None:
        """Raises AccessRefused if this user may not acknowledge alarms of an item.

        Who may write some of the robot, and read the item, may do so.
        """
        self._check(client, "read", path, now)
        if not client.user.rights.parts("write"):
            self._check(client, "write", path, now)

    def check_admin(self, client: Client, now: Now) -> None:
        """Raises AccessRefused if this user is no administrator."""
        self._check(client, "admin", WHOLE, now)

    def armed(self, client: Client, now: Now) -> None:
        """End a stop, so that users can write again. Raises AccessRefused if this user may not."""
        self.check_arm(client, now)
        self.stopped_by = ""
        self._log("arm", now, client)

    def stopped(self, client: Client, now: Now) -> None:
        """Note that a user stopped the robot. All leases are lost, and nobody writes before `armed`."""
        self._known(client, now)
        self.stopped_by = client.name
        self.leases.break_up(WHOLE, client.name)
        self._note_lost(now)
        self._log("stop", now, client)

    def found_stopped(self, who: str, reason: str, now: Now) -> None:
        """Note that the robot was stopped before this program began. Nobody writes before `armed`."""
        self.stopped_by = who
        self._audit.line("stop", now.wall_s, robot=self.name, user=who, reason=reason)

    # -- leases

    def take(self, client: Client, part: str, duration_s: float, now: Now) -> Lease:
        """Give this client the write lease of a part, or renew it.

        Raises UnknownName, AccessRefused, LeaseHeld or ValueRangeError.
        """
        part = known(self.root, subtree(part))
        self._check(client, "write", part, now)
        had = self.leases.of(client.number)
        self.expire(now)
        self.wishes.check(part, client.name, now.steady_s)
        lease = self.leases.take(
            part, client=client.number, holder=client.name, duration_s=duration_s, now_s=now.steady_s
        )
        if lease.part not in {one.part for one in had}:
            self._log("lease", now, client, part=shown(lease.part), duration_s=duration_s)
        self.wishes.taken(lease.part, client.name)
        return lease

    def renew(self, client: Client, now: Now) -> None:
        """A sign of life: renew the leases of this client."""
        self._known(client, now)
        self.expire(now)
        self.leases.renew(client.number, now.steady_s)

    def release(self, client: Client, part: str, now: Now) -> None:
        """Give a lease back in order. The outputs keep their values."""
        if any(lease.part == part for lease in self.leases.of(client.number)):
            self.leases.release(client.number, part)
            self._log("release", now, client, part=shown(part))

    def hand_over(self, client: Client, part: str, to: Client, now: Now) -> Lease:
        """Give a lease to another client. Raises AccessRefused if that one may not write the part."""
        self._check(to, "write", part, now)
        lease = self.leases.hand_over(
            part, client=client.number, to=to.number, holder=to.name, now_s=now.steady_s
        )
        self._log("lease", now, to, part=shown(part), duration_s=lease.duration_s, given_by=client.name)
        return lease

    def break_up(self, client: Client, part: str, now: Now) -> None:
        """Take the leases of a part away from whoever has them. Needs the scope `admin`."""
        self._check(client, "admin", WHOLE, now)
        self.leases.break_up(known(self.root, subtree(part)), client.name)
        self._note_lost(now)

    def ask(self, client: Client, part: str, now: Now) -> tuple[str, ...]:
        """Ask for the lease of a part, and return the names of who holds it.

        Nothing else happens: the holders see it, and may give the lease. Raises UnknownName or AccessRefused.
        """
        part = known(self.root, subtree(part))
        self._check(client, "write", part, now)
        self.expire(now)
        holders = {one.holder for one in self.leases.all() if overlap(one.part, part)} - {client.name}
        if holders:
            self.wishes.ask(part, client.name, now.steady_s)
            self._log("asked", now, client, part=shown(part))
        return tuple(sorted(holders))

    def give(self, client: Client, part: str, to: str, now: Now) -> str:
        """Give the leases of a part back in order, and keep the part for a user: `to`, or who asked first.

        A user may give what one of his connections holds, an administrator what anybody holds. The outputs
        keep their values. Returns for whom the part is kept, or "" if nobody has asked. Raises UnknownName,
        AccessRefused or LeaseHeld.
        """
        part = known(self.root, subtree(part))
        self._known(client, now)
        if to and to not in self._tokens.names():
            raise UnknownName(f"no token of this server is that of {to}")
        self.expire(now)
        held = [one for one in self.leases.all() if contains(part, one.part) and not one.ending]
        if not held:
            raise LeaseHeld(f"nobody holds a write lease of {shown(part)}")
        if others := sorted({one.holder for one in held} - {client.name}):
            self._check(client, "admin", WHOLE, now, f"{others[0]} holds it")
        for lease in held:
            self.leases.release(lease.client, lease.part)
            self._log("release", now, client, part=shown(lease.part))
        return self.wishes.keep(part, to, now.steady_s)

    def unsafe(self) -> tuple[str, ...]:
        """Return the parts that the server has to make safe."""
        return tuple(lease.part for lease in self.leases.ending())

    def made_safe(self, part: str, now: Now) -> None:
        """Say that the outputs of a part are safe now."""
        self.leases.made_safe(part)
        self._noted.discard(part)
        self._audit.line("safe", now.wall_s, robot=self.name, part=shown(part))

    def wrote(self, client: Client, values: dict[str, object], now: Now) -> None:
        """Note what a person wrote."""
        self._log("write", now, client, values=values)

    def note(self, event: str, client: Client, now: Now, **facts: object) -> None:
        """Note another event of the audit log, which a person caused."""
        self._log(event, now, client, **facts)

    # -- within

    def _check(self, client: Client, action: str, part: str, now: Now, why: str = "") -> None:
        self._known(client, now)
        if action == "write" and self.stopped_by:
            raise AccessRefused(
                f"{self.stopped_by} has stopped the robot; nobody writes before somebody arms it: link.arm()"
            )
        if client.user.rights.allow(action, part):
            return
        self._refused(now, action, client=client, part=part)
        needed = f"{action} {part}.*" if part and action in ("read", "write") else action
        what = "it" if part else self.name
        because = f"{why}, and " if why else ""
        raise AccessRefused(
            f"{because}{client.name} may not {action} {what}; the token needs the scope `{needed}`",
            item=part or None,
        )

    def _known(self, client: Client, now: Now) -> None:
        if self._clients.get(client.number) != client:
            raise AccessRefused(f"{self.name}: {client.name} is not logged in any more")
        if _expired(client.user, now):
            self.gone(client, now, "its token expired")
            raise AccessRefused(f"{self.name}: the token of {client.name} has expired")

    def _note_lost(self, now: Now) -> None:
        for lease in self.leases.ending():
            if lease.part not in self._noted:
                self._noted.add(lease.part)
                facts = {"user": lease.holder, "part": shown(lease.part), "reason": lease.ending}
                self._audit.line("lost", now.wall_s, robot=self.name, **facts)

    def _refused(self, now: Now, action: str, *, client: Client | None = None, **facts: object) -> None:
        self.refused += 1
        if not self._lines.allow(now.steady_s):
            return  # a flood of refusals must not fill the disk
        who = {"user": client.name, "where": client.where} if client else {}
        self._audit.line("refused", now.wall_s, robot=self.name, action=action, **who, **facts)

    def _log(self, event: str, now: Now, client: Client, **facts: object) -> None:
        self._audit.line(event, now.wall_s, robot=self.name, user=client.name, where=client.where, **facts)


def _first(path: str) -> str:
    """Return the part below the root in which an item is."""
    return path.split(".", 1)[0]


def _expired(user: User, now: Now) -> bool:
    return user.expires_s is not None and now.wall_s >= user.expires_s
