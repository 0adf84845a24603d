# SPDX-License-Identifier: BSD-3-Clause
"""Network namespaces around a switch, as machines of their own. Needs root."""

from __future__ import annotations

import contextlib
import ctypes
import os
import re
import signal
import subprocess
import sys
from contextlib import ExitStack

from processes import Processes

PORT = 7447
_NAME = re.compile(r"ulbench(\d+)-\w+")


def ip(*words: str) -> str:
    """Run `ip`, and return what it prints. Raises CalledProcessError."""
    return subprocess.run(["ip", *words], check=True, stdout=subprocess.PIPE, text=True).stdout


def sweep() -> None:
    """Remove the namespaces of benches that were killed, and end what still runs there."""
    for line in ip("netns", "list").splitlines():
        name = line.split()[0]
        found = _NAME.fullmatch(name)
        if found is None or _lives(int(found[1])):
            continue
        print(f"{name} is left of a bench that was killed; it is removed", file=sys.stderr)
        for pid in ip("netns", "pids", name).split():
            with contextlib.suppress(ProcessLookupError):
                os.kill(int(pid), signal.SIGKILL)
        ip("netns", "del", name)


def _lives(pid: int) -> bool:
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    except PermissionError:
        return True
    return True


class Lab:
    """Namespaces around a switch, and `programs` in them. All ends with the `with` block of `stack`."""

    def __init__(self, stack: ExitStack) -> None:
        sweep()
        self._stack = stack
        self._mark = f"ulbench{os.getpid()}-"
        self._names: list[str] = []
        self._switch = self._namespace("switch")
        ip("-n", self._switch, "link", "add", "switch", "type", "bridge")
        ip("-n", self._switch, "link", "set", "switch", "up")
        self.programs = Processes(stack)

    def _namespace(self, name: str) -> str:
        whole = f"{self._mark}{name}"
        ip("netns", "add", whole)
        self._stack.callback(subprocess.run, ["ip", "netns", "del", whole], check=False)
        ip("-n", whole, "link", "set", "lo", "up")
        return whole

    def join(self, name: str) -> str:
        """Make a namespace, with a cable to the switch. Return its address."""
        space = self._namespace(name)
        self._names.append(name)
        address = f"10.77.0.{len(self._names)}"
        ip("link", "add", name, "netns", self._switch, "type", "veth", "peer", "name", "net", "netns", space)
        ip("-n", self._switch, "link", "set", name, "master", "switch", "up")
        ip("-n", space, "address", "add", f"{address}/24", "dev", "net")
        ip("-n", space, "link", "set", "net", "up")
        return address

    def start(self, name: str, *words: str) -> tuple[subprocess.Popen[str], str]:
        """Start a program there. Return it and its first line."""
        within = ("ip", "netns", "exec", f"{self._mark}{name}")
        return self.programs.start(*words, within=within, quiet=False)

    def let(self, name: str, through: bool) -> None:
        """Pull a cable out of the switch, or put it back. Its end in the namespace does not notice."""
        ip("-n", self._switch, "link", "set", name, *(("master", "switch") if through else ("nomaster",)))

    def slow_down(self, name: str, rate: str) -> None:
        """Let the switch give so many bits a second at most to a namespace."""
        limit = ("tbf", "rate", rate, "burst", "10kb", "latency", "100ms")
        subprocess.run(
            ["tc", "-n", self._switch, "qdisc", "add", "dev", name, "root", *limit],
            check=True,
        )

    def enter(self, name: str) -> None:
        """Let this thread, and all that it starts, be there."""
        with open(f"/run/netns/{self._mark}{name}", "rb") as space:
            if ctypes.CDLL(None, use_errno=True).setns(space.fileno(), 0):
                raise OSError(ctypes.get_errno(), "setns")
