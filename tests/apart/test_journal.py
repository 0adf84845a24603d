# SPDX-License-Identifier: BSD-3-Clause
"""The oracle finds violations. Each of these journals holds one thing that is against a promise."""

from __future__ import annotations

import struct
from pathlib import Path

import pytest
from apart.journal import BORN, DONE, GOT, MORE, NOT, PART, POST, RECORD, UNKNOWN, WISH, judged

BEGUN = (0xFFFFFFFF, 0)
ONE, TWO, THREE = (0x10, 1), (0x11, 2), (0x10, 3)
W1, W2, W3 = ((WISH, *pair) for pair in (ONE, TWO, THREE))
OK, NO, DARK, SOME, SYNCED = (DONE, 0, 0), (NOT, 0, 0), (UNKNOWN, 0, 0), (PART, 0, 0), (DONE, 1, 0)

RIGHT = {
    "done": ([ONE, TWO], [W1, W2, OK]),
    "not done": ([], [W1, NO]),
    "unknown, and done": ([ONE], [W1, DARK]),
    "unknown, and not": ([], [W1, DARK]),
    "killed before it was told": ([ONE], [W1, (BORN, 0, 0), W2, DARK]),
    "a first part": ([ONE], [W1, W2, SOME]),
    "a post": ([ONE, TWO], [(POST, *ONE), W2, OK, SYNCED]),
    "read again": ([ONE, THREE], [(GOT, 0x10, 0), W1, OK, (GOT, *ONE), W3, OK, (GOT, *THREE)]),
    "read behind an unknown write": ([ONE, THREE], [W1, OK, W3, DARK, (GOT, *ONE), (GOT, *THREE)]),
    "read together while the board was killed": ([ONE, BEGUN], [W1, OK, (GOT, 0x10, 0), (MORE, *ONE)]),
    "read behind a restart": ([ONE, BEGUN], [W1, OK, (GOT, *ONE), (GOT, 0x10, 0)]),
}
WRONG = {
    "executed twice": ([ONE, ONE], [W1, OK]),
    "never executed": ([ONE], [W1, W2, OK]),
    "executed all the same": ([ONE], [W1, NO]),
    "executed elsewhere": ([(0x12, 1)], [W1, OK]),
    "nobody asked for it": ([ONE, TWO], [W1, OK]),
    "although one before it was not": ([TWO], [W1, W2, SOME]),
    "behind a later one": ([TWO, ONE], [W1, DARK, W2, OK]),
    "did not stand there then": ([ONE, THREE], [W1, OK, W3, OK, (GOT, *ONE)]),
}


def told(folder: Path, done: list[tuple[int, int]], noted: list[tuple[int, int, int]]) -> list[str]:
    records = [BEGUN, *done]
    board = struct.pack("<II", len(records), 0) + b"".join(struct.pack("<II", *one) for one in records)
    (folder / "board").write_bytes(board + bytes(64))  # a journal has room for more
    (folder / "client-0").write_bytes(b"".join(RECORD.pack(*one) for one in noted) + b"torn")
    return judged(folder / "board", [folder / "client-0"]).violations


@pytest.mark.parametrize("name", RIGHT)
def test_what_is_promised_is_right(name: str, tmp_path: Path) -> None:
    assert told(tmp_path, *RIGHT[name]) == []


@pytest.mark.parametrize("name", WRONG)
def test_what_is_not_is_told(name: str, tmp_path: Path) -> None:
    assert [name in text for text in told(tmp_path, *WRONG[name])] == [True]


@pytest.mark.parametrize("value", [0, 3])
def test_a_read_may_not_go_back(value: int, tmp_path: Path) -> None:
    """After an unknown write, a value that was read once stays until something else is written."""
    done, noted = [ONE, THREE], [W1, OK, W3, DARK, (GOT, *THREE), (GOT, 0x10, value)]
    assert bool(told(tmp_path, done, noted)) == (value == 0)
