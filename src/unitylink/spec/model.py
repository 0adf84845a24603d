# SPDX-License-Identifier: BSD-3-Clause
"""The resolved specification, which every generator, tool and layer reads. It is frozen.

A `Spec` is a tree. Each public constructor is one root `Instance`. An instance holds, in source order,
`Instance`s (expansions), `Element`s (words at an address) and `Group`s (aliases of elements). Two instances
of one constructor with the same shape share `constructor`. So a generator can make one class for each
constructor. All addresses are absolute: they are word addresses on the bus, and the BASE of the link binding
has been added.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import Union

from ..protocol import BASE_HZ_DEFAULT, DATA_BITS_MAX, TOSNET_ADDRESS_BITS
from ..settings import SETTINGS
from .annotation import Annotation
from .types import EnumType, Number, ValueType

READS = ("READ", "READWRITE", "W1C", "READCLEAR")
WRITES = ("WRITE", "READWRITE", "W1C", "PULSE")


@dataclass(frozen=True)
class Span:
    """A place in a source file.

    Line and column count from 1, offsets from 0. All of them count characters.
    """

    file: str
    line: int
    column: int
    start: int
    end: int


@dataclass(frozen=True)
class Publish:
    """How an element publishes: `mode` 1 means hardware (the gateware sends), 2 means software (the PC
    polls).

    With `trigger` "rate", `divisor` divides the gateware's base publish frequency (base 1000 Hz, 10 -> 100
    Hz), and `rate_hz` is the result. With "event", each rising edge of the event line `event` triggers it.
    With "change", each change of the value does. Both have divisor 0. `group` names a snapshot group. With
    "", all publishes with the same trigger and rate share it.
    """

    mode: int
    divisor: int
    rate_hz: float | None = None
    trigger: str = "rate"
    event: str = ""
    group: str = ""


CYCLE = "cycle"  # the event of a device with a ring: each of its cycles, after the words have been exchanged


TOSNET_NODES = ("inside", "ring")  # where the other nodes of a TosNet are


@dataclass(frozen=True)
class RingOptions:
    """What a TOSNET says about its ring. None means the default.

    `node` is the PC's own node, `baud_hz` the line rate between nodes, and `cycle_hz` the rate of the network
    cycle. `nodes` is one of TOSNET_NODES: "ring" for nodes of their own behind a line, "inside" for logic in
    the PC's FPGA that takes their place. There are `rings` rings. The check of a packet has `check_bytes`
    bytes. `time` is the OUT word of the PC's node that carries the clock of the ring.
    """

    node: int | None = None
    baud_hz: int | None = None
    cycle_hz: int | None = None
    nodes: str = "inside"
    rings: int = 1
    check_bytes: int = 1
    time: int | None = None

    @property
    def exact_hops(self) -> bool:
        """Do all nodes take the same time for a hop? Then their strobes are at the same moment."""
        return self.rings > 1 or self.time is not None


@dataclass(frozen=True)
class LinkBinding:
    """The hardware proxy of an instance and of everything below it.

    `kind` is "memory" (plain memory, the default at base 0), "tosnet", "double_buffer" or "fifo". `ctrl` and
    `comm` name the run-time parameters of the public constructor that were bound to it. None means the
    default. `size` is the number of words of a double buffer, or the depth of a FIFO. `link` is the name of
    the declared `Link`. `ring` is for "tosnet".
    """

    kind: str
    base: int = 0
    ctrl: str | None = None
    comm: str | None = None
    size: int = 0
    link: str = ""
    ring: RingOptions = RingOptions()

    @property
    def words(self) -> int:
        """How many words from `base` on belong to the hardware itself. It is 0 for plain memory."""
        if self.kind == "double_buffer":
            return self.size + 1  # the last word is the commit
        return {"tosnet": 1 << TOSNET_ADDRESS_BITS, "fifo": 3}.get(self.kind, 0)

    def event_at(self, path: str) -> str:
        """Return the event that the hardware at `path` itself has, or ""."""
        return f"{path}.arrival".lstrip(".") if self.kind == "fifo" else ""


@dataclass(frozen=True)
class Element:
    """One value at an address: the PC reads it, writes it, or both.

    Its engineering value is raw * `scale` + `offset` in `unit`. `minimum`, `maximum`, `initial` and `safe`
    are engineering values. A value of several `words` has its low word at `address`.
    """

    name: str  # "pos", or "duty[2]" in an array
    path: str  # with dots, without the root: "j1.cpos", "j[2].pos"
    address: int
    access: str  # READ, WRITE, READWRITE, W1C (write 1 to clear), PULSE (write-only strobe), READCLEAR
    type: ValueType
    display: str  # ID after evaluation ("joint 1:cpos"), or the path if there is no ID
    checked: bool  # CRC
    publish: Publish | None
    link: LinkBinding
    span: Span
    documentation: str = ""
    unit: str = ""
    words: int = 1
    scale: Number = 1
    offset: Number = 0
    minimum: Number | None = None
    maximum: Number | None = None
    overflow: str = "error"  # "error" or "saturate": the effect of a write beyond the limits
    initial: Number | None = None
    safe: Number | None = None  # its value after the link is lost
    annotations: tuple[Annotation, ...] = ()
    array: str = ""  # the array's name if it belongs to an array
    index: int | None = None

    @property
    def signed(self) -> bool:
        """Is the raw word two's complement?"""
        return self.type.signed

    @property
    def readable(self) -> bool:
        return self.access in READS

    @property
    def writable(self) -> bool:
        return self.access in WRITES

    @property
    def pollable(self) -> bool:
        """Whether it may be read without being named. It may not if a read changes something."""
        return self.readable and self.access != "READCLEAR"

    @property
    def addresses(self) -> tuple[int, ...]:
        """The addresses of its words, with the low word first."""
        return tuple(range(self.address, self.address + self.words))


