# SPDX-License-Identifier: BSD-3-Clause
"""The other clients on a wire: `peer.py uart|server|script PTY` or
`peer.py udp|packets|server-udp HOST:PORT`.

uart: LiteX's CommUART. server: LiteX's RemoteClient over Etherbone to its litex_server, which opens the port.
udp, server-udp: the same with CommUDP instead, which sends Etherbone on the wire. packets: CommUDP, but
scattered reads go in one packet, made with LiteX's own classes. script: what a user writes with pyserial on
the classic protocol. It handles no timeout and has no checksum.

Each line on standard input gets an answer. "times OPERATION COUNT" gives the time of each call in ns. "read
WORD" and "write WORD VALUE" give a number, "done", or the error. "another" continues with a second client of
the server. "stop" ends the server. The operations are: read; write (LiteX acknowledges none, so it is read
back); block (255 words, LiteX's best call); cycle (18 scattered reads and 18 writes). Values are compared
outside of the timed part.
"""

from __future__ import annotations

import socket
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

FIRST = 0x40DE0000
WORD = 0x88
BLOCK = 255
READS = [0x300 + 7 * n for n in range(18)]
WRITES = [0x200 + 5 * n for n in range(18)]


class Litex:
    """A LiteX client. Its addresses count bytes."""

    def __init__(self, client: Any) -> None:
        self.client = client
        self.client.open()

    def read(self, word: int = WORD) -> int:
        return self.client.read(4 * word)

    def put(self, word: int, number: int) -> None:
        self.client.write(4 * word, number)

    def write(self, number: int) -> int:
        self.client.write(4 * WRITES[0], number)
        return self.client.read(4 * WRITES[0])

    def block(self) -> list[int]:
        return self.client.read(4 * WORD, BLOCK)

    def cycle(self, number: int) -> list[int]:
        for address in WRITES:
            self.client.write(4 * address, number)
        return [self.client.read(4 * address) for address in READS]


class Packets(Litex):
    """Etherbone at its best: one read has many addresses.

    Its packets can do that, but CommUDP does not offer it.

    Each write stays a packet of its own. A record writes only neighbouring words, and a packet for LiteX's
    gateware has one record.
    """

    def cycle(self, number: int) -> list[int]:
        from litex.tools.remote.etherbone import EtherbonePacket, EtherboneReads, EtherboneRecord

        for address in WRITES:
            self.client.write(4 * address, number)
        record = EtherboneRecord(addr_size=4)
        record.reads = EtherboneReads(addr_size=4, addrs=[4 * address for address in READS])
        record.rcount = len(READS)
        packet = EtherbonePacket(32)
        packet.records = [record]
        packet.encode()
        self.client.socket.sendto(packet.bytes, (self.client.server, self.client.port))
        answer = EtherbonePacket(32, self.client.socket.recvfrom(8192)[0])
        answer.decode()
        return answer.records.pop().writes.get_datas()


class Script:
    """The classic protocol, written by hand."""

    def __init__(self, path: str) -> None:
        import serial

        self.port = serial.Serial(path, 115200, timeout=2)

    def ask(self, line: str) -> bytes:
        self.port.write(line.encode())
        return self.port.read_until(b"\n")

    def read(self, address: int = WORD) -> int:
        return int(self.ask(f"#R:{address:04X}\n")[5:-1], 16)

    def write(self, number: int, address: int = WRITES[0]) -> int:
        self.ask(f"#W:{address:04X}{number:08X}\n")
        return number

    def block(self) -> list[int]:
        addresses = "".join(f"{WORD + n:04X}" for n in range(BLOCK))
        digits = self.ask(f"#RM:{BLOCK:02X}{addresses}\n")[6:-1]
        return [int(digits[at : at + 8], 16) for at in range(0, len(digits), 8)]

    def cycle(self, number: int) -> list[int]:
        for address in WRITES:
            self.write(number, address)
        return [self.read(address) for address in READS]


