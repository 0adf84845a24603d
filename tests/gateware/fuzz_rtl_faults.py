# SPDX-License-Identifier: BSD-3-Clause
"""Play histories of the compiled gateware behind faulty wires and devices, until the time is used up.

Example: `python tests/gateware/fuzz_rtl_faults.py --seconds 60 --seed 1`. The tests run a short history of
each profile.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
import time
from pathlib import Path

MESSAGES = 300


def main() -> int:
    """Print the seed, profile and protocol of each history that fails."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seconds", type=float, default=60.0)
    parser.add_argument("--seed", type=int, default=1)
    arguments = parser.parse_args()
    sys.path.insert(0, str(Path(__file__).parent))
    from test_rtl_faults import CLIENTS, PROFILES, compiled

    from unitylink import _native

    with tempfile.TemporaryDirectory() as folder:
        model, configuration = compiled(Path(folder))
    end = time.monotonic() + arguments.seconds
    seed, messages, failures = arguments.seed, 0, 0
    while time.monotonic() < end:
        profile, framed = PROFILES[seed % len(PROFILES)], seed // len(PROFILES) % 2 == 0
        report = _native.run_faults(seed, MESSAGES, profile, framed, CLIENTS, 8, configuration, model)
        messages += report["messages"]
        if report["violations"]:
            failures += 1
            name = "framed" if framed else "classic"
            print(f"seed {seed}, {profile}, {name}: {report['violations'][:5]}", flush=True)
        seed += 1
    print(f"fuzz_rtl_faults: {seed - arguments.seed} histories, {messages:,} messages, {failures} failed")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
