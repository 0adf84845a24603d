# SPDX-License-Identifier: BSD-3-Clause
"""Mutated specs: each gives only positioned diagnostics, in time, and what is valid survives formatting.

`python tests/unit/spec/fuzz_specs.py --count 1000000` is the long form; the tests run a short one.
"""

from __future__ import annotations

import argparse
import sys
import time
from pathlib import Path

SLOWEST_S = 1.0  # of one spec, in processor time


def main() -> int:
    """Run until the count or the time is used up; print the seed of what fails."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=1_000_000)
    parser.add_argument("--seconds", type=float, default=float("inf"))
    parser.add_argument("--seed", type=int, default=1)
    arguments = parser.parse_args()
    sys.path.insert(0, str(Path(__file__).parent))
    from test_properties import check, corpus, mutated

    texts = corpus()
    end = time.monotonic() + arguments.seconds
    slowest = 0.0
    count = 0
    for seed in range(arguments.seed, arguments.seed + arguments.count):
        text = mutated(seed, texts)
        started = time.process_time()
        try:
            check(text)
        except BaseException:
            print(f"seed {seed}:\n{text}")
            raise
        took = time.process_time() - started
        slowest = max(slowest, took)
        if took > SLOWEST_S * 5:  # it is compiled and formatted several times
            print(f"seed {seed} takes {took:.2f} s:\n{text}")
            return 1
        count += 1
        if time.monotonic() > end:
            break
    print(f"fuzz_specs: {count:,} specs, the slowest {slowest * 1e3:.0f} ms")
    return 0


if __name__ == "__main__":
    sys.exit(main())
