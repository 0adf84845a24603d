# SPDX-License-Identifier: BSD-3-Clause
"""The same random traffic on the core in GHDL and on the twin gives equal reply bytes."""

from __future__ import annotations

import random
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import pytest

from unitylink.simulate import BoardConfiguration
from unitylink_lab.conformance.bench import bench, play_on_twin

QUIET = 400  # clocks; longer than a bus timeout and the rest after it
ODDITIES = "#$%&?:*\n\r ,.\t!0aGzR\x00\xff"

CONFIGURATIONS: list[dict[str, Any]] = [
    {},
    {"AW": 12, "DW": 16, "SG": 2, "SW": 3, "RB": 1, "PM": 1, "RMS": 5},
    {"AW": 16, "DW": 24, "SG": 0, "SW": 2, "RB": 4, "RMS": 255},
    {"AW": 32, "DW": 8, "SG": 4, "SW": 5, "RB": 3},
    {"AW": 5, "DW": 13, "PM": 0, "RMS": 0, "RLC": 0},
    {"AW": 8, "DW": 32, "CK": 1},
    {"AW": 8, "DW": 32, "CK": 0},
    {"AW": 12, "DW": 16, "SG": 4, "FULL": 0},
]


class Traffic:
    """A source of requests for one configuration. Most are correct, the others nearly."""

    def __init__(self, configuration: BoardConfiguration, seed: int) -> None:
        self.c = configuration
        self.random = random.Random(seed)
        self.address_bytes = (configuration.address_bits + 7) // 8
        self.data_bytes = (configuration.data_bits + 7) // 8

    def address(self) -> bytes:
        r = self.random
        if self.address_bytes > 2:  # the bench's memory holds 64 Ki words
            return r.randrange(1 << 16).to_bytes(self.address_bytes, "big")
        return r.randrange(16 if r.random() < 0.6 else 1 << 8 * self.address_bytes).to_bytes(
            self.address_bytes, "big"
        )

    def data(self) -> bytes:
        r, group = self.random, self.random.randrange(self.c.groups + (self.random.random() < 0.1))
        count = r.randint(0, 6) if r.random() < 0.8 else r.randint(0, 255)
        addresses = b"".join(self.address() for _ in range(count))
        self.command = r.choice(
            [
                "R",
                "R",
                "RM",
                "RM",
                "W",
                "W",
                "RLC",
                "WSA",
                "WSA",
                "WSR",
                "RSI",
                "EPS",
                "EPC",
                "DPS",
                "WIC",
                "RIC",
            ]
        )
        match self.command:
            case "R":
                return self.address()
            case "W":
                return self.address() + r.randbytes(self.data_bytes)
            case "RM":
                return bytes([count]) + addresses
            case "WSA":
                return bytes([group % 256, count]) + addresses
            case "WSR":
                return bytes([group % 256]) + r.randrange(3).to_bytes(self.c.rate_bytes, "big")
            case "RSI":
                return bytes([group % 256])
            case "WIC":
                return r.randbytes(2)
        return b""

    def message(self) -> str:
        r, data = self.random, self.data()
        if r.random() < 0.1:
            data = data[: r.randint(0, len(data))] + r.randbytes(r.randint(0, 2))
        letters = self.command if r.random() < 0.8 else self.command.lower()
        digits = data.hex() if r.random() < 0.5 else data.hex(r.choice(",. ")).upper()
        if self.c.datalink == "none":
            digits = data.decode("latin-1")
        body = letters + (":" + digits if data else "")
        if r.random() < 0.5:
            return f"#{body}\n"
        return f"${body}*{self.checksum(letters.encode() + data):02x}\n"

    def damaged(self) -> str:
        r, text = self.random, self.message()
        for _ in range(r.randint(1, 3)):
            place = r.randrange(len(text) + 1)
            text = text[:place] + r.choice(("", r.choice(ODDITIES))) + text[place + r.randint(0, 1) :]
        return text + "\n"

    def checksum(self, covered: bytes) -> int:
        sum_ = 0
        for byte in covered:
            sum_ ^= byte
            for _ in range(8 if self.c.checksum == "crc8" else 0):
                sum_ = (sum_ << 1 ^ (self.c.polynomial if sum_ & 0x80 else 0)) & 0xFF
        return sum_


def spoken(text: str, *, ending: str = "#\n") -> list[tuple[str, Any]]:
    """Return the steps of an exchange. If it starts publishing, it also stops it before the next base strobe.

    `ending` ends a message that is still open, for datalinks that ignore it otherwise.
    """
    return [("send", text), ("quiet", QUIET), ("send", ending + "#DPS\n"), ("quiet", QUIET)]


def split(answer: bytes) -> tuple[list[bytes], list[bytes]]:
    lines = answer.splitlines(keepends=True)
    return [line for line in lines if line[0] != ord("?")], [line for line in lines if line[0] == ord("?")]


def compare(exchanges: Sequence[Any], twin: Sequence[bytes], rtl: Sequence[bytes]) -> None:
    for exchange, expected, got in zip(exchanges, twin, rtl, strict=True):
        # The twin may report a bad message after the reply to a later one. The core never does.
        assert split(got) == split(expected), f"sent {exchange[0][1]!r}\ntwin {expected!r}\ncore {got!r}"


@pytest.mark.parametrize(
    "generics", CONFIGURATIONS, ids=lambda g: "-".join(f"{k}{v}" for k, v in g.items()) or "plain"
)
def test_messages(rtl: Any, generics: dict[str, Any]) -> None:
    configuration = bench(generics)
    traffic = Traffic(configuration, seed=1)
    exchanges = [spoken(traffic.message()) for _ in range(90)] + [
        spoken(traffic.damaged()) for _ in range(90)
    ]
    compare(exchanges, play_on_twin(configuration, exchanges), rtl(configuration, exchanges))


def test_data_as_bytes(rtl: Any) -> None:
    """Without a datalink, a request that lacks bytes takes them from whatever comes next."""
    configuration = replace(bench({"SG": 3, "SW": 3, "RMS": 20}), datalink="none")
    traffic = Traffic(configuration, seed=4)
    longest = "\n" * (1 + 255 * traffic.address_bytes)
    exchanges = [spoken(traffic.message(), ending=longest) for _ in range(100)]
    exchanges += [spoken(traffic.damaged(), ending=longest) for _ in range(50)]
    compare(exchanges, play_on_twin(configuration, exchanges), rtl(configuration, exchanges))


def test_another_polynomial(rtl: Any) -> None:
    configuration = replace(bench({}), polynomial=0x2F)
    traffic = Traffic(configuration, seed=2)
    exchanges = [spoken(traffic.message()) for _ in range(60)]
    answers = play_on_twin(configuration, exchanges)
    assert sum(answer.startswith(b"$S_") for answer in answers) > 10
    compare(exchanges, answers, rtl(configuration, exchanges))


@pytest.mark.parametrize("stall_percent", [0, 30, 80])
def test_bursts_under_back_pressure(rtl: Any, stall_percent: int) -> None:
    """Requests are sent without waiting, while either side of the stream may stall."""
    configuration = bench({"PM": 0})
    traffic = Traffic(configuration, seed=3 + stall_percent)
    exchanges: list[list[tuple[str, Any]]] = [
        [("send", "".join(traffic.message() for _ in range(20))), ("quiet", QUIET)] for _ in range(8)
    ]
    twin = play_on_twin(configuration, exchanges)
    compare(
        exchanges, twin, rtl(configuration, exchanges, stall_percent=stall_percent, seed=stall_percent + 1)
    )
