# SPDX-License-Identifier: BSD-3-Clause
"""A machine made of files, and boards with faults."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import pytest

from unitylink.layer1_stream import ClassicEncoder
from unitylink.ports import Machine

CONFIGURATION = "01,04,20,02,03e8,02,10,02"
USER = 1000


class FakeMachine:
    """Makes the files that the kernel shows for a port, below a temporary folder."""

    def __init__(self, root: Path) -> None:
        self.root = root
        for folder in ("dev", "proc", "sys/class/tty", "run/udev/data"):
            (root / folder).mkdir(parents=True)

    def write(self, name: str, text: str) -> Path:
        path = self.root / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text + "\n")
        return path

    def usb_port(
        self, name: str = "ttyUSB0", *, latency_ms: int = 1, mode: int = 0o666, channel: int = 0
    ) -> str:
        """Return the channel of an FT2232H as /sys shows it."""
        usb = "sys/devices/pci0/usb1/1-1"
        for file, text in (
            ("idVendor", "0403"),
            ("idProduct", "6010"),
            ("manufacturer", "FTDI"),
            ("product", "Dual RS232-HS"),
            ("serial", "FT1234"),
            ("bNumInterfaces", " 2"),
        ):
            self.write(f"{usb}/{file}", text)
        interface = f"{usb}/1-1:1.{channel}"
        self.write(f"{usb}/busnum", "1")
        self.write(f"{usb}/devnum", "7")
        self.write("dev/bus/usb/001/007", "").chmod(mode)
        devices = self.root / "sys/bus/usb/devices"
        devices.mkdir(parents=True, exist_ok=True)
        for name_of in ("1-1", f"1-1:1.{channel}"):
            target = self.root / (usb if name_of == "1-1" else interface)
            (devices / name_of).symlink_to(target)
        self.write(f"{interface}/bInterfaceNumber", f"0{channel}")
        self.write(f"{interface}/{name}/latency_timer", str(latency_ms))
        (self.root / "sys/bus/drivers/ftdi_sio").mkdir(parents=True, exist_ok=True)
        (self.root / interface / name / "driver").symlink_to(self.root / "sys/bus/drivers/ftdi_sio")
        self.write(f"sys/class/tty/{name}/dev", f"188:{channel}")
        (self.root / f"sys/class/tty/{name}/device").symlink_to(self.root / interface / name)
        self.write(f"dev/{name}", "").chmod(mode)
        return f"/dev/{name}"

    def process(self, pid: int, command: str, *, holds: str | None = None) -> None:
        self.write(f"proc/{pid}/comm", command)
        (self.root / f"proc/{pid}/fd").mkdir()
        if holds is not None:
            (self.root / f"proc/{pid}/fd/7").symlink_to(holds)

    def machine(self, *, uid: int = USER, gids: tuple[int, ...] = (USER,)) -> Machine:
        return Machine(self.root, uid=uid, gids=gids)


@pytest.fixture
def fake(tmp_path: Path) -> FakeMachine:
    return FakeMachine(tmp_path / "root")


class Clock:
    """A clock that runs only while somebody waits."""

    def __init__(self) -> None:
        self.now_s = 0.0

    def __call__(self) -> float:
        return self.now_s


class Board:
    """A board that answers a request line with `reply(line)`, `delay_s` later on a clock of its own."""

    def __init__(self, reply: Callable[[bytes], bytes], clock: Clock, *, delay_s: float = 0.0005) -> None:
        self.reply = reply
        self.clock = clock
        self.delay_s = delay_s
        self.waiting = b""
        self.asked: list[bytes] = []

    def send(self, data: bytes, *, timeout_s: float = 1.0) -> None:
        self.asked.append(data)
        self.waiting += self.reply(data)

    def receive(self, *, timeout_s: float = 1.0) -> bytes:
        if timeout_s == 0.0:
            return b""
        if not self.waiting:
            self.clock.now_s += timeout_s
            return b""
        self.clock.now_s += self.delay_s
        data, self.waiting = self.waiting, b""
        return data

    def close(self) -> None:
        pass


def healthy(line: bytes, *, polynomial: int | None = 0x07) -> bytes:
    """Return the reply of a healthy board to any form of RLC."""
    if re.fullmatch(rb"!#RLC\n", line):
        return b"#CNF:" + CONFIGURATION.encode() + b"\n"
    right = ClassicEncoder(checked=True, polynomial=polynomial).encode("RLC")
    if line != b"!" + right:
        return b"?f4\n"
    return b"$CNF:" + CONFIGURATION.encode() + b"*%02x\n" % _configuration_sum(polynomial)


def _configuration_sum(polynomial: int | None) -> int:
    fields = CONFIGURATION.split(",")
    data = b"".join(bytes.fromhex(field) for field in fields)
    encoded = ClassicEncoder(checked=True, polynomial=polynomial).encode("CNF", data)
    return int(encoded.rpartition(b"*")[2], 16)


@pytest.fixture
def clock() -> Clock:
    return Clock()
