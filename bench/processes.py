# SPDX-License-Identifier: BSD-3-Clause
"""Programs that run beside a bench, each a process of its own."""

from __future__ import annotations

import signal
import subprocess
import sys
from contextlib import ExitStack

ROUTER = """
import sys, time
from unitylink.zenoh.session import Network
with Network(listen=sys.argv[1]).opened():
    print("there", flush=True)
    time.sleep(3600)
"""


class Processes:
    """Programs beside this one, each of which says a line when it is ready."""

    def __init__(self, stack: ExitStack) -> None:
        self._stack = stack
        self.pids: list[int] = []

    def start(self, *words: str) -> str:
        """Start one, and return its first line."""
        one = self._stack.enter_context(
            subprocess.Popen(
                [sys.executable, *words], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True
            )
        )
        self._stack.callback(one.send_signal, signal.SIGTERM)
        self.pids.append(one.pid)
        assert one.stdout is not None
        return one.stdout.readline()
