# SPDX-License-Identifier: BSD-3-Clause
"""Irregular data through a FIFO that triggers its own subscription group: in the core in GHDL, and in the
twin.
"""

from __future__ import annotations

import random
from pathlib import Path
from typing import Any

import pytest

from unitylink._native import Device
from unitylink.interface.board_configuration import BoardConfiguration, FifoConfiguration

FIFO = 0x40
DEPTH = 16
SETTINGS = (
    "#WSA:010140\n#WSA:000101\n#WSR:000005\n#WIC:0002\n#EPS\n"  # group 1 is the FIFO; group 0 has a rate
)
PUBLISH = b"%PUB:0101"
Schedule = list[tuple[int, int]]  # clock, word
Requests = list[tuple[int, str]]


def configuration(publish_mode: int, remind_clocks: int) -> BoardConfiguration:
    return BoardConfiguration(
        clock_hz=1_000_000,
        groups=2,
        group_size=16,
        read_many=32,
        publish_mode=publish_mode,
        edge_events=(1,),
        fifos=(FifoConfiguration(base=FIFO, depth=DEPTH, event_group=1, remind_clocks=remind_clocks),),
    )


def on_rtl(ghdl: Any, folder: Path, words: Schedule, requests: Requests, **generics: int) -> list[bytes]:
    """Return the lines that the core sends."""
    files = {name: folder / f"{name}.txt" for name in ("words", "requests", "answers")}
    files["words"].write_text("".join(f"{clock} {word:08x}\n" for clock, word in words))
    files["requests"].write_text("".join(f"{clock} {text.encode().hex()}\n" for clock, text in requests))
    last = max(clock for clock, _ in words + requests) + 30_000
    paths = {f"{name}_file": str(path) for name, path in files.items()}
    ghdl.run("fifo_publish_tb", **paths, last_clock=last, depth=DEPTH, **generics)
    sent = bytes(int(line.split()[1]) for line in files["answers"].read_text().splitlines())
    return sent.splitlines()


def on_twin(board: BoardConfiguration, words: Schedule, requests: Requests) -> list[bytes]:
    device, sent = Device(board), b""
    for clock, what in sorted([*words, *requests], key=lambda entry: entry[0]):
        device.run_until(clock)
        if isinstance(what, str):
            assert device.receive(what.encode()) == len(what)
        else:
            assert device.set(FIFO, what), "the FIFO is full"
        sent += device.take()
    device.run_until(device.clock + 30_000)
    return (sent + device.take()).splitlines()


def published(lines: list[bytes]) -> list[int]:
    return [int(line[len(PUBLISH) :], 16) for line in lines if line.startswith(PUBLISH)]


def irregular(seed: int, count: int = 150) -> Schedule:
    """Return single words, bursts and silences, with never more words at once than the FIFO holds."""
    draw, clock, words = random.Random(seed), 2000, []
    while len(words) < count:
        burst = draw.choice([1, 1, 1, 2, 5, DEPTH - 2])
        for _ in range(burst):
            words.append((clock, draw.getrandbits(32)))
            clock += draw.choice([1, 1, 2, 7, 30])
        clock += burst * 60 + draw.choice([1, 40, 300, 4000])
    return words


@pytest.mark.parametrize(("seed", "publish_mode"), [(1, 2), (2, 1), (3, 2)])
def test_every_word_once_and_in_order(ghdl: Any, tmp_path: Path, seed: int, publish_mode: int) -> None:
    words = irregular(seed)
    draw = random.Random(seed + 10)
    reads = [(draw.randrange(2000, words[-1][0]), "#R:01\n") for _ in range(100)]
    requests = [(10, SETTINGS), *sorted(reads)]
    rtl = on_rtl(ghdl, tmp_path, words, requests, publish_mode=publish_mode)
    twin = on_twin(configuration(publish_mode, 20_000), words, requests)
    for lines in (rtl, twin):
        assert published(lines) == [word for _, word in words]
        assert lines.count(b"#S_R:00000000") == 100, "requests are answered in between"
        assert not [line for line in lines if b"?" in line], "no word was asked for that is not there"


def test_words_that_were_there_before_anybody_asked(ghdl: Any, tmp_path: Path) -> None:
    """The event rose before the group was enabled. It rises again after `remind_clocks`."""
    words = [(100 + n, 0x1000 + n) for n in range(5)]
    requests = [(900, SETTINGS)]
    rtl = on_rtl(ghdl, tmp_path, words, requests, remind_clocks=5000)
    twin = on_twin(configuration(2, 5000), words, requests)
    assert published(rtl) == published(twin) == [word for _, word in words]
    assert not [line for line in rtl + twin if b"?" in line]
