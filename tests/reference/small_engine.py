# SPDX-License-Identifier: BSD-3-Clause
"""The small engine's program on a model of its hardware, without time: bytes come and go at once.

The hardware itself is `gateware/small/framed_small.vhd`. The model is for many histories and for faulty
programs.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Protocol

from reference.bus import Bus, BusError
from reference.framing import crc
from reference.settings import Settings
from unitylink import protocol as p

DENIED = 3  # the bus answers so to a write after a trip
STEPS_MOST = 1_000_000


class Program(Protocol):
    """The output of tools/small/assemble.py."""

    words: list[int]
    names: dict[str, int]
    labels: dict[str, int]


def memory_of(settings: Settings, names: dict[str, int]) -> bytearray:
    """Return the data memory at power-up, as it is in small_memory_pkg.vhd."""
    s = settings
    memory = bytearray(1024)
    for register, value in s.description().items():
        memory[4 * register : 4 * register + 4] = value.to_bytes(4, "big")
    known = {"a_bytes": s.a, "d_bytes": s.d, "window": s.window, "window_mask": s.window - 1}
    for name, value in {**known, "post_size": 8 + s.a + s.d, "write_bytes": s.a + s.d}.items():
        memory[names[name]] = value
    if s.groups:
        memory[names["last_group"]] = names["group_bytes"] * (s.groups - 1)
    for group in range(s.groups):
        memory[names["groups"] + names["group_bytes"] * group] = 1 << group
    return memory


@dataclass
class SmallEngine:
    """The engine behind a port_splitter."""

    program: Program
    settings: Settings
    bus: Bus = field(default_factory=Bus)
    reply_steps: int = 0  # instructions that run while a reply is being sent

    def __post_init__(self) -> None:
        self.memory = memory_of(self.settings, self.program.names)
        self.a = self.carry = self.x = self.crc = self.word = self.address = self.answer = 0
        self.stack = [0, 0]
        self.reply_start = self.program.names["reply"]
        self.reset()

    def reset(self) -> None:
        """Reset it as the reset signal does. The memory keeps its contents."""
        self.position = self.come = self.free = self.sending = self.pieces = 0
        self.put_at = self.reply_start + 2
        self.tripped = self.running = self.tripped_now = self.uncounted = False
        self.waiting = bytearray()
        self.sent = bytearray()
        self.at_border = self.inside = False
        self.strobes = self.events = self.enabled = self.due = 0
        self.publishing = self.holding = False
        self.held: list[bool] = []  # at each read of a publish: whether it keeps the bus

    def feed(self, data: bytes) -> bytes:
        """Return what the engine sends for these bytes."""
        self._receive_later(data)
        return self._run()

    def strobe(self, count: int = 1) -> bytes:
        """Return what it sends after `count` base strobes that came at once."""
        self.strobes += count if self.publishing else 0
        return self._run()

    def event(self, groups: int) -> bytes:
        """Return what it sends after an edge of the event inputs of `groups`, as bits."""
        self.events |= groups & self.enabled
        return self._run()

    def _receive_later(self, data: bytes) -> None:
        for byte in data:
            if self.inside or (self.at_border and byte & 0x80):
                self.waiting.append(byte)
                self.inside = byte != 0
            self.at_border = byte == 0

    def _run(self) -> bytes:
        """Return what it sends until it has nothing to do."""
        self.sent = bytearray()
        idle, looked = self.program.labels["none"], 0
        for _ in range(STEPS_MOST):
            self._receive()
            looked += self.position == idle and not (self.waiting or self.sending or self._alert())
            if looked > 2:
                return bytes(self.sent)
            self._step()
        raise AssertionError("the program does not come to an end")

    def _receive(self) -> None:
        while self.waiting and (self.come + 1) % 128 != self.free:
            byte = self.waiting.pop(0)
            self.pieces += byte == 0
            self.memory[self.program.names["ring"] + self.come] = byte
            self.come = (self.come + 1) % 128

    def _step(self) -> None:
        word = self.program.words[self.position]
        self.position += 1
        self.sending -= self.sending > 0
        if word >> 15:
            self._jump(word)
            return
        operation, mode, address = word >> 11 & 15, word >> 9 & 3, word & 511
        place = self.x if mode > 1 else address
        operand = address & 255 if mode == 1 else self.memory[place]
        given = operand if mode > 1 or (operation == 11 and mode == 0) else self.a
        if operation < 4:
            self.a = [operand, self.a & operand, self.a | operand, self.a ^ operand][operation]
        elif operation < 8:
            added = operand ^ 255 if operation > 5 else operand
            total = self.a + added + [0, self.carry, 1, self.carry][operation - 4]
            self.a, self.carry = total & 255, total >> 8
        elif operation == 8 and mode == 3:  # get
            self.a = self.memory[address] = operand
        elif operation == 8 and mode == 1:  # give
            self.memory[self.x] = self.memory[address]
            mode = 3
        elif operation == 8:
            wants = (self.strobes > 0) << 6 | self.events
            check, there = 0x80 | self.crc & 127, self.put_at & 255
            ports = (self.word >> 24, check, self._status(), self.x & 255, wants, there)
            before, self.a = self.a, ports[address & 7]
            if address >> 7 & 1:
                self.word = (self.word << 8 | before) & 0xFFFFFFFF
            if address >> 8:
                self.crc >>= 7
        elif operation == 9:
            self.memory[place] = 255 if mode == 1 else self.a
        elif operation == 10:
            self.x = (mode & 2) << 8 | (address if mode & 1 else address & 256 | self.a)
            return
        elif operation == 11:
            assert not self.sending, "the reply before has not been sent"
            self.memory[self.put_at] = given
            self.put_at += 1
        elif operation == 12:
            self._out(address, given)
        elif operation == 13:
            self._tell(address)
        elif operation == 14 and mode == 1:  # follow
            self.x = 256 | self.memory[address]
        elif operation == 14:
            self.memory[place] = 0
        else:
            self._note(address, given)
        if mode == 3:
            self.x = self.x & ~127 | (self.x + 1) & 127

    def _jump(self, word: int) -> None:
        condition, inverted = word >> 12 & 7, word >> 11 & 1
        if condition == 0 and inverted:
            self.position = self.stack.pop(0)
            self.stack.append(self.stack[-1])
            return
        asked = (self.pieces > 0, self.sending > 0, False, self._alert())
        holds = (True, self.a == 0, bool(self.carry), *asked, True)
        if holds[condition] != bool(inverted):
            if condition == 7:
                self.stack = [self.position, self.stack[0]]
            self.position = word & 2047

    def _status(self) -> int:
        full = (self.come + 1) % 128 == self.free
        flags = (self.tripped, self.running, full, self.tripped_now)
        return sum(flag << n for n, flag in enumerate(flags)) | self.answer << 4 | self.uncounted << 6

    def _out(self, actions: int, given: int) -> None:
        if actions & 1:
            self.word = (self.word << 8 | given) & 0xFFFFFFFF
        if actions & 2:
            self.address = (self.address << 8 | given) & (1 << 8 * self.settings.a) - 1
        if actions & 12:
            self._access(writes=bool(actions & 8))
        if actions & 32:
            self.crc = crc(p.FRAME_CRC16_POLYNOMIAL, self.crc, bytes([given]))
        if actions & 64:
            self.crc = 0
        if actions & 128:
            end = self.memory.index(0, self.reply_start) + 1
            self.sent += self.memory[self.reply_start : end]
            self.put_at = self.reply_start + 2
            self.sending = self.reply_steps
        if actions & 256:
            self.free = given & 127

    def _tell(self, actions: int) -> None:
        """Do those actions of the dead-man that need no time."""
        if actions & 4:
            self.running = self.word != 0 and not self.tripped
        if actions & 8 and self.running:
            self.tripped = self.tripped_now = self.uncounted = True
            self.running = False
            for address, value in self.settings.safe:
                self.bus.write(address, value)
        if actions & 16:
            self.running = self.tripped_now = False
        if actions & 32 and not self.tripped_now:
            self.tripped = False
        if actions & 64:
            self.uncounted = False

    def _alert(self) -> bool:
        return self.strobes > 0 or (self.publishing and bool(self.events or self.due))

    def _note(self, actions: int, given: int) -> None:
        self.pieces -= actions & 1
        self.strobes -= actions >> 1 & 1
        if actions & 4:
            self.events &= ~given
        if actions & 8:
            self.enabled = given & (1 << self.settings.groups) - 1
        if actions & 16:
            self.publishing = bool(given & 1)
            self.strobes = given & 1  # the first one comes at once
        if actions & 32:
            self.due = given
        if actions & 64:
            self.holding = bool(given & 1)
        if actions & 128:
            self.put_at = self.reply_start + 2

    def _access(self, *, writes: bool) -> None:
        self.answer = 0
        try:
            if writes and self.tripped:
                self.answer = DENIED
            elif writes:
                self.bus.write(self.address, self.word & (1 << 8 * self.settings.d) - 1)
            else:
                if self.memory[self.reply_start] == p.DEVICE_KIND_PUBLISH:
                    self.held.append(self.holding)
                self.word = self.bus.read(self.address) << 8 * (4 - self.settings.d)
        except BusError as error:
            self.answer = error.status


def small_settings(a: int = 2, d: int = 4, window: int = 8, groups: int = 0, **others: Any) -> Settings:
    """Return the settings that a device with the small engine reports."""
    sizes = {"credit": 96, "request_max": 32, "reply_max": 76, "cache": 8, "window": window}
    most = min(p.SMALL_ENGINE_GROUP_ADDRESS_BYTES // a, (p.SMALL_ENGINE_REPLY_MAX - 7) // d)
    has = {"groups": groups, "group_size": most if groups else 0}
    lacks = {"exchanges": 0, "exchange_size": 16, "lists": False}
    features = p.CONTROL_VALUE_FEATURE_DEADMAN | (p.CONTROL_VALUE_FEATURE_PUBLISHING if groups else 0)
    return Settings(a, d, **{**sizes, **has, **lacks, "features": features, **others})
