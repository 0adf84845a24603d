# SPDX-License-Identifier: BSD-3-Clause
"""Play histories of the compiled gateware behind faulty wires and devices.

It ends after so many messages, or after so many seconds. The same seed and number of messages give the same
histories, so they name a shard.

Example: `python tests/gateware/fuzz_rtl_faults.py --messages 100000 --seed 1`. The tests run a short history
of some profiles.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field
from itertools import count, product
from pathlib import Path
from typing import Any

KINDS = (("fast", "framed"), ("fast", "classic"), ("small", "framed"))  # engines with their protocols
# Where the device restarts again and again or lies, the host waits most of the time. The gateware's clock
# runs on meanwhile: a message costs some hundred times the work. So these histories are shorter.
WAITING = ("restarts", "dead", "half-dead", "closing", "renewing", "refusing")
MESSAGES, MESSAGES_WAITING = 2000, 100  # of a history
PROGRESS = 50_000  # messages after which the sums are printed


@dataclass(frozen=True)
class History:
    """One run of the simulation: the same fields give the same history."""

    seed: int
    profile: str
    engine: str
    protocol: str
    messages: int


@dataclass
class Sums:
    """What the histories from `first_seed` up to, and without, `seed` have shown."""

    first_seed: int
    seed: int = 0
    faults: int = 0
    failures: int = 0
    messages: Counter[tuple[str, str]] = field(default_factory=Counter)  # of each engine and protocol
    work_s: dict[tuple[str, str], float] = field(default_factory=dict)

    def add(self, history: History, report: dict[str, Any], work_s: float) -> None:
        kind = history.engine, history.protocol
        self.messages[kind] += report["messages"]
        self.work_s[kind] = self.work_s.get(kind, 0.0) + work_s
        self.faults += report["faults"]
        self.seed = history.seed + 1
        if report["violations"]:
            self.failures += 1
            print(f"{history}: {report['violations'][:5]}", flush=True)

    def __str__(self) -> str:
        return (
            f"seeds {self.first_seed} to {self.seed - 1}, {self.messages.total():,} messages, "
            f"{self.faults:,} faults, {self.failures} failed"
        )


def histories(first_seed: int, profiles: list[str]) -> Iterator[History]:
    """Yield a history of each profile and engine in turn, with consecutive seeds, without an end."""
    turns = list(product(profiles, KINDS))
    for seed in count(first_seed):
        profile, (engine, protocol) = turns[seed % len(turns)]
        yield History(seed, profile, engine, protocol, MESSAGES_WAITING if profile in WAITING else MESSAGES)


def main() -> int:
    """Print each history that fails, and the sums."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--seconds", type=float, default=60.0, help="if no messages are given")
    parser.add_argument("--messages", type=int, help="so many at least, however long it takes")
    parser.add_argument("--seed", type=int, default=1, help="of the first history")
    arguments = parser.parse_args()
    sys.path.insert(0, str(Path(__file__).parent))
    from test_rtl_faults import CLIENTS, compiled

    from unitylink import _native

    with tempfile.TemporaryDirectory() as folder:
        gateware = {engine: compiled(Path(folder), engine) for engine, _ in KINDS}
    end_s = time.monotonic() + arguments.seconds
    sums = Sums(arguments.seed)
    told = 0
    for history in histories(arguments.seed, [name for name, _ in _native.fault_profiles()]):
        sums.seed = history.seed
        enough = time.monotonic() >= end_s
        if arguments.messages is not None:
            enough = sums.messages.total() >= arguments.messages
        if enough:
            break
        begun_s = time.process_time()
        report = played(history, CLIENTS, gateware[history.engine])
        sums.add(history, report, time.process_time() - begun_s)
        if sums.messages.total() // PROGRESS > told:
            told = sums.messages.total() // PROGRESS
            print(f"[{sums}]", flush=True)
    for kind, number in sums.messages.items():
        rate = number / sums.work_s[kind]
        print(f"{' '.join(kind)}: {number:,} messages, {rate:,.0f} in a second of processor time")
    print(f"fuzz_rtl_faults: {sums}")
    return 1 if sums.failures else 0


def played(history: History, clients: int, gateware: tuple[Any, Any]) -> dict[str, Any]:
    """Return the report of a history."""
    from unitylink import _native

    model, configuration = gateware
    framed = history.protocol == "framed"
    return _native.run_faults(
        history.seed, history.messages, history.profile, framed, clients, 8, configuration, model
    )


if __name__ == "__main__":
    sys.exit(main())
