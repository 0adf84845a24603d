# SPDX-License-Identifier: BSD-3-Clause
"""Captures of a wire, read back as packets and as messages with their meaning.

from unitylink.capture import messages, read_packets

for message in messages(read_packets("scara.pcapng"), MessageReader({0x88: "j1.cpos"})):
    print(message.time_s, message.direction, message.text, message.meaning)
"""

from __future__ import annotations

from .messages import CaptureMessage, MessageReader, Pieces, messages
from .pcapng import Packet, PcapngWriter, read_packets

__all__ = [
    "CaptureMessage",
    "MessageReader",
    "Packet",
    "PcapngWriter",
    "Pieces",
    "messages",
    "read_packets",
]
