# SPDX-License-Identifier: BSD-3-Clause
"""What others do on a wire: `peer.py uart|server|script PTY`, lines on standard input, an answer each.

uart: LiteX's CommUART. server: its RemoteClient over Etherbone to its litex_server, which has the port.
script: what one writes with pyserial, on the classic protocol, without a timeout's handling or a checksum.

"times OPERATION COUNT" gives the time of each call in ns; "try" reads once and says what came: a number, or
the error. Operations: read; write (LiteX acknowledges none, so
it is read back); block (255 words, their best call); cycle (18 scattered reads and 18 writes). Values are
compared outside of the timed part.
"""

from __future__ import annotations

import socket
import subprocess
import sys
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
    """A LiteX client, whose addresses are those of bytes."""

    def __init__(self, client: Any) -> None:
        self.client = client
        self.client.open()

    def read(self) -> int:
        return self.client.read(4 * WORD)

    def write(self, number: int) -> int:
        self.client.write(4 * WRITES[0], number)
        return self.client.read(4 * WRITES[0])

    def block(self) -> list[int]:
        return self.client.read(4 * WORD, BLOCK)

    def cycle(self, number: int) -> list[int]:
        for address in WRITES:
            self.client.write(4 * address, number)
        return [self.client.read(4 * address) for address in READS]


class Script:
    """The classic protocol by hand."""

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


def serve_litex(path: str) -> Any:
    """Start litex_server on the port; return a client of it."""
    from litex.tools.litex_client import RemoteClient

    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
    program = Path(sys.executable).parent / "litex_server"
    command = [
        str(program),
        "--uart",
        "--uart-port",
        path,
        "--bind-ip",
        "127.0.0.1",
        "--bind-port",
        str(port),
    ]
    server = subprocess.Popen([sys.executable, *command], stdout=subprocess.DEVNULL, stdin=subprocess.DEVNULL)
    for _ in range(100):
        try:
            socket.create_connection(("127.0.0.1", port)).close()
            break
        except OSError:
            time.sleep(0.1)
    return server, RemoteClient("127.0.0.1", port)


def main() -> None:
    kind, path = sys.argv[1:3]
    server = None
    if kind == "uart":
        from litex.tools.remote.comm_uart import CommUART

        peer: Any = Litex(CommUART(path))
    elif kind == "server":
        server, client = serve_litex(path)
        peer = Litex(client)
    else:
        peer = Script(path)
    print("ready", flush=True)
    try:
        for line in sys.stdin:
            words = line.split()
            print(attempt(peer) if words[0] == "try" else times(peer, words[1], int(words[2])), flush=True)
    finally:
        if server is not None:
            server.kill()


def attempt(peer: Any) -> str:
    try:
        return str(peer.read())
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
