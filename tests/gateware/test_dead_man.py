# SPDX-License-Identifier: BSD-3-Clause
"""The host dies at any moment, behind every physical layer. The outputs become safe all the same."""

from __future__ import annotations

import struct
from collections.abc import Callable, Sequence
from typing import Any

import pytest
from reference.framing import Borders, Frame, field
from reference.rs485 import token

from unitylink import protocol as p
from unitylink.interface.board_configuration import BoardConfiguration

SAFE = [(0x10, 1), (0x11, 0xFFFFFFFF)]  # of replay_tb
TICKS = 3
OK, ERROR, DENIED = 0, p.REPLY_STATUS_BUS_ERROR, p.REPLY_STATUS_DENIED
TRIP, DEAD, WRITTEN, VALUE = "p", "k", "u", "v"

Step = tuple[str, Any]


class Host:
    """What a host sends, as steps of the bench. Ids start again in each session."""

    def __init__(self, physical: str = "none") -> None:
        self.physical = physical
        self.steps: list[Step] = []
        self.marks: dict[str, tuple[int, int]] = {}  # name -> (step, epoch)
        self.nonce = self.epoch = 0
        self.next_id = self.posts = 0

    def do(self, *steps: Step) -> None:
        self.steps += steps

    def say(self, data: bytes, pause: int = 0) -> None:
        """Send bytes.

        Then, if needed, let the SPI slave or the node send: a PC has to clock or poll its bytes out.
        """
        if self.physical == "spi_slave":
            data += bytes(80)
        elif self.physical == "rs485":
            data = b"\0" + token(1, poll=False) + data + token(1, poll=True)
        self.do(("send", data.decode("latin-1")))
        if self.physical == "rs485":  # wait while the node has its turn
            self.settle()
        elif pause:
            self.do(("wait", pause))

    def settle(self) -> None:
        """Wait until the device has sent everything.

        On a serial line a byte takes 80 clocks, and a FIFO has 16.
        """
        self.do(("quiet", 2500 if self.physical in ("uart", "rs485") else 500))

    def mark(self, name: str) -> None:
        """Give a name to the answers from here to the next mark."""
        self.marks[name] = (len(self.steps), self.epoch)

    def open(self) -> None:
        self.nonce += 1
        self.epoch = 0x1234 + self.nonce
        self.next_id = self.posts = 0
        hello = Frame(p.REQUEST_KIND_HELLO, b"\1\1").encode()
        last = Frame(p.REQUEST_KIND_OPEN, field((self.nonce, 2), (self.epoch, 2), (0, 1))).encode()
        self.say(b"\0\0" + hello + last)
        self.settle()  # a real host waits for the answer, too

    def ask(self, kind: int, *fields: tuple[int, int]) -> bytes:
        frame = Frame(kind, field((self.next_id, 2), *fields)).encode(self.epoch)
        self.next_id += 1
        return frame

    def post(self, address: int, word: int) -> bytes:
        frame = Frame(p.REQUEST_KIND_POST, field((self.posts, 2), (address, 2), (word, 4))).encode(self.epoch)
        self.posts += 1
        return frame

    def control(self, register: int, value: int) -> bytes:
        return self.ask(p.REQUEST_KIND_WRITE_CONTROL, (register, 2), (value, 4))

    def write(self, address: int, word: int) -> bytes:
        return self.ask(p.REQUEST_KIND_WRITE, (address, 2), (word, 4))

    def group(self) -> bytes:
        words = tuple((0x10 + n, 2) for n in range(8))
        return self.ask(p.REQUEST_KIND_DEFINE_GROUP, (0, 1), (1, 4), (0, 1), (8, 1), *words)

    def exchange_group(self) -> bytes:
        members = tuple(f for n in range(4) for f in ((0x10 + n, 2), (4, 1)))
        return self.ask(p.REQUEST_KIND_DEFINE_EXCHANGE, (0, 1), (2, 1), (2, 1), *members)

    def traffic(self) -> list[bytes]:
        """Return everything that holds the bus or writes, one after another."""
        reads = (
            (1, 1),  # this flag holds the bus
            (p.LIST_OPERATION_READ, 1),
            (12, 1),
            *((0x20 + n, 2) for n in range(12)),
        )
        writes = tuple(f for n in range(4) for f in ((0x10 + n, 2), (7 + n, 4)))
        return [
            self.post(0x10, 5) + self.write(0x11, 6) + self.post(0x22, 7),
            self.ask(p.REQUEST_KIND_LIST, *reads),
            self.ask(p.REQUEST_KIND_LIST, (1, 1), (p.LIST_OPERATION_WRITE, 1), (4, 1), *writes),
            self.ask(p.REQUEST_KIND_EXCHANGE, (0, 1), (0x1234, 4), (0x5678, 4)),
            self.ask(p.REQUEST_KIND_LIST, (0, 1), (p.LIST_OPERATION_ADD, 1), (1, 1), (0x11, 2), (1, 4)),
            self.write(0x10, 9) + self.ask(p.REQUEST_KIND_READ, (0x11, 2)) + self.post(0x11, 8),
        ]


