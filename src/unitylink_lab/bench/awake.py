# SPDX-License-Identifier: BSD-3-Clause
"""Keep the processors awake while a round trip is measured."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager

# The process ends with this program, however this program ends.
_SPIN = """
import os, sys
os.sched_setscheduler(0, os.SCHED_IDLE, os.sched_param(0))
os.sched_setaffinity(0, {int(sys.argv[1])})
while os.getppid() == int(sys.argv[2]):
    for _ in range(100_000):
        pass
"""


@contextmanager
def processors_awake() -> Iterator[None]:
    """Keep every processor from sleeping. On each one spins a process of the scheduling class `SCHED_IDLE`.

    Such a process runs only when no other wants to, and gives way at once. Without it, a round trip contains
    the time in which a processor wakes up. In a virtual machine this takes 20 to 100 us, and changes from one
    minute to the next.
    """
    command = [sys.executable, "-S", "-c", _SPIN]
    spinning = [
        subprocess.Popen([*command, str(processor), str(os.getpid())])
        for processor in sorted(os.sched_getaffinity(0))
    ]
    try:
        yield
    finally:
        for process in spinning:
            process.kill()
            process.wait()
