# SPDX-License-Identifier: BSD-3-Clause
"""All kinds of input from outside: for each kind some good inputs, and the code that reads one.

`read` takes the mutated bytes and a folder to work in. It may raise an error of ours, which the command line
shows in a line. Any other exception is a defect.
"""

from __future__ import annotations

import random
import shutil
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import input_texts as texts
import input_wire as wire
from input_base import allowed, typed

__all__ = ["KINDS", "Inputs", "Kind", "allowed", "shown", "typed"]


@dataclass(frozen=True)
class Kind:
    """A kind of input. `share` says how often this kind is drawn, relative to the others."""

    name: str
    good: Callable[[Path], list[bytes]]
    read: Callable[[bytes, Path], None]
    share: int = 10
    words: list[bytes] = field(default_factory=list)  # the words that mutations insert
    text: bool = False  # if true, most inputs are kept valid UTF-8, because others are refused at once


_NUMBERS = [b"0", b"-1", b"1e308", b"nan", b"inf", b"0x", b"9" * 30, b"9" * 5000, b"1e999999"]
_TEXT = [
    *_NUMBERS,
    b"\0",
    b"\xff",
    "é§\u2028".encode(),
    b"$",
    b"$\\frac$",
    b"%s",
    b"{}",
    b"[" * 2000,
    b'"',
    b"'",
]
_BYTES = [
    bytes(4),
    b"\xff" * 4,
    b"\xff" * 8,
    b"\0" * 7 + b"\x80",
    b"\x01\0\0\0\0\0\0\0",
    b"$",
    b"\n",
    b"{",
    b"[",
]

KINDS = (
    Kind("recording, MCAP", wire.recordings(".mcap"), wire.read_recording(".mcap"), 20, [*_BYTES, *_TEXT]),
    Kind(
        "recording, CSV",
        wire.recordings(".csv"),
        wire.read_recording(".csv"),
        10,
        [*_TEXT, b",", b"\n", b"{"],
        text=True,
    ),
    Kind("capture", wire.captures, wire.read_capture, 15, _BYTES),
    Kind(
        "classic lines",
        wire.transfers("classic"),
        wire.read_transfers,
        15,
        [*_BYTES, *_TEXT, b"#", b"*", b":"],
    ),
    Kind("frames", wire.transfers("framed"), wire.read_transfers, 15, [*_BYTES, b"\xff>", b"\xff<"]),
    Kind(
        "lines typed",
        wire.transfers("classic"),
        wire.read_typed_lines,
        5,
        [*_TEXT, b"#R:j[0].pos", b"\n"],
        text=True,
    ),
    Kind(
        "page request",
        wire.page_requests,
        wire.read_page_request,
        10,
        [*_TEXT, b"[", b"{", b"}", b"null", b"true", b"[" * 5000, b'"id":'],
        text=True,
    ),
    Kind(
        "Foxglove message",
        wire.foxglove_messages,
        wire.read_foxglove_message,
        10,
        [*_BYTES, *_TEXT, b"[", b"{", b"null", b"[" * 5000],
    ),
    Kind("question", wire.questions, wire.read_question, 3, [*_TEXT, b" ", b"*", b"status"]),
    Kind(
        "spec",
        texts.specs,
        texts.read_spec,
        8,
        [*_TEXT, b"@", b"(", b";", b"READ", b"PUBLISH(1 Hz)"],
        text=True,
    ),
    Kind(
        "fleet",
        texts.fleets,
        texts.read_fleet_text,
        2,
        [*_TEXT, b"[[robot]]", b"[fleet]", b"*", b"/", b" = ", b"\n"],
        text=True,
    ),
    Kind(
        "import",
        texts.imports,
        texts.read_import,
        2,
        [*_TEXT, b"`include", b"addrmap", b"{", b"};"],
        text=True,
    ),
    Kind(
        "configuration",
        texts.configurations,
        texts.read_configuration,
        2,
        [*_TEXT, b'"pins"', b"{", b"}", b"[", b"null", b'"joint.0.home-sw-in"', b'"type": "stepdir"'],
        text=True,
    ),
    Kind("board", texts.boards, texts.read_board, 5, [*_TEXT, b"[", b"]", b"=", b"[[pins]]"], text=True),
    Kind("report", texts.reports, texts.read_report, 2, [*_TEXT, b"[", b"null"], text=True),
    Kind(
        "exchanges",
        texts.exchanges,
        texts.read_exchanges,
        3,
        [*_TEXT, b"[]", b"{}", b"null", b"[/x]"],
        text=True,
    ),
    Kind("settings", texts.settings, texts.read_settings, 5, [*_TEXT, b"="], text=True),
    Kind("value", texts.values, texts.read_value, 15, [*_TEXT, b"mm", b"deg", b"=", b",", b"_"], text=True),
    Kind(
        "command line",
        texts.command_lines,
        texts.read_command_line,
        4,
        [*_TEXT, b"\0", b"--json", b"*", b"0x10"],
        text=True,
    ),
    Kind(
        "URL",
        texts.urls,
        texts.read_url,
        3,
        [*_TEXT, b"&", b"=", b"?", b"%", b"%00", b"crc=", b"fifo="],
        text=True,
    ),
)


def mutated(chance: random.Random, good: list[bytes], words: list[bytes]) -> bytes:
    """Return a good input with one to four mutations: cut, remove, insert, double, flip bits, mix."""
    data = chance.choice(good)
    for _ in range(chance.randrange(1, 5)):
        at = chance.randrange(len(data) + 1)
        to = min(len(data), at + chance.choice((0, 1, 4, 8, chance.randrange(64))))
        other = chance.choice(good)
        start = chance.randrange(len(other) + 1)
        how = chance.randrange(8)
        if how == 0:
            data = data[:at]
        elif how == 1 and data:
            place = chance.randrange(len(data))
            data = data[:place] + bytes([data[place] ^ 1 << chance.randrange(8)]) + data[place + 1 :]
        elif how == 2:
            data = data[:to] + data[at:]  # doubled
        else:
            put = (
                b"",
                chance.choice(words),
                other[start : start + chance.randrange(64)],
                chance.randbytes(4),
            )
            data = data[:at] + put[how % 4] + data[to:]
    return data


class Inputs:
    """Inputs of all kinds or of one, with a folder of their own."""

    def __init__(self, folder: Path, only: str = "") -> None:
        self.folder = folder
        self.kinds = [kind for kind in KINDS if kind.name == only or not only]
        self.good = {}
        for kind in self.kinds:
            place = folder / kind.name.replace(" ", "-")
            place.mkdir(parents=True, exist_ok=True)
            self.good[kind.name] = kind.good(place)

    def one(self, seed: int) -> tuple[Kind, bytes]:
        chance = random.Random(seed)
        kind = chance.choices(self.kinds, [kind.share for kind in self.kinds])[0]
        data = mutated(chance, self.good[kind.name], kind.words)
        if kind.text and chance.randrange(8):
            data = data.decode("utf-8", "ignore").encode()
        return kind, data

    def read(self, kind: Kind, data: bytes) -> None:
        kind.read(data, self.folder / kind.name.replace(" ", "-"))

    def close(self) -> None:
        shutil.rmtree(self.folder, ignore_errors=True)


def shown(data: bytes) -> Any:
    return data if len(data) < 3000 else data[:3000] + b"..."
