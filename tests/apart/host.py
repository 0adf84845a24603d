# SPDX-License-Identifier: BSD-3-Clause
"""A host that is meant to be killed: python host.py URL FOLDER SEED WORDS CLIENTS KILL_S

Each client runs in a thread of the program and uses words of its own, at random. It notes what it asks and
what it is told. It ends after WORDS words. After about KILL_S seconds the program is killed, and another one
takes its place.
"""

from __future__ import annotations

import ctypes
import itertools
import mmap
import os
import random
import signal
import struct
import sys
import threading
import time
from collections.abc import Callable
from pathlib import Path

from journal import BORN, DONE, GOT, MORE, NOT, PART, POST, POSTS, RECORD, REQUESTS, UNKNOWN, WISH

from unitylink import LinkError, OutcomeUnknown, connect
from unitylink.layer2_message import ExchangeGroup, Link

CLIENT_WORDS = 16  # words of each client
MOST = 24  # the most words in a call
GROUP = 4  # words each way in an exchange group
PAUSE_S = 0.002  # before asking again after an error, because the line may be gone


class Life:
    """What outlives the program, for the next one: how many words each client has done, and the values it
    used.
    """

    def __init__(self, clients: int) -> None:
        self._memory = mmap.mmap(-1, 8 * (2 * clients + 2))
        self.clients = clients

    def get(self, index: int) -> int:
        return int(struct.unpack_from("<Q", self._memory, 8 * index)[0])

    def words(self) -> int:
        return sum(self.get(2 * number) for number in range(self.clients))

    def add(self, index: int, count: int) -> int:
        value = self.get(index) + count
        struct.pack_into("<Q", self._memory, 8 * index, value)
        return value


class Client:
    """A client that trusts nothing and notes everything."""

    def __init__(self, number: int, link: Link, life: Life, folder: Path, seed: int) -> None:
        self.number, self.link, self.life = number, link, life
        self.random = random.Random(seed)
        self.addresses = range(0x100 + 0x20 * number, 0x100 + 0x20 * number + CLIENT_WORDS)
        self.file = os.open(folder / f"client-{number}", os.O_WRONLY | os.O_CREAT | os.O_APPEND, 0o666)
        size = os.fstat(self.file).st_size
        # a client that was killed while it noted has not asked yet
        os.ftruncate(self.file, size - size % RECORD.size)
        self.group: ExchangeGroup | None = None
        self.note((BORN, 0, 0))

    def note(self, *records: tuple[int, int, int]) -> None:
        """Write records with one system call, so that either all of them are in the file or none is."""
        os.write(self.file, b"".join(RECORD.pack(*record) for record in records))

    def some(self, most: int = MOST) -> list[int]:
        return self.random.choices(self.addresses, k=self.random.randint(1, most))

    def wish(self, addresses: list[int], kind: int = WISH) -> list[int]:
        last = self.life.add(2 * self.number + 1, len(addresses))
        first = (self.number + 1 << 26) + last - len(addresses)
        values = list(range(first + 1, first + len(addresses) + 1))
        self.note(*((kind, address, value) for address, value in zip(addresses, values, strict=True)))
        return values

    def tell(self, act: Callable[[], object], failed: int, queue: int = REQUESTS) -> bool:
        """Call `act` and note the outcome.

        It is `failed` after an error, except where the outcome is unknown.
        """
        try:
            act()
        except OutcomeUnknown:
            self.note((PART if failed == PART else UNKNOWN, queue, 0))
            return False
        except LinkError:
            self.note((failed, queue, 0))
            raise
        self.note((DONE, queue, 0))
        return True

    def got(self, addresses: list[int], words: list[int]) -> None:
        kinds = [GOT, *[MORE] * (len(words) - 1)]
        self.note(*zip(kinds, addresses, words, strict=True))

    def read(self) -> int:
        addresses = self.some(1)
        self.got(addresses, [self.link.read(addresses[0])])
        return 1

    def read_many(self) -> int:
        addresses = self.some()
        read = self.random.choice((self.link.read_many, self.link.read_each))
        self.got(addresses, read(addresses).tolist())
        return len(addresses)

    def write(self) -> int:
        addresses = self.some(1)
        (value,) = self.wish(addresses)
        self.tell(lambda: self.link.write(addresses[0], value), NOT)
        return 1

    def write_many(self) -> int:
        addresses = self.some()
        values = self.wish(addresses)
        self.tell(lambda: self.link.write_many(addresses, values), PART)
        return len(addresses)

    def exchange(self) -> int:
        """Write and read in one message, by name or as a group."""
        framed = self.link.protocol == "framed"
        named = self.random.random() < 0.5
        writes, reads = (self.some(8), self.some(8)) if named else (list(self.addresses[:GROUP]),) * 2
        if not named and self.group is None:
            self.group = self.link.exchange_group(writes=writes, reads=reads)
        values = self.wish(writes)
        words: list[int] = []

        def act() -> None:
            if named:
                words.extend(self.link.exchange(reads, list(zip(writes, values, strict=True))).tolist())
            elif self.group is not None:
                words.extend(int(word) for word in self.group.exchange(values))

        # with classic this is several messages, and any of them may fail
        if self.tell(act, NOT if framed else PART):
            self.got(reads, words)
        return len(writes) + len(reads)

    def post(self) -> int:
        """The next sync tells the outcome of posts, and its answer is for the whole link.

        So one client makes all posts.
        """
        addresses = self.some()
        if self.number > 0 or self.link.protocol != "framed":
            return self.write_many()
        values = self.wish(addresses, POST)
        try:
            self.link.post_many(addresses, values)
        except LinkError:
            self.note((UNKNOWN, POSTS, 0))  # some of them may be on their way
            raise
        if self.random.random() < 0.5:
            try:
                self.link.sync()
                self.note((DONE, POSTS, 0))
            except OutcomeUnknown:
                self.note((UNKNOWN, POSTS, 0))
        return len(addresses)

    def run(self, words: int) -> None:
        kinds = [
            self.read,
            self.read_many,
            self.read_many,
            self.write,
            self.write_many,
            self.exchange,
            self.post,
        ]
        while self.life.get(2 * self.number) < words and not self.link.closed:
            try:
                self.life.add(2 * self.number, self.random.choice(kinds)())
            except LinkError:
                time.sleep(PAUSE_S)
        os.close(self.file)


