# SPDX-License-Identifier: BSD-3-Clause
"""TosNet's line as samples, one a clock of the observer: packets become levels, and levels become packets."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Sequence
from itertools import groupby

from gateware.tosnet_packets import Packet
from gateware.tosnet_scrambler import SEED, following, scrambled

from gateware import tosnet_code as code

CLOCKS_PER_BIT = 4  # 50 MHz, 12.5 Mbit/s


class Sender:
    """What sends on a line: its running disparity, and the register that gives the seeds."""

    def __init__(self, seed: int = SEED) -> None:
        self.bits: list[int] = []
        self._disparity = code.START
        self._seed = seed

    def rest(self, symbols: int = 1) -> None:
        """Send K28.1, with which the line is at rest. The register of seeds steps with each."""
        for _ in range(symbols):
            self._send(code.K28_1, control=True)
            self._seed = following(self._seed)

    def packet(self, body: Iterable[int]) -> None:
        """Send a packet, without the K28.1 that ends it."""
        self._send(code.K28_5, control=True)
        self._send(self._seed)
        for byte in scrambled(bytes(body), self._seed):
            self._send(byte)

    def _send(self, byte: int, *, control: bool = False) -> None:
        symbol, self._disparity = code.encode(byte, self._disparity, control=control)
        self.bits += code.bits(symbol)


def encode_packets(
    bodies: Iterable[bytes],
    clocks_per_bit: float = CLOCKS_PER_BIT,
    *,
    rest: int = 4,
    ppm: float = 0.0,
    wrong_bits: Collection[int] = (),
    seed: int = SEED,
) -> list[int]:
    """Return the samples of packets with `rest` symbols between them, before the first, and behind the last.

    The sender's clock is `ppm` faster than the observer's. `wrong_bits` are inverted, counted from 0.
    """
    sender = Sender(seed)
    sender.rest(rest)
    for body in bodies:
        sender.packet(body)
        sender.rest(rest)
    for place in wrong_bits:
        sender.bits[place] ^= 1
    return levels(sender.bits, clocks_per_bit, ppm=ppm)


def levels(bits: Sequence[int], clocks_per_bit: float = CLOCKS_PER_BIT, *, ppm: float = 0.0) -> list[int]:
    """Return the samples of bits."""
    length = clocks_per_bit / (1 + ppm * 1e-6)
    return [bits[min(int(at / length), len(bits) - 1)] for at in range(round(len(bits) * length))]


def bits_of(samples: Sequence[int], clocks_per_bit: float = CLOCKS_PER_BIT) -> list[tuple[int, int]]:
    """Return the bits on a line, each with its first sample. Each edge sets the receiver's bit clock anew."""
    found: list[tuple[int, int]] = []
    start = 0
    for level, run in groupby(samples):
        length = sum(1 for _ in run)
        count = max(1, round(length / clocks_per_bit))
        found += [(level, start + round(k * clocks_per_bit)) for k in range(count)]
        start += length
    return found


def decode_line(
    samples: Sequence[int], clocks_per_bit: float = CLOCKS_PER_BIT, *, strict: bool = True
) -> list[Packet]:
    """Return the packets on a line in their order.

    A packet begins with K28.5, wherever it is, and ends with K28.1. A symbol that does not exist ends it as
    broken. So does one of the wrong disparity, if `strict`. A packet that the samples do not hold to its end
    is left out.

    >>> decode_line(encode_packets([bytes.fromhex("2101")]))[0].body.hex()
    '2101'
    """
    bits = bits_of(samples, clocks_per_bit)
    found: list[Packet] = []
    place = 0
    while (start := _next_start(bits, place)) is not None:
        data, broken, place = _data(bits, start + 10, strict)
        if broken is None:  # the end of the samples
            break
        found.append(
            Packet(
                body=scrambled(data[1:], data[0]) if data else b"",
                seed=data[0] if data else 0,
                start=bits[start][1],
                end=bits[place][1],
                broken=broken,
            )
        )
    return found


def _next_start(bits: Sequence[tuple[int, int]], place: int) -> int | None:
    word = 0
    for at in range(place, len(bits)):
        word = word >> 1 | bits[at][0] << 9
        if at - place >= 9 and code.starts_packet(word):
            return at - 9
    return None


def _symbols(bits: Sequence[tuple[int, int]], place: int) -> Iterator[tuple[int, int]]:
    while place + 10 <= len(bits):
        yield place, sum(bits[place + k][0] << k for k in range(10))
        place += 10


def _data(bits: Sequence[tuple[int, int]], place: int, strict: bool) -> tuple[bytes, str | None, int]:
    """Return the bytes from a place on, why they end, and where. No reason: the samples end."""
    data = bytearray()
    disparity = 2 * sum(bit for bit, _ in bits[place - 10 : place]) - 10
    disparity = 1 if disparity > 0 else -1  # K28.5 leaves it on the side of its surplus
    for at, symbol in _symbols(bits, place):
        meaning = code.decode(symbol, disparity) or (None if strict else code.decode(symbol, -disparity))
        if meaning is None:
            known = code.decode(symbol, -disparity)
            return bytes(data), "a symbol of the wrong disparity" if known else "no symbol of 8b10b", at
        character, disparity = meaning
        if character.control:
            return bytes(data), "" if character.byte == code.K28_1 else f"K {character.byte:#04x}", at
        data.append(character.byte)
    return bytes(data), None, len(bits)
