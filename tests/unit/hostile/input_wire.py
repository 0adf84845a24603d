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
from unitylink.dashboard.requests import read
from unitylink.recording import Origin, Sample, create
from unitylink.server.questions import _answer as answer
from unitylink.server.scopes import Rights
from unitylink.server.tokens import User
from unitylink.simulate.plants.recording import RecordingPlant
from unitylink.streams.foxglove import wire as foxglove

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


# ---- what browsers and tools send to a server


def page_requests(_: Path) -> list[bytes]:
    return [
        b'{"do": "take", "id": 3, "part": "j[0]", "seconds": 2.5}',
        b'{"do": "view", "id": 4, "series": [[0, 0.01, -3.5], [2, 1, 0]]}',
        b'{"do": "write", "id": 5, "values": {"j[0].pos": 1.5, "flags": {"ready": true}, "uptime": "7"}}',
        b'{"do": "range", "series": [[1, 0.25, 10]], "end_s": 1e3}',
    ]


def read_page_request(data: bytes, _: Path) -> None:
    with allowed():
        request = read(data.decode("utf-8", "replace"))
        for take in (
            lambda: request.series(3),
            lambda: request.text("part"),
            lambda: request.seconds("seconds", 0.05, 3600.0),
        ):
            with allowed():
                take()


def foxglove_messages(_: Path) -> list[bytes]:
    call = b"\2" + (1).to_bytes(4, "little") + (9).to_bytes(4, "little") + (4).to_bytes(4, "little")
    return [
        call + b'json{"value": 3}',
        b'{"op": "subscribe", "subscriptions": [{"id": 1, "channelId": 2}]}',
        b'{"op": "setParameters", "id": "a", "parameters": [{"name": "j[0].pos", "value": [1, 2]}]}',
        b'{"op": "unsubscribe", "subscriptionIds": [1, 2]}',
    ]


def read_foxglove_message(data: bytes, _: Path) -> None:
    with allowed():
        foxglove.read_call(data)
    with allowed():
        told = foxglove.read_text(data.decode("utf-8", "replace"))
        for name, kind in (("subscriptions", dict), ("parameters", dict), ("subscriptionIds", int)):
            with allowed():
                for one in foxglove.entries(told, name, kind):
                    foxglove.number(one if isinstance(one, dict) else {"id": one}, "id")


def questions(_: Path) -> list[bytes]:
    return [b"status", b"ask j1", b"give j1 ben", b"break *"]


def read_question(data: bytes, _: Path) -> None:
    # what the native side hands on: printable ASCII, and at most a line
    line = "".join(chr(byte) for byte in data if 32 <= byte < 127)
    with allowed():
        answer(line.split(" "), User("ana", Rights.of(["read"])), "here", [], dict)


def read_typed_lines(data: bytes, _: Path) -> None:
    for line in data.decode("utf-8", "surrogateescape").splitlines():
        with allowed(ValueError):  # `term` shows these
            prepare(line, elements(), 1 + len(line) % 4)
