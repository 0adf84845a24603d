# SPDX-License-Identifier: BSD-3-Clause
"""Draw the pictures of the documents:  python tools/docs/pictures.py [--check]

Each is drawn from real data. The bytes of a message are those that a link sends and a virtual board answers.
The times of publishes are those in docs/images/publish.pcapng, which `--capture` records again. The same
inputs give the same bytes, and --check compares.
"""

from __future__ import annotations

import sys
import tempfile
import time
from pathlib import Path

import ring_picture
from made_files import parser_of, write_or_compare
from picture import BOLD, CHECK, DEVICE, FAINT, GRID, INK, MONO, PC, PUBLISH, SMALL, Picture

from unitylink import connect
from unitylink.capture import CaptureMessage, MessageReader, messages, read_packets
from unitylink.simulate import Board, BoardConfiguration

IMAGES = Path(__file__).resolve().parents[2] / "docs" / "images"
CAPTURE = IMAGES / "publish.pcapng"
BAUD_HZ = 115_200  # so slow that a message can be seen as a bar

# level, its name on the PC, its name in the FPGA, what passes between them
LAYERS = [
    ("", "your program, tools", "your logic, TosNet", "one UL-spec describes both"),
    ("4 data", "values, groups, callbacks", "cores: PWM, encoder, GPIO", "values in engineering units"),
    ("3 hardware", "proxies of modules", "bus: slaves and interconnect", "words at addresses of a module"),
    (
        "2 message",
        "link: credit, retry, subscriptions",
        "application: requests, publishes",
        "R, W, RM, WSA, PUB",
    ),
    ("1 stream", "codec, checksum", "datalink: deframer, framer", "messages: $R:12*58"),
    ("0 driver", "serial, TCP, UDP, in process", "UART", "bytes"),
]


def architecture() -> str:
    """Draw the layers of both sides."""
    picture = Picture(860, 420, "The layers of Unity-Link on the PC and on the FPGA")
    picture.text(240, 28, "PC", anchor="middle", style=BOLD, colour=PC)
    picture.text(700, 28, "FPGA, or its twin", anchor="middle", style=BOLD, colour=DEVICE)
    for row, (layer, host, device, between) in enumerate(LAYERS):
        y = 44 + row * 56
        picture.text(12, y + 25, layer, colour=FAINT, style=BOLD)
        picture.box(110, y, 260, 40, PC, fill=0.12 if layer else 0.02)
        picture.text(240, y + 25, host, anchor="middle")
        picture.box(570, y, 260, 40, DEVICE, fill=0.12 if layer else 0.02)
        picture.text(700, y + 25, device, anchor="middle")
        picture.text(470, y + 18, between, anchor="middle", colour=FAINT, style=SMALL)
        picture.line(378, y + 26, 562, y + 26, dash="" if layer == "0 driver" else "3 4")
        if row:
            for x in (240, 700):
                picture.line(x, y - 16, x, y, INK)
    picture.line(240, 364, 240, 392, INK)
    picture.line(240, 392, 700, 392, INK)
    picture.line(700, 364, 700, 392, INK)
    picture.text(470, 410, "the byte link: a wire, a network, or memory", anchor="middle", style=SMALL)
    return picture.svg()


def exchange() -> list[CaptureMessage]:
    """Read the word at 0x12 with a checksum from a virtual board. Return the request and the reply."""
    with tempfile.TemporaryDirectory() as folder:
        trace = Path(folder) / "read.pcapng"
        with Board(None, configuration=BoardConfiguration(address_bits=8, data_bits=32)) as board:
            board.registers[0x12] = 0x40DE1212
            with connect(f"{board.url}?protocol=classic&crc=1&timeout=20&trace={trace}") as link:
                link.read(0x12)
        return [m for m in messages(read_packets(trace)) if m.text.startswith(("$R:", "$S_R:"))]


def _parts(text: str) -> list[tuple[str, str, str]]:
    """Return (bytes, their meaning, colour) for each part of a message with a checksum."""
    letters, _, rest = text[1:].partition(":")
    data, _, check = rest.partition("*")
    reply = letters.startswith("S_")
    return [
        (text[0], "checked", FAINT),
        (letters, "reply" if reply else "read", DEVICE if reply else PC),
        (":", "", FAINT),
        (data, "word" if reply else "address", INK),
        ("*", "", FAINT),
        (check, "CRC-8", CHECK),
        ("\n", "end", FAINT),
    ]


