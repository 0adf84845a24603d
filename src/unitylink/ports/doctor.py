# SPDX-License-Identifier: BSD-3-Clause
"""The doctor: it takes a link and returns findings, with the worst first.

It first asks the operating system, then opens the port, then tries the link. The first step that fails is the
cause of all later failures.
"""

from __future__ import annotations

import shlex
import time
from collections.abc import Callable
from dataclasses import dataclass
from statistics import median
from typing import TYPE_CHECKING, Protocol
from urllib.parse import parse_qsl

from unitylink import protocol
from unitylink.errors import BusError, DeviceMismatch, LinkError, LinkTimeout, UrlError
from unitylink.interface.wire_hash import part_behind
from unitylink.layer0_driver import Driver
from unitylink.layer2_message import Link, check_url

from .findings import Finding, finding
from .ftdi import chosen, ftdi_channels
from .machine import Machine
from .probe import WAIT_S, Answer, find_polynomial, probe
from .probe import request as configuration_request
from .udev import program

if TYPE_CHECKING:
    from unitylink.spec.model import Element, Spec

BAUD_RATES_HZ = (
    3_000_000,
    115_200,
    1_000_000,
    12_000_000,
    2_000_000,
    921_600,
    460_800,
    6_000_000,
    230_400,
    9_600,
    57_600,
    500_000,
)
_NETWORK = ("tcp", "udp")
_ROUND_TRIPS = 50
_SLACK_S = 0.005  # time that an operating system may need
_SAMPLE_BYTES = 24


class OpenedDriver(Protocol):
    def send(self, data: bytes, *, timeout_s: float = ...) -> None: ...
    def receive(self, *, timeout_s: float = ...) -> bytes: ...
    def close(self) -> None: ...


@dataclass(frozen=True)
class _Place:
    """A link URL, taken apart."""

    url: str
    scheme: str
    path: str
    options: dict[str, str]
    baud_hz: int

    @classmethod
    def of(cls, url: str) -> _Place:
        check_url(url)
        scheme, _, rest = url.partition(":")
        path, _, query = rest.partition("?")
        options = dict(parse_qsl(query))
        try:
            baud_hz = _number(options.get("baud", "0"))
        except ValueError:
            wrong = f"baud={options['baud']} is not a baud rate such as 3000000"
            raise UrlError(f"link URL {url!r}: {wrong}") from None
        return cls(url, scheme, path, options, baud_hz)

    @property
    def name(self) -> str:
        """The user's name for it: `/dev/ttyUSB0`, `tcp://10.0.0.2:5555`."""
        return self.path if self.scheme == "serial" else f"{self.scheme}:{self.path}"

    @property
    def host_and_port(self) -> tuple[str, str]:
        host, _, port = self.path.lstrip("/").rpartition(":")
        return host or self.path, port

    @property
    def polynomial(self) -> int | None:
        text = self.options.get("polynomial", str(protocol.CRC8_POLYNOMIAL))
        return None if text in ("xor", "none") else _number(text)

    @property
    def checksums(self) -> bool:
        """It is False if the URL says that the gateware has no checksums.

        Such gateware must not get a `$`.
        """
        return self.options.get("polynomial") != "none"

    def with_option(self, name: str, value: object) -> str:
        options = {**self.options, name: str(value)}
        return f"{self.scheme}:{self.path}?" + "&".join(f"{key}={text}" for key, text in options.items())


def examine(
    url: str,
    *,
    spec: Spec | None = None,
    machine: Machine | None = None,
    open_driver: Callable[[str], OpenedDriver] = Driver,
    open_link: Callable[[str], Link] = Link,
    wait_s: float = WAIT_S,
    clock: Callable[[], float] = time.monotonic,
    say: Callable[[str], None] = lambda message: None,
) -> list[Finding]:
    """Return what keeps a user from the board at `url`. The list is empty if nothing does.

    `say` gets a text about each step. Raises UrlError if it is not a link URL.
    """
    return _Doctor(
        _Place.of(url), spec, machine or Machine(), open_driver, open_link, wait_s, clock, say
    ).examine()


_FRAMED_ONLY = ("rs485", "serve")


