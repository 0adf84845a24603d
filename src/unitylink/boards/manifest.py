# SPDX-License-Identifier: BSD-3-Clause
"""A board, from its manifest: chip, clock, link, pins, and the roles of the pins."""

from __future__ import annotations

import re
import sys
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from unitylink.errors import BoardError
from unitylink.interface.board_configuration import BoardConfiguration, told_engine, told_physical
from unitylink.interface.engine import too_fast
from unitylink.resources import resource_folder
from unitylink.settings import SETTINGS
from unitylink.spec.model import SEND_IMMEDIATE, Spec
from unitylink.spec.report.suggest import nearest

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

MANIFEST = "board.toml"
FAMILIES = ("ice40", "ecp5")
PHYSICAL = ("uart", "ft245_async", "ft245_sync", "spi")  # physical layers that `build` can put on pins
CHIP_CLOCK, CHIP_CLOCK_HZ = "ft245_clkout", 60_000_000  # clock of an FTDI chip in synchronous mode
# The roles of a pin: a port whose name has one of these words gets its pins (see pins.py).
ROLES = ("leds", "buttons", "pwm", "encoder", "io", "tripped")
_NAME = re.compile(r"[A-Za-z](\w*[A-Za-z0-9])?")  # no _ at the end, because such names are the wrapper's


@dataclass(frozen=True)
class Pin:
    """A pin: the board's name for it, the chip's name (`site`), and its electrical properties."""

    name: str
    site: str
    active_low: bool = False
    pull: str = "up"  # pull of an input: "up", "down" or "none"
    io: str = ""  # the input-output standard, for families that have several


@dataclass(frozen=True)
class Board:
    """The contents of a manifest.

    `roles` maps a role to its pins, in the order in which they are assigned.
    """

    name: str
    reference: str  # the argument with which load_board() finds it from any folder
    title: str
    path: Path
    pins_from: tuple[str, ...]
    notes: tuple[str, ...]
    family: str
    device: str
    package: str
    clock_pin: str
    clock_hz: int  # frequency of the oscillator
    design_hz: int  # the default clock of the design
    pll: str  # iCE40: "pad" if the clock's pin feeds the PLL directly, else "core"
    protocol: str  # the default protocol: "classic", "framed" or "both"
    physical: str  # the physical layer of the link
    rx: str  # this and the next three belong to a UART; "" without one
    tx: str
    baud_hz: int  # the default baud rate
    baud_hz_most: int
    link_pins: Mapping[str, tuple[str, ...]]  # for another physical layer than a UART: port -> pins
    # pins that are never driven, but pulled as the manifest says, such as a chip's reset
    released: tuple[str, ...]
    send_immediate: str  # for an FT245, as in physical_pkg.vhd
    flash: Mapping[str, tuple[str, ...]]  # program -> its options, the preferred one first
    pins: Mapping[str, Pin]
    roles: Mapping[str, tuple[str, ...]]

    @property
    def link_clock(self) -> str | None:
        """The pin on which the link's chip gives a clock of CHIP_CLOCK_HZ, or None."""
        return self.link_pins[CHIP_CLOCK][0] if self.physical == "ft245_sync" else None

    @property
    def fixed_pins(self) -> tuple[tuple[str, bool], ...]:
        """The pins that are assigned before all others, and whether each is an input."""
        line = ((self.rx, True), (self.tx, False)) if self.physical == "uart" else ()
        return ((self.clock_pin, True), *line)

    def configuration(
        self, spec: Spec, protocol: str | None = None, settings: Mapping[str, Any] | None = None
    ) -> BoardConfiguration:
        """Return the gateware that `spec` needs, on this board's link, changed by `settings`.

        If the small engine is requested, the link uses only frames. Raises BoardError if the spec names
        another kind of link, or if the line is too fast for that engine.
        """
        given = settings or {}
        told = told_physical(spec)
        if told is not None and told != self.physical:
            raise BoardError(
                f"{self.name}: its link is {self.physical}, and the spec says PHYSICAL={told}: take another "
                "board, or remove PHYSICAL from the spec's link"
            )
        small = given.get("engine", told_engine(spec)) == "small"
        link: dict[str, Any] = {"protocol": protocol or ("framed" if small else self.protocol)}
        if self.physical != "uart":
            told = next((device.link.send_immediate for device in spec.devices), None)
            link |= {"physical": self.physical, "send_immediate": told or self.send_immediate}
        made = BoardConfiguration.for_spec(spec, **{**link, **given})
        if wrong := too_fast(made):
            raise BoardError(f"{self.name}: {wrong}")
        return made