@dataclass(frozen=True)
class Group:
    """Another name for a list of elements: one write, one snapshot, one callback."""

    name: str
    path: str
    elements: tuple[Element, ...]
    span: Span
    documentation: str = ""
    annotations: tuple[Annotation, ...] = ()


@dataclass(frozen=True)
class Carried:
    """A word of a component in a node of a ring, which a word of the shared memory stands for.

    `offset` is its place in the component, and `address` that of the other word on the PC's bus. It is
    `inward` if the PC writes it.
    """

    offset: int
    address: int
    inward: bool


@dataclass(frozen=True)
class Component:
    """The entity for an instance. It is at `base` and takes `words`.

    `generics` are the values that the spec gives. `pins` and `events` are its ports beside the bus: (port,
    "in" | "out", bits; 0 for a single signal). `sources` are the VHDL files of an entity that is not of the
    library. `clock_least_hz` is the slowest clock of a design with it, 0 if any will do. `wires` are ports
    for one value of 32 bits: (port, "in" | "out", the element with this value). `connections` lead to other
    components: (own port, "in" | "out", path of the other instance, its port).

    With a `node`, it is in this node of a ring, and `base` is on the node's own bus. Then the PC reaches only
    the words that are `carried`. `constants` are further elements, which have their INITIAL and SAFE values.
    Their addresses count from the component's first word.
    """

    entity: str
    base: int
    words: int
    generics: tuple[tuple[str, int | str], ...] = ()
    pins: tuple[tuple[str, str, int], ...] = ()
    events: tuple[str, ...] = ()
    sources: tuple[str, ...] = ()
    clock_least_hz: int = 0
    wires: tuple[tuple[str, str, str], ...] = ()
    connections: tuple[tuple[str, str, str, str], ...] = ()
    node: int | None = None
    carried: tuple[Carried, ...] = ()
    constants: tuple[Element, ...] = ()


@dataclass(frozen=True)
class Instance:
    """One expansion of a constructor. The root instance of a public constructor has path ""."""

    name: str
    path: str
    constructor: str
    display: str  # value of the first string argument, or else the path
    link: LinkBinding
    members: tuple[Member, ...]
    parameters: tuple[str, ...]  # run-time parameters (CTRL or COMM), only on roots
    span: Span
    documentation: str = ""
    annotations: tuple[Annotation, ...] = ()
    component: Component | None = None
    # the array's name if it belongs to an array: then `name` is "j[2]", `array` "j", `index` 2
    array: str = ""
    index: int | None = None

    @property
    def instances(self) -> tuple[Instance, ...]:
        return tuple(m for m in self.members if isinstance(m, Instance))

    @property
    def elements(self) -> tuple[Element, ...]:
        return tuple(m for m in self.members if isinstance(m, Element))

    @property
    def groups(self) -> tuple[Group, ...]:
        return tuple(m for m in self.members if isinstance(m, Group))

    def walk(self) -> Iterator[Element]:
        """Yield every element below, in source order."""
        for member in self.members:
            if isinstance(member, Element):
                yield member
            elif isinstance(member, Instance):
                yield from member.walk()

    def only(self, wanted: Callable[[Element], bool]) -> Instance | None:
        """Return the instance with only the `wanted` elements and their parents.

        Return None if there are none.
        """
        members: list[Member] = []
        kept = any(map(wanted, self.walk()))
        for member in self.members:
            part: Member | None
            if isinstance(member, Instance) and member.component is not None and not member.members:
                part = member if kept else None  # in a node of a ring; none of its words travels
            elif isinstance(member, Instance):
                part = member.only(wanted)
            elif isinstance(member, Group):
                elements = tuple(element for element in member.elements if wanted(element))
                part = replace(member, elements=elements) if elements else None
            else:
                part = member if wanted(member) else None
            if part is not None:
                members.append(part)
        return replace(self, members=tuple(members)) if members else None


Member = Union[Instance, Element, Group]


PHYSICAL_LAYERS = SETTINGS["physical"].choices  # gateware/physical
LINES = ("uart", "rs485")  # the layers that have a baud rate
SEND_IMMEDIATE = SETTINGS["send_immediate"].choices  # for an FT245, as in physical_pkg
ENGINES = SETTINGS["engine"].choices  # engines of the framed protocol, as in engine_pkg