@dataclass
class _Doctor:
    place: _Place
    spec: Spec | None
    machine: Machine
    open_driver: Callable[[str], OpenedDriver]
    open_link: Callable[[str], Link]
    wait_s: float
    clock: Callable[[], float]
    say: Callable[[str], None]

    def examine(self) -> list[Finding]:
        found = {"serial": self.port, "ftdi": self.chip, "spi": self.spi, "rs485": self.port}.get(
            self.place.scheme, list
        )()
        if not _stopped(found):
            found += self.device()
        return sorted(found, key=lambda f: ("error", "warning", "note").index(f.severity))

    # ---- the port, as the operating system sees it

    def port(self) -> list[Finding]:
        device, machine = self.place.path, self.machine
        self.say(f"looking at {device}")
        if not machine.exists(device):
            ports = ", ".join(port.device for port in machine.serial_ports()) or "none"
            absent = [finding("no-port", device=device, ports=ports)]
            return absent + ([finding("brltty", device=device)] if machine.runs("brltty") else [])
        if not machine.is_serial(device):
            return [finding("no-serial-port", device=device)]
        found = self.access(device)
        if machine.modem_manager_probes(device):
            link = shlex.quote(self.place.url)
            found.append(finding("modem-manager", device=device, program=program(), link=link))
        latency_ms = machine.serial_port(device).latency_timer_ms
        if latency_ms is not None and latency_ms > 1:
            name = device.rpartition("/")[2]
            found.append(finding("latency-timer", device=device, latency_ms=latency_ms, name=name))
        return found

    def access(self, device: str) -> list[Finding]:
        """Find who may open an existing device file, and who has it open."""
        found = []
        if not self.machine.may_open(device):
            found.append(finding("permission", device=device, group=self.machine.group_of(device)))
        if holders := self.machine.holders(device):
            names = ", ".join(f"{holder.command} (process {holder.pid})" for holder in holders)
            pids = " ".join(str(holder.pid) for holder in holders)
            found.append(finding("busy-port", device=device, holders=names, pids=pids))
        return found

    def spi(self) -> list[Finding]:
        device = self.place.path
        self.say(f"looking at {device}")
        if not self.machine.exists(device):
            ports = ", ".join(self.machine.spi_ports()) or "none"
            return [finding("no-spi", device=device, ports=ports)]
        return self.access(device)

    def chip(self) -> list[Finding]:
        """Look at the FTDI chip as a USB device."""
        place, channels = self.place, ftdi_channels(self.machine)
        self.say("looking at the FTDI chips")
        channel = place.options.get("channel", "A")
        found = chosen(channels, place.path, channel)
        if found is None:
            wanted = f"channel {channel} of {place.path or 'the one FTDI chip'}"
            chips = ", ".join(one.url for one in channels) or "none"
            return [finding("no-ftdi", wanted=wanted, chips=chips)]
        if found.node and not self.machine.may_open(found.node):
            serial, link = found.port.serial_number, shlex.quote(place.url)
            return [finding("ftdi-permission", node=found.node, serial=serial, program=program(), link=link)]
        return []

    # ---- the other end

    def device(self) -> list[Finding]:
        place = self.place
        if place.scheme in _FRAMED_ONLY:
            return self.by_frames()
        try:
            driver = self.open_driver(place.url)
        except LinkError as error:
            if place.scheme in _NETWORK:
                return [self.unreachable(error)]
            if place.scheme == "ftdi":
                return [finding("ftdi-refused", reason=error.message)]
            raise
        try:
            self.say("asking for its configuration")
            answer = self.probe(driver)
            if answer.kind != "configuration":
                return self.wrong_answer(driver, answer)
            found = self.round_trips(driver)
        except LinkError as error:
            if place.scheme in _NETWORK:
                return [self.unreachable(error)]
            raise  # the driver says what happened to its port, and there is no host to ping
        finally:
            driver.close()
        if self.spec is not None and not _stopped(found):
            found += self.against_spec(self.spec)
        return found

    def by_frames(self) -> list[Finding]:
        """Ask a node on a pair, or a server. They know only frames, so this tells whether they answer."""
        self.say("asking for its configuration")
        try:
            self.open_link(self.place.url).close()
        except LinkTimeout:
            return [finding("silence", place=self.place.name, waited_s=self.wait_s, baud_rates_tried="")]
        return self.against_spec(self.spec) if self.spec is not None else []

    def unreachable(self, error: LinkError) -> Finding:
        host, port = self.place.host_and_port
        place = self.place.name
        reason = error.message.removeprefix(f"{place}: ")
        return finding("unreachable", place=place, reason=reason, host=host, port=port)

    def probe(self, driver: OpenedDriver, *, checked: bool = True) -> Answer:
        polynomial = self.place.polynomial
        checked = checked and self.place.checksums
        return probe(driver, checked=checked, polynomial=polynomial, wait_s=self.wait_s, clock=self.clock)

    def wrong_answer(self, driver: OpenedDriver, answer: Answer) -> list[Finding]:
        place = self.place.name
        if answer.kind == "busy":
            return [finding("board-busy", place=place)]
        if answer.kind == "line-errors":
            shown = _sample(answer.received)
            return [finding("line-errors", answer=shown, errors=answer.detail)]
        if answer.kind == "echo":
            return [finding("echo", place=place)]
        self.say("asking without a checksum")
        plain = self.probe(driver, checked=False)
        if plain.kind == "configuration":
            return self.without_checksum(driver, answer)
        if plain.kind == "refused" or answer.kind == "refused":
            link = self.place.with_option("address_bytes", 1) + "&data_bytes=4"
            refusal = plain.detail if plain.kind == "refused" else answer.detail
            return [finding("no-configuration", answer=refusal, link_with_widths=link)]
        if right := self.other_baud_rate():
            link = self.place.with_option("baud", right)
            return [
                finding(
                    "wrong-baud", baud_hz=self.place.baud_hz, right_baud_hz=right, link_with_right_baud=link
                )
            ]
        if answer.kind == "garbage":
            shown = _sample(answer.received)
            return [finding("garbage", place=place, count=len(answer.received), sample=shown)]
        tried = " at any usual baud rate" if self.place.scheme == "serial" else ""
        return [finding("silence", place=place, waited_s=self.wait_s, baud_rates_tried=tried)]

    def without_checksum(self, driver: OpenedDriver, answer: Answer) -> list[Finding]:
        if answer.kind == "checksum":
            self.say("trying all checksums")
            polynomial = find_polynomial(driver, wait_s=self.wait_s, clock=self.clock)
            if polynomial is not None:
                text = "xor" if polynomial == 0 else f"0x{polynomial:02X}"
                link = self.place.with_option("polynomial", text)
                return [finding("checksum", polynomial=text, link_with_polynomial=link)]
        return [finding("no-checksum", link_without_checksums=self.place.with_option("polynomial", "none"))]

    def other_baud_rate(self) -> int | None:
        """Return the baud rate at which the device answers. Only serial ports have one."""
        if self.place.scheme != "serial":
            return None
        for baud_hz in BAUD_RATES_HZ:
            if baud_hz == self.place.baud_hz:
                continue
            self.say(f"trying {baud_hz} baud")
            try:
                driver = self.open_driver(self.place.with_option("baud", baud_hz))
            except LinkError:  # the port does not have this rate
                continue
            try:
                if self.probe(driver).kind == "configuration":
                    return baud_hz
            finally:
                driver.close()
        return None

    # ---- how well the link works

    def round_trips(self, driver: OpenedDriver) -> list[Finding]:
        self.say(f"measuring {_ROUND_TRIPS} round trips")
        times_s, failures = [], []
        size = 0
        for _ in range(_ROUND_TRIPS):
            answer = self.probe(driver)
            if answer.kind == "configuration":
                times_s.append(answer.elapsed_s)
                size = len(configuration_request()) + len(answer.received)
            else:
                failures.append(answer.kind)
        found = []
        if failures:
            reasons = ", ".join(f"{kind} ({failures.count(kind)})" for kind in sorted(set(failures)))
            found.append(finding("losses", bad=len(failures), count=_ROUND_TRIPS, reasons=reasons))
        expected_s = self.expected_s(size)
        if times_s and median(times_s) > expected_s + _SLACK_S:
            measured_ms, expected_ms = median(times_s) * 1e3, expected_s * 1e3
            found.append(finding("slow", measured_ms=measured_ms, expected_ms=expected_ms))
        return found

    def expected_s(self, size: int) -> float:
        """Return the time that wire and USB chip need for `size` bytes."""
        if self.place.scheme != "serial":
            return 0.0
        latency_ms = self.machine.serial_port(self.place.path).latency_timer_ms or 0
        return 10 * size / (self.place.baud_hz or 115_200) + latency_ms / 1e3

    # ---- whether spec and gateware belong together

    def against_spec(self, spec: Spec) -> list[Finding]:
        self.say(f"comparing with {spec.source}")
        with self.open_link(self.place.url) as link:
            try:
                part = part_behind(link, spec)
            except DeviceMismatch as error:
                return [finding("other-gateware", spec=spec.source, reason=error.message)]
            found = []
            if link.unverified:
                found = [finding("unverified-gateware", spec=spec.source, reason=link.unverified)]
            elements = [element for _, element in part.walk()]
            configuration = link.configuration
            beyond = [e for e in elements if e.address >> configuration.address_bits]
            if beyond:
                return [
                    finding(
                        "widths",
                        count=len(beyond),
                        spec=spec.source,
                        bits=configuration.address_bits,
                        example=_named(beyond[0]),
                    )
                ]
            publishing = [e for e in elements if e.publish is not None and e.publish.mode == 1]
            if publishing and (configuration.publish_mode == 0 or configuration.groups == 0):
                asked = f"{len(publishing)} items"
                known = {
                    "spec": spec.source,
                    "asked": asked,
                    "has": "no publishing",
                    "spec_file": spec.source,
                }
                return [finding("publishing", **known)]
            readable = [e for e in elements if e.pollable and e.link.kind != "fifo"]
            refused = [e for e in readable if not _reads(link, e.address)]
        if refused:
            count, total, example = len(refused), len(readable), _named(refused[0])
            found.append(finding("wrong-spec", count=count, total=total, example=example))
        return found


def _number(text: str) -> int:
    """Return a number from a link URL. The link has already checked its form."""
    return int(text, 16 if text[:2].lower() == "0x" else 10)


def _reads(link: Link, address: int) -> bool:
    try:
        link.read(address)
    except BusError:
        return False
    return True


def _named(element: Element) -> str:
    return f"{element.path} at 0x{element.address:04X}"


def _stopped(found: list[Finding]) -> bool:
    return any(f.severity == "error" for f in found)


def _sample(data: bytes) -> str:
    return ascii(data[:_SAMPLE_BYTES].rstrip(b"\r\n").decode("latin-1"))