def board_names() -> list[str]:
    """Return the boards of this package. A variant has the form `ulx3s:25f`.

    >>> "icebreaker" in board_names(), "ulx3s:85f" in board_names()
    (True, True)
    """
    names = []
    for path in sorted(resource_folder("boards").glob(f"*/{MANIFEST}")):
        variants = _Table(path, _toml(path)).part("variants")
        names += [f"{path.parent.name}:{variant}" for variant in variants] or [path.parent.name]
    return names


def load_board(name: str) -> Board:
    """Return the board called `name`, or the board of a folder with your own board.toml.

        load_board("icebreaker")
        load_board("ulx3s:25f")
        load_board("./my_board")

    Raises BoardError if the board does not exist or its manifest is wrong.
    """
    place, _, variant = name.partition(":")
    own = Path(place)
    if own.name == MANIFEST:
        own = own.parent
    folder = own if (own / MANIFEST).is_file() else resource_folder("boards") / place
    if not _NAME.match(own.name) or not (folder / MANIFEST).is_file():
        raise BoardError(f"no board is called {name!r}; {_meant(name, board_names())}")
    table = _Table(folder / MANIFEST, _toml(folder / MANIFEST))
    variants = table.part("variants")
    if variant and variant not in list(variants):
        raise BoardError(f"{name}: {_meant(variant, variants, place + ':')}")
    if len(variants) and not variant:
        raise BoardError(f"{name} comes in variants: {', '.join(f'{place}:{v}' for v in variants)}")
    end = f":{variant}" if variant else ""
    reference = (place if folder != own else str(own.resolve())) + end
    return _board(own.name + end, reference, table, variants.part(variant) if variant else None)


def _board(name: str, reference: str, table: _Table, variant: _Table | None) -> Board:
    table.only("title", "pins_from", "notes", "chip", "variants", "clock", "link", "flash", "pins", "roles")
    chip, clock, link = table.part("chip"), table.part("clock"), table.part("link")
    chip.only("family", "device", "package", "io")
    clock.only("pin", "hz", "design_hz", "pll")
    physical = link.text("physical", among=PHYSICAL)
    uart = physical == "uart"
    link.only(
        "protocol",
        "physical",
        *(("rx", "tx", "baud_hz", "baud_hz_most") if uart else ("pins", "released", "send_immediate")),
    )
    link_pins = link.part("pins")
    if physical == "ft245_sync" and not link_pins.texts(CHIP_CLOCK):
        raise link_pins.wrong(CHIP_CLOCK, "has no pin, and the chip's clock is needed")
    io = chip.text("io", "")
    pins = {pin: _pin(table.part("pins"), pin, io) for pin in table.part("pins")}
    roles = table.part("roles")
    roles.only(*ROLES)
    flash = table.part("flash")
    board = Board(
        name=name,
        reference=reference,
        title=table.text("title"),
        path=table.path,
        pins_from=table.texts("pins_from"),
        notes=table.texts("notes", ()),
        family=chip.text("family", among=FAMILIES),
        device=variant.text("device") if variant else chip.text("device"),
        package=chip.text("package"),
        clock_pin=clock.text("pin", among=pins),
        clock_hz=clock.number("hz"),
        design_hz=clock.number("design_hz"),
        pll=clock.text("pll", "core", among=("core", "pad")),
        protocol=link.text("protocol", "both", among=SETTINGS["protocol"].choices),
        physical=physical,
        rx=link.text("rx", among=pins) if uart else "",
        tx=link.text("tx", among=pins) if uart else "",
        baud_hz=link.number("baud_hz") if uart else 0,
        baud_hz_most=link.number("baud_hz_most") if uart else 0,
        released=link.texts("released", (), among=pins),
        link_pins={port: link_pins.texts(port, among=pins) for port in link_pins},
        send_immediate=link.text("send_immediate", "both", among=SEND_IMMEDIATE),
        flash={program: flash.texts(program) for program in flash},
        pins=pins,
        roles={role: roles.texts(role, (), among=pins) for role in ROLES},
    )
    return board


