# SPDX-License-Identifier: BSD-3-Clause
"""`spi:` links over a fake of the kernel's spidev, ioctl by ioctl, with the twin behind a slave."""

from __future__ import annotations

import re
import socket
import threading
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from unitylink import LinkNotFound, UrlError, connect
from unitylink.simulate import Board

SpiClient = Callable[..., str]

MOVE = """
    from unitylink import connect
    with connect("spi:/dev/spidev0.0?speed_hz=20000000&fifo=256&{options}") as link:
        for number in range(20):
            link.write(0x12, number)
            assert link.read(0x12) == number
        link.write_many([0x12, 0x1A] * 100, list(range(200)))
        print(link.read_each([0x12, 0x1A] * 30).tolist() == [198, 199] * 30)
        with link.subscribe([0x12, 0x1A], divisor=1) as subscription:
            for _ in range(5):
                assert subscription.wait(30)
                assert set(map(tuple, subscription.drain()[1].tolist())) == {(198, 199)}
        seen = link.statistics()
        print(link.protocol, seen.garbage_bytes, seen.malformed_messages, seen.checksum_errors)
"""


@pytest.fixture
def board() -> Iterator[Board]:
    with Board(endpoint="tcp") as board:
        yield board


def port_of(board: Board) -> str:
    return board.url.rpartition(":")[2]


@pytest.mark.parametrize(("asked", "spoken"), [("auto", "framed"), ("classic", "classic")])
def test_words_both_ways_and_publishes(
    spi_client: SpiClient, board: Board, tmp_path: Path, asked: str, spoken: str
) -> None:
    said = spi_client(MOVE.replace("{options}", f"protocol={asked}"), port=port_of(board))
    assert said.splitlines() == ["True", f"{spoken} 0 0 0"]
    log = (tmp_path / "spi.log").read_text().splitlines()
    assert log[:3] == ["mode 0", "bits 8", "speed_hz 20000000"]
    assert log[-1].startswith("transfers ")


def test_a_wire_signals_that_the_board_has_bytes(spi_client: SpiClient, board: Board) -> None:
    """Without the wire, the second publish would come with the next poll: ten minutes later."""
    code = MOVE.replace("{options}", "poll=600&waiting=/dev/gpiochip0:25")
    said = spi_client(code, port=port_of(board), gpiochip="/dev/gpiochip0")
    assert said.splitlines() == ["True", "framed 0 0 0"]


def test_a_port_or_a_wire_that_fails_while_it_is_set_up(spi_client: SpiClient, board: Board) -> None:
    """The steps that fail in turn: open, mode, lock, mode, bits and speed of the port, then chip, line and
    flags of the wire.
    """
    code = """
        import os
        from unitylink import LinkError, connect
        descriptors = lambda: len(os.listdir("/proc/self/fd"))
        before, told = descriptors(), []
        for nth in range(1, 11):
            os.environ["FAKE_SPI_FAIL"] = str(nth)
            try:
                with connect("spi:/dev/spidev0.0?waiting=/dev/gpiochip0:25") as link:
                    link.write(0x12, nth)
                    told.append(link.read(0x12))
                del link
            except LinkError as error:
                told.append("Too many open files" in str(error))
        print(told, descriptors() - before)
    """
    said = spi_client(code, port=port_of(board), gpiochip="/dev/gpiochip0")
    assert said == f"{[True] * 9 + [10]} 0\n"


NO_WIRES = {
    "/dev/gpiochip0:26": "DeviceMismatch: GPIO line /dev/gpiochip0:26: the chip has no such line",
    "/dev/gpiochip7:25": "LinkNotFound: GPIO line /dev/gpiochip7:25: there is no such port; gpiodetect",
    "/dev/null:25": "LinkNotFound: GPIO line /dev/null:25: /dev/null is not a GPIO chip",
    "25": "UrlError: link URL .* waiting=25 is not a line of a GPIO chip such as /dev/gpiochip0:25",
    ":25": "UrlError: link URL .* waiting=:25 is not a line",
}


def test_a_wire_that_is_not_there(spi_client: SpiClient, board: Board) -> None:
    code = f"""
        from unitylink import UnityLinkError, connect
        for line in {list(NO_WIRES)}:
            try:
                connect(f"spi:/dev/spidev0.0?waiting={{line}}")
            except UnityLinkError as error:
                print(type(error).__name__, error, sep=": ")
    """
    said = spi_client(code, port=port_of(board), gpiochip="/dev/gpiochip0").splitlines()
    for (line, error), told in zip(NO_WIRES.items(), said, strict=True):
        assert re.match(error, told), line


def test_every_byte_of_long_answers(spi_client: SpiClient, board: Board) -> None:
    """These are more bytes than a transfer and the socket hold. No filler byte is passed on."""
    code = """
        from unitylink.layer0_driver import Driver
        with Driver("spi:/dev/spidev0.0?poll=1e-5") as driver:
            driver.send(b"#RLC\\n")
            reply = b""
            while not reply.endswith(b"\\n"):
                reply += driver.receive(timeout_s=30)
            for _ in range(5):
                driver.send(b"#RLC\\n" * 200)
            got = b""
            while len(got) < 1000 * len(reply):
                more = driver.receive(timeout_s=30)
                assert more
                got += more
        print(got == reply * 1000)
    """.replace("\\\\", "\\")
    assert spi_client(code, port=port_of(board)) == "True\n"


