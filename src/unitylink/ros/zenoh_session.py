# SPDX-License-Identifier: BSD-3-Clause
"""A session on the Zenoh network of ROS 2, configured as rmw_zenoh_cpp is."""

from __future__ import annotations

import json
import logging
import os
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from unitylink.errors import UrlError
from unitylink.zenoh_session import open_session

if TYPE_CHECKING:
    import zenoh

_log = logging.getLogger("unitylink.ros")
FILE, OVERRIDE = "ZENOH_SESSION_CONFIG_URI", "ZENOH_CONFIG_OVERRIDE"
# As a node of ROS 2 without a file: it finds others through the router of its machine, and is found there.
_SETTINGS: dict[str, Any] = {
    "mode": "peer",
    "connect/endpoints": ["tcp/localhost:7447"],
    "listen/endpoints": ["tcp/localhost:0"],
    # A peer goes on without a router, and looks for one all the time. A client cannot.
    "connect/timeout_ms": {"router": -1, "peer": -1, "client": 3000},
    "connect/exit_on_failure": {"router": False, "peer": False, "client": True},
    "connect/retry": {"period_init_ms": 100, "period_max_ms": 1000, "period_increase_factor": 1.5},
    "scouting/multicast/enabled": False,
    "scouting/gossip/enabled": True,
    "transport/shared_memory/enabled": False,
}


def overrides(text: str) -> dict[str, Any]:
    """Return what ZENOH_CONFIG_OVERRIDE says. Raises UrlError.

    >>> overrides('mode="client";connect/endpoints=["tcp/10.0.0.7:7447"]')
    {'mode': 'client', 'connect/endpoints': ['tcp/10.0.0.7:7447']}
    """
    found: dict[str, Any] = {}
    for part in filter(str.strip, text.split(";")):
        key, equals, value = part.partition("=")
        try:
            found[key.strip()] = json.loads(value)
        except ValueError:
            equals = ""
        if not equals or not key.strip():
            raise UrlError(
                f'{OVERRIDE}: {part.strip()!r} is not KEY=VALUE with a value of JSON: mode="client"'
            )
    return found


class RosSession:
    """How to get on the network: the variables of rmw_zenoh_cpp in `environment`."""

    def __init__(self, environment: Mapping[str, str] = os.environ) -> None:
        self._file = environment.get(FILE, "")
        self._settings = ({} if self._file else _SETTINGS) | overrides(environment.get(OVERRIDE, ""))

    def opened(self) -> zenoh.Session:
        """Open a session. Raises LinkNotFound, UrlError, or ToolError if the package is missing."""
        session = open_session(
            self._file,
            self._settings,
            use="ROS 2 over Zenoh",
            source=f"{FILE} or {OVERRIDE}",
            unreachable="there is no Zenoh network",
        )
        if not session.info.routers_zid():
            where = ", ".join(self._settings.get("connect/endpoints", [self._file]))
            _log.warning(
                "no Zenoh router at %s yet; other nodes are found when there is one: "
                "ros2 run rmw_zenoh_cpp rmw_zenohd",
                where,
            )
        return session
