# SPDX-License-Identifier: BSD-3-Clause
"""Unity-Link: a bridge between a PC and FPGA gateware for robots.

    from unitylink import connect

    with connect("sim:examples/scara/scara.ul") as link:
        print(link.configuration)

Names are loaded when they are first used, so that a command that needs no link starts at once.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from unitylink.lazy import load_name

if TYPE_CHECKING:
    from unitylink.connection import connect
    from unitylink.errors import (
        AssignmentError,
        BindingError,
        BoardError,
        BusError,
        DeviceMismatch,
        LinkBusy,
        LinkClosed,
        LinkDown,
        LinkError,
        LinkNotFound,
        LinkTimeout,
        NetworkError,
        OutcomeUnknown,
        ProtocolError,
        SpecError,
        ToolError,
        UnityLinkError,
        UnknownName,
        UrlError,
        ValueRangeError,
    )
    from unitylink.layer2_message import Configuration, Link, Statistics, Subscription

__version__ = "0.1.0"

__all__ = [
    "AssignmentError",
    "BindingError",
    "BoardError",
    "BusError",
    "Configuration",
    "DeviceMismatch",
    "Link",
    "LinkBusy",
    "LinkClosed",
    "LinkDown",
    "LinkError",
    "LinkNotFound",
    "LinkTimeout",
    "NetworkError",
    "OutcomeUnknown",
    "ProtocolError",
    "SpecError",
    "Statistics",
    "Subscription",
    "ToolError",
    "UnityLinkError",
    "UnknownName",
    "UrlError",
    "ValueRangeError",
    "__version__",
    "connect",
]

_HOMES = dict.fromkeys((name for name in __all__ if name != "__version__"), "errors") | {
    "Configuration": "layer2_message",
    "Link": "layer2_message",
    "Statistics": "layer2_message",
    "Subscription": "layer2_message",
    "connect": "connection",
}


def __getattr__(name: str) -> object:
    return load_name(__name__, _HOMES, name)


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
