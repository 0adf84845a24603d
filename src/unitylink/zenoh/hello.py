# SPDX-License-Identifier: BSD-3-Clause
"""What a bridge answers to a hello. No I/O, no clock."""

from __future__ import annotations

import json
import struct
from dataclasses import fields
from typing import Any

from unitylink.errors import ProtocolError
from unitylink.layer2_message.configuration import Configuration

from .messages import CLOCK, VISIT

_DEVICE = tuple(one.name for one in fields(Configuration) if one.name != "discovered")
_WORD_BYTES_MAX = 4  # a message has words of 32 bits


def read_welcome(data: bytes) -> dict[str, Any]:
    """Return what a bridge answers to a hello. Raises ProtocolError, and nothing else, if it is none.

    >>> read_welcome(b'{"visit": "?"}')
    Traceback (most recent call last):
    unitylink.errors.ProtocolError: the bridge answers a hello with something else
    """
    try:
        told = json.loads(data)
        visit, now_ns, bridge = int(told["visit"]), int(told["now_ns"]), int(told["bridge"], 16)
        CLOCK.pack(bridge, now_ns)  # numbers that the messages to this bridge can hold
        VISIT.pack(visit)
        device = {name: int(told["configuration"][name]) for name in _DEVICE}
        if not 1 <= device["data_bytes"] <= _WORD_BYTES_MAX or min(device.values()) < 0:
            raise ValueError("a device that there cannot be")
        return {
            "visit": visit,
            "bridge": f"{bridge:016x}",
            "now_ns": now_ns,
            "hash": str(told["hash"]),
            "configuration": device,
        }
    except (ValueError, TypeError, KeyError, OverflowError, RecursionError, struct.error):
        raise ProtocolError("the bridge answers a hello with something else") from None