@dataclass(frozen=True)
class Link:
    """A declared link: `link NAME (DATA=32, ADDRESS=8, BASE_RATE=1000 Hz, BAUD=3000000, PHYSICAL=uart);`.

    `physical` is one of PHYSICAL_LAYERS, `engine` one of ENGINES. `send_immediate` is for the FT245 layers,
    `node` for rs485. `stated` names the properties that the spec gives. The others are defaults, or None.
    """

    name: str
    data_bits: int = DATA_BITS_MAX
    address_bits: int | None = None  # None means: as wide as the highest address needs
    base_hz: int = BASE_HZ_DEFAULT  # the base publish frequency
    baud_hz: int | None = None
    stated: tuple[str, ...] = ()
    documentation: str = ""
    physical: str | None = None  # None means: whatever the board has, or a UART
    send_immediate: str | None = None
    node: int | None = None
    engine: str | None = None  # None means: the small one if it is enough


@dataclass(frozen=True)
class SubscriptionGroup:
    """Values that the gateware publishes together, as one snapshot.

    `number` is that of the gateware's group and of its event line. `rate_hz` is also known of the cycle of a
    ring, which has no divisor."""

    number: int
    name: str  # the name in the spec, or "100 Hz", "on limit", "on change"
    trigger: str  # "rate", "event" or "change"
    divisor: int
    rate_hz: float | None
    event: str
    elements: tuple[Element, ...]

    @property
    def addresses(self) -> tuple[int, ...]:
        """Every word of the group, in the order of a publish."""
        return tuple(address for element in self.elements for address in element.addresses)


@dataclass(frozen=True)
class Device:
    """One address space with its own gateware. One public constructor reaches it through one COMM."""

    root: str
    comm: str | None
    link: Link
    groups: tuple[SubscriptionGroup, ...]


@dataclass(frozen=True)
class Spec:
    """A compiled UL-spec.

    `hash` is 16 hex digits over the interface and everything that reaches the wire (names, addresses, access,
    types, scaling, CRC, publish, links, groups). It does not depend on comments, layout or display names.
    `source` is the file's name without folders.
    """

    name: str
    package: str
    source: str
    hash: str
    roots: tuple[Instance, ...]
    enums: tuple[EnumType, ...] = ()
    bits: tuple[ValueType, ...] = ()
    links: tuple[Link, ...] = ()  # as declared; a spec without links has one with the spec's name
    devices: tuple[Device, ...] = ()

    def root(self, name: str | None = None) -> Instance:
        """Return the public constructor `name`, or the only one. Raises KeyError, which names the choices."""
        for root in self.roots:
            if root.name == name or (name is None and len(self.roots) == 1):
                return root
        choices = ", ".join(r.name for r in self.roots)
        raise KeyError(f"no public constructor {name!r}; there are: {choices}")

    @property
    def boards(self) -> tuple[Spec, ...]:
        """The part of the spec for each board. Behind each link there is one board, with gateware of its own.

        If all devices have the same link, the only part is the spec itself. A part has the name of its public
        constructor. If it is not exactly one constructor, it has the name of its link.
        """
        links = dict.fromkeys(device.link.name for device in self.devices)
        return tuple(self._behind(link) for link in links) if len(links) > 1 else (self,)

    def only(self, name: str) -> Spec:
        """Return the part of the spec for one public constructor, or the part behind the link of that name.

        Raises KeyError, which names the choices.
        """
        if any(root.name == name for root in self.roots):
            devices = tuple(device for device in self.devices if device.root == name)
            part = replace(self, roots=(self.root(name),), devices=devices)
            return replace(part, name=name) if len(self.roots) > 1 else part
        links = dict.fromkeys(device.link.name for device in self.devices)
        if len(links) == 1:
            links.clear()
        if name in links:
            return self._behind(name)
        what = "public constructor or link" if links else "public constructor"
        choices = ", ".join(dict.fromkeys([*(root.name for root in self.roots), *links]))
        raise KeyError(f"no {what} {name!r}; there are: {choices}")

    def _behind(self, link: str) -> Spec:
        """Return the part behind a link. It may be a part of a public constructor."""
        devices = tuple(device for device in self.devices if device.link.name == link)
        comms = {(device.root, device.comm) for device in devices}

        def there(root: str) -> Callable[[Element], bool]:
            return lambda element: (root, element.link.comm) in comms

        parts = (root.only(there(root.name)) for root in self.roots)
        roots = tuple(part for part in parts if part is not None)
        whole = [device for device in self.devices if device.root == roots[0].name]
        name = roots[0].name if len(roots) == 1 and len(whole) == len(devices) else link
        return replace(self, name=name, roots=roots, devices=devices)

    def walk(self) -> Iterator[tuple[str, Element]]:
        """Yield (qualified path, element). With several roots the path starts with the root's name."""
        several = len(self.roots) > 1
        for root in self.roots:
            for element in root.walk():
                yield (f"{root.name}.{element.path}" if several else element.path), element