def comm_udp(place: str) -> Any:
    """Return a CommUDP with any free port.

    Its own choice is the device's port, which this machine already uses.
    """
    from litex.tools.remote.comm_udp import CommUDP

    host, _, port = place.rpartition(":")
    comm = CommUDP(host, int(port))
    comm.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    comm.socket.bind(("127.0.0.1", 0))
    comm.socket.settimeout(comm.timeout)
    return comm


def serve_udp(place: str, bind_port: int) -> None:
    """Serve as litex_server on UDP: do what its command does, with that CommUDP."""
    from litex.tools.litex_server import RemoteServer

    server = RemoteServer(comm_udp(place), "127.0.0.1", bind_port)
    server.open()
    server.start(4)
    threading.Event().wait()


class Server:
    """A litex_server on the port or the network, and clients of it."""

    def __init__(self, kind: str, place: str) -> None:
        with socket.socket() as probe:
            probe.bind(("127.0.0.1", 0))
            self._port = probe.getsockname()[1]
        if kind == "server":
            program = str(Path(sys.executable).parent / "litex_server")
            own = ["--bind-ip", "127.0.0.1", "--bind-port", str(self._port)]
            arguments = [program, "--uart", "--uart-port", place, *own]
        else:
            arguments = [__file__, "serve", place, str(self._port)]
        command = [sys.executable, *arguments]
        # Nothing reads what it prints, but a thread of it that dies prints a message there.
        quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL, "stdin": subprocess.DEVNULL}
        self._process = subprocess.Popen(command, **quiet)
        for _ in range(100):
            try:
                socket.create_connection(("127.0.0.1", self._port)).close()
                break
            except OSError:
                time.sleep(0.1)

    def client(self) -> Litex:
        from litex.tools.litex_client import RemoteClient

        return Litex(RemoteClient("127.0.0.1", self._port))

    def stop(self) -> None:
        self._process.kill()
        self._process.wait()


def main() -> None:
    kind, place = sys.argv[1:3]
    if kind == "serve":
        serve_udp(place, int(sys.argv[3]))
    server = Server(kind, place) if kind.startswith("server") else None
    if server is not None:
        peer: Any = server.client()
    elif kind == "uart":
        from litex.tools.remote.comm_uart import CommUART

        peer = Litex(CommUART(place))
    elif kind in ("udp", "packets"):
        peer = (Litex if kind == "udp" else Packets)(comm_udp(place))
    else:
        peer = Script(place)
    print("ready", flush=True)
    try:
        for line in sys.stdin:
            word, *rest = line.split()
            if word == "times":
                print(times(peer, rest[0], int(rest[1])), flush=True)
            elif word == "another":
                peer = server.client()
                print("ok", flush=True)
            elif word == "stop":
                server.stop()
                print("ok", flush=True)
            else:
                print(attempt(peer, word, *map(int, rest)), flush=True)
    finally:
        if server is not None:
            server.stop()


def attempt(peer: Any, operation: str, word: int, value: int = 0) -> str:
    try:
        if operation == "write":
            peer.put(word, value)
            return "done"
        return str(peer.read(word))
    except Exception as error:
        return f"{type(error).__name__}: {error}"


def times(peer: Any, operation: str, count: int) -> str:
    calls: dict[str, tuple[Callable[[int], Any], Callable[[int], Any]]] = {
        "read": (lambda _: peer.read(), lambda _: FIRST + WORD),
        "write": (peer.write, lambda number: number),
        "block": (lambda _: peer.block(), lambda _: [FIRST + WORD + n for n in range(BLOCK)]),
        "cycle": (peer.cycle, lambda _: [FIRST + address for address in READS]),
    }
    call, expected = calls[operation]
    taken = []
    for number in range(count):
        start = time.perf_counter_ns()
        got = call(number)
        taken.append(time.perf_counter_ns() - start)
        if got != expected(number):
            sys.exit(f"{operation} gave {got!r}, not {expected(number)!r}")
    return " ".join(map(str, taken))


if __name__ == "__main__":
    main()