def _pin(pins: _Table, name: str, io: str) -> Pin:
    if not re.fullmatch(_NAME, name):
        raise pins.wrong(name, "a pin's name begins with a letter and has letters, digits and _ only")
    if isinstance(pins.data[name], str):
        return Pin(name, pins.text(name), io=io)
    table = pins.part(name)
    table.only("site", "active", "pull", "io")
    return Pin(
        name,
        site=table.text("site"),
        active_low=table.text("active", "high", among=("high", "low")) == "low",
        pull=table.text("pull", "up", among=("up", "down", "none")),
        io=table.text("io", io),
    )


class _Table:
    """A table of a manifest. A mistake in it is reported with its key."""

    def __init__(self, path: Path, data: Any, key: str = "") -> None:
        self.path, self.data, self.key = path, data, key
        if not isinstance(data, dict):
            raise BoardError(f"{path}: {key} is {data!r}; expected a table")

    def wrong(self, key: str, text: str) -> BoardError:
        return BoardError(f"{self.path}: {self.key + '.' if self.key else ''}{key}: {text}")

    def __iter__(self) -> Iterator[str]:
        return iter(self.data)

    def __len__(self) -> int:
        return len(self.data)

    def only(self, *known: str) -> None:
        for key in self.data:
            if key not in known:
                raise self.wrong(key, f"there is no such key; {_meant(key, known)}")

    def part(self, key: str) -> _Table:
        name = f"{self.key}.{key}" if self.key else key
        return _Table(self.path, self.data.get(key, {}), name)

    def text(
        self, key: str, default: str | None = None, *, among: Sequence[str] | Mapping[str, Any] = ()
    ) -> str:
        value = self._value(key, default)
        if not isinstance(value, str):
            raise self.wrong(key, f"is {value!r}; expected a text")
        if among and value not in among and value != default:
            raise self.wrong(key, f"is {value!r}; {_meant(value, among)}")
        return value

    def texts(
        self, key: str, default: tuple[str, ...] | None = None, *, among: Mapping[str, Any] | None = None
    ) -> tuple[str, ...]:
        value = self._value(key, default)
        if not isinstance(value, (list, tuple)) or not all(isinstance(one, str) for one in value):
            raise self.wrong(key, f"is {value!r}; expected a list of texts")
        for one in value:
            if among is not None and one not in among:
                raise self.wrong(key, f"{one!r} is no pin of [pins]; {_meant(one, among)}")
        return tuple(value)

    def number(self, key: str) -> int:
        value = self._value(key, None)
        if not isinstance(value, int) or isinstance(value, bool) or value <= 0:
            raise self.wrong(key, f"is {value!r}; expected a number above 0")
        return value

    def _value(self, key: str, default: Any) -> Any:
        if key not in self.data and default is None:
            raise self.wrong(key, "is missing")
        return self.data.get(key, default)


def _toml(path: Path) -> dict[str, Any]:
    try:
        data: dict[str, Any] = tomllib.loads(path.read_text(encoding="utf-8"))
        return data
    except (ValueError, RecursionError) as error:  # TOMLDecodeError and UnicodeDecodeError are ValueErrors
        raise BoardError(f"{path}: {error}") from error
    except OSError as error:
        raise BoardError(f"{path}: {error.strerror or error}") from error


def _meant(name: str, among: Iterable[str], prefix: str = "") -> str:
    """Return a remedy: the name that was probably meant, or all names."""
    near = nearest(name, among)
    return (
        f"did you mean {prefix}{near}?" if near else f"there are: {', '.join(prefix + one for one in among)}"
    )
