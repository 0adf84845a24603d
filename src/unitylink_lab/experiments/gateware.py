# SPDX-License-Identifier: BSD-3-Clause
"""The gateware behind the chip, clock for clock.

The twin stands for that of 2012; ours is its own VHDL, compiled.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections import deque
from functools import cache
from typing import Any

from unitylink import _native
from unitylink import protocol as p
from unitylink.errors import UnityLinkError
from unitylink.interface.board_configuration import BoardConfiguration

from .exchange import EPOCH, SPEC, frame, plain_client

CLOCK_HZ = 50_000_000
BASE_HZ = 961  # the base frequency; with it, each publish comes at another place within a microframe
FIFO_LATENCY = 2  # clocks that a byte takes through the FIFO, each way
LONGEST_READ = 255  # words that an experiment reads with one request: as many as the protocol can ask for
_LARGE = 1 << 16  # depth of the FIFO in bytes if `fifo` is 0
_IN_FLIGHT_CLOCKS = 16  # from the read of a word to its first byte
_QUIET_CLOCKS = 2500  # longer than our core needs before or within any answer; a list of 60 words takes 1700
_LOOK_CLOCKS = 20  # the first byte of a publish may be seen this late
_START_UP_CLOCKS = 1000  # after a reset the core clears its tables
_OPENING_CLOCKS, _OPENING_STEPS = 20_000, 100


class Gateware(ABC):
    """A device between two FIFOs of `fifo` bytes (0 means large).

    It tells at which clock each request was answered.

    `watch` is an address. `effects` gets the clock of each change of its word. Clocks in which the device
    cannot do anything are skipped. That is so behind a full transmit FIFO, and when nothing is due.
    """

    terminator = 0x0A  # the byte that ends a message
    publish_heads = b"%&"  # the bytes that begin a publish

    def __init__(self, device: _native.ServedDevice, *, fifo: int, watch: int | None = None) -> None:
        self._device = device
        self._depth = fifo or _LARGE
        self._stood = 0  # clocks that were skipped
        self._transmit: deque[int] = deque()
        self._watch = watch
        self._word = None if watch is None else device.get(watch)
        self.answered: list[int] = []  # clock at which the last byte of each message left the core
        self.effects: list[int] = []
        self.peak = 0  # the most bytes that have waited in the transmit FIFO

    @abstractmethod
    def _due(self) -> int | None:
        """Return the device's clock at which it may do something.

        None means that it does nothing until a byte comes.
        """

    @property
    def clock(self) -> int:
        """Clocks since reset, or since the session was opened."""
        return self._device.clock + self._stood

    @property
    def waiting(self) -> int:
        """Bytes in the transmit FIFO."""
        return len(self._transmit)

    @property
    def next_event(self) -> int | None:
        """The clock at which something may happen."""
        if len(self._transmit) >= self._depth or (due := self._due()) is None:
            return None
        return due + self._stood

    def receive(self, byte: int) -> bool:
        """Take a byte from the host. The result is False if the receive FIFO is full."""
        return self._device.receive(bytes([byte])) == 1

    def run_until(self, clock: int) -> None:
        device = self._device
        while (end := clock - self._stood) > device.clock:
            due = None if len(self._transmit) >= self._depth else self._due()
            if due is None:
                self._stood = clock - device.clock
                return
            if self._watch is None:  # at most one byte leaves in a clock
                due = max(due, min(end, device.clock + self._depth - len(self._transmit)))
            device.run_until(max(device.clock + 1, min(end, due)))
            if self._watch is not None and (word := device.get(self._watch)) != self._word:
                self._word = word
                self.effects.append(device.clock + self._stood)
            for at, byte in device.take_timed():
                self._sent(at + self._stood, byte)
            self.peak = max(self.peak, len(self._transmit))

    def take(self) -> int:
        """Return the oldest byte of the transmit FIFO, which must not be empty."""
        return self._transmit.popleft()

    def _sent(self, clock: int, byte: int) -> None:
        self._transmit.append(byte)
        if byte == self.terminator:
            self.answered.append(clock)


class Gateware2012(Gateware):
    """The gateware of 2012, played by the twin, which takes the same clocks.

    >>> gateware = Gateware2012(fifo=256)
    >>> all(gateware.receive(byte) for byte in b"#R:12\\n")
    True
    >>> gateware.run_until(100); gateware.answered, gateware.waiting
    ([57], 14)
    """

    def __init__(self, *, fifo: int = 256, watch: int | None = None, publishing: bool = False) -> None:
        self._twin = _native.Device(
            BoardConfiguration(
                fifo=fifo,
                fifo_latency=FIFO_LATENCY,
                clock_hz=CLOCK_HZ,
                base_hz=BASE_HZ,
                protocol="classic",
            )
        )
        super().__init__(self._twin, fifo=fifo, watch=watch)

    def _due(self) -> int | None:
        twin = self._twin
        if twin.clock < twin.last_activity + FIFO_LATENCY + _IN_FLIGHT_CLOCKS:
            return twin.clock + 1  # the sent bytes are still in the FIFO
        return twin.next_event


class OurGateware(Gateware):
    """Our gateware: the compiled VHDL for SPEC. The first use compiles it, with GHDL and Verilator.

    With `publishing`, idle clocks are not skipped. Raises ToolError if a tool is missing.
    """

    protocol = "both"
    on_chip = False

    def __init__(self, *, fifo: int = 256, watch: int | None = None, publishing: bool = False) -> None:
        configuration, model = _compiled(fifo, self.protocol, self.on_chip)
        self._publishing = publishing
        self._rtl = _native.RtlDevice(configuration, model)
        self._rtl.run_until(_START_UP_CLOCKS)
        self._quiet_at = 0
        super().__init__(self._rtl, fifo=fifo, watch=watch)
        self._begin()

    def _begin(self) -> None:
        """Let the clocks and the counters start at zero now."""
        self.answered.clear()
        self._stood = -self._rtl.clock
        self.peak = 0

    def _due(self) -> int | None:
        if self._rtl.clock < self._quiet_at:
            return self._rtl.clock + 1
        return self._rtl.clock + _LOOK_CLOCKS if self._publishing else None

    def receive(self, byte: int) -> bool:
        self._quiet_at = self._rtl.clock + _QUIET_CLOCKS
        return super().receive(byte)

    def run_until(self, clock: int) -> None:
        super().run_until(clock)
        if self._rtl.failure:
            raise UnityLinkError(f"an assertion of the gateware failed: {self._rtl.failure}")

    def _sent(self, clock: int, byte: int) -> None:
        self._quiet_at = self._rtl.clock + _QUIET_CLOCKS
        super()._sent(clock, byte)


class FramedGateware(OurGateware):
    """Our gateware in a framed session. The session is open when the constructor returns."""

    terminator = 0x00
    publish_heads = bytes([p.DEVICE_KIND_PUBLISH])

    def __init__(self, *, fifo: int = 256, watch: int | None = None, publishing: bool = False) -> None:
        super().__init__(fifo=fifo, watch=watch, publishing=publishing)
        told = self._ask(p.REQUEST_KIND_HELLO, bytes([1, 1]), p.DEVICE_KIND_HELLO)
        opening = told[1:3] + EPOCH.to_bytes(2, "big") + b"\0"
        self._ask(p.REQUEST_KIND_OPEN, opening, p.DEVICE_KIND_OPEN)
        self._begin()

    def _ask(self, kind: int, payload: bytes, wanted: int) -> bytes:
        for byte in b"\0" + frame(kind, payload, p.FRAME_OPEN_EPOCH):
            while not self.receive(byte):
                self.run_until(self.clock + 1)
        answer = b""
        for _ in range(_OPENING_STEPS):  # a small FIFO holds less than one answer
            self.run_until(self.clock + _OPENING_CLOCKS // _OPENING_STEPS)
            answer += bytes(self.take() for _ in range(self.waiting))
        got, told = plain_client().unframe(answer.rstrip(b"\0"), p.FRAME_OPEN_EPOCH)
        if got != wanted:
            raise UnityLinkError(f"the gateware answered {answer.hex(' ')} where a session was to begin")
        return bytes(told)


class ClassicOnChip(OurGateware):
    """Our gateware with text alone, unpacked from its bitstream for an iCE40 HX8K.

    With both protocols it takes more block RAMs than that has.
    """

    protocol = "classic"
    on_chip = True


class FramedOnChip(FramedGateware):
    """The same with frames alone."""

    protocol = "framed"
    on_chip = True


@cache
def _compiled(fifo: int, protocol: str, on_chip: bool) -> tuple[BoardConfiguration, Any]:
    from unitylink.simulate.bit.bare import build_on_chip
    from unitylink.simulate.rtl import build_model, design_of
    from unitylink.spec import compile_text

    spec = compile_text(SPEC.encode(), "experiment.ul").spec
    assert spec is not None
    configuration = BoardConfiguration.for_spec(
        spec,
        clock_hz=CLOCK_HZ,
        base_hz=BASE_HZ,
        protocol=protocol,
        engine="fast",
        fifo=fifo,
        fifo_latency=FIFO_LATENCY,
        read_many=LONGEST_READ,
    )
    build = build_on_chip if on_chip else build_model
    return configuration, build(design_of(spec, configuration))


CLASSIC, FRAMED = "ours, classic", "ours, framed"
GATEWARES: dict[str, type[Gateware2012] | type[OurGateware]] = {
    "2012": Gateware2012,
    CLASSIC: OurGateware,
    FRAMED: FramedGateware,
}
BITSTREAMS: dict[str, type[OurGateware]] = {
    f"{CLASSIC}, bitstream": ClassicOnChip,
    f"{FRAMED}, bitstream": FramedOnChip,
}
