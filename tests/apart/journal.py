# SPDX-License-Identifier: BSD-3-Clause
"""The oracle: it compares what the board's bus executed with what the host was told.

It knows nothing of the engine.

Board and host write their journals as they go, into files that outlive them. Each value is written once in a
history, so an execution shows which write caused it.
"""

from __future__ import annotations

import struct
from bisect import bisect_left, bisect_right
from dataclasses import dataclass, field
from pathlib import Path

RECORD = struct.Struct("<III")  # kind, address, value
# What a client of the host notes: before it asks ...
BORN, WISH, POST = 1, 2, 3
# ... and what it was told then of all its WISHes, or (address 1) of its POSTs, that have no outcome yet.
# PART means: the first of them, perhaps none and perhaps all.
DONE, NOT, UNKNOWN, PART = 4, 5, 6, 7
GOT, MORE = 8, 9  # a word that was read; another word of the same call, which may have been read before it
REQUESTS, POSTS = 0, 1
_TOLD = {DONE: "done", NOT: "not executed", UNKNOWN: "unknown", PART: "unknown"}
_BEGUN = 0xFFFFFFFF  # stands in place of an address when the board starts


@dataclass
class Wish:
    address: int
    value: int
    told: int = UNKNOWN
    at: list[int] = field(default_factory=list)  # the places in the board's journal where it was executed


def executions(path: Path) -> list[tuple[int, int]]:
    """Return what the board did, in order: (address, value). `_BEGUN` marks each start of the board."""
    data = path.read_bytes()
    (count,) = struct.unpack_from("<I", data)
    return list(struct.iter_unpack("<II", data[8 : 8 + 8 * count]))


class Words:
    """The value of each word of the board, with the place in its journal from which on it holds."""

    def __init__(self, done: list[tuple[int, int]]) -> None:
        self.begun = [at for at, (address, _) in enumerate(done) if address == _BEGUN]
        self._written: dict[int, tuple[list[int], list[int]]] = {}
        for at, (address, value) in enumerate(done):
            if address != _BEGUN:
                places, values = self._written.setdefault(address, ([], []))
                places.append(at)
                values.append(value)

    def held(self, address: int, value: int, floor: int, ceiling: int) -> int | None:
        """Return since when the word held `value` at some time between two places of the journal.

        Return None if it never did.

        A word is 0 when the board starts.
        """
        places, values = self._written.get(address, ([], []))
        first = max(0, bisect_right(places, floor) - 1)
        last = bisect_left(places, ceiling)
        for index in range(first, last):
            until = places[index + 1] if index + 1 < len(places) else ceiling
            ended = bisect_right(self.begun, places[index])
            if ended < len(self.begun):
                until = min(until, self.begun[ended])
            if values[index] == value and places[index] < ceiling and until > floor:
                return places[index]
        if value == 0:
            for began in self.begun:
                following = bisect_right(places, began)
                until = places[following] if following < len(places) else ceiling
                if began < ceiling and until > floor:
                    return began
        return None


@dataclass
class Verdict:
    words: int = 0
    executed: int = 0
    told: dict[str, int] = field(default_factory=dict)
    violations: list[str] = field(default_factory=list)


