# SPDX-License-Identifier: BSD-3-Clause
"""One test for each finding: something is made wrong, and the doctor must report exactly that."""

from __future__ import annotations

import itertools
import shlex
from collections.abc import Callable
from pathlib import Path

import pytest

from unitylink.errors import LinkClosed, LinkError, LinkNotFound, LinkTimeout, UrlError
from unitylink.layer2_message import Link
from unitylink.ports import FINDINGS, Finding, examine
from unitylink.ports.findings import page
from unitylink.ports.probe import WAIT_S, find_polynomial, probe
from unitylink.simulate import Board as Twin
from unitylink.simulate import BoardConfiguration
from unitylink.spec import compile_text
from unitylink.spec.model import Spec

from .conftest import Board, Clock, FakeMachine, healthy

ROOT_PAGE = "docs/troubleshooting.md"
LINK = "serial:/dev/ttyUSB0?baud=3000000"
Reply = Callable[[bytes], bytes]


@pytest.fixture
def diagnose(fake: FakeMachine, clock: Clock) -> Callable[..., dict[str, Finding]]:
    """Return a function that examines a board with the replies of `reply`, and gives the findings by code."""
    fake.usb_port()

    def examined(
        reply: Reply = healthy,
        *,
        link: str = LINK,
        delay_s: float = 0.0005,
        boards: dict[str, Reply] | None = None,
    ) -> dict[str, Finding]:
        def open_driver(url: str) -> Board:
            return Board((boards or {}).get(url, reply), clock, delay_s=delay_s)

        found = examine(link, machine=fake.machine(), open_driver=open_driver, clock=clock)
        assert len({f.code for f in found}) == len(found)
        return {f.code: f for f in found}

    return examined


Diagnose = Callable[..., "dict[str, Finding]"]


def test_a_healthy_board_has_no_findings(diagnose: Diagnose) -> None:
    assert diagnose() == {}


def test_no_port(diagnose: Diagnose) -> None:
    found = diagnose(link="serial:/dev/ttyUSB7")
    assert list(found) == ["no-port"] and "ports on this machine: /dev/ttyUSB0" in found["no-port"].cause


@pytest.mark.parametrize(
    ("link", "wrong"),
    [
        ("serial:/dev/ttyUSB7?nonsense=3", "no option 'nonsense'"),
        ("serial:/dev/ttyUSB7?timeout=soon", "timeout=soon"),
        ("serial:/dev/ttyUSB7?baud=fast", "baud=fast"),
        ("serial:/dev/ttyUSB7?node=3", "no option 'node'"),
        ("tcp://127.0.0.1:99999", "99999"),
    ],
)
def test_the_doctor_refuses_at_once_what_connect_refuses(diagnose: Diagnose, link: str, wrong: str) -> None:
    with pytest.raises(UrlError, match=wrong):
        diagnose(link=link)


def test_brltty(diagnose: Diagnose, fake: FakeMachine) -> None:
    fake.process(79, "brltty")
    assert list(diagnose(link="serial:/dev/ttyUSB7")) == ["no-port", "brltty"]
    assert diagnose() == {}  # the program left this port alone


def test_no_serial_port(diagnose: Diagnose, fake: FakeMachine) -> None:
    fake.write("dev/null", "")
    fake.process(80, "bash", holds="/dev/null")  # no finding asks to kill it
    assert list(diagnose(link="serial:/dev/null")) == ["no-serial-port"]


def test_permission(diagnose: Diagnose, fake: FakeMachine) -> None:
    (fake.root / "dev/ttyUSB0").chmod(0o600)
    found = diagnose()
    assert list(found) == ["permission"] and "sudo usermod -aG" in found["permission"].remedy


def test_busy_port(diagnose: Diagnose, fake: FakeMachine) -> None:
    fake.process(77, "minicom", holds="/dev/ttyUSB0")
    found = diagnose()
    assert "minicom (process 77)" in found["busy-port"].cause and found["busy-port"].remedy.startswith(
        "kill 77"
    )


def test_modem_manager(diagnose: Diagnose, fake: FakeMachine) -> None:
    fake.process(78, "ModemManager")
    found = diagnose()
    assert list(found) == ["modem-manager"]
    sudo, program, *rest = shlex.split(found["modem-manager"].remedy)
    assert (sudo, rest) == ("sudo", ["doctor", LINK, "--install"])
    assert Path(program).is_absolute()  # sudo's path does not contain the virtual environment


