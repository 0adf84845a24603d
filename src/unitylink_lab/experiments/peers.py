# SPDX-License-Identifier: BSD-3-Clause
"""Others on the same kind of wire, in the same run: LiteX's clients and a plain pyserial script, beside ours.

Each has an instant device of its own in another process, behind a pty or on UDP. Our link and the script have
the twin. LiteX has the far end of its own protocol (`bench/native/bench_uartbone.cpp`, on UDP
`bench/litex/board.py`). To count bytes and to make faults, `wire.py` stands between. LiteX is its released
package, in an environment of its own.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack, contextmanager
from pathlib import Path
from statistics import median, quantiles
from typing import Any, Protocol

from unitylink.errors import LinkError
from unitylink_lab.bench import litex
from unitylink_lab.bench.board import ADDRESS, FIRST_VALUE
from unitylink_lab.bench.figure import BenchError, Run
from unitylink_lab.bench.programs import Process, Silence, native, twin
from unitylink_lab.bench.timing import times

OPERATIONS = ("read", "write", "block", "cycle")
BLOCK = litex.BLOCK_WORDS
READS = [0x300 + 7 * n for n in range(18)]
WRITES = [0x200 + 5 * n for n in range(18)]
EXPECTED = FIRST_VALUE + ADDRESS
OURS = {
    "Unity-Link, framed": "protocol=framed",
    "Unity-Link, classic": "protocol=classic",
    "Unity-Link, classic, CRC": "protocol=classic&crc=1",
    "Unity-Link, framed, UDP": "protocol=framed",
}
THEIRS = {
    "pyserial script, classic": "script",
    "LiteX CommUART": "uart",
    "LiteX RemoteClient, litex_server": "server",
    "LiteX CommUDP": "udp",
    "Etherbone packets, reads in one": "packets",
    "LiteX RemoteClient, litex_server, UDP": "server-udp",
}
PTY, UDP = "pty", "UDP"
DATAGRAMS = {
    "Unity-Link, framed, UDP",
    "LiteX CommUDP",
    "Etherbone packets, reads in one",
    "LiteX RemoteClient, litex_server, UDP",
}
FIRST = {
    PTY: "Unity-Link, framed",
    UDP: "Unity-Link, framed, UDP",
}  # the others on the same wire are compared with this peer
PATIENCE_S = 12.0  # on a frozen device, a read takes RemoteClient four seconds and CommUDP ten
SERIES_S = 0.5  # the longest series that a round has for each operation
# how many calls of each operation a series has, as a share of the reads
_SPAN = {"read": 1, "write": 1, "block": 0.1, "cycle": 0.1}


class Peer(Protocol):
    """One way to reach a device."""

    def series(self, operation: str, count: int) -> Sequence[int]: ...  # the time of each call in ns
    def attempt(self, command: str) -> str:
        """Do "read WORD" or "write WORD VALUE".

        Return the number, "done" or the error. Raises Silence if it never ends.
        """


class Ours:
    """A link of ours."""

    def __init__(self, link: Any) -> None:
        self._link = link
        self._group = link.exchange_group(writes=WRITES, reads=READS)
        self._number = 0

    def series(self, operation: str, count: int) -> Sequence[int]:
        return times(getattr(self, operation), count)

    def attempt(self, command: str) -> str:
        operation, *numbers = command.split()
        try:
            if operation == "read":
                return str(self._link.read(int(numbers[0])))
            self._link.write(int(numbers[0]), int(numbers[1]))
            return "done"
        except LinkError as error:
            return f"{type(error).__name__}: {error}"

    def read(self) -> int:
        value: int = self._link.read(ADDRESS)
        return value

    def write(self) -> None:
        self._number += 1
        self._link.write(WRITES[0], self._number)

    def block(self) -> list[int]:
        words: list[int] = self._link.read_many(range(ADDRESS, ADDRESS + BLOCK)).tolist()
        return words

    def cycle(self) -> list[int]:
        self._number += 1
        words: list[int] = list(self._group.exchange([self._number] * len(WRITES)))
        return words

    def check(self) -> None:
        """Raise BenchError unless every operation is right."""
        self.write()
        if (
            self._link.read(WRITES[0]) != self._number
            or self.block() != [FIRST_VALUE + n for n in range(ADDRESS, ADDRESS + BLOCK)]
            or self.cycle() != [FIRST_VALUE + n for n in READS]
            or self._link.read(WRITES[-1]) != self._number
        ):
            raise BenchError("the twin does not hold what was put there")


class Theirs:
    """A client of somebody else, in a process of its own."""

    def __init__(self, process: Process) -> None:
        self._process = process
        process.line()  # wait until the process is ready

    def series(self, operation: str, count: int) -> Sequence[int]:
        return self._process.series(f"times {operation} {count}")

    def attempt(self, command: str) -> str:
        return self._process.ask(command, PATIENCE_S)

    def obey(self, command: str) -> None:
        """Start "another" client of the server, or "stop" the server."""
        if (said := self._process.ask(command)) != "ok":
            raise BenchError(f"`{command}` was answered {said!r}")


@contextmanager
def peer(run: Run, name: str, *, spoiled: bool = False) -> Iterator[tuple[Peer, Process | None]]:
    """Start a device and its reader.

    With `spoiled` there is a faulty wire between them. It is returned too.
    """
    from unitylink import connect

    datagrams = name in DATAGRAMS
    scripts = run.checkout / "bench" / "litex"
    with ExitStack() as stack:
        if name in OURS or THEIRS[name] == "script":
            end = "udp" if datagrams else "pty"
            board = twin(
                end,
                read_many=BLOCK,
                clock_hz=litex.CLOCK_HZ,
                fifo=litex.FIFO_BYTES,
                exchange_size=len(WRITES) + len(READS),
                long_frames=datagrams,  # our gateware has no UDP; on datagrams, a device uses long checks
            )
            url = stack.enter_context(board).line()
            path = url.partition(":")[2].partition("?")[0].removeprefix("//")
        elif datagrams:
            path = stack.enter_context(Process([litex.environment(run), scripts / "board.py"])).line()
        else:
            path = stack.enter_context(Process([native(run.checkout, "bench_uartbone")])).line()
        wire = None
        if spoiled:
            wire = stack.enter_context(
                Process([sys.executable, "-m", "unitylink_lab.experiments.wire", path])
            )
            path = wire.line()
        if name in OURS:
            place = f"udp://{path}" if datagrams else f"serial:{path}"
            link = connect(f"{place}?fifo={litex.FIFO_BYTES}&{OURS[name]}")
            ours = Ours(stack.enter_context(link))
            ours.check()
            yield ours, wire
        else:
            command: list[str | Path] = [litex.environment(run), scripts / "peer.py", THEIRS[name], path]
            yield Theirs(stack.enter_context(Process(command))), wire


def compare(run: Run, *, rounds: int, count: int) -> list[dict[str, Any]]:
    """Return a row for each peer: its times, its bytes, and its results with a frozen device and with a
    flipped bit.
    """
    names = [*OURS, *THEIRS]
    some = {operation: max(2, round(count * span)) for operation, span in _SPAN.items()}
    calls = {name: dict(some) for name in names}
    taken: dict[str, dict[str, list[Sequence[int]]]] = {
        name: {operation: [] for operation in OPERATIONS} for name in names
    }
    with ExitStack() as stack:
        peers = {name: stack.enter_context(peer(run, name))[0] for name in names}
        for number in range(-1, rounds):
            for name, one in peers.items():
                for operation in OPERATIONS:
                    series = one.series(operation, calls[name][operation])
                    if number >= 0:
                        taken[name][operation].append(series)
                    else:  # the first series warms up, and shows how many calls fit into a round
                        fit = int(SERIES_S / (median(series) * 1e-9))
                        calls[name][operation] = max(2, min(fit, some[operation]))
    run.say("peers: bytes and faults")
    others = spoiled(run, names)
    return [
        {
            "name": name,
            **{each: _figures(taken[name][each], taken[FIRST[wire]][each]) for each in OPERATIONS},
            **others[name],
        }
        for wire in FIRST
        for name in names
        if wire_of(name) == wire
    ]


def wire_of(name: str) -> str:
    """Return the kind of wire that a peer uses.

    >>> wire_of("LiteX CommUDP"), wire_of("LiteX CommUART")
    ('UDP', 'pty')
    """
    return UDP if name in DATAGRAMS else PTY


def _figures(rounds: Sequence[Sequence[int]], first: Sequence[Sequence[int]]) -> dict[str, float]:
    """Return the times of all rounds.

    Also return their ratio to the first peer of the wire, taken within each round.
    """
    every = [time_ns for series in rounds for time_ns in series]
    return {
        "p50_s": median(every) * 1e-9,
        "p99_s": quantiles(every, n=100)[-1] * 1e-9,
        "ratio": median(median(a) / median(b) for a, b in zip(rounds, first, strict=True)),
    }


def spoiled(run: Run, names: Sequence[str]) -> dict[str, dict[str, Any]]:
    """Return the bytes of each operation, and the results of a read with a flipped bit and with a frozen
    device.
    """
    told: dict[str, dict[str, Any]] = {}
    with ExitStack() as stack:
        peers = {name: stack.enter_context(peer(run, name, spoiled=True)) for name in names}
        for name, (one, wire) in peers.items():
            assert wire is not None
            one.series("read", 2)
            wire.ask("bytes")
            counted = {}
            for operation in OPERATIONS:
                tries = []
                # take the fewest bytes, because on a busy machine an engine may repeat a request
                for _ in range(3):
                    one.series(operation, 2)
                    tries.append([int(part) / 2 for part in wire.ask("bytes").split()])
                counted[operation] = min(tries, key=sum)
            wire.ask("flip")
            told[name] = {"bytes": counted, "flipped": attempt(one), "after": attempt(one)}
            wire.ask("freeze")
        # in parallel, because each one only waits, some of them for ten seconds
        with ThreadPoolExecutor(len(peers)) as pool:
            frozen = pool.map(attempt, [one for one, _ in peers.values()])
        for name, outcome in zip(peers, frozen, strict=True):
            told[name]["frozen"] = outcome
    return told


def attempt(one: Peer, word: int = ADDRESS, right: int = EXPECTED) -> dict[str, Any]:
    """Read a word once. Return the result and the time that it took."""
    start = time.perf_counter()
    try:
        said = one.attempt(f"read {word}")
    except Silence:
        return {"outcome": "hangs", "detail": f"no answer after {PATIENCE_S:g} s", "time_s": PATIENCE_S}
    taken_s = time.perf_counter() - start
    if said == str(right):
        return {"outcome": "right", "detail": "", "time_s": taken_s}
    if said.isdecimal():
        return {"outcome": "wrong, unnoticed", "detail": f"{int(said):#x}", "time_s": taken_s}
    return {"outcome": "error", "detail": said, "time_s": taken_s}
