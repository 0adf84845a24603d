# SPDX-License-Identifier: BSD-3-Clause
"""Fig. 4 of the paper: how often messages of some size can be published, as far as this can be computed."""

from __future__ import annotations

from collections.abc import Callable

from .gateware import CLOCK_HZ
from .link_parameters import FT245_ASYNC

WORDS = (1, 2, 4, 8, 15, 16, 32, 64, 128, 255)


def message_bytes(words: int) -> int:
    """Return the bytes of a classic publish without checksum.

    >>> message_bytes(1)
    18
    """
    return 10 + 8 * words


def frame_bytes(words: int) -> int:
    """Return the bytes of a framed publish (docs/protocol.md, section 8).

    >>> frame_bytes(1), frame_bytes(255)
    (17, 1039)
    """
    payload = 7 + 4 * words
    whole = 1 + payload + 1 + payload // 254
    return whole + (3 if whole <= 256 else 5) + 1


def gateware_2012_hz(words: int) -> float:
    """The limit of the 2012 gateware: 20 + 16n clocks a message.

    >>> round(gateware_2012_hz(15))
    192308
    """
    return CLOCK_HZ / (20 + 16 * words)


def core_hz(words: int) -> float:
    """The limit of our core: 10 + 8n clocks, one byte in each clock."""
    return CLOCK_HZ / (10 + 8 * words)


def link_hz(words: int) -> float:
    """The limit of the paper's ideal link, from its byte rate alone."""
    return 1 / (message_bytes(words) * FT245_ASYNC.byte_s)


def framed_link_hz(words: int) -> float:
    """The same for frames."""
    return 1 / (frame_bytes(words) * FT245_ASYNC.byte_s)


def chip_hz(words: int) -> float:
    """The rate of the FT232H's model. Packets are full, and a microframe has as many as the driver takes."""
    return min(link_hz(words), _payload_hz() / message_bytes(words))


def framed_chip_hz(words: int) -> float:
    """The same for frames."""
    return min(framed_link_hz(words), _payload_hz() / frame_bytes(words))


def _payload_hz() -> float:
    p = FT245_ASYNC
    return p.packets_per_microframe * p.payload_bytes / p.microframe_s


LIMITS: dict[str, Callable[[int], float]] = {
    "2012 gateware": gateware_2012_hz,
    "our core, classic": core_hz,
    "ideal link, classic": link_hz,
    "ideal link, framed": framed_link_hz,
    "FT232H, classic": chip_hz,
    "FT232H, framed": framed_chip_hz,
}


def limits() -> dict[str, list[float]]:
    """Return each limit in messages per second, for the sizes of WORDS."""
    return {name: [limit(words) for words in WORDS] for name, limit in LIMITS.items()}
