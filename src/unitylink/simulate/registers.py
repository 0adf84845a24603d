# SPDX-License-Identifier: BSD-3-Clause
"""The registers of a virtual board, from the FPGA's side."""

from __future__ import annotations

from collections.abc import Sequence

from unitylink import _native
from unitylink.errors import ValueRangeError

from .components import BoardComponents


class Registers:
    """The registers as the logic in the FPGA sees them: `registers[address]` is a raw unsigned word.

    In plain memory both sides see the same word. On TosNet, nodes read the IN words of the last commit, and
    set their OUT words. Behind a FIFO, setting its data register queues a word for the PC. Getting it takes a
    word from the PC. Negative values are stored as two's complement. Calls may come from any thread. Raises
    ValueRangeError.

        registers[0x88] = -1200          # an encoder count
        set_point = registers.signed(0x8C)

    The words of a component are its own: a plant reads them, and drives the pins in `components`.
    """

    def __init__(
        self, native: _native.Board, data_bits: int, components: BoardComponents | None = None
    ) -> None:
        self._native = native
        self._data_bits = data_bits
        self.components = components if components is not None else BoardComponents(native, ())

    @property
    def data_bits(self) -> int:
        return self._data_bits

    def __getitem__(self, address: int) -> int:
        value = self._native.get(self._word(address))
        if value is None:
            raise ValueRangeError(
                f"register 0x{address:04x} cannot be read from the board's side: nothing is there"
            )
        return value

    def __setitem__(self, address: int, value: int) -> None:
        if not -(1 << (self._data_bits - 1)) <= value < 1 << self._data_bits:
            raise ValueRangeError(
                f"register 0x{address:04x} has {self._data_bits} bits; {value} does not fit"
            )
        if not self._native.set(self._word(address), value & ((1 << self._data_bits) - 1)):
            raise ValueRangeError(
                f"register 0x{address:04x} cannot be set from the board: "
                "it belongs to the PC or to a component, is full, or does not exist"
            )

    def signed(self, address: int) -> int:
        """Return the word at `address` as a number in two's complement."""
        value = self[address]
        return value - (1 << self._data_bits) if value >> (self._data_bits - 1) else value

    def read_many(self, addresses: Sequence[int]) -> list[int]:
        """Return the words at some addresses. This is quicker than one after another."""
        words = self._native.get_many(addresses)
        if len(words) < len(addresses):
            self[addresses[len(words)]]  # it raises the error
        return words

    def write_many(self, addresses: Sequence[int], words: Sequence[int]) -> None:
        """Set the words at some addresses, in order."""
        most = 1 << self._data_bits
        if type(words) is not list:
            words = list(words)
        if words and (min(words) < 0 or max(words) >= most):
            for address, word in zip(addresses, words, strict=True):
                if not 0 <= word < most:
                    self[address] = word  # it takes a negative one, or raises the error
            words = [word & most - 1 for word in words]
        if len(addresses) != len(words):
            raise ValueRangeError(f"{len(addresses)} addresses and {len(words)} words")
        done = self._native.set_many(addresses, words)
        if done < len(words):
            self[addresses[done]] = words[done]

    def event(self, group: int) -> None:
        """Pulse the event input of a publish group.

        Its words go to the PC if the PC has subscribed to them.
        """
        self._native.pulse_event(group)

    def async_receive(self) -> list[tuple[int, bytes]]:
        """Take what the PC sent through TosNet's asynchronous channel, oldest first.

        Each entry is (node, 1 to 4 bytes).
        """
        taken = []
        while (word := self._native.async_take()) is not None:
            node, data, count = word
            taken.append((node, data.to_bytes(4, "big")[:count]))
        return taken

    def async_send(self, node: int, data: bytes) -> None:
        """Let `node` send 1 to 4 bytes to the PC. Raises ValueRangeError if its queue is full."""
        if not 1 <= len(data) <= 4 or not 1 <= node <= 15:
            raise ValueRangeError(
                f"asynchronous word of {len(data)} bytes from node {node}; 1 to 4 bytes, nodes 1 to 15"
            )
        if not self._native.async_give(node, int.from_bytes(data.ljust(4, b"\0"), "big"), len(data)):
            raise ValueRangeError(f"node {node}: the asynchronous channel is full or the board has no TosNet")

    def _word(self, address: int) -> int:
        if not 0 <= address < 1 << 32:
            raise ValueRangeError(f"address {address} is not in 0..0xffffffff")
        return address
