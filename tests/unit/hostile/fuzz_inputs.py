# SPDX-License-Identifier: BSD-3-Clause
"""Mutated inputs of every kind that is read from outside. Each is read, or refused with an error of ours.

The long form is `python tests/unit/hostile/fuzz_inputs.py --count 100000`. The tests run a short one. A
failure is printed with its seed. `--seed SEED --count 1` repeats it.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
import time
import traceback
import warnings
from collections import Counter
from pathlib import Path

SLOWEST_S = 5.0  # limit for one input, in processor time
PROGRESS = 10_000


def main() -> int:
    """Run until the count or the time is used up. Print the input and the seed of each failure."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=1_000_000)
    parser.add_argument("--seconds", type=float, default=float("inf"))
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", default="", help="one kind of input")
    arguments = parser.parse_args()
    sys.path.insert(0, str(Path(__file__).parent))
    from kinds import Inputs, shown

    warnings.simplefilter("ignore")
    with tempfile.TemporaryDirectory() as folder:
        inputs = Inputs(Path(folder), arguments.only)
        end = time.monotonic() + arguments.seconds
        read, failed, took = Counter[str](), Counter[str](), Counter[str]()
        slowest_s, slowest_seed = 0.0, 0
        for seed in range(arguments.seed, arguments.seed + arguments.count):
            kind, data = inputs.one(seed)
            started = time.process_time()
            try:
                inputs.read(kind, data)
            except Exception:
                failed[kind.name] += 1
                print(f"seed {seed}, {kind.name}: {shown(data)!r}\n{traceback.format_exc()}", flush=True)
            took_s = time.process_time() - started
            read[kind.name] += 1
            took[kind.name] += took_s  # type: ignore[assignment]
            if took_s > slowest_s:
                slowest_s, slowest_seed = took_s, seed
            if took_s > SLOWEST_S:
                failed[kind.name] += 1
                print(f"seed {seed}, {kind.name} takes {took_s:.1f} s: {shown(data)!r}", flush=True)
            if read.total() % PROGRESS == 0:
                print(f"{read.total():,} inputs, {failed.total()} failed", flush=True)
            if time.monotonic() > end:
                break
    for name in read:
        print(f"  {name:<16} {read[name]:>7,} inputs, {failed[name]} failed, {took[name]:.0f} s")
    print(
        f"fuzz_inputs: {read.total():,} inputs of {len(read)} kinds, {failed.total()} failed; "
        f"the slowest {slowest_s * 1e3:.0f} ms (seed {slowest_seed})"
    )
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