def test_latency_timer(diagnose: Diagnose, fake: FakeMachine) -> None:
    path = next(fake.root.rglob("1-1:1.0/ttyUSB0/latency_timer"))
    path.write_text("16\n")
    found = diagnose()
    assert "waits 16 ms" in found["latency-timer"].cause
    assert "/sys/bus/usb-serial/devices/ttyUSB0/latency_timer" in found["latency-timer"].remedy


def test_unreachable(fake: FakeMachine, clock: Clock) -> None:
    def refuse(url: str) -> Board:
        raise LinkNotFound(f"{url}: Connection refused")

    (found,) = examine("tcp://10.1.2.3:5555", machine=fake.machine(), open_driver=refuse, clock=clock)
    assert found.code == "unreachable" and found.remedy.startswith("ping 10.1.2.3 ")
    assert "tcp://10.1.2.3:5555" in found.cause and "port 5555" in found.remedy


@pytest.mark.parametrize(
    ("link", "codes"), [(LINK, None), ("fd:7", None), ("tcp://10.1.2.3:5555", ["unreachable"])]
)
def test_a_line_that_is_lost_while_the_board_is_asked(
    fake: FakeMachine, clock: Clock, link: str, codes: list[str] | None
) -> None:
    """A port that is unplugged then is not a network device, and there is no host to ping."""

    class Unplugged(Board):
        def send(self, data: bytes, *, timeout_s: float = 0) -> None:
            raise LinkClosed("unplugged")

    fake.usb_port()

    def examined() -> list[Finding]:
        return examine(
            link, machine=fake.machine(), open_driver=lambda _: Unplugged(healthy, clock), clock=clock
        )

    if codes is None:
        with pytest.raises(LinkClosed, match="unplugged"):
            examined()
    else:
        assert [finding.code for finding in examined()] == codes


def test_a_port_that_cannot_be_opened_for_another_reason_is_an_error(fake: FakeMachine, clock: Clock) -> None:
    fake.usb_port()

    def refuse(url: str) -> Board:
        raise LinkError("Input/output error")

    with pytest.raises(LinkError, match="Input/output"):
        examine(LINK, machine=fake.machine(), open_driver=refuse, clock=clock)


def test_no_ftdi(diagnose: Diagnose) -> None:
    assert diagnose(link="ftdi:FT1234?channel=A") == {}
    found = diagnose(link="ftdi:FT9?channel=B")
    assert found["no-ftdi"].cause == (
        "no channel B of FT9; there are: ftdi:FT1234?channel=A, ftdi:FT1234?channel=B"
    )


def test_ftdi_permission(diagnose: Diagnose, fake: FakeMachine) -> None:
    (fake.root / "dev/bus/usb/001/007").chmod(0o664)
    found = diagnose(link="ftdi:?channel=B")
    assert list(found) == ["ftdi-permission"]
    assert "/dev/bus/usb/001/007, the FTDI chip FT1234," in found["ftdi-permission"].cause
    assert found["ftdi-permission"].remedy.endswith("doctor 'ftdi:?channel=B' --install")


def test_no_spi(diagnose: Diagnose, fake: FakeMachine) -> None:
    fake.write("sys/class/spidev/spidev0.1/dev", "153:1")
    fake.write("dev/spidev0.1", "").chmod(0o000)
    found = diagnose(link="spi:/dev/spidev0.0")
    assert found["no-spi"].cause == "/dev/spidev0.0 is not there; SPI ports on this machine: /dev/spidev0.1"
    assert list(diagnose(link="spi:/dev/spidev0.1")) == ["permission"]


def test_a_node_on_a_pair_that_is_silent(fake: FakeMachine, clock: Clock) -> None:
    """The node knows only frames, so a link is opened instead of sending text.

    The port is examined like any other.
    """
    fake.usb_port()
    asked = []

    def silent(url: str) -> Link:
        asked.append(url)
        raise LinkTimeout("nothing answers", elapsed_s=0.1)

    link = "rs485:/dev/ttyUSB0?node=3"
    (found,) = examine(link, machine=fake.machine(), open_link=silent, clock=clock)
    assert (found.code, asked) == ("silence", [link])
    (found,) = examine("rs485:/dev/ttyUSB9?node=3", machine=fake.machine(), open_link=silent, clock=clock)
    assert found.code == "no-port"


