# SPDX-License-Identifier: BSD-3-Clause
"""Time LiteX's CommUART: `client.py PTY`, then one line `COUNT WORDS` on standard input for each series.

It prints the time of each of COUNT calls in ns, on one line. With WORDS 0 the call is `read(address)`,
LiteX's call for one register. Otherwise it is `read(address, WORDS)`, its best call for a block. Every value
is compared with what the emulator holds, outside of the timed part.
"""

from __future__ import annotations

import sys
from time import perf_counter_ns

from litex.tools.remote.comm_uart import CommUART

WORD_ADDRESS = 0x88
FIRST_VALUE = 0x40DE0000 + WORD_ADDRESS


def main() -> None:
    link = CommUART(sys.argv[1])
    link.open()
    byte_address = 4 * WORD_ADDRESS
    for line in sys.stdin:
        count, words = map(int, line.split())
        expected = list(range(FIRST_VALUE, FIRST_VALUE + words)) if words else FIRST_VALUE
        times = []
        for _ in range(count):
            start = perf_counter_ns()
            got = link.read(byte_address, words) if words else link.read(byte_address)
            times.append(perf_counter_ns() - start)
            if got != expected:
                sys.exit(f"LiteX read {got!r} where the emulator holds {expected!r}")
        print(*times, flush=True)


if __name__ == "__main__":
    main()
