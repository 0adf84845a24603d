# SPDX-License-Identifier: BSD-3-Clause
"""Sessions on a Zenoh network, with what a robot needs: quick to notice a loss, quiet otherwise."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from unitylink.errors import LinkNotFound
from unitylink.zenoh_session import open_session

if TYPE_CHECKING:
    import zenoh

ROUTER = "tcp/127.0.0.1:7447"
LEASE_MS = 800  # a peer that is silent for so long is gone
_BURST = 16  # set-points, at most: each goes alone, and one for which there is no room is dropped
# TCP waits 1 s, and more each time, before it asks again for a connection. So an attempt without an answer is
# given up early, and the next one asks at once.
_OPEN_MS = 400
_PAUSE_MS = 50  # between two attempts
_ROUTER_OPEN_MS = 1000  # from a router to another one, which may be far away
_TRY_MS = 2000  # how long a client tries at the start
_SLOW_OPEN_MS = 5000  # if the first attempts were all too short
_SOCKET_BYTES = 65536  # what waits in the kernel for a slow reader is old when it arrives


@dataclass(frozen=True)
class Network:
    """How to get on a Zenoh network.

    `connect` is a locator such as `tcp/10.0.0.7:7447`. With `listen`, the session is the router itself,
    and `connect` is another one to which it is linked.
    `config` is a file of Zenoh with all that is not here, such as TLS.
    """

    connect: str = ""
    listen: str = ""
    config: str = ""

    def opened(self) -> zenoh.Session:
        """Open a session. Raises LinkNotFound, UrlError, or ToolError if the package is missing."""
        if self.listen:
            unreachable = f"no Zenoh router can listen at {self.listen}"
        else:
            where = self.connect or self.config or ROUTER
            unreachable = f"no Zenoh router answers at {where}: is it running, or `unitylink bridge zenoh`?"

        def opened(settings: dict[str, Any]) -> zenoh.Session:
            return open_session(
                self.config,
                settings,
                use="a Zenoh network",
                source=self.config or self.listen or self.connect,
                unreachable=unreachable,
            )

        try:
            return opened(self._settings(_ROUTER_OPEN_MS if self.listen else _OPEN_MS))
        except LinkNotFound:
            if self.listen:
                raise
            # one attempt that may take long, for a network whose answers take longer than a short one
            return opened({**self._settings(_SLOW_OPEN_MS), "connect/timeout_ms": 0})

    def _settings(self, open_ms: int) -> dict[str, Any]:
        settings: dict[str, Any] = {
            "transport/link/tx/lease": LEASE_MS,
            "transport/link/tx/queue/congestion_control/drop/wait_before_drop": 0,
            "transport/link/tx/queue/size/interactive_high": _BURST,
            "transport/shared_memory/enabled": False,
            "transport/unicast/open_timeout": open_ms,
            "connect/retry": {
                "period_init_ms": _PAUSE_MS,
                "period_max_ms": _PAUSE_MS,
                "period_increase_factor": 1.0,
            },
        }
        if self.config:
            return settings if not self.connect else {**settings, "connect/endpoints": [_sized(self.connect)]}
        settings["scouting/multicast/enabled"] = False
        settings["scouting/gossip/enabled"] = False
        if self.listen:
            settings |= {"mode": "router", "listen/endpoints": [_sized(self.listen)]}
            if self.connect:
                settings["connect/endpoints"] = [_sized(self.connect)]
        else:
            settings |= {
                "mode": "client",
                "connect/endpoints": [_sized(self.connect or ROUTER)],
                "connect/timeout_ms": _TRY_MS,
            }
        return settings


def _sized(locator: str) -> str:
    """Return a locator with small buffers, unless it says something of them."""
    if not locator.startswith("tcp/") or "so_sndbuf" in locator or "so_rcvbuf" in locator:
        return locator
    joint = ";" if "#" in locator else "#"
    return f"{locator}{joint}so_sndbuf={_SOCKET_BYTES};so_rcvbuf={_SOCKET_BYTES}"
