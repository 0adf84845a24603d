# SPDX-License-Identifier: BSD-3-Clause
"""The far end of LiteX's Etherbone: an instant device on UDP. LiteX's own package makes the packets.

It prints HOST:PORT and serves until standard input ends. Word n holds 0x40DE0000 + n until it is written, as
in `bench/native/bench_uartbone.cpp`.
"""

from __future__ import annotations

import select
import socket
import sys
from typing import Any

from litex.tools.remote.etherbone import EtherbonePacket, EtherboneRecord, EtherboneWrites

FIRST = 0x40DE0000
WIDTH = 32


def answer(words: dict[int, int], request: bytes) -> bytes | None:
    """Do what a request asks for. Return the answer, or None if there is none."""
    packet = EtherbonePacket(WIDTH, request)
    packet.decode()
    reply = EtherbonePacket(WIDTH)
    if packet.pf:
        reply.pr = 1
        reply.encode()
        return bytes(reply.bytes)
    for asked in packet.records:
        if asked.writes is not None:
            for at, value in enumerate(asked.writes.get_datas()):
                words[asked.writes.base_addr // 4 + at] = value
        if asked.reads is not None:
            reply.records.append(told(words, asked.reads))
    if not reply.records:
        return None
    reply.encode()
    return bytes(reply.bytes)


def told(words: dict[int, int], reads: Any) -> EtherboneRecord:
    numbers = [address // 4 for address in reads.get_addrs()]
    values = [words.get(number, FIRST + number) for number in numbers]
    # the package's decoder leaves this part undecoded
    id_of_read = int.from_bytes(reads.bytes[: WIDTH // 8], "big")
    record = EtherboneRecord(WIDTH // 8)
    record.writes = EtherboneWrites(WIDTH // 8, base_addr=id_of_read, datas=values)
    record.wcount = len(values)
    return record


def main() -> None:
    words: dict[int, int] = {}
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as port:
        port.bind(("127.0.0.1", 0))
        print(f"127.0.0.1:{port.getsockname()[1]}", flush=True)
        while True:
            ready, _, _ = select.select([port, sys.stdin], [], [])
            if sys.stdin in ready:
                return
            request, sender = port.recvfrom(65536)
            reply = answer(words, request)
            if reply is not None:
                port.sendto(reply, sender)


if __name__ == "__main__":
    main()
