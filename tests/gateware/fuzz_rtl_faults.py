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
from dataclasses import dataclass
from itertools import count, product
from pathlib import Path
from typing import Any

KINDS = (("fast", "framed"), ("fast", "classic"), ("small", "framed"))  # engines with their protocols
# Where the device restarts again and again or lies, the host waits most of the time. The gateware's clock
# runs on meanwhile: a message costs some hundred times the work. So these histories are shorter.
WAITING = ("restarts", "dead", "half-dead", "closing", "renewing", "refusing")
MESSAGES, MESSAGES_WAITING = 2000, 100  # of a history


@dataclass(frozen=True)
class History:
    """One run of the simulation: the same fields give the same history."""

    seed: int
    profile: str
    engine: str
    protocol: str
    messages: int


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
    end = time.monotonic() + arguments.seconds
    messages: Counter[tuple[str, str]] = Counter()
    work_s: Counter[tuple[str, str]] = Counter()
    faults, failures, seed = 0, 0, arguments.seed
    for history in histories(arguments.seed, [name for name, _ in _native.fault_profiles()]):
        seed = history.seed
        enough = time.monotonic() >= end
        if arguments.messages is not None:
            enough = messages.total() >= arguments.messages
        if enough:
            break
        begun_s = time.process_time()
        report = played(history, CLIENTS, gateware[history.engine])
        kind = history.engine, history.protocol
        work_s[kind] += time.process_time() - begun_s  # type: ignore[assignment]  # a Counter adds any number
        messages[kind] += report["messages"]
        faults += report["faults"]
        if report["violations"]:
            failures += 1
            print(f"{history}: {report['violations'][:5]}", flush=True)
    for kind, number in messages.items():
        rate = number / work_s[kind]
        print(f"{' '.join(kind)}: {number:,} messages, {rate:,.0f} in a second of processor time")
    print(
        f"fuzz_rtl_faults: seeds {arguments.seed} to {seed - 1}, {messages.total():,} messages, "
        f"{faults:,} faults, {failures} failed"
    )
    return 1 if failures else 0


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
