# SPDX-License-Identifier: BSD-3-Clause
"""The assumptions of the model of the USB chip, each with its source."""

from __future__ import annotations

from dataclasses import dataclass, fields

PAPER_LINK_BITS_HZ = 67.1e6  # the paper's 64 Mbit/s are 64 * 2**20 bit/s


@dataclass(frozen=True)
class LinkParameters:
    """An FT232H between a USB host and a board. Times are in seconds, sizes in bytes.

    `send_immediate` says after which messages the board pulses SIWU#: "never", "publishes" or "all".
    """

    name: str = "FT245 asynchronous"
    byte_s: float = 8 / PAPER_LINK_BITS_HZ
    half_duplex: bool = True
    microframe_s: float = 125e-6
    packet_bytes: int = 512
    status_bytes: int = 2
    packets_per_microframe: int = 1
    chip_packets: int = 2
    latency_timer_s: float = 1e-3
    event_character: int | None = None
    send_immediate: str = "never"
    flow_controlled: bool = True

    @property
    def payload_bytes(self) -> int:
        """How many of the board's bytes a full packet holds."""
        return self.packet_bytes - self.status_bytes


SOURCES: dict[str, str] = {
    "byte_s": "asynchronous FT245: the paper's ideal row, 67.1e6 bit/s; UART: start, 8 data "
    "and stop bit at the baud rate; synchronous FT245: 60 MHz, a byte a clock (DS_FT232H)",
    "half_duplex": "FT245: one data bus of eight lines for both ways (DS_FT232H); a UART has a wire each way",
    "microframe_s": "USB 2.0, high speed. Assumed: an IN that was refused is tried again in the "
    "next microframe, an OUT goes at once, "
    "the host is informed at the end of a microframe (EHCI's interrupt threshold at one)",
    "packet_bytes": "USB 2.0, high-speed bulk",
    "status_bytes": "modem and line status at the head of each packet (FTDI, AN_232B-04)",
    "packets_per_microframe": "asynchronous FT245 and UART: 1, assumed; the paper's pause after 36 replies "
    "(504 bytes) and its mean of 35.3 Mb/s support this. Synchronous: 10, from the 320 Mbit/s of FTDI's "
    "own driver that the paper quotes",
    "chip_packets": "1 kB towards the host (DS_FT232H): two packets",
    "latency_timer_s": "assumed: 1 ms, the least the chip takes; inferred from the paper's 974 us. "
    "It restarts with each packet, and an empty packet goes when it runs out (AN_232B-04)",
    "event_character": "none in the paper's runs; a line feed makes the chip send with the next IN "
    "(AN_232B-04)",
    "send_immediate": "as the row of the table says. Assumed: the chip takes no further byte until the "
    "next IN",
    "flow_controlled": "FT245: RXF# and TXE#; a UART without handshake loses a byte that finds the FIFO full",
}


def uart(baud_hz: int) -> LinkParameters:
    """Return the chip as a UART at `baud_hz`.

    >>> uart(12_000_000).byte_s
    8.333333333333333e-07
    """
    return LinkParameters(
        f"UART {baud_hz / 1e6:g} MBaud", byte_s=10 / baud_hz, half_duplex=False, flow_controlled=False
    )


FT245_ASYNC = LinkParameters()
FT245_SYNC = LinkParameters("FT245 synchronous", byte_s=1 / 60e6, packets_per_microframe=10)
LINKS = (uart(1_000_000), uart(6_000_000), uart(12_000_000), FT245_ASYNC, FT245_SYNC)


def assumptions() -> list[dict[str, str]]:
    """Return every parameter of the paper's link: name, value and source.

    >>> assumptions()[0]["name"]
    'byte_s'
    """
    return [
        {"name": field.name, "value": _shown(getattr(FT245_ASYNC, field.name)), "source": SOURCES[field.name]}
        for field in fields(LinkParameters)
        if field.name != "name"
    ]


def _shown(value: object) -> str:
    if isinstance(value, float):
        return f"{value * 1e6:.4g} us"
    return str(value)
