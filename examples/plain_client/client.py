# SPDX-License-Identifier: BSD-3-Clause
"""A client of the framed protocol in 60 lines, with nothing but Python: docs/protocol.md is enough."""

import random
import socket
import sys


def check(body: bytes, epoch: int) -> bytes:  # CRC-16/MCRF4XX in three bytes with the top bit set
    for byte in body:
        epoch ^= byte
        for _ in range(8):
            epoch = epoch >> 1 ^ (0x8408 if epoch & 1 else 0)
    return bytes(0x80 | epoch >> shift & 0x7F for shift in (0, 7, 14))


def frame(kind: int, payload: bytes, epoch: int) -> bytes:  # payload below 254 bytes: a block for each zero
    body = bytes([kind]) + b"".join(bytes([len(p) + 1]) + p for p in payload.split(b"\0"))
    return body + check(body, epoch) + b"\0"


def unframe(piece: bytes, epoch: int) -> tuple[int, bytes]:  # kind 0 means: not a frame of this session
    body, payload, at = piece[:-3], b"", 1
    if len(piece) < 5 or check(body, epoch) != piece[-3:]:
        return 0, b""
    while at < len(body):
        payload += body[at + 1 : at + body[at]] + b"\0"
        at += body[at]
    return body[0], payload[:-1]


class Client:
    def __init__(self, address: str) -> None:
        host, port = address.split(":")
        self.socket = socket.create_connection((host, int(port)), timeout=1)
        self.begun, self.id, self.epoch = b"", 0, 0xFFFF
        _, told = self.ask(0x80, b"\1\1", lambda kind, _: kind == 0xD0)  # HELLO
        self.a, self.d = told[5], told[6]
        epoch = random.randrange(0xFF00)
        self.ask(0x81, told[1:3] + epoch.to_bytes(2, "big") + b"\0", lambda kind, _: kind == 0xD1)  # OPEN
        self.epoch = epoch

    def ask(self, kind: int, payload: bytes, wanted) -> tuple[int, bytes]:
        for _ in range(5):  # send the same bytes again; the device executes them once
            self.socket.sendall(b"\0" + frame(kind, payload, self.epoch))
            try:
                while chunk := self.socket.recv(4096):
                    *pieces, self.begun = (self.begun + chunk).split(b"\0")
                    for answer in (unframe(piece, self.epoch) for piece in pieces):
                        if wanted(*answer):
                            return answer
            except TimeoutError:
                continue
        raise TimeoutError("no answer")

    def request(self, kind: int, body: bytes) -> bytes:
        number, self.id = self.id.to_bytes(2, "big"), (self.id + 1) % 65536
        status, reply = self.ask(kind, number + body, lambda k, p: 0xC0 <= k < 0xD0 and p[:2] == number)
        if status != 0xC0:
            raise OSError(f"the device answered status {status - 0xC0}")
        return reply[4:]

    def read(self, address: int) -> int:
        return int.from_bytes(self.request(0x82, address.to_bytes(self.a, "big")), "big")

    def write(self, address: int, value: int) -> None:
        self.request(0x83, address.to_bytes(self.a, "big") + value.to_bytes(self.d, "big"))


if __name__ == "__main__":
    client, where = Client(sys.argv[1]), int(sys.argv[2], 0)
    if len(sys.argv) > 3:
        client.write(where, int(sys.argv[3], 0))
    print(f"0x{where:x} = {client.read(where)}")
