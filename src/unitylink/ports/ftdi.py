# SPDX-License-Identifier: BSD-3-Clause
"""FTDI chips as USB devices, for `ftdi:` links. The kernel's serial driver may use them or not."""

from __future__ import annotations

from dataclasses import dataclass

from .machine import Machine, SerialPort, entries, hexadecimal, text

VENDOR = 0x0403
# Product number of a chip from the factory -> number of its channels.
PRODUCTS = {0x6001: 1, 0x6010: 2, 0x6011: 4, 0x6014: 1, 0x6015: 1}
_CHANNELS = "ABCD"


@dataclass(frozen=True)
class FtdiChannel:
    """A channel of a chip.

    `port.device` is the kernel's serial port, or "". `node` is the file in /dev/bus/usb. To open the chip, a
    program needs permission to write to it.
    """

    port: SerialPort
    channel: str
    node: str

    @property
    def url(self) -> str:
        return f"ftdi:{self.port.serial_number}?channel={self.channel}"


def ftdi_channels(machine: Machine) -> list[FtdiChannel]:
    """Return the channels of all FTDI chips that are plugged in, by serial number."""
    found = []
    devices = machine.path("/sys/bus/usb/devices")
    for chip in entries(devices):
        product_id = hexadecimal(text(chip / "idProduct"))
        if hexadecimal(text(chip / "idVendor")) != VENDOR or product_id not in PRODUCTS:
            continue
        bus, number = text(chip / "busnum"), text(chip / "devnum")
        node = f"/dev/bus/usb/{int(bus):03}/{int(number):03}" if bus.isdigit() and number.isdigit() else ""
        for index, channel in enumerate(_CHANNELS[: PRODUCTS[product_id]]):
            interface = devices / f"{chip.name}:1.{index}"
            ttys = [entry.name for entry in entries(interface) if entry.name.startswith("ttyUSB")]
            port = SerialPort(
                device=f"/dev/{ttys[0]}" if ttys else "",
                vendor_id=VENDOR,
                product_id=product_id,
                manufacturer=text(chip / "manufacturer"),
                product=text(chip / "product"),
                serial_number=text(chip / "serial"),
                channel=channel if PRODUCTS[product_id] > 1 else "",
            )
            found.append(FtdiChannel(port, channel, node))
    return sorted(found, key=lambda one: (one.port.serial_number, one.channel))


def chosen(channels: list[FtdiChannel], serial_number: str, channel: str) -> FtdiChannel | None:
    """Return the channel that an `ftdi:` URL names. Return None if it is absent, or if there are several."""
    serials = {one.port.serial_number for one in channels}
    wanted = serial_number or (next(iter(serials)) if len(serials) == 1 else "")
    return next((c for c in channels if (c.port.serial_number, c.channel) == (wanted, channel)), None)