def live(url: str, folder: Path, seed: int, words: int, life: Life) -> None:
    """Run the program once, until the clients have done all their words, however often the link ends."""
    while any(life.get(2 * number) < words for number in range(life.clients)):
        try:
            link = connect(url)
        except LinkError:
            time.sleep(PAUSE_S)
            continue
        with link:
            clients = [Client(n, link, life, folder, seed * 64 + n) for n in range(life.clients)]
            threads = [threading.Thread(target=client.run, args=(words,)) for client in clients]
            for thread in threads:
                thread.start()
            counted = 0
            while any(thread.is_alive() for thread in threads):
                threads[0].join(0.005)
                told = link.statistics()
                life.add(2 * life.clients, told.requests + told.posts - counted)
                counted = told.requests + told.posts
        seed += 1000


def main(url: str, folder: Path, seed: int, words: int, *, clients: int, kill_s: float) -> int:
    ctypes.CDLL(None).prctl(1, signal.SIGKILL)  # end this process if the one that started it has ended
    life = Life(clients)
    chance = random.Random(seed)
    kills = 0
    for number in itertools.count():
        child = os.fork()
        if child == 0:
            ctypes.CDLL(None).prctl(1, signal.SIGKILL)
            threading.excepthook = lambda told: (sys.__excepthook__(*told[:3]), os._exit(3))  # type: ignore[arg-type,func-returns-value]
            try:
                live(url, folder, seed + number, words, life)
            except BaseException:
                sys.excepthook(*sys.exc_info())  # type: ignore[arg-type]
                os._exit(3)
            os._exit(0)
        # The child's time to live begins when it has done a word. For one child in five it begins at once.
        done, until = life.words() if chance.random() > 0.2 else -1, float("inf")
        while (ended := os.waitpid(child, os.WNOHANG))[0] == 0 and time.monotonic() < until:
            if until == float("inf") and life.words() != done:
                until = time.monotonic() + chance.uniform(0.2, 1.8) * kill_s
            time.sleep(0.005)
        if ended[0] == 0:
            os.kill(child, signal.SIGKILL)
            ended = os.waitpid(child, 0)
            kills += 1
        code = os.waitstatus_to_exitcode(ended[1])
        if code != -signal.SIGKILL:
            print(f"{kills} {life.get(2 * clients)}", flush=True)
            return code
    return 0


if __name__ == "__main__":
    url, folder, seed, words, clients, kill_s = sys.argv[1:]
    sys.exit(main(url, Path(folder), int(seed), int(words), clients=int(clients), kill_s=float(kill_s)))