def play(rtl: Any, host: Host, tick: int, **generics: Any) -> list[bytes]:
    configuration = BoardConfiguration(
        address_bits=16, data_bits=32, base_hz=50_000_000 // tick, groups=2, group_size=16
    )
    own = {"protocol": "both", "physical": host.physical, "recorded": 0}
    answers: list[bytes] = rtl(configuration, [[step] for step in host.steps], **{**own, **generics})
    return answers


def replies(host: Host, answers: Sequence[bytes], mark: str) -> list[tuple[int, str]]:
    """Return the status and the data of each reply between a mark and the next one."""
    start, epoch = host.marks[mark]
    end = min((at for at, _ in host.marks.values() if at > start), default=len(answers))
    frames = [Frame.decode(piece, epoch) for piece in Borders().feed(b"".join(answers[start:end]))]
    return [
        (frame.kind - p.DEVICE_KIND_REPLY, frame.payload[4:].hex())
        for frame in frames
        if frame is not None and p.DEVICE_KIND_REPLY <= frame.kind < p.DEVICE_KIND_HELLO
    ]


def written(times: Sequence[tuple[str, int, int]]) -> list[tuple[int, int, int]]:
    """Return what was written on the bus: clock, address, word."""
    values = [number & 0xFFFFFFFF for kind, _, number in times if kind == VALUE]
    places = [(clock, address) for kind, clock, address in times if kind == WRITTEN]
    return [(*place, value) for place, value in zip(places, values, strict=True)]


def edges(times: Sequence[tuple[str, int, int]], kind: str) -> list[tuple[int, int]]:
    """Return pairs of clocks: something of `kind` begins at the first and ends at the second."""
    clocks = [clock for found, clock, _ in times if found == kind]
    return list(zip(clocks[::2], clocks[1::2], strict=True))


def check_trips(times: Sequence[tuple[str, int, int]], tick: int, access: int, late: int) -> None:
    """Check that each silence trips in time.

    After it, all safe values are written in time, and nothing else is.
    """
    silences, trips, writes = edges(times, DEAD), edges(times, TRIP), written(times)
    assert len(trips) == len(silences)
    bound = (len(SAFE) + 1) * (access + 1)
    for (dead, alive), (tripped, armed) in zip(silences, trips, strict=True):
        assert tripped <= dead + late + TICKS * tick + 1, "it trips at its tick"
        assert alive < armed, "until it is armed"
        behind = [(clock, (at, word)) for clock, at, word in writes if tripped <= clock < armed]
        begun = len(behind) - len(SAFE)  # 1 if a write was on the bus at the trip
        assert begun in (0, 1)
        assert [what for _, what in behind[begun:]] == SAFE
        assert behind[0][0] <= tripped + access or not begun
        assert behind[-1][0] <= tripped + bound, "the bound of dead_man.vhd"


def begin(host: Host, ticks: int = TICKS) -> None:
    """Open a session that publishes and has a dead-man."""
    host.open()
    host.say(host.group(), 200)
    host.say(host.exchange_group(), 200)
    host.say(host.control(p.CONTROL_PUBLISH, 1))
    host.say(host.control(p.CONTROL_DEADMAN_TICKS, ticks), 300)


