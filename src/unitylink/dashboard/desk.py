# SPDX-License-Identifier: BSD-3-Clause
"""What people do to a robot: each request passes the gate, and then goes to the board."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from contextlib import contextmanager, suppress
from typing import TYPE_CHECKING, Any, TypeVar

from unitylink.errors import DeadManTripped, UnknownName, ValueRangeError, shown
from unitylink.layer4_data import ClearValue, Node, PulseValue, Value, ValueGroup, WriteValue
from unitylink.server.gate import Client, Gate
from unitylink.server.stop_switch import StopSwitch, now
from unitylink.server.subtree import contains
from unitylink.values import format_value

from .description import as_text

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

T = TypeVar("T")
MOST = 1000  # items of one write


class Desk:
    """Takes requests from any thread. Those that reach the board block until it has answered.

    While one is under way, others wait, except `stop`. So a set-point that the gate has let pass cannot reach
    the board after the SAFE values of a lost lease. After a stop, nobody writes before `arm`.
    """

    def __init__(self, robot: Node, gate: Gate, switch: StopSwitch | None = None) -> None:
        """`switch` is that of a server, which keeps the gate, and makes lost parts safe by itself.

        Without it, the robot is stopped if its board's dead-man has tripped. Raises LinkError.
        """
        self.robot = robot
        self._gate = gate
        self._values = {value.path: value for value in robot}
        self._keeps = switch is None
        self.switch = switch if switch is not None else StopSwitch(gate)
        if self._keeps:
            self.switch.attach(robot.links, robot.apply_safe)

    @contextmanager
    def gate(self) -> Iterator[Gate]:
        """Give the gate to one thread alone."""
        with self.switch.lock:
            yield self._gate

    def write(self, client: Client, values: Mapping[str, Any]) -> None:
        """Write values by their paths, all together.

        Raises UnknownName, ValueRangeError, AccessRefused, LeaseHeld or another LinkError. Nothing is sent if
        one of the values is wrong, or may not be written by this client.
        """
        if not values or len(values) > MOST:
            raise ValueRangeError(f"{len(values)} values; a write has 1 to {MOST}")
        group = ValueGroup({path: self._value(path, WriteValue) for path in values}, "write")
        values = {path: _number(group.writes[path], given) for path, given in values.items()}
        for value, number in group.chosen(values, {}).items():
            value.encode(number)  # raises before the lease is touched
        self._do(client, values, lambda: group.write(values))

    def pulse(self, client: Client, path: str, value: Any = 1) -> None:
        """Write a PULSE once. Raises what `write` raises."""
        strobe = self._value(path, PulseValue)
        strobe.codec.encode(value)
        self._do(client, {path: value}, lambda: strobe.pulse(value))

    def clear(self, client: Client, path: str, seen: Any) -> None:
        """Clear those flags of a W1C item that were seen. Raises what `write` raises."""
        flags = self._value(path, ClearValue)
        if seen is None:
            raise ValueRangeError(f"{path}: no value has come yet, so the flags to clear are not known")
        self._do(client, {path: format_value(seen)}, lambda: flags.clear(seen))

    def act(self, client: Client, paths: Iterable[str], send: Callable[[], T]) -> T:
        """Call `send` while nobody else writes, if this client may write the items. Return its result.

        Raises AccessRefused, LeaseHeld, or what `send` raises.
        """
        with self.switch.board:
            with self.gate() as gate:
                moment = now()
                for path in paths:
                    gate.check_write(client, path, moment)
            return send()

    def _do(self, client: Client, values: Mapping[str, Any], send: Callable[[], None]) -> None:
        def send_and_note() -> None:
            send()
            with self.gate() as gate:
                gate.wrote(client, dict(values), now())

        self.act(client, values, send_and_note)

    def stop(self, client: Client) -> int:
        """Write all SAFE values now, end all leases, and refuse writes until `arm`. Return how many values.

        The values are written at once, beside a request that is under way. Then the board's dead-man trips.
        Without one, they are written again when that request has ended. So they are the last that the board
        gets. Raises what `StopSwitch.stop` raises. Then the writes are refused all the same.
        """
        self.switch.stop(client)
        if self._keeps:
            self._note_safe(("",))
        return sum(value.writable and value.quantity.safe is not None for value in self._values.values())

    def arm(self, client: Client, stops: int) -> None:
        """Allow writes again, after a stop or after the board's dead-man has tripped.

        `stops` is the number of `switch.stops` that whoever asks has seen: a later stop wins.
        """
        self.switch.arm(client, stops=stops)

    def keep_safe(self) -> None:
        """End leases that are over, and write the SAFE values of their parts. Call it often.

        Raises a LinkError if the board did not answer. Then the parts stay closed, and the next call tries
        again. A server that shares the gate does this itself.
        """
        if not self._keeps:
            return
        self.switch.keep()
        with self.gate() as gate:
            gate.expire(now())
            unsafe = gate.unsafe()
        if unsafe:
            with self.switch.board:
                self.make_safe(unsafe)
                self._note_safe(unsafe)

    def make_safe(self, parts: Iterable[str]) -> None:
        """Write the SAFE values of all items of these parts together. The gate is not asked.

        A part is the path of an item, or of what has items in it; "" is the whole robot. If the board has
        tripped, it takes nothing, and has written all SAFE values itself. Raises LinkError.
        """
        parts = tuple(parts)
        safe = {
            path: value.quantity.safe
            for path, value in self._values.items()
            if isinstance(value, WriteValue)
            and value.quantity.safe is not None
            and any(contains(part, path) for part in parts)
        }
        if safe:
            with suppress(DeadManTripped):
                ValueGroup({path: self._values[path] for path in safe}, "safe").write(safe)

    def _note_safe(self, parts: tuple[str, ...]) -> None:
        with self.gate() as gate:
            for ending in gate.unsafe():
                if any(contains(part, ending) for part in parts):
                    gate.made_safe(ending, now())

    def _value(self, path: str, kind: type[T]) -> T:
        value: Value[Any] | None = self._values.get(path)
        if value is None:
            raise UnknownName(f"the robot has no item {shown(path)}")
        if not isinstance(value, kind):
            raise ValueRangeError(f"{path} is a {value.access}; this is not what can be done to it")
        return value


def _number(value: WriteValue[Any], given: Any) -> Any:
    """Return a value as the codec wants it. A browser sends as text what it cannot hold as a number."""
    if isinstance(given, str) and as_text(value):
        try:
            return int(given, 0)
        except ValueError:
            raise ValueRangeError(f"{value.path}: {shown(given)} is no whole number") from None
    return given
