# SPDX-License-Identifier: BSD-3-Clause
"""All reasons why a board may not answer. The doctor and the documents use this one table.

`page()` is docs/troubleshooting.md.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from textwrap import fill
from types import MappingProxyType


@dataclass(frozen=True)
class FindingKind:
    """One kind of trouble.

    `cause`, `remedy` and `more` are format strings, filled in with what the doctor has found. `remedy` is a
    command, with a remark after a #, or it is an option. `severity` is "error" if nothing works until it is
    mended.
    """

    severity: str
    title: str
    cause: str
    remedy: str
    more: str = ""


@dataclass(frozen=True)
class Finding:
    """One finding, described for this link."""

    code: str
    severity: str
    title: str
    cause: str
    remedy: str


FINDINGS: Mapping[str, FindingKind] = MappingProxyType(
    {
        "no-port": FindingKind(
            "error",
            "The port does not exist",
            "{device} is not there; ports on this machine: {ports}",
            "unitylink discover",
            "The board is not plugged in, has no power, or was given another number. Names that do not "
            "change are in /dev/serial/by-id/. `dmesg -w` shows what the kernel says at plug-in. A container "
            "or WSL must be given the port: `docker run --device`, `usbipd attach`.",
        ),
        "brltty": FindingKind(
            "warning",
            "A driver for Braille displays takes ports away",
            "brltty runs, and mistakes the USB chip of {device} for a Braille display",
            "sudo apt remove brltty    # if nobody reads Braille here; then plug the board in again",
            "Ubuntu 22.04 starts it for some CH340, CP210x and FTDI chips: the port appears and vanishes at "
            "once. `sudo dmesg | grep brltty` shows it.",
        ),
        "no-serial-port": FindingKind(
            "error",
            "The file is not a serial port",
            "{device} exists, and is something else",
            "unitylink discover",
            "Serial ports are called /dev/ttyUSB0, /dev/ttyACM0, /dev/ttyS0 or /dev/serial/by-id/...",
        ),
        "permission": FindingKind(
            "error",
            "The port may not be opened",
            "{device} belongs to the group {group}, and this user is not in it",
            "sudo usermod -aG {group} $USER    # then log out and in again",
            "`newgrp {group}` does it for one shell at once. Or install the udev rule, which opens the "
            'port to the user who sits at the machine (not over ssh): `sudo "$(which unitylink)" doctor '
            "LINK --install`.",
        ),
        "busy-port": FindingKind(
            "error",
            "Another program has the port",
            "{device} is held by {holders}",
            "kill {pids}    # or close that program",
            "Only one program can talk to a board. You need sudo to see the programs of other users.",
        ),
        "modem-manager": FindingKind(
            "warning",
            "ModemManager talks to the port",
            "ModemManager runs and sends modem commands to {device} whenever the board is plugged in",
            "sudo {program} doctor {link} --install",
            "It writes a udev rule that sets ID_MM_DEVICE_IGNORE for this kind of USB chip. Plug the board "
            "in again afterwards. sudo does not know the virtual environment and needs the whole path: "
            '`sudo "$(which unitylink)" doctor LINK --install`.',
        ),
        "latency-timer": FindingKind(
            "warning",
            "The latency timer of the USB chip is slow",
            "{device} waits {latency_ms} ms before it passes on a reply; 1 ms is the least",
            "echo 1 | sudo tee /sys/bus/usb-serial/devices/{name}/latency_timer",
            "A read takes at least that long. `--install` writes the udev rule that sets it at every "
            "plug-in. The driver asks for low latency itself, if it has the permission.",
        ),
        "no-ftdi": FindingKind(
            "error",
            "The FTDI chip is not plugged in",
            "no {wanted}; there are: {chips}",
            "unitylink discover",
            "An ftdi: link names a chip by its serial number, and its channel (`ftdi:FT1234?channel=B`). "
            "Without a serial number the chip must be the only one. Chips with a vendor or product number "
            "of their own are reached through the kernel's serial port.",
        ),
        "ftdi-permission": FindingKind(
            "error",
            "The USB device may not be used",
            "{node}, the FTDI chip {serial}, may not be written to by this user",
            "sudo {program} doctor {link} --install",
            "ftdi: links do not use the kernel's serial driver, so the permission for the serial port is not "
            "enough. The udev rule gives the USB device to the user who sits at the machine. Plug the board "
            "in again afterwards.",
        ),
        "ftdi-refused": FindingKind(
            "error",
            "The FTDI chip cannot be opened as asked",
            "{reason}",
            "check mode= and channel= of the link, and what else has the chip open",
            "The synchronous FIFO is on channel A of an FT232H or FT2232H only, and both FIFO modes need "
            "the chip's EEPROM set for them. Unity-Link never writes an EEPROM: on many boards the same chip "
            "is the programmer, and a wrong EEPROM makes it unfindable. libusb-1.0 is needed: "
            "`sudo apt-get install libusb-1.0-0`.",
        ),
        "no-spi": FindingKind(
            "error",
            "The SPI port does not exist",
            "{device} is not there; SPI ports on this machine: {ports}",
            "switch SPI on; on a Raspberry Pi: sudo raspi-config nonint do_spi 0    # then reboot",
            "The kernel shows a chip select as /dev/spidevBUS.SELECT if its device tree says so "
            "(`dtparam=spi=on` in config.txt of a Raspberry Pi). USB adapters such as the FT2232H in MPSSE "
            "mode have no such file.",
        ),
        "unreachable": FindingKind(
            "error",
            "The network device cannot be reached",
            "{place}: {reason}",
            "ping {host}    # if that answers: nothing serves port {port} there",
            "The address or port is wrong, a firewall is in the way, or the board is off. For a virtual "
            "board: `unitylink simulate` does not run, or serves this machine only (--bind). UDP notices "
            "it only when it sends.",
        ),
        "wrong-baud": FindingKind(
            "error",
            "The baud rate is wrong",
            "no valid reply at {baud_hz} baud, and one at {right_baud_hz}",
            "use {link_with_right_baud}",
            "The gateware's baud rate is a generic of its UART, fixed when it was built.",
        ),
        "silence": FindingKind(
            "error",
            "Nothing answers",
            "no byte came from {place} in {waited_s:g} s{baud_rates_tried}",
            "check power, RX and TX (crossed?), ground, and that the FPGA is configured",
            "To test the cable, connect TX to RX at the board's connector. If bytes come back, the doctor "
            "reports an echo.",
        ),
        "echo": FindingKind(
            "error",
            "What is sent comes back",
            "{place} sends back exactly what it receives",
            "connect the board instead of a loop; turn local echo off",
            "RX and TX are connected to each other, or an RS-485 adapter receives what it sends.",
        ),
        "garbage": FindingKind(
            "error",
            "The bytes are not those of Unity-Link",
            "{place} sends {count} bytes that are no message, such as {sample}",
            "check the baud rate and that this is the right port",
            "At a wrong baud rate most bytes look like noise. Another kind of device sends its own text.",
        ),
        "line-errors": FindingKind(
            "error",
            "The board reports parity or framing errors",
            "the board answers {answer}: {errors} on its receive line",
            "set parity and stop bits to 8N1 on both sides, and the same baud rate",
            "The board's baud rate may be off by more than 3 %, or the line too long for it.",
        ),
        "checksum": FindingKind(
            "error",
            "The checksums do not agree",
            "the board refuses our checksum and accepts polynomial {polynomial}",
            "use {link_with_polynomial}",
            "The polynomial of the CRC is a generic of the gateware.",
        ),
        "no-checksum": FindingKind(
            "note",
            "The gateware has no checksums",
            "plain messages are answered, messages with a checksum are not",
            "leave crc=1 out of the link, and use {link_without_checksums}: it never sends a $",
            "Without checksums a flipped bit on the wire is a wrong value. Gateware of 2012 (the first "
            "published one) that was built without checksums may hang after a message that asks for one.",
        ),
        "board-busy": FindingKind(
            "error",
            "The board serves another program",
            "{place} answers ?busy",
            "close the program that is connected to it",
            "A board talks to one program at a time.",
        ),
        "no-configuration": FindingKind(
            "error",
            "The gateware does not report its configuration",
            "RLC is refused with {answer}",
            "add address_bytes= and data_bytes= to the link, such as {link_with_widths}",
            "RLC, the request for the configuration, was left out when the gateware was built. Its widths "
            "are in its source.",
        ),
        "other-gateware": FindingKind(
            "error",
            "The gateware was built from another spec",
            "{reason}",
            "give the spec of this gateware (--spec), or build the gateware from {spec}",
            "In that gateware a name may have another address, type, unit or limit. A write could move the"
            " wrong joint, so every program refuses it. With `spec_hash=any` in the link's URL a program "
            "goes on, and says so.",
        ),
        "unverified-gateware": FindingKind(
            "note",
            "It cannot be verified that spec and gateware belong together",
            "{reason}",
            "compare {spec} with the one this gateware was built from",
            "Only gateware that was generated from a spec and has the framed protocol tells its spec. "
            "Classic gateware, that of 2012 and cores of your own do not.",
        ),
        "widths": FindingKind(
            "error",
            "The device is too narrow for the spec",
            "{count} items of {spec} are beyond the {bits} address bits of the device, such as {example}",
            "give the spec of this gateware (--spec), or build the gateware from this spec",
        ),
        "publishing": FindingKind(
            "error",
            "The device cannot publish what the spec asks for",
            "{spec} publishes {asked}; the device has {has}",
            "unitylink generate {spec_file} --only vhdl    # and build the gateware from it",
        ),
        "wrong-spec": FindingKind(
            "error",
            "The device does not have the spec's words",
            "reading {count} of {total} items gives a bus error, such as {example}",
            "give the spec of this gateware (--spec), or build the gateware from this spec",
            "Nothing is at those addresses of the board's bus. Words of TosNet, the real-time network "
            "between FPGAs, need the network to run: see `unitylink info`.",
        ),
        "slow": FindingKind(
            "warning",
            "Replies take longer than the wire needs",
            "a request takes {measured_ms:.2f} ms, and bytes and USB account for {expected_ms:.2f} ms",
            "look for a hub, a virtual machine, or a busy processor between program and board",
        ),
        "losses": FindingKind(
            "error",
            "Messages get lost or damaged",
            "{bad} of {count} requests failed: {reasons}",
            "lower the baud rate, shorten the cable, and ask for checksums (crc=1)",
            "If the gateware has buffers of 16 bytes, fifo=16 keeps the link from overrunning them.",
        ),
    }
)


# Examples for the braces of the table. With them, a finding is explained without a port.
_EXAMPLE: Mapping[str, object] = MappingProxyType(
    {
        "answer": "'?f2'",
        "asked": "8 items",
        "bad": 3,
        "baud_hz": 115_200,
        "baud_rates_tried": " at any usual baud rate",
        "bits": 10,
        "chips": "FT5678",
        "count": 7,
        "device": "/dev/ttyUSB0",
        "errors": "framing errors",
        "example": "x.target at 0x0410",
        "expected_ms": 0.21,
        "group": "dialout",
        "has": "no publishing",
        "holders": "minicom (process 4711)",
        "host": "192.168.1.10",
        "latency_ms": 16,
        "link": "'serial:/dev/ttyUSB0?baud=3000000'",
        "link_with_polynomial": "serial:/dev/ttyUSB0?baud=3000000&polynomial=0x31",
        "link_without_checksums": "serial:/dev/ttyUSB0?baud=3000000&polynomial=none",
        "link_with_right_baud": "serial:/dev/ttyUSB0?baud=3000000",
        "link_with_widths": "serial:/dev/ttyUSB0?baud=3000000&address_bytes=1&data_bytes=4",
        "measured_ms": 16.2,
        "name": "ttyUSB0",
        "node": "/dev/bus/usb/001/004",
        "pids": "4711",
        "place": "/dev/ttyUSB0",
        "polynomial": "0x31",
        "port": 5555,
        "ports": "/dev/ttyS0",
        "program": '"$(which unitylink)"',
        "reason": "nothing listens there",
        "reasons": "silence (3)",
        "right_baud_hz": 3_000_000,
        "sample": "'login:'",
        "serial": "FT1234",
        "spec": "arm.ul",
        "spec_file": "arm.ul",
        "total": 16,
        "waited_s": 0.3,
        "wanted": "FTDI chip FT1234",
    }
)


def finding(code: str, **known: object) -> Finding:
    """Return the finding `code` with its texts filled in."""
    kind = FINDINGS[code]
    return Finding(code, kind.severity, kind.title, kind.cause.format(**known), kind.remedy.format(**known))


# The same for devices that are not serial ports.
_EXAMPLES: Mapping[str, Mapping[str, object]] = MappingProxyType(
    {
        "no-spi": {"device": "/dev/spidev0.0", "ports": "none"},
        "unreachable": {"place": "tcp://192.168.1.10:5555"},
        "board-busy": {"place": "tcp://192.168.1.10:5555"},
        "ftdi-permission": {"link": "ftdi:FT1234"},
        "ftdi-refused": {"reason": "an FT232R has no FIFO mode"},
    }
)


def example(code: str) -> tuple[Finding, str]:
    """Return an example of the finding `code`, and its further text.

    >>> example("no-port")[0].cause
    '/dev/ttyUSB0 is not there; ports on this machine: /dev/ttyS0'
    """
    known = {**_EXAMPLE, **_EXAMPLES.get(code, {})}
    return finding(code, **known), FINDINGS[code].more.format(**known)


def wrapped(text: str) -> str:
    """Return a paragraph of the page, wrapped into lines."""
    return fill(text, 120, break_long_words=False, break_on_hyphens=False)


def page() -> str:
    """Return docs/troubleshooting.md.

    >>> page().splitlines()[0]
    '# Troubleshooting'
    """
    lines = [
        "# Troubleshooting",
        "",
        "`unitylink doctor LINK` looks for all of these faults. It names the command that mends what it",
        "finds. Ports, numbers and names on this page are examples; the doctor shows those of your machine.",
        "The page and the doctor use the same table, `src/unitylink/ports/findings.py`. `make docs`",
        "makes the page.",
    ]
    for code, kind in FINDINGS.items():
        shown, more = example(code)
        lines += [
            "",
            f"## {kind.title}",
            "",
            wrapped(f"`{code}`, {kind.severity}: {shown.cause}."),
            "",
            "```sh",
            shown.remedy,
            "```",
        ]
        if more:
            lines += ["", wrapped(more)]
    return "\n".join(lines) + "\n"