def test_no_filler_is_clocked_within_a_message(spi_client: SpiClient, board: Board) -> None:
    """A zero within a classic message would be an invalid character.

    The reply would be `?f3` instead of the answer.
    """
    code = r"""
        import time
        from unitylink.layer0_driver import Driver
        with Driver("spi:/dev/spidev0.0?poll=1e-5") as driver:
            for part in (b"#R", b"L", b"C\n"):
                driver.send(part)
                assert part == b"C\n" or driver.receive(timeout_s=0.05) == b""
            print(driver.receive(timeout_s=30)[:5])
    """
    assert spi_client(code, port=port_of(board)) == "b'#CNF:'\n"


def test_a_transfer_that_fails_ends_the_link(spi_client: SpiClient, board: Board) -> None:
    code = """
        from unitylink import LinkClosed, connect
        link = connect("spi:/dev/spidev0.0")
        try:
            while True:
                link.read(0x12)
        except LinkClosed as error:
            print(error, link.closed)
        link.close()
    """
    said = spi_client(code, port=port_of(board), unplug=20000)
    assert "an SPI transfer failed: Input/output error" in said and said.endswith("True\n")


def test_a_port_that_fails_is_opened_again(spi_client: SpiClient, board: Board) -> None:
    code = """
        from unitylink import connect
        from unitylink.errors import LinkDown, OutcomeUnknown
        with connect("spi:/dev/spidev0.0?timeout=5&reconnect=1") as link:
            number = 0
            while link.statistics().reconnections < 2:
                number += 1
                try:
                    link.write(0x12, number)
                except (LinkDown, OutcomeUnknown):
                    assert link.wait_up(30)
            link.write(0x12, 7)
            print(link.read(0x12), number > 10)
    """
    assert spi_client(code, port=port_of(board), unplug=20000) == "7 True\n"
    assert board.registers[0x12] == 7


def test_one_program_at_a_time(spi_client: SpiClient, board: Board, tmp_path: Path) -> None:
    code = """
        import fcntl
        from unitylink import LinkBusy, connect
        with open(FILE) as held:
            fcntl.flock(held, fcntl.LOCK_EX)
            try:
                connect("spi:/dev/spidev0.0")
            except LinkBusy as error:
                print(error)
    """.replace("FILE", repr(str(tmp_path / "spidev")))
    assert "another program holds it" in spi_client(code, port=port_of(board))


def test_a_speed_that_the_port_has_not(spi_client: SpiClient, board: Board) -> None:
    code = """
        from unitylink import DeviceMismatch, connect
        try:
            connect("spi:/dev/spidev0.0?speed_hz=900000000")
        except DeviceMismatch as error:
            print(error)
    """
    assert "cannot run at 900000000 Hz" in spi_client(code, port=port_of(board), refuse=22)


@pytest.mark.parametrize(
    ("url", "error", "message"),
    [
        ("spi:", UrlError, "the device file is missing, as in spi:/dev/spidev0.0"),
        ("spi:/dev/null?speed_hz=fast", UrlError, "speed_hz=fast is not a clock rate"),
        ("spi:/dev/null?speed_hz=999", UrlError, "speed_hz=999 is not a clock rate"),
        ("spi:/dev/null?poll=0", UrlError, "poll=0 is not a time in seconds"),
        ("spi:/dev/null?baud=9600", UrlError, "no option 'baud'"),
        ("serial:/dev/null?speed_hz=1000", UrlError, "no option 'speed_hz'"),
        ("spi:/dev/spidev99.0", LinkNotFound, "there is no such port; is SPI switched on"),
        ("spi:/dev/null", LinkNotFound, "this is not an SPI port"),
    ],
)
def test_what_cannot_be(url: str, error: type[Exception], message: str) -> None:
    with pytest.raises(error, match=message):
        connect(url)


@pytest.mark.parametrize("level", [b"\xff", b"\x00"], ids=["high", "low"])
def test_a_wire_with_nobody_on_it(spi_client: SpiClient, level: bytes) -> None:
    """miso floats: bytes come as fast as they are clocked, and none of them is an answer."""

    def float_(server: socket.socket) -> None:
        connection, _ = server.accept()
        with connection:
            while data := connection.recv(65536):
                connection.sendall(level * len(data))

    with socket.create_server(("127.0.0.1", 0)) as server:
        thread = threading.Thread(target=float_, args=(server,))
        thread.start()
        code = """
            from unitylink import LinkTimeout, connect
            try:
                connect("spi:/dev/spidev0.0?timeout=0.05&attempts=2")
            except LinkTimeout as error:
                print("nobody")
        """
        assert spi_client(code, port=server.getsockname()[1], exchange=1) == "nobody\n"
        thread.join()
