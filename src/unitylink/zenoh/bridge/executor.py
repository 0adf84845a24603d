# SPDX-License-Identifier: BSD-3-Clause
"""What clients do to the board behind a bridge: each write passes the gate, and is not begun too late."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterable, Mapping
from typing import TYPE_CHECKING, Any, TypeVar

from unitylink.dashboard.desk import Desk
from unitylink.errors import (
    AccessRefused,
    LinkTimeout,
    OutcomeUnknown,
    UnknownName,
    ValueRangeError,
)
from unitylink.layer2_message import sent_before
from unitylink.layer4_data import PulseValue, ValueGroup, WriteValue, load_spec_objects
from unitylink.protocol import (
    LIST_OPERATION_ADD,
    LIST_OPERATION_READ,
    LIST_OPERATION_READ_FIFO,
    LIST_OPERATION_WRITE,
    LIST_OPERATION_WRITE_FIFO,
)
from unitylink.server.grants import EVERYTHING, commit_of, grant, paths_of
from unitylink.server.stop_switch import now
from unitylink.server.subtree import WHOLE

from ..messages import ATOMIC, CHECKED, ONCE, UNCHECKED, Operation, Request

if TYPE_CHECKING:
    from unitylink.layer2_message import Link
    from unitylink.layer2_message.batch import Batch
    from unitylink.server.gate import Client
    from unitylink.server.grants import Ranges
    from unitylink.server.robot import Robot
    from unitylink.server.scopes import Rights

T = TypeVar("T")
_ATTEMPT_LEAST_S, _ATTEMPT_MOST_S, _ATTEMPTS = 0.005, 0.1, 3


class Executor:
    """Does what clients ask, from any thread. It raises UnityLinkError, for example if the board is away."""

    def __init__(self, robot: Robot) -> None:
        self.robot = robot
        self._paths = paths_of(robot.spec)
        self._elements = dict(robot.spec.walk())
        self._commits: dict[int, frozenset[str]] = {}  # the items that a word commits
        for path, element in self._elements.items():
            if element.writable and (word := commit_of(element.link)) is not None:
                self._commits[word] = self._commits.get(word, frozenset()) | {path}
        self._lock = threading.Lock()  # guards what follows
        self._link: Link | None = None
        self._desk: Desk | None = None
        self._parts: dict[str, ValueGroup] = {}
        self._readable: list[tuple[Rights, Ranges]] = []  # of each user

    def desk(self) -> tuple[Link, Desk]:
        """Return the link and what passes requests to it. Raises UnityLinkError if the board is away."""
        link = self.robot.board_link()
        with self._lock:
            if self._desk is None or self._link is not link:  # the line was opened anew
                objects = load_spec_objects(self.robot.spec, link)
                self._link, self._desk = link, Desk(objects, self.robot.gate, self.robot.switch)
                self._parts = {}
            return link, self._desk

    @property
    def generation(self) -> int:
        """How often the link has lost the board and found it again."""
        return self._link.generation if self._link is not None else 0

    def words(self, client: Client, request: Request) -> list[int]:
        """Do a list of operations, and return the words that were read."""
        link, desk = self.desk()
        self.check_reads(client, request.operations)
        if not request.writes:
            return _read(link, request)
        written = [one[1] for one in request.operations if one[0] >= LIST_OPERATION_WRITE]
        return self._act(
            desk,
            client,
            self._items(desk, client, written),
            lambda: _in_time(request.deadline_ns, lambda: _do(link, request)),
        )

    def _items(self, desk: Desk, client: Client, addresses: list[int]) -> list[str]:
        """Return the items to which addresses belong. One that the spec does not name is the whole robot.

        Who writes an item behind a committed memory, or has its lease, may commit it, too.
        """
        items = list(dict.fromkeys(self._paths[one] for one in addresses if one in self._paths))
        for address in addresses:
            if address in self._paths:
                continue
            behind = self._commits.get(address, frozenset())
            if not behind.isdisjoint(items):
                continue
            with desk.gate() as gate:
                steady_s, leases = now().steady_s, gate.leases
                held = (path for path in behind if leases.may_write(client.number, path, steady_s))
                items.append(next(held, WHOLE))
        return items

    def set_point(self, client: Client, values: Mapping[str, Any], part: str, deadline_ns: int) -> None:
        """Write values of items below `part` together, if it is not too late."""
        _, desk = self.desk()

        def send() -> None:
            left_s = (deadline_ns - time.monotonic_ns()) / 1e9
            timeout_s = min(max(left_s / _ATTEMPTS, _ATTEMPT_LEAST_S), _ATTEMPT_MOST_S)
            self._group(desk, part, values).write(values, timeout_s=timeout_s)

        self._act(desk, client, values, lambda: _in_time(deadline_ns, send))

    def write_value(self, client: Client, path: str, value: Any, deadline_ns: int) -> None:
        """Write one item, or give a pulse."""
        _, desk = self.desk()
        item = next((one for one in desk.robot if one.path == path), None)
        if isinstance(item, PulseValue):
            strobe = item

            def send() -> None:
                strobe.pulse(value)
        elif isinstance(item, WriteValue):

            def send() -> None:
                self._group(desk, path, (path,)).write({path: value})
        else:
            raise ValueRangeError(f"{path} is a {item.access if item else 'nothing'}; a write needs a WRITE")
        self._act(desk, client, (path,), lambda: _in_time(deadline_ns, send))

    def raw(self, client: Client, path: str) -> int:
        """Read the raw number of an item."""
        link, desk = self.desk()
        with desk.gate() as gate:
            gate.check_read(client, path, now())
        element = self._elements.get(path)
        if element is None or not element.readable:
            raise UnknownName(f"the robot has nothing to read at {path}")
        if element.words == 1:
            return link.read(element.address, checked=element.checked, repeat=element.pollable)
        words = link.read_many(
            element.addresses, atomic=element.words > 1, checked=element.checked, repeat=element.pollable
        )
        bits = link.configuration.data_bits
        return sum(int(word) << bits * place for place, word in enumerate(words))

    def arm(self, client: Client, asked_ns: int | None) -> None:
        """Allow writes again, if there was no stop since this was asked for."""
        self.robot.switch.arm(client, asked_ns)

    def stop(self, client: Client) -> int:
        """Make all outputs safe now. Return how many outputs have a SAFE value.

        While the board is away, that is done when it comes back; it is an error all the same.
        """
        self.robot.switch.stop(client)
        return sum(one.writable and one.safe is not None for one in self._elements.values())

    def _act(self, desk: Desk, client: Client, paths: Iterable[str], send: Callable[[], T]) -> T:
        sent = True
        try:
            return desk.act(client, paths, send)
        except (LinkTimeout, OutcomeUnknown):
            raise  # perhaps it was sent
        except BaseException:
            sent = False
            raise
        finally:
            if sent:
                self._check_kept(desk, client, paths)

    def _check_kept(self, desk: Desk, client: Client, paths: Iterable[str]) -> None:
        """Make items safe whose lease was lost meanwhile: the SAFE values may have been first."""
        with desk.gate() as gate:
            steady_s = now().steady_s
            lost = [path for path in paths if not gate.leases.may_write(client.number, path, steady_s)]
        if lost:
            desk.make_safe(lost)

    def _group(self, desk: Desk, part: str, paths: Iterable[str]) -> ValueGroup:
        with self._lock:
            if part not in self._parts:
                wanted = set(paths)
                values = {one.path: one for one in desk.robot if one.path in wanted}
                self._parts[part] = ValueGroup(values, part or "all")
            return self._parts[part]

    def check_reads(self, client: Client, operations: tuple[Operation, ...]) -> None:
        """Raises AccessRefused if this client may not read one of the words."""
        ranges = self._ranges(client.user.rights)
        if ranges is EVERYTHING:
            return
        for operation, address, *_ in operations:
            if operation < LIST_OPERATION_WRITE and not any(low <= address <= high for low, high in ranges):
                raise AccessRefused(f"{client.name} may not read {address:#06x}", address=address)

    def _ranges(self, rights: Rights) -> Ranges:
        """Return the words that a user may read. A request is answered often, so they are computed once."""
        for known, ranges in self._readable:
            if known == rights:
                return ranges
        ranges = grant(self.robot.spec, rights).reads
        with self._lock:
            self._readable.append((rights, ranges))
        return ranges


def _in_time(deadline_ns: int, send: Callable[[], T]) -> T:
    """Call `send` unless it is too late. The core looks again when it gives what is sent to the line."""
    if not deadline_ns:
        return send()
    if time.monotonic_ns() >= deadline_ns:
        raise LinkTimeout("it reached the bridge too late, and was not executed")
    return sent_before(deadline_ns, send)


def _flags(request: Request) -> tuple[bool, bool | None, bool]:
    checked = True if request.flags & CHECKED else False if request.flags & UNCHECKED else None
    return bool(request.flags & ATOMIC), checked, not request.flags & ONCE


def _read(link: Link, request: Request) -> list[int]:
    """Read words. Only words of memory are read together; a FIFO gives its words one after the other."""
    atomic, checked, repeat = _flags(request)
    operations = request.operations
    if len(operations) == 1 and operations[0][0] == LIST_OPERATION_READ:
        return [link.read(operations[0][1], checked=checked, repeat=repeat)]
    if all(one[0] == LIST_OPERATION_READ for one in operations):
        addresses = [one[1] for one in operations]
        words: list[int] = link.read_many(addresses, atomic=atomic, checked=checked, repeat=repeat).tolist()
        return words
    return _do(link, request)


def _do(link: Link, request: Request) -> list[int]:
    atomic, checked, repeat = _flags(request)
    operations = request.operations
    if not atomic and all(one[0] == LIST_OPERATION_WRITE for one in operations):
        addresses, values = [one[1] for one in operations], [one[2] for one in operations]
        link.write_many(addresses, values, checked=checked, repeat=repeat)
        return []
    with link.batch(atomic=atomic) as batch:
        pending = [one for each in operations for one in _add(batch, each)]
    return [int(one.value) for one in pending]


def _add(batch: Batch, operation: Operation) -> list[Any]:
    """Add an operation to a batch. Return what will have its word, if it reads one."""
    kind, address, value, mask = operation
    if kind == LIST_OPERATION_READ:
        return [batch.read(address)]
    if kind == LIST_OPERATION_READ_FIFO:
        return batch.read_fifo(address, 1)
    if kind == LIST_OPERATION_WRITE:
        batch.write(address, value)
    elif kind == LIST_OPERATION_WRITE_FIFO:
        batch.write_fifo(address, [value])
    elif kind == LIST_OPERATION_ADD:
        batch.add(address, value)
    else:
        batch.write_masked(address, mask, value)
    return []
