# SPDX-License-Identifier: BSD-3-Clause
"""Mutated specs: each gives only diagnostics with a place, and in time. A valid one survives formatting.

The long form is `python tests/unit/spec/fuzz_specs.py --count 1000000`. The tests run a short one.
"""

from __future__ import annotations

import argparse
import sys
import time
import traceback
from pathlib import Path

SLOWEST_S = 1.0  # limit for one spec, in processor time
PROGRESS = 50_000  # specs between two lines of progress


def main() -> int:
    """Run until the count or the time is used up. Print the text and the seed of each failure."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--count", type=int, default=1_000_000)
    parser.add_argument("--seconds", type=float, default=float("inf"))
    parser.add_argument("--seed", type=int, default=1)
    arguments = parser.parse_args()
    sys.path.insert(0, str(Path(__file__).parent))
    from test_properties import check, corpus, mutated

    texts = corpus()
    end = time.monotonic() + arguments.seconds
    slowest_s, slowest_seed = 0.0, 0
    count = failures = 0
    for seed in range(arguments.seed, arguments.seed + arguments.count):
        text = mutated(seed, texts)
        started = time.process_time()
        try:
            check(text)
        except Exception:
            failures += 1
            print(f"seed {seed}:\n{text}\n{traceback.format_exc()}", flush=True)
        took_s = time.process_time() - started
        if took_s > slowest_s:
            slowest_s, slowest_seed = took_s, seed
        if took_s > SLOWEST_S * 5:  # each spec is compiled and formatted several times
            failures += 1
            print(f"seed {seed} takes {took_s:.2f} s:\n{text}", flush=True)
        count += 1
        if count % PROGRESS == 0:
            print(f"{count:,} specs, {failures} failed", flush=True)
        if time.monotonic() > end:
            break
    print(
        f"fuzz_specs: {count:,} specs, {failures} failed; "
        f"the slowest {slowest_s * 1e3:.0f} ms (seed {slowest_seed})"
    )
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
