# SPDX-License-Identifier: BSD-3-Clause
"""A part of a robot: the base of generated classes."""

from __future__ import annotations

from collections.abc import AsyncIterator, Callable, Iterator
from contextlib import contextmanager
from difflib import get_close_matches
from typing import TYPE_CHECKING, Any, TypeVar

from unitylink.errors import AssignmentError, UnknownName, shown

from .assignment import Array, refuse
from .binding import Tree
from .cycle import Cycle
from .dead_man import DeadMen
from .group import ValueGroup
from .html import values_html
from .read_value import ReadClearValue, ReadValue
from .recording import Recording
from .snapshot import Snapshot
from .value import Value
from .write_value import ClearValue, PulseValue, ReadWriteValue, WriteValue

V = TypeVar("V", bound=Value[Any])

if TYPE_CHECKING:
    from typing_extensions import Self

    from unitylink.layer2_message import Link
    from unitylink.layer3_hardware import HardwareProxy

    from .publishing import Publisher


class Node:
    """Hold the values, groups and parts of one expansion of a constructor, under the names of the spec.

    `node["j1.cpos"]` finds a part by its path. Iteration gives every value below. `snapshot()` reads all
    READs at once.

    >>> for value in robot:                                   # doctest: +SKIP
    ...     print(value.path, hex(value.address))
    >>> with robot.publishing():                              # doctest: +SKIP
    ...     robot.on_publish(lambda time_s, s: print(s["j1.cpos"]))
    """

    _closed = True
    name: str
    path: str
    display: str
    publisher: Publisher

    def __init__(self, parent: Node | Tree, name: str) -> None:
        if isinstance(parent, Node):
            self._tree: Tree = parent._tree
            self._hardware: HardwareProxy = parent._hardware
            path = f"{parent.path}.{name}" if parent.path else name
            parent._members[name] = self
        else:
            self._tree = parent
            self._hardware = parent.hardware("memory")
            path = ""
        display = self._tree.names.get(path, path or name)
        self.__dict__.update(name=name, path=path, display=display, publisher=self._tree.publisher)
        self._members: dict[str, Value[Any] | ValueGroup | Node] = {}
        self._whole: ValueGroup | None = None
        self._feed: ValueGroup | None = None

    def __init_subclass__(cls, *, closed: bool = False, **more: Any) -> None:
        """Generated classes are `closed`: they have only the attributes of the spec."""
        super().__init_subclass__(**more)
        cls._closed = closed

    def __setattr__(self, name: str, value: object) -> None:
        """Set each member only once. If a number replaced a value, nothing could write the value any more."""
        held = self.__dict__.get(name)
        if name.startswith("_"):
            pass
        elif held is not None:
            refuse(self._path(name), held, value)
        elif self._closed and not isinstance(value, (Value, ValueGroup, Node, tuple)):
            near = get_close_matches(name, self.__dict__, n=1)
            hint = f"; did you mean {self._path(near[0])}?" if near else ""
            raise AssignmentError(f"{self.path or self.name} has no {name}{hint}")
        elif type(value) is tuple:
            value = Array(self._path(name), value)
        object.__setattr__(self, name, value)

    def __setitem__(self, path: str, value: object) -> None:
        """Refuse the assignment, because a write was probably meant."""
        refuse(self._path(path), self[path], value)

    # Generated classes, and trees that are made from a Spec, call these methods when they are built.

    def _bind(self, kind: str, **binding: Any) -> None:
        self._hardware = self._tree.hardware(kind, **binding)

    def _read(self, name: str, **facts: Any) -> ReadValue[Any]:
        return self._value(ReadValue, name, facts)

    def _write(self, name: str, **facts: Any) -> WriteValue[Any]:
        return self._value(WriteValue, name, facts)

    def _read_write(self, name: str, **facts: Any) -> ReadWriteValue[Any]:
        return self._value(ReadWriteValue, name, facts)

    def _read_clear(self, name: str, **facts: Any) -> ReadClearValue[Any]:
        return self._value(ReadClearValue, name, facts)

    def _clear(self, name: str, **facts: Any) -> ClearValue[Any]:
        return self._value(ClearValue, name, facts)

    def _pulse(self, name: str, **facts: Any) -> PulseValue[Any]:
        return self._value(PulseValue, name, facts)

    def _value(self, kind: type[V], name: str, facts: dict[str, Any]) -> V:
        path = self._path(name)
        facts.setdefault("words", 1)
        value = kind(
            path,
            self._hardware,
            self._tree.addresses[path],
            display=self._tree.names.get(path, path),
            publisher=self.publisher,
            classes=self._tree.classes,
            **facts,
        )
        self._members[name] = value
        return value

    def _group(self, name: str, *paths: str) -> ValueGroup:
        members: dict[str, Value[Any]] = {}
        for path in paths:
            member = self[path]
            if isinstance(member, Value):
                members[path] = member
        group = ValueGroup(members, self._path(name))
        self._members[name] = group
        return group

    def _path(self, name: str) -> str:
        return f"{self.path}.{name}" if self.path else name

    # Finding

    def __iter__(self) -> Iterator[Value[Any]]:
        for member in self._members.values():
            if isinstance(member, Value):
                yield member
            elif isinstance(member, Node):
                yield from member

    def __getitem__(self, path: str) -> Value[Any] | ValueGroup | Node:
        """Return the value, group or part at a path of names.

        Raises UnknownName, which lists similar names.
        """
        if not isinstance(path, str):
            raise UnknownName(f"{self.path or self.name}: names are text, not {shown(path)}")
        here: Value[Any] | ValueGroup | Node = self
        for step in path.split("."):
            if not isinstance(here, Node) or step not in here._members:
                start = len(self.path) + 1 if self.path else 0
                near = get_close_matches(path, [value.path[start:] for value in self], n=1)
                hint = f"; did you mean {near[0]}?" if near else ""
                raise UnknownName(f"no {path!r} in {self.path or self.name}{hint}")
            here = here._members[step]
        return here

    def _repr_html_(self) -> str:
        """Return what a notebook shows: all values below."""
        return values_html(self.display, self)

    def _ipython_key_completions_(self) -> list[str]:
        """Return what a notebook offers after `robot["`."""
        start = len(self.path) + 1 if self.path else 0
        return [value.path[start:] for value in self]

    def __repr__(self) -> str:
        return f"<{type(self).__name__} {self.path or self.name}: {', '.join(self._members)}>"

    # Doing

    def snapshot(self, *, consistent: bool = True, timeout_s: float | None = None) -> Snapshot:
        """Read every READ below at once. Keys are paths relative to this node. See ValueGroup.snapshot.

        Values that a read would change (READCLEAR) are left out.
        """
        return self._all().snapshot(consistent=consistent, timeout_s=timeout_s)

    def apply_initial(self, *, timeout_s: float | None = None) -> None:
        """Write the INITIAL values of everything below, together. On TosNet this is one commit.

        Opening a link writes nothing, because a running robot must not jump.
        """
        self._apply("initial", timeout_s)

    def apply_safe(self, *, timeout_s: float | None = None) -> None:
        """Write the SAFE values of everything below, together.

        Values without a SAFE value are not written.
        """
        self._apply("safe", timeout_s)

    def _apply(self, which: str, timeout_s: float | None) -> None:
        known = {
            key: getattr(value.quantity, which)
            for key, value in self._all().writes.items()
            if getattr(value.quantity, which) is not None
        }
        if known:
            self._all().write(known, timeout_s=timeout_s)

    def cycle(self) -> Cycle:
        """Return a Cycle: each call writes every WRITE below and reads every READ."""
        return self._all().cycle()

    @property
    def links(self) -> tuple[Link, ...]:
        """The links of the values below, each once. For example, call `link.health()` on each."""
        return tuple(dict.fromkeys(value.hardware.link for value in self))

    @property
    def dead_man(self) -> DeadMen:
        """The dead-men, which make outputs safe if this program is silent: `start`, `tripped`, `arm`."""
        return DeadMen(self.links)

    def on_publish(self, callback: Callable[[float, Snapshot], object]) -> Callable[[], None]:
        """Call `callback(time_s, snapshot)` for each set of fresh samples of all published values below."""
        return self._published().on_publish(callback)

    def on_change(self, callback: Callable[[Snapshot], object]) -> Callable[[], None]:
        """Call `callback(snapshot)` for each set in which a published value below has changed."""
        return self._published().on_change(callback)

    def publishes(self) -> AsyncIterator[tuple[float, Snapshot]]:
        """Iterate over consistent sets: `async for time_s, snapshot in robot.publishes():`."""
        return self._published().publishes()

    def start_publishing(self, *, fallback: bool = False) -> None:
        """Start the whole tree's publishes.

        With `fallback`, the PC polls those that do not fit into the gateware.
        """
        self.publisher.start(fallback=fallback)

    def stop_publishing(self) -> None:
        """Stop publishing, for the whole tree."""
        self.publisher.stop()

    @contextmanager
    def publishing(self, *, fallback: bool = False) -> Iterator[Self]:
        """Publish within a `with` block."""
        with self.publisher.running(fallback=fallback):
            yield self

    def record(self) -> Recording:
        """Record the publishes and the written set-points within a `with` block."""
        return Recording(self.publisher, self._all().writes.values())

    def _all(self) -> ValueGroup:
        if self._whole is None:
            start = len(self.path) + 1 if self.path else 0
            values = {value.path[start:]: value for value in self if value.pollable or value.writable}
            self._whole = ValueGroup(values, self.path or self.name)
        return self._whole

    def _published(self) -> ValueGroup:
        if self._feed is None:
            start = len(self.path) + 1 if self.path else 0
            values = {
                value.path[start:]: value
                for value in self
                if isinstance(value, ReadValue) and value.publish is not None
            }
            self._feed = ValueGroup(values, self.path or self.name)
        return self._feed
