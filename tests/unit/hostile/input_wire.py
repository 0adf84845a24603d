# SPDX-License-Identifier: BSD-3-Clause
"""Recordings, captures and bytes of a wire: good ones, and the code that reads them."""

import io
from collections.abc import Callable
from contextlib import redirect_stderr, redirect_stdout
from functools import cache
from pathlib import Path

from input_base import TYPED, Registers, allowed, elements, typed

from unitylink import connect
from unitylink.capture import messages, read_packets
from unitylink.commands.names import Names
from unitylink.commands.plot import _draw, _recorded
from unitylink.commands.term import prepare
from unitylink.commands.wire_reader import wire_reader
from unitylink.recording import Origin, Sample, create
from unitylink.simulate.plants.recording import RecordingPlant

DRAWN = 40  # one of so many recordings is also drawn, which costs a hundred times as much as reading it


# ---- recordings


def _sample(number: int) -> Sample:
    values = {
        "j[0].pos": number / 8,
        "j[1].mode": "run" if number % 2 else "idle",
        "lost": number,
        "flags": {"ready": True, "level": 3.5},
        "uptime": number << 40,
    }
    return Sample(1.7e9 + number / 100, values)


def recordings(ending: str) -> Callable[[Path], list[bytes]]:
    def good(folder: Path) -> list[bytes]:
        made = []
        for count in (1, 5, 60):
            path = folder / f"good-{count}{ending}"
            text = TYPED.read_text()
            units = {"j[0].pos": "rad", "lost": "$m^2$"}
            with create(path, Origin("typed.ul", text, "0" * 16, units), force=True) as writer:
                for number in range(count):
                    writer.add(_sample(number))
                    if number % 20 == 19:
                        writer.flush()
            made.append(path.read_bytes())
        return made

    return good


def read_recording(ending: str) -> Callable[[bytes, Path], None]:
    def read(data: bytes, folder: Path) -> None:
        path = folder / f"r{ending}"
        path.write_bytes(data)
        for attempt in (_plotted, _replayed):
            with allowed():
                attempt(path, data)

    return read


def _plotted(path: Path, data: bytes) -> None:
    with redirect_stderr(io.StringIO()), redirect_stdout(io.StringIO()):
        series = _recorded(str(path), (), None)
        if sum(data) % DRAWN == 0:
            _draw(series, path.name, str(path.with_suffix(".svg")), force=True)


def _replayed(path: Path, _: bytes) -> None:
    plant = RecordingPlant(path, loop=True)
    plant.attach(typed(), Registers())  # type: ignore[arg-type]
    for tick in range(5):
        plant.step(tick * 0.2)


# ---- captures, lines, frames


@cache
def captured(protocol: str, folder: Path) -> bytes:
    path = folder / f"{protocol}.pcapng"
    path.unlink(missing_ok=True)
    with connect(f"sim:{TYPED}?protocol={protocol}&trace={path}") as link:
        link.read(0x10)
        link.write_many([0x11, 0x12], [5, 1])
        link.read_many([0x10, 0x18, 0x20])
        with link.subscribe([0x10, 0x18], divisor=1) as publishes:
            publishes.wait(2.0)
        if protocol == "framed":
            link.exchange([0x10], [(0x11, 4)], atomic=True)
            link.health()
            with link.exchange_group([0x11], [0x10]) as group:
                group.exchange([3])
    return path.read_bytes()


def captures(folder: Path) -> list[bytes]:
    return [captured("classic", folder), captured("framed", folder)]


def transfers(protocol: str) -> Callable[[Path], list[bytes]]:
    """Return the bytes of a capture. A byte for its direction stands before each transfer."""

    def good(folder: Path) -> list[bytes]:
        captured(protocol, folder)
        pieces = [
            (b">" if packet.direction == "sent" else b"<") + packet.data.replace(b"\xff", b"\xfe") + b"\xff"
            for packet in read_packets(folder / f"{protocol}.pcapng")
        ]
        return [b"".join(pieces), *(b"".join(pieces[at : at + 8]) for at in range(0, len(pieces), 8))]

    return good


def read_capture(data: bytes, folder: Path) -> None:
    path = folder / "c.pcapng"
    path.write_bytes(data)
    with allowed():
        for _ in messages(read_packets(path), wire_reader(elements())):
            pass


def read_transfers(data: bytes, _: Path) -> None:
    reader = wire_reader(elements() if len(data) % 2 else Names(None))
    for number, piece in enumerate(data.split(b"\xff")):
        with allowed():
            reader.read(number / 1000, "sent" if piece[:1] == b">" else "received", piece[1:])


def read_typed_lines(data: bytes, _: Path) -> None:
    for line in data.decode("utf-8", "surrogateescape").splitlines():
        with allowed(ValueError):  # `term` shows these
            prepare(line, elements(), 1 + len(line) % 4)