def message() -> str:
    """Draw a read and its reply, byte for byte."""
    picture = Picture(860, 250, "A read of address 0x12 and its reply, byte for byte")
    for row, sent in enumerate(exchange()):
        y, x, size = 62 + row * 110, 20.0, 44.0
        who = "PC to device" if sent.direction == "sent" else "device to PC"
        picture.text(20, y - 28, f"{who}: {sent.text}", style=BOLD, colour=PC if row == 0 else DEVICE)
        for text, meaning, colour in _parts(sent.text):
            for offset, byte in enumerate(text):
                left = x + offset * size
                picture.box(left, y, size - 3, 34, colour)
                shown = "LF" if byte == "\n" else byte
                picture.text(left + size / 2 - 1.5, y + 22, shown, anchor="middle", style=MONO)
                code = f"{ord(byte):02x}"
                picture.text(left + size / 2 - 1.5, y - 6, code, anchor="middle", colour=FAINT, style=SMALL)
            middle = x + len(text) * size / 2 - 1.5
            picture.text(middle, y + 50, meaning, anchor="middle", colour=colour, style=SMALL)
            x += len(text) * size
    picture.text(20, 240, "above each byte its code; one UART frame each", colour=FAINT, style=SMALL)
    return picture.svg()


def capture() -> None:
    """Record publishes of two groups with reads between them, on a line of 115,200 baud."""
    CAPTURE.unlink(missing_ok=True)
    with (
        Board(None, configuration=BoardConfiguration(address_bits=8, data_bits=32, baud_hz=BAUD_HZ)) as board,
        connect(f"{board.url}?trace={CAPTURE}") as link,
        link.subscribe([0, 1, 2, 3], divisor=10),
        link.subscribe([4], divisor=25),
    ):
        end = time.monotonic() + 0.1
        while time.monotonic() < end:
            link.read(0x12)
            time.sleep(0.004)


def publish() -> str:
    """Draw 60 ms of the capture: the messages on either line, and their times."""
    found = list(messages(read_packets(CAPTURE), MessageReader(address_bytes=1, data_bytes=4)))
    window_s = 0.06
    firsts = [m for m in found if m.kind == "publish" and m.text.startswith(("%PUB:01", "&PUB:01"))]
    start_s = firsts[1].time_s - 0.012
    picture = Picture(860, 230, "Publishes and requests on a line of 115,200 baud")
    left, scale = 110.0, 720.0 / window_s

    def x(time_s: float) -> float:
        return left + (time_s - start_s) * scale

    picture.text(12, 78, "PC sends", style=BOLD, colour=PC)
    picture.text(12, 138, "device", style=BOLD, colour=DEVICE)
    picture.text(12, 154, "sends", style=BOLD, colour=DEVICE)
    for tick in range(0, 61, 10):
        at = left + tick / 1000 * scale
        picture.line(at, 44, at, 176, GRID, dash="2 3")
        picture.text(at, 194, f"{tick} ms", anchor="middle", colour=FAINT, style=SMALL)
    line_free_s = start_s
    for one in found:
        took_s = len(one.data) * 10 / BAUD_HZ
        began_s = one.time_s if one.direction == "sent" else one.time_s - took_s
        if not start_s <= began_s or began_s + took_s > start_s + window_s:
            continue
        # its bytes come one after another, and the program saw them a little later
        if one.direction != "sent":
            began_s = max(began_s, line_free_s)
            line_free_s = began_s + took_s
        sent, published = one.direction == "sent", one.kind == "publish"
        colour = PC if sent else PUBLISH if published else DEVICE
        y = 58 if sent else 120
        picture.box(x(began_s), y, max(2.0, took_s * scale), 34, colour, fill=0.35)
        if published:
            middle = x(began_s + took_s / 2)
            picture.text(middle, y + 22, str(int(one.text[5:7], 16)), anchor="middle", style=BOLD)
    legend = [
        (PC, "request #R:12"),
        (DEVICE, "its reply"),
        (PUBLISH, "publish of group 0 (100 Hz), 1 (40 Hz)"),
    ]
    for index, (colour, text) in enumerate(legend):
        picture.box(110 + index * 160, 14, 14, 14, colour, fill=0.35)
        picture.text(130 + index * 160, 26, text, style=SMALL)
    note = "recorded with ?trace=; requests and publishes take turns, message by message"
    picture.text(left, 218, note, colour=FAINT, style=SMALL)
    return picture.svg()


PICTURES = {
    "architecture.svg": architecture,
    "message.svg": message,
    "publish.svg": publish,
    "tosnet_ring.svg": ring_picture.ring,
    "tosnet_cycle.svg": ring_picture.cycle,
}


def main() -> int:
    """Write the pictures, or compare them with the files."""
    parser = parser_of("Draw the pictures of the documents.")
    parser.add_argument("--capture", action="store_true", help="record docs/images/publish.pcapng anew first")
    given = parser.parse_args()
    if given.capture:
        capture()
    return write_or_compare({IMAGES / name: draw() for name, draw in PICTURES.items()}, check=given.check)


if __name__ == "__main__":
    sys.exit(main())