def cut(host: Host, name: str, tick: int, moment: int) -> None:
    """Play two sessions. In the first one the host falls silent at a moment of its traffic."""
    begin(host)
    host.do(("dead", moment + 1))
    for data in host.traffic():
        host.say(data)
    host.do(("wait", (TICKS + 2) * tick))
    host.do(("dead", 0))
    host.open()
    host.mark(name)
    host.say(
        b"".join(host.ask(p.REQUEST_KIND_READ, (address, 2)) for address, _ in SAFE) + host.write(0x10, 3),
        300,
    )
    host.settle()
    host.say(host.control(p.CONTROL_ARM, 1) + host.write(0x20, 4))
    host.settle()


# For each layer: the clocks of a tick, the most clocks by which a byte may be late, and the moments of the
# traffic.
LAYERS = {
    "none": (600, 60, range(0, 330, 11)),
    "ft245_async": (3000, 400, range(0, 3000, 499)),
    "ft245_sync": (2000, 400, range(0, 1500, 251)),
    "uart": (3000, 2000, range(0, 12_000, 4999)),
    "spi_slave": (5000, 1000, range(0, 12_000, 4999)),
    "rs485": (5000, 2000, range(5003, 5004)),
}


@pytest.mark.parametrize("every", [3, pytest.param(1, marks=pytest.mark.long)])
@pytest.mark.parametrize("physical", LAYERS)
def test_a_host_that_dies_at_any_moment(rtl: Any, physical: str, every: int) -> None:
    """This tries every moment of LAYERS, and in `make test` a third of them, but at least one."""
    tick, late, moments = LAYERS[physical]
    moments = moments[len(moments) // 2 % every :: every]
    host = Host(physical)
    for moment in moments:
        cut(host, str(moment), tick, moment)
    answers = play(rtl, host, tick)
    check_trips(rtl.times, tick, access=2, late=late)
    safe = [(OK, f"{word:08x}") for _, word in SAFE]
    for moment in moments:
        told = replies(host, answers, str(moment))
        assert told[:5] == [*safe, (DENIED, ""), (OK, ""), (OK, "")], f"dead from clock {moment} on"


# For a host that reads nothing: the clocks of a tick, how late a byte may be, and when it stops sending.
DEAF = {"none": (600, 60, 10_000), "ft245_async": (1000, 400, 20_000), "ft245_sync": (800, 400, 12_000)}
FRAMES_UNHEARD = 16  # so many more frames are taken while an answer waits


@pytest.mark.parametrize("physical", DEAF)
def test_a_host_that_reads_nothing_counts_as_alive_while_it_sends(rtl: Any, physical: str) -> None:
    """Its posts are executed. When answers wait to be sent, there is still room for some more frames."""
    tick, late, life = DEAF[physical]
    host = Host(physical)
    begin(host)
    host.do(("deaf", 1), ("dead", life))
    before = len(host.steps)
    posts = 80
    for number in range(posts):
        host.say(host.post(0x30, number), 30)
    for _ in range(40):
        host.say(host.ask(p.REQUEST_KIND_READ, (0x11, 2)), 30)
    host.do(("wait", TICKS * tick), ("dead", 0), ("deaf", 0))
    host.open()
    host.mark("again")
    host.say(host.ask(p.REQUEST_KIND_READ_CONTROL, (p.CONTROL_PUBLISH_OVERRUNS, 2), (1, 1)))
    host.say(host.control(p.CONTROL_ARM, 1) + host.write(0x20, 4))
    host.settle()
    answers = play(rtl, host, tick)
    check_trips(rtl.times, tick, access=2, late=late)

    ((silent, _),), ((tripped, _),) = edges(rtl.times, DEAD), edges(rtl.times, TRIP)
    said = [clock for kind, clock, _ in rtl.times if kind == "i" and clock < silent]
    said = said[sum(kind == "send" for kind, _ in host.steps[:before]) :]
    left = [clock for kind, clock, _ in rtl.times if kind == "b" and said[0] <= clock < silent]
    assert not left, "it is deaf"
    executed = [word for clock, at, word in written(rtl.times) if at == 0x30 and clock < tripped]
    assert executed == list(range(posts))
    assert said[posts] - said[0] > (TICKS + 1) * tick, "it lives longer than a silence may be"
    assert len(said) >= posts + FRAMES_UNHEARD
    assert (TICKS - 1) * tick <= tripped - said[-1] <= TICKS * tick + late, "until it is not heard any more"
    overruns, *others = replies(host, answers, "again")
    assert overruns[0] == OK and int(overruns[1], 16) > 0, "publishes without room are counted"
    assert others == [(OK, ""), (OK, "")]


PLACES = range(0x40, 0x46)  # the addresses that are written when it trips
WORDS = [(at, number) for number, at in enumerate(PLACES, 1)]
COUNT = len(PLACES)


def _write(host: Host) -> bytes:
    return host.write(*WORDS[0])


def _write_list(host: Host) -> bytes:
    words = tuple(f for at, word in WORDS for f in ((at, 2), (word, 4)))
    return host.ask(p.REQUEST_KIND_LIST, (0, 1), (p.LIST_OPERATION_WRITE, 1), (COUNT, 1), *words)


def _exchange(host: Host) -> bytes:
    return host.ask(p.REQUEST_KIND_EXCHANGE, (0, 1), *((word, 4) for _, word in WORDS))


def _posts(host: Host) -> bytes:
    return b"".join(host.post(at, word) for at, word in WORDS)


def of_trips(times: Sequence[tuple[str, int, int]]) -> list[list[tuple[int, int]]]:
    """Return, for each trip, what was written since the trip before."""
    trips: list[list[tuple[int, int]]] = [[]]
    for _, at, word in written(times):
        trips[-1].append((at, word))
        if trips[-1][-2:] == SAFE:
            trips[-1:] = [trips[-1][:-2], []]
    assert trips.pop() == [], "behind the last one nothing is"
    return trips


# For each request: a tick in clocks, about as long as the request takes to come in and be executed; and for
# each possible status, how many words were written.
CAUGHT = {
    _write: (61, {OK: 1, DENIED: 0}),
    _write_list: (241, {OK: COUNT, ERROR: None, DENIED: 0}),
    _exchange: (211, {OK: COUNT, ERROR: None, DENIED: 0}),
    _posts: (121, {OK: None}),
}


@pytest.mark.parametrize("what", CAUGHT)
def test_replies_tell_truly_what_was_written_at_a_trip(rtl: Any, what: Callable[[Host], bytes]) -> None:
    """At whatever clock it trips: exactly the words were written that the replies tell."""
    tick, expected = CAUGHT[what]
    rounds = range(20)
    host = Host()
    for number in rounds:
        host.open()
        members = tuple(f for at in PLACES for f in ((at, 2), (4, 1)))
        define = host.ask(p.REQUEST_KIND_DEFINE_EXCHANGE, (0, 1), (COUNT, 1), (0, 1), *members)
        host.say(define + host.control(p.CONTROL_ARM, 1), 300 + 7 * number)
        host.mark(f"{number}")
        host.say(host.control(p.CONTROL_DEADMAN_TICKS, 1) + what(host), 3 * tick)
        host.mark(f"{number} behind it")
        host.say(host.ask(p.REQUEST_KIND_SYNC))
        host.settle()
    answers = play(rtl, host, tick, bus_waits=4)
    made = of_trips(rtl.times)
    assert len(made) == len(rounds)
    seen = set()
    for number, words in zip(rounds, made, strict=True):
        assert words == WORDS[: len(words)]
        _, *told = replies(host, answers, f"{number}")
        ((_, sync),) = replies(host, answers, f"{number} behind it")
        executed, failed, first, status = struct.unpack(">HHHB", bytes.fromhex(sync))
        if what is _posts:
            told = [(OK, "")]
            assert (executed, failed) == (COUNT, COUNT - len(words))
            assert not failed or (first, status) == (len(words), DENIED)
        ((status, data),) = told
        count = expected[status]
        if status == ERROR:
            assert len(words) < COUNT
            assert data == (f"{len(words):04x}" if what is _write_list else ""), "`done`"
        assert count is None or len(words) == count
        seen.add((status, len(words)))
    assert {status for status, _ in seen} == set(expected), "each reply has come"
    assert what is _write or any(0 < count < COUNT for _, count in seen), "a trip in the middle, too"
