# SPDX-License-Identifier: BSD-3-Clause
"""TosNet's asynchronous channel: bytes from node to node, beside the cyclic memory."""

from __future__ import annotations

import threading
from typing import TYPE_CHECKING

from unitylink import protocol
from unitylink.errors import LinkTimeout, ValueRangeError, shown

from .arguments import positive, whole

if TYPE_CHECKING:
    from unitylink.layer2_message import Link

FULL_BIT, EMPTY_BIT, VALID_BIT = 6, 7, 6  # bits of the send status, and of the receive status
LAST_BYTE_SHIFT = 4  # bits 5-4 of control and status words: index of the last valid byte
FIFO_WORDS = 128


class TosNetAsync:
    """Move bytes through the channel's two FIFOs. A word has four bytes, with byte 0 in bits 31-24.

    Pushes and pops are never repeated. A lost reply raises OutcomeUnknown or LinkTimeout.
    """

    def __init__(self, link: Link, base: int) -> None:
        self._link = link
        self._base = base
        self._lock = threading.Lock()  # control and data must be written together

    def send(self, node_id: int, data: bytes, timeout_s: float) -> None:
        node_id = whole("tosnet: node", node_id)
        timeout_s = positive("tosnet: timeout_s", timeout_s)
        if not isinstance(data, (bytes, bytearray, memoryview)):
            raise ValueRangeError(f"tosnet: {shown(data)} are not bytes to send")
        data = bytes(data)
        if not 0 <= node_id <= 15:
            raise ValueRangeError(f"tosnet: node {shown(node_id)} is not in 0..15 (0 = all)")
        if not data:
            raise ValueRangeError("tosnet: there are not bytes to send")
        deadline = self._link.now_s() + timeout_s
        with self._lock:
            control = None
            for start in range(0, len(data), 4):
                piece = data[start : start + 4]
                self._wait_for_space(deadline, timeout_s, start)
                wanted = (len(piece) - 1) << LAST_BYTE_SHIFT | node_id
                if control != wanted:
                    self._link.write(self._base + protocol.TOSNET_ASYNC_TX_CONTROL, wanted, repeat=True)
                    control = wanted
                word = int.from_bytes(piece.ljust(4, b"\0"), "big")
                self._link.write(self._base + protocol.TOSNET_ASYNC_TX_DATA, word, repeat=False)

    def _wait_for_space(self, deadline: float, timeout_s: float, sent: int) -> None:
        address = self._base + protocol.TOSNET_ASYNC_TX_STATUS
        while self._link.read(address) >> FULL_BIT & 1:
            if self._link.now_s() >= deadline:
                raise LinkTimeout(
                    f"tosnet: the asynchronous FIFO stayed full for {timeout_s:g} s; "
                    f"{sent} bytes were taken before",
                    address=address,
                    elapsed_s=timeout_s,
                )
            self._link.pause_between_looks()

    def receive(self) -> list[tuple[int, bytes]]:
        messages: list[tuple[int, bytes]] = []
        with self._lock:
            for _ in range(FIFO_WORDS):  # bounded, because a sender that never stops must not keep us here
                status = self._link.read(self._base + protocol.TOSNET_ASYNC_RX_STATUS)
                if status >> EMPTY_BIT & 1 or not status >> VALID_BIT & 1:
                    break
                node_id, count = status & 0xF, (status >> LAST_BYTE_SHIFT & 3) + 1
                word = self._link.read(self._base + protocol.TOSNET_ASYNC_RX_DATA, repeat=False)
                piece = word.to_bytes(4, "big")[:count]
                if messages and messages[-1][0] == node_id:
                    piece = messages.pop()[1] + piece
                messages.append((node_id, piece))
        return messages
