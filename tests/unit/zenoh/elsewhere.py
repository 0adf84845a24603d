# SPDX-License-Identifier: BSD-3-Clause
"""A Zenoh router in a process and in a network namespace of its own, behind a virtual cable.

Where namespaces may not be made, which takes root, it is on loopback. `PLACE` says which.
"""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager

from unit.zenoh.rig import free_port

_ROUTER = """
import sys
from unitylink.zenoh.session import Network
with Network(listen=sys.argv[1]).opened():
    print("there", flush=True)
    sys.stdin.read()
"""
_NAME = f"ul{os.getpid()}"  # of the namespace, and of the cable's end here
_NET = f"10.{64 + os.getpid() % 64}.{os.getpid() // 64 % 256}"
_IP = shutil.which("ip", path=f"{os.environ['PATH']}:/usr/sbin:/sbin")


def _ip(*words: str) -> None:
    if _IP is None:
        raise FileNotFoundError("no `ip`: install iproute2, or run tools/setup.sh system")
    subprocess.run([_IP, *words], check=True, capture_output=True)


@contextmanager
def _namespace() -> Iterator[None]:
    with ExitStack() as stack:
        _ip("netns", "add", _NAME)
        stack.callback(_ip, "netns", "del", _NAME)  # and with it the cable
        _ip("link", "add", _NAME, "type", "veth", "peer", "name", "net", "netns", _NAME)
        _ip("address", "add", f"{_NET}.2/24", "dev", _NAME)
        _ip("link", "set", _NAME, "up")
        _ip("-n", _NAME, "address", "add", f"{_NET}.1/24", "dev", "net")
        _ip("-n", _NAME, "link", "set", "net", "up")
        yield


def _place() -> str:
    try:
        with _namespace():
            return "namespace"
    except subprocess.CalledProcessError:
        return "loopback"


PLACE = _place()


class Router:
    """The router: its `locator`, and a way to it that can be cut."""

    def __init__(self, locator: str, process: subprocess.Popen[str]) -> None:
        self.locator, self._process = locator, process

    def let(self, through: bool) -> None:
        """Cut the cable, or mend it. On loopback, the router stops instead, and goes on."""
        if PLACE == "namespace":
            _ip("-n", _NAME, "link", "set", "net", "up" if through else "down")
        else:
            self._process.send_signal(signal.SIGCONT if through else signal.SIGSTOP)
            os.waitid(os.P_PID, self._process.pid, os.WCONTINUED if through else os.WSTOPPED)


@contextmanager
def router() -> Iterator[Router]:
    """Run a router."""
    with ExitStack() as stack:
        host, within = "127.0.0.1", []
        if PLACE == "namespace":
            stack.enter_context(_namespace())
            host, within = f"{_NET}.1", [str(_IP), "netns", "exec", _NAME]
        locator = f"tcp/{host}:{free_port()}"
        process = stack.enter_context(
            subprocess.Popen(
                [*within, sys.executable, "-c", _ROUTER, locator],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                text=True,
            )
        )
        stack.callback(process.kill)
        assert process.stdout is not None
        assert process.stdout.readline() == "there\n"
        yield Router(locator, process)