class Judge:
    """Compares the journals of clients with the board's journal."""

    def __init__(self, done: list[tuple[int, int]]) -> None:
        self.verdict = Verdict(executed=sum(address != _BEGUN for address, _ in done))
        self._words = Words(done)
        self._at: dict[int, list[tuple[int, int]]] = {}
        for at, (address, value) in enumerate(done):
            if address != _BEGUN:
                self._at.setdefault(value, []).append((at, address))

    def accuse(self, what: str, wish: Wish) -> None:
        self.verdict.violations.append(
            f"{what}: {wish.value:08x} at {wish.address:04x}, told {_TOLD[wish.told]}, executed {wish.at}"
        )

    def client(self, path: Path) -> None:
        """Judge what one client noted, in its order."""
        wishes: list[Wish] = []
        # for each call: the number of writes before it, and its words
        reads: list[tuple[int, list[tuple[int, int]]]] = []
        open_: dict[int, list[Wish]] = {REQUESTS: [], POSTS: []}
        parts: list[list[Wish]] = []
        for kind, address, value in RECORD.iter_unpack(whole(path)):
            if kind == BORN:
                for queue in open_.values():
                    queue.clear()  # the client was not told, so the outcome is unknown
            elif kind in (WISH, POST):
                wishes.append(Wish(address, value))
                open_[POSTS if kind == POST else REQUESTS].append(wishes[-1])
            elif kind == GOT:
                reads.append((len(wishes), [(address, value)]))
            elif kind == MORE:
                reads[-1][1].append((address, value))
            else:
                for wish in open_[address]:
                    wish.told = kind
                if kind == PART:
                    parts.append(list(open_[address]))
                open_[address].clear()
        for wish in wishes:
            found = self._at.pop(wish.value, [])
            wish.at = [at for at, _ in found]
            if any(address != wish.address for _, address in found):
                self.accuse("executed elsewhere", wish)
        self._times(wishes, parts)
        self._order(wishes)
        self._reads(wishes, reads)
        read = sum(len(words) for _, words in reads)
        self.verdict.words += len(wishes) + read
        for wish in wishes:
            name = _TOLD[wish.told]
            self.verdict.told[name] = self.verdict.told.get(name, 0) + 1
        self.verdict.told["read"] = self.verdict.told.get("read", 0) + read

    def nobodys(self) -> None:
        """Judge what is left after all clients: writes that were executed, but that nobody asked for."""
        for value, found in self._at.items():
            self.verdict.violations.append(f"executed, but nobody asked for it: {value:08x} at {found}")

    def _times(self, wishes: list[Wish], parts: list[list[Wish]]) -> None:
        for wish in wishes:
            if len(wish.at) > 1:
                self.accuse("executed twice", wish)
            if wish.told == DONE and not wish.at:
                self.accuse("never executed", wish)
            if wish.told == NOT and wish.at:
                self.accuse("executed all the same", wish)
        for part in parts:
            missing = False
            for wish in part:
                missing = missing or not wish.at
                if missing and wish.at:
                    self.accuse("executed although one before it was not", wish)

    def _order(self, wishes: list[Wish]) -> None:
        """Check that no write is executed after a later one that was reported as done."""
        last = 1 << 62
        for wish in reversed(wishes):
            if wish.at and wish.at[0] > last:
                self.accuse("executed behind a later one that was told as done", wish)
            if wish.told == DONE and wish.at:
                last = min(last, wish.at[0])

    def _reads(self, wishes: list[Wish], reads: list[tuple[int, list[tuple[int, int]]]]) -> None:
        """Check that a read gives a value that the word held between the write done before it and the one
        after it.

        Reads of one call may be under way together. If the board is killed, the answered ones show its old
        life. The others are asked again and show the next life.
        """
        ceilings = [1 << 62] * (len(wishes) + 1)
        for index in range(len(wishes) - 1, -1, -1):
            places = wishes[index].at
            ceilings[index] = min(ceilings[index + 1], places[0]) if places else ceilings[index + 1]
        floor, next_ = 0, 0
        for before, words in reads:
            while next_ < before:
                if wishes[next_].told == DONE and wishes[next_].at:
                    floor = max(floor, wishes[next_].at[0])
                next_ += 1
            seen = floor
            for address, value in words:
                since = self._words.held(address, value, floor, ceilings[before])
                if since is None:
                    self.verdict.violations.append(
                        f"read {value:08x} at {address:04x}, which did not stand there then (from {floor} on)"
                    )
                else:
                    seen = max(seen, since)
            floor = seen


def whole(path: Path) -> bytes:
    """Return the records of a file, without a last one that is incomplete."""
    data = path.read_bytes() if path.exists() else b""
    return data[: len(data) - len(data) % RECORD.size]


def judged(board: Path, clients: list[Path]) -> Verdict:
    """Return what the journals say about a history."""
    judge = Judge(executions(board))
    for path in clients:
        judge.client(path)
    judge.nobodys()
    return judge.verdict