def test_ftdi_refused(fake: FakeMachine, clock: Clock) -> None:
    fake.usb_port()

    def refuse(url: str) -> Board:
        raise LinkError("the synchronous FIFO is on channel A of an FT232H or FT2232H")

    link = "ftdi:FT1234?channel=B&mode=sync-fifo"
    (found,) = examine(link, machine=fake.machine(), open_driver=refuse, clock=clock)
    assert found.code == "ftdi-refused" and "on channel A" in found.cause


def test_wrong_baud(diagnose: Diagnose) -> None:
    found = diagnose(lambda line: b"\x80\xf8\x00", boards={"serial:/dev/ttyUSB0?baud=115200": healthy})
    assert list(found) == ["wrong-baud"] and "serial:/dev/ttyUSB0?baud=115200" in found["wrong-baud"].remedy


def test_silence(diagnose: Diagnose) -> None:
    found = diagnose(lambda line: b"")
    assert list(found) == ["silence"] and "at any usual baud rate" in found["silence"].cause


def test_publishes_are_no_answer(diagnose: Diagnose) -> None:
    assert list(diagnose(lambda line: b"%PUB:000100000001\n")) == ["silence"]


def test_echo(diagnose: Diagnose) -> None:
    assert list(diagnose(lambda line: line)) == ["echo"]


def test_garbage(diagnose: Diagnose) -> None:
    found = diagnose(lambda line: b"ok T:21.3 /0.0\n")
    assert list(found) == ["garbage"] and "T:21.3" in found["garbage"].cause


def test_line_errors(diagnose: Diagnose) -> None:
    found = diagnose(lambda line: b"?f7\n")
    assert list(found) == ["line-errors"] and "framing" in found["line-errors"].cause


def test_a_message_that_was_received_in_half_before_is_not_a_line_error(diagnose: Diagnose) -> None:
    assert diagnose(lambda line: b"?f3\n" + healthy(line)) == {}


@pytest.mark.parametrize(("polynomial", "text"), [(0x2F, "0x2F"), (None, "xor")])
def test_checksum(diagnose: Diagnose, polynomial: int | None, text: str) -> None:
    found = diagnose(lambda line: healthy(line, polynomial=polynomial))
    assert list(found) == ["checksum"] and f"polynomial={text}" in found["checksum"].remedy


def test_a_board_that_goes_while_checksums_are_tried_is_not_asked_256_times(clock: Clock) -> None:
    board = Board(lambda line: b"?f4\n" if len(board.asked) < 10 else b"", clock)
    assert find_polynomial(board, clock=clock) is None
    assert len(board.asked) == 12 and clock() < 3 * WAIT_S + 1


def test_a_flooded_port_is_asked_all_the_same(clock: Clock) -> None:
    """The noise never ends, before the question and after it."""

    class Flooded(Board):
        def receive(self, *, timeout_s: float = 1.0) -> bytes:
            self.clock.now_s += 0.001
            return b"\x55" * 64

    board = Flooded(healthy, clock)
    assert probe(board, clock=clock).kind == "garbage"
    assert len(board.asked) == 1 and clock() <= 2 * WAIT_S + 0.01


def test_a_wrong_polynomial_is_a_wrong_link(diagnose: Diagnose) -> None:
    with pytest.raises(UrlError, match="polynomial=x is not a CRC-8 polynomial"):
        diagnose(link=f"{LINK}&polynomial=x")


def test_no_checksum(diagnose: Diagnose) -> None:
    found = diagnose(lambda line: healthy(line) if b"#" in line else b"")
    assert list(found) == ["no-checksum"] and found["no-checksum"].severity == "note"
    assert "polynomial=none" in found["no-checksum"].remedy


def test_gateware_without_checksum_is_never_sent_one(diagnose: Diagnose) -> None:
    asked: list[bytes] = []

    def answer(line: bytes) -> bytes:
        asked.append(line)
        return b"" if b"$" in line else healthy(line)

    assert diagnose(answer, link=f"{LINK}&polynomial=none") == {}
    assert asked and not any(b"$" in line for line in asked)


def test_board_busy(diagnose: Diagnose) -> None:
    assert list(diagnose(lambda line: b"?busy\n")) == ["board-busy"]
    (found,) = diagnose(lambda line: b"?busy\n", link="tcp://10.1.2.3:5555").values()
    assert found.cause.startswith("tcp://10.1.2.3:5555 answers")


