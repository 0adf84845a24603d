# SPDX-License-Identifier: BSD-3-Clause
"""`ftdi:` links over a fake of the USB library, transfer by transfer, with the twin behind the chip."""

from __future__ import annotations

import os
import shutil
import threading
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from unitylink import DeviceMismatch, LinkBusy, LinkClosed, LinkError, LinkNotFound, UrlError, connect
from unitylink.errors import LinkDown, OutcomeUnknown
from unitylink.layer0_driver import Driver
from unitylink.layer4_data import ReadValue, WriteValue, load_spec_objects
from unitylink.simulate import Board
from unitylink.simulate.plant import load_plant
from unitylink.spec import load

ROOT = Path(__file__).resolve().parents[3]
SCARA = ROOT / "examples" / "scara" / "scara.ul"
Plug = Callable[..., Path]


@pytest.fixture
def board() -> Iterator[Board]:
    with Board(endpoint="tcp") as board:
        yield board


@pytest.fixture
def plug(fake_library: Path, board: Board, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Plug:
    """Return a function that plugs in a chip with the board behind it: `plug(serial="FT1", unplug=1000)`
    returns its log.
    """
    # A library of its own for each test, because it keeps the chip's state.
    library = tmp_path / "fake_libusb.so"
    shutil.copy(fake_library, library)
    monkeypatch.setenv("UNITYLINK_LIBUSB", str(library))
    monkeypatch.setenv("UNITYLINK_ROOT", str(tmp_path))
    log = tmp_path / "log"

    def plug(**settings: object) -> Path:
        words = {"serial": "FT1", "port": board.url.rpartition(":")[2], "log": log, **settings}
        monkeypatch.setenv("FAKE_USB", " ".join(f"{k}={v}" for k, v in words.items() if v != ""))
        return log

    return plug


def test_the_chip_is_set_up_for_a_serial_line(plug: Plug) -> None:
    log = plug()
    with connect("ftdi:FT1?channel=B&baud=3000000&latency=2&event=0x0A") as link:
        assert link.read(0x18) == 0
    said = log.read_text().splitlines()
    assert said[0] == "claim 1"
    assert said[1:10] == [
        "40 00 0000 0002",  # reset, on channel B
        "40 0B 0000 0002",  # no bit mode
        "40 09 0002 0002",  # latency timer 2 ms
        "40 06 010A 0002",  # event character, enabled
        "40 03 0004 0202",  # 3 MBd of 12 MHz
        "40 04 0008 0002",  # 8N1
        "40 02 0000 0002",  # no flow control
        "40 00 0001 0002",  # purge both
        "40 00 0002 0002",
    ]
    assert said[-2] == "release 1"


def test_the_synchronous_fifo(plug: Plug) -> None:
    log = plug(release="0x0900")
    with connect("ftdi:?mode=sync-fifo&event=0x00") as link:
        link.write(0x10, 7)
    said = log.read_text().splitlines()
    assert "40 0B 40FF 0000" in said and "40 02 0000 0100" in said and "40 06 0100 0000" in said
    assert "40 03" not in "".join(said)
    assert said[-3:-1] == ["40 0B 0000 0000", "release 0"]  # as it was before


@pytest.mark.parametrize(("protocol", "event"), [("classic", "010A"), ("framed", "0100"), ("auto", "0100")])
def test_the_event_character_sends_bytes_that_would_wait_for_the_latency_timer(
    plug: Plug, protocol: str, event: str
) -> None:
    log = plug()
    with connect(f"ftdi:FT1?mode=fifo&latency=255&protocol={protocol}") as link:
        for number in range(20):
            link.write(0x12, number)
            assert link.read(0x12) == number
    said = log.read_text().splitlines()
    assert [line for line in said if line.startswith("40 06")][-1] == f"40 06 {event} 0001"
    words = said[-1].split()  # full F event E timer T
    assert int(words[3]) >= 40
    assert int(words[5]) == 0


def test_an_event_character_that_is_told_stays(plug: Plug) -> None:
    log = plug()
    with connect("ftdi:FT1?mode=fifo&event=0x41") as link:
        assert link.read(0x12) == 0
    assert [line[6:10] for line in log.read_text().splitlines() if line.startswith("40 06")] == ["0141"]


@pytest.mark.parametrize("packet", [64, 512])
def test_many_words_both_ways(plug: Plug, packet: int) -> None:
    plug(packet=packet, take=100)
    with connect(
        "ftdi:FT1?mode=fifo&fifo=1024&timeout=10"
    ) as link:  # a late reply to a request counts as garbage
        addresses = [0x12, 0x1A, 0x13, 0x1B] * 50
        link.write_many(addresses, list(range(200)))
        assert link.read_each([0x12, 0x1A, 0x13, 0x1B]).tolist() == [196, 197, 198, 199]
        with link.subscribe([0x12, 0x1A], divisor=1) as subscription:
            for _ in range(5):
                assert subscription.wait(30)
                assert set(map(tuple, subscription.drain()[1].tolist())) == {(196, 197)}
        assert link.statistics().garbage_bytes == 0


def test_large_transfers_keep_every_byte(plug: Plug) -> None:
    """More bytes than a packet, a transfer and the socket can hold, fetched late."""
    log = plug()
    with Driver("ftdi:FT1?mode=fifo&event=none&latency=255") as driver:
        driver.send(b"#RLC\n")
        reply = b""
        while not reply.endswith(b"\n"):
            reply += driver.receive(timeout_s=30)
        got = b""
        for _ in range(10):
            driver.send(b"#RLC\n" * 100)
        while len(got) < 1000 * len(reply):
            more = driver.receive(timeout_s=30)
            assert more
            got += more
    assert got == reply * 1000
    assert int(log.read_text().splitlines()[-1].split()[1]) > 20  # full packets


def test_unplugged_in_the_middle_of_a_transfer(plug: Plug) -> None:
    plug(unplug=700)
    link = connect("ftdi:FT1?mode=fifo")
    with pytest.raises(LinkClosed, match="the FTDI chip was unplugged"):
        for _ in range(1000):
            link.read_many(list(range(0x10, 0x14)), atomic=True)
    assert link.closed
    link.close()


def test_a_chip_that_is_plugged_in_again(plug: Plug, board: Board) -> None:
    """It is unplugged again and again, each time in the middle of a transfer.

    Every write is reported correctly.
    """
    plug(unplug=4000)
    with connect("ftdi:FT1?mode=fifo&timeout=5", reconnect=True) as link:
        number = told = 0
        while link.statistics().reconnections < 3:
            number += 1
            try:
                link.write(0x12, number)
            except (LinkDown, OutcomeUnknown):
                assert link.wait_up(30)
                continue
            told = number
            assert board.registers[0x12] == told
        assert number > 10 * (told > 0)


def test_a_link_that_is_closed_lets_go(plug: Plug) -> None:
    log = plug()
    for _ in range(3):
        with Driver("ftdi:FT1") as driver:
            assert driver.fileno() >= 0
        assert driver.fileno() == -1
    assert log.read_text().count("claim 0") == log.read_text().count("release 0") == 3


def test_a_forked_child_leaves_the_chip_to_its_parent(plug: Plug) -> None:
    log = plug()
    with connect("ftdi:FT1") as link:
        child = os.fork()
        if not child:
            os._exit(0 if link.closed else 1)
        assert os.waitpid(child, 0)[1] == 0
        assert link.read(0x18) == 0
        assert "release" not in log.read_text()


@pytest.mark.parametrize(
    ("url", "settings", "error", "message"),
    [
        (
            "ftdi:FT2",
            {},
            LinkNotFound,
            "no FTDI chip with the serial number FT2 .*; there are: FT1",
        ),
        ("ftdi:", {"serial": ""}, LinkNotFound, "no FTDI chip is plugged in"),
        ("ftdi:?channel=C", {}, UrlError, r"a FT2232H has 2 channel\(s\), and channel=C is asked"),
        ("ftdi:?channel=E", {}, UrlError, "channel=E is not one of A, B, C, D"),
        ("ftdi:?mode=sync", {}, UrlError, "mode=sync is not one of serial, fifo, sync-fifo"),
        ("ftdi:?mode=fifo&baud=9600", {}, UrlError, "a FIFO has no baud rate"),
        ("ftdi:?baud=fast", {}, UrlError, "baud=fast is not a baud rate"),
        ("ftdi:?baud=11000000", {}, UrlError, "the nearest that an FT2232H can is 12000000"),
        ("ftdi:?latency=0", {}, UrlError, "latency=0 is not 1 to 255 ms"),
        ("ftdi:?event=256", {}, UrlError, "event=256 is not a character"),
        ("ftdi:?evnt=1", {}, UrlError, "no option 'evnt'"),
        ("serial:/dev/null?event=1", {}, UrlError, "no option 'event'"),
        ("ftdi:?mode=sync-fifo&channel=B", {}, DeviceMismatch, "on channel A of an FT232H or FT2232H"),
        ("ftdi:?mode=sync-fifo", {"release": "0x0600"}, DeviceMismatch, "this is channel A of an FT232R"),
        ("ftdi:", {"release": "0x1234"}, DeviceMismatch, "this FTDI chip is not known"),
        ("ftdi:", {"claim": -6}, LinkBusy, "another program holds it"),
        ("ftdi:", {"refuse": -3}, LinkError, "LIBUSB_ERROR_ACCESS; you need the right to use the USB device"),
    ],
)
def test_what_cannot_be(
    plug: Plug, url: str, settings: dict[str, object], error: type[Exception], message: str
) -> None:
    plug(**settings)
    with pytest.raises(error, match=message):
        connect(url)


def test_without_the_library(plug: Plug, monkeypatch: pytest.MonkeyPatch) -> None:
    plug()
    monkeypatch.setenv("UNITYLINK_LIBUSB", "libusb-none.so.0")
    with pytest.raises(LinkNotFound, match=r"libusb-none.so.0 is missing; .*apt-get install libusb-1.0-0"):
        connect("ftdi:FT1")
    monkeypatch.setenv("UNITYLINK_LIBUSB", "libc.so.6")
    with pytest.raises(LinkNotFound, match=r"it is not libusb-1.0"):
        connect("ftdi:FT1")


def kernel_has(root: Path, port: Path, *, serial: str = "FT1", channel: int = 0, number: int = 0) -> None:
    """Make the files that the kernel shows for a chip whose channel is a serial port."""
    chip = root / "sys" / "bus" / "usb" / "devices" / f"1-{number + 1}"
    chip.mkdir(parents=True)
    (chip / "idVendor").write_text("0403\n")
    (chip / "serial").write_text(f"{serial}\n")
    (chip.with_name(f"{chip.name}:1.{channel}") / f"ttyUSB{number}").mkdir(parents=True)
    (root / "dev").mkdir(exist_ok=True)
    (root / "dev" / f"ttyUSB{number}").symlink_to(port)


def test_the_kernels_port_is_taken_with_a_notice(plug: Plug, tmp_path: Path) -> None:
    plug(refuse=-3)
    with Board(endpoint=f"pty:{tmp_path / 'tty'}"):
        kernel_has(tmp_path, tmp_path / "tty", channel=1)
        notice = rf"LIBUSB_ERROR_ACCESS; .*the kernel's serial port {tmp_path}/dev/ttyUSB0 is used instead"
        with pytest.warns(RuntimeWarning, match=notice):
            link = connect("ftdi:FT1?channel=B&baud=3000000")
        with link:
            assert link.read(0x18) == 0
        for url in ("ftdi:FT1?channel=A", "ftdi:FT2?channel=B"):  # these URLs name another channel or chip
            with pytest.raises(LinkError, match="LIBUSB_ERROR_ACCESS"):
                connect(url)
        with pytest.raises(LinkError, match="LIBUSB_ERROR_ACCESS"):  # the kernel's driver has no such mode
            connect("ftdi:FT1?mode=sync-fifo")


def test_the_kernels_ports_of_several_chips(plug: Plug, tmp_path: Path) -> None:
    plug(refuse=-3)
    with Board(endpoint=f"pty:{tmp_path / 'tty'}"):
        kernel_has(tmp_path, tmp_path / "tty")
        kernel_has(tmp_path, tmp_path / "none", serial="FT2", number=1)
        with pytest.raises(LinkError, match="LIBUSB_ERROR_ACCESS"):
            connect("ftdi:")
        with pytest.warns(RuntimeWarning, match="ttyUSB0 is used instead"):
            connect("ftdi:FT1").close()


def test_the_scara_moves(plug: Plug) -> None:
    """The unchanged demo, on the twin behind the chip."""
    with Board(load(SCARA), plant=load_plant("scara", load(SCARA)), endpoint="tcp") as robot:
        plug(port=robot.url.rpartition(":")[2])
        with connect("ftdi:FT1?mode=fifo&fifo=256") as link:
            arm = load_spec_objects(load(SCARA), link)
            speed, target, position = arm["j1.spd_sp"], arm["j1.pos_sp"], arm["j1.cpos"]
            assert isinstance(speed, WriteValue) and isinstance(target, WriteValue)
            assert isinstance(position, ReadValue)
            there = threading.Event()
            position.on_change(lambda counts: counts == 300 and there.set())
            speed.write(2000)
            target.write(300)
            assert there.wait(30)
            arm.stop_publishing()
            assert link.statistics().checksum_errors == link.statistics().garbage_bytes == 0
