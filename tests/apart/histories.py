# SPDX-License-Identifier: BSD-3-Clause
"""Run board, host and a bad wire as three programs. Kill two of them again and again, and judge the result.

    python tests/apart/histories.py                        # 100,000 messages, each profile in its turn
    python tests/apart/histories.py --messages 4000000 --jobs 2
    python tests/apart/histories.py --profile udp --seed 17 --messages 1 --keep /tmp/history

A message is a request of the protocol, as the host's link counts them, or a post. A list is one message. An
answer is not counted. A history always runs to its end, so there are some more messages than asked. The
machine decides when bytes come. So a seed draws the same faults, but the history is not the same. The
journals of a failed history are kept as the proof.
"""

from __future__ import annotations

import argparse
import itertools
import json
import random
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time
from collections import Counter
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from pathlib import Path

from journal import judged

HERE = Path(__file__).parent
BOARD = HERE.parents[1] / "build" / "native" / "journal_board"
HISTORY_WORDS = 20_000
CLIENTS = 4
PATIENCE_S = 120  # longest wait for a host that notes nothing


@dataclass(frozen=True)
class Profile:
    kind: str
    protocol: str
    faults: dict[str, float] = field(default_factory=dict)
    board_kill_s: float = 0.7  # about so long between two kills
    host_kill_s: float = 1.5
    options: str = "timeout=0.03&attempts=5"


_STREAM = {"split": 0.1, "lose": 0.01, "double": 0.01, "flip": 0.01, "cut": 0.002, "stall": 0.005}
_WHOLE = {"split": 0.1, "cut": 0.001, "stall": 0.002}  # no byte is altered
# Classic promises less, so less is asked of it: no byte is altered, and no answer is several timeouts late.
_CLASSIC = "timeout=0.2&attempts=4&crc=1"
PROFILES = {
    "tcp": Profile("tcp", "framed", _STREAM),
    "pty": Profile("pty", "framed", _STREAM),
    "udp": Profile("udp", "framed", {"lose": 0.02, "double": 0.05, "flip": 0.005, "cut": 0.01, "late": 0.05}),
    "kills": Profile("tcp", "framed", {"split": 0.05}, board_kill_s=0.1, host_kill_s=0.3),
    "classic-tcp": Profile("tcp", "classic", _WHOLE, options=_CLASSIC),
    "classic-pty": Profile("pty", "classic", _WHOLE, options=_CLASSIC),
}


@dataclass
class Report:
    words: int = 0
    requests: int = 0  # requests and posts, which are the messages
    executed: int = 0
    told: Counter[str] = field(default_factory=Counter)
    faults: Counter[str] = field(default_factory=Counter)
    violations: list[str] = field(default_factory=list)

    def add(self, other: Report) -> None:
        self.words += other.words
        self.requests += other.requests
        self.executed += other.executed
        self.told.update(other.told)
        self.faults.update(other.faults)
        self.violations += other.violations


def _free_port(kind: str) -> str:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM if kind == "udp" else socket.SOCK_STREAM) as one:
        one.bind(("127.0.0.1", 0))
        return str(one.getsockname()[1])