def test_a_board_that_says_busy_before_it_is_asked_and_hangs_up(fake: FakeMachine, clock: Clock) -> None:
    class HangsUp(Board):
        def receive(self, *, timeout_s: float = 1.0) -> bytes:
            said, self.waiting = self.waiting, b""
            if not said:
                raise LinkClosed("the other side closed the connection")
            return said

    def open_driver(url: str) -> Board:
        board = HangsUp(healthy, clock)
        board.waiting = b"?busy\n"
        return board

    (found,) = examine("tcp://10.1.2.3:5555", machine=fake.machine(), open_driver=open_driver, clock=clock)
    assert found.code == "board-busy"


def test_no_configuration(diagnose: Diagnose) -> None:
    found = diagnose(lambda line: b"$?E_ICC\n")
    assert list(found) == ["no-configuration"] and "E_ICC" in found["no-configuration"].cause
    assert "address_bytes=1&data_bytes=4" in found["no-configuration"].remedy


def test_slow(diagnose: Diagnose) -> None:
    found = diagnose(delay_s=0.02)
    assert list(found) == ["slow"] and "takes 20.00 ms" in found["slow"].cause


def test_losses(diagnose: Diagnose) -> None:
    turns = itertools.count(1)
    found = diagnose(lambda line: healthy(line) if next(turns) % 10 else b"")
    assert list(found) == ["losses"] and "of 50 requests failed: silence" in found["losses"].cause


# ---- a spec, compared with the twin


def against(text: str, board: Twin) -> dict[str, Finding]:
    spec = compile_text(text.encode(), "arm.ul").spec
    assert isinstance(spec, Spec)
    found = examine(board.url, spec=spec, open_link=Link)
    return {f.code: f for f in found if f.code != "slow"}  # a loaded machine may really be slow


def twin(**configuration: int) -> Twin:
    return Twin(configuration=BoardConfiguration(**configuration), endpoint="tcp:0")


NARROW = "public arm() { @far = 0x1234: READ(); }"
PUBLISHING = "public arm() { @angle = 0x10: READ(PUBLISH(1,10)); }"


def test_widths() -> None:
    with twin(address_bits=8) as board:
        found = against(NARROW, board)
    assert list(found) == ["widths"] and "far at 0x1234" in found["widths"].cause


def test_publishing() -> None:
    with twin(publish_mode=0) as board:
        found = against(PUBLISHING, board)
    assert list(found) == ["publishing"]


def test_other_gateware() -> None:
    """Here the same words have other names. A write would move the wrong one, without any bus error."""
    text = "public arm() { @x = 0x10: WRITE(); @y = 0x11: WRITE(); }"
    with Twin(compile_text(text, "arm.ul").spec, endpoint="tcp:0") as board:
        found = against(text.replace("0x10", "0x12").replace("0x11", "0x10").replace("0x12", "0x11"), board)
        assert list(found) == ["other-gateware"] and found["other-gateware"].severity == "error"
        assert against(text, board) == {}


def test_unverified_gateware() -> None:
    text = "public arm() { @x = 0x10: WRITE(); }"
    with Twin(endpoint="tcp:0") as board:
        found = against(text, board)
    assert list(found) == ["unverified-gateware"] and found["unverified-gateware"].severity == "note"


def test_wrong_spec() -> None:
    other = compile_text(b"public lamp(c,u) { TOSNET(CTRL=c,COMM=u); @led = 0x40: READ(); }", "lamp.ul").spec
    assert isinstance(other, Spec)
    classic = BoardConfiguration.for_spec(other, protocol="classic")  # framed gateware reports this itself
    with Twin(other, configuration=classic, endpoint="tcp:0") as board:
        found = against(PUBLISHING.replace("0x10", "0x480"), board)
    assert (
        list(found) == ["wrong-spec", "unverified-gateware"]
        and "angle at 0x0480" in found["wrong-spec"].cause
    )


def test_the_right_spec() -> None:
    spec = compile_text(PUBLISHING.encode(), "arm.ul").spec
    with Twin(spec, endpoint="tcp:0") as board:
        assert against(PUBLISHING, board) == {}


# ---- the table


def test_every_finding_has_its_test() -> None:
    tested = {name.removeprefix("test_").replace("_", "-") for name in globals() if name.startswith("test_")}
    assert set(FINDINGS) <= tested


def test_the_page_is_that_of_the_table(pytestconfig: pytest.Config) -> None:
    assert (pytestconfig.rootpath / ROOT_PAGE).read_text() == page(), "make docs writes it anew"