class History:
    """One life of a wire, with many lives of a board and of a host at its ends."""

    def __init__(self, profile: Profile, seed: int, words: int, folder: Path, board: Path = BOARD) -> None:
        self.profile, self.seed, self.words, self.folder, self.program = profile, seed, words, folder, board
        folder.mkdir(parents=True, exist_ok=True)
        if profile.kind == "pty":
            self.listen, self.target = str(folder / "host.tty"), str(folder / "board.tty")
            self.url = f"serial:{self.listen}"
        else:
            self.listen, self.target = _free_port(profile.kind), _free_port(profile.kind)
            self.url = f"{profile.kind}://127.0.0.1:{self.listen}"
        self.url += f"?{profile.options}&protocol={profile.protocol}&reconnect=1"

    def _board(self) -> subprocess.Popen[str]:
        endpoint = f"{self.profile.kind}:{self.target}"
        return subprocess.Popen(
            [self.program, endpoint, self.folder / "board", self.profile.protocol],
            stdin=subprocess.PIPE,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
            text=True,
        )

    def _noted(self) -> int:
        return sum(path.stat().st_size for path in self.folder.glob("client-*"))

    def run(self) -> Report:
        """Run until the host has done all its words. Return what the journals say."""
        chance = random.Random(self.seed)
        report = Report()
        rates = [str(self.seed), *(f"{name}={rate}" for name, rate in self.profile.faults.items())]
        board = self._board()
        wire = subprocess.Popen(
            [sys.executable, HERE / "wire.py", self.profile.kind, self.listen, self.target, *rates],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )
        assert wire.stdin is not None and wire.stdout is not None
        if wire.stdout.readline() != "ready\n":
            raise RuntimeError("the wire did not begin")
        told = self.folder / "host.txt"
        life = self.seed, self.words // CLIENTS, CLIENTS, self.profile.host_kill_s
        with told.open("w") as output:
            host = subprocess.Popen(
                [sys.executable, HERE / "host.py", self.url, self.folder, *map(str, life)], stdout=output
            )
        try:
            while host.poll() is None:
                # A board normally gets a while after its first executed word. One in five is killed whether
                # it has begun or not.
                noted, begun = self._noted(), time.monotonic()
                idle = chance.random() > 0.2
                while host.poll() is None and idle and self._noted() == noted:
                    if time.monotonic() > begun + PATIENCE_S:
                        report.violations.append(f"the host has done nothing for {PATIENCE_S} s")
                        _end(host)
                    time.sleep(0.005)
                until = time.monotonic() + chance.uniform(0.2, 1.8) * self.profile.board_kill_s
                while host.poll() is None and time.monotonic() < until:
                    time.sleep(0.005)
                if board.poll() is not None:
                    report.violations.append(f"the board ended by itself: {board.communicate()[1]}")
                    break
                if host.poll() is None:
                    # otherwise the wire would open another terminal that gets the same number
                    if self.profile.kind == "pty":
                        Path(self.target).unlink(missing_ok=True)
                    _end(board)
                    report.faults["board killed"] += 1
                    time.sleep(chance.choice((0, 0, 0.02)))
                    board = self._board()
        finally:
            for one in (host, board):
                _end(one)
            wire.stdin.close()
            report.faults.update(json.loads(wire.stdout.readline() or "{}"))
            wire.wait()
            wire.stdout.close()
        if host.returncode not in (0, -signal.SIGKILL):
            report.violations.append(
                f"the host ended with {host.returncode}: something else than an error of the link"
            )
        killed, requests = (int(word) for word in (told.read_text().split() or ["0", "0"]))
        report.faults["host killed"] += killed
        report.requests = requests
        verdict = judged(self.folder / "board", sorted(self.folder.glob("client-*")))
        report.words, report.executed = verdict.words, verdict.executed
        report.told.update(verdict.told)
        report.violations += verdict.violations
        return report


def _end(process: subprocess.Popen[str]) -> None:
    process.kill()
    process.wait()
    for stream in (process.stdin, process.stderr):
        if stream is not None:
            stream.close()


def lived(
    name: str, seed: int, words: int = HISTORY_WORDS, keep: Path | None = None, board: Path = BOARD
) -> Report:
    """Return the report of one history. Its journals stay if it failed, or in `keep`."""
    folder = keep / f"{name}-{seed}" if keep else Path(tempfile.mkdtemp(prefix="unitylink-history-"))
    report = History(PROFILES[name], seed, words, folder, board).run()
    if report.violations:
        report.violations.insert(0, f"--profile {name} --seed {seed} --words {words}; journals in {folder}")
    elif keep is None:
        shutil.rmtree(folder)
    return report


def main() -> int:
    plain = argparse.RawDescriptionHelpFormatter
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=plain)
    parser.add_argument("--profile", choices=PROFILES)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--messages", type=int, default=100_000)
    parser.add_argument("--seconds", type=float, default=float("inf"))
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--words", type=int, default=HISTORY_WORDS, help="read and written in a history")
    parser.add_argument("--board", type=Path, default=BOARD, help="another program in its place")
    parser.add_argument("--keep", type=Path, help="a folder for the journals")
    arguments = parser.parse_args()
    names = [arguments.profile] if arguments.profile else list(PROFILES)
    begun = time.monotonic()
    totals = {name: Report() for name in names}
    whole = Report()
    numbers = itertools.count()

    def job() -> None:
        while whole.requests < arguments.messages and time.monotonic() < begun + arguments.seconds:
            number = next(numbers)
            name = names[number % len(names)]
            report = lived(name, arguments.seed + number, arguments.words, arguments.keep, arguments.board)
            totals[name].add(report)
            whole.add(report)
            if report.violations:
                print("\n  ".join(report.violations[:20]), flush=True)

    with ThreadPoolExecutor(arguments.jobs) as pool:
        for done in [pool.submit(job) for _ in range(arguments.jobs)]:
            done.result()
    for name, total in totals.items():
        told, faults = (
            ", ".join(f"{count:,} {what}" for what, count in sorted(counts.items()))
            for counts in (total.told, total.faults)
        )
        print(f"{name}: {total.requests:,} messages ({told}); {faults}; {len(total.violations)} violations")
    print(
        f"apart: {whole.requests:,} messages with {whole.words:,} words, {whole.executed:,} writes executed, "
        f"{sum(whole.faults.values()):,} faults, {len(whole.violations)} violations, "
        f"{time.monotonic() - begun:.0f} s"
    )
    return 1 if whole.violations else 0


if __name__ == "__main__":
    sys.exit(main())
